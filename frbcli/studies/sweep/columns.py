"""The columns of a sweep: its points."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

from frbcli.columns import Column, Shown, with_uncertainty

EVENTS = {
    "runup": ("critical-speed", "self-excited", "onset", "offset", "lock-in", "contact"),
    "stability": ("threshold",),
}
TOLD = ("onset", "threshold")  # events in the table of the terminal
LONGEST_REASON = 100  # characters in the table of the terminal


def reason(point: Any) -> str:
    """Why a point has no result, no longer than a cell of a table; the message has all of it."""
    event = point.first("threshold") or point.first("onset")
    return "" if event is not None else textwrap.shorten(point.message, LONGEST_REASON, placeholder=" ...")


def _setting(key: str) -> Callable[[Any], str | None]:
    return lambda point: point.settings.get(key)


def _cost(name: str) -> Callable[[Any], float]:
    return lambda point: _number(point.cost.get(name))


def _first(kind: str, key: str) -> Callable[[Any], float]:
    return lambda point: _number((point.first(kind) or {}).get(key))


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


NUMBER = Column("point", "", "number of the point, from 1", attrgetter("number"), shown=(Shown(""),), key="")
RESULT = (
    Column("set", "", "values of the keys, as text", attrgetter("settings"), flat=False),
    Column("status", "", "how the run ended; `input-error`, `error` or `interrupted` without a run"),
    Column("message", "", "why, where it is not `finished`"),
    Column("events", "", "events of the run, or the threshold", flat=False),
    Column("cost", "", "cost of the run", flat=False),
    Column("run", "", "run file, if it is kept", flat=False),
)
COST = tuple(
    Column(quantity, "s", f"{words} time", _cost(f"{quantity}_s"), key="")
    for quantity, words in (("cpu", "CPU"), ("wall", "elapsed"))
)
REASON = Column("reason", "", "", reason, shown=(Shown("reason"),), key="", flat=False)
ENDED = Column("ended", "", "", attrgetter("status"), shown=(Shown("status"),), key="", flat=False)


def point_columns(keys: Sequence[str], method: str, reasons: bool = False) -> tuple[Column, ...]:
    """The columns of a SweepPoint of a sweep over some keys of the case. reasons: whether some have no result."""
    settings = (
        Column(key, "", f"value of {key}, as text", _setting(key), shown=(Shown(key),), key="")
        for key in keys
    )  # fmt: skip
    return (NUMBER, *settings, *RESULT, *(one for kind in EVENTS[method] for one in event_columns(kind)), *COST, ENDED,
            *([REASON] if reasons else []))  # fmt: skip


def event_columns(kind: str) -> tuple[Column, ...]:
    """Rotor speed and frequency at the first event of a kind, with their uncertainties where the point has them."""
    name, found = kind.replace("-", "_").removesuffix("_speed"), []
    wanted = (("speed", kind, "rotor speed"), ("frequency", "frequency", "frequency of the motion"))
    for quantity, head, words in wanted:
        value, uncertainty = _first(kind, f"{quantity}_Hz"), _first(kind, f"{quantity}_uncertainty_Hz")
        at = f"at the first event `{kind}`"
        found.append(Column(f"{name}_{quantity}", "Hz", f"{words} {at}", value, key=""))
        found.append(
            Column(f"{name}_{quantity}_uncertainty", "Hz", f"uncertainty of the {words} {at}", uncertainty, key="")
        )
        if kind in TOLD:
            shown = (Shown(head),)
            found.append(Column(head, "", "", _told(value, uncertainty), shown=shown, key="", flat=False))
    return tuple(found)


def _told(value: Callable[[Any], float], uncertainty: Callable[[Any], float]) -> Callable[[Any], str | None]:
    def told(point: Any) -> str | None:
        number = value(point)
        return None if math.isnan(number) else f"{with_uncertainty(number, uncertainty(point), 1)} Hz"

    return told
