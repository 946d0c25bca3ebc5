"""The columns of a fit: its numbers."""

from __future__ import annotations

from typing import Any

from frbcli.columns import Column, Shown


def _in_units(number: Any, value: float) -> str:
    from frbcli.units import display  # of the library of units, which is slow to import

    return display(float(f"{value:.5g}"), number.unit) if number.unit else f"{value:.5g}"


def _error(number: Any) -> str:
    return "at a bound" if number.at_bound else f"{100.0 * number.error / number.value:.2g} %"


def _bounds(number: Any) -> str:
    return f"{_in_units(number, number.low)} to {_in_units(number, number.high)}"


# Of a Fitted; the terminal shows each number in a unit of its own
FITTED = (
    Column("key", "", "key of the case", shown=(Shown("key"),)),
    Column("unit", "", "unit of the numbers, SI"),
    Column("start", "", "value of the case"),
    Column("value", "", "value that was found"),
    Column("error", "", "standard error"),
    Column("low", "", "lower bound"),
    Column("high", "", "upper bound"),
    Column("at_bound", "", "whether the value lies at a bound, so that the error means nothing", flat=False),
    *(Column(head, "", "", value, shown=(Shown(head),), key="", flat=False) for head, value in (
        ("at first", lambda number: _in_units(number, number.start)),
        ("found", lambda number: _in_units(number, number.value)),
        ("error", _error),
        ("between", _bounds),
    )),
)  # fmt: skip
