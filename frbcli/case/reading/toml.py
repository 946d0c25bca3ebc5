"""Read TOML, with a fault for text that is not TOML, and write tables as TOML."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from frbcli.errors import Fault

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
