"""Tables of results as CSV, which spreadsheets and terminals may show."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frbcli.errors import printable
from frbcli.results.files.kinds import TABLES
from frbcli.results.files.write import written

if TYPE_CHECKING:
    import pandas as pd

# A spreadsheet takes what begins so for a formula, but for a number with a unit
FORMULA = re.compile(r"[=@]|[+-](?![\d.][\w.,%°µΩ·*/^ ]*$)")


def write_table(table: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, with texts that do nothing in a spreadsheet or a terminal. Raises InputError as `written`
    does."""
    harmless = table.rename(columns=harmless_text)
    for place, kind in enumerate(harmless.dtypes):
        if kind.kind not in "fiub":
            harmless.isetitem(place, harmless.iloc[:, place].map(harmless_text))
    with written(path, TABLES["csv"]) as part:
        harmless.to_csv(part, index=False, lineterminator="\n")


def harmless_text(cell: Any) -> Any:
    """A cell without control characters; a text that a spreadsheet would compute begins with an apostrophe."""
    if not isinstance(cell, str):
        return cell
    text = printable(cell)
    return f"'{text}" if FORMULA.match(text.lstrip()) else text
