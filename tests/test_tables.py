"""Tables and errors on a screen of 80 columns."""

import pytest
from helpers.screen import seen

from frbcli.cli.common import Terminal
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


def test_errors_fit_the_screen_without_a_word_cut(capsys: pytest.CaptureFixture[str]) -> None:
    """In a pipe a fault is one line, which programs can read; on a terminal all of the same words are there."""
    assert run(WRONG) == 2
    piped = capsys.readouterr().err
    shown = seen(WRONG, environment={"COLUMNS": "80"})
    assert shown.code == 2
    assert max(map(len, piped.splitlines())) > 80 >= max(map(len, shown.text.splitlines()))
    assert shown.text.split() == piped.split()
