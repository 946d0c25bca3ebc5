"""Writes the lists of columns into the pages of the documents: `cd tests && python -m pages.column_tables`.

A list is below its mark on a page, a comment `<!-- columns: NAME -->`.
"""

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from paths import DOCS

from frbcli.balancing import PLANES, POINTS
from frbcli.bearing_tests.columns import GAS, MOMENT, MOMENT_HISTORY, RESULT, STRIBECK, moment_columns
from frbcli.cli.hard import HARD_CASE
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
from frbcli.equilibrium.linearised import HEAT_BALANCE, WARM_FILMS, WARM_RINGS
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
from frbcli.linear.damped_modes import API_POINTS, ISO_POINTS, MARGINS
from frbcli.linear.modes import CRITICAL_SPEEDS
from frbcli.results.columns import EVENTS, MACHINE_SIGNALS, PART_SIGNALS
from frbcli.scene.machine.findings import FILM_LOADS, FILM_OPERATION, FILM_TILTS
from frbcli.studies.accuracy import LADDER_COLUMNS
from frbcli.studies.against import DEVIATIONS, RIDGES
from frbcli.studies.compare import HEAT, VARIANT
from frbcli.studies.fit import FITTED
from frbcli.studies.sweep import point_columns


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
    "accuracy": LADDER_COLUMNS,
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
COMMON = re.compile(r"(<!-- common columns -->\n)((?:- .*\n)*)")
SMALL = {"a", "at", "in", "its", "number", "of", "on", "the"}  # words that say little
Row = tuple[str, str, str]  # names, what the terminal shows, and meaning


def page_list(columns: Columns, common: Mapping[str, str] = MappingProxyType({})) -> str:
    """The list of columns in Markdown, without what only begins a row of the terminal; neighbours of one meaning share
    a line. Those of `common`, meanings by names, and then obvious ones have one line without meanings."""
    lines: list[tuple[list[str], str]] = []
    known: list[str] = []
    for names, shown, meaning in _rows(columns):
        entry = f"{names} ({shown})" if names and shown else names or f"({shown})"
        if common and (common.get(names) == meaning or (names not in common and _obvious(names, meaning))):
            known.append(entry)
        elif lines and lines[-1][1] == meaning:
            lines[-1][0].append(entry)
        else:
            lines.append(([entry], meaning))
    first = f"- {', '.join(known)}\n" if known else ""
    return first + "".join(f"- {_joined(names)}: {meaning}\n" for names, meaning in lines)


def _obvious(names: str, meaning: str) -> bool:
    """Whether the names have all words of the meaning."""
    words = set(re.findall(r"[a-z0-9.]+", meaning.lower())) - SMALL
    return bool(names) and all(word[:5] in names.lower() for word in words)


def common_rows(page: Path) -> dict[str, str]:
    """Meanings by names of the rows that several lists of a page have, if it has a list of them."""
    text = page.read_text(encoding="utf-8")
    if not COMMON.search(text):
        return {}
    counted = Counter((names, meaning) for name in marked(page) for names, _, meaning in _rows(TABLES[name]) if names)
    common: dict[str, str] = {}
    for (names, meaning), times in counted.most_common():
        if times > 1:
            common.setdefault(names, meaning)
    return common


def _rows(columns: Columns) -> list[Row]:
    shown = [column for column in columns if column.meaning]
    mixed = any(column.flat for column in shown) and any(column.path for column in shown)
    return [
        (*_names(column, mixed), ": ".join(filter(None, (column.meaning, column.more)))) for column in shown
    ]


def _joined(names: list[str]) -> str:
    """Their names, of more than two that are numbered the first and the last one."""
    numbered = len(names) > 2 and len({re.sub(r"\d+", "", name) for name in names}) == 1
    return f"{names[0]} to {names[-1]}" if numbered else ", ".join(names)


def _names(column: Column, mixed: bool) -> tuple[str, str]:
    """Names in pandas and in JSON, which are marked where they differ, the list has both and no dot shows it, and heads
    of the terminal. The name of a vector or matrix in JSON is its name without axes, and is left out."""
    flat, path, head = _flat(column), f"`{column.path}`" if column.path else "", _head(column)
    if flat and column.path == re.sub("_xx?(?=_|$)", "", column.names[0], count=1):
        path = flat
    head = "" if head in ("``", flat, path) else head
    if mixed and flat != path:
        flat = f"CSV {flat}" if flat and not path else flat
        path = f"JSON {path}" if path and "." not in path else path
    return ", ".join(dict.fromkeys(filter(None, (flat, path)))), head


def _flat(column: Column) -> str:
    """The name, or the first and the last one of a vector or a matrix."""
    first, last = column.names[0], column.names[-1]
    if not column.flat or first == last:
        return f"`{first}`" if column.flat else ""
    start = next(place for place, letters in enumerate(zip(first, last, strict=True)) if len(set(letters)) > 1)
    return f"`{first}`{' to' if len(column.names) > 2 else ','} `_{last[start:]}`"


def _head(column: Column) -> str:
    heads = ((", ".join(f"`{head}`" for head in shown.heads), *shown.unit_beside()) for shown in column.shown)
    return ", ".join(dict.fromkeys(map(" in ".join, heads)))


def marked(page: Path) -> list[str]:
    """The names of the lists on a page."""
    return [name for _, name, _ in MARKED.findall(page.read_text(encoding="utf-8"))]


def with_tables(page: Path) -> str:
    """The page with its lists as they are declared."""
    common = common_rows(page)
    text = MARKED.sub(lambda found: found[1] + page_list(TABLES[found[2]], common), page.read_text(encoding="utf-8"))
    listed = "".join(f"- {names}: {meaning}\n" for names, meaning in sorted(common.items()))
    return COMMON.sub(lambda found: found[1] + listed, text)


if __name__ == "__main__":
    for each in DOCS.glob("*.md"):
        each.write_text(with_tables(each), encoding="utf-8")
