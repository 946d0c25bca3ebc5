"""Writes the lists of columns into the pages of the documents: `cd tests && python -m pages.column_tables`.

A list is below its mark on a page, a comment `<!-- columns: NAME -->`.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from paths import DOCS

from frbcli.balancing.balance import PLANES, POINTS
from frbcli.bearing_tests.columns import GAS, MOMENT, MOMENT_HISTORY, RESULT, STRIBECK, moment_columns
from frbcli.cli.casefiles.hard import HARD_CASE
from frbcli.columns import Column, Columns
from frbcli.cycles.columns import (
    MISSING,
    cycle_columns,
    diagram_columns,
    equilibrium_columns,
    line_columns,
    map_columns,
    map_point_columns,
    special_columns,
    whirl_columns,
)
from frbcli.equilibrium.columns import HEAT_BALANCE, WARM_FILMS, WARM_RINGS
from frbcli.linear.balance_quality import COLUMNS as BALANCE_QUALITY
from frbcli.linear.columns import (
    AXIAL,
    BALL_SHEET,
    DAMPED_MODES,
    FILM,
    MIXED_FRICTION,
    MODES,
    NATURAL_MODES,
    PEAKS,
    POINT,
    REDUCTION,
    RESPONSE_COEFFICIENTS,
    RESPONSE_FILMS,
    RESPONSE_FORCES,
    RESPONSE_POINTS,
    SHEET,
    THRUST,
    TILTING,
)
from frbcli.linear.critical_map import CRITICAL_SPEEDS
from frbcli.linear.vibration import API_POINTS, ISO_POINTS, MARGINS
from frbcli.results.columns import EVENTS, MACHINE_SIGNALS, PART_SIGNALS
from frbcli.scene.machine.findings import FILM_LOADS
from frbcli.scene.machine.operating import FILM_OPERATION
from frbcli.scene.machine.shaft_tilt import FILM_TILTS
from frbcli.studies.against import DEVIATIONS, RIDGES
from frbcli.studies.compare import HEAT, VARIANT
from frbcli.studies.fit import FITTED
from frbcli.studies.ladder import LADDER
from frbcli.studies.sweep.sweep import point_columns


def of_pandas(columns: Columns) -> Columns:
    """Columns that JSON does not have."""
    return [replace(column, key="") for column in columns]


def of_json(columns: Columns) -> Columns:
    """Columns that pandas and CSV do not have."""
    return [replace(column, flat=False) for column in columns]


def without(columns: Columns, *beginnings: str) -> Columns:
    """Columns whose names do not begin like this: the page names these events in a sentence."""
    return [column for column in columns if not column.names[0].startswith(beginnings)]


TABLES: dict[str, Columns] = {
    "bearing sheet": SHEET,
    "mixed friction": MIXED_FRICTION,
    "ball bearings": BALL_SHEET,
    "thrust sheet": THRUST,
    "collar": tuple(column for column in AXIAL if column.quantity.startswith("axial")),
    "stability": (*POINT[:2], *FILM, *POINT[2:]),
    "tilting films": TILTING,
    "modes": of_json(MODES),
    "damped modes": DAMPED_MODES,
    "response": RESPONSE_POINTS,
    "kinematic tests": RESULT,
    "moment of the force": MOMENT,
    "gas of the oil": GAS,
    "stribeck curve": STRIBECK,
    "moments": moment_columns(False),
    "moment over time": MOMENT_HISTORY,
    "accuracy": LADDER,
    "comparison": VARIANT,
    "comparison with heat": of_json(HEAT),
    "natural modes": NATURAL_MODES,
    "reduction": of_json(REDUCTION),
    "forces": of_json(RESPONSE_FORCES),
    "peaks of the response": of_json(PEAKS),
    "vibration": of_json(API_POINTS),
    "zones": of_json(ISO_POINTS),
    "separation margins": of_json(MARGINS),
    "balance quality": BALANCE_QUALITY,
    "corrections": PLANES,
    "corrected points": of_json(POINTS),
    "films of the response": of_json(RESPONSE_FILMS),
    "coefficients of the response": of_json(RESPONSE_COEFFICIENTS),
    "critical speeds": of_pandas(CRITICAL_SPEEDS),
    "diagram": of_pandas(diagram_columns("speed", ("",), 1, ("Omega",), unbalance=True, heat=True, tilts=True)),
    "static equilibria": of_json(equilibrium_columns((), heat=True, tilts=True)),
    "cycles": of_json(cycle_columns((), heat=True, tilts=True)),
    "whirls": of_json(whirl_columns(())),
    "lines": of_json(line_columns(())),
    "missing whirls": of_json(MISSING),
    "special points": of_json(special_columns(())),
    "map": of_pandas(map_columns("KEY", "", "KEY of --and", "")),
    "map points": of_json(map_point_columns(())),
    "sweep": without(point_columns(("KEY",), "runup"), "critical_", "self_excited_", "offset_", "lock_in_", "contact_"),
    "fit": FITTED,
    "deviations": of_json(DEVIATIONS),
    "ridges": of_pandas([column for column in RIDGES if column.names[0].endswith("_computed")]),
    "hard cases": HARD_CASE,
    "events": of_json(EVENTS),
    "signals": MACHINE_SIGNALS + PART_SIGNALS,
    "warm films": of_json(WARM_FILMS),
    "warm rings": of_json(WARM_RINGS),
    "balance": of_json(HEAT_BALANCE),
    "loads": of_json(FILM_LOADS),
    "tilts": of_json(FILM_TILTS),
    "operation": of_json(FILM_OPERATION),
}
MARKED = re.compile(r"(<!-- columns: ([a-z ]+) -->\n)((?:- .*\n)*)")


def page_list(columns: Columns) -> str:
    """The list of columns in Markdown, without what only begins a row of the terminal; neighbours of one meaning share
    a line."""
    shown = [column for column in columns if column.meaning]
    mixed = any(column.flat for column in shown) and any(column.path for column in shown)
    lines: list[tuple[list[str], str]] = []
    for column in shown:
        meaning = ": ".join(filter(None, (column.meaning, column.more)))
        if lines and lines[-1][1] == meaning:
            lines[-1][0].append(_names(column, mixed))
        else:
            lines.append(([_names(column, mixed)], meaning))
    return "".join(f"- {_joined(names)}: {meaning}\n" for names, meaning in lines)


def _joined(names: list[str]) -> str:
    return f"{names[0]} to {names[-1]}" if len(names) > 2 else ", ".join(names)


def _names(column: Column, mixed: bool) -> str:
    """Names in pandas and in JSON, which are marked where they differ and the list has both, and in the terminal. The
    name of a vector or matrix in JSON is its name without axes, and is left out."""
    flat, path, told = _flat(column), f"`{column.path}`" if column.path else "", _told(column)
    if flat and column.path == re.sub("_xx?(?=_|$)", "", column.names[0], count=1):
        path = flat
    told = "" if told in ("``", flat, path) else f"terminal {told}" if told else ""
    if mixed and flat != path:
        flat, path = (f"CSV {flat}" if flat and not path else flat), (f"JSON {path}" if path else "")
    return ", ".join(dict.fromkeys(filter(None, (flat, path, told))))


def _flat(column: Column) -> str:
    first_and_last = dict.fromkeys((column.names[0], column.names[-1]))
    return " to ".join(f"`{name}`" for name in first_and_last) if column.flat else ""


def _told(column: Column) -> str:
    heads = ((", ".join(f"`{head}`" for head in shown.heads), *shown.unit_beside()) for shown in column.shown)
    return ", ".join(dict.fromkeys(map(" in ".join, heads)))


def marked(page: Path) -> list[str]:
    """The names of the lists on a page."""
    return [name for _, name, _ in MARKED.findall(page.read_text(encoding="utf-8"))]


def with_tables(page: Path) -> str:
    """The page with its lists as they are declared."""
    return MARKED.sub(lambda found: found[1] + page_list(TABLES[found[2]]), page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for each in DOCS.glob("*.md"):
        each.write_text(with_tables(each), encoding="utf-8")
