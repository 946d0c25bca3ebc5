"""The tables of a case file as the user wrote them.

The lines of the keys, which the parser of TOML does not report and faults need, and the breaches that the rules find.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from frbcli.units import ValueFault, quantity

Path = tuple[str | int, ...]

_BARE_END = " \t\r\n=.]}#,"
_VALUE_END = ",]}#\n"


def key_lines(text: str) -> dict[Path, int]:
    """The 1-based line of every key and table of `text`, which must be valid TOML.

    A path holds keys and, inside of arrays, indices: ("bearing", 1, "width").
    """
    scanner = _Scanner(text)
    scanner.document()
    return scanner.lines


@dataclass
class _Scanner:
    """Reads a text that is known to be valid once, for its keys alone."""

    text: str
    at: int = 0
    line: int = 1
    lines: dict[Path, int] = field(default_factory=dict)
    arrays: dict[Path, int] = field(default_factory=dict)  # array of tables -> index of its newest table

    def document(self) -> None:
        table: Path = ()
        while self._skip_blank():
            if self._peek("["):
                table = self._header()
            else:
                self._assignment(table)

    def _header(self) -> Path:
        many = self._peek("[[")
        self._step(2 if many else 1)
        path = self._key(())
        if many:
            newest = self.arrays.get(path, -1) + 1
            self.arrays[path] = newest
            self._note(path)
            path = (*path, newest)
        self._note(path)
        self._step(2 if many else 1)
        return path

    def _assignment(self, table: Path) -> None:
        path = self._key(table)
        self._note(path)
        self._step(1)  # the equals sign
        self._value(path)

    def _key(self, table: Path) -> Path:
        """A dotted key under `table`; in a header, arrays of tables on the way mean their newest table."""
        path = table
        while True:
            self._skip_spaces()
            path = (*path, self._key_part())
            self._skip_spaces()
            if not self._peek("."):
                return path
            self._note(path)
            if path in self.arrays:
                path = (*path, self.arrays[path])
            self._step(1)

    def _key_part(self) -> str:
        begin = self.at
        if self._peek('"') or self._peek("'"):
            self._string()
            quoted = self.text[begin : self.at]
            return quoted[1:-1] if quoted[0] == "'" else str(tomllib.loads(f"v={quoted}")["v"])
        while self.at < len(self.text) and self.text[self.at] not in _BARE_END:
            self.at += 1
        return self.text[begin : self.at]

    def _value(self, path: Path) -> None:
        self._skip_blank()
        if self._peek("["):
            self._array(path)
        elif self._peek("{"):
            self._inline_table(path)
        elif self._peek('"') or self._peek("'"):
            self._string()
        else:
            while self.at < len(self.text) and self.text[self.at] not in _VALUE_END:
                self.at += 1

    def _array(self, path: Path) -> None:
        self._step(1)
        index = 0
        while self._skip_blank() and not self._peek("]"):
            if self._peek(","):
                self._step(1)
                continue
            self._note((*path, index))
            self._value((*path, index))
            index += 1
        self._step(1)

    def _inline_table(self, path: Path) -> None:
        self._step(1)
        while self._skip_blank() and not self._peek("}"):
            if self._peek(","):
                self._step(1)
                continue
            self._assignment(path)
        self._step(1)

    def _string(self) -> None:
        quote = self.text[self.at]
        fence = quote * 3 if self._peek(quote * 3) else quote
        self._step(len(fence))
        while self.at < len(self.text) and not self._peek(fence):
            self._step(2 if quote == '"' and self._peek("\\") else 1)
        self._step(len(fence))
        while len(fence) == 3 and self._peek(quote):  # a fence may follow up to two quotes of the text itself
            self._step(1)

    def _note(self, path: Path) -> None:
        self.lines.setdefault(path, self.line)

    def _peek(self, expected: str) -> bool:
        return self.text.startswith(expected, self.at)

    def _step(self, count: int) -> None:
        self.line += self.text.count("\n", self.at, self.at + count)
        self.at += count

    def _skip_spaces(self) -> None:
        while self.at < len(self.text) and self.text[self.at] in " \t":
            self.at += 1

    def _skip_blank(self) -> bool:
        """Skip blanks, line ends and comments; whether anything is left."""
        while self.at < len(self.text):
            if self._peek("#"):
                end = self.text.find("\n", self.at)
                self.at = len(self.text) if end < 0 else end
            elif self.text[self.at] in " \t\r\n":
                self._step(1)
            else:
                return True
        return False


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
        if isinstance(element, int):
            data = data[element] if isinstance(data, list) and element < len(data) else None
        else:
            data = data.get(element) if isinstance(data, dict) else None
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
