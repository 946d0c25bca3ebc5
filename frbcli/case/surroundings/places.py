"""Places of a machine, its tables, and magnetic pulls there.

The places of a machine that forces can act on.

Tables of a case for what surrounds its rotor, each with the rules that tie it to the rest of the machine.

The magnetic pull of an electrical machine on its rotor.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Identifier, Quantity
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.over_time import OverTime, over_time_problem
from frbcli.nearest import did_you_mean

if TYPE_CHECKING:
    from frbcli.case.schema import Case


def places(case: Case) -> tuple[str, ...]:
    """The nodes of the machine of a case, as its runs name them."""
    rotor, found = case.rotor, []
    if rotor.symmetric:
        found += ["journal"] if rotor.kind == "rigid" else ["journal", "disk"]
    else:
        found += [f"journal_{bearing.name}" for bearing in case.placed_bearings]
        found += [f"disk_{disk.name or number}" for number, disk in enumerate(case.disks, start=1)]
    for bearing in case.placed_bearings:
        if bearing.kind == "floating-ring":
            found.append(f"ring_{bearing.name}".rstrip("_"))
        if bearing.damper is not None:
            found.append(f"shell_{bearing.name}".rstrip("_"))
        if bearing.support is not None:
            found.append(f"support_{bearing.name}".rstrip("_"))
    if case.housing is not None:
        found += () if case.housing.modes and not rotor.symmetric else ("housing",)
        found += () if rotor.symmetric else [f"housing_{bearing.name}" for bearing in case.placed_bearings]
    return tuple(found)


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
    """Rules of a table over time beside the other keys that say how a load changes."""
    beside = [key for key in others if key in given.model_fields_set]
    if beside:
        yield Breach((*path, beside[0]), "is given beside file.", "Keep one of the two.")
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


Pull = Annotated[float, Quantity("N/m", "1e5 N/m", above=0)]


class MagneticPull(MachineTable):
    """The unbalanced magnetic pull of an electrical machine: a spring of negative stiffness."""

    at: Identifier = Field(description="place of the rotor, as of a [[force]]")
    pull: Pull = Field(description="force over displacement; of a symmetric rotor at each of both journals")
    stator: Identifier = Field(
        default="", description="place that the stator is fixed to, such as `housing`; the ground if not given"
    )

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        for key, place in (("at", self.at), ("stator", self.stator)):
            if (place or key == "at") and not node_at(case, place):
                yield Breach((*path, key), *no_place(case, place))
        if self.stator and node_at(case, self.stator) == node_at(case, self.at):
            yield Breach((*path, "stator"), "is the place of the rotor.", "Name what carries the stator, or remove it.")
