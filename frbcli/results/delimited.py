"""Tables of numbers in text, as measuring instruments write them: a head, names, perhaps units, and rows of numbers;
and time stamps, dates with times of the day or times of the day alone, turned into seconds.

The rows begin at the first whole row: one that has a number, or a word for a missing one, wherever most rows have a
number. Names and units are sought above it; what else the head holds is left out, except single numbers after a word,
such as a sampling interval.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array

if TYPE_CHECKING:
    import pandas as pd


_DAYS = r"\d\d?\.\d\d?\.|\d\d?/\d\d?/|\d\d?-[A-Za-z]{3}-"  # before a year of four digits or two
_DATE = rf"\d{{4}}-\d\d?-\d\d?|\d{{4}}/\d\d?/\d\d?|(?:{_DAYS})(?:\d{{4}}|\d\d)"
_PARTS = rf"(?:({_DATE})[T ]\s*)?(\d\d?):(\d\d):(\d\d(?:[.,]\d*)?)\s*(AM|PM|am|pm)?(?:Z|[+-]\d\d:?\d\d)?"
STAMP = re.compile(_PARTS)
_LATE = ("%d.%m.", "%m/%d/", "%d/%m/", "%d-%b-")
DATES = ("%Y-%m-%d", "%Y/%m/%d", *(f"{days}{year}" for year in ("%Y", "%y") for days in _LATE))
DAY_s, HALF_DAY_s = 86400.0, 43200.0
COMMENTS = ("#", "%")
NUMBERED = re.compile(r"\s*[#%]\s*[,;\t]")  # a line whose first column counts the rows, or is in %
DELIMITERS = ("\t", ";", ",", " ")  # a comma after the others, for it may be a decimal one; any number of blanks
MOST_COLUMNS = 1000
LOOKED_AT = 1000  # lines from which delimiter and decimal mark are found
FEW_ROWS = 2  # whole rows that may stand above the names, such as numbers of channels
HEAD_LINES = 100  # in which names are sought below whole rows
UNITS = {  # that distinguish a line of units from a line of names
    "", "-", "1", "%", "s", "sec", "second", "seconds", "ms", "us", "µs", "min", "sequence", "samples",
    "m", "mm", "cm", "um", "µm", "nm", "micron", "microns", "mil", "mils", "in", "inch", "m/s", "mm/s", "m/s^2", "g",
    "hz", "khz", "rpm", "krpm", "1/min", "min^-1", "min-1", "u/min", "r/min", "rev/min", "cpm", "rad/s",
    "deg", "°", "v", "mv", "volt", "volts", "a", "ma",
    "°c", "degc", "k", "bar", "pa", "n", "counts", "mm/v", "v/mm",
}  # fmt: skip
GAPS = {  # words of instruments where a number is missing or out of range
    "", "-", "--", "---", "*", "***", "****", "?", "∞", "-∞", "+∞", "na", "n/a", "#n/a", "nan", "null", "none",
    "ol", "ovl", "over", "overload", "overflow", "overrange", "clip", "clipped", "invalid", "missing", "no data",
}  # fmt: skip
LEFT_OUT = "comment"  # a last name without a column, as of LVM files
FEWEST_UNITS = 0.5  # share of a line of units that are known ones

UNEVEN = "Give every row as many fields as there are names."
DECIMAL_COMMA = "If its numbers have a decimal comma, put semicolons between them, or write decimal points."

_DIGITS = r"[+-]?(?:\d+{0}?\d*|{0}\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf|infinity)"
_POINT, _COMMA = (re.compile(_DIGITS.format(mark), re.IGNORECASE) for mark in (r"\.", ","))
_BLANKS = re.compile(r"\s+(?![\[(]|[^\[(]*[\])])")  # between fields, but none before or in a unit in brackets
_BRACKETS = re.compile(r"[\[(](.*)[\])]")
_IN_NAME = re.compile(r".*\S\s*[\[(]([^\[\]()]+)[\])]")
_PEAKS = re.compile(r"\s*(?:pp|p-p|pk-pk|pkpk|pk|peak|rms)$")  # how an instrument measures, after the unit


def seconds(stamps: pd.Series) -> Array | None:
    """Seconds (n,) from the first of n time stamps on, NaN at gaps; None if they are none.

    Dates that can be read in two orders of day and month are read in the one in which they lie closer together. Times
    without a date that fall by more than half a day have passed midnight.
    """
    parts = stamps.astype(str).str.strip().str.extract(f"^{_PARTS}$")
    known = parts[1].notna().to_numpy()
    if 2 * np.sum(known) <= len(parts):
        return None
    hours = parts[1].astype(float)
    half = parts[4].str.lower()
    hours = hours.where(half.isna(), hours % 12) + 12.0 * (half == "pm")
    of_day = hours * 3600.0 + parts[2].astype(float) * 60.0 + parts[3].str.replace(",", ".").astype(float)
    clock_s = of_day.to_numpy(dtype=np.float64)
    first = int(np.argmax(known))
    return np.asarray(clock_s - clock_s[first] + DAY_s * _days(parts[0], clock_s, known))


def _days(dates: pd.Series, of_day: Array, known: Array) -> Array:
    """Days (n,) from the first time stamp on; of_day: seconds (n,) of the day."""
    if dates[known].isna().any():
        days = np.zeros(len(of_day))
        days[known] = np.concatenate([[0.0], np.cumsum(np.diff(of_day[known]) < -HALF_DAY_s)])
        return days
    written = list(dict.fromkeys(dates[known]))
    spans = [days for days in (_in_order(written, order) for order in DATES) if days is not None]
    if not spans:
        return np.full(len(of_day), np.nan)
    number = dict(zip(written, min(spans, key=max), strict=True))
    return np.asarray(dates.map(number), dtype=np.float64)


def _in_order(dates: list[str], order: str) -> list[float] | None:
    """Days from the first of some dates on; None if they are not written in this order, or fall."""
    try:
        days = [float((datetime.strptime(date, order) - datetime.strptime(dates[0], order)).days) for date in dates]
    except ValueError:
        return None
    return days if days == sorted(days) else None


class NoTable(ValueError):
    """A text is no table for a reason that a remedy mends."""

    def __init__(self, problem: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(problem)


@dataclass(frozen=True)
class DelimitedTable:
    """names (k,), blank ones replaced by numbers from 1, and units (k,), "" where there is none; values: columns 0 to
    k - 1, text where they hold some; lines: number of the line of each row; numbers: of the head, by their words; mark:
    the decimal mark."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: pd.DataFrame
    lines: tuple[int, ...]
    numbers: Mapping[str, float]
    mark: str


