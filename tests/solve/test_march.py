"""The time loop against exact solutions: order of every method, error control, rotors of any size, several films; and
its course: steps, buffers and output, energy, contact, standstill and reversal."""

import math
from itertools import pairwise

import numpy as np
import pytest
from marches import (
    BEARING,
    SHORT_FILM,
    Array,
    control,
    even_steps,
    forces,
    jeffcott,
    linear_reference,
    march,
    modal_rotor,
    rigid,
    slender_jeffcott,
    slope,
    start,
    with_short_films,
    without_films,
)
from scipy.integrate import simpson, solve_ivp
from scipy.linalg import block_diag

from frbcli.film.rectangles.film import evaluate
from frbcli.rotor.assembly import LinearRotor, planar
from frbcli.rotor.loads import speed_profile
from frbcli.runs.start import rotor_data
from frbcli.solve.state import (
    CONTACT,
    FINISHED,
    LARGEST_EPS,
    METHODS,
    RUNNING,
    STEP,
    STEPS,
    TIME,
    Method,
    State,
    Tableau,
    make_output,
)
from frbcli.solve.time_loop import advance

ALL_METHODS = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())


# --- the methods themselves ---


def order_defects(stage: Array, times: Array, weights: Array) -> list[float]:
    """How far the conditions of order 1, 2, 3, 4 and, of one tree, 5 are missed (Butcher's trees)."""
    ac = stage @ times
    trees = [
        [(weights.sum(), 1)],
        [(weights @ times, 2)],
        [(weights @ times**2, 3), (weights @ ac, 6)],
        [(weights @ times**3, 4), (weights @ (times * ac), 8), (weights @ (stage @ times**2), 12),
         (weights @ (stage @ ac), 24)],
        [(weights @ times**4, 5)],
    ]  # fmt: skip
    return [max(abs(float(value) - 1.0 / density) for value, density in order) for order in trees]


@ALL_METHODS
def test_order_conditions_hold_up_to_the_stated_orders_and_no_further(method: Method) -> None:
    tableau = method.tableau
    main = order_defects(tableau.stage, tableau.times, tableau.stage[-1])
    assert max(main[: tableau.order]) < 1e-12
    assert main[tableau.order] > 1e-4
    embedded = order_defects(tableau.stage, tableau.times, tableau.stage[-1] - tableau.defect)
    assert max(embedded[: method.embedded_order]) < 1e-12
    assert embedded[method.embedded_order] > 1e-4


def amplification(tableau: Tableau, z: complex) -> complex:
    """Growth R(z) of y' = lambda y in one step, z = h lambda."""
    s = len(tableau.times)
    stages = np.linalg.solve(np.eye(s) - z * tableau.stage, np.ones(s, dtype=complex))
    return complex(stages[-1])


@ALL_METHODS
def test_methods_are_stable_for_every_damped_motion_and_forget_stiff_ones(method: Method) -> None:
    tableau = method.tableau
    assert tableau.stage[0].tolist() == [0.0] * len(tableau.times)
    np.testing.assert_allclose(np.diag(tableau.stage)[1:], tableau.stage[1, 1], rtol=1e-14)
    assert np.triu(tableau.stage, 1).any() == np.False_
    on_the_axis = [abs(amplification(tableau, 1j * y)) for y in np.logspace(-3, 6, 400)]
    assert max(on_the_axis) < 1.0 + 1e-12
    at_infinity = -np.linalg.solve(tableau.stage[1:, 1:], tableau.stage[1:, 0])[-1]
    assert abs(at_infinity) < 1e-11


# --- order, measured ---


@ALL_METHODS
def test_measured_order_is_the_stated_one(method: Method) -> None:
    system, omega, end = without_films(slender_jeffcott()), 150.0, 0.1
    profile = speed_profile([0.0, end], [omega, omega])
    q = np.array([0.0, 0.01, 0.02, -0.01])
    exact_q, exact_v = (part[-1] for part in linear_reference(system.rotor, omega, np.array([0.0, end]), q, q * 0))
    sizes, errors = [], []
    for steps in (400, 600, 900):
        h = end / steps
        got = march(system, profile, even_steps(h, end), first_step(start(system, profile, q), h), method.name)
        assert steps <= got.numbers[STEPS] < 1.05 * steps
        sizes.append(end / got.numbers[STEPS])
        of_q, of_v = np.linalg.norm(got.q[-1] - exact_q), np.linalg.norm(got.v[-1] - exact_v)
        errors.append(math.hypot(of_q, of_v / omega))  # neither alone: each is by chance exact at some phase
    assert slope(sizes, errors) == pytest.approx(method.tableau.order, abs=0.15)


