"""The tables of a case file as the user wrote them.

The lines of the keys, which the parser of TOML does not report and faults need, and the breaches that the rules find.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from frbcli.units import ValueFault, quantity

Path = tuple[str | int, ...]

# The tokens of TOML but for blanks and comments; the end of a line closes a value.
_TOKEN = re.compile(
    r'''("{3}(?:\\.|[^\\])*?"{3,5}|'{3}.*?'{3,5}|"(?:\\.|[^"\\])*"|'[^']*'|'''  # texts
    r'''[][{}=.,\n]|[^][{}=.,\n \t\r#"']+)|#[^\n]*''',
    re.DOTALL,
)
_VALUE_END = ("", ",", "]", "}", "\n")


def key_lines(text: str) -> dict[Path, int]:
    """The 1-based line of every key and table of `text`, which must be valid TOML.

    A path holds keys and, inside of arrays, indices: ("bearing", 1, "width").
    """
    scanner = _Scanner([*_tokens(text)])
    scanner.document()
    return scanner.lines


def _tokens(text: str) -> Iterator[tuple[str, int]]:
    """The tokens of a text with their lines, and an empty one at its end."""
    line = 1
    for match in _TOKEN.finditer(text):
        if match[1]:
            yield match[1], line
            line += match[1].count("\n")
    yield "", line


@dataclass
class _Scanner:
    """Reads the tokens of a text that is known to be valid once, for its keys alone."""

    tokens: list[tuple[str, int]]
    at: int = 0
    lines: dict[Path, int] = field(default_factory=dict)
    arrays: dict[Path, int] = field(default_factory=dict)  # array of tables -> index of its newest table

    def document(self) -> None:
        table: Path = ()
        while self.tokens[self.at][0]:
            if self._takes("["):
                table = self._header()
            elif not self._takes("\n"):
                self._assignment(table)

    def _header(self) -> Path:
        many = self._takes("[")
        path = self._key(())
        if many:
            newest = self.arrays.get(path, -1) + 1
            self.arrays[path] = newest
            self._note(path)
            path = (*path, newest)
        self._note(path)
        self.at += 2 if many else 1
        return path

    def _assignment(self, table: Path) -> None:
        path = self._key(table)
        self._note(path)
        self.at += 1  # the equals sign
        self._value(path)

    def _key(self, table: Path) -> Path:
        """A dotted key under `table`; in a header, arrays of tables on the way mean their newest table."""
        path = (*table, self._key_part())
        while self._takes("."):
            self._note(path)
            if path in self.arrays:
                path = (*path, self.arrays[path])
            path = (*path, self._key_part())
        return path

    def _key_part(self) -> str:
        part, _ = self.tokens[self.at]
        self.at += 1
        return str(tomllib.loads(f"v={part}")["v"]) if part[0] in "'\"" else part

    def _value(self, path: Path) -> None:
        index = 0
        if self._takes("["):
            while not self._takes("]"):
                if not self._takes(",", "\n"):
                    self._note((*path, index))
                    self._value((*path, index))
                    index += 1
        elif self._takes("{"):
            while not self._takes("}"):
                if not self._takes(","):
                    self._assignment(path)
        else:
            while self.tokens[self.at][0] not in _VALUE_END:
                self.at += 1

    def _takes(self, *tokens: str) -> bool:
        """Whether the next token is one of these, which is then behind."""
        is_next = self.tokens[self.at][0] in tokens
        self.at += is_next
        return is_next

    def _note(self, path: Path) -> None:
        self.lines.setdefault(path, self.tokens[self.at][1])


RINGED = ("floating-ring", "cartridge")  # kinds of bearings with an inner and an outer film


@dataclass(frozen=True)
class Breach:
    """A rule that is broken: the key to change, the problem, and the remedy."""

    path: Path
    problem: str
    remedy: str


def has_table(data: Mapping[str, Any], key: str) -> bool:
    """Whether a key is a table."""
    return isinstance(data.get(key), dict)


def table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The table [key], empty if there is none."""
    return data[key] if has_table(data, key) else {}


def listed(data: Mapping[str, Any], key: str) -> list[Any]:
    """The entries of a list, none if a key is no list."""
    entry = data.get(key)
    return list(entry) if isinstance(entry, list | tuple) else []


def pairs(given: object) -> tuple[list[Any], list[Any]] | None:
    """The two columns of a list of pairs, None of anything else."""
    rows: Any = given if isinstance(given, list | tuple) else [given]
    if any(not isinstance(row, list | tuple) or len(row) != 2 for row in rows):
        return None
    return [row[0] for row in rows], [row[1] for row in rows]


def tables(data: Mapping[str, Any], key: str) -> list[tuple[Path, dict[str, Any]]]:
    """The tables of [key] or [[key]] with their paths."""
    if has_table(data, key):
        return [((key,), data[key])]
    return [((key, index), item) for index, item in enumerate(listed(data, key)) if isinstance(item, dict)]


def at(data: Any, path: Path) -> Any:
    """What stands at a path of nested tables and lists, None where nothing does."""
    for element in path:
        match data, element:
            case dict(), str():
                data = data.get(element)
            case list(), int() if element < len(data):
                data = data[element]
            case _:
                return None
    return data


def replaced(data: Any, path: Path, value: Any) -> Any:
    """`data` with another value at a path that it has."""
    if not path:
        return value
    changed: Any = list(data) if isinstance(data, list) else dict(data)
    changed[path[0]] = replaced(data[path[0]], path[1:], value)
    return changed


Located = tuple[Path, dict[str, Any]]  # a table with its path


def ring_films(bearing: Mapping[str, Any]) -> list[tuple[Located, Located]]:
    """The tables of the inner and outer film of a ring, with their paths in the table of its bearing; two pairs where a
    cartridge has other films at each end; none of a bearing without a ring."""
    if bearing.get("kind") not in RINGED:
        return []
    inner, outer = (tables(bearing, side) or [((side,), {})] for side in ("inner", "outer"))
    count = max(len(inner), len(outer))
    return [(inner[min(end, len(inner) - 1)], outer[min(end, len(outer) - 1)]) for end in range(count)]


def number(values: Mapping[str, Any], key: str, unit: str, default: float | None = None) -> float | None:
    """The SI value of a key; `default` where it is absent, None where it cannot be read."""
    return as_number(values[key], unit) if key in values else default


def as_number(given: object, unit: str) -> float | None:
    """The SI value of a quantity as it is written, None where it cannot be read."""
    try:
        return quantity(given, unit)
    except ValueFault:
        return None
