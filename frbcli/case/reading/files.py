"""Files that a case names: their place in its tables, and columns of numbers out of a CSV with their names above.

The case gets the numbers instead of the key `file`, so that a run has all that it was made of.

The modes of a housing: a table, as a finite element program lists them, with a row for each mode, or a rotor of ROSS.

Coefficients of a bearing over speed: of ROSS, as `frb bearing --ross` writes it, too, or a CSV. A file of ROSS is a
table of its class and tag with lists kxx to cyy in N/m and N s/m over the frequency in rad/s, as `BearingElement.save`
writes it, TOML or JSON.
"""

from __future__ import annotations

import csv
import itertools
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from frbcli.case.elements import AXES
from frbcli.case.model import LARGEST
from frbcli.case.reading.settings import TomlFault, parse
from frbcli.case.reading.tables import Breach, at, number, replaced, table, tables
from frbcli.case.reading.tables import Path as Key
from frbcli.case.rotor import OF_SECTIONS
from frbcli.results.write import NoFile, NoText, Unreadable
from frbcli.results.write import text_of as text_of_file
from frbcli.units import is_number

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
    key = (*path, "file")
    given, name = at(data, path), at(data, key)
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
        if not (is_number(given) or isinstance(given, str)):
            raise ValueError
        value = float(given)
    except (ValueError, OverflowError):
        raise Refused(f'has no number as {row}. value of "{name}".', SI) from None
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise Refused(f'has a {row}. value of "{name}" that is no finite number within {LARGEST:g}.', SI)
    return value


def ross_tables(text: str, is_json: bool, wrong: str, write: str) -> dict[str, dict[str, Any]]:
    """The tables of a file of ROSS by their names; wrong, write: problem and remedy of a text that is none. Raises
    Refused."""
    try:
        data = json.loads(text) if is_json else parse(text)
    except TomlFault as error:
        where = "" if error.fault.line is None else f" in line {error.fault.line}"
        raise Refused(f"{wrong}{where}: it {error.fault.problem}", write) from None
    except (ValueError, RecursionError):
        raise Refused(f"{wrong}.", write) from None
    named = data if isinstance(data, dict) else {}
    return {name: values for name, values in named.items() if isinstance(values, dict)}


FREQUENCY, DAMPING = "frequency_Hz", "damping"
IN_X_AND_Y = ("_x", "_y")
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
    from frbcli.case.reading.ross import ross_housing  # which takes linear algebra

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
    places = list(dict.fromkeys(name[:-2] for name in columns if name.endswith(IN_X_AND_Y)))
    wanted = [FREQUENCY, *(f"{place}{axis}" for place in places for axis in IN_X_AND_Y)]
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
            "at": {place: [columns[f"{place}{axis}"][row] for axis in IN_X_AND_Y] for place in places},
        }
        for row in range(count)
    ]


MOST_SPEEDS = 2000
SPEED = "speed_Hz"
SPEEDS = {SPEED: 1.0, "speed_rpm": 1.0 / 60.0, "speed_rad_s": 0.5 / math.pi}  # columns, in Hz
OVER = ("frequency", "speed")  # of a file of ROSS: rad/s; its version 3 calls them speed
UNITS = {"k": "N/m", "c": "N*s/m", "m": "kg"}
REQUIRED = tuple(f"{letter}{axes}" for letter in "kc" for axes in AXES)
MASSES = tuple(f"m{axes}" for axes in AXES)
BEARINGS = ("BearingElement", "SealElement")
COLUMNS = f"Give the columns {SPEED} (or speed_rpm, speed_rad_s), {', '.join(REQUIRED)}, perhaps {', '.join(MASSES)}."
WRITE = "Write it with frb bearing --ross, with BearingElement.save of ROSS, or as .csv."


