"""Writes the tables of columns into the pages of the documents: `cd tests && python -m pages.column_tables`.

A table stands on a page below its mark, a comment `<!-- columns: NAME -->`.
"""

from __future__ import annotations

import re
from pathlib import Path

from paths import DOCS

from frbcli.bearing_tests.columns import MOMENTS, RESULT
from frbcli.columns import Column, Columns
from frbcli.linear.columns import DAMPED_MODES, FILM, MODES, POINT, RESPONSE_POINTS, SHEET
from frbcli.studies.comparison_columns import VARIANT
from frbcli.studies.ladder_columns import LADDER

TABLES: dict[str, Columns] = {
    "bearing sheet": SHEET,
    "stability": (*POINT[:2], *FILM, *POINT[2:]),
    "modes": MODES,
    "damped modes": DAMPED_MODES,
    "response": RESPONSE_POINTS,
    "kinematic tests": RESULT,
    "moments": MOMENTS,
    "accuracy": LADDER,
    "comparison": VARIANT,
}
MARKED = re.compile(r"(<!-- columns: ([a-z ]+) -->\n)((?:\|.*\n)*)")


def page_table(columns: Columns) -> str:
    """The table of columns in Markdown, without what only begins a row of the terminal."""
    rows = ["| pandas, CSV | JSON | unit | terminal | meaning |", "|" + " --- |" * 5]
    for column in (column for column in columns if column.meaning):
        cells = map(_escaped, (_flat(column), f"`{column.path}`" if column.path else "", column.unit, _told(column),
                               ": ".join(filter(None, (column.meaning, column.more)))))  # fmt: skip
        rows.append("|".join(["", *(f" {cell} " if cell else " " for cell in cells), ""]))
    return "\n".join(rows) + "\n"


def _flat(column: Column) -> str:
    first_and_last = dict.fromkeys((column.names[0], column.names[-1]))
    return " to ".join(f"`{name}`" for name in first_and_last) if column.flat else ""


def _told(column: Column) -> str:
    heads = ((", ".join(f"`{head}`" for head in shown.heads), *shown.unit_beside()) for shown in column.shown)
    return ", ".join(dict.fromkeys(map(" in ".join, heads)))


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|")


def marked(page: Path) -> list[str]:
    """The names of the tables on a page."""
    return [name for _, name, _ in MARKED.findall(page.read_text(encoding="utf-8"))]


def with_tables(page: Path) -> str:
    """The page with its tables as they are declared."""
    return MARKED.sub(lambda found: found[1] + page_table(TABLES[found[2]]), page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for each in DOCS.glob("*.md"):
        each.write_text(with_tables(each), encoding="utf-8")
