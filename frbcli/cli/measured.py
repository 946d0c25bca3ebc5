"""Options that say where a motion stands in the file of a measurement, and the run that it makes."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.speeds import RotorSpeed

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.results.store import Run

Function = TypeVar("Function", bound=Callable[..., Any])


class Size(click.ParamType[float]):
    """A length with a unit, "35 um"; a bare number is in m. Greater than zero."""

    name = "length"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        from frbcli.units import quantity

        try:
            size = quantity(value, "m", "35 um")
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)
        if size <= 0.0:
            self.fail(f'{value!r} is not greater than 0. Write e.g. "35 um".', param, ctx)
        return size


def measured_options(function: Function) -> Function:
    """Give a command the options of a measurement; it receives `measurement: Measurement | None`."""

    @wraps(function)
    def with_measurement(
        *words: Any, x: str | None, y: str | None, time_column: str | None, rate: float | None, speed: str | None,
        speed_at: float | None, tacho: str | None, pulses: int, unit: float, clearance: float | None, **others: Any,
    ) -> Any:  # fmt: skip
        from frbcli.analysis.measured import Measurement

        told = None
        if x is not None:
            if clearance is None:
                raise click.UsageError("A measurement needs --clearance, to which amplitudes refer.")
            told = Measurement(x, clearance, y, time_column, rate, speed, speed_at, tacho, pulses, unit)
        return function(*words, measurement=told, **others)

    options = (
        click.option("--x", metavar="COLUMN", help="Of a measurement: the displacement in x."),
        click.option("--y", metavar="COLUMN", help="The displacement in y; events need it."),
        click.option("--time", "time_column", metavar="COLUMN", help="The times in s."),
        click.option("--rate", type=click.FloatRange(min=0.0, min_open=True), help="Samples per second."),
        click.option("--speed", metavar="COLUMN", help="The rotor speed in Hz."),
        click.option("--speed-at", type=RotorSpeed(), metavar="SPEED", help='A constant rotor speed, e.g. "100 Hz".'),
        click.option("--tacho", metavar="COLUMN", help="A signal with a pulse per revolution, in place of the speed."),
        click.option("--pulses", type=click.IntRange(min=1), default=1, show_default=True, help="Per revolution."),
        click.option("--unit", type=Size(), default="1 um", show_default=True, help="What 1 in x and y is."),
        click.option("--clearance", type=Size(), metavar="LENGTH", help='0 dB, and that of the bearing, e.g. "35 um".'),
    )
    decorated: Any = with_measurement
    for option in reversed(options):
        decorated = option(decorated)
    return decorated  # type: ignore[no-any-return]


def run_of(path: Path, measurement: Measurement | None) -> Run:
    """The run in a file: a computed one, or a measurement. Raises as read_run and measured_run do."""
    from frbcli.results.measured import SUFFIXES

    if path.suffix.lower() in SUFFIXES:
        if measurement is None:
            raise click.UsageError(f"{path} is a measurement: say by --x COLUMN where its motion stands.")
        from frbcli.analysis.measured import measured_run

        return measured_run(path, measurement)
    if measurement is not None:
        raise click.UsageError(f"{path} is a run, which needs no --x.")
    from frbcli.results.store import read_run

    return read_run(path)
