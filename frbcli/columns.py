"""Columns of results: each is declared once, with its name, unit, shape and meaning, and how the terminal shows it.

Tables for pandas and CSV, the objects of a JSON document, the cells and the legend of a table of the terminal, and the
tables of notebooks are made from the declarations, and so are the tables of columns in the documents.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from frbcli.errors import printable
from frbcli.units import SpeedUnit

if TYPE_CHECKING:
    import pandas as pd

AXES = "xy"
ENTRIES = ("xx", "xy", "yx", "yy")  # heads of a matrix
ZERO_CELSIUS = 273.15
MINUS_ZERO = re.compile(r"^-(?=0(?:\.0*)?[^\d.]*$)")  # of round-off below zero, such as -0.0 or -0°
LARGEST_PLAIN = 1e6  # below it, numbers with a number of digits have no powers of ten
NOTHING = 1e-12  # of the largest entry of a matrix: an entry that is zero but for round-off
SCALES = {  # over SI
    "um": 1e6, "bar": 1e-5, "MPa": 1e-6, "mm^3/s": 1e9, "mPa s": 1e3, "N/um": 1e-6, "N s/mm": 1e-3, "l/min": 6e4,
}  # fmt: skip


def spaced(name: str) -> str:
    """The name of a film or point as people read it: "turbine inner" for turbine_inner."""
    return name.replace("_", " ")


@dataclass(frozen=True)
class Shown:
    """A column in a table of the terminal.

    head: its head, or as many as it has cells there
    form: the format of a number, or a function from the value to the cell, or to all cells of several heads
    unit: the unit in which it is shown, by default the column's
    table: the name of the table
    per_minute: the same for people who read rotor speeds in rpm
    """

    head: str | tuple[str, ...]
    form: str | Callable[[Any], Any] = ""
    unit: str = ""
    table: str = ""
    per_minute: Shown | None = None

    @property
    def heads(self) -> tuple[str, ...]:
        """The heads of its cells."""
        return (self.head,) if isinstance(self.head, str) else self.head

    def unit_beside(self, unit: str = "") -> tuple[str, ...]:
        """The shown unit, or this one without it; empty where there is none or the head names it."""
        own = self.unit or unit
        return (own,) if own and not self.heads[0].endswith(own) else ()

    def cells(self, value: Any) -> tuple[str, ...]:
        """The cells of a value; "-" for a number that is not known."""
        if isinstance(self.head, str):
            cells: Iterable[str] = (self._cell(value),)
        elif value is None:
            cells = ("-",) * len(self.head)
        else:
            cells = self.form(value) if callable(self.form) else map(self._cell, _without_round_off(value))
        return tuple(MINUS_ZERO.sub("", cell) for cell in cells)

    def _cell(self, value: Any) -> str:
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return "-"
        if callable(self.form):
            return str(self.form(value))
        if self.unit == "degC":
            value = value - ZERO_CELSIUS
        elif self.unit in SCALES:
            value = SCALES[self.unit] * value
        text = format(value, self.form)
        if self.form.endswith("g") and "e+" in text and abs(float(text)) < LARGEST_PLAIN:
            return f"{float(text):.0f}"
        return text.replace("e-0", "e-") if self.form.endswith("e") else text


def _without_round_off(value: Any) -> list[float]:
    """The entries of an array, 0 where they are round-off of the largest."""
    entries = np.ravel(value).astype(float)
    least = NOTHING * float(np.abs(entries).max(initial=0.0))
    return [0.0 if abs(entry) < least else float(entry) for entry in entries]


def speed_shown(form: str = ".4g", head: str = "Hz", table: str = "") -> Shown:
    """A rotor speed in Hz in a table of the terminal. head: ends with Hz."""
    per_minute = Shown(f"{head[:-2]}rpm", SpeedUnit(rpm=True).number, "rpm", table)
    return Shown(head, form, table=table, per_minute=per_minute)


def uncertain_speed(head: str = "speed, Hz", digits: int = 1, table: str = "", unit: str = "") -> Shown:
    """A rotor speed in Hz with its uncertainty, both of a pair, in a table of the terminal. digits: of a speed in Hz
    behind its point; unit: "Hz" where the head does not name it."""
    hertz, per_minute = SpeedUnit(), SpeedUnit(rpm=True)
    return Shown(head, lambda pair: hertz.cell(pair[0], pair[1], digits), unit, table,
                 per_minute=Shown(head.replace("Hz", "rpm"), lambda pair: per_minute.cell(pair[0], pair[1]),
                                  unit and per_minute.name, table))  # fmt: skip


@dataclass(frozen=True)
class Column:
    """One quantity of a result.

    quantity: its name in whole words
    unit: in SI, Hz or deg
    meaning: a few words, to which `more` adds what is only said in documents; "" for what only the terminal shows
    value: a function from the item of a row to a number, a text or an array of `shape`, None where there is none;
        without it the item's attribute of that name, with or without the unit, or its entry of that name in a dict
    shape: (), (2,) over x and y, or (2, 2)
    shown: where and how the terminal shows it
    key: its name in JSON, with a dot inside of an object; the name without one; "" where JSON does not have it
    flat: whether pandas and CSV have it
    of: the end of its names there, such as the film of several
    """

    quantity: str
    unit: str
    meaning: str
    value: Callable[[Any], Any] | None = None
    shape: tuple[int, ...] = ()
    shown: tuple[Shown, ...] = ()
    more: str = ""
    key: str | None = None
    flat: bool = True
    of: str = ""

    @property
    def name(self) -> str:
        """The quantity with its unit, such as torque_N_m."""
        return _joined(self.quantity, self.unit_name, self.of)

    @property
    def unit_name(self) -> str:
        """The unit as it ends a name: N_m, m3_s."""
        return re.sub("[/ *]", "_", self.unit.replace("^", ""))

    @property
    def path(self) -> str:
        """The name in JSON, with a dot inside of an object."""
        return self.name if self.key is None else self.key

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all entries: stiffness_xx_N_m, stiffness_xy_N_m, ..."""
        entries = map("".join, itertools.product(AXES, repeat=len(self.shape)))
        return tuple(_joined(self.quantity, entry, self.unit_name, self.of) for entry in entries)

    def value_of(self, item: Any) -> Any:
        """The value of an item: a number, a text, an array of the shape, or None."""
        if self.value is not None:
            return self.value(item)
        if isinstance(item, Mapping):
            return item.get(self.name)
        return getattr(item, self.quantity if hasattr(item, self.quantity) else self.name)

    def entries(self, value: Any) -> list[Any]:
        """The values of the names; NaN for each name of an array that is None."""
        if not self.shape:
            return [value]
        return np.ravel(np.full(self.shape, math.nan) if value is None else value).tolist()


