"""The hard cases on the terminal: apart, for their table loads numpy, and `frb cases` starts without it."""

from __future__ import annotations

from operator import attrgetter

from frbcli.case.reading.shipped import hard_cases
from frbcli.cli.common import Terminal
from frbcli.columns import Column, Shown, table_of

LIST = "list"  # table of the terminal

# Of a HardCase
HARD_CASE = (
    Column("name", "", "name of the hard case", shown=(Shown("case"), Shown("case", table=LIST))),
    Column("topic", "", "topic"),
    Column("hard", "", "difficulty", shown=(Shown("difficulty"), Shown("difficulty", table=LIST)), flat=False),
    Column("command", "", "command that it is for", attrgetter("words"), flat=False),
    Column("expected", "", "how it has to end", attrgetter("end"), shown=(Shown("ends", table=LIST),)),
    Column("why", "", "cause of that end", flat=False),
)


def list_hard(terminal: Terminal) -> None:
    """The table of all hard cases."""
    table = table_of(HARD_CASE, hard_cases())
    terminal.show("hard cases", table, LIST)
    terminal.remark("`frb cases --hard NAME` prints one as a case file.")
    terminal.emit({"command": "cases", "hard": table.documents()})


def hard_text(name: str) -> str:
    """The case file of a hard case: its shipped case with the settings put in. Raises InputError for an unknown name;
    a case that has to be refused is given as its base and its settings."""
    (hard,) = hard_cases([name])
    settings = "".join(f"#   --set '{text}'\n" for text in hard.settings)
    head = f"# {hard.hard}\n# The shipped case {hard.base} for `frb {hard.command}`, with\n{settings}"
    return head + (hard.case().source_text if hard.end != "input-error" else "# which has to be refused.\n")
