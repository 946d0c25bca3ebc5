"""The critical speeds of the linearised rotor, with which resonances of a run are compared.

A mode of the rotor in its films whose natural frequency equals the rotor speed. The films are half-Sommerfeld ones,
full wherever they carry: a mass-conserving film has no eight coefficients, and the stiffness of a starved film changes
with time. A bearing model is linearised itself. Films on cells are on the coarsest mesh of static results, whose
critical speeds differ by less than 1e-4 from those on the finest.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium.coefficients import coefficients_of
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import FrbError, NotConverged
from frbcli.linear.stability_point import eigenvalues
from frbcli.scene.films import full_films, rings

SPEEDS = 20  # between which natural frequencies are nearly straight
LOWEST = 0.01  # share of the highest speed
ABOVE = 1.2  # times the highest speed of a run: a mode a little above it is felt below
DAMPED = 1.0 / math.sqrt(2.0)  # damping ratio from which on unbalance causes no peak


def linear_critical_speeds(case: Case) -> tuple[float, ...] | None:
    """Critical speeds of a case in Hz, ascending, up to its highest speed and a little above; None where they are not
    known: for floating rings, whose films whirl from low speeds on, and where no resting position is found."""
    if rings(case):
        return None
    top = ABOVE * max(abs(case.speed.start), abs(case.speed.end))
    try:
        machines = StaticMachines(full_films(case), coarse=True)
    except FrbError:  # an opening that this film does not know
        return None
    sweep = np.geomspace(top, LOWEST * top, SPEEDS).tolist() if top > 0.0 else []
    points = list(_modes(machines, sweep))
    found = (_crossings(below, above) for above, below in itertools.pairwise(points))
    return tuple(sorted(itertools.chain(*found))) if len(points) > 1 else None


def _modes(machines: StaticMachines, speeds_Hz: Sequence[float]) -> Iterator[tuple[float, Array]]:
    """Speed and natural frequencies (k,) in Hz of the modes that unbalance can excite, where the rotor can rest; from a
    fast journal near the middle outwards."""
    machine = None
    for speed in speeds_Hz:
        omega = 2.0 * math.pi * speed
        try:
            machine = machines.at(omega, machine, with_error=False)
        except NotConverged:
            continue
        stiffness, damping = coefficients_of(machine.films)
        values = eigenvalues(machine.system.rotor, omega, stiffness, damping)
        excited = values[(values.imag > 0.0) & (-values.real < DAMPED * np.abs(values))]
        yield speed, np.abs(excited) / (2.0 * math.pi)


def _crossings(below: tuple[float, Array], above: tuple[float, Array]) -> Iterator[float]:
    """Where natural frequencies equal the speed between two speeds: of each mode and the nearest one at the other."""
    (low, lower), (high, upper) = below, above
    for frequency in lower if len(upper) else ():
        off, then = frequency - low, upper[np.argmin(np.abs(upper - frequency))] - high
        if off >= 0.0 > then:
            yield float(low + (high - low) * off / (off - then))
