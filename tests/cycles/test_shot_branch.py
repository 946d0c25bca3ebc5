"""Branches of cycles by shooting, on motions whose cycles are known; curves that are followed through folds, and
multipliers of cycles."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from cycle_machines import CLEARANCE, GRAVITY, MASS, UNIT_Hz, diagram, machine_of, rigid
from known_flows import KnownFlow, round_cycles
from marches import planned_system
from numba import njit

from frbcli.cycles.method.balance import multipliers, packed, state_space
from frbcli.cycles.method.continuation import Place, Strides, corrected, fold_between, follow, step_from
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.machine import smooth_films
from frbcli.cycles.shooting.branch import OtherCells, follow_shots, shot_errors
from frbcli.cycles.shooting.fixed_point import SlowSpace
from frbcli.cycles.shooting.rest import RestThreshold, located, thresholds
from frbcli.cycles.shooting.shots import AT_REST_DIFFERENCE, Shooting, Shot, multipliers_of
from frbcli.film.rectangles.film_force import film_force


def started(shooting: Shooting, flow: KnownFlow, begun: tuple[float, float]) -> tuple[RestThreshold, Shot]:
    """The Hopf point between two speeds and the first cycle beside it."""
    rests = [shooting.rest(flow.wet(np.zeros(4), speed), speed) for speed in begun]
    assert rests[0] is not None
    assert rests[1] is not None
    hopf = located(shooting, rests[0], rests[1])
    first = shooting.from_rest(hopf.rest, hopf.number, 0.1)
    assert first is not None
    return hopf, first


def branch(
    flow: KnownFlow, low: float, high: float, begun: tuple[float, float]
) -> tuple[RestThreshold, tuple[Shot, ...]]:
    """The Hopf point between two speeds and the cycles that begin there."""
    shooting = Shooting(flow, high)  # type: ignore[arg-type]
    hopf, first = started(shooting, flow, begun)
    shots, note = follow_shots(shooting, first, (low, high))
    assert note == "It leaves the range."
    return hopf, shots


@pytest.mark.parametrize(
    ("twisted", "kind", "unstable"), [(True, "flip", 1), (False, "torus", 2)], ids=["flip", "torus"]
)
def test_flips_and_torus_points_are_named_and_located(twisted: bool, kind: str, unstable: int) -> None:
    """They lie at the speed 1.3. A multiplier counts from 1.005 on, that is from 1.3005, known to 1 / 64 of a step."""

    def decay(speed: float) -> tuple[float, float]:
        return speed - 1.3, -0.4 if twisted else speed - 1.3

    hopf, shots = branch(round_cycles(decay, 0.3, twisted), 0.9, 1.5, (0.9, 1.1))
    assert hopf.rest.omega == pytest.approx(1.0 + 4.0 * AT_REST_DIFFERENCE**2, abs=2e-4)  # of differences of a cubic
    assert abs(hopf.rest.omega - 1.0) < 1.1 * hopf.uncertainty < 2e-3
    (special,) = [shot for shot in shots if shot.kind]
    assert special.kind == kind
    assert 1.5 * math.exp(special.p[1]) == pytest.approx(1.3005, abs=2e-3)
    for shot in shots:
        speed = 1.5 * math.exp(shot.p[1])
        assert shot.eccentricity_max[0] == pytest.approx(0.5 * math.sqrt(speed - 1.0), rel=1e-6)
        period = 4.0 * math.pi / speed
        turns = math.pi if twisted else 0.3 * 2.0 * math.pi
        expected = np.exp((speed - 1.3) * period + 1j * turns)
        assert np.abs(shot.multipliers.others - expected).min() < 2e-3 * abs(expected)
        assert shot.multipliers.unstable == (unstable if abs(expected) > 1.005 else 0)


def test_a_speed_asked_for_in_the_last_step_has_its_cycle() -> None:
    """At 1.499 of a range to 1.5, which the last step leaves: the amplitude there is 0.5 sqrt(speed - 1)."""
    flow = round_cycles(lambda _: (-0.2, -0.4), 0.3, True)
    shooting = Shooting(flow, 1.5)  # type: ignore[arg-type]
    _, first = started(shooting, flow, (0.9, 1.1))
    shots, note = follow_shots(shooting, first, (0.9, 1.5), [1.499])
    assert note == "It leaves the range."
    (asked,) = [shot for shot in shots if shot.kind == "asked"]
    assert shots[-2] is asked
    assert 1.5 * math.exp(asked.p[1]) == pytest.approx(1.499, rel=1e-9)
    assert asked.eccentricity_max[0] == pytest.approx(0.5 * math.sqrt(0.499), rel=1e-6)


def test_a_whirl_that_begins_beside_another_has_its_hopf_point() -> None:
    """The second motion grows from the speed 1.3 on, the first from 1 on."""
    flow = round_cycles(lambda speed: (speed - 1.3, speed - 1.3), 0.3, False)
    shooting = Shooting(flow, 1.5)  # type: ignore[arg-type]
    rests = [shooting.rest(flow.wet(np.zeros(4), speed), speed) for speed in (1.15, 1.4)]
    (found,) = thresholds(shooting, [rest for rest in rests if rest is not None])
    assert found.rest.omega == pytest.approx(1.3, rel=1e-5)
    assert found.rest.eigenvalues[found.number].imag == pytest.approx(0.3 * 0.5 * 1.3, rel=1e-5)
    assert found.uncertainty < 1e-5


@njit
def rigid_rate(film: Any, z: np.ndarray, omega: float) -> np.ndarray:
    x, y, u, v = z / CLEARANCE
    force = film_force(film, x, y, u, v, omega)
    return np.array([z[2], z[3], 2.0 * force[0] / MASS - GRAVITY, 2.0 * force[1] / MASS])


@njit
def rigid_after(film: Any, z: np.ndarray, omega: float, h: float, count: int) -> np.ndarray:
    for _ in range(count):
        a = rigid_rate(film, z, omega)
        b = rigid_rate(film, z + 0.5 * h * a, omega)
        c = rigid_rate(film, z + 0.5 * h * b, omega)
        z = z + h / 6.0 * (a + 2.0 * (b + c) + rigid_rate(film, z + h * c, omega))
    return z


def rigid_flow(gamma: float) -> KnownFlow:
    """The rigid rotor in short bearings, integrated in time. Its damping is large for the steps that shooting asks
    for: with 256 in a period the cycle with an eccentricity of 0.81 was found at 0.75."""
    case = rigid(gamma, 2.4, 2.9)
    (film,) = smooth_films(planned_system(case))
    return KnownFlow(
        lambda z, omega: rigid_rate(film, z, omega),
        CLEARANCE,
        lambda z, omega, h, count: rigid_after(film, z, omega, h / 4.0, 4 * count),
    )


@cache
def rigid_branch() -> tuple[RestThreshold, tuple[Shot, ...]]:
    """The branch of the rigid rotor with Gamma = 4.538."""
    unit = 2.0 * math.pi * UNIT_Hz
    return branch(rigid_flow(4.538), 2.4 * unit, 2.75 * unit, (2.65 * unit, 2.8 * unit))


def test_the_error_of_a_fold_is_a_share_of_the_difference_to_other_films() -> None:
    """Films of another Gamma stand for other cells; both folds are those of the harmonic balance. Where the
    other fold lies along the branch is known from both neighbours, a tenth away, alone."""
    share, other_gamma, unit = 1.5, 4.4, 2.0 * math.pi * UNIT_Hz
    own, other = Shooting(rigid_flow(4.538), 2.75 * unit), Shooting(rigid_flow(other_gamma), 2.75 * unit)  # type: ignore[arg-type]
    _, shots = rigid_branch()
    (bottom,) = [i for i, shot in enumerate(shots) if shot.kind == "fold"]
    _, fold, _ = shot_errors(own, OtherCells(other, (0, 0), share), shots[bottom - 1 : bottom + 2])
    (here,), (there,) = (diagram(gamma, 2.4, 2.9).of("fold") for gamma in (4.538, other_gamma))
    assert fold.value == pytest.approx(share * abs(math.log(here.speed_Hz / there.speed_Hz)), rel=0.05)
    off = share * abs(here.eccentricity_max[0] - there.eccentricity_max[0])
    assert fold.eccentricity[0] == pytest.approx(off, rel=0.1)


def test_the_fold_is_that_of_the_harmonic_balance() -> None:
    """Rigid rotor in short bearings, Gamma = 4.538, integrated in time: Hopf point, fold, the stability on both sides
    of it, and the large cycle at the end of the range."""
    unit = 2.0 * math.pi * UNIT_Hz
    known = diagram(4.538, 2.4, 2.9)
    (threshold,), (known_fold,) = known.of("hopf"), known.of("fold")
    hopf, shots = rigid_branch()
    assert hopf.rest.omega / unit == pytest.approx(threshold.speed_Hz / UNIT_Hz, rel=1e-4)
    (bottom,) = [i for i, shot in enumerate(shots) if shot.kind == "fold"]
    fold = shots[bottom]
    assert 2.75 * math.exp(fold.p[1]) == pytest.approx(known_fold.speed_Hz / UNIT_Hz, rel=1e-5)
    assert fold.eccentricity_max[0] == pytest.approx(known_fold.eccentricity_max[0], abs=2e-4)
    assert not any(shot.multipliers.stable for shot in shots[1 : bottom - 1])
    assert all(shot.multipliers.stable for shot in shots[bottom + 2 :])
    (balanced,) = known.branches
    large = [point for point in balanced.points if point.stable]
    end = np.interp(2.75 * UNIT_Hz, [p.speed_Hz for p in large], [p.eccentricity_max[0] for p in large])
    assert 2.75 * math.exp(shots[-1].p[1]) == pytest.approx(2.75)
    assert shots[-1].eccentricity_max[0] == pytest.approx(end, abs=2e-4)


def test_a_multiplier_beside_the_trivial_one_is_told_by_the_sum_of_both() -> None:
    """1 and 1.03 with one disturbance for both but for 0.02: an error of 2e-3 in the matrix makes a pair of them."""
    exact = np.array([[1.0, 1.0, 0.0], [0.0, 1.03, 0.0], [0.0, 0.0, 0.5]])
    wrong = exact + 2e-3 * np.array([[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert np.abs(np.linalg.eigvals(wrong).imag).max() > 0.03
    for matrix in (exact, wrong):
        found = multipliers_of(SlowSpace(np.eye(3), matrix, np.zeros((3, 2))), np.array([1.0, 0.0, 0.0]))
        np.testing.assert_allclose(found.values, [1.0, 1.03, 0.5], atol=1e-9)
        assert found.unstable == 1


def test_a_curve_is_followed_through_its_fold() -> None:
    """x^2 + p^2 = 1 from (1, 0): p has its largest value 1 at x = 0, and the curve comes back."""

    def circle(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.array([y @ y - 1.0]), 2.0 * y[None]

    start = Place(np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    steps = list(follow(circle, start, Strides(0.05, 1e-6, 0.2, 60)))
    assert max(abs(place.y @ place.y - 1.0) for place, _ in steps) < 1e-12
    assert min(place.y[0] for place, _ in steps) < -0.9
    before = start
    for place, length in steps:
        if before.tangent[-1] * place.tangent[-1] < 0.0:
            fold = fold_between(circle, before, length)
            assert fold is not None
            np.testing.assert_allclose(fold.y, [0.0, 1.0], atol=1e-8)
            break
        before = place
    else:
        pytest.fail("no fold on the way")


def test_a_step_does_not_change_to_a_part_of_the_curve_that_passes_close_by() -> None:
    """Two straight lines p = x and p = x + 0.02: a guess that is nearer to the other one is not taken for it."""

    def lines(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        a = y[1] - y[0]
        return np.array([a * (a - 0.02)]), np.array([[-(2.0 * a - 0.02), 2.0 * a - 0.02]])

    start = corrected(lines, np.array([0.0, 0.0]), np.array([0.6, 0.8]))
    assert start is not None
    astray = Place(start.y, np.array([0.0, 1.0]), side=start.side)
    assert step_from(lines, astray, 0.03) is None
    assert step_from(lines, start, 0.03) is not None


def test_multipliers_next_to_rest_are_those_of_the_eigenvalues() -> None:
    """A cycle of almost no size: exp(lambda T) of the eigenvalues at the Hopf point, 1 for the critical pair."""
    case = rigid(1.313, 2.4, 2.9)
    machine = machine_of(case)
    system = planned_system(case)
    (hopf,) = resting_curve(system, machine, 2.0 * math.pi * case.speed.start, 2.0 * math.pi * case.speed.end).hopf
    motion = np.zeros((3, 2), dtype=complex)
    motion[0], motion[1] = hopf.equilibrium.u, 1e-7 * hopf.mode
    y = np.concatenate([packed(motion), [hopf.nu / machine.pace, hopf.equilibrium.omega / machine.pace]])
    found = np.sort(np.abs(multipliers(machine, state_space(machine), y).values))
    expected = np.sort(np.abs(np.exp(2.0 * math.pi / hopf.nu * hopf.equilibrium.eigenvalues)))
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("gamma", [4.538, 1.313])
def test_the_trivial_multiplier_is_one(gamma: float) -> None:
    """To 1e-6, at folds as well, where a second multiplier is 1."""
    points = diagram(gamma, 2.4, 2.9).branches[0].points
    for point in points:
        assert abs(point.multipliers[0] - 1.0) < 1e-6
        if point.kind == "fold":
            assert np.abs(point.multipliers[1:] - 1.0).min() < 1e-5
    assert any(point.kind == "fold" for point in points)
