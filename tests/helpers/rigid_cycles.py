"""The rigid rotor in short bearings without supply, in the numbers of its limit cycles, and its diagrams."""

from __future__ import annotations

import math
from functools import cache

import frbcli
from frbcli.cycles.columns import LimitCycles

GRAVITY, CLEARANCE, MASS, WIDTH, RADIUS = 9.81, 50e-6, 6.0, 10e-3, 25e-3
UNIT_Hz = math.sqrt(GRAVITY / CLEARANCE) / (2.0 * math.pi)  # w = 1


def rigid(gamma: float, low: float, high: float, **more: float) -> frbcli.Case:
    """The rigid rotor from w = low to high."""
    viscosity = gamma * 0.5 * MASS * GRAVITY * CLEARANCE**2 / (RADIUS * WIDTH**3) / math.sqrt(GRAVITY / CLEARANCE)
    rotor = {"kind": "rigid", "mass": MASS, "gravity": GRAVITY, **more}
    bearing = {"kind": "single-film", "width": WIDTH, "diameter": 2.0 * RADIUS, "clearance": CLEARANCE}
    return frbcli.case_from_dict(
        {
            "rotor": rotor,
            "bearing": {**bearing, "supply": {"kind": "none"}},
            "oil": {"viscosity": viscosity},
            "film": {"theory": "short", "cavitation": "half-sommerfeld"},
            "speed": {"from": low * UNIT_Hz, "to": high * UNIT_Hz, "duration": 1.0},
        }
    )


@cache
def diagram(gamma: float, low: float, high: float) -> LimitCycles:
    return frbcli.limit_cycles(rigid(gamma, low, high))
