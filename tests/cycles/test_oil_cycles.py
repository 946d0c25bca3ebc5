"""Limit cycles of films that keep their oil: the map of the time loop over a period, shooting, the command."""

import math
from functools import cache

import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.schema import Case
from frbcli.cycles.columns import LimitCycles
from frbcli.cycles.shooting.fixed_point import Conditions, SlowSpace, fixed_point, ritz, slow_space
from frbcli.cycles.shooting.period_map import SAMPLES, PeriodMap, Wet, period_map, turned_back, wet_at
from frbcli.cycles.shooting.rest import settled
from frbcli.cycles.shooting.shots import Shooting, largest
from frbcli.equilibrium.resting import resting_position
from frbcli.film.cells.film import Motion
from frbcli.film.cells.linearised import steady_solution
from frbcli.linear.stability import stability_points

FED = ('bearing.supply.pressure="2 bar"', "speed.from=74 Hz", "speed.to=84 Hz")


@cache
def diagram() -> LimitCycles:
    return frbcli.limit_cycles(frbcli.load_case("rigid-two-phase", FED), [82.0])


def test_a_field_is_seen_from_where_it_began() -> None:
    """cos(phi) and 2 on 64 cells, turned by 1.3 rad: cubics leave 2e-6."""
    phi = 2.0 * math.pi * np.arange(64) / 64
    field = np.column_stack([np.cos(phi), np.full(64, 2.0)])
    np.testing.assert_allclose(
        turned_back(field, 1.3), np.column_stack([np.cos(phi - 1.3), np.full(64, 2.0)]), atol=3e-6
    )
    np.testing.assert_allclose(turned_back(field, 2.0 * math.pi * 3 / 64), np.roll(field, 3, axis=0), atol=1e-14)


def test_slow_motions_of_a_map_are_solved_for_and_fast_ones_repeated() -> None:
    """x -> A x + B p + curvature in 60 unknowns, three slow eigenvalues, one of them growing, all in what the first two
    states are led to: the fixed point with x_0 given, and the eigenvalues."""
    random = np.random.default_rng(2)
    turn = np.linalg.qr(random.standard_normal((60, 60)))[0]
    decay = np.concatenate([[1.2, 0.95, 0.7], 0.05 * random.uniform(-1.0, 1.0, 57)])
    matrix, by_p = turn @ np.diag(decay) @ turn.T, random.standard_normal(60)

    def mapped(x: np.ndarray, p: np.ndarray) -> np.ndarray:
        return matrix @ x + by_p * p[0] + 0.1 * x**2

    first = turn[:, :3] @ random.standard_normal((3, 2)) + 0.01 * random.standard_normal((60, 2))
    x, p = np.zeros(60), np.zeros(1)
    space = slow_space(mapped, x, p, first)
    largest = np.sort(np.abs(ritz(space)[0]))[::-1]
    np.testing.assert_allclose(largest[:3], decay[:3], atol=1e-3)
    asked = np.zeros((1, 60))
    asked[0, 0] = 1.0
    guess = 0.01 * by_p
    found = fixed_point(mapped, guess, p, space, Conditions(asked, np.zeros((1, 1))))
    assert found is not None
    np.testing.assert_allclose(found.image, found.x, atol=1e-6)
    assert found.x[0] == pytest.approx(guess[0], abs=1e-6)
    assert abs(found.p[0]) > 1e-4