@dataclass(frozen=True)
class _Layout:
    """How the fields of a row are written: delimiter, decimal mark, count of fields, and the places of those that are
    numbers or time stamps in most rows."""

    delimiter: str
    mark: str
    width: int
    numbers: frozenset[int]
    stamps: frozenset[int]

    @property
    def least(self) -> int:
        """The number of fields up to the last one that is a number or a time stamp."""
        return max(self.numbers | self.stamps) + 1

    def split(self, line: str) -> list[str]:
        return fields(line, self.delimiter)

    def is_number(self, field: str) -> bool:
        return _number(field, self.mark)

    def has_numbers(self, row: Sequence[str]) -> bool:
        return any(map(self.is_number, row))

    def is_whole(self, row: Sequence[str]) -> bool:
        """Whether a row has a number, or a gap, in all places in which most rows have one, and a number in some."""
        if len(row) < self.width or any(row[self.width :]):
            return False
        filled = [self.is_number(row[at]) for at in self.numbers]
        gaps = (row[at].lower() in GAPS for at in self.numbers)
        stamped = all(STAMP.fullmatch(row[at]) for at in self.stamps)
        return stamped and any(filled) and all(map(max, filled, gaps))

    def is_labelled(self, row: Sequence[str]) -> bool:
        """Whether a row has a word in the first place where others have a number or a time stamp."""
        first = min(self.numbers | self.stamps)
        words = row[first] if first < len(row) else ""
        return not (self.is_number(words) or words.lower() in GAPS or STAMP.fullmatch(words))


@dataclass(frozen=True)
class _Head:
    """The lines above the rows. begin: the first row; names and units: (k,); numbers: by their words."""

    begin: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    numbers: Mapping[str, float]


