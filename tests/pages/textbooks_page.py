"""Writes docs/textbooks.md, figures of textbooks beside the program's: `cd tests && python -m pages.textbooks_page`."""

import re
import sys
from collections.abc import Iterable
from textwrap import fill

from paths import DOCS, ROOT

sys.path.insert(0, str(ROOT / "tests" / "helpers"))  # as pytest has it

from pages.textbook_bearings import FORMS, TABLES
from pages.textbook_rotors import ROTORS
from pages.textbook_rows import Bench, Row

PAGE = DOCS / "textbooks.md"
NUMBERED, RANGE = r"\d+", r"\d+(?: to \d+)?"
HEAD = "| machine: source | quantity | source, frb | deviation, stated error, % |\n" + "|---" * 4
INTRODUCTION = """\
# Textbooks

Rotors, bearings and dampers of textbooks, standards and other programs. `cd tests && python -m pages.textbooks_page`
writes this page; `tests/docs/test_validation.py` checks it. Figures of the dissertation are in
[validation](validation.md).

- **machine**: an empty cell repeats the one above; (c): closed form, (p): other program, else printed. Numbered
  quantities have their values in order. Friswell's examples and Lund and Thomsen's tables are as in ROSS' tests,
  Butenschoen and Sander as in mboct-mbdyn-pkg.
- **stated error**: by the modes of a shaft and the mesh of a film.
- A number in brackets is the [reason](#why-figures-differ) of a deviation beyond printed digits and stated error.
"""
OPEN = """\
## What has no row

Not supported: pressure dams (Nicholas, Barrett and Leader 1980), tilting pads (Fillon, Bligoud, Frene 1992; Someya
1989, p. 83 and 107), porous aerostatic bearings (Miettinen et al. 2024) and labyrinth seals. A seal of known
coefficients is an [element](elements.md).
"""


def tables(parts: list[tuple[str, list[Row]]]) -> str:
    """The tables of the page, and the reasons behind them."""
    reasons = list(dict.fromkeys(row.reason for _, rows in parts for row in rows if row.reason))
    texts = []
    for title, rows in parts:
        cells: list[tuple[str, ...]] = []
        for row in rows:
            *others, deviation = row.cells()
            number = f" ({reasons.index(row.reason) + 1})" if row.reason else ""
            cells.append((*others, deviation + number))
        lines, machine = [], ""
        for first, *others in _joined(cells):
            lines.append(" | ".join(["" if first == machine else first, *others]))
            machine = first
        texts.append(f"## {title}\n\n{HEAD}|\n" + "".join(f"| {line} |\n" for line in lines))
    numbered = [
        fill(f"{n}. {reason}", 120, subsequent_indent="   ", break_long_words=False, break_on_hyphens=False)
        for n, reason in enumerate(reasons, 1)
    ]
    return "\n".join([*texts, "## Why figures differ\n", *numbered]) + "\n"


def _joined(cells: Iterable[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Rows of one machine whose quantities are numbered, such as "mode 1, Hz", in one row: "mode 1 to 3, Hz"."""
    rows: list[tuple[str, ...]] = []
    for row in cells:
        before = rows[-1] if rows else ("", "", "", "")
        numbers = [int(each) for each in re.findall(NUMBERED, row[1])[:1]]
        plain, last = re.sub(NUMBERED, "#", row[1], count=1), re.match(r".*?(\d+)(?: to (\d+))?", before[1])
        same = before[0] == row[0] and plain == re.sub(RANGE, "#", before[1], count=1) and last is not None
        if same and numbers and last and numbers[0] == int(last[2] or last[1]) + 1:
            quantity = plain.replace("#", f"{last[1]} to {numbers[0]}", 1)
            rows[-1] = (row[0], quantity, *(f"{a}; {b}" for a, b in zip(before[2:], row[2:], strict=True)))
        else:
            rows.append(row)
    return rows


def _single(row: tuple[str, ...]) -> list[tuple[str, ...]]:
    """The rows of a joined one."""
    found = re.search(r"(\d+) to (\d+)", row[1])
    if not found:
        return [row]
    values = zip(*(cell.split("; ") for cell in row[2:]), strict=True)
    numbers = range(int(found[1]), int(found[2]) + 1)
    return [(row[0], row[1].replace(found[0], str(n), 1), *each) for n, each in zip(numbers, values, strict=True)]


def written(text: str) -> list[tuple[str, ...]]:
    """Cells of all quantities of the page, the machine in each of them."""
    rows: list[tuple[str, ...]] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if line.startswith("| ") and not cells[0].startswith("machine"):
            rows += _single((cells[0] or rows[-1][0], *cells[1:]))
    return rows


def computed(benches: tuple[Bench, ...]) -> list[Row]:
    """All rows of some benches."""
    return [row for bench in benches for row in bench()]


if __name__ == "__main__":
    found = [("Rotors", computed(ROTORS)), ("Bearings and dampers", computed(FORMS + TABLES))]
    PAGE.write_text(f"{INTRODUCTION}\n{tables(found)}\n{OPEN}", encoding="utf-8")