def first_step(state: State, h: float) -> State:
    state.numbers[STEP] = h
    return state


@ALL_METHODS
def test_dense_output_is_as_exact_as_the_steps_allow(method: Method) -> None:
    system, omega, end = without_films(slender_jeffcott()), 150.0, 0.06
    profile = speed_profile([0.0, end], [omega, omega])
    output = end / 997
    times = np.arange(998) * output
    exact_q, exact_v = linear_reference(system.rotor, omega, times, np.zeros(4), np.zeros(4))
    sizes, of_q, of_v = [], [], []
    for steps in (100, 150, 225):
        h = end / steps
        got = march(system, profile, even_steps(h, output), first_step(start(system, profile), h), method.name)
        assert len(got.times) == len(times)
        sizes.append(end / got.numbers[STEPS])
        of_q.append(float(np.abs(got.q - exact_q).max()))
        of_v.append(float(np.abs(got.v - exact_v).max()))
    # The cubic through both ends has an error of h^4, its derivative one of h^3.
    assert slope(sizes, of_q) == pytest.approx(min(method.tableau.order, 4), abs=0.2)
    assert slope(sizes, of_v) == pytest.approx(min(method.tableau.order, 3), abs=0.2)


# --- error control ---


@ALL_METHODS
def test_error_falls_with_the_tolerance(method: Method) -> None:
    system = with_short_films(jeffcott())
    profile = speed_profile([0.0, 0.15], [2 * math.pi * 60.0, 2 * math.pi * 80.0])
    exact = march(system, profile, control(1e-11, longest=1e-4), method="esdirk4").q
    tolerances = [1e-5, 1e-6, 1e-7, 1e-8]
    errors = []
    for tolerance in tolerances:
        got = march(system, profile, control(tolerance, longest=1.0), method=method.name)
        errors.append(float(np.abs(got.q - exact).max()) / BEARING.clearance)
        assert errors[-1] < 300 * tolerance ** share(method)
    assert all(tighter < looser for looser, tighter in pairwise(errors))
    assert slope(tolerances, errors) == pytest.approx(share(method), abs=0.25)


def share(method: Method) -> float:
    """The step's error is that of the lower of the two orders, the run's error that of the method."""
    return method.tableau.order / (min(method.tableau.order, method.embedded_order) + 1)


def test_steps_are_at_least_as_many_per_revolution_as_asked_for() -> None:
    system = with_short_films(jeffcott())
    speed = 200.0
    profile = speed_profile([0.0, 0.1], [2 * math.pi * speed] * 2)
    got = march(system, profile, control(1.0, per_revolution=40.0))
    assert got.numbers[STEPS] >= 40 * 0.1 * speed
    assert got.numbers[STEPS] < 1.1 * 40 * 0.1 * speed + 20


# --- rotors of every size ---


def overhung_disk() -> LinearRotor:
    """A thin rigid disk at the end of an elastic cantilever; q = [x, tilt in x, y, tilt in y]."""
    mass, diametral, polar, length, bending = 2.0, 5e-3, 1e-2, 0.1, 60.0
    plane = bending * np.array([[12 / length**3, -6 / length**2], [-6 / length**2, 4 / length]])
    tilts = np.zeros((4, 4))
    tilts[1, 3], tilts[3, 1] = polar, -polar
    end = planar(4, 0, 2)
    return LinearRotor(
        mass=block_diag(*2 * [np.diag([mass, diametral])]),
        damping=np.zeros((4, 4)),
        gyroscopic=tilts,
        stiffness=block_diag(plane, plane),
        static_load=np.zeros(4),
        unbalance_cos=np.zeros(4),
        unbalance_sin=np.zeros(4),
        journals=end[None],
        multiplicity=np.array([1.0]),
        points=(("journal", end), ("tilt", planar(4, 1, 3))),
    )


