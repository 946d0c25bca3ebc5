"""Limit cycles of films on cells that keep no oil and whose force has kinks, by shooting."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.optimize import brentq

import frbcli
from frbcli.cycles.columns import CyclePoint, LimitCycles
from frbcli.cycles.limit_cycles import check
from frbcli.cycles.shooting.period_map import PeriodMap, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, largest
from frbcli.equilibrium.resting import resting_position
from frbcli.linear.stability_point import critical_eigenvalue, eigenvalues
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
