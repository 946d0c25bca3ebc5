"""Branches of motions of two frequencies: folds, their stability, and what they are not computed of."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from cycle_machines import machine_of
from scipy.integrate import solve_ivp
from whirls_of_jeffcott import SHORT, harmonic, jeffcott

import frbcli
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.method.balance import unpacked
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.follower import FoldFollower
from frbcli.cycles.parts.linearised import state_space
from frbcli.cycles.parts.machine import Machine, film_loads
from frbcli.cycles.unbalance import two_frequencies
from frbcli.cycles.unbalance.growth import is_stable
from frbcli.cycles.unbalance.torus_branch import TorusBranch, TorusFollower, TorusPlace, follow_torus
from frbcli.cycles.unbalance.two_frequencies import Torus, of_cycle, samples, with_unbalance
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan


@pytest.fixture(scope="module")
def turned() -> tuple[TorusFollower, TorusPlace, TorusBranch, np.ndarray]:
    """The Jeffcott rotor in short films with little unbalance: a motion of two frequencies, the branch from there to
    lower speeds, and the cycle that the motion is next to."""
    case = jeffcott(0.1, SHORT, "speed.to=180.2 Hz")
    machine, speeds = machine_of(case), (2.0 * math.pi * 173.9, 2.0 * math.pi * 180.2)
    (hopf,) = resting_curve(make_system(case, make_plan(case)), machine, *speeds).hopf
    follower = FoldFollower(MachineCourse(machine), *(speed / machine.pace for speed in speeds))
    cycles = follow_branch(follower, first_place(hopf)).cycles
    turn = [cycle.kind for cycle in cycles].index("fold")
    cycle = min(cycles[turn:], key=lambda cycle: abs(cycle.y[-1] * machine.pace - 2.0 * math.pi * 176.0)).y
    nu, omega = cycle[-2:] * machine.pace
    torus = with_unbalance(machine, of_cycle(unpacked(cycle[:-2], machine.size), nu, omega))
    along = TorusFollower(MachineCourse(machine), speeds)
    start = along.start(torus, upwards=False)
    assert start is not None
    return along, start, follow_torus(along, start), cycle


def speed_of(follower: TorusFollower, place: TorusPlace) -> float:
    return float(place.place.y[-1]) * follower.pace / (2.0 * math.pi)


def test_motions_of_two_frequencies_turn_back_in_a_fold_and_end_at_the_synchronous_response(
    turned: tuple[TorusFollower, TorusPlace, TorusBranch, np.ndarray],
) -> None:
    """The fold has the same speed from both sides; with the square of the unbalance it comes from that of the cycles,
    174.0549 Hz; the whirl ends at the Hopf point, 179.8453 Hz, where the response without it becomes unstable."""
    follower, _, branch, _ = turned
    assert branch.note == "The whirl ends in the synchronous response."
    (at,) = [number for number, place in enumerate(branch.places) if place.kind == "fold"]
    behind = branch.places[at + 2]
    back = replace(behind, place=replace(behind.place, tangent=-behind.place.tangent, side=-behind.place.side))
    found = follow_torus(follower, back, lambda here, _: "fold" if here.place.tangent[-1] > 0.0 else "")
    (again,) = [place for place in found.places if place.kind == "fold"]
    assert speed_of(follower, again) == pytest.approx(speed_of(follower, branch.places[at]), rel=1e-8)
    assert speed_of(follower, again) == pytest.approx(174.0549, abs=2e-3)
    assert speed_of(follower, branch.places[-1]) == pytest.approx(179.8453, abs=0.1)


def behind_the_fold(turned: tuple[TorusFollower, TorusPlace, TorusBranch, np.ndarray]) -> Torus:
    """The first motion above 175 Hz on the part of the branch that rises in speed."""
    follower, _, branch, _ = turned
    place = next(place for place in branch.places if place.kind != "fold" and place.place.tangent[-1] > 0.0
                 and speed_of(follower, place) > 175.0)  # fmt: skip
    return follower.torus(place.orders, place.place.y)


def test_motions_behind_a_fold_are_unstable(
    turned: tuple[TorusFollower, TorusPlace, TorusBranch, np.ndarray],
) -> None:
    follower, start, _, cycle = turned
    before, behind = follower.torus(start.orders, start.place.y), behind_the_fold(turned)
    machine = follower.course.top
    assert is_stable(machine, state_space(machine), before, cycle)
    assert is_stable(machine, state_space(machine), behind, cycle) is False


@pytest.mark.nightly
def test_a_run_started_beside_an_unstable_motion_leaves_it_to_either_side(
    turned: tuple[TorusFollower, TorusPlace, TorusBranch, np.ndarray],
) -> None:
    """With 3 % more whirl to the large motion of the other part, with 3 % less to the synchronous one."""
    follower, start, _, _ = turned
    behind, large = behind_the_fold(turned), follower.torus(start.orders, start.place.y)
    machine = follower.course.top
    size, size_of_large = (np.abs(harmonic(torus, 1, 0)).max() for torus in (behind, large))
    on_it = samples(behind.orders, behind.motion, (128, 16))[0, 0]
    np.testing.assert_allclose(state_space(machine).read @ state_of(machine, behind, 1.0), on_it, atol=1e-6)
    more, less = (whirl_in_time(machine, behind, share) for share in (1.03, 0.97))
    assert more > 0.5 * (size + size_of_large)
    assert less < 0.5 * size


def driven_states(machine: Machine) -> tuple[np.ndarray, np.ndarray]:
    """(N,) what the static load, and exp(i Omega t) of the unbalance times Omega^2, add to the rate of the states."""
    n, inverse = machine.rotor.size, np.linalg.inv(machine.rotor.mass)
    still, turning = (np.zeros(2 * n, dtype=complex) for _ in range(2))
    still[n:], turning[n:] = inverse @ machine.rotor.static_load, inverse @ machine.rotor.unbalance
    return still.real, turning


def state_of(machine: Machine, torus: Torus, share: float) -> np.ndarray:
    """(N,) all states of a machine without rings at the time 0 of a motion, with a share of its whirl. Springs stand
    beside the films, without which the rotor is free."""
    space, (still, turning) = state_space(machine), driven_states(machine)
    u = samples(torus.orders, torus.motion, counts := two_frequencies.grid_of(torus.orders))
    v = samples(torus.orders, 1j * torus.frequencies[:, None] * torus.motion, counts)
    c = machine.size
    values = film_loads(machine, u.reshape(-1, c), v.reshape(-1, c), torus.omega).values
    loads = two_frequencies.harmonics(values.reshape(*counts, c), torus.orders)
    spring = np.repeat(machine.spring, 2)
    held = space.still + torus.omega * space.by_speed - space.given @ np.diag(spring) @ space.read
    start = np.zeros(len(held))
    for (j, k), frequency, load, own in zip(torus.orders, torus.frequencies, loads, torus.motion, strict=True):
        right = space.given @ (load + spring * own) + (still if (j, k) == (0, 0) else 0.0)
        right = right + (0.5 * torus.omega**2 * turning if (j, k) == (0, 1) else 0.0)
        state = np.linalg.solve(1j * frequency * np.eye(len(held)) - held, right)
        start += (share if j else 1.0) * (1.0 if (j, k) == (0, 0) else 2.0) * state.real
    return start


def whirl_in_time(machine: Machine, torus: Torus, share: float) -> float:
    """The amplitude of the whirl after 150 of its periods from a share of it, by the equations in time."""
    space, (still, turning), omega = state_space(machine), driven_states(machine), torus.omega
    linear = space.still + omega * space.by_speed

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        u = space.read @ x
        inside = u * min(1.0, 0.9999 / float(np.hypot(*u)))  # a trial step may leave the gap
        loads = film_loads(machine, inside[None], (space.read_rate @ x)[None], omega).values[0]
        return np.asarray(linear @ x + space.given @ loads + still + omega**2 * (turning * np.exp(1j * omega * t)).real)

    t = np.linspace(145.0, 150.0, 200) * 2.0 * math.pi / torus.nu
    start = state_of(machine, torus, share)
    found = solve_ivp(rate, (0.0, t[-1]), start, "LSODA", t_eval=t, rtol=1e-6, atol=1e-9)
    return float(0.5 * np.ptp(space.read @ found.y, axis=1).max())


@pytest.mark.parametrize(
    ("case", "problem"),
    [
        (lambda: jeffcott(0.0), "is zero"),
    ],
    ids=["none"],
)
def test_what_it_is_not_computed_of_is_refused(case, problem: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(frbcli.InputError, match=problem):
        frbcli.limit_cycles(case(), with_unbalance=True)
