"""The course of a march: steps, buffers and output, energy, contact, standstill and reversal."""

from __future__ import annotations

import math

import numpy as np
import pytest
from marches import BEARING, control, forces, jeffcott, march, modal_rotor, start, with_short_films
from scipy.integrate import simpson

from frbcli.rotor.loads import speed_profile
from frbcli.runs.start import rotor_data
from frbcli.solve.state import CONTACT, FINISHED, LARGEST_EPS, METHODS, RUNNING, STEPS, TIME, make_output
from frbcli.solve.time_loop import advance

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