def read_table(content: bytes) -> DelimitedTable:
    """The table in a file of text. Raises ValueError if there is none, or its rows are ragged."""
    lines = list(_lines(content))
    numbered = [(number, line) for number, line in lines if not _is_comment(line)]
    if not numbered:
        raise ValueError("it is empty")
    ending = [line for _, line in numbered[len(numbered) // 2 :]]  # which holds few lines from above the rows
    layout = _layout(ending[:: max(1, len(ending) // LOOKED_AT)], numbered[-2:][0][1])
    comments = [line.lstrip().lstrip("".join(COMMENTS)) for _, line in lines if _is_comment(line)]
    head = _head([layout.split(line) for _, line in numbered], layout, comments)
    line_numbers, rows = zip(*_even_rows(numbered[head.begin :], layout.delimiter, len(head.names)), strict=True)
    import pandas as pd

    values = pd.read_csv(
        io.StringIO("\n".join(rows)), sep=r"\s+" if layout.delimiter == " " else layout.delimiter, header=None,
        decimal=layout.mark, names=range(len(head.names)), skipinitialspace=True, low_memory=False,
    )  # fmt: skip
    return DelimitedTable(head.names, head.units, values, line_numbers, head.numbers, layout.mark)


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(COMMENTS) and not NUMBERED.match(line)


def fields(line: str, delimiter: str) -> list[str]:
    """The fields of a line, without blanks around them."""
    if delimiter == " ":
        return _BLANKS.split(line.strip()) if "[" in line or "(" in line else line.split()
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


def _layout(ending: Sequence[str], last: str) -> _Layout:
    """The layout of the rows; last: the last whole line but one, for the last may be cut off. Raises ValueError if no
    field of most rows is a number."""
    delimiter = _delimiter(ending)
    rows = [fields(line, delimiter) for line in ending]
    mark = _decimal_mark(delimiter, rows)
    width = Counter(map(len, rows)).most_common(1)[0][0]
    even = [row for row in rows if len(row) == width]

    def mostly(at: int, fits: re.Pattern[str]) -> bool:
        return 2 * sum(fits.fullmatch(row[at]) is not None for row in even) > len(even)

    number = _POINT if mark == "." else _COMMA
    numbers = frozenset(at for at in range(width) if mostly(at, number))
    if not any(_number(field, mark) for field in fields(last, delimiter)) or not numbers:
        raise ValueError("it holds no rows of numbers")
    return _Layout(delimiter, mark, width, numbers, frozenset(at for at in range(width) if mostly(at, STAMP)))


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
    marks = {mark for row in rows for field in row for mark in ".," if mark in field and _number(field, mark)}
    if len(marks) > 1:
        problem = "it has numbers both with a decimal point and with a decimal comma"
        raise NoTable(problem, "Write all with one of them, without marks between thousands.")
    return marks.pop() if marks else "."


def _number(field: str, mark: str) -> bool:
    return (_POINT if mark == "." else _COMMA).fullmatch(field) is not None


def _head(rows: Sequence[Sequence[str]], layout: _Layout, comments: Sequence[str]) -> _Head:
    """The head of a table of rows, all lines of the file. Raises ValueError if no row is whole."""
    whole = [place for place, row in enumerate(rows[: LOOKED_AT * FEW_ROWS]) if layout.is_whole(row)]
    if not whole:
        raise ValueError("it holds no rows of numbers")
    first = _first_row(rows, whole, layout)
    names_at, units_at = _names_at(rows[:first], layout), None
    if names_at is None:
        words_above = next((words for words in map(layout.split, reversed(comments)) if _are_words(words, layout)
                      and len(words) == layout.width), [""] * layout.width)  # fmt: skip
        head = _Head(first, tuple(words_above), tuple(map(_unit_in, words_above)), {})
    else:
        units_at = _units_at(rows[:first], names_at, layout)
        begin = next(at for at in range(max(names_at, units_at or 0) + 1, first + 1)
                     if at == first or (layout.has_numbers(rows[at]) and not layout.is_labelled(rows[at])))  # fmt: skip
        names = _single_names(rows, names_at)
        if len(names) == layout.width + 1 and names[-1].lower() == LEFT_OUT:
            names = names[:-1]
        units, numbers = _units_of(rows, units_at, names, layout)
        head = _Head(begin, names, units, numbers)
    if len(head.names) > MOST_COLUMNS:
        raise ValueError(f"it has {len(head.names)} columns, more than {MOST_COLUMNS}")
    named = tuple(name or str(number) for number, name in enumerate(head.names, start=1))
    return replace(head, names=named, numbers=_numbers_of(rows[: head.begin], layout) | dict(head.numbers))


def _first_row(rows: Sequence[Sequence[str]], whole: Sequence[int], layout: _Layout) -> int:
    """The first row of the table. whole: places of the rows that are whole; those above the last line of words, such as
    numbers of channels, belong to the head if they are few, or have a word where others have nothing."""
    words = [place for place, row in enumerate(rows[:HEAD_LINES])
             if _are_words(row, layout) and len(_without_end(row)) >= layout.least]  # fmt: skip
    above = [place for place in whole if words and place < words[-1]]
    below = next((place for place in whole if words and place > words[-1]), None)
    if below is None or not above:
        return whole[0]
    first = min(layout.numbers | layout.stamps)
    labelled = all(any(rows[place][:first]) for place in above)
    return below if len(above) <= FEW_ROWS or labelled else above[0]


def _single_names(rows: Sequence[Sequence[str]], names_at: int) -> tuple[str, ...]:
    """The names of a line; repeated ones are taken from the line above, where it has others."""
    names = _without_end(rows[names_at])
    above = _without_end(rows[names_at - 1]) if names_at else []
    double = {name for name, count in Counter(names).items() if count > 1}
    places = [place for place, name in enumerate(names) if name in double]
    others = [above[place] for place in places] if len(above) == len(names) else []
    if others and all(others) and len(set(others)) == len(others):
        for place, other in zip(places, others, strict=True):
            names[place] = other
    return tuple(names)


def _are_words(row: Sequence[str], layout: _Layout) -> bool:
    return any(row) and not layout.has_numbers(row)


def _names_at(head: Sequence[Sequence[str]], layout: _Layout) -> int | None:
    """Where the names are: right above a line of units, or else the last line of words."""
    for place in range(len(head) - 1, 0, -1):
        above = _without_end(head[place - 1])
        fits = len(above) >= layout.least and len(above) == len(_without_end(head[place])) and all(above)
        fits = fits and not _is_called_units(head[place])
        if place == len(head) - 1 and len(above) >= layout.least and _is_called_units(head[place]):
            fits = len(above) == len(_without_end(head[place])) and not any(map(layout.is_number, above))
        if fits and _are_units(head[place], layout) and not _are_units(above, layout):
            return place - 1
    words = [place for place, row in enumerate(head) if _are_words(row, layout)]
    wide = [place for place in words if len(_without_end(head[place])) >= layout.least]
    return wide[-1] if wide else words[-1] if words else None


def _units_at(head: Sequence[Sequence[str]], names_at: int, layout: _Layout) -> int | None:
    """Where the units are: right below the names, or above them in a line that calls itself so."""
    if names_at + 1 < len(head) and _are_units(head[names_at + 1], layout):
        return names_at + 1
    called = (place for place, row in enumerate(head[:names_at]) if _is_called_units(row))
    wide = (place for place in called if len(_without_end(head[place])) >= layout.least)
    return next((place for place in wide if _are_units(head[place][1:], layout)), None)


def _is_called_units(row: Sequence[str]) -> bool:
    return "unit" in row[0].lower()


def _units_of(
    rows: Sequence[Sequence[str]], units_at: int | None, names: tuple[str, ...], layout: _Layout
) -> tuple[tuple[str, ...], dict[str, float]]:
    """The units of columns, and the numbers in the row of units of columns without any other number."""
    if units_at is None:
        return tuple(map(_unit_in, names)), {}
    row = rows[units_at]
    row_of_units = [*([""] if _is_called_units(row) else row[:1]), *row[1:], *[""] * len(names)][: len(names)]
    numbers = {
        name: float(field.replace(layout.mark, "."))
        for at, (name, field) in enumerate(zip(names, row_of_units, strict=True))
        if at not in layout.numbers and layout.is_number(field)
    }
    units = (_unit(field) for field in row_of_units)
    named = zip(names, units, strict=True)
    return tuple("" if name in numbers else unit or _unit_in(name) for name, unit in named), numbers


def _are_units(row: Sequence[str], layout: _Layout) -> bool:
    """Whether most words of a line are units."""
    words = [_unit(field).lower() for field in row if field and not layout.is_number(field)]
    known = sum(_PEAKS.sub("", word) in UNITS for word in words)
    return known > 0 and known >= FEWEST_UNITS * len(words)


def _numbers_of(head: Sequence[Sequence[str]], layout: _Layout) -> dict[str, float]:
    """The numbers of lines of a word and a number, or of the same one for each channel."""
    numbers: dict[str, float] = {}
    for row in head:
        values = {field for field in row[1:] if layout.is_number(field)}
        if row[0] and not layout.is_number(row[0]) and len(values) == 1 and layout.is_number(row[1]):
            numbers[row[0].rstrip(":= ")] = float(values.pop().replace(layout.mark, "."))
    return numbers


def _without_end(cells: Sequence[str]) -> list[str]:
    """The fields up to the last one that is not empty."""
    filled = [place for place, field in enumerate(cells) if field]
    return list(cells[: max(filled, default=0) + 1])


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
        cells = fields(line, delimiter)
        if count < width or any(cells[width:]):
            problem = f"row {row} (line {number}) has {count} fields, and the line of names {width}"
            remedy = DECIMAL_COMMA if delimiter == "," and width < count and "." not in line else UNEVEN
            raise NoTable(problem, remedy)
        yield number, delimiter.join(cells[:width])


