"""What was measured of one row of docs/validation.md, and as which text it is shown."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Measured:
    """text: as shown; value: to compare with a printed number, NaN if there is none; holds: whether an order holds."""

    text: str
    value: float = math.nan
    holds: bool = True


def number(value: float, digits: int) -> Measured:
    """A number, shown with `digits` decimals."""
    return Measured(f"{value:.{digits}f}", value)


def listed(values: Sequence[float], form: str) -> str:
    """Values as text, each in the form given, "none" for NaN."""
    return ", ".join("none" if math.isnan(value) else format(value, form) for value in values)


def speeds(thresholds: Sequence[float]) -> str:
    """Thresholds as text."""
    words = {0.0: "unstable at once", math.inf: "stable"}
    return ", ".join(words.get(value, f"{value:.1f} Hz") for value in thresholds)


def rises(values: Sequence[float]) -> bool:
    """Whether each value is above the one before it."""
    return all(a < b for a, b in itertools.pairwise(values))


def with_reasons(rows: Sequence[str], reasons: Sequence[str]) -> list[str]:
    """Rows of a table with the number of their reason in the last cell, and the reasons as a list below; "": none."""
    numbers = {reason: number for number, reason in enumerate(dict.fromkeys(filter(None, reasons)), 1)}
    lines = [
        f"{row.removesuffix(' |')} ({numbers[reason]}) |" if reason else row
        for row, reason in zip(rows, reasons, strict=True)
    ]
    notes = [f"{number}. {reason[0].upper()}{reason[1:]}." for reason, number in numbers.items()]
    return [*lines, *(["", "Reasons:", "", *notes] if notes else [])]
