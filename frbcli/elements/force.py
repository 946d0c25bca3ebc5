"""Constant forces on places of a machine."""

from __future__ import annotations

from frbcli.case.surroundings.force import AppliedForce
from frbcli.rotor.assembly import NodeForce
from frbcli.units import display


def node_force(force: AppliedForce, node: str, count: float) -> NodeForce:
    """The force on a node by `count` equal ones."""
    x, y = force.force
    return NodeForce(node, (count * x, count * y))


def told(force: AppliedForce, node: str, count: float) -> tuple[str, str]:
    """Its line of the plan."""
    x, y = (display(each, "N") for each in force.force)
    where = "at each of both equal bearings" if count > 1.0 else "at one place"
    return f"{node.replace('_', ' ')}: {x} in x, {y} in y", f"constant, {where}; beside unbalance and weight"
