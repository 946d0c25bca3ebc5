"""One declaration of a column makes pandas, CSV, JSON, the terminal's table with its legend, and a page's list. Tables
and errors on a screen of 80 columns. Text in a table: no formula to a spreadsheet, no command to a terminal."""

import math
import re
from dataclasses import dataclass, replace
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from commands import Frb
from pages import column_tables
from screen import seen

from frbcli.cli.common import Terminal
from frbcli.columns import ENTRIES, Column, Shown, heads, keys, legend, named, spread_table, table_of
from frbcli.results.write import harmless_text, write_table
from frbcli.units import with_uncertainty

COLUMNS = (
    Column("speed", "Hz", "rotor speed", shown=(Shown("Hz", ".3g"), Shown("Hz", ".4g", table="stiffness"))),
    Column("torque", "N m", "torque on the journal"),
    Column("p_max", "Pa", "largest pressure", shown=(Shown("p", ".3g", "bar"),), more="absolute"),
    Column("stiffness", "N/m", "stiffness", shape=(2, 2), shown=(Shown(ENTRIES, ".2g", "N/um", "stiffness"),)),
    Column("load", "N", "load", shape=(2,), flat=False),
    Column("error", "", "error", shown=(Shown("err.", ".0e"),), key="error.relative"),
    Column("rise", "K", "temperature rise", key=""),
)


@dataclass(frozen=True)
class Item:
    """A row."""

    speed_Hz: float = 123.456
    torque: float = -0.5
    p_max: float = 2.5e5
    stiffness: Any = None
    load: Any = (3.0, -4.0)
    error: float = math.nan
    rise: float = 7.0


KNOWN = Item(stiffness=np.array([[1e6, 2e6], [3e6, 4e6]]), error=3e-4)


def test_pandas_has_a_column_per_entry_with_its_unit_at_the_end() -> None:
    frame = table_of(COLUMNS, [KNOWN, Item()]).to_pandas()
    matrix = [f"stiffness_{entry}_N_m" for entry in ("xx", "xy", "yx", "yy")]
    assert list(frame.columns) == ["speed_Hz", "torque_N_m", "p_max_Pa", *matrix, "error", "rise_K"]
    assert frame["stiffness_xy_N_m"][0] == 2e6
    assert frame[matrix].loc[1].isna().all()
    assert frame["torque_N_m"].dtype == np.float64


def test_a_document_nests_keys_and_leaves_out_those_without_one() -> None:
    known, unknown = table_of(COLUMNS, [KNOWN, Item()]).documents()
    assert keys(COLUMNS) == ["speed_Hz", "torque_N_m", "p_max_Pa", "stiffness_N_m", "load_N", "error"]
    assert list(known) == keys(COLUMNS)
    assert known["error"] == {"relative": 3e-4}
    assert known["stiffness_N_m"] is KNOWN.stiffness
    assert unknown["stiffness_N_m"] is None


def test_the_terminal_shows_numbers_in_their_units() -> None:
    table = table_of(COLUMNS, [KNOWN, Item()])
    assert heads(COLUMNS) == ("Hz", "p", "err.")
    assert table.cells() == [("123", "2.5", "3e-4"), ("123", "2.5", "-")]
    assert heads(COLUMNS, "stiffness") == ("Hz", *ENTRIES)
    assert table.cells("stiffness") == [("123.5", "1", "2", "3", "4"), ("123.5", "-", "-", "-", "-")]
    assert legend(COLUMNS) == "Hz: rotor speed; p: largest pressure, bar; err.: error"


@pytest.mark.parametrize(
    ("value", "form", "cell"),
    [
        (-1e-17, ".1f", "0.0"), (-1e-17, ".3g", "-1e-17"), (-0.0, ".3g", "0"), (-0.06, ".1f", "-0.1"),
        (-0.2, "{:.0f}°".format, "0°"), (-10.2, "{:.0f}°".format, "-10°"),
        (2344.0, ".3g", "2340"), (-18334.0, ".4g", "-18330"), (2e6, ".3g", "2e+06"), (2e-7, ".0e", "2e-7"),
    ],
)  # fmt: skip
def test_noise_is_zero_and_large_numbers_are_plain(value: float, form: Any, cell: str) -> None:
    shown = Column("force", "N", "a force", value=lambda item: item, shown=(Shown("F", form),))
    assert table_of((shown,), [value]).cells() == [(cell,)]