def test_overhung_disk_whirls_forward_and_backward_with_its_exact_frequencies() -> None:
    system, omega = without_films(overhung_disk()), 400.0
    rotor = system.rotor
    # With z = x + i y and the tilts likewise, whirling as exp(i w t): (K + w Omega G_polar - w^2 M) z = 0, 2 x 2.
    k, m, polar = rotor.stiffness[:2, :2], rotor.mass[:2, :2], np.diag([0.0, rotor.gyroscopic[1, 3]])
    companion = np.block([[np.zeros((2, 2)), np.eye(2)], [np.linalg.solve(m, k), np.linalg.solve(m, polar) * omega]])
    whirls, shapes = np.linalg.eig(companion)
    assert np.abs(np.sort(whirls)).min() > 50.0
    assert sorted(np.sign(whirls)) == [-1.0, -1.0, 1.0, 1.0]
    assert abs(whirls.sum()) > 10.0  # gyroscopic: forward is faster than backward
    for whirl, shape in zip(whirls, shapes.T, strict=True):
        z = 1e-2 * shape[:2] / np.abs(shape[:2]).max()
        end = 4 * 2 * math.pi / abs(whirl)
        profile = speed_profile([0.0, end], [omega, omega])
        state = start(system, profile, np.concatenate([z, 0 * z]), np.concatenate([0 * z, whirl * z]))
        got = march(system, profile, control(1e-10, output=end / 200), state)
        turned = np.exp(1j * whirl * got.times)[:, None] * z
        np.testing.assert_allclose(got.q[:, :2] + 1j * got.q[:, 2:], turned, rtol=0, atol=1e-8)


def test_modal_rotor_in_two_films_follows_radau_while_its_speed_changes() -> None:
    rotor = modal_rotor(2)
    system, end = with_short_films(rotor), 0.01
    profile = speed_profile([0.0, end], [2 * math.pi * 100.0, 2 * math.pi * 160.0])
    got = march(system, profile, control(1e-11, longest=1e-5, output=1e-3))
    assert got.status == FINISHED
    speed_up = float(np.diff(profile.speeds)[0] / end)

    def rates(t: float, y: Array) -> Array:
        omega, angle = profile.speeds[0] + speed_up * t, t * (profile.speeds[0] + 0.5 * speed_up * t)
        load = forces(system, y[:60], y[60:], speed_up, omega, angle)
        return np.concatenate([y[60:], load])  # the mass is one

    def slopes(t: float, y: Array) -> Array:
        omega = profile.speeds[0] + speed_up * t
        by_q, by_v = -rotor.stiffness, -rotor.damping - omega * rotor.gyroscopic
        for selection, count in zip(rotor.journals, rotor.multiplicity, strict=True):
            film = evaluate(SHORT_FILM, BEARING.clearance, selection @ y[:60], selection @ y[60:], omega)
            by_q = by_q + count * selection.T @ film.by_displacement @ selection
            by_v = by_v + count * selection.T @ film.by_velocity @ selection
        return np.block([[np.zeros((60, 60)), np.eye(60)], [by_q, by_v]])

    reference = solve_ivp(rates, (0.0, end), np.zeros(120), "Radau", got.times, jac=slopes, rtol=1e-9, atol=1e-14)
    exact = reference.y[:60].T
    assert np.abs(rotor.journals[0] @ exact[-1]).max() > 0.01 * BEARING.clearance  # the films have work to do
    assert np.abs(got.q - exact).max() < 1e-6 * np.abs(exact).max()


# --- several films ---


def side_by_side(rotors: list[LinearRotor]) -> LinearRotor:
    """Rotors that know nothing of each other, as one system."""
    sizes = [rotor.size for rotor in rotors]
    before = np.concatenate([[0], np.cumsum(sizes)])
    maps = []
    for rotor, first in zip(rotors, before, strict=False):
        selection = np.zeros((2, sum(sizes)))
        selection[:, first : first + rotor.size] = rotor.journals[0]
        maps.append(selection)
    return LinearRotor(
        mass=block_diag(*[rotor.mass for rotor in rotors]),
        damping=block_diag(*[rotor.damping for rotor in rotors]),
        gyroscopic=block_diag(*[rotor.gyroscopic for rotor in rotors]),
        stiffness=block_diag(*[rotor.stiffness for rotor in rotors]),
        static_load=np.concatenate([rotor.static_load for rotor in rotors]),
        unbalance_cos=np.concatenate([rotor.unbalance_cos for rotor in rotors]),
        unbalance_sin=np.concatenate([rotor.unbalance_sin for rotor in rotors]),
        journals=np.stack(maps),
        multiplicity=np.concatenate([rotor.multiplicity for rotor in rotors]),
        points=tuple((f"journal_{number}", selection) for number, selection in enumerate(maps)),
    )


