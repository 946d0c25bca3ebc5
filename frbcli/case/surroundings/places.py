"""Places of a machine that forces can act on, and tables of a case with the rules that tie them to its machine."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from frbcli.case.model import Model
from frbcli.case.reading.tables import Breach, Path
from frbcli.case.surroundings.over_time import OverTime, over_time_problem
from frbcli.errors import did_you_mean

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


class MachineTable(Model):
    """A table of a case, or one of several with the same key, that has no effect without a rotor."""

    alone: ClassVar[bool] = False  # a single one has no number in its key

    @abstractmethod
    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        """Every rule that it breaks in a case with a rotor. path: its key in the case file, with its number."""


def machine_breaches(case: Case) -> Iterator[Breach]:
    """Every rule that tables of this kind break in a case."""
    for name, field in type(case).model_fields.items():
        given, key = getattr(case, name), field.alias or name
        for number, table in enumerate(given if isinstance(given, tuple) else (given,)):
            if isinstance(table, MachineTable):
                single = table is given or (table.alone and len(given) == 1)
                path: Path = (key,) if single else (key, number)
                if case.given_rotor is None:
                    yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
                else:
                    yield from table.breaches(case, path)
