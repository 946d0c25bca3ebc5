"""Rough surfaces in limit cycles: loads of film and summits with their derivatives, and where the machine rests."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from cycle_machines import machine_of
from differences import differences
from films import ROUGH
from marches import planned_system

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.machine import film_loads
from frbcli.film.roughness.asperities import rub
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.runs.run import runup

OMEGA = 2.0 * math.pi * 1.5
PLACE, RATE = np.array([[0.11, -0.958]]), np.array([[3.0, -1.0]])


def rigid() -> Case:
    return load_case("rigid", [*ROUGH, "speed.from=0.3 Hz", "speed.to=1 Hz"])


def test_loads_are_those_of_film_and_summits_with_exact_derivatives() -> None:
    case = rigid()
    machine, system = machine_of(case), planned_system(case)
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
    machine, still = machine_of(rigid()), np.zeros((1, 2))
    found = film_loads(machine, PLACE, still, slow).by_speed[0]
    measured = differences(lambda omega: film_loads(machine, PLACE, still, omega[0]).values[0], [slow], 1e-6 * slow)
    np.testing.assert_allclose(found, measured[:, 0], rtol=1e-5, atol=1e-6 * np.abs(found).max())


def test_resting_curve_is_that_of_the_sheet() -> None:
    case = rigid()
    machine, system = machine_of(case), planned_system(case)
    points = resting_curve(system, machine, 2.0 * math.pi * 0.3, 2.0 * math.pi).points
    ends = points[0], points[-1]
    states = bearing_sheet(case, [each.omega / (2.0 * math.pi) for each in ends]).points
    for each, state in zip(ends, states, strict=True):
        np.testing.assert_allclose(each.u, state.displacement, rtol=1e-5)
    assert states[0].mixed is not None
    assert states[0].mixed.share > 0.05


@pytest.mark.nightly  # half a minute, with compilation
def test_a_cycle_whose_ring_hits_its_shell_is_that_of_a_long_run(tmp_path: Path) -> None:
    """The ring rolls through its shell with the whirl: in a period its summits carry between nothing and nine tenths of
    the load, and friction swings its speed by 1 %."""
    groove = 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}'
    films = (
        *ROUGH, "contact.roughness=2.2 um", groove, "film.cavitation=half-sommerfeld", "accuracy.mesh=[3, 16]",
        "rotor.unbalance=0", "bearing.outer.viscosity=2 mPa*s",
    )  # fmt: skip
    found = limit_cycles(load_case("floating-ring", [*films, "speed.from=129 Hz", "speed.to=131 Hz"]), [130.0])
    (cycle,) = (point for point in found.branches[0].points if point.speed_Hz == pytest.approx(130.0, rel=1e-9))
    course = 'speed={points=[["0 s", "130 Hz"], ["1.2 s", "130 Hz"]]}', "start.displacement=[0.3, -0.3]"
    steps = "output.step=5e-5 s", "accuracy.tolerance=1e-8"
    run = runup(load_case("floating-ring", [*films, *course, *steps]), tmp_path / "run.h5")
    late = run["time_s"] > 1.1
    for name, largest in zip(("inner", "outer"), cycle.eccentricity_max, strict=True):
        assert run[f"eccentricity_{name}"][late].max() == pytest.approx(largest, rel=1e-3)
    x = run["journal_x_m"][late] - run["journal_x_m"][late].mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossings = up - x[up] / (x[up + 1] - x[up])
    assert 1.0 / (5e-5 * np.diff(crossings).mean()) == pytest.approx(cycle.frequency_Hz, rel=1e-3)
    share, ring = run["asperity_share_outer"][late], run["ring_speed_Hz"][late]
    assert share.min() < 0.01
    assert share.max() > 0.8
    assert 0.005 < np.ptp(ring) / ring.mean() < 0.02
