"""Time stamps of measured files, turned into seconds: dates with times of the day, or times of the day alone."""

from __future__ import annotations

import re
from datetime import datetime
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array

if TYPE_CHECKING:
    import pandas as pd

_DATE = r"\d{4}-\d\d?-\d\d?|\d{4}/\d\d?/\d\d?|\d\d?\.\d\d?\.\d{4}|\d\d?/\d\d?/\d{4}"
_PARTS = rf"(?:({_DATE})[T ]\s*)?(\d\d?):(\d\d):(\d\d(?:[.,]\d*)?)\s*(AM|PM|am|pm)?(?:Z|[+-]\d\d:?\d\d)?"
STAMP = re.compile(_PARTS)
DATES = ("%Y-%m-%d", "%Y/%m/%d", "%d.%m.%Y", "%m/%d/%Y", "%d/%m/%Y")
DAY_s, HALF_DAY_s = 86400.0, 43200.0


def seconds(stamps: pd.Series) -> Array | None:
    """Seconds (n,) from the first of n time stamps on, NaN at gaps; None if they are none.

    Dates that can be read in two orders of day and month are read in the one in which they lie closer together. Times
    without a date that fall by more than half a day have passed midnight.
    """
    parts = stamps.astype(str).str.strip().str.extract(f"^{_PARTS}$")
    known = parts[1].notna().to_numpy()
    if 2 * np.sum(known) <= len(parts):
        return None
    hours = parts[1].astype(float)
    half = parts[4].str.lower()
    hours = hours.where(half.isna(), hours % 12) + 12.0 * (half == "pm")
    of_day = hours * 3600.0 + parts[2].astype(float) * 60.0 + parts[3].str.replace(",", ".").astype(float)
    clock_s = of_day.to_numpy(dtype=np.float64)
    first = int(np.argmax(known))
    return np.asarray(clock_s - clock_s[first] + DAY_s * _days(parts[0], clock_s, known))


def _days(dates: pd.Series, of_day: Array, known: Array) -> Array:
    """Days (n,) from the first time stamp on; of_day: seconds (n,) of the day."""
    if dates[known].isna().any():
        days = np.zeros(len(of_day))
        days[known] = np.concatenate([[0.0], np.cumsum(np.diff(of_day[known]) < -HALF_DAY_s)])
        return days
    written = list(dict.fromkeys(dates[known]))
    spans = [days for days in (_in_order(written, order) for order in DATES) if days is not None]
    if not spans:
        return np.full(len(of_day), np.nan)
    number = dict(zip(written, min(spans, key=max), strict=True))
    return np.asarray(dates.map(number), dtype=np.float64)


def _in_order(dates: list[str], order: str) -> list[float] | None:
    """Days from the first of some dates on; None if they are not written in this order, or fall."""
    try:
        days = [float((datetime.strptime(date, order) - datetime.strptime(dates[0], order)).days) for date in dates]
    except ValueError:
        return None
    return days if days == sorted(days) else None
