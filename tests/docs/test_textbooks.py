"""The rows of docs/textbooks.md: frb has the figures of their sources within the bounds of the rows."""

import re

import pytest
from pages.textbook_bearings import FORMS, TABLES, nicholas
from pages.textbook_rotors import ROTORS
from pages.textbook_rows import Bench
from pages.textbooks_page import PAGE, written


def hold(bench: Bench) -> None:
    page = {(*cells[:2], cells[2].split(", ")[0]) for cells in written(PAGE.read_text(encoding="utf-8"))}
    rows = bench()
    assert rows
    for row in rows:
        assert row.holds, row.cells()
        assert row.given in page


QUICK = (*ROTORS, *FORMS, nicholas)  # the others are tables of films of finite length
LONG = [pytest.param(bench, marks=pytest.mark.nightly) for bench in TABLES if bench not in QUICK]


@pytest.mark.parametrize("bench", [*QUICK, *LONG], ids=lambda bench: bench.__name__)
def test_figures_of_textbooks(bench: Bench) -> None:
    hold(bench)


def test_the_page_has_25_machines_and_says_why_figures_differ() -> None:
    text = PAGE.read_text(encoding="utf-8")
    rows = written(text)
    assert len({row[0].partition(":")[0] for row in rows}) >= 25
    reasons = text.partition("## Why figures differ")[2].partition("\n## ")[0]
    numbers = set(re.findall(r" \((\d+)\)(?:;| \|$)", text, re.MULTILINE))
    assert numbers
    for number in numbers:
        assert f"\n{number}. " in reasons
