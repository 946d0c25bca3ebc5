"""Cycles of films whose forces have kinks, on pockets, slots, lobes and cells, and on rough surfaces."""

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from cycle_machines import machine_of
from differences import differences
from films import ROUGH
from marches import planned_system
from scipy.optimize import brentq

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.columns import CyclePoint, LimitCycles
from frbcli.cycles.limit_cycles import check, limit_cycles
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.machine import film_loads
from frbcli.cycles.shooting.period_map import PeriodMap, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, largest
from frbcli.equilibrium.resting import resting_position
from frbcli.film.roughness.asperities import rub
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.stability_point import critical_eigenvalue, eigenvalues
from frbcli.runs.run import runup
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import SPEED_CYCLES

REYNOLDS = ("film.cavitation=reynolds", "accuracy.mesh=[6,32]")
POCKET = '{kind="pocket", position="90 deg", opening_angle="30 deg", width="8 mm", pressure="2 bar"}'
OPENINGS = {
    "pocket": (f"bearing.supply={POCKET}", True),
    "lobes": ("bearing.lobes={count=3, preload=0.5}", False),
}
RANGE_Hz, ASKED_Hz = (212.0, 232.0), 222.0


@lru_cache
def cells() -> PeriodMap:
    return period_map(frbcli.load_case("rigid", REYNOLDS))


@lru_cache
def diagram() -> LimitCycles:
    speeds = [f"speed.{end}={speed} Hz" for end, speed in zip(("from", "to"), RANGE_Hz, strict=True)]
    return frbcli.limit_cycles(frbcli.load_case("rigid", [*REYNOLDS, *speeds]), [ASKED_Hz])


def by_coefficients(speed_Hz: float, flow: PeriodMap | None = None) -> complex:
    """The eigenvalue of the whirl on the derivatives of the force on the same cells."""
    omega, system = 2.0 * math.pi * speed_Hz, (flow or cells()).system
    films = resting_position(system, omega).films
    k, d = (-np.array([getattr(film, name) for film in films]) for name in ("by_displacement", "by_velocity"))
    return critical_eigenvalue(eigenvalues(system.rotor, omega, k, d))


@pytest.mark.parametrize(("opening", "begins"), OPENINGS.values(), ids=OPENINGS)
def test_pockets_slots_and_lobes_rest_and_begin_to_whirl_as_their_coefficients_do(opening: str, begins: bool) -> None:
    """The growth of the whirl at two speeds, between which that of pocket and slots changes its sign: a Hopf point.
    Three lobes hold the journal: no whirl begins."""
    flow = period_map(frbcli.load_case("rigid", [opening, "film.cavitation=half-sommerfeld", "accuracy.mesh=[6,32]"]))
    growths = []
    for speed_Hz in (120.0, 260.0):
        omega = 2.0 * math.pi * speed_Hz
        rest = settled(Shooting(flow, omega), omega)
        assert rest is not None
        expected, position = by_coefficients(speed_Hz, flow), resting_position(flow.system, omega)
        np.testing.assert_allclose(rest.displacement, position.journals / flow.clearances[0], atol=1e-5)
        assert abs(rest.eigenvalues[rest.whirls[0]] - expected) < 1e-3 * abs(expected)
        growths.append(rest.eigenvalues[rest.whirls[0]].real)
    assert growths[0] < 0.0
    assert (growths[1] > 0.0) == begins


def test_the_error_of_the_hopf_point_by_the_cells_holds_the_threshold_on_twice_as_many() -> None:
    (hopf,), fine = diagram().of("hopf"), period_map(diagram().case, (64, 12))
    threshold = brentq(lambda speed: by_coefficients(speed, fine).real, *RANGE_Hz, xtol=1e-3)
    assert abs(hopf.speed_Hz - threshold) <= hopf.value_uncertainty < 0.01 * hopf.speed_Hz
    off = abs(hopf.frequency_Hz - by_coefficients(threshold, fine).imag / (2.0 * math.pi))
    assert off <= hopf.frequency_uncertainty_Hz < 0.01 * hopf.frequency_Hz


def on_twice_as_many_cells(point: CyclePoint, turns: int) -> tuple[float, float]:
    """Largest eccentricity and frequency in Hz of what a stable cycle becomes on 64 x 12 cells in so many turns."""
    flow = period_map(diagram().case, (64, 12))
    omega, nu = 2.0 * math.pi * point.speed_Hz, 2.0 * math.pi * point.frequency_Hz
    waves = point.harmonics[1:, 0] * flow.scale
    rates = 1j * nu * np.arange(1, len(waves) + 1)[:, None]
    q = flow.scale * point.harmonics[0, 0].real + 2.0 * waves.sum(axis=0).real
    v = 2.0 * (rates * waves).sum(axis=0).real
    turn = 2.0 * math.pi / omega
    late = flow.passage(wet_at(flow, q, v, omega), turns * turn, omega, 100 * turns).end
    moved = flow.passage(late, 40.0 * turn, omega, 4000, 40 * 128).displacements
    x = moved[:, 0, 0] - moved[:, 0, 0].mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    times = (up + x[up] / (x[up] - x[up + 1])) * turn / 128.0
    return float(np.hypot(*moved[:, 0].T).max()), (len(times) - 1) / float(times[-1] - times[0])