def with_coefficient_files(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with the numbers of each bearing's `file` instead of that key, and the faults.

    folder: that a relative path counts from. A bearing whose file has faults keeps the key.
    """

    def joined(name: str, kept: dict[str, Any]) -> dict[str, Any]:
        return {**kept, "over_speed": {"source": name, **_with_units(_checked(_read(folder / name)))}}

    breaches = list[Breach]()
    for path, bearing in tables(data, "bearing"):
        if bearing.get("kind") == "coefficients":
            excluded = ("stiffness", "damping", "mass", "over_speed")
            data, faults = with_file(data, path, joined, excluded, "Keep the file, or the coefficients themselves.")
            breaches += faults
    return data, breaches


def _with_units(columns: Columns) -> dict[str, list[str]]:
    speeds = [f"{value!r} Hz" for value in columns[SPEED]]
    named = [name for name in (*REQUIRED, *MASSES) if name in columns]
    return {"speed": speeds} | {name: [f"{value!r} {UNITS[name[0]]}" for value in columns[name]] for name in named}


def _read(path: Path) -> Columns:
    text = text_of(path, "a file of coefficients", WRITE)
    if path.suffix.lower() != ".csv":
        return _of_ross(text, path.suffix.lower() == ".json")
    columns = number_table(text, COLUMNS)
    over = [name for name in columns if name in SPEEDS]
    if len(over) > 1:
        raise Refused(f"has the columns {' and '.join(over)}.", "Keep one of them.")
    columns = {SPEED if name in SPEEDS else name: [SPEEDS.get(name, 1.0) * value for value in values]
               for name, values in columns.items()}  # fmt: skip
    unknown = [name for name in columns if name not in (SPEED, *REQUIRED, *MASSES)]
    if unknown:
        raise Refused(f'has the column "{unknown[0]}", which is not known here.', COLUMNS)
    return columns


def _of_ross(text: str, is_json: bool) -> Columns:
    named = ross_tables(text, is_json, "is no JSON" if is_json else "is no TOML", WRITE)
    elements = [(name, item) for name, item in named.items() if name.startswith(BEARINGS)]
    if len(elements) != 1:
        count = "no bearing" if not elements else f"{len(elements)} bearings"
        raise Refused(f"holds {count}, not one.", WRITE)
    name, element = elements[0]
    over = [key for key in OVER if element.get(key) is not None]
    if len(over) > 1:
        raise Refused(f'has both frequency and speed in "{name}".', "Keep one of them.")
    given = element[over[0]] if over else None
    columns: Columns = {}
    for key in (*REQUIRED, *MASSES):
        if element.get(key) is not None:
            columns[key] = _numbers(element[key], key)
    if given is None and all(len(values) == 1 for values in columns.values()):
        columns[SPEED] = [0.0]  # constant
    elif given is None:
        raise Refused(f'lacks "frequency", or "speed", in "{name}".', WRITE)
    else:
        columns[SPEED] = [value / (2.0 * math.pi) for value in _numbers(given, over[0])]
    return columns


def _numbers(given: object, name: str) -> list[float]:
    values = given if isinstance(given, list) else [given]
    return [finite(value, name, number) for number, value in enumerate(values, start=1)]


def _checked(columns: Columns) -> Columns:
    """The coefficients, with masses complete or left out."""
    missing = [name for name in (SPEED, *REQUIRED) if name not in columns]
    some = [name for name in MASSES if name in columns]
    if some:
        missing += [name for name in MASSES if name not in columns]
    if missing:
        raise Refused(f"lacks {', '.join(missing)}.", COLUMNS)
    count = len(columns[SPEED])
    if not 1 <= count <= MOST_SPEEDS:
        raise Refused(f"has {count} speeds.", f"Give 1 to {MOST_SPEEDS}.")
    for name, values in columns.items():
        if len(values) != count:
            raise Refused(f'has {len(values)} values of "{name}" at {count} speeds.', "Give one at each speed.")
    if problem := over_speed_problem(columns[SPEED], [columns[name] for name in MASSES] if some else ()):
        raise Refused(problem, "Give each speed once, in ascending order, and a mass that is not negative.")
    return columns


def over_speed_problem(speeds: Sequence[float], masses: Sequence[Sequence[float]]) -> str:
    """The fault of speeds in Hz and masses xx, xy, yx, yy at them, or nothing."""
    for below, above in itertools.pairwise(speeds):
        if above <= below:
            return f"has {above:g} Hz after {below:g} Hz: the speeds do not ascend."
    for speed, entries in zip(speeds, zip(*masses, strict=True), strict=False):
        if is_negative(entries):
            return f"has a mass matrix at {speed:g} Hz that is negative in some direction."
    return ""


def is_negative(mass: Sequence[float]) -> bool:
    """Whether a mass matrix xx, xy, yx, yy has a negative kinetic energy in some direction, beyond round-off."""
    xx, xy, yx, yy = mass
    cross = 0.5 * (xy + yx)
    least = 0.5 * (xx + yy) - math.hypot(0.5 * (xx - yy), cross)
    return least < -1e-12 * max(abs(entry) for entry in mass)


def column_lengths(over_speed: Mapping[str, Any]) -> dict[str, int]:
    """How many values each list of a table over speed has."""
    return {name: len(values) for name, values in over_speed.items() if isinstance(values, list)}
