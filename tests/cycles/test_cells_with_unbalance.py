"""Motions with the unbalance in films on cells: synchronous, and whirls that have locked in.

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
from frbcli.cycles.columns import CycleBranch, CyclePoint
from frbcli.cycles.shooting.diagram import _locking, whirls_of_branch
from frbcli.cycles.shooting.period_map import SAMPLES, Passage, PeriodMap, Wet, period_map, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, Shot, largest

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


@dataclass(frozen=True)
class Carried(KnownFlow):
    """A whirl with nu = 0.49 Omega on a circle of the radius 0.5, on which disturbances of the radius decay with 2 and
    those of two further numbers with `decay`, on a centre that the unbalance carries around on a circle of 0.1."""

    decay: float = 0.3

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z, growth = complex(*wet.q) - 0.1 * self.driven, np.exp(2.0 * t)
        size = np.sqrt(growth / (1.0 + 4.0 * abs(z) ** 2 * (growth - 1.0)))
        moved = z * size * np.exp(0.49j * omega * t) + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        end = np.concatenate([places[-1], np.exp(-self.decay * time) * wet.v])
        return Passage(replace(wet, q=end[:2], v=end[2:]), places[:, None])


def one_cycle(flow: KnownFlow) -> tuple[Shooting, CycleBranch, Shot]:
    """The whirl of a known flow as a branch of one stable cycle behind a resting position."""
    free, wet = Shooting(flow, 2.0), flow.wet(np.array([0.5, 0.0, 0.0, 0.0]), 2.0)  # type: ignore[arg-type]
    p = np.array([math.log(2.0 * math.pi / 0.49), 0.0])
    shot = free._near(wet, p, np.zeros(6), 200)
    rest = CyclePoint(
        value=0.3, speed_Hz=0.3, frequency_Hz=0.49 / math.pi, eccentricity_max=np.zeros(1), ring_speeds_Hz=np.zeros(0),
        torque_N_m=0.0, stable=False, multipliers=np.ones(1, dtype=complex),
        harmonics=np.zeros((1, 1, 2), dtype=complex),
    )  # fmt: skip
    branch = CycleBranch(0, (rest, replace(rest, speed_Hz=1.0 / math.pi, stable=True)), "It leaves the range.")
    return free, branch, shot


def test_a_whirl_that_does_not_lock_in_says_what_a_run_does() -> None:
    free, branch, shot = one_cycle(Carried(lambda z, _: z, held=np.zeros(1)))
    found = whirls_of_branch(free, branch, [shot], 1.0, None)
    assert found.note == branch.note
    assert not found.with_unbalance
    (missing,) = found.missing
    assert missing.speed_Hz == pytest.approx(1.0 / math.pi)
    assert missing.reason == "a run from the cycle whirls on with 0.156 Hz and an eccentricity of 0.600"


@dataclass(frozen=True)
class Decaying(Carried):
    """The same without a whirl: what is off the circle of the unbalance decays, or, without it, stays."""

    def passage(self, wet: Wet, time: float, omega: float, _: int, samples: int = SAMPLES) -> Passage:
        t = np.linspace(0.0, time, samples + 1)
        z = (complex(*wet.q) - 0.1 * self.driven) * np.exp((0.49j * omega - 0.2 * self.driven) * t)
        moved = z + 0.1 * self.driven * np.exp(1j * omega * t)
        places = np.column_stack([moved.real, moved.imag])
        return Passage(replace(wet, q=places[-1], v=np.exp(-self.decay * time) * wet.v), places[:, None])


def test_a_speed_at_which_the_whirl_decays_says_so() -> None:
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


POCKET = 'bearing.supply={kind="pocket",position="0 deg",opening_angle="60 deg",width="10 mm",pressure="2 bar"}'
GROOVE = 'bearing.inner.supply={kind="circumferential-groove",pressure="2 bar"}'
SHAKEN, CELLS = "rotor.unbalance=20 g*mm", "accuracy.mesh=[4,24]"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("case", "speed_Hz"),
    [
        (frbcli.load_case("jeffcott", [SHAKEN, CELLS, POCKET, "film.cavitation=reynolds"]), 110.0),
        (rigid_shaft(CELLS, "film.tilt=follows", "disk.0.position=12 mm"), 150.0),
        (
            frbcli.load_case(
                "floating-ring", [SHAKEN, "accuracy.mesh=[5,32]", GROOVE, "film.cavitation=two-phase"]
            ),
            55.0,
        ),
    ],
    ids=("pocket", "tilt", "ring and oil"),
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


@pytest.mark.nightly
def test_a_whirl_that_locks_in_is_what_the_time_loop_ends_in_with_oil_that_films_keep() -> None:
    free, shot = whirling("rigid-two-phase", 82.0, 300, 'bearing.supply.pressure="2 bar"', "rotor.unbalance=10 g*mm")
    omega = 2.0 * math.pi * 82.0
    _, found = _locking(free.with_all_unbalance, shot.wet, omega)
    assert found is not None
    _, orbit = after(free.with_all_unbalance, found.wet, omega, 150, 2)
    np.testing.assert_allclose(largest(orbit), found.eccentricity_max, atol=1e-6)