def test_slow_motions_that_the_space_misses_are_learned_of() -> None:
    """The same map with six slow motions, 0.9 to 0.99, of which the space knows two: repeated, they would need
    hundreds of evaluations."""
    random = np.random.default_rng(3)
    turn = np.linalg.qr(random.standard_normal((60, 60)))[0]
    decay = np.concatenate([np.linspace(0.99, 0.9, 6), 0.05 * random.uniform(-1.0, 1.0, 54)])
    matrix, by_p = turn @ np.diag(decay) @ turn.T, 1e-4 * random.standard_normal(60)
    calls = 0

    def mapped(x: np.ndarray, p: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return matrix @ x + by_p * (1.0 + p[0]) + 0.01 * x**2

    known = SlowSpace(turn[:, :2], matrix @ turn[:, :2], by_p[:, None])
    held = Conditions(np.zeros((1, 60)), np.ones((1, 1)))
    found = fixed_point(mapped, np.zeros(60), np.zeros(1), known, held)
    assert found is not None
    assert calls <= 25
    np.testing.assert_allclose(mapped(found.x, found.p), found.x, atol=1e-7)
    assert found.space.states.shape[1] > 2


def test_a_fixed_point_is_the_one_that_was_met_where_noise_begins() -> None:
    """x -> A x with noise of 1e-6, and of 3e-5 when the iteration asks whether corrections still become smaller."""
    matrix, calls = np.diag([0.9, 0.5, 0.0]), 0

    def mapped(x: np.ndarray, _: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return matrix @ x + (1e-6 if calls < 12 else 3e-5) * math.cos(calls) * np.array([0.0, 0.0, 1.0])

    space = SlowSpace(np.eye(3)[:, :2], matrix[:, :2], np.zeros((3, 0)))
    found = fixed_point(mapped, np.full(3, 0.1), np.zeros(0), space, Conditions(np.zeros((0, 3)), np.zeros((0, 0))))
    assert found is not None
    assert np.abs(found.x).max() < 3e-6
    assert calls >= 12


def after_transients(flow: PeriodMap, wet: Wet, period: float, omega: float, periods: int) -> tuple[np.ndarray, float]:
    """(F,) largest eccentricities, mean over the last third of so many periods without a break, with the steps that
    shooting takes, and the frequency there in Hz. The cells pass all places in some ten periods."""
    moved = flow.passage(wet, periods * period, omega, periods * 200, periods * SAMPLES).displacements
    late = moved[2 * len(moved) // 3 :]
    pieces = [late[i : i + SAMPLES + 1] for i in range(0, len(late) - SAMPLES, SAMPLES)]
    x = late[:, 0, 0] - late[:, 0, 0].mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    times = (up + x[up] / (x[up] - x[up + 1])) * period / SAMPLES
    return np.mean([largest(piece) for piece in pieces], axis=0), (len(times) - 1) / (times[-1] - times[0])


def check_time_loop_ends_in_the_cycle(found: LimitCycles, periods: int, atol: float, rtol: float = 1e-5) -> None:
    """The stable cycle at the speed asked for is what a run of so many periods has become, from 0.4 off rest on: its
    eccentricities to atol, its frequency to rtol."""
    (cycle,) = [point for branch in found.branches for point in branch.points if point.kind == "asked"]
    assert cycle.stable
    flow, omega = period_map(found.case), 2.0 * math.pi * cycle.speed_Hz
    rest = settled(Shooting(flow, omega), omega)
    assert rest is not None
    rest.wet.q[0] += 0.4 * flow.scale
    eccentricity, frequency = after_transients(flow, rest.wet, 1.0 / cycle.frequency_Hz, omega, periods)
    np.testing.assert_allclose(cycle.eccentricity_max, eccentricity, atol=atol)
    assert cycle.frequency_Hz == pytest.approx(frequency, rel=rtol)


@pytest.mark.nightly  # 70 s; cycles that are shot, in a plane: solve/test_tilted_cycles.py
def test_the_cycle_is_what_the_time_loop_ends_in() -> None:
    """At 82 Hz, where disturbances lose 6 % in a period: after 160 periods, the mean over 80."""
    check_time_loop_ends_in_the_cycle(diagram(), 240, 1e-4)


def given_flow(*settings: str) -> Case:
    """A supply of 2 bar that gives less than the film takes at this pressure."""
    flow = "bearing.supply.pressure=2 bar", "bearing.supply.flow=4e-7", "accuracy.mesh=[6,32]"
    return frbcli.load_case("rigid-two-phase", ["film.cavitation=elrod", *flow, *settings])


def test_the_filling_of_a_limited_supply_is_part_of_the_state() -> None:
    """Behind displacements and velocities of the rotor, before the oil; at rest it is that of the settled film."""
    flow, omega = period_map(given_flow()), 2.0 * math.pi * 90.0
    system = flow.system
    rest = resting_position(system, omega)
    wet = wet_at(flow, rest.displacements, rest.velocities(system), omega)
    x, y = (rest.journals[0] / system.clearances[0]).tolist()
    film = steady_solution(system.films.with_fields[0], Motion((x, y), (0.0, 0.0), omega))
    state = flow.packed(wet, omega)
    assert flow.slow == 5
    assert len(state) == 5 + np.count_nonzero(flow.held)
    assert state[4] == pytest.approx(film.filling, rel=1e-9)
    assert 0.7 < state[4] < 0.95
    state[4] -= 0.1
    other = flow.unpacked(state, wet, omega)
    assert other.filling == pytest.approx(wet.filling - 0.1)
    np.testing.assert_allclose(flow.packed(other, omega), state, atol=1e-12)
    assert flow.motion_of(wet, omega)[4] == 0.0


@pytest.mark.nightly  # the time loop of inputs
def test_the_cycle_at_a_given_flow_is_what_the_time_loop_ends_in() -> None:
    """At 92 Hz, where disturbances lose 5 % in a period."""
    found = frbcli.limit_cycles(given_flow("speed.from=84 Hz", "speed.to=92.5 Hz"), [92.0])
    check_time_loop_ends_in_the_cycle(found, 240, 1e-3)
    (hopf,) = found.of("hopf")
    assert hopf.speed_Hz == pytest.approx(86.2, abs=1.5)  # by the linearised film


@pytest.mark.nightly  # the time loop of inputs
def test_whirls_at_a_given_flow_grow_as_the_linearised_film_says() -> None:
    """Differences on cells scatter by 0.07 1/s, and their frequency by as much, from place to place of the cells:
    the mean over eight places is that of the linearised film but for the cells of both, 0.3 1/s, as in
    tests/linear/test_stability_of_oil.py."""
    omega = 2.0 * math.pi * 90.0
    shooting = Shooting(period_map(given_flow(), (48, 6)), omega)
    rest = settled(shooting, omega)
    assert rest is not None
    rates = []
    for place in np.arange(8) / 8.0:
        there = Shooting(shooting.flow.lying(place), omega).rest(shooting.flow.moved(rest.wet, place), omega)
        assert there is not None
        rates.append(complex(there.eigenvalues[there.whirls[0]]))
    linear = max(frbcli.stability(given_flow(), [90.0]).points[0].eigenvalues, key=lambda rate: rate.real)
    assert np.std(rates) < 0.2
    assert np.mean(np.real(rates)) == pytest.approx(linear.real, abs=0.3)
    assert np.mean(np.abs(np.imag(rates))) == pytest.approx(abs(linear.imag), rel=1e-3)


GAS = ("rotor.mass=30 kg", "film.cavitation=bubbly", "accuracy.mesh=[4,24]")
AT_170_Hz = 2.0 * math.pi * 170.0


def with_rates(*times: str) -> PeriodMap:
    keys = ("film.bubbly.release_time", "film.bubbly.absorption_time")
    rates = [f"{key}={time}" for key, time in zip(keys, times, strict=False)]
    return period_map(frbcli.load_case("rigid-two-phase", [*GAS, *rates]))


def thrown(flow: PeriodMap) -> Wet:
    """The heavy rotor at 170 Hz at 0.7 of the clearance, with half of the speed of a whirl there."""
    return wet_at(flow, 0.7 * flow.scale * np.eye(2)[0], 0.2 * AT_170_Hz * flow.scale * np.eye(2)[1], AT_170_Hz)


def test_gas_is_a_part_of_the_state() -> None:
    """Over two periods, once without a break, and once with the state in numbers in between, which has the oil and the
    gas of each cell; with the gas in equilibrium there, as of a state without it, the motion is another one."""
    flow, time = with_rates("1 ms", "1 s"), 1.0 / 85.0
    cells = flow.held[0].size
    assert np.count_nonzero(flow.held) == 2 * cells
    once = flow.passage(thrown(flow), 2.0 * time, AT_170_Hz, 400).displacements[-1]
    half = flow.passage(thrown(flow), time, AT_170_Hz, 200).end
    x = flow.packed(half, AT_170_Hz)
    assert len(x) == 4 + 2 * cells
    whole = flow.unpacked(x, half, AT_170_Hz)
    np.testing.assert_allclose(whole.content, half.content, atol=1e-14)
    again = flow.passage(whole, time, AT_170_Hz, 200).displacements[-1]
    x[-cells:] = 0.0
    without = flow.passage(flow.unpacked(x, half, AT_170_Hz), time, AT_170_Hz, 200).displacements[-1]
    np.testing.assert_allclose(again, once, atol=1e-4)
    assert np.abs(without - once).max() > 1e-2


def test_whirls_with_gas_grow_as_stability_has_it() -> None:
    """Stability linearises film, oil and gas on 96 x 12 and 48 x 6 cells."""
    omega = 2.0 * math.pi * 150.0
    rest = settled(Shooting(with_rates(), omega), omega)
    assert rest is not None
    _, (point,) = stability_points(frbcli.load_case("rigid-two-phase", GAS), [150.0])
    assert abs(rest.eigenvalues[rest.whirls[0]] - point.critical) < 0.01 * abs(point.critical)
    assert rest.growing == 0


@cache
def gas_diagram() -> LimitCycles:
    """From Hopf point to an eccentricity of 0.85."""
    case = frbcli.load_case("rigid-two-phase", [*GAS, "speed.from=158 Hz", "speed.to=171 Hz"])
    return frbcli.limit_cycles(case, [170.0])


@pytest.mark.nightly  # 3 minutes
def test_the_hopf_point_of_bubbly_oil_is_where_stability_has_it() -> None:
    """163.06(20) Hz with 81.96(10) Hz, see docs/theory.md, to the sum of both errors."""
    (hopf,) = gas_diagram().of("hopf")
    assert hopf.speed_Hz == pytest.approx(163.06, abs=hopf.value_uncertainty + 0.20)
    assert hopf.frequency_Hz == pytest.approx(81.96, abs=hopf.frequency_uncertainty_Hz + 0.10)
    assert hopf.value_uncertainty < 0.02 * hopf.speed_Hz


@pytest.mark.nightly
def test_the_cycle_of_bubbly_oil_is_what_the_time_loop_ends_in() -> None:
    """Disturbances lose 14 % in a period at 170 Hz."""
    check_time_loop_ends_in_the_cycle(gas_diagram(), 150, 1e-3, 1e-4)


@pytest.mark.nightly
def test_oil_that_stays_for_many_periods_does_not_end_the_branch() -> None:
    """Beyond 91 Hz the oil of the wide side stays for ten and more periods, with multipliers above 0.9."""
    settings = ['bearing.supply.pressure="2 bar"', "speed.from=74 Hz", "speed.to=100 Hz"]
    (branch,) = frbcli.limit_cycles(frbcli.load_case("rigid-two-phase", settings)).branches
    assert branch.note.startswith("It leaves the range.")  # with cycles that lack places of the cells
    last = branch.points[-1]
    assert last.speed_Hz == pytest.approx(100.0, rel=1e-6)
    assert np.count_nonzero(np.abs(last.multipliers) > 0.9) > 3
    assert all(point.stable for point in branch.points[1:])


def test_a_disturbance_at_rest_grows_as_the_slow_motions_say() -> None:
    """Rest at 90 Hz plus the growing motion, over one and three revolutions of the time loop: displacements (velocities
    at one moment jump by some per cent, as fronts of the oil cross cells)."""
    flow, omega = period_map(frbcli.load_case("rigid-two-phase", FED)), 2.0 * math.pi * 90.0
    shooting = Shooting(flow, omega)
    rest = settled(shooting, omega)
    assert rest is not None
    number = rest.whirls[0]
    rate, state = complex(rest.eigenvalues[number]), rest.states[:, number]
    assert rate.real > 0.0
    assert not rest.stable
    turn, size = 2.0 * math.pi / omega, 0.02 / np.abs(state[:2]).max()
    for revolutions in (1, 3):
        ends = []
        for side in (1.0, -1.0):
            start = flow.unpacked(rest.x + side * size * state.real, rest.wet, omega)
            ends.append(flow.packed(flow.passage(start, revolutions * turn, omega, 100 * revolutions).end, omega))
        moved, expected = 0.5 * (ends[0] - ends[1]), (size * state * np.exp(rate * revolutions * turn)).real
        assert np.linalg.norm((moved - expected)[:2]) < 0.01 * np.linalg.norm(expected[:2])


def test_a_film_that_stays_full_has_the_eigenvalues_of_sommerfeld() -> None:
    """Under 5 bar nothing cavitates: Elrod's film on cells against that of Sommerfeld's condition at 90 Hz."""
    pressures = [f'{key}="5 bar"' for key in ("bearing.supply.pressure", "oil.ambient_pressure")]
    settings = [*pressures, 'oil.cavitation_pressure="0.01 bar"', "bearing.ends=oil-bath"]
    cells = [*settings, "film.cavitation=elrod", "accuracy.mesh=[12,64]"]
    flow = period_map(frbcli.load_case("rigid-two-phase", cells))
    omega = 2.0 * math.pi * 90.0
    rest = settled(Shooting(flow, omega), omega)
    plain = frbcli.load_case("rigid-two-phase", [*settings, "film.cavitation=sommerfeld", "film.theory=finite"])
    (point,) = frbcli.stability(plain, [90.0]).points
    assert rest is not None
    np.testing.assert_allclose(rest.displacement[0], point.films[0].displacement, atol=1e-4)
    number = rest.whirls[0]
    expected = point.oscillating[np.argmax(point.oscillating.real)]
    assert abs(rest.eigenvalues[number] - expected) < 2e-4 * abs(expected)
    assert rest.growth_of(0) == pytest.approx(expected.real, rel=0.01)


@pytest.mark.nightly
def test_the_command_shoots(frb: Frb, tmp_path) -> None:  # type: ignore[no-untyped-def]
    words = ["limit-cycles", "rigid-two-phase", "--json", "-o", str(tmp_path / "oil.png")]
    settings = ("bearing.supply.pressure=2 bar", "speed.from=75 Hz", "speed.to=79 Hz")
    words += [word for setting in settings for word in ("--set", setting)]
    document = frb(*words, "--csv", str(tmp_path / "oil.csv")).document
    assert "are mass-conserving" in document["notes"][0]
    (branch,) = document["branches"]
    assert branch["points"][0]["torque_N_m"] is None
    assert (tmp_path / "oil.png").exists()
