"""The cavitation laws cell by cell, compiled: the same as the classes in film/cavitation, which tests hold them to."""

from __future__ import annotations

import math

from numba import njit

from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.peeken import Peeken
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cavitation.reynolds import Reynolds
from frbcli.film.cavitation.sommerfeld import Sommerfeld
from frbcli.film.cavitation.two_phase import TwoPhase

SOMMERFELD, REYNOLDS, PENALTY, PEEKEN, ELROD, TWO_PHASE = range(6)


def law_code(law: Law) -> tuple[int, float, float]:
    """(kind, its first parameter, its second) of a law. Raises KeyError for one that is not compiled."""
    codes: dict[type, tuple[int, tuple[str, ...]]] = {
        Sommerfeld: (SOMMERFELD, ()),
        Reynolds: (REYNOLDS, ()),
        Penalty: (PENALTY, ("prefactor", "steepness")),
        Peeken: (PEEKEN, ("bunsen",)),
        Elrod: (ELROD, ("bulk_modulus",)),
        TwoPhase: (TWO_PHASE, ("steepness", "outer_slope")),
    }
    kind, names = codes[type(law)]
    first, second = [float(getattr(law, name)) for name in names] + [0.0] * (2 - len(names))
    return kind, first, second


@njit(cache=True, error_model="numpy")
def wright_omega(x):  # type: ignore[no-untyped-def]
    """The real solution of omega + ln omega = x, by two steps of Fritsch, Shafer and Crowley's iteration."""
    if x < -36.0:
        return math.exp(x)
    if x < 1.0:
        e = math.exp(x)
        omega = e / (1.0 + e) if x < -1.0 else 0.5671432904097838 + 0.36 * x + 0.07 * x * x
    else:
        omega = x - math.log(x) * (1.0 - 1.0 / (1.0 + x))
    for _ in range(2):
        r = x - omega - math.log(omega)
        q = (1.0 + omega) * (1.0 + omega + 2.0 * r / 3.0)
        omega *= 1.0 + r / (1.0 + omega) * (q - 0.5 * r) / (q - r)
    return omega


@njit(cache=True, error_model="numpy")
def empty_unknown(kind, first, second, reference, cavity, ambient):  # type: ignore[no-untyped-def]
    """w below which a cell is empty and its oil hardly changes any more; -inf for laws without such an end."""
    if kind != TWO_PHASE:
        return -math.inf
    return second * (2.0 * first - 1.0) - 1.0 - 2.0 * (1.0 - first) * (cavity + ambient) / reference


@njit(cache=True, error_model="numpy")
def cell_law(kind, first, second, w, reference, cavity, ambient):  # type: ignore[no-untyped-def]
    """(pressure, oil fraction, source, and their derivatives by w) of one cell; see CellState for their units."""
    if kind == SOMMERFELD:
        return cavity + w * reference, 1.0, 0.0, reference, 0.0, 0.0
    if kind == PENALTY:
        target = w * reference
        omega = wright_omega(math.log(first * second) - second * target)
        above = -math.log(omega / (first * second)) / second if omega > 1.0 else target + omega / second
        slope = reference / (1.0 + omega)
        return cavity + above, 1.0, omega / second, slope, 0.0, -omega * slope
    if kind == ELROD:
        if w > 0.0:
            packed = w * reference / first
            held = math.exp(min(packed, 1.0))
            return cavity + w * reference, held * max(packed, 1.0), 0.0, reference, held * reference / first, 0.0
        return cavity, 1.0 + w, 0.0, 0.0, 1.0, 0.0
    if kind == REYNOLDS:
        if w > 0.0:
            return cavity + w * reference, 1.0, 0.0, reference, 0.0, 0.0
        return cavity, 1.0, -w * reference, 0.0, 0.0, -reference
    absolute = cavity + ambient
    ratio = absolute / reference
    if kind == PEEKEN:
        if w > 0.0:
            return cavity + w * reference, 1.0, 0.0, reference, 0.0, 0.0
        partial = max(w, -1.0 - ratio)
        linear = first + ratio - partial * (1.0 - first)
        root = math.sqrt(max(linear * linear + 4.0 * ratio * (1.0 - first) * partial, 0.0))
        fall = -2.0 * partial / (linear + root)
        steep = first / (1.0 - fall * (1.0 - first)) ** 2
        fall -= (w - partial) / (steep + ratio)
        rise = 1.0 / (steep + ratio)
        return cavity - fall * absolute, 1.0 + w + fall * ratio, 0.0, absolute * rise, steep * rise, 0.0
    return _two_phase(first, second, w, cavity, absolute, ratio)


@njit(cache=True, error_model="numpy")
def _two_phase(steepness, outer_slope, w, cavity, absolute, ratio):  # type: ignore[no-untyped-def]
    """See TwoPhase.cells."""
    x_0 = 2.0 * steepness - 1.0
    bottom = outer_slope * x_0 - 1.0 + (x_0 - 1.0) * ratio
    if w > 0.0 or w < bottom:
        depth, start = (0.0, 0.0) if w > 0.0 else (x_0 - 1.0, bottom)
        rise, slope = depth + (w - start) / (ratio + outer_slope), outer_slope
    else:
        height, m = 1.0 - outer_slope * x_0, outer_slope * (1.0 - x_0) / (1.0 - x_0 * outer_slope)
        cubic, linear = height * (1.0 - m), height * m + (1.0 - x_0) * ratio
        p = (1.5 * cubic + linear) / (2.0 * cubic)
        q = (0.5 * (cubic + linear) - (w - bottom)) / (2.0 * cubic)
        radius = math.sqrt(p / 3.0)
        sine = min(max(q / (2.0 * radius * radius * radius), -1.0), 1.0)
        place = 0.5 - 2.0 * radius * math.sin(math.asin(sine) / 3.0)
        for _ in range(2):
            place = min(max(place, 0.0), 1.0)
            defect = cubic * place * place * (3.0 - 2.0 * place) + linear * place - (w - bottom)
            place -= defect / (6.0 * cubic * place * (1.0 - place) + linear)
        place = min(max(place, 0.0), 1.0)
        rise = (x_0 - 1.0) * (1.0 - place)
        slope = height / (1.0 - x_0) * ((1.0 - m) * 6.0 * place * (1.0 - place) + m)
    by_w = 1.0 / (slope + ratio)
    return cavity + rise * absolute, 1.0 + w - rise * ratio, 0.0, absolute * by_w, slope * by_w, 0.0