Columns = Sequence[Column]


@dataclass(frozen=True)
class Table:
    """Values of columns, row by row."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Any, ...], ...]

    def to_pandas(self) -> pd.DataFrame:
        """The table for pandas, with a column per entry of the flat columns."""
        import pandas as pd

        return pd.DataFrame(
            [
                dict(pair for column, value in zip(self.columns, row, strict=True) if column.flat
                     for pair in zip(column.names, column.entries(value), strict=True))
                for row in self.rows
            ],
            columns=[name for column in self.columns if column.flat for name in column.names],
        )  # fmt: skip

    def documents(self) -> list[dict[str, Any]]:
        """An object of JSON per row."""
        rows: list[dict[str, Any]] = []
        for row in self.rows:
            document: dict[str, Any] = {}
            for column, value in zip(self.columns, row, strict=True):
                *path, last = column.path.split(".")
                place = document
                for key in path:
                    place = place.setdefault(key, {})
                if last:
                    place[last] = value
            rows.append(document)
        return rows

    def heads(self, table: str = "") -> tuple[str, ...]:
        """The heads of a table of the terminal."""
        return heads(self.columns, table)

    def spans(self, table: str = "") -> tuple[int, ...]:
        """Numbers of columns of a table of the terminal that belong together, such as the columns of a vector, in
        order."""
        return tuple(len(shown.heads) for column in self.columns for shown in _in(column, table))

    def legend(self, table: str = "") -> str:
        """The heads of a table of the terminal with meaning and unit."""
        return legend(self.columns, table)

    def with_speeds_in(self, unit: SpeedUnit) -> Table:
        """The table with its rotor speeds in a unit, for the terminal."""
        return replace(self, columns=with_speeds_in(unit, self.columns))

    def cells(self, table: str = "") -> list[tuple[str, ...]]:
        """The rows of a table of the terminal."""
        return [
            tuple(cell for column, value in zip(self.columns, row, strict=True)
                  for shown in _in(column, table) for cell in shown.cells(value))
            for row in self.rows
        ]  # fmt: skip


def with_speeds_in(unit: SpeedUnit, columns: Columns) -> tuple[Column, ...]:
    """The columns with rotor speeds in a unit, for the terminal."""
    if not unit.rpm:
        return tuple(columns)
    return tuple(replace(each, shown=tuple(shown.per_minute or shown for shown in each.shown)) for each in columns)


def table_of(columns: Columns, items: Iterable[object]) -> Table:
    """The table of some columns with a row per item."""
    return Table(tuple(columns), tuple(tuple(column.value_of(item) for column in columns) for item in items))


def documents(columns: Columns, items: Iterable[object]) -> list[dict[str, Any]]:
    """The objects of JSON of some columns, one per item."""
    return table_of(columns, items).documents()


def document(columns: Columns, item: object) -> dict[str, Any]:
    """The object of JSON of one item."""
    return documents(columns, [item])[0]


def spread_table(columns: Columns, result: object) -> Table:
    """A row per entry of the arrays of a result, which are broadcast to one shape; the columns are scalars."""
    values = np.broadcast_arrays(*(np.asarray(column.value_of(result)) for column in columns))
    return Table(tuple(columns), tuple(zip(*(value.ravel().tolist() for value in values), strict=True)))


def named(columns: Columns, of: str, value: Callable[[Any], Any]) -> tuple[Column, ...]:
    """The columns of a part of a row, which `value` takes from it, with `of` at the end of their names."""
    return tuple(replace(column, of=of, value=_after(value, column.value_of)) for column in columns)


def keys(columns: Columns) -> list[str]:
    """The keys of their object in JSON."""
    return list(dict.fromkeys(column.path.split(".")[0] for column in columns if column.path))


def heads(columns: Columns, table: str = "") -> tuple[str, ...]:
    """The heads of a table of the terminal."""
    return tuple(head for column in columns for shown in _in(column, table) for head in shown.heads)


def legend(columns: Columns, table: str = "") -> str:
    """The heads of a table of the terminal with meaning and unit."""
    listed = ((column, shown) for column in columns if column.meaning for shown in _in(column, table))
    return "; ".join(
        ", ".join((*shown.heads[:-1], f"{shown.heads[-1]}: {column.meaning}", *shown.unit_beside(column.unit)))
        for column, shown in listed
    )


def short_number(value: float | None) -> str:
    """Two digits for a narrow column, e.g. 4.2e-3; "-" where there is none."""
    if value is None or math.isnan(value):
        return "-"
    return f"{value:.1e}".replace("e-0", "e-").replace("e+00", "")


def _joined(*words: str) -> str:
    return "_".join(word for word in words if word)


def _in(column: Column, table: str) -> list[Shown]:
    return [shown for shown in column.shown if shown.table == table]


def _after(first: Callable[[Any], Any], then: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def value(item: Any) -> Any:
        part = first(item)
        return None if part is None else then(part)

    return value


MOST_COLUMNS = 6  # of a table, in a line of text
MOST_ROWS = 60  # of a table; of the rest the number is stated


class Tabular:
    """A result that a notebook shows as its table: one with `table` or a `to_pandas` of its own, and a case that it is
    of."""

    def table(self) -> Table:
        """The declared columns of the result with their values."""
        raise NotImplementedError

    def to_pandas(self) -> pd.DataFrame:
        """The rows of the table, units in the names of the columns."""
        return self.table().to_pandas()

    def __repr__(self) -> str:
        """Kind, case and columns: three lines, whatever it holds."""
        frame, case = self.to_pandas(), getattr(self, "case", None)
        names = [str(name) for name in frame.columns]
        more = f" and {len(names) - MOST_COLUMNS} more" if len(names) > MOST_COLUMNS else ""
        of = "" if case is None else f" of {case.name}: {printable(case.title)}"
        return f"{type(self).__name__}{of}\n{len(frame)} rows of {', '.join(names[:MOST_COLUMNS])}{more}"

    def _repr_html_(self) -> str:
        frame, case = self.to_pandas(), getattr(self, "case", None)
        title = "" if case is None else case.heading
        words = ": ".join(word for word in (title, type(self).__name__) if word)
        return html_table(words, list(frame.columns), frame.itertuples(index=False), len(frame))


def html_table(title: str, columns: Sequence[str], rows: Iterable[Iterable[object]], count: int | None = None) -> str:
    """A table under its title, with at most MOST_ROWS rows; count: how many there are, where `rows` is not a sequence
    of known length."""
    shown = [[_cell(cell) for cell in row] for _, row in zip(range(MOST_ROWS), rows, strict=False)]
    head = "".join(f"<th style='text-align:left'>{escape(printable(str(name)))}</th>" for name in columns)
    body = "".join(f"<tr>{''.join(cells)}</tr>" for cells in shown)
    left = 0 if count is None else count - len(shown)
    more = f"<p>and {left} more rows</p>" if left > 0 else ""
    caption = f"<p><b>{escape(printable(title))}</b></p>" if title else ""
    return f"{caption}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _cell(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f"<td style='text-align:left'>{escape(printable(text))}</td>"
