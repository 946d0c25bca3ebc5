"""Motions with the unbalance in films on cells: synchronous, of two frequencies, and such as have locked in.

The answers are those of the time loop, which the motions come back to, and of the machine without unbalance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest
from known_flows import KnownFlow
from marches import rigid_shaft

import frbcli
from frbcli.case.schema import Case
from frbcli.cycles.result import CycleBranch, CyclePoint
from frbcli.cycles.shooting.invariant_curve import (
    TAIL,
    InvariantCurve,
    along_cycle,
    between,
    combined,
    invariant_curve,
)
from frbcli.cycles.shooting.period_map import SAMPLES, Passage, PeriodMap, Wet, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, Shot, largest
from frbcli.cycles.shooting.whirls import _locking, whirls_of_branch

OMEGA = 2.0 * math.pi * 120.0
TURNS = 60


@lru_cache
def rigid(unbalance: str = "30 g*mm") -> PeriodMap:
    return period_map(frbcli.load_case("rigid", ["film.cavitation=reynolds", f"rotor.unbalance={unbalance}"]))


def after(shooting: Shooting, wet: Wet, omega: float, turns: int, periods: int = 1) -> tuple[Wet, np.ndarray]:
    """The machine after so many times of some periods of the rotor, and the orbit of the last."""
    for _ in range(turns):
        passage = shooting.flow.passage(wet, 2.0 * math.pi * periods / omega, omega, 100 * periods)
        wet = passage.end
    return wet, passage.displacements


def test_a_synchronous_motion_is_what_the_time_loop_ends_in() -> None:
    free = Shooting(rigid(), OMEGA)
    rest = settled(free, OMEGA)
    assert rest is not None
    assert rest.stable
    shot = free.with_all_unbalance.with_unbalance(rest)
    assert shot is not None
    assert shot.multipliers.stable
    assert math.exp(shot.p.sum()) == pytest.approx(2.0 * math.pi, rel=1e-9)
    assert np.abs(shot.multipliers.others[0]) ** TURNS < 1e-3
    _, orbit = after(free.with_all_unbalance, rest.wet, OMEGA, TURNS)
    assert largest(orbit)[0] > largest(rest.displacement[None] * np.ones((3, 1, 1)))[0] + 0.01
    np.testing.assert_allclose(shot.eccentricity_max, largest(orbit), atol=1e-5)


def test_little_unbalance_leaves_the_multipliers_of_the_resting_position() -> None:
    free = Shooting(rigid(), OMEGA)
    rest = settled(free, OMEGA)
    assert rest is not None
    shot = Shooting(replace(rigid(), driven=0.01), OMEGA).with_unbalance(rest)
    assert shot is not None
    sizes = np.exp(np.sort(rest.eigenvalues.real)[::-1] * 2.0 * math.pi / OMEGA)
    np.testing.assert_allclose(np.abs(shot.multipliers.others)[:2], sizes[:2], atol=5e-3)


def test_a_curve_between_its_points_is_a_trigonometric_polynomial() -> None:
    phases, others = 2.0 * math.pi * np.arange(9) / 9, np.array([0.3, 2.0, 5.1])
    values = 0.5 + np.cos(4.0 * phases) - 2.0 * np.sin(phases)
    np.testing.assert_allclose(
        between(9, others) @ values, 0.5 + np.cos(4.0 * others) - 2.0 * np.sin(others), atol=1e-13
    )
    np.testing.assert_allclose(
        between(9, others, slope=True) @ values, -4.0 * np.sin(4.0 * others) - 2.0 * np.cos(others), atol=1e-13
    )


def test_corrections_that_go_astray_are_combined_to_those_that_do_not() -> None:
    """x = b + A x in three unknowns, which repetition does not find: it grows by 3 in each step."""
    matrix = np.array([[3.0, 0.4, 0.0], [0.0, -2.0, 0.1], [0.2, 0.0, 0.5]])
    right, x, known = np.array([1.0, 2.0, 3.0]), np.zeros(3), []
    for _ in range(4):
        known.append((x, right + matrix @ x - x))
        x = combined(known)
    np.testing.assert_allclose(x, np.linalg.solve(np.eye(3) - matrix, right), rtol=1e-9)


def test_the_lines_of_a_motion_of_two_frequencies() -> None:
    """x = 0.1 + 0.6 cos a + 0.2 cos(b - a), y = 0.6 sin a at nu = 0.47 Omega."""
    rho, a0, b = 0.47, 2.0 * math.pi * np.arange(33)[:, None] / 33, 2.0 * math.pi * np.arange(SAMPLES + 1) / SAMPLES
    a = a0 + rho * b
    orbit = np.stack([0.1 + 0.6 * np.cos(a) + 0.2 * np.cos(b - a), 0.6 * np.sin(a)], axis=-1)[:, :, None]
    curve = InvariantCurve((), np.zeros((33, 1)), rho, 1.0, orbit, np.ones(1))
    orders, found = curve.harmonics(orbit)
    by_order = {(int(j), int(k)): u[0] for (j, k), u in zip(orders, found, strict=True)}
    np.testing.assert_allclose(by_order.pop((0, 0)), [0.1, 0.0], atol=1e-12)
    np.testing.assert_allclose(by_order.pop((1, 0)), [0.3, -0.3j], atol=1e-12)
    np.testing.assert_allclose(by_order.pop((-1, 1)), [0.1, 0.0], atol=1e-12)
    assert max(np.abs(u).max() for u in by_order.values()) < 1e-12
    assert curve.largest[0] == pytest.approx(0.9, abs=2e-3)


@dataclass(frozen=True)
class Carried(KnownFlow):
    """A whirl with nu = 0.47 Omega on a circle of the radius 0.5, on which disturbances of the radius decay with 2 and
    those of two further numbers with `decay`, on a centre that the unbalance carries around on a circle of 0.1."""

    decay: float = 0.3

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z, growth = complex(*wet.q) - 0.1 * self.driven, np.exp(2.0 * t)
        size = np.sqrt(growth / (1.0 + 4.0 * abs(z) ** 2 * (growth - 1.0)))
        moved = z * size * np.exp(0.47j * omega * t) + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        end = np.concatenate([places[-1], np.exp(-self.decay * time) * wet.v])
        return Passage(replace(wet, q=end[:2], v=end[2:]), places[:, None])


@pytest.mark.parametrize(("decay", "stable"), [pytest.param(0.3, True, marks=pytest.mark.nightly), (-0.3, False)])
def test_a_carried_whirl_is_found_with_its_exponents(decay: float, stable: bool) -> None:
    """From the whirl without unbalance, whose points lie on a circle, too."""
    flow = Carried(lambda z, _: z, driven=1.0, decay=decay, held=np.zeros(1))
    circle = 0.5 * np.exp(2j * np.pi * np.arange(33) / 33)
    wets = tuple(flow.wet(np.array([z.real, z.imag, 0.0, 0.0]), 2.0) for z in circle)
    curve = invariant_curve(flow, 2.0, 2.0, (wets, 0.45))  # type: ignore[arg-type]
    assert curve is not None
    assert curve.rho == pytest.approx(0.47, abs=1e-7)
    assert curve.largest[0] == pytest.approx(0.6, abs=1e-4)
    for rate in (0.0, 2.0, decay):
        assert np.abs(curve.radii - math.exp(-rate * math.pi)).min() < 1e-3
    assert curve.radii[0] == pytest.approx(math.exp(max(-decay, 0.0) * math.pi), abs=1e-3)
    assert curve.stable is stable


def one_cycle(flow: KnownFlow) -> tuple[Shooting, CycleBranch, Shot]:
    """The whirl of a known flow as a branch of one stable cycle behind a resting position."""
    free, wet = Shooting(flow, 2.0), flow.wet(np.array([0.5, 0.0, 0.0, 0.0]), 2.0)  # type: ignore[arg-type]
    p = np.array([math.log(2.0 * math.pi / 0.47), 0.0])
    shot = free._near(wet, p, np.zeros(6), 200)
    rest = CyclePoint(
        value=0.3, speed_Hz=0.3, frequency_Hz=0.15, eccentricity_max=np.zeros(1), ring_speeds_Hz=np.zeros(0),
        torque_N_m=0.0, stable=False, multipliers=np.ones(1, dtype=complex),
        harmonics=np.zeros((1, 1, 2), dtype=complex),
    )  # fmt: skip
    branch = CycleBranch(0, (rest, replace(rest, speed_Hz=1.0 / math.pi, stable=True)), "It leaves the range.")
    return free, branch, shot


def test_a_cycle_of_a_branch_becomes_a_whirl_with_its_lines() -> None:
    free, branch, shot = one_cycle(Carried(lambda z, _: z, held=np.zeros(1)))
    found = whirls_of_branch(free, branch, [shot], 1.0, None)
    assert found.note == branch.note
    assert not found.missing
    (whirl,) = found.with_unbalance
    assert (whirl.locked, whirl.stable) == (False, True)
    assert whirl.speed_Hz == pytest.approx(1.0 / math.pi)
    assert whirl.frequency_Hz == pytest.approx(0.47 / math.pi, rel=1e-6)
    assert [line.name for line in whirl.lines] == ["nu", "Omega"]
    np.testing.assert_allclose([line.amplitude[0] for line in whirl.lines], [0.5, 0.1], atol=1e-6)


@dataclass(frozen=True)
class Decaying(Carried):
    """The same without a whirl: what is off the circle of the unbalance decays, or, without it, stays."""

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z = (complex(*wet.q) - 0.1 * self.driven) * np.exp((0.47j * omega - 0.2 * self.driven) * t)
        moved = z + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        return Passage(replace(wet, q=places[-1]), places[:, None])


def test_a_speed_at_which_the_whirl_decays_says_so() -> None:
    """The curve shrinks to a point, of which no phase can be told."""
    free, branch, shot = one_cycle(Decaying(lambda z, _: z, held=np.zeros(1)))
    (missing,) = whirls_of_branch(free, branch, [shot], 1.0, None).missing
    assert missing.speed_Hz == pytest.approx(1.0 / math.pi)
    assert missing.reason == "a run from the cycle comes back to the synchronous motion"


def whirling(name: str, speed_Hz: float, turns: int, *settings: str) -> tuple[Shooting, Shot]:
    """A cycle without unbalance that the time loop goes to from a large whirl."""
    flow, omega = period_map(frbcli.load_case(name, settings)), 2.0 * math.pi * speed_Hz
    free = Shooting(flow, omega)
    rest = settled(free, omega)
    assert rest is not None
    seen, middle = flow.journals[0], flow.scale * np.array([0.85, 0.0])
    q = rest.wet.q + np.linalg.lstsq(seen, middle - seen @ rest.wet.q, rcond=None)[0]
    v = np.linalg.lstsq(seen, 0.5 * omega * middle[::-1], rcond=None)[0]
    wet, _ = after(free, wet_at(flow, q, v, omega), omega, turns)
    passage = flow.passage(wet, 60.0 * 2.0 * math.pi / omega, omega, 6000, 6000)
    d = passage.displacements[:, 0] - passage.displacements[:, 0].mean(axis=0)
    turned = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
    p = np.array([math.log(2.0 * math.pi * 60.0 * 2.0 * math.pi / (turned[-1] - turned[0])), 0.0])
    return free, replace(free._near(passage.end, p, np.zeros(len(rest.x) + 2), 200))


SLOT = 'bearing.supply={kind="axial-slots",position="0 deg",opening_angle="20 deg",length="12 mm",pressure="2 bar"}'
POCKET = 'bearing.supply={kind="pocket",position="0 deg",opening_angle="60 deg",width="10 mm",pressure="2 bar"}'
GROOVE = 'bearing.inner.supply={kind="circumferential-groove",pressure="2 bar"}'
SHAKEN, CELLS = "rotor.unbalance=20 g*mm", "accuracy.mesh=[4,24]"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("case", "speed_Hz"),
    [
        (frbcli.load_case("jeffcott", [SHAKEN, CELLS, POCKET, "film.cavitation=reynolds"]), 110.0),
        (frbcli.load_case("jeffcott", [SHAKEN, CELLS, SLOT, "film.cavitation=elrod"]), 110.0),
        (frbcli.load_case("jeffcott", [SHAKEN, CELLS, SLOT, "film.cavitation=penalty"]), 110.0),
        (rigid_shaft(CELLS, "film.tilt=follows", "disk.0.position=12 mm"), 150.0),
        (frbcli.load_case("floating-ring", [SHAKEN, CELLS, GROOVE, "film.cavitation=reynolds"]), 50.0),
        (
            frbcli.load_case(
                "floating-ring", [SHAKEN, "accuracy.mesh=[5,32]", GROOVE, "film.cavitation=two-phase"]
            ),
            55.0,
        ),
    ],
    ids=("pocket", "slot and oil", "slot and penalty", "tilt", "ring", "ring and oil"),
)  # fmt: skip
def test_synchronous_motions_of_all_films_are_what_the_time_loop_ends_in(case: Case, speed_Hz: float) -> None:
    flow, omega = period_map(case), 2.0 * math.pi * speed_Hz
    free = Shooting(flow, omega)
    rest = settled(free, omega)
    assert rest is not None
    shot = free.with_all_unbalance.with_unbalance(rest)
    assert shot is not None
    assert shot.multipliers.stable
    _, orbit = after(free.with_all_unbalance, rest.wet, omega, 160)
    assert np.abs(shot.eccentricity_max - np.hypot(*rest.displacement.T)).max() > 0.01
    np.testing.assert_allclose(largest(orbit), shot.eccentricity_max, atol=1e-6)


HEAVY = (
    "rotor.mass=30 kg",
    "rotor.unbalance=2 g*mm",
    'bearing.supply.pressure="2 bar"',
    "accuracy.mesh=[4,24]",
)  # a whirl of 0.496 of the speed, far enough from half of it for a small unbalance not to lock it in


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("name", "speed_Hz", "settings"),
    [
        ("jeffcott", 185.0, ("film.cavitation=reynolds", "rotor.unbalance=0.3 g*mm")),
        ("rigid-two-phase", 175.0, ("film.cavitation=elrod", *HEAVY)),
        ("rigid-two-phase", 175.0, HEAVY),
    ],
    ids=("reynolds", "elrod", "two-phase"),
)
def test_a_whirl_of_two_frequencies_is_what_the_time_loop_stays_on(
    name: str, speed_Hz: float, settings: tuple[str, ...]
) -> None:
    """The run is on the torus from its start, and sees all of it within a beat, of 4.7 and of 0.7 s."""
    free, shot = whirling(name, speed_Hz, 300, *settings)
    driven, omega = free.with_all_unbalance, 2.0 * math.pi * speed_Hz
    curve = invariant_curve(driven.flow, omega, omega, along_cycle(free, shot))
    assert curve is not None
    assert curve.stable
    # A shift along the curve neither grows nor decays.
    assert curve.radii[0] == pytest.approx(1.0, abs=5e-3)
    wet, seen = curve.wets[0], []
    for _ in range(900):
        wet, orbit = after(driven, wet, omega, 1)
        seen.append(orbit[:-1, 0])
    d = np.concatenate(seen)
    # The last harmonics of a curve, of which a few add up, are smaller than TAIL.
    assert np.hypot(*d.T).max() == pytest.approx(curve.largest[0], abs=3.0 * TAIL)
    turned = np.unwrap(np.arctan2(*(d - d.mean(axis=0)).T[::-1]))
    assert (turned[-1] - turned[0]) / (2.0 * math.pi * 900.0) == pytest.approx(curve.rho, rel=1e-4)


@pytest.mark.nightly
def test_a_curve_without_unbalance_is_the_cycle() -> None:
    free, shot = whirling("jeffcott", 185.0, 1500, "film.cavitation=reynolds", "rotor.unbalance=0.3 g*mm")
    omega = 2.0 * math.pi * 185.0
    curve = invariant_curve(free.flow, omega, omega, along_cycle(free, shot))
    assert curve is not None
    _, orbit = after(free, shot.wet, omega, 1, 60)
    assert curve.rho == pytest.approx(math.exp(-shot.p[0]) * 2.0 * math.pi, rel=1e-5)
    assert curve.largest[0] == pytest.approx(float(np.hypot(*orbit[:, 0].T).max()), abs=2e-4)
    assert curve.radii[0] == pytest.approx(1.0, abs=5e-3)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("speed_Hz", "settings", "error"),
    [
        (82.0, ('bearing.supply.pressure="2 bar"', "rotor.unbalance=10 g*mm"), 1e-6),
        # It settles slowly, after 900 turns, and enlarges as much what Newton's method leaves.
        (171.5, ("film.cavitation=elrod", *HEAVY), 1e-4),
    ],
)
def test_a_whirl_that_locks_in_is_what_the_time_loop_ends_in_with_oil_that_films_keep(
    speed_Hz: float, settings: tuple[str, ...], error: float
) -> None:
    free, shot = whirling("rigid-two-phase", speed_Hz, 300, *settings)
    omega = 2.0 * math.pi * speed_Hz
    _, found = _locking(free.with_all_unbalance, shot.wet, omega)
    assert found is not None
    _, orbit = after(free.with_all_unbalance, found.wet, omega, 150, 2)
    np.testing.assert_allclose(largest(orbit), found.eccentricity_max, atol=error)
