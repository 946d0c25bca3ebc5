"""Implicit Runge-Kutta methods of the time loop: one diagonal coefficient, first stage explicit, last stage the result.

Every implicit stage then has the same linear rotor behind it, so that one small inverse serves a whole step.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

Indices = NDArray[np.int64]

NOISE = 0.1  # how much the amplification of errors counts against the reach of an extrapolation


class Tableau(NamedTuple):
    """Coefficients of an s-stage method of an order: stage (s, s), times (s,), defect (s,) = b - b_embedded."""

    stage: Array
    times: Array
    defect: Array
    order: int
    error_order: int
    guess: Indices


@dataclass(frozen=True)
class Method:
    """A method with its source. embedded_order: order of the solution that the error estimate compares with."""

    name: str
    source: str
    embedded_order: int
    tableau: Tableau


def _method(
    name: str, source: str, rows: list[list[float]], embedded: list[float], order: int, embedded_order: int
) -> Method:
    s = len(rows)
    stage = np.zeros((s, s))
    for i, row in enumerate(rows):
        stage[i, : len(row)] = row
    defect = stage[-1] - np.array(embedded)
    times = stage.sum(axis=1)
    tableau = Tableau(stage, times, defect, order, min(order, embedded_order) + 1, _guess_points(times))
    return Method(name, source, embedded_order, tableau)


def _guess_points(times: Array) -> Indices:
    """(s, 3) the points of the parabola that guesses each stage: near to it, and not so near to each other that the
    errors of the stages are blown up. Steps are taken as equal."""
    points = np.concatenate([[-1.0, times[1] - 1.0], times])
    chosen = np.zeros((len(times), 3), dtype=np.int64)
    for s in range(1, len(times)):

        def badness(three: tuple[int, ...], at: float = times[s]) -> float:
            x = points[list(three)]
            weights = [np.prod([(at - b) / (a - b) for b in x if b != a]) for a in x]
            return float(np.abs(np.prod(at - x)) + NOISE * np.sum(np.abs(weights)))

        chosen[s] = min(combinations(range(2 + s), 3), key=badness)
    return chosen


def _trbdf2() -> Method:
    gamma = 1.0 - np.sqrt(0.5)
    w = np.sqrt(2.0) / 4.0
    rows = [[0.0], [gamma, gamma], [w, w, gamma]]
    embedded = [(1.0 - w) / 3.0, (3.0 * w + 1.0) / 3.0, gamma / 3.0]
    return _method("trbdf2", "Bank et al. 1985; Hosea and Shampine 1996", rows, embedded, 2, 3)


def _esdirk3() -> Method:
    gamma = 1767732205903 / 4055673282236
    rows = [
        [0.0],
        [gamma, gamma],
        [2746238789719 / 10658868560708, -640167445237 / 6845629431997, gamma],
        [1471266399579 / 7840856788654, -4482444167858 / 7529755066697, 11266239266428 / 11593286722821, gamma],
    ]
    embedded = [2756255671327 / 12835298489170, -10771552573575 / 22201958757719, 9247589265047 / 10645013368117,
                2193209047091 / 5459859503100]
    return _method("esdirk3", "Kennedy and Carpenter 2003, ARK3(2)4L[2]SA", rows, embedded, 3, 2)


def _esdirk4() -> Method:
    gamma = 0.25
    rows = [
        [0.0],
        [gamma, gamma],
        [8611 / 62500, -1743 / 31250, gamma],
        [5012029 / 34652500, -654441 / 2922500, 174375 / 388108, gamma],
        [15267082809 / 155376265600, -71443401 / 120774400, 730878875 / 902184768, 2285395 / 8070912, gamma],
        [82889 / 524892, 0.0, 15625 / 83664, 69875 / 102672, -2260 / 8211, gamma],
    ]
    embedded = [4586570599 / 29645900160, 0.0, 178811875 / 945068544, 814220225 / 1159782912, -3700637 / 11593932,
                61727 / 225920]
    return _method("esdirk4", "Kennedy and Carpenter 2003, ARK4(3)6L[2]SA", rows, embedded, 4, 3)


METHODS: dict[str, Method] = {method.name: method for method in (_trbdf2(), _esdirk3(), _esdirk4())}
