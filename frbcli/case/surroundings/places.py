"""The places of a machine that forces can act on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from frbcli.case.model import Model
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.over_time import OverTime, over_time_problem
from frbcli.nearest import did_you_mean

if TYPE_CHECKING:
    from frbcli.case.schema import Case


def places(case: Case) -> tuple[str, ...]:
    """The nodes of the machine of a case, as its runs name them."""
    rotor, nodes = case.rotor, []
    if rotor.symmetric:
        nodes += ["journal"] if rotor.kind == "rigid" else ["journal", "disk"]
    else:
        nodes += [f"journal_{bearing.name}" for bearing in case.placed_bearings]
        nodes += [f"disk_{disk.name or number}" for number, disk in enumerate(case.disks, start=1)]
    for bearing in case.placed_bearings:
        if bearing.kind == "floating-ring":
            nodes.append(f"ring_{bearing.name}".rstrip("_"))
        if bearing.damper is not None:
            nodes.append(f"shell_{bearing.name}".rstrip("_"))
        if bearing.support is not None:
            nodes.append(f"support_{bearing.name}".rstrip("_"))
    if case.housing is not None:
        nodes += () if case.housing.modes and not rotor.symmetric else ("housing",)
        nodes += () if rotor.symmetric else [f"housing_{bearing.name}" for bearing in case.placed_bearings]
    return tuple(nodes)


def node_at(case: Case, at: str) -> str:
    """The node of a place: a node itself, or the journal of a bearing or the disk of a name; "" if there is none, or if
    both a bearing and a disk have the name."""
    known = places(case)
    if at in known:
        return at
    named = [node for node in (f"journal_{at}", f"disk_{at}") if node in known]
    return named[0] if len(named) == 1 else ""


def no_place(case: Case, at: str) -> tuple[str, str]:
    """Problem and remedy of a place that the machine does not have."""
    both = f"journal_{at}" in places(case)
    return "is both a bearing and a disk." if both else "is no place of the machine.", did_you_mean(at, places(case))


def table_breaches(path: Path, given: Model, table: OverTime, others: tuple[str, ...]) -> Iterator[Breach]:
    """Rules of a table over time together with other keys that say how a load changes."""
    extra = [key for key in others if key in given.model_fields_set]
    if extra:
        yield Breach((*path, extra[0]), "is given with file.", "Keep one of the two.")
    problem = over_time_problem(table.time, *table.both)
    if problem:
        yield Breach((*path, "over_time"), problem, "Order its rows by rising times.")
