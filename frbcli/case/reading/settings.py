"""Overrides of single keys of a case, as `--set` gives them.

A case as text: TOML, read with a fault for text that is none, and written; the tables of a case with their units.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from frbcli.case.model import Model, unit_of
from frbcli.case.reading.tables import Path
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
    plain, tables = list[str](), list[str]()
    for key, value in data.items():
        name = key if _BARE.fullmatch(key) else _inline(key)
        inner = (*path, name)
        if isinstance(value, dict):
            tables += ["", f"[{'.'.join(inner)}]", *_table(value, inner)]
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            tables += [line for item in value for line in ("", f"[[{'.'.join(inner)}]]", *_table(item, inner))]
        else:
            plain.append(f"{name} = {_inline(value)}")
    return plain + tables


def _inline(value: Any) -> str:
    """JSON's texts and words are TOML's, but for DEL, which TOML wants escaped."""
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    written = repr(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)
    return written.replace("\x7f", "\\u007f")


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
    match value:
        case None | bool() | str():
            return value
        case Model():
            return as_tables(value)
        case tuple() | list():
            return [_written(item, unit) for item in value]
        case dict():  # of names that are no keys, with their units
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


DEEPEST_KEY = 8
ALL = "*"  # instead of an index: every table of an array

_INDEX = re.compile(r"[0-9]{1,4}")


def with_setting(data: Mapping[str, Any], setting: str) -> tuple[dict[str, Any], Path]:
    """`data` with one `key.path=value` set, and the path that was set; `data` itself stays. Raises TomlFault.

    The value is TOML where it can be ("3", "true", "{ kind = 'none' }"), else text ("40 um"). An index, or a name,
    leads into an array of tables: "bearing.0.width", "bearing.front.width"; "bearing.*.width" sets the key in all. An
    index at the end is a value of a list: "bearing.support.stiffness.1" is the one in y. Index 0, the name, or * of a
    single table are the table itself. """
    key, equals, value = setting.partition("=")
    parts = _parts(key)
    if not (equals and parts and _encodable(setting)):
        raise _refuse("--set", "is not of the form key.path=value.", 'Write e.g. --set speed.to="200 Hz".')
    copy = dict(data)
    return copy, _insert(copy, parts, _value(value), ())


def with_value(data: Mapping[str, Any], key: str, value: Any) -> tuple[dict[str, Any], Path]:
    """As with_setting, with a value as written in a file; None takes the key out. Raises TomlFault."""
    parts = _parts(key)
    if not (parts and _encodable(key)):
        raise _refuse(key or "settings", "is not of the form key.path.", 'Write e.g. {"speed.to": "200 Hz"}.')
    copy = dict(data)
    return copy, _insert(copy, parts, value, ())


def _parts(key: str) -> list[str]:
    """The parts of a dotted key, none if it is no such."""
    parts = [part.strip() for part in key.split(".")]
    return parts if all(parts) and len(parts) <= DEEPEST_KEY else []


def _value(text: str) -> Any:
    try:
        parsed = parse(f"value = {text}")
    except TomlFault:
        return text.strip()
    return parsed["value"] if len(parsed) == 1 else text.strip()


def _encodable(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:  # bytes of a command line that are no UTF-8
        return False
    return True


def _insert(table: dict[str, Any], parts: list[str], value: Any, above: Path) -> Path:
    """Set a value in `table`, copying every table on the way; the path that was set."""
    head, *rest = parts
    path: Path = (*above, head)
    if not rest and value is None:
        table.pop(head, None)
        return path
    if not rest:
        table[head] = value
        return path
    inner = table.get(head, {})
    if isinstance(inner, list):
        table[head] = inner = list(inner)
        return _insert_among(inner, rest, value, path)
    if not isinstance(inner, dict):
        whole = ".".join(map(str, path))
        raise _refuse(f"{whole}.{'.'.join(rest)}", f"is set inside {whole}, which is not a table.", f"Set {whole}.")
    table[head] = inner = dict(inner)
    itself = rest[0] in ("0", ALL) or (rest[0] not in inner and rest[0] == inner.get("name"))
    return _insert(inner, rest[1:] if itself and len(rest) > 1 else rest, value, path)


def _insert_among(items: list[Any], rest: list[str], value: Any, path: Path) -> Path:
    """Set a value within a list: in one of its tables or in all, or one of its values, as of a pair [x, y]."""
    if not all(isinstance(one, dict) for one in items):
        return _insert_value(items, rest, value, path)
    if rest[0] == ALL and len(rest) > 1 and items:
        for number, one in enumerate(items):
            items[number] = dict(one)
            _insert(items[number], rest[1:], value, (*path, number))
        return path
    index = _index(items, rest, path)
    items[index] = dict(items[index])
    return _insert(items[index], rest[1:], value, (*path, index))


def _insert_value(items: list[Any], rest: list[str], value: Any, path: Path) -> Path:
    """Set one of the values of a list, which may be lists, as the rows of a matrix."""
    number = int(rest[0]) if _INDEX.fullmatch(rest[0]) else len(items)
    deeper = number < len(items) and isinstance(items[number], list)
    if number >= len(items) or deeper != (len(rest) > 1) or value is None:
        whole = ".".join(map(str, path))
        problem = f"is no value of {whole}, which has {len(items)}."
        remedy = f"Count from 0, e.g. {whole}.0{'.0' if isinstance(items[0], list) else ''}, or set {whole}."
        raise _refuse(f"{whole}.{'.'.join(rest)}", problem, remedy)
    if deeper:
        items[number] = list(items[number])
        return _insert_value(items[number], rest[1:], value, (*path, number))
    items[number] = value
    return (*path, number)


def _index(tables: list[dict[str, Any]], rest: list[str], path: Path) -> int:
    """The index that leads into an array of tables, and is followed by a key."""
    if len(rest) > 1 and _INDEX.fullmatch(rest[0]) and int(rest[0]) < len(tables):
        return int(rest[0])
    whole = ".".join(map(str, path))
    names = [str(table["name"]) for table in tables if "name" in table]
    if len(rest) > 1 and names.count(rest[0]) == 1 and len(names) == len(tables):
        return names.index(rest[0])
    problem = f"does not say which of the {len(tables)} tables of {whole} is meant."
    by_name = f", or name it: {whole}.{names[0]}.{rest[-1]}" if names else ""
    remedy = f"Count from 0, e.g. {whole}.0.{rest[-1]}{by_name}; {whole}.*.{rest[-1]} is all of them."
    raise _refuse(f"{whole}.{'.'.join(rest)}", problem, remedy)


def _refuse(key: str, problem: str, remedy: str) -> TomlFault:
    return TomlFault(Fault(key, "", None, problem, remedy))
