"""Text in a table: no formula to a spreadsheet, no command to a terminal."""

import re
from pathlib import Path

import numpy as np
import pandas as pd

from frbcli.results.write import harmless_text, write_table

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
