"""A case as text: the tables that a case file has for its values, each number with its unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from frbcli.case.model import Model
from frbcli.case.quantities import unit_of
from frbcli.case.reading.toml import to_toml
from frbcli.units import NUMBER, display, quantity, readable


def as_text(case: Model, name: str, bearing_names: Sequence[str]) -> str:
    """TOML text of everything that is set in the Case `case` of this name; loading it gives the case again."""
    tables = {"name": name, **as_tables(case)}
    bearings = tables.get("bearing", [])
    if len(bearings) > 1:
        for table, bearing_name in zip(bearings, bearing_names, strict=True):
            table["name"] = bearing_name  # a file without names would number them
    elif bearings:
        tables["bearing"] = bearings[0]
    if len(tables.get("base", [])) == 1:
        tables["base"] = tables["base"][0]
    return to_toml(tables)


def as_tables(model: Model) -> dict[str, Any]:
    """The values that are set in `model`, by the keys of the case file."""
    tables: dict[str, Any] = {}
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if name == "kind" or name in model.model_fields_set or value != field.default:
            written = _written(value, unit_of(field))
            if written not in (None, "", []):
                tables[field.alias or name] = written
    return tables


def _written(value: Any, unit: str | None) -> Any:
    """A value as written in a file; None for one that no file can have."""
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, Model):
        return as_tables(value)
    if isinstance(value, tuple | list):
        return [_written(item, unit) for item in value]
    if isinstance(value, dict):  # of names that are no keys, with their units
        return dict(value)
    if unit is None:
        return int(value)
    number = float(value)
    if not math.isfinite(number):
        return None
    return number if unit == NUMBER else _with_unit(number, unit)


def _with_unit(value: float, unit: str) -> str:
    """With a usual unit where that is exact, else in SI with all digits."""
    shown = display(value, unit)
    return shown if quantity(shown, unit) == value else f"{value!r} {readable(unit)}"
