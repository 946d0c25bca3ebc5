"""Files that a case names: their place in its tables, and columns of numbers out of a CSV with their names above."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from frbcli.case.quantities import LARGEST
from frbcli.case.reading.lines import Path as Key
from frbcli.case.reading.tables import Breach, at, replaced
from frbcli.results.files import named
from frbcli.results.files.named import NoFile, NoText, Unreadable

LARGEST_FILE = 4_194_304  # bytes
SI = "Correct it; values are in SI units."

Columns = dict[str, list[float]]


class Refused(Exception):
    """Problem and remedy of a file that cannot be read."""


def with_file(
    data: dict[str, Any], path: Key, joined: Callable[[str, dict[str, Any]], dict[str, Any]],
    excluded: Iterable[str] = (), remedy: str = "Keep one of the two.",
) -> tuple[dict[str, Any], list[Breach]]:  # fmt: skip
    """The tables of a case with what the file of one of them holds instead of its key `file`, and the fault, with which
    it keeps the key. joined: that table by the name of the file and the other keys, may raise Refused; excluded: keys
    that the file replaces; remedy: where one of them is given, too."""
    given = at(data, path)
    name, key = given.get("file") if isinstance(given, dict) else None, (*path, "file")
    if not isinstance(name, str) or not name:
        return data, []
    if both := [other for other in excluded if other in given]:
        return data, [Breach(key, f"is given with {' and '.join(both)}.", remedy)]
    try:
        table = joined(name, {other: value for other, value in given.items() if other != "file"})
    except Refused as fault:
        return data, [Breach(key, *fault.args)]
    return replaced(data, path, table), []


def text_of(path: Path, meant: str, write: str) -> str:
    """The text of a file; meant: what it should be; write: the remedy for what is no text. Raises Refused."""
    try:
        return named.text_of(path, LARGEST_FILE)
    except NoFile:
        raise Refused("names no file.", "Give its path from the folder of the case.") from None
    except Unreadable as error:
        raise Refused(str(error), write if isinstance(error, NoText) else f"Name {meant}.") from None


def number_table(text: str, names_remedy: str) -> Columns:
    """The columns of a text by their names; names_remedy: the remedy for wrong names. Raises Refused."""
    try:
        rows = [row for row in csv.reader(text.splitlines()) if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise Refused(f"cannot be read: {error}.", names_remedy) from None
    if not rows:
        raise Refused("is empty.", names_remedy)
    names = [cell.strip() for cell in rows[0]]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise Refused(f'has the column "{twice}" twice.', names_remedy)
    columns: Columns = {name: [] for name in names}
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise Refused(f"has {len(row)} values in row {number} of numbers, not {len(names)}.", "Complete the row.")
        for name, cell in zip(names, row, strict=True):
            columns[name].append(finite(cell, name, number))
    return columns


def finite(given: object, name: str, row: int) -> float:
    """A finite number that a case would take. Raises Refused."""
    try:
        if isinstance(given, bool) or not isinstance(given, str | int | float):
            raise ValueError
        value = float(given)
    except (ValueError, OverflowError):
        raise Refused(f'has no number as {row}. value of "{name}".', SI) from None
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise Refused(f'has a {row}. value of "{name}" that is no finite number within {LARGEST:g}.', SI)
    return value
