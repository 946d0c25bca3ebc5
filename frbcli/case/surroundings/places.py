"""The places of a machine that forces can act on, and what is wrong with forces of a case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from frbcli.case.reading.tables import Breach
from frbcli.nearest import did_you_mean

if TYPE_CHECKING:
    from frbcli.case.schema import Case


def places(case: Case) -> tuple[str, ...]:
    """The nodes of the machine of a case, as its runs name them."""
    rotor, found = case.rotor, []
    if rotor.symmetric:
        found += ["journal"] if rotor.kind == "rigid" else ["journal", "disk"]
    else:
        found += [f"journal_{bearing.name}" for bearing in case.given_bearings]
        found += [f"disk_{disk.name or number}" for number, disk in enumerate(case.disks, start=1)]
    for bearing in case.given_bearings:
        if bearing.kind == "floating-ring":
            found.append(f"ring_{bearing.name}".rstrip("_"))
        if bearing.damper is not None:
            found.append(f"shell_{bearing.name}".rstrip("_"))
        if bearing.support is not None:
            found.append(f"support_{bearing.name}".rstrip("_"))
    if case.housing is not None:
        found += () if case.housing.modes and not rotor.symmetric else ("housing",)
        found += () if rotor.symmetric else [f"housing_{bearing.name}" for bearing in case.given_bearings]
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
        path = ("force", number)
        if case.given_rotor is None:
            yield Breach(path, "has no effect: a kinematic test moves its journal.", "Remove it.")
            continue
        if not node_at(case, force.at):
            both = f"journal_{force.at}" in places(case)
            problem = "is both a bearing and a disk." if both else "is no place of the machine."
            yield Breach((*path, "at"), problem, did_you_mean(force.at, places(case)))
        if force.order is not None and force.frequency is not None:
            yield Breach((*path, "frequency"), "is given beside order.", "Keep one of the two.")
        for key in ("order", "frequency"):
            if getattr(force, key) == 0.0:
                yield Breach((*path, key), "is 0.", "Leave it out: the force is then constant.")
        if force.phase and force.constant:
            yield Breach((*path, "phase"), "has no effect: the force is constant.", "Remove it, or give an order.")
