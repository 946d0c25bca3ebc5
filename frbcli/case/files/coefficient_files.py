"""Coefficients of a bearing over speed out of a file: of ROSS, as `frb bearing --ross` writes it, too, or a CSV.

A file of ROSS is a table of its class and tag with lists kxx to cyy in N/m and N s/m over the frequency in rad/s, as
`BearingElement.save` writes it, TOML or JSON. The case gets the numbers instead of the key `file`, so that a run has
all that it was made of. """

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from frbcli.case.elements import AXES
from frbcli.case.reading.coefficient_files import Columns, Refused, finite, number_table, text_of, with_file
from frbcli.case.reading.settings import TomlFault, parse
from frbcli.case.reading.tables import Breach, tables

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
    try:
        data = json.loads(text) if is_json else parse(text)
    except TomlFault as error:
        where = "" if error.fault.line is None else f" in line {error.fault.line}"
        raise Refused(f"is no TOML{where}: it {error.fault.problem}", WRITE) from None
    except (ValueError, RecursionError):
        raise Refused("is no JSON.", WRITE) from None
    items = data.items() if isinstance(data, dict) else ()
    elements = [(name, item) for name, item in items if name.startswith(BEARINGS) and isinstance(item, dict)]
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
