"""A case as a flat list of its values, for tables, and which of its keys are numbers of the machine."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic.fields import FieldInfo

from frbcli.case.model import Model, unit_of
from frbcli.case.reading.settings import parse
from frbcli.case.reading.tables import at
from frbcli.case.rules.film_checks import OF_SPRING, WITH_DEFAULT
from frbcli.case.schema import Case
from frbcli.errors import Fault, printable
from frbcli.film.cavitation import table
from frbcli.units import NUMBER, PER_MINUTE, SPEED, display, is_per_minute, readable

MOST_LISTED = 12  # numbers of a list; of a table from a file only the count is listed


@dataclass(frozen=True)
class Value:
    """One value of a case. key: as in the file; value: SI number, text, or whole number; unit: SI, "" for none; bare:
    whether it was written without its unit, and so taken as SI."""

    key: str
    value: float | int | str
    unit: str = ""
    shown: str = ""
    bare: bool = False

    @property
    def cells(self) -> tuple[str, str]:
        """The value in SI, and as engineers write it where it has a unit."""
        number = f"{self.value:.6g}" if isinstance(self.value, float) else printable(str(self.value))
        return f"{number} {self.unit}".rstrip(), self.shown if self.unit else ""


def values(case: Case) -> tuple[Value, ...]:
    """Every value of `case` that is set, by itself or by default, in the order of the case file."""
    return tuple(value for value in _values("", case, parse(case.source_text)) if not _is_idle(value.key, case))


def _values(prefix: str, model: Model, written: Any) -> Iterator[Value]:
    for name, field in type(model).model_fields.items():
        key = field.alias or name
        yield from _one(f"{prefix}{key}", getattr(model, name), field, at(written, (key,)))


def _one(key: str, content: Any, field: FieldInfo, written: Any) -> Iterator[Value]:
    """written: the same value in the text of the case, None where it is not there."""
    in_table = isinstance(written, dict)
    match content:
        case None | () | "":
            return
        case Model():
            yield from _values(f"{key}.", content, written)
        case (first, *_) if in_table and hasattr(first, "place"):
            yield from _by_place(key, content, written)
        case (float(), *_) if len(content) > MOST_LISTED:
            yield Value(key, len(content), "", f"{len(content)} values")
        case tuple():
            both = in_table and len(content) > 1  # one table for both ends of a cartridge
            single = both or (key in ("bearing", "base") and len(content) == 1)
            each = written if isinstance(written, list) else [written] * len(content)
            for index, (item, its_text) in enumerate(zip(content[:1] if both else content, each, strict=not both)):
                yield from _one(key if single else f"{key}.{index}", item, field, its_text)
        case float():
            unit = unit_of(field) or NUMBER
            si = "" if unit == NUMBER else readable(unit)
            per_minute = unit == SPEED and is_per_minute(written)
            shown = f"{PER_MINUTE * content:.6g} rpm" if per_minute else display(content, unit)
            yield Value(key, content, si, shown, bool(si) and isinstance(written, int | float))
        case _:
            yield Value(key, content, "", str(content))


def _by_place(key: str, items: tuple[Any, ...], written: dict[str, Any]) -> Iterator[Value]:
    """Values of a list of models that is written as a table by their places."""
    for item in items:
        fields = type(item).model_fields
        (name,) = fields.keys() - {"place"}
        yield from _one(f"{key}.{item.place}", getattr(item, name), fields[name], written.get(item.place))


def _is_idle(key: str, case: Case) -> bool:
    """Whether a key belongs to a cavitation or contact model that the case does not use."""
    section, _, rest = key.partition(".")
    if section == "contact":
        return rest in (OF_SPRING if case.contact.rough else WITH_DEFAULT)
    model = rest.partition(".")[0]
    return section == "film" and model in table.names() and model not in case.cavitations


OF_THE_RUN = ("name", "title", "confirm", "speed", "motion", "start", "accuracy", "output")
TABLES = tuple(
    key for key in (field.alias or name for name, field in Case.model_fields.items()) if key not in OF_THE_RUN
)
# Keys of these tables that are no numbers of the machine: of the reduction of its rotor, of kinematic tests, of the
# course and the end of a run.
OTHERS = re.compile(
    r"rotor\.cutoff|drive\.(start|to|duration|down_duration|reaction)|.*\.ramp|.*\.clearance_steps\..*\.time|"
    r".*\.loss\.time|thermal\.hottest_film|contact\.eccentricity"
)

_NUMBERED = re.compile(r"\.\d+(?=\.|$)")


def machine_fault(key: str, option: str) -> Fault | None:
    """Why a key cannot be varied as a number of the machine; None if it is one. option: where it was given."""
    table = key.partition(".")[0].strip()
    if table in TABLES and not OTHERS.fullmatch(_NUMBERED.sub(".0", key.strip())):
        return None
    problem = "is no number of the machine: it is a setting of the run or of its computation."
    tables = ", ".join(f"[{name}]" for name in TABLES[:-1])
    remedy = f"Vary a key of {tables} or [{TABLES[-1]}], e.g. bearing.clearance; frb sweep takes any key."
    return Fault(option, key, None, problem, remedy)
