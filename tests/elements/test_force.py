"""Constant forces on places of a machine: equal ways to say the same, places, and faults."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.errors import InputError
from frbcli.linear.stability import stability
from frbcli.report.sketch import rotor_sketch
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.plan import make_plan

M, K, C, U = 6.0, 1e6, 300.0, 3e-6  # kg; N/m and N s/m of one bearing; kg m
RIGID = {"kind": "rigid", "mass": f"{M} kg", "gravity": 0.0}
JEFFCOTT = {"kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m"}
BEARING = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m"}
SPEED = {"from": "10 Hz", "to": "200 Hz", "duration": "1 s"}
TURN = 2.0 * math.pi


def machine(rotor: dict[str, Any], *forces: dict[str, Any], **tables: object) -> frbcli.Case:
    data = {"rotor": rotor, "bearing": BEARING, "speed": SPEED, "force": list(forces)} | tables
    return case_from_dict(data, "forced")


def push(at: str = "journal", x: float = 10.0, y: float = 0.0, **keys: object) -> dict[str, Any]:
    return {"at": at, "force": [f"{x!r} N", f"{y!r} N"]} | keys


def test_a_constant_force_is_a_weight() -> None:
    """Half the weight of the rotor, lifted at both journals, leaves what a rotor under half the gravity has."""
    film = load_case("rigid", ["film.theory=short"])
    weight = film.rotor.mass * film.rotor.gravity
    forced = film.with_settings({"force": [push(x=0.0, y=0.25 * weight)]})
    light = film.with_settings({"rotor.gravity": 0.5 * film.rotor.gravity})
    one, other = (stability(case, [60.0]).points[0].films[0] for case in (forced, light))
    np.testing.assert_allclose(one.displacement, other.displacement, rtol=1e-9)
    hopf = [limit_cycles(case).special[0].speed_Hz for case in (forced, light)]
    assert abs(hopf[0] - hopf[1]) < 1e-6 * hopf[1]


def test_the_text_gives_the_case_again_and_plan_and_sketch_show_forces() -> None:
    case = machine(JEFFCOTT, push("disk"), push("journal", y=2.0))
    assert load_case_text(case.source_text, name="forced") == case
    told = [each.value for each in make_plan(case).decisions if each.choice == "force"]
    assert rotor_sketch(case)[0].count(">F1<") == 1  # at the disk
    assert rotor_sketch(case)[0].count(">F2<") == 2  # at both journals
    assert told == ["disk: 10 N in x, 0 N in y", "journal: 10 N in x, 2 N in y"]


def test_places_of_a_turbocharger_are_bearings_and_disks() -> None:
    heavy = load_case("turbocharger-heavy")
    bearing, bearings = heavy.bearings[0].name, {each.name for each in heavy.bearings}
    disk = next(each.name for each in heavy.disks if each.name not in bearings)
    forced = heavy.with_settings({"force": [push(f"journal_{bearing}"), push(disk)]})
    load = make_rotor(forced).static_load - make_rotor(heavy).static_load
    points = dict(make_rotor(heavy).points)
    expected = 10.0 * (points[f"journal_{bearing}"][0] + points[f"disk_{disk}"][0])
    np.testing.assert_allclose(load, expected, atol=1e-9)
    assert ">F2<" in rotor_sketch(forced)[0]


FAULTS = {
    "no such place": (push("compresor"), "force.0.at", "no place"),
    "one entry": ({"at": "journal", "force": ["10 N"]}, "force.0.force.1", "missing"),
    "unknown": (push(order=2.0), "force.0.order", "not known"),
    "no force": ({"at": "journal"}, "force.0.force", "missing"),
}


@pytest.mark.parametrize("given", FAULTS.values(), ids=FAULTS.keys())
def test_bad_forces_are_refused(given: tuple[dict[str, Any], str, str]) -> None:
    force, key, problem = given
    with pytest.raises(InputError) as caught:
        machine(RIGID, force)
    (fault,) = caught.value.faults
    assert (fault.key, problem in fault.problem, bool(fault.remedy)) == (key, True, True)


def test_the_nearest_place_is_the_remedy() -> None:
    with pytest.raises(InputError, match='Did you mean "disk"'):
        machine(JEFFCOTT, push("dsk"))




def test_a_kinematic_test_refuses_forces() -> None:
    with pytest.raises(InputError, match="has no effect"):
        load_case("bearing").with_settings({"force": [push()]})