def test_errors_of_a_cycle_and_a_fold_by_the_cells_hold_twice_as_many() -> None:
    """The time loop goes to the cycle on these from that on the own ones."""
    (branch,) = diagram().branches
    (stable,) = (point for point in branch.points if point.kind == "asked" and point.stable)
    eccentricity, frequency_Hz = on_twice_as_many_cells(stable, 80)
    assert stable.eccentricity_max_uncertainty is not None
    assert abs(stable.eccentricity_max[0] - eccentricity) <= stable.eccentricity_max_uncertainty[0] < 0.02
    assert abs(stable.frequency_Hz - frequency_Hz) <= stable.frequency_uncertainty_Hz < 0.01 * frequency_Hz
    cycles = [point for point in branch.points[1:] if point.kind != "fold"]
    for one, beside, after in zip(cycles, cycles[1:], cycles[2:], strict=False):  # no error vanishes by chance
        highest = max(one.frequency_uncertainty_Hz, after.frequency_uncertainty_Hz)
        assert beside.frequency_uncertainty_Hz > 0.45 * highest
    (fold,) = diagram().of("fold")
    assert fold.certain
    assert 0.0 < fold.value_uncertainty < 0.005 * fold.speed_Hz
    assert math.isnan(branch.points[0].frequency_uncertainty_Hz)


def test_the_time_loop_goes_to_the_stable_motions_on_both_sides_of_the_unstable_cycle() -> None:
    """Below the Hopf point, above the fold: rest from a small displacement, the large cycle from a wide one."""
    (branch,) = diagram().branches
    unstable, stable = (point for point in branch.points if point.kind == "asked")
    assert (unstable.stable, stable.stable) == (False, True)
    assert unstable.eccentricity_max[0] < stable.eccentricity_max[0]
    omega = 2.0 * math.pi * ASKED_Hz
    rest = resting_position(cells().system, omega)
    for eccentricity, expected in ((0.25, float(np.hypot(*rest.journals[0]) / cells().clearances[0])),
                                   (0.9, float(stable.eccentricity_max[0]))):  # fmt: skip
        q = np.array([eccentricity * cells().clearances[0], 0.0])
        start = wet_at(cells(), q, np.zeros(2), omega)
        turns = 240  # small motions decay with 5.9 1/s, to a thousandth
        after = cells().passage(start, turns * 2.0 * math.pi / omega, omega, 100 * turns).end
        whirl = cells().passage(after, 2.0 / stable.frequency_Hz, omega, 400)
        assert largest(whirl.displacements)[0] == pytest.approx(expected, abs=5e-3)


def test_a_ring_that_stands_still_has_no_resting_position_under_a_weight() -> None:
    blocked = frbcli.load_case("floating-ring", ["bearing.ring.spin=blocked"])
    with pytest.raises(frbcli.InputError, match="outer film carries no weight"):
        check(blocked, shooting=True)


@pytest.mark.nightly  # 15 s; in films that are tabulated: test_limit_cycles.py
def test_a_cycle_of_a_cartridge_closes_in_the_time_loop_by_its_gyroscopic_moments() -> None:
    """Over three periods with steps a quarter as long; without the moments of the ring it misses its start by more."""
    case = frbcli.load_case("turbocharger-car-cartridge", [
        'bearing.inner.supply={kind="circumferential-groove", pressure="3 bar"}', "bearing.ring.inertia=4 kg*mm^2",
        "bearing.ring.tilt_inertia=4 kg*mm^2", "rotor.cutoff=3 kHz", "rotor.gravity=100 m/s^2",
        "film.cavitation=reynolds", "accuracy.mesh=[3, 24]",
    ])  # fmt: skip
    assert not faults(case, SPEED_CYCLES)
    flow, omega = period_map(case), 2.0 * math.pi * 243.5
    shooting = Shooting(flow, omega)
    rest = settled(shooting, omega)
    assert rest is not None
    shot = shooting.from_rest(rest, rest.whirls[0], 0.1)
    assert shot is not None
    period, speed = math.exp(shot.p[0]) / omega, math.exp(shot.p[1]) * omega
    rotor = flow.system.rotor
    without = replace(rotor, cones=tuple((spin, 0.0 * cone) for spin, cone in rotor.cones))
    missed = []
    for each in (flow, replace(flow, system=replace(flow.system, rotor=without))):
        after = each.passage(shot.wet, 3.0 * period, speed, 12 * shot.steps).displacements
        missed.append(float(np.abs(after[-1] - shot.displacements[0]).max()))
    assert missed[0] < 2e-5
    assert missed[1] > 4.0 * missed[0]


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
    for name, expected in zip(("inner", "outer"), cycle.eccentricity_max, strict=True):
        assert run[f"eccentricity_{name}"][late].max() == pytest.approx(expected, rel=1e-3)
    x = run["journal_x_m"][late] - run["journal_x_m"][late].mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossings = up - x[up] / (x[up + 1] - x[up])
    assert 1.0 / (5e-5 * np.diff(crossings).mean()) == pytest.approx(cycle.frequency_Hz, rel=1e-3)
    share, ring = run["asperity_share_outer"][late], run["ring_speed_Hz"][late]
    assert share.min() < 0.01
    assert share.max() > 0.8
    assert 0.005 < np.ptp(ring) / ring.mean() < 0.02
