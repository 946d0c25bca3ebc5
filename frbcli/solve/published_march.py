"""The time loop for a film in the published two-phase form: the steps of march.py around the stages of
published_step.py.

The film's state is the oil fraction at the points of its elements; the rates of the stages are added up as those of the
velocities are. Steps are controlled as with cells: by the error of the journal's displacement and velocity, which the
film drives. A stage costs some milliseconds, so that the loop itself is plain Python around compiled parts.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.film.grid import Array
from frbcli.film.published.film import PublishedFilm
from frbcli.rotor.excitation import rotation
from frbcli.solve.march import ERROR_MEMORY, SMALLEST_STEP, UNSOLVED
from frbcli.solve.published_state import FilmStep, book_step, mean_fraction
from frbcli.solve.published_step import Parts, make_parts, pressures, solve_stages
from frbcli.solve.state import (
    CONTACT,
    ERROR_BEFORE,
    ERROR_LARGEST,
    ERROR_NOW,
    FINISHED,
    HISTORY,
    LARGEST_EPS,
    PIECE,
    REJECTED,
    RUNNING,
    STEP,
    STEP_BEFORE,
    STEP_DONE,
    STEPS,
    STUCK,
    TIME,
    TURNS,
    Control,
    RotorData,
    State,
)
from frbcli.solve.step import SAFETY, local_error, step_after, step_to_take, write_outputs
from frbcli.solve.tableau import Tableau


def advance_published(
    rotor: RotorData,
    films: PublishedFilm,
    tableau: Tableau,
    control: Control,
    state: State,
    budget: int,
    out_q: Array,
    out_v: Array,
    out_oil: Array,
) -> tuple[int, int]:
    """As advance of march.py, for rotors with the one film that is given in `films`; a budget of 0 has all parts
    compiled and changes nothing."""
    if budget == 0:
        copied = State(*(np.array(part) for part in state))
        advance_published(rotor, films, tableau, control, copied, 1, out_q, out_v, out_oil)
        return RUNNING, 0
    parts = make_parts(rotor, films, tableau, control, state)
    numbers, times = state.numbers, rotor.profile_times
    written, done = 0, 0
    while done < budget:
        t, piece = numbers[TIME], int(numbers[PIECE])
        if t >= times[piece + 1] and piece + 2 < times.shape[0]:
            piece += 1
            numbers[PIECE] = piece
        if t >= times[-1]:
            return FINISHED, written
        speed = rotation(times, rotor.profile_speeds, rotor.profile_angles, piece, t)[1]
        h, step = step_to_take(
            numbers[STEP], numbers[STEP_BEFORE], times[piece + 1] - t, speed, control.steps_per_revolution,
            control.longest_step)  # fmt: skip
        if written + int(step / control.output_step) + 2 > out_q.shape[0]:
            return RUNNING, written
        solved = solve_stages(parts, state, piece, t, step)
        scratch, g = parts.scratch, tableau.stage[1, 1] * step
        error = UNSOLVED
        if solved:
            error = local_error(tableau.defect, rotor.observed, scratch.stage_v, scratch.stage_a, step, g)
            error /= control.tolerance
        if not error <= 1.0:  # not a number counts as too large
            numbers[REJECTED] += 1
            shrink = SAFETY * error ** (-1.0 / tableau.error_order) if math.isfinite(error) else 0.0
            numbers[STEP] = step * max(0.2, shrink)
            if numbers[STEP] < SMALLEST_STEP:
                return STUCK, written
            continue
        written = _accept(parts, state, piece, t, step, error, out_q, out_v, out_oil, written)
        done += 1
        if control.contact_stiffness == 0.0 and _eccentricity(parts, state.q) >= control.contact_eccentricity:
            return CONTACT, written
        numbers[STEP] = step_after(h, error, numbers[ERROR_BEFORE], float(tableau.error_order))
        numbers[ERROR_BEFORE] = error
        numbers[STEP_BEFORE] = h
    return RUNNING, written


def _accept(
    parts: Parts,
    state: State,
    piece: int,
    t: float,
    step: float,
    error: float,
    out_q: Array,
    out_v: Array,
    out_oil: Array,
    written: int,
) -> int:
    """Write what lies within the step and move the state on. Returns the rows written."""
    numbers, scratch, rotor, control = state.numbers, parts.scratch, parts.rotor, parts.control
    times, last = rotor.profile_times, len(parts.tableau.times) - 1
    t_new = t + step
    if t_new >= times[piece + 1] * (1.0 - 1e-15):
        t_new = float(times[piece + 1])
    q_new = state.q + step * scratch.stage_v @ parts.tableau.stage[last]
    before = written
    written = write_outputs(
        numbers, scratch.stage_v, control.output_step, t, step, t_new, state.q, q_new, out_q, out_v, written
    )
    speed = rotation(times, rotor.profile_speeds, rotor.profile_angles, piece, t_new)[1]
    place = scratch.pick @ np.column_stack([state.q, q_new, scratch.stage_v[:, last]]) / parts.clearance
    omega = float(rotor.turning[0, 0, 0] * speed)
    end = FilmStep(scratch.w, pressures(parts), scratch.thetas[last], scratch.rates[last])
    book_step(parts.film, state, end, place, omega, step)
    out_oil[before:written] = mean_fraction(parts.film, end.fraction)
    state.q[:], state.v[:], state.a[:] = q_new, scratch.stage_v[:, last], scratch.stage_a[:, last]
    state.past[0], state.past[1] = scratch.past[2], scratch.past[3]
    state.past[2] = scratch.past[HISTORY + last - 1]
    numbers[STEP_DONE] = step
    numbers[TIME] = t_new
    numbers[STEPS] += 1
    numbers[TURNS] += abs(speed) * step / (2.0 * math.pi)
    numbers[ERROR_NOW] = numbers[ERROR_NOW] * math.exp(-step / ERROR_MEMORY) + error * control.tolerance
    numbers[ERROR_LARGEST] = max(numbers[ERROR_LARGEST], numbers[ERROR_NOW])
    numbers[LARGEST_EPS] = max(numbers[LARGEST_EPS], _eccentricity(parts, state.q))
    return written


def _eccentricity(parts: Parts, q: Array) -> float:
    return float(np.hypot(*(parts.scratch.pick @ q))) / parts.clearance