def test_a_page_has_names_units_and_meaning() -> None:
    rows = column_tables.page_list(COLUMNS).splitlines()
    assert len(rows) == len(COLUMNS)
    assert rows[2] == "- `p_max_Pa` (`p` in bar): largest pressure: absolute"
    assert rows[3].startswith("- `stiffness_xx_N_m` to `_yy_N_m` (")
    assert rows[4].startswith("- JSON `load_N`")
    assert rows[6] == "- CSV `rise_K`: temperature rise"


def test_columns_of_a_part_have_its_name_at_their_end() -> None:
    (column,) = named(COLUMNS[3:4], "inner", attrgetter("film"))
    holder = type("Holder", (), {"film": KNOWN})()
    assert table_of([column], [holder]).to_pandas()["stiffness_xy_N_m_inner"][0] == 2e6
    assert column.value_of(type("Holder", (), {"film": None})()) is None


def test_arrays_are_spread_over_rows() -> None:
    columns = (
        replace(COLUMNS[0], value=lambda _: np.array([[1.0], [2.0]])),
        Column("point", "", "point", lambda _: ("journal", "disk")),
        Column("amplitude", "m", "amplitude", lambda _: np.arange(4.0).reshape(2, 2)),
    )
    frame = spread_table(columns, None).to_pandas()
    rows = [(1.0, "journal", 0.0), (1.0, "disk", 1.0), (2.0, "journal", 2.0), (2.0, "disk", 3.0)]
    pd.testing.assert_frame_equal(frame, pd.DataFrame(rows, columns=["speed_Hz", "point", "amplitude_m"]))


@pytest.mark.parametrize("columns", column_tables.TABLES.values(), ids=column_tables.TABLES)
def test_declared_names_are_of_one_column_each(columns: tuple[Column, ...]) -> None:
    flat = [name for column in columns if column.flat for name in column.names]
    json = [column.path for column in columns if column.path]
    assert len(set(flat)) == len(flat)
    assert len(set(json)) == len(json)


@pytest.mark.parametrize(
    ("value", "uncertainty", "digits", "told"),
    [
        (318.04, 4.0, 1, "318(4)"),
        (318.04, 3.2, 1, "318(4)"),
        (204.44, 0.6, 1, "204.4(6)"),
        (204.44, 1.2, 1, "204.4(12)"),
        (1014.0, 17.2, 1, "1014(18)"),
        (1014.0, 230.0, 1, "1014(230)"),
        (142.907, 0.004, 1, "142.9(1)"),
        (0.372, 0.0053, 3, "0.372(6)"),
        (0.372, None, 3, "0.372"),
        (0.372, 0.0, 3, "0.372"),
        (0.372, math.inf, 3, "0.372"),
        (None, 1.0, 3, "-"),
    ],
)
def test_a_number_has_its_uncertainty_in_its_last_digits(
    value: float | None, uncertainty: float | None, digits: int, told: str
) -> None:
    assert with_uncertainty(value, uncertainty, digits) == told


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


def test_errors_fit_the_screen_without_a_word_cut(frb: Frb) -> None:
    """In a pipe a fault is one line, which programs can read; on a terminal all of the same words are there."""
    piped = frb(*WRONG, code=2).err
    shown = seen(WRONG, environment={"COLUMNS": "80"})
    assert shown.code == 2
    assert max(map(len, piped.splitlines())) > 80 >= max(map(len, shown.text.splitlines()))
    assert shown.text.split() == piped.split()


HARMFUL = ["=cmd|' /C calc'!A0", "@SUM(1)", "+1+cmd|x", "-2+3", " =1", "=1"]
HARMLESS = ["1 g*mm", "-5 N", "+1.5e3 N*s/m", "-3.5 um", "--", "a=b", "", "-1", "[1, 2]"]


def test_a_table_is_not_computed_by_a_spreadsheet_nor_obeyed_by_a_terminal(tmp_path: Path) -> None:
    assert [harmless_text(text) for text in HARMFUL] == [f"'{text}" for text in HARMFUL]
    assert [harmless_text(text) for text in HARMLESS if text != "--"] == [text for text in HARMLESS if text != "--"]
    assert harmless_text("\x1b[2Jx\x07") == "?[2Jx?"
    table = pd.DataFrame({"=film": [1.5, -2.0], "film": ["=1", "\x1b]0;x\x07"], "none": [None, np.nan]})
    table = table[["film", "=film", "none"]]
    write_table(table, tmp_path / "a.csv")
    text = re.sub(r"0{25}\d{10}(?=,\n$)", "", (tmp_path / "a.csv").read_text())  # without the checksum
    assert text == "film,'=film,none\n'=1,1.5,\n?]0;x?,-2.0,\n"
