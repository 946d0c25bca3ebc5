"""The places of a machine that forces can act on, and what is wrong with the loads of a case."""

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


def force_breaches(case: Case) -> Iterator[Breach]:
    """Every broken rule of the forces of a case."""
    for number, force in enumerate(case.forces):
        path: Path = ("force", number)
        if case.given_rotor is None:
            yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
            continue
        if not node_at(case, force.at):
            yield Breach((*path, "at"), *_no_place(case, force.at))
        if force.order is not None and force.frequency is not None:
            yield Breach((*path, "frequency"), "is given beside order.", "Keep one of the two.")
        for key in ("order", "frequency"):
            if getattr(force, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Leave it out: the force is then constant.")
        if force.over_time is not None:
            yield from _table_breaches(path, force, force.over_time, ("order", "frequency", "rotating", "phase"))
        elif force.force is None:
            yield Breach((*path, "force"), "is missing.", 'Write e.g. ["10 N", "0 N"].')
        elif force.phase and force.constant:
            yield Breach((*path, "phase"), "has no effect: the force is constant.", "Remove it, or give an order.")


def pull_breaches(case: Case) -> Iterator[Breach]:
    """Every broken rule of the magnetic pulls of a case."""
    for number, given in enumerate(case.magnetic_pulls):
        path: Path = ("magnetic_pull", number)
        if case.given_rotor is None:
            yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
            continue
        for key, place in (("at", given.at), ("stator", given.stator)):
            if (place or key == "at") and not node_at(case, place):
                yield Breach((*path, key), *_no_place(case, place))
        if given.stator and node_at(case, given.stator) == node_at(case, given.at):
            yield Breach((*path, "stator"), "is the place of the rotor.", "Name what carries the stator, or remove it.")


def _no_place(case: Case, at: str) -> tuple[str, str]:
    """Problem and remedy of a place that the machine does not have."""
    both = f"journal_{at}" in places(case)
    return "is both a bearing and a disk." if both else "is no place of the machine.", did_you_mean(at, places(case))


def base_breaches(case: Case) -> Iterator[Breach]:
    """Every broken rule of the motion of the ground."""
    for number, base in enumerate(case.bases):
        path: Path = ("base",) if len(case.bases) == 1 else ("base", number)
        if case.given_rotor is None:
            yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
            continue
        if case.housing is not None and case.housing.modes and not case.housing.masses:
            problem = "acts on masses, and those of the housing are not known: its modes do not say them."
            yield Breach(path, problem, "Give housing.masses, or a rigid housing.")
        if base.over_time is not None:
            yield from _table_breaches(path, base, base.over_time, ("order", "speed", "phase"))
            continue
        if base.acceleration is None:
            yield Breach((*path, "acceleration"), "is missing.", 'Write e.g. ["2 m/s^2", "0 m/s^2"], or a file.')
        elif base.order is None and base.speed is None:
            problem = "would not change: a ground that is only accelerated moves away."
            yield Breach((*path, "acceleration"), problem, "Give an order, the speed of what shakes, or a file.")
        for key in ("order", "speed"):
            if getattr(base, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Give what the ground swings with.")


def _table_breaches(path: Path, given: Model, table: OverTime, others: tuple[str, ...]) -> Iterator[Breach]:
    """Rules of a table over time beside the other keys that say how a load changes."""
    beside = [key for key in others if key in given.model_fields_set]
    if beside:
        yield Breach((*path, beside[0]), "is given beside file.", "Keep one of the two.")
    problem = over_time_problem(table.time, *table.both)
    if problem:
        yield Breach((*path, "over_time"), problem, "Order its rows by rising times.")
