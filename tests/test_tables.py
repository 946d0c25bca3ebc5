"""Tables and errors on a screen of 80 columns."""

from __future__ import annotations

import pytest
from helpers.screen import seen

from frbcli.cli.common import PIPE_WIDTH, Terminal
from frbcli.cli.main import run

WRONG = ("check", "jeffcott", "--set", "foo.bar=2", "--set", "oil.viscosity=abc")


def lines(capsys: pytest.CaptureFixture[str]) -> list[str]:
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("before", range(8))
def test_the_components_of_a_vector_stay_in_one_table(before: int, capsys: pytest.CaptureFixture[str]) -> None:
    """However many columns are before them; each table begins with the first column."""
    names = ("film", *(f"column{k}" for k in range(before)), "Mx", "My")
    cells = [("inner", *["0.123456"] * before, "-0.002567890", "-0.000245678")]
    Terminal().table("", names, cells, (*(1,) * (before + 1), 2))
    heads = [line.split() for line in lines(capsys) if line.split()[:1] == ["film"]]
    assert ["Mx", "My"] in [head[-2:] for head in heads]
    assert sorted({name for head in heads for name in head}) == sorted(names)


def test_columns_that_no_table_holds_together_are_split(capsys: pytest.CaptureFixture[str]) -> None:
    names = ("film", *(f"entry-of-a-matrix-{k}" for k in range(6)))
    Terminal().table("", names, [("inner", *["1"] * 6)], (1, 6))
    printed = lines(capsys)
    assert max(map(len, printed)) <= PIPE_WIDTH
    assert {word for line in printed for word in line.split()} >= set(names)


def test_sentences_get_the_room_that_short_values_do_not_need(capsys: pytest.CaptureFixture[str]) -> None:
    """A plan: beside a value of two lines a reason has five; where the value has one, the reason has eight."""
    value, reason = "table over eccentricity and direction", "the force turns with the line of centres of the gap " * 3
    Terminal().table("", ("choice", "value", "reason"), [("expected cost", value, reason), ("film", "short", "short")])
    printed = lines(capsys)
    row = printed[printed.index(next(line for line in printed if line.startswith("  expected cost"))) :]
    row = row[: row.index(next(line for line in row if line.startswith("  film")))]
    assert max(map(len, printed)) <= PIPE_WIDTH
    assert len(row) <= 5


def test_heads_are_broken_before_cells(capsys: pytest.CaptureFixture[str]) -> None:
    names = ("film", "a head of several words", "second", "third", "fourth")
    Terminal().table("", names, [("compressor inner", *["12.3456789"] * 4)] * 2)
    printed = lines(capsys)
    assert max(map(len, printed)) <= PIPE_WIDTH
    assert sum("compressor inner" in line for line in printed) == 2
    assert not any("a head of several words" in line for line in printed)


def test_a_table_is_its_title_its_heads_a_line_and_its_rows(capsys: pytest.CaptureFixture[str]) -> None:
    """Heads that are broken stand on the line; all rows are as wide as the table. In a pipe nothing is bold."""
    long = "stiffness " * 9
    Terminal().table("K", ("a", "", long.strip()), [("1\n2", "x" * 4, "y")])
    title, above, first, second, line, row, below, last = lines(capsys)
    assert {len(each) for each in (title, above, first, second, line, row, below, last)} == {len(line)}
    assert (title.strip(), above.strip(), last.strip()) == ("K", "", "")
    assert first.split() + second.split() == [*["stiffness"] * 6, "a", *["stiffness"] * 3]
    assert line.strip() == "─" * (len(line) - 2)
    assert (row.split(), below.split()) == (["1", "xxxx", "y"], ["2"])


def test_tables_fit_a_terminal() -> None:
    shown = seen(("check", "jeffcott"), environment={"COLUMNS": "80"})
    assert shown.code == 0
    assert max(map(len, shown.text.splitlines())) <= 80


def test_errors_fit_the_screen_without_a_word_cut(capsys: pytest.CaptureFixture[str]) -> None:
    """In a pipe a fault is one line, which programs can read; on a terminal all of the same words are there."""
    assert run(WRONG) == 2
    piped = capsys.readouterr().err
    shown = seen(WRONG, environment={"COLUMNS": "80"})
    assert shown.code == 2
    assert max(map(len, piped.splitlines())) > 80 >= max(map(len, shown.text.splitlines()))
    assert shown.text.split() == piped.split()
