"""Rotor speeds as options of commands."""

from __future__ import annotations

from contextlib import suppress

import click


class RotorSpeed(click.ParamType[float]):
    """A rotor speed with a unit, "25 Hz" or "1500 rpm"; a bare number is in Hz. Greater than zero."""

    name = "speed"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        from frbcli.units import SPEED, quantity

        with suppress(ValueError):  # then it has a unit
            value = float(str(value))
        try:
            speed = quantity(value, SPEED, "25 Hz")
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)
        if speed <= 0.0:
            self.fail(f'{value!r} is not greater than 0. Write e.g. "25 Hz".', param, ctx)
        return speed
