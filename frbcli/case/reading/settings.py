"""Overrides of single keys of a case, as `--set` gives them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.toml import TomlFault, parse
from frbcli.errors import Fault

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
    if rest[0] == ALL and len(rest) > 1 and items and all(isinstance(one, dict) for one in items):
        for number, one in enumerate(items):
            items[number] = dict(one)
            _insert(items[number], rest[1:], value, (*path, number))
        return path
    if any(not isinstance(one, dict) for one in items):
        return _insert_value(items, rest, value, path)
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


def _index(tables: list[Any], rest: list[str], path: Path) -> int:
    """The index that leads into an array of tables, and is followed by a key."""
    if len(rest) > 1 and _INDEX.fullmatch(rest[0]) and int(rest[0]) < len(tables):
        index = int(rest[0])
        if isinstance(tables[index], dict):
            return index
    whole = ".".join(map(str, path))
    names = [str(table["name"]) for table in tables if isinstance(table, dict) and "name" in table]
    if len(rest) > 1 and names.count(rest[0]) == 1 and len(names) == len(tables):
        return names.index(rest[0])
    problem = f"does not say which of the {len(tables)} tables of {whole} is meant."
    by_name = f", or name it: {whole}.{names[0]}.{rest[-1]}" if names else ""
    remedy = f"Count from 0, e.g. {whole}.0.{rest[-1]}{by_name}; {whole}.*.{rest[-1]} is all of them."
    raise _refuse(f"{whole}.{'.'.join(rest)}", problem, remedy)


def _refuse(key: str, problem: str, remedy: str) -> TomlFault:
    return TomlFault(Fault(key, "", None, problem, remedy))
