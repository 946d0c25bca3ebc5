"""Quantities with a unit as options of commands."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import click


@dataclass(frozen=True)
class QuantityOption(click.ParamType[float]):
    """A quantity with a unit, as in the example; a bare number is in `unit`, SI. positive: it must be above 0."""

    name: str
    unit: str
    example: str
    positive: bool = True

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        from frbcli.units import quantity

        with suppress(ValueError):  # then it has a unit
            value = float(str(value))
        try:
            found = quantity(value, self.unit, self.example)
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)
        if self.positive and found <= 0.0:
            self.fail(f'{value!r} is not greater than 0. Write e.g. "{self.example}".', param, ctx)
        return found


SPEED_OPTION = QuantityOption("speed", "Hz", "25 Hz")
TIME_OPTION = QuantityOption("time", "s", "0.2 s", positive=False)
LENGTH_OPTION = QuantityOption("length", "m", "35 um")
LOAD_OPTION = QuantityOption("load", "N", "30 N")
STIFFNESS_OPTION = QuantityOption("stiffness", "N/m", "5e6 N/m")
