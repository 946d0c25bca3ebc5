"""The columns of hard cases: their list and their results."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

from frbcli.columns import Column, Shown, named, short_number

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


def _end(result: Any) -> str:
    return result.status if result.status == result.hard.end else f"{result.status}, not {result.hard.end}"


# Of a HardResult
HARD_RESULT = (
    *named(HARD_CASE[:-1], "", attrgetter("hard")),
    Column("status", "", "how it ended"),
    Column("end", "", "", _end, shown=(Shown("end"),), key="", flat=False),
    Column("ok", "", "whether it ended as the list says"),
    Column("message", "", "why it ended early", flat=False),
    Column("events", "", "kinds of events with their films", flat=False),
    Column("error", "", "deviation from the reference", shown=(Shown("error", short_number),),
           more="largest of the eccentricities until a whirl begins or the run ends; relative of a force"),
    Column("reported", "", "error that the run or test states", shown=(Shown("stated", short_number),)),
    Column("certain", "", "uncertainty of the reference"),
    Column("until", "s", "end of the comparison", attrgetter("until_s")),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU s", ".1f"),)),
    Column("problems", "", "deviations from the list", lambda result: "; ".join(result.problems), key=""),
    Column("problems", "", "deviations from the list, as a list", flat=False),
)  # fmt: skip
