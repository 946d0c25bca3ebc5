"""Between the stages of the time loop: the error of a step, its output, the next step. Compiled."""

from __future__ import annotations

import math

from numba import njit

from frbcli.solve.state import OUTPUTS

SAFETY = 0.9  # of the step that the error estimate would allow
GROWTH = 1.2  # a step is enlarged only if it pays for the new inverse
LASTING = 0.95  # of the longest allowed step: a step chosen there lasts a while before the speed outgrows it


@njit(cache=True, error_model="numpy")
def local_error(defect, observed, stage_v, stage_a, step, g):  # type: ignore[no-untyped-def]
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


@njit(cache=True, error_model="numpy")
def write_outputs(numbers, stage_v, output_step, t, step, t_new, q, q_new, out_q, out_v, written):  # type: ignore[no-untyped-def]
    """Dense output: the cubic through displacements and velocities at both ends of a step. Returns rows written."""
    last = stage_v.shape[1] - 1
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


@njit(cache=True, error_model="numpy")
def step_after(h, error, before, order):  # type: ignore[no-untyped-def]
    """Proportional-integral control: the step after an accepted one; errors over the tolerance, now and before."""
    ratio = SAFETY * max(error, 1e-8) ** (-0.7 / order) * max(before, 1e-8) ** (0.3 / order)
    ratio = min(5.0, max(0.2, ratio))
    return h * ratio if ratio < 1.0 or ratio > GROWTH else h


@njit(cache=True, error_model="numpy")
def step_to_take(h, before, remaining, speed, steps_per_revolution, longest):  # type: ignore[no-untyped-def]
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
