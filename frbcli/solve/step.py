"""The parts of all time loops around the stages of a step: its length, its error, its end, its output, the next.
Compiled.

The functions are given few arrays each: to pass a tuple of many costs more than they do.
"""

from __future__ import annotations

import math
from typing import Any

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.solve.drive import speed_now
from frbcli.solve.state import (
    CONTACT,
    ERROR_BEFORE,
    ERROR_LARGEST,
    ERROR_NOW,
    ERRORS_LARGEST,
    ERRORS_SUM,
    FINISHED,
    HISTORY,
    LARGEST_EPS,
    OUTPUTS,
    PIECE,
    REJECTED,
    RUN_END,
    RUNNING,
    STEP,
    STEP_BEFORE,
    STEPS,
    TIME,
    TURNS,
    Control,
)

SMALLEST_STEP = 1e-12  # s
UNSOLVED = 1e3  # counts as error of a step whose stages were not solved
ERROR_MEMORY = 0.1  # s: how long a local error is taken to live on in a damped rotor
SAFETY = 0.9  # of the step that the error estimate would allow
SMALLEST_SHARE = 0.2  # of a step that is left of it after an error
LARGEST_SHARE = 5.0  # of a step that the next may be
GROWTH = 1.2  # a step is enlarged only if it pays for the new inverse
LASTING = 0.95  # of the longest allowed step: a step chosen there lasts a while before the speed outgrows it


@compiled()
def local_error(defect: Array, observed: Array, stage_v: Array, stage_a: Array, step: float, g: float) -> float:
    """Largest embedded error of the observed displacements, over their clearances; velocities count times g."""
    n, stages = stage_v.shape
    error = 0.0
    for p in range(observed.shape[0]):
        in_q, in_v = 0.0, 0.0
        for i in range(n):
            if observed[p, i] != 0.0:
                defect_q, defect_v = 0.0, 0.0
                for j in range(stages):
                    defect_q += defect[j] * stage_v[i, j]
                    defect_v += defect[j] * stage_a[i, j]
                in_q += observed[p, i] * defect_q
                in_v += observed[p, i] * defect_v
        error = max(error, abs(step * in_q), abs(step * g * in_v))
    return error


@compiled()
def write_outputs(
    numbers: Array, stage_v: Array, output_step: float, step: float, t_new: float, q: Array, q_new: Array,
    out_q: Array, out_v: Array, written: int,
) -> int:  # fmt: skip
    """Dense output: the cubic through displacements and velocities at both ends of a step. Returns rows written."""
    last, t = stage_v.shape[1] - 1, numbers[TIME]
    while numbers[OUTPUTS] * output_step <= t_new * (1.0 + 1e-12):
        x = min(max((numbers[OUTPUTS] * output_step - t) / step, 0.0), 1.0)
        for i in range(q.shape[0]):
            left, right, rise = step * stage_v[i, 0], step * stage_v[i, last], q_new[i] - q[i]
            square, cube = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
            out_q[written, i] = q[i] + x * (left + x * (square + x * cube))
            out_v[written, i] = (left + x * (2.0 * square + 3.0 * x * cube)) / step
        written += 1
        numbers[OUTPUTS] += 1
    return written


@compiled()
def book_error(numbers: Array, errors: Array, step: float, error: float) -> None:
    """Add the local error of a step, which is done, to the fading sum of all, and to its span of the run."""
    spans = errors.shape[1]
    span = min(int(spans * numbers[TIME] / numbers[RUN_END]), spans - 1)
    now = numbers[ERROR_NOW] * math.exp(-step / ERROR_MEMORY) + error
    numbers[ERROR_NOW], numbers[ERROR_LARGEST] = now, max(numbers[ERROR_LARGEST], now)
    errors[ERRORS_LARGEST, span] = max(errors[ERRORS_LARGEST, span], now)
    errors[ERRORS_SUM, span] += error


@compiled()
def step_after(h: float, error: float, before: float, order: float) -> float:
    """Proportional-integral control: the step after an accepted one; errors over the tolerance, now and before."""
    ratio = SAFETY * max(error, 1e-8) ** (-0.7 / order) * max(before, 1e-8) ** (0.3 / order)
    ratio = min(LARGEST_SHARE, max(SMALLEST_SHARE, ratio))
    return h * ratio if ratio < 1.0 or ratio > GROWTH else h


@compiled()
def step_to_take(
    h: float, before: float, remaining: float, speed: float, steps_per_revolution: float, longest: float,
) -> tuple[float, float]:  # fmt: skip
    """(step that the controller keeps, step to take now): some of a revolution, and never across a kink of the profile.

    A step near the one before is the one before: a new step costs a new inverse.
    """
    if speed != 0.0:
        longest = min(longest, 2.0 * math.pi / (abs(speed) * steps_per_revolution))
    if h > longest:
        h = before if LASTING**2 * longest < before <= longest else LASTING * longest
    if h > remaining * (1.0 - 1e-9):
        return h, remaining
    if h > 0.5 * remaining:
        return h, 0.5 * remaining
    return h, h


