"""Rows of docs/textbooks.md: a figure of a source, and what the program has for it."""

import math
from collections.abc import Callable
from dataclasses import dataclass

PRINTED, CLOSED, PROGRAM = "printed", "closed form", "other program"  # where the figure of a source comes from
MARKS = {PRINTED: "", CLOSED: " (c)", PROGRAM: " (p)"}


@dataclass(frozen=True)
class Row:
    """name: of the rotor, bearing or damper; source: with page, table or equation; kind: of the figure; quantity: with
    its unit; expected, found: of the source and of the program; error: relative one that the program states, NaN if it
    states none; bound: relative deviation beyond which the row fails; reason: for a deviation beyond error and digits.
    """

    name: str
    source: str
    kind: str
    quantity: str
    expected: float
    found: float
    error: float
    bound: float
    reason: str = ""

    @property
    def deviation(self) -> float:
        """Relative; absolute of a figure that is zero."""
        return self.found / self.expected - 1.0 if self.expected else self.found

    @property
    def holds(self) -> bool:
        """Whether the deviation is within the bound."""
        return abs(self.deviation) <= self.bound

    @property
    def given(self) -> tuple[str, ...]:
        """Texts of a row of the page up to the figure of the source; the first one is of all rows of a machine."""
        return f"{self.name}: {self.source}{MARKS[self.kind]}", self.quantity, f"{self.expected:.6g}"

    def cells(self) -> tuple[str, ...]:
        """Texts of a row of the page, but for the number of its reason."""
        error = "" if math.isnan(self.error) else f", {float(f'{100.0 * self.error:.1g}'):g}"
        return *self.given[:2], f"{self.given[2]}, {self.found:.6g}", _percent(self.deviation) + error


def _percent(share: float) -> str:
    """A deviation in %; below a millionth it is round-off of one machine or the other."""
    return "<1e-4" if abs(share) < 1e-6 else f"{float(f'{100.0 * share:.2g}'):+g}"


Bench = Callable[[], list[Row]]