def test_two_different_rotors_in_one_system_do_not_disturb_each_other() -> None:
    profile, limits = speed_profile([0.0, 0.1], [300.0, 500.0]), control(1e-10)
    rotors = [rigid(6.1, 1e-6, 0.0), rigid(2.0, 4e-6, 5.0)]
    both = march(with_short_films(side_by_side(rotors)), profile, limits)
    for film, rotor in enumerate(rotors):
        alone = march(with_short_films(rotor), profile, limits)
        own = both.q[:, 2 * film : 2 * film + 2]
        np.testing.assert_allclose(own, alone.q, rtol=0, atol=1e-7 * BEARING.clearance)


# --- the course of a march ---


def test_numbers_do_not_depend_on_how_the_steps_are_handed_out() -> None:
    system = with_short_films(modal_rotor(2))
    profile = speed_profile([0.0, 0.01, 0.015, 0.02], [600.0, 650.0, 650.0, 300.0])
    whole = march(system, profile, control())
    for budget in (1, 7):
        pieces = march(system, profile, control(), budget=budget)
        np.testing.assert_array_equal(pieces.q, whole.q)
        np.testing.assert_array_equal(pieces.v, whole.v)
        np.testing.assert_array_equal(pieces.numbers, whole.numbers)


def test_numbers_do_not_depend_on_the_size_of_the_buffers() -> None:
    system, profile, limits = with_short_films(jeffcott()), speed_profile([0.0, 0.05], [0.0, 300.0]), control()
    whole = march(system, profile, limits)
    state, data = start(system, profile), rotor_data(system, profile)
    output = make_output(20, 4)
    rows, status = [], RUNNING
    while status == RUNNING:
        status, written = advance(data, system.films.loop, METHODS["esdirk4"].tableau, limits, state, 10**9, output)
        rows.append(output.q[:written].copy())
    np.testing.assert_array_equal(np.concatenate(rows), whole.q)


def test_output_comes_at_its_own_even_times_and_does_not_cut_steps() -> None:
    system, profile = with_short_films(jeffcott()), speed_profile([0.0, 0.05], [300.0, 300.0])
    fine, coarse = (march(system, profile, control(output=output)) for output in (1e-6, 1e-3))
    assert fine.numbers[STEPS] == coarse.numbers[STEPS]
    assert (len(fine.times), len(coarse.times)) == (50_001, 51)
    np.testing.assert_allclose(fine.q[::1000], coarse.q, rtol=0, atol=1e-13 * BEARING.clearance)


def test_work_done_on_the_rotor_is_the_energy_it_gains() -> None:
    system = with_short_films(jeffcott(unbalance=30e-6))
    rotor = system.rotor
    times, speeds = [0.0, 0.1, 0.12], [600.0, 1100.0, 1100.0]
    profile = speed_profile(times, speeds)
    got = march(system, profile, control(1e-9, longest=2e-5, output=1e-5))
    power = []
    for t, q, v in zip(got.times, got.q, got.v, strict=True):
        piece = 0 if t < times[1] else 1
        speed_up = (speeds[piece + 1] - speeds[piece]) / (times[piece + 1] - times[piece])
        since = t - times[piece]
        omega = speeds[piece] + speed_up * since
        angle = profile.angles[piece] + since * (speeds[piece] + 0.5 * speed_up * since)
        # Elastic forces are the energy's own; all others do work on it or take it away.
        power.append(v @ (forces(system, q, v, speed_up, omega, angle) + rotor.stiffness @ q))
    energy = 0.5 * np.einsum("ki,ij,kj->k", got.v, rotor.mass, got.v)
    energy += 0.5 * np.einsum("ki,ij,kj->k", got.q, rotor.stiffness, got.q)
    turnover = simpson(np.abs(power), x=got.times)
    kink = round(times[1] / 1e-5)  # the unbalance jumps where the acceleration ends
    for part in (slice(0, kink), slice(kink, None)):
        gain = energy[part][-1] - energy[part][0]
        assert simpson(power[part], x=got.times[part]) == pytest.approx(gain, abs=1e-4 * turnover)
    assert np.ptp(energy) > 1e-3 * turnover  # there is a balance to be struck


