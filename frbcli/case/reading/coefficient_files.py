"""Files that a case names: their place in its tables, and columns of numbers out of a CSV with their names above.

The modes of a housing out of a file: a table, as a finite element program lists them, with a row for each mode, or a
rotor of ROSS.

The case gets the modes instead of the key `file`, so that a run has all that it was made of.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from frbcli.case.model import LARGEST
from frbcli.case.reading.tables import Breach, at, number, replaced, table, tables
from frbcli.case.reading.tables import Path as Key
from frbcli.case.rotor import OF_SECTIONS
from frbcli.results.write import NoFile, NoText, Unreadable
from frbcli.results.write import text_of as text_of_file

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
        return text_of_file(path, LARGEST_FILE)
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
    for place, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise Refused(f"has {len(row)} values in row {place} of numbers, not {len(names)}.", "Complete the row.")
        for name, cell in zip(names, row, strict=True):
            columns[name].append(finite(cell, name, place))
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


FREQUENCY, DAMPING = "frequency_Hz", "damping"
AXES = ("_x", "_y")
MOST_MODES = 200
ROSS = (".toml", ".json")
MODE_COLUMNS = (
    f"Give the columns {FREQUENCY}, {DAMPING}, and for each bearing and place NAME_x and NAME_y in 1/sqrt(kg), e.g. "
    "left_x, left_y."
)
FILE = "a table of modes"


def with_housing_file(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with the modes of housing.file instead of that key, and the faults.

    folder: that a relative path counts from. With faults the tables are returned unchanged.
    """

    def joined(name: str, kept: dict[str, Any]) -> dict[str, Any]:
        if Path(name).suffix.lower() in ROSS:
            return {**_housing_of_ross(data, folder / name), **kept}
        return {"modes": _modes(number_table(text_of(folder / name, FILE, MODE_COLUMNS), MODE_COLUMNS)), **kept}

    return with_file(data, ("housing",), joined, ("modes",))


def _housing_of_ross(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """Modes and masses of a rotor of ROSS, as a case file has them. Raises Refused."""
    from frbcli.case.files.ross_housing import ross_housing  # which takes linear algebra

    if table(data, "rotor").get("kind") not in OF_SECTIONS:
        raise Refused("is of a shaft of sections, which the rotor of this case has not.", "Give a rigid housing.")
    bearings = []
    for place, (_, bearing) in enumerate(tables(data, "bearing"), start=1):
        position = number(bearing, "position", "m")
        if position is not None:  # else a fault of its own
            bearings.append((str(bearing.get("name") or place), position))
    return ross_housing(path, bearings)


def _modes(columns: Columns) -> list[dict[str, Any]]:
    """The modes as a case file has them. Raises Refused."""
    places = list(dict.fromkeys(name[:-2] for name in columns if name.endswith(AXES)))
    wanted = [FREQUENCY, *(f"{place}{axis}" for place in places for axis in AXES)]
    if missing := [name for name in wanted if name not in columns]:
        raise Refused(f"lacks {', '.join(missing)}.", MODE_COLUMNS)
    if unknown := [name for name in columns if name not in (*wanted, DAMPING)]:
        raise Refused(f'has the column "{unknown[0]}", which is not known here.', MODE_COLUMNS)
    count = len(columns[FREQUENCY])
    if not 1 <= count <= MOST_MODES:
        raise Refused(f"has {count} modes.", f"Give 1 to {MOST_MODES}, a row each.")
    return [
        {
            "frequency": f"{columns[FREQUENCY][row]!r} Hz",
            "damping": columns.get(DAMPING, [0.0] * count)[row],
            "at": {place: [columns[f"{place}{axis}"][row] for axis in AXES] for place in places},
        }
        for row in range(count)
    ]