@compiled()
def begin_step(
    drive: Any, v: Array, numbers: Array, times: Array, speeds: Array, angles: Array, control: Control, room: int,
) -> tuple[int, float, int, float, float]:  # fmt: skip
    """(status, t, piece, h, step): how things stand, the time, its piece of the profile, and both of step_to_take.

    Without a step, 0, the loop has to end: FINISHED with the profile, or RUNNING, for `room` rows cannot take what the
    step would write.
    """
    t, piece = numbers[TIME], int(numbers[PIECE])
    if t >= times[piece + 1] and piece + 2 < times.shape[0]:
        piece += 1
        numbers[PIECE] = piece
    if t >= times[-1]:
        return FINISHED, t, piece, 0.0, 0.0
    speed = speed_now(drive, v, times, speeds, angles, piece, t)
    h, step = step_to_take(
        numbers[STEP], numbers[STEP_BEFORE], times[piece + 1] - t, speed, control.steps_per_revolution,
        control.longest_step)  # fmt: skip
    if int(step / control.output_step) + 2 > room:
        return RUNNING, t, piece, h, 0.0
    return RUNNING, t, piece, h, step


@compiled(inline=True)
def begin_stages(v: Array, a: Array, stage_v: Array, stage_a: Array) -> None:
    """The first stage, which is explicit: the state at the start of the step."""
    for i in range(v.shape[0]):
        stage_v[i, 0], stage_a[i, 0] = v[i], a[i]


@compiled(inline=True)
def begin_past(past_now: Array, past: Array) -> None:
    """The points that predict the stages, see State.past: of the step before, ahead of its own."""
    for k in range(HISTORY):
        for i in range(past.shape[1]):
            past[k, i] = past_now[k, i]


@compiled()
def shorter(step: float, error: float, order: float) -> float:
    """The step to try instead of one whose error, over the tolerance, was too large or no number."""
    share = SAFETY * error ** (-1.0 / order) if math.isfinite(error) else 0.0
    return step * max(SMALLEST_SHARE, share)


@compiled()
def reject(numbers: Array, step: float, error: float, order: float) -> bool:
    """Count a step that has to be tried again, shorter. Returns whether that makes sense any more."""
    numbers[REJECTED] += 1
    numbers[STEP] = shorter(step, error, order)
    return not numbers[STEP] < SMALLEST_STEP


@compiled()
def end_of_step(t: float, step: float, end: float) -> float:
    """The time after a step: the end of the profile's piece, not a rounding error off it."""
    t_new = t + step
    return end if t_new >= end * (1.0 - 1e-15) else t_new


@compiled()
def displace(weights: Array, stage_v: Array, step: float, q: Array, q_new: Array) -> None:
    """q_new <- the displacements after a step; weights: (stages,) of the result."""
    for i in range(q.shape[0]):
        total = 0.0
        for j in range(weights.shape[0]):
            total += weights[j] * stage_v[i, j]
        q_new[i] = q[i] + step * total


@compiled()
def move_on(q: Array, v: Array, a: Array, q_new: Array, stage_v: Array, stage_a: Array) -> None:
    """The state after a step: q_new, and the velocities and accelerations of the last stage."""
    last = stage_v.shape[1] - 1
    for i in range(q.shape[0]):
        q[i], v[i], a[i] = q_new[i], stage_v[i, last], stage_a[i, last]


@compiled()
def keep_past(past: Array, past_now: Array) -> None:
    """The points of a step that is done: its start, its first stage, and its end."""
    end = past.shape[0] - 1
    for i in range(past.shape[1]):
        past_now[0, i], past_now[1, i], past_now[2, i] = past[HISTORY - 1, i], past[HISTORY, i], past[end, i]


@compiled()
def count_step(
    numbers: Array, errors: Array, control: Control, t_new: float, step: float, speed: float, drift: float,
    largest: float,
) -> int:  # fmt: skip
    """Count a step that is done. drift: what its error adds to the error of the run; largest eccentricity at its end.

    Returns RUNNING, or CONTACT where a journal has met a shell that does not give way.
    """
    numbers[TIME] = t_new
    numbers[STEPS] += 1
    numbers[TURNS] += abs(speed) * step / (2.0 * math.pi)
    book_error(numbers, errors, step, drift)
    numbers[LARGEST_EPS] = max(numbers[LARGEST_EPS], largest)
    return CONTACT if control.contact_stiffness == 0.0 and largest >= control.contact_eccentricity else RUNNING


@compiled()
def choose_next(numbers: Array, h: float, error: float, order: float, longest: float) -> None:
    """The step after an accepted one, at most `longest`; error: of the accepted one over the tolerance."""
    numbers[STEP] = min(step_after(h, error, numbers[ERROR_BEFORE], order), longest)
    numbers[ERROR_BEFORE] = error
    numbers[STEP_BEFORE] = h
