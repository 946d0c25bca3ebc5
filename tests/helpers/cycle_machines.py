"""Machines whose limit cycles are tested: the rigid rotor in short bearings without supply, in the numbers of its
cycles, and in short films a floating ring, a turbocharger and a cartridge."""

import math
import tomllib
from functools import cache

import frbcli
from frbcli.case.reading.shipped import find_shipped
from frbcli.cycles.columns import LimitCycles
from frbcli.cycles.method.machine import Machine, make_machine
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

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


def machine_of(case: frbcli.Case) -> Machine:
    """The machine of a case up to its highest speed."""
    return make_machine(make_system(case, make_plan(case)), 2.0 * math.pi * case.speed.end)


def ring_case() -> frbcli.Case:
    """A floating ring without openings."""
    case = tomllib.loads(find_shipped("floating-ring"))
    case["bearing"]["inner"]["supply"] = {"kind": "none"}
    case["film"] = {"theory": "short", "cavitation": "half-sommerfeld"}
    case["bearing"]["outer"]["supply"] = {"kind": "none"}
    return frbcli.case_from_dict(case)


def turbocharger() -> frbcli.Case:
    """A flexible rotor on two floating rings without openings."""
    case = tomllib.loads(find_shipped("turbocharger-heavy"))
    for bearing in case["bearing"]:
        bearing["inner"]["supply"] = {"kind": "none"}
    case["film"] = {"theory": "short", "cavitation": "half-sommerfeld"}
    return frbcli.case_from_dict(case)


def cartridge() -> frbcli.Case:
    """A shaft in a heavy cartridge, whose gyroscopic moments count, without openings and unbalance, in short films."""
    case = tomllib.loads(find_shipped("turbocharger-car-cartridge"))
    for film in ("inner", "outer"):
        case["bearing"][film]["supply"] = {"kind": "none"}
    for disk in case["disk"]:
        disk.pop("unbalance", None)
    case["bearing"]["ring"] |= {"inertia": "4 kg*mm^2", "tilt_inertia": "4 kg*mm^2"}
    case["rotor"] |= {"cutoff": "3 kHz", "gravity": "30 m/s^2"}
    case["film"] = {"theory": "short", "cavitation": "half-sommerfeld"}
    case["speed"]["to"] = "400 Hz"
    return frbcli.case_from_dict(case)
