"""The events of a run as rows of a table."""

from __future__ import annotations

from typing import Any

from frbcli.results.records import event_place

EVENT_COLUMNS = ("event", "time in s", "speed in Hz", "frequency in Hz", "ratio")


def event_row(event: dict[str, Any]) -> tuple[str, ...]:
    """One event, in these columns."""

    def number(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    return (
        f"{event['kind']} {event_place(event)}".rstrip(),
        number(event["t_s"], ".3f"),
        number(event["speed_Hz"], ".1f"),
        number(event["frequency_Hz"], ".1f"),
        number(event["frequency_ratio"], ".3f"),
    )
