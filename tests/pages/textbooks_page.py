"""Writes docs/textbooks.md, figures of textbooks beside the program's: `cd tests && python -m pages.textbooks_page`."""

from __future__ import annotations

import sys
from textwrap import fill

from paths import DOCS, ROOT

sys.path.insert(0, str(ROOT / "tests" / "helpers"))  # as pytest has it

from pages.textbook_bearings import FORMS, TABLES
from pages.textbook_rotors import ROTORS
from pages.textbook_rows import Bench, Row

PAGE = DOCS / "textbooks.md"
HEAD = (
    "| machine | source | kind | quantity | source's figure | frb | deviation | stated error | why |\n" + "| --- " * 9
)
INTRODUCTION = """\
# Textbooks

Rotors, bearings and dampers of textbooks, standards and other programs: each figure of a source beside frb's.
`cd tests && python -m pages.textbooks_page` computes all rows and writes this page. `tests/docs/test_textbooks.py`
checks them: rotors and short films in every run of the tests, films of finite length in the nightly ones.

- **kind**: a *printed* figure was read in the source or in the repository that is named; a *closed form* is evaluated
  from the equation of the source; *other program* is the figure of a program that is named.
- **stated error**: relative error that frb states beside its figure, by the modes that a shaft keeps and by the mesh of
  a film; empty where it states none.
- **why**: number of the reason below, of deviations beyond the printed digits and the stated error.

Figures of the dissertation are in [validation](validation.md).
"""
OPEN = """\
## What has no row

- The pressure dams of Nicholas, Barrett and Leader 1980 (bearings 1 of sets 1 to 5): a step that ends within a pad is
  not modelled. Their bearings without a dam are above.
- Tilting pads (Fillon, Bligoud, Frene 1992; Someya 1989, p. 83 and 107): a bearing with pads that tilt is not modelled.
- Porous aerostatic bearings (Miettinen et al. 2024) and labyrinth seals: not modelled. A seal of known coefficients is
  an [element](elements.md).
"""


def tables(parts: list[tuple[str, list[Row]]]) -> str:
    """The tables of the page, and the reasons behind them."""
    reasons = list(dict.fromkeys(row.reason for _, rows in parts for row in rows if row.reason))
    texts = []
    for title, rows in parts:
        lines = [" | ".join([*row.cells(), f"{reasons.index(row.reason) + 1}" if row.reason else ""]) for row in rows]
        texts.append(f"## {title}\n\n{HEAD}|\n" + "".join(f"| {line} |\n" for line in lines))
    numbered = [
        fill(f"{n}. {reason}", 120, subsequent_indent="   ", break_long_words=False, break_on_hyphens=False)
        for n, reason in enumerate(reasons, 1)
    ]
    return "\n".join([*texts, "## Why figures differ\n", *numbered]) + "\n"


def computed(benches: tuple[Bench, ...]) -> list[Row]:
    """All rows of some benches."""
    return [row for bench in benches for row in bench()]


if __name__ == "__main__":
    found = [("Rotors", computed(ROTORS)), ("Bearings and dampers", computed(FORMS + TABLES))]
    PAGE.write_text(f"{INTRODUCTION}\n{tables(found)}\n{OPEN}", encoding="utf-8")
