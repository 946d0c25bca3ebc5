"""Machines whose limit cycles are tested: a floating ring and a turbocharger in short films."""

from __future__ import annotations

import math
import tomllib

import frbcli
from frbcli.case.reading.shipped import find_shipped
from frbcli.cycles.method.machine import Machine, make_machine
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan


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
