"""Values over time, as they were read from a file."""

from __future__ import annotations

import itertools
from typing import Annotated

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Label, Quantity
from frbcli.units import NUMBER

Entry = Annotated[float, Quantity(NUMBER, "0.5")]


class OverTime(Model):
    """Values at several times, as they were read from a file: linear between them. All in SI."""

    source: Label = Field(default="", description="the file that they were read from")
    time: tuple[Entry, ...] = Field(description="in s, ascending")
    x: tuple[Entry, ...] = Field(description="value in x, or of the one quantity, at each time")
    y: tuple[Entry, ...] = Field(default=(), description="value in y; that in x if not given")

    @property
    def both(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The values in x and in y."""
        return self.x, self.y or self.x

    @property
    def told(self) -> str:
        """Where it is from, in words."""
        return f"{len(self.time)} rows of {self.source}" if self.source else f"{len(self.time)} rows"


def over_time_problem(time: tuple[float, ...], *columns: tuple[float, ...]) -> str:
    """What is wrong with the numbers of a table, "" if nothing."""
    if any(len(column) not in (0, len(time)) for column in columns) or len(time) < 2:
        return "needs at least two times, and a value at each of them."
    if any(later <= earlier for earlier, later in itertools.pairwise(time)):
        return "has times that do not rise."
    return ""
