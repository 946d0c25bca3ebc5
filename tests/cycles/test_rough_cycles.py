"""Rough surfaces in limit cycles: loads of film and summits with their derivatives, and where the machine rests."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cycle_machines import machine_of
from films import ROUGH

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.parts.machine import film_loads
from frbcli.film.roughness.asperities import rub
from frbcli.linear.bearing_sheet import bearing_sheet
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

OMEGA = 2.0 * math.pi * 1.5
PLACE, RATE = np.array([[0.11, -0.958]]), np.array([[3.0, -1.0]])


def rigid() -> Case:
    return load_case("rigid", [*ROUGH, "speed.from=0.3 Hz", "speed.to=1 Hz"])


def test_loads_are_those_of_film_and_summits_with_exact_derivatives() -> None:
    case = rigid()
    machine, system = machine_of(case), make_system(case, make_plan(case))
    found, c = film_loads(machine, PLACE, RATE, OMEGA), system.clearances[0]
    expected = system.force(0, c * PLACE[0], c * RATE[0], OMEGA)
    np.testing.assert_allclose(found.values[0], expected.force, rtol=1e-9)
    np.testing.assert_allclose(found.by_u[0], c * expected.by_displacement, rtol=1e-9)
    np.testing.assert_allclose(found.by_v[0], c * expected.by_velocity, rtol=1e-9)
    assert system.asperities is not None
    summits = rub(system.asperities, 0, c, *(c * PLACE[0]).tolist(), *(c * RATE[0]).tolist(), OMEGA, 0.0)
    film = load_case("rigid")
    alone = film_loads(machine_of(film), PLACE, RATE, OMEGA)
    assert found.drive[0] - alone.drive[0] == pytest.approx(-summits.torque, rel=1e-9)


@pytest.mark.parametrize("slow", [OMEGA, 1e-3 * OMEGA])
def test_friction_follows_the_speed(slow: float) -> None:
    """Also where it is not fully developed."""
    machine, step, still = machine_of(rigid()), 1e-6 * slow, np.zeros((1, 2))
    found = film_loads(machine, PLACE, still, slow).by_speed[0]
    ahead, behind = (film_loads(machine, PLACE, still, slow + side * step).values[0] for side in (1.0, -1.0))
    np.testing.assert_allclose(found, (ahead - behind) / (2.0 * step), rtol=1e-5, atol=1e-6 * np.abs(found).max())


def test_resting_curve_is_that_of_the_sheet() -> None:
    case = rigid()
    machine, system = machine_of(case), make_system(case, make_plan(case))
    points = resting_curve(system, machine, 2.0 * math.pi * 0.3, 2.0 * math.pi).points
    ends = points[0], points[-1]
    states = bearing_sheet(case, [each.omega / (2.0 * math.pi) for each in ends]).points
    for each, state in zip(ends, states, strict=True):
        np.testing.assert_allclose(each.u, state.displacement, rtol=1e-5)
    assert states[0].mixed is not None
    assert states[0].mixed.share > 0.05
