"""What a run file must look like inside: its records, and the signals that the others are drawn over."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FINITE = ("time_s", "speed_Hz")  # signals that others are drawn over
RISING = "time_s"
EVENT_NUMBERS = ("t_s", "speed_Hz")  # every event has them
EVENT_OPTIONAL = ("frequency_Hz", "frequency_ratio")


def wrong_record(records: Mapping[str, Any]) -> str:
    """The name of the first record with a wrong form, "" if there is none.

    versions: names -> text; references: names -> finite numbers; cost, error: tables; events: a list of tables, each
    with kind, time and speed, and with film and frequency where the event has them.
    """
    forms: dict[str, Callable[[Any], bool]] = {
        "versions": lambda record: _is_table(record, lambda value: isinstance(value, str)),
        "references": lambda record: _is_table(record, lambda value: _is_number(value) and math.isfinite(value)),
        "cost": lambda record: isinstance(record, dict),
        "error": lambda record: isinstance(record, dict),
        "events": lambda record: isinstance(record, list) and all(map(_is_event, record)),
    }
    return next((name for name, holds in forms.items() if not holds(records[name])), "")


def wrong_signal(signals: Mapping[str, NDArray[np.float64]]) -> str:
    """The name of time or speed (n,) if it is not finite, or of a time that runs backwards, "" if all is well."""
    for name in FINITE:
        if name in signals and not np.isfinite(signals[name]).all():
            return name
    return RISING if RISING in signals and (np.diff(signals[RISING]) < 0.0).any() else ""


def _is_table(record: Any, holds: Callable[[Any], bool]) -> bool:
    return isinstance(record, dict) and all(map(holds, record.values()))


def _is_event(record: Any) -> bool:
    return (
        isinstance(record, dict)
        and isinstance(record.get("kind"), str)
        and all(_is_number(record.get(name)) for name in EVENT_NUMBERS)
        and all(record.get(name) is None or _is_number(record[name]) for name in EVENT_OPTIONAL)
        and isinstance(record.get("film"), str | None)
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
