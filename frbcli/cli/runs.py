"""What the commands share that read runs: RUN.h5, times with a unit, where a result goes."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

import click


class Seconds(click.ParamType[float]):
    """A time with a unit, "0.2 s" or "200 ms"; a bare number is in seconds."""

    name = "time"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        from frbcli.units import quantity

        with suppress(ValueError):  # then it has a unit
            value = float(str(value))
        try:
            return quantity(value, "s", "0.2 s")
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)


RUN = click.Path(path_type=Path)
OUTPUT = click.Path(path_type=Path)
SECONDS = Seconds()


def beside(run: Path, what: str) -> Path:
    """The default place of a result: beside its run."""
    return run.parent / (run.stem + what)


def here(case_name: str, what: str) -> Path:
    """The default place of the result of a case: this directory, under the name of the case."""
    return Path((re.sub(r"[^\w.-]+", "-", case_name) or "run") + what)
