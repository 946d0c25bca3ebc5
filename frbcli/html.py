"""Tables for notebooks: what cases, plans, runs and results show of themselves there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from frbcli.columns import Table
from frbcli.errors import printable

if TYPE_CHECKING:
    import pandas as pd

MOST_COLUMNS = 6  # of a table, in a line of text
MOST_ROWS = 60  # of a table; of the rest the number is stated


class Tabular:
    """A result that a notebook shows as its table: one with `table` or a `to_pandas` of its own, and a case that it is
    of."""

    def table(self) -> Table:
        """The declared columns of the result with their values."""
        raise NotImplementedError

    def to_pandas(self) -> pd.DataFrame:
        """The rows of the table, units in the names of the columns."""
        return self.table().to_pandas()

    def __repr__(self) -> str:
        """Kind, case and columns: three lines, whatever it holds."""
        frame, case = self.to_pandas(), getattr(self, "case", None)
        names = [str(name) for name in frame.columns]
        more = f" and {len(names) - MOST_COLUMNS} more" if len(names) > MOST_COLUMNS else ""
        of = "" if case is None else f" of {case.name}: {printable(case.title)}"
        return f"{type(self).__name__}{of}\n{len(frame)} rows of {', '.join(names[:MOST_COLUMNS])}{more}"

    def _repr_html_(self) -> str:
        frame, case = self.to_pandas(), getattr(self, "case", None)
        title = "" if case is None else case.heading
        words = ": ".join(word for word in (title, type(self).__name__) if word)
        return html_table(words, list(frame.columns), frame.itertuples(index=False), len(frame))


def html_table(title: str, columns: Sequence[str], rows: Iterable[Iterable[object]], count: int | None = None) -> str:
    """A table under its title, with at most MOST_ROWS rows; count: how many there are, where `rows` is not a sequence
    of known length."""
    shown = [[_cell(cell) for cell in row] for _, row in zip(range(MOST_ROWS), rows, strict=False)]
    head = "".join(f"<th style='text-align:left'>{escape(printable(str(name)))}</th>" for name in columns)
    body = "".join(f"<tr>{''.join(cells)}</tr>" for cells in shown)
    left = 0 if count is None else count - len(shown)
    more = f"<p>and {left} more rows</p>" if left > 0 else ""
    caption = f"<p><b>{escape(printable(title))}</b></p>" if title else ""
    return f"{caption}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _cell(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f"<td style='text-align:left'>{escape(printable(text))}</td>"
