"""Tables of numbers in text, as measuring instruments write them: names, perhaps units, and rows of numbers.

What stands above the names (model, date, settings) is skipped. The names are the last line without a number above the
first whole row of numbers; a line of units may follow them.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

COMMENT = "#"
DELIMITERS = ("\t", ";", ",", " ")  # a comma after the others, for it may be a decimal one; any number of blanks
MOST_COLUMNS = 1000
LOOKED_AT = 1000  # lines from which delimiter and decimal mark are found
UNITS = {  # that distinguish a line of units from a line of names
    "", "-", "1", "%", "s", "sec", "second", "seconds", "ms", "us", "µs", "min",
    "m", "mm", "cm", "um", "µm", "nm", "mil", "mils", "in", "inch", "m/s", "mm/s", "m/s^2", "g",
    "hz", "khz", "rpm", "1/min", "min^-1", "u/min", "rad/s", "deg", "°", "v", "mv", "volt", "volts", "a", "ma",
    "°c", "degc", "k", "bar", "pa", "n", "counts", "mm/v", "v/mm",
}  # fmt: skip

UNEVEN = "Give every row as many fields as there are names."
DECIMAL_COMMA = "If its numbers have a decimal comma, put semicolons between them, or write decimal points."

_DIGITS = r"[+-]?(?:\d+{0}?\d*|{0}\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf|infinity)"
_POINT, _COMMA = (re.compile(_DIGITS.format(mark), re.IGNORECASE) for mark in (r"\.", ","))
_BRACKETS = re.compile(r"[\[(](.*)[\])]")
_IN_NAME = re.compile(r".*\S\s*[\[(]([^\[\]()]+)[\])]")


class NoTable(ValueError):
    """A text is no table for a reason that a remedy mends."""

    def __init__(self, problem: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(problem)


@dataclass(frozen=True)
class DelimitedTable:
    """names (k,) and units (k,), "" where there is none; values: columns 0 to k - 1, text where they hold some; lines:
    number of the line of each row."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: pd.DataFrame
    lines: tuple[int, ...]


