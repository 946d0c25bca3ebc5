"""The time loop for a film in the published two-phase form: the steps of time_loop.py around the stages of
step.py.

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
from frbcli.solve.contact import felt_motion
from frbcli.solve.published.state import FilmStep, book_step, mean_fraction
from frbcli.solve.published.step import Parts, make_parts, pressures, solve_stages
from frbcli.solve.state import RUNNING, STEP_DONE, STUCK, Control, RotorData, State
from frbcli.solve.step import (
    UNSOLVED,
    begin_step,
    choose_next,
    count_step,
    end_of_step,
    keep_past,
    local_error,
    move_on,
    reject,
    write_outputs,
)
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
    """As advance of time_loop.py, for rotors with the one film that is given in `films`; a budget of 0 has all parts
    compiled and changes nothing."""
    if budget == 0:
        copied = State(*(np.array(part) for part in state))
        advance_published(rotor, films, tableau, control, copied, 1, out_q, out_v, out_oil)
        return RUNNING, 0
    parts = make_parts(rotor, films, tableau, control, state)
    numbers, order = state.numbers, float(tableau.error_order)
    profile = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    written, done = 0, 0
    while done < budget:
        status, t, piece, h, step = begin_step(numbers, *profile, control, out_q.shape[0] - written)
        if step == 0.0:
            return status, written
        solved = solve_stages(parts, state, piece, t, step)
        scratch, g = parts.scratch, tableau.stage[1, 1] * step
        error = UNSOLVED
        if solved:
            error = local_error(tableau.defect, rotor.observed, scratch.stage_v, scratch.stage_a, step, g)
            error /= control.tolerance
        if not error <= 1.0:  # not a number counts as too large
            if reject(numbers, step, error, order):
                continue
            return STUCK, written
        before, t_new = written, end_of_step(t, step, rotor.profile_times[piece + 1])
        speed = rotation(*profile, piece, t_new)[1]
        written = _accept(parts, state, t, step, t_new, speed, out_q, out_v, written)
        out_oil[before:written] = mean_fraction(parts.film, scratch.thetas[-1])
        done += 1
        largest = float(np.hypot(*(scratch.selection @ state.q))) / parts.clearance
        status = count_step(numbers, state.errors, control, t_new, step, speed, error * control.tolerance, largest)
        if status != RUNNING:
            return status, written
        choose_next(numbers, h, error, order, math.inf)
    return RUNNING, written


def _accept(
    parts: Parts,
    state: State,
    t: float,
    step: float,
    t_new: float,
    speed: float,
    out_q: Array,
    out_v: Array,
    written: int,
) -> int:
    """Write what lies within the step and move the state on. speed: of the rotor at the end. Returns the rows
    written."""
    scratch, last = parts.scratch, len(parts.tableau.times) - 1
    q_new = state.q + step * scratch.stage_v @ parts.tableau.stage[last]
    written = write_outputs(
        state.numbers, scratch.stage_v, parts.control.output_step, t, step, t_new, state.q, q_new, out_q, out_v, written
    )
    place = scratch.selection @ np.column_stack([state.q, q_new, scratch.stage_v[:, last]]) / parts.clearance
    place[:, 1:] = felt_motion(parts.control, place[:, 1], place[:, 2]).T
    place[:, 0] = felt_motion(parts.control, place[:, 0], np.zeros(2))[0]
    omega = float(parts.rotor.turning[0, 0, 0] * speed)
    end = FilmStep(scratch.w, pressures(parts), scratch.thetas[last], scratch.rates[last])
    book_step(parts.film, state, end, place, omega, step)
    move_on(state.q, state.v, state.a, q_new, scratch.stage_v, scratch.stage_a)
    keep_past(scratch.past, state.past)
    state.numbers[STEP_DONE] = step
    return int(written)