def test_a_journal_without_mass_worth_mentioning_costs_no_smaller_steps() -> None:
    profile = speed_profile([0.0, 0.1], [2 * math.pi * 80.0, 2 * math.pi * 90.0])
    heavy = march(with_short_films(jeffcott(0.01)), profile, control(1e-7))
    light = march(with_short_films(jeffcott(1e-6)), profile, control(1e-7))
    assert light.status == FINISHED
    assert light.numbers[STEPS] < 1.5 * heavy.numbers[STEPS]
    settled = heavy.times > 0.05
    assert np.abs(light.q - heavy.q)[settled].max() < 2e-2 * BEARING.clearance


# --- contact, standstill, reversal ---


TOUCHES = 0.9  # eccentricity at which the surfaces of these two tests meet; closer, the film lets no rotor through


def test_contact_stops_the_march_with_the_journal_at_the_shell() -> None:
    system, profile = with_short_films(jeffcott(unbalance=3e-3)), speed_profile([0.0, 1.0], [0.0, 1800.0])
    got = march(system, profile, control()._replace(contact_eccentricity=TOUCHES))
    assert got.status == CONTACT
    assert 0.1 < got.numbers[TIME] < 1.0
    assert TOUCHES <= got.numbers[LARGEST_EPS] < TOUCHES + 0.01
    assert got.times[-1] <= got.numbers[TIME] < got.times[-1] + 1e-4
    assert np.hypot(got.q[:, 0], got.q[:, 2]).max() < TOUCHES * BEARING.clearance


def test_elastic_contact_pushes_back_and_the_march_goes_on() -> None:
    system, profile = with_short_films(jeffcott(unbalance=3e-3)), speed_profile([0.0, 1.0], [0.0, 1800.0])
    free = march(system, profile, control())
    deepest = []
    for stiffness in (1e10, 1e11):  # a softer shell than a film gives way beyond 1.5 times the clearance
        got = march(system, profile, control(stiffness=stiffness)._replace(contact_eccentricity=TOUCHES))
        assert got.status == FINISHED
        deepest.append(got.numbers[LARGEST_EPS])
    assert free.numbers[LARGEST_EPS] > deepest[0] > deepest[1] > TOUCHES


def test_a_rotor_at_standstill_sinks_and_never_turns_sideways() -> None:
    system, profile = with_short_films(jeffcott()), speed_profile([0.0, 0.2], [0.0, 0.0])
    got = march(system, profile, control())
    assert got.status == FINISHED
    depth = got.q[:, 2] / BEARING.clearance
    assert np.abs(got.q[:, 0]).max() < 1e-9 * BEARING.clearance
    assert -1.0 < depth[-1] < -0.85
    assert (np.diff(depth[20:]) < 0.0).all()


def test_reversed_rotation_is_the_mirror_image() -> None:
    system, limits = with_short_films(jeffcott(unbalance=0.0)), control(1e-8)
    there, back = (march(system, speed_profile([0.0, 0.1], [sign * 300.0, sign * 500.0]), limits) for sign in (1, -1))
    np.testing.assert_allclose(back.q * [-1, -1, 1, 1], there.q, rtol=0, atol=1e-9 * BEARING.clearance)
    assert np.abs(there.q[:, 0]).max() > 0.1 * BEARING.clearance


def test_speed_may_pass_through_zero() -> None:
    system, profile = with_short_films(jeffcott()), speed_profile([0.0, 0.2], [200.0, -200.0])
    loose, tight = (march(system, profile, control(tolerance)) for tolerance in (1e-7, 1e-9))
    assert loose.status == tight.status == FINISHED
    assert np.abs(loose.q - tight.q).max() < 1e-4 * BEARING.clearance