def read_table(content: bytes) -> DelimitedTable:
    """The table in a file of text. Raises ValueError if there is none, or its rows are ragged."""
    numbered = [(number, line) for number, line in _lines(content) if not line.lstrip().startswith(COMMENT)]
    if not numbered:
        raise ValueError("it is empty")
    ending = [line for _, line in numbered[len(numbered) // 2 :]]  # which holds few lines from above the rows
    ending = ending[:: max(1, len(ending) // LOOKED_AT)]
    delimiter = _delimiter(ending)
    mark = _decimal_mark(delimiter, [fields(line, delimiter) for line in ending])
    last = numbered[-2:][0][1]  # but one, for the last may be cut off
    begin, names, units = _head(numbered, delimiter, mark, fields(last, delimiter))
    lines, rows = zip(*_even_rows(numbered[begin:], delimiter, len(names)), strict=True)
    import pandas as pd

    values = pd.read_csv(
        io.StringIO("\n".join(rows)), sep=r"\s+" if delimiter == " " else delimiter, header=None, decimal=mark,
        names=range(len(names)), skipinitialspace=True, low_memory=False,
    )  # fmt: skip
    return DelimitedTable(names, units, values, lines)


def fields(line: str, delimiter: str) -> list[str]:
    """The fields of a line, without blanks around them."""
    if delimiter == " ":
        return line.split()
    if '"' in line:
        try:
            return [field.strip() for field in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]
        except csv.Error as error:
            raise ValueError(f"a line of it is no table: {error}") from None
    return [field.strip() for field in line.split(delimiter)]


def _lines(content: bytes) -> Iterator[tuple[int, str]]:
    """The lines that are not blank, numbered from 1."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16")
    elif b"\0" in content:
        raise ValueError("it is no text")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")  # of which every byte is a character
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return ((number, line) for number, line in enumerate(lines, start=1) if line.strip())


def _delimiter(lines: Sequence[str]) -> str:
    """The first delimiter that gives most lines the same number of fields, which is more than one."""
    for delimiter in DELIMITERS:
        width, count = Counter(len(fields(line, delimiter)) for line in lines).most_common(1)[0]
        if width > 1 and 2 * count >= len(lines):
            return delimiter
    return ","


def _decimal_mark(delimiter: str, rows: Sequence[Sequence[str]]) -> str:
    """The mark between whole number and decimals."""
    if delimiter == ",":
        return "."
    found = {mark for row in rows for field in row for mark in ".," if mark in field and _number(field, mark)}
    if len(found) > 1:
        problem = "it has numbers both with a decimal point and with a decimal comma"
        raise NoTable(problem, "Write all with one of them, without marks between thousands.")
    return found.pop() if found else "."


def _number(field: str, mark: str) -> bool:
    return (_POINT if mark == "." else _COMMA).fullmatch(field) is not None


def _head(
    numbered: Sequence[tuple[int, str]], delimiter: str, mark: str, row: Sequence[str]
) -> tuple[int, tuple[str, ...], tuple[str, ...]]:
    """Where the rows begin, names and units; row: fields of one of the rows."""
    holds = {place for place, field in enumerate(row) if _number(field, mark)}
    if not holds:
        raise ValueError("it holds no rows of numbers")
    last: int | None = None
    for place, (_, line) in enumerate(numbered):
        found = fields(line, delimiter)
        numbers = {at for at, field in enumerate(found) if _number(field, mark)}
        if numbers >= holds and len(found) == len(row):
            break
        if not numbers and any(found):
            last = place
    if last is None:
        raise NoTable("there is no line of names above its numbers", "Write a line of names above them, e.g. t,x,y.")
    names, units = _without_end(fields(numbered[last][1], delimiter)), []
    if last > 0 and len(names) > 1 and all(_unit(name).lower() in UNITS for name in names):
        above = _without_end(fields(numbered[last - 1][1], delimiter))
        if len(above) == len(names) and all(above):
            names, units = above, [_unit(name) for name in names]
    if len(names) > MOST_COLUMNS:
        raise ValueError(f"it has {len(names)} columns, more than {MOST_COLUMNS}")
    return last + 1, tuple(names), tuple(units or map(_unit_in, names))


def _without_end(found: list[str]) -> list[str]:
    """The fields up to the last one that is not empty."""
    while len(found) > 1 and not found[-1]:
        found = found[:-1]
    return found


def _unit(text: str) -> str:
    inside = _BRACKETS.fullmatch(text)
    return (inside.group(1) if inside else text).strip()


def without_unit(name: str) -> str:
    """A name without the unit in brackets at its end."""
    inside = _IN_NAME.fullmatch(name)
    return name if inside is None else name[: inside.start(1) - 1].rstrip()


def _unit_in(name: str) -> str:
    """The unit in the brackets at the end of a name."""
    inside = _IN_NAME.fullmatch(name)
    return inside.group(1).strip() if inside else ""


def _even_rows(numbered: Sequence[tuple[int, str]], delimiter: str, width: int) -> Iterator[tuple[int, str]]:
    """The rows with so many fields; more of them may only be empty ones at the end."""
    for row, (number, line) in enumerate(numbered, start=1):
        plain = delimiter != " " and '"' not in line
        count = line.count(delimiter) + 1 if plain else len(fields(line, delimiter))
        if count == width:
            yield number, line
            continue
        found = fields(line, delimiter)
        if count < width or any(found[width:]):
            problem = f"row {row} (line {number}) has {count} fields, and the line of names {width}"
            remedy = DECIMAL_COMMA if delimiter == "," and width < count and "." not in line else UNEVEN
            raise NoTable(problem, remedy)
        yield number, delimiter.join(found[:width])
