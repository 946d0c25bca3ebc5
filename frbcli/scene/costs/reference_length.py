"""The length that displacements of a machine without films are compared with, in place of a clearance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.rotor.held import held_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.shafts.table import shaft_of

SMALLEST = 1e-9  # m: of a rotor that neither its weight nor an unbalance moves
LARGEST = 1.0  # m: bearings that let the rotor sag further do not hold it
SAGS, TURNS, LEAST = "the largest static deflection", "the unbalance over the mass", "the least that is taken"
LOADED = "the largest static deflection under a load that changes"


def reference_length(case: Case) -> tuple[float, str]:
    """Length in m, and which one it is: the largest static deflection of a point of a run at the first and the last
    speed, under the static load or another load at its largest, or the unbalance over the mass if that is larger, at
    least SMALLEST."""
    rotor = make_rotor(case)
    speeds = [2.0 * math.pi * speed for speed in (case.speed.start, case.speed.end)]
    sag = max(_sag(rotor, omega) for omega in speeds)
    pushed = (replace(rotor, static_load=column) for load in rotor.loads for column in load.largest)
    loaded = max((_sag(each, omega) for each in pushed for omega in speeds), default=0.0)
    return max((sag, SAGS), (loaded, LOADED), (shaft_of(case).eccentricity, TURNS), (SMALLEST, LEAST))


def _sag(rotor: LinearRotor, omega: float) -> float:
    """m; 0 where the bearings do not hold the rotor."""
    try:
        shape = held_rotor(rotor, omega).shape
    except NotConverged:
        return 0.0
    found = max((float(np.hypot(*(place @ shape))) for _, place in rotor.points), default=0.0)
    return found if found < LARGEST else 0.0
