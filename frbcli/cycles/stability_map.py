"""Hopf points and folds over the rotor speed and a second number of the case: a stability map."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from frbcli.case.load import load_case_text
from frbcli.case.schema import Case
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.cycles.result import SpecialPoint
from frbcli.errors import Fault, InputError, NotConverged

if TYPE_CHECKING:
    import pandas as pd

NUMBER = re.compile(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(.*?)\s*")


@dataclass(frozen=True)
class MapRow:
    """The special points at one value of the second number; problem: why there are none, else empty."""

    value: float
    special: tuple[SpecialPoint, ...]
    problem: str = ""


@dataclass(frozen=True)
class StabilityMap:
    """rows: ascending in the value of the key, in `unit`."""

    case: Case
    key: str
    unit: str
    rows: tuple[MapRow, ...]

    def to_pandas(self) -> pd.DataFrame:
        """One row per value and special point."""
        import pandas as pd

        return pd.DataFrame(
            {
                self.key: row.value,
                "unit": self.unit,
                "kind": point.kind,
                "branch": point.branch,
                "speed_Hz": point.speed_Hz,
                "frequency_Hz": point.frequency_Hz,
                "criticality": point.criticality,
            }
            for row in self.rows
            for point in row.special
        )


def stability_map(
    case: Case, key: str, low: str, high: str, count: int, observe: Callable[[int, int], None] | None = None
) -> StabilityMap:
    """The diagrams of a case at `count` values of a key from `low` to `high`, as text with their unit.

    observe: called with the number of each value and their number. Raises InputError if the values are none, or if the
    case cannot have one of them.
    """
    first, last, unit = value_range(case, key, low, high)
    values = [first + (last - first) * i / (count - 1) for i in range(count)]
    cases = [load_case_text(case.source_text, [f"{key}={value!r} {unit}".strip()], case.name) for value in values]
    rows = []
    for number, (value, one) in enumerate(zip(values, cases, strict=True)):
        try:
            rows.append(MapRow(value, limit_cycles(one).special))
        except NotConverged as error:
            rows.append(MapRow(value, (), str(error)))
        if observe is not None:
            observe(number + 1, count)
    return StabilityMap(case, key, unit, tuple(rows))


def value_range(case: Case, key: str, low: str, high: str) -> tuple[float, float, str]:
    """The ends of a range, text with one unit, and that unit. Raises InputError."""
    (first, unit), (last, other) = _number(key, low), _number(key, high)
    if unit != other or not first < last:
        problem, remedy = "is no range of one unit.", f'Write e.g. --from "40 um" --to "90 um", not {low} to {high}.'
        raise InputError(case.name or "case", (Fault(key, f"{low} to {high}", None, problem, remedy),))
    return first, last, unit


def _number(key: str, text: str) -> tuple[float, str]:
    """A number and its unit."""
    found: Sequence[str] | None = None if (match := NUMBER.fullmatch(text)) is None else match.groups()
    if found is None:
        raise InputError(key, (Fault(key, text, None, "is no number with a unit.", 'Write e.g. "40 um".'),))
    return float(found[0]), found[1]
