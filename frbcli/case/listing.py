"""A case as a flat list of its values, for people and for tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args

from pydantic.fields import FieldInfo

from frbcli.case.model import Model
from frbcli.case.quantities import Quantity
from frbcli.case.schema import Case
from frbcli.units import NUMBER, TEMPERATURE_DIFFERENCE, display

# What stands in a case for models that it does not choose.
_MODEL_SECTIONS = ("penalty", "peeken", "elrod", "two-phase")


@dataclass(frozen=True)
class Value:
    """One value of a case. key: as in the file; value: SI number, text, or whole number; unit: SI, "" for none."""

    key: str
    value: float | int | str
    unit: str = ""
    shown: str = ""


def values(case: Case) -> tuple[Value, ...]:
    """Every value of `case` that is set, by itself or by default, in the order of the case file."""
    return tuple(value for value in _values("", case) if not _is_idle(value.key, case))


def _values(prefix: str, model: Model) -> Iterator[Value]:
    for name, field in type(model).model_fields.items():
        key = f"{prefix}{field.alias or name}"
        yield from _one(key, getattr(model, name), field)


def _one(key: str, found: Any, field: FieldInfo) -> Iterator[Value]:
    if found is None or found == () or found == "":
        return
    if isinstance(found, Model):
        yield from _values(f"{key}.", found)
    elif isinstance(found, tuple):
        single = key == "bearing" and len(found) == 1
        for index, item in enumerate(found):
            yield from _one(key if single else f"{key}.{index}", item, field)
    elif isinstance(found, float):
        unit = _unit(field)
        shown = display(found, unit)
        si = "K" if unit == TEMPERATURE_DIFFERENCE else "" if unit == NUMBER else unit
        yield Value(key, found, si, shown)
    else:
        yield Value(key, found, "", str(found))


def _unit(field: FieldInfo) -> str:
    kinds = [part for part in (*field.metadata, *_annotated(field.annotation)) if isinstance(part, Quantity)]
    return kinds[0].unit


def _annotated(annotation: Any) -> Iterator[Any]:
    for part in get_args(annotation):
        yield part
        yield from _annotated(part)


def _is_idle(key: str, case: Case) -> bool:
    """Whether a key belongs to a cavitation model that the case does not use."""
    section, _, rest = key.partition(".")
    model = rest.partition(".")[0]
    return section == "film" and model in _MODEL_SECTIONS and model not in case.cavitations
