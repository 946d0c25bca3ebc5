"""A case as text: TOML, read with a fault for text that is none, and written; the tables of a case with their units."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from frbcli.case.model import Model, unit_of
from frbcli.errors import Fault
from frbcli.units import NUMBER, display, quantity, readable

_LINE = re.compile(r"\s*\(at line (\d+), column \d+\)")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_KEY_END = re.compile(r"[=,{]")
_STRING = re.compile(r"""\"(?:[^"\\]|\\.)*"|'[^']*'""")
DEEPEST = 30  # tables and lists in each other; what reads them recurs once or twice for each
LONGEST_KEY = DEEPEST  # dots; a case has three, and tomllib takes minutes for some ten thousand


class TomlFault(Exception):
    """A text or a setting that cannot be read, with its fault."""

    def __init__(self, fault: Fault) -> None:
        self.fault = fault
        super().__init__(str(fault))


def parse(text: str) -> dict[str, Any]:
    """The tables of `text`. Raises TomlFault."""
    for line, content in enumerate(text.split("\n"), 1):
        if content.count(".") > LONGEST_KEY and _has_long_key(content):
            raise TomlFault(Fault("text", "", line, "has a key with too many dots.", "Write: key = value."))
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = _LINE.search(str(error))
        line = int(match.group(1)) if match else text.count("\n") + 1
        problem = f"is not TOML: {_LINE.sub('', str(error)).replace(' (at end of document)', ' at the end')}."
        raise TomlFault(Fault("text", "", line, problem, 'Write: key = value, with text in "quotes".')) from None
    except RecursionError:
        raise _too_deep() from None
    except ValueError as error:  # whole numbers of thousands of digits, dates like 2000-99-99
        raise TomlFault(Fault("text", "", None, f"cannot be read: {error}.", "Write plain numbers.")) from None
    if _is_too_deep(tables):
        raise _too_deep()
    return tables


def _too_deep() -> TomlFault:
    return TomlFault(Fault("text", "", None, "is nested too deeply.", "Write tables as [table.table]."))


def _has_long_key(line: str) -> bool:
    """Whether a line has what may be a key with too many dots: numbers in a list end at commas."""
    bare = _STRING.sub("s", line).partition("#")[0]
    return any(part.count(".") > LONGEST_KEY for part in _KEY_END.split(bare))


def _is_too_deep(tables: dict[str, Any]) -> bool:
    level: list[Any] = [tables]
    for _ in range(DEEPEST):
        inner = (item for value in level for item in (value.values() if isinstance(value, dict) else value))
        level = [item for item in inner if isinstance(item, dict | list)]
    return bool(level)


def to_toml(data: Mapping[str, Any]) -> str:
    """`data` (tables, lists, text, numbers, booleans) as TOML text; parsing it gives `data` again."""
    return "\n".join(_table(data, ())) + "\n"


def _table(data: Mapping[str, Any], path: tuple[str, ...]) -> list[str]:
    lines = [f"{_key(key)} = {_inline(value)}" for key, value in data.items() if not _is_table(value)]
    for key, value in data.items():
        if not _is_table(value):
            continue
        inner = (*path, _key(key))
        many = isinstance(value, list)
        for table in value if many else [value]:
            header = f"[[{'.'.join(inner)}]]" if many else f"[{'.'.join(inner)}]"
            lines += ["", header, *_table(table, inner)]
    return lines


def _is_table(value: Any) -> bool:
    tables = isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)
    return isinstance(value, dict) or tables


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _text(key)


def _inline(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return f"[{', '.join(_inline(item) for item in value)}]"
    return repr(value)


def _text(text: str) -> str:
    """JSON's escapes are TOML's, but for DEL, which TOML wants escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


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
