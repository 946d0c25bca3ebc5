"""The machine out of its bodies and of what lies between their nodes.

A film, a spring or a damper lies between a node of one body and a node of another, or the ground: it sees the motion of
the first against the second. One more body, such as the mass of a support or a housing, is one more entry; nothing that
uses the assembled machine changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from frbcli.arrays import Array
from frbcli.rotor.body import COORDINATES, PLANE, Body
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.loads import Load
from frbcli.rotor.over_speed import LinearPart

GROUND = ""


@dataclass(frozen=True)
class Link:
    """Where an element acts: from the node `inside` to the node `outside`, or the ground. count: of equal elements that
    one stands for, 2 in a symmetric rotor; sees: those of the COORDINATES of a node that it acts on."""

    inside: str
    outside: str = GROUND
    count: float = 1.0
    sees: tuple[str, ...] = PLANE


@dataclass(frozen=True)
class NodeForce:
    """A constant force (x, y) in N on a node."""

    node: str
    force: tuple[float, float]


def assembled(
    bodies: Sequence[Body],
    films: Sequence[Link] = (),
    parts: Sequence[tuple[Link, LinearPart]] = (),
    forces: Sequence[NodeForce] = (),
    loads: Sequence[tuple[str, Load]] = (),
) -> LinearRotor:
    """The machine of bodies, whose degrees of freedom follow each other in their order, with films between nodes,
    linear parts on the relative motion of nodes, constant forces on nodes, and loads on the (x, y) of nodes; a load on
    the GROUND is its acceleration, in m/s^2. Raises KeyError for a node that no body has, and for the GROUND under
    bodies of unknown inertia."""
    size = sum(body.size for body in bodies)
    nodes = _nodes(bodies, size)

    def relative(link: Link) -> Array:
        """(c, n) the coordinates of the inner node against the outer one that the link sees."""
        rows = [COORDINATES.index(each) for each in link.sees]
        inside = nodes[link.inside][rows]
        return inside if link.outside == GROUND else inside - nodes[link.outside][rows]

    def diagonal(of: Callable[[Body], Array]) -> Array:
        return reduce(_bordered, map(of, bodies))

    machine = LinearRotor(
        mass=diagonal(lambda body: body.mass),
        damping=diagonal(lambda body: body.damping),
        gyroscopic=diagonal(lambda body: body.gyroscopic),
        stiffness=diagonal(lambda body: body.stiffness),
        static_load=np.concatenate([body.static_load for body in bodies]),
        unbalance_cos=np.concatenate([body.unbalance_cos for body in bodies]),
        unbalance_sin=np.concatenate([body.unbalance_sin for body in bodies]),
        journals=np.array([relative(film) for film in films]) if films else np.zeros((0, len(PLANE), size)),
        multiplicity=np.array([film.count for film in films], dtype=np.float64),
        points=tuple((name, place[: len(PLANE)]) for name, place in nodes.items()),
    )
    own = [part.seen_by(relative(link), link.count) for link, part in parts]
    machine = machine.with_parts([*own, *_internal_dampings(bodies, size)])
    constant = (nodes[each.node][: len(PLANE)].T @ np.array(each.force) for each in forces)
    if all(body.inertia is not None for body in bodies):
        nodes[GROUND] = -np.concatenate([body.inertia for body in bodies if body.inertia is not None], axis=1)
    varying = tuple(load.seen_by(nodes[node][: len(PLANE)]) for node, load in loads)
    return replace(machine, static_load=sum(constant, machine.static_load), loads=varying)


def _internal_dampings(bodies: Sequence[Body], size: int) -> Iterator[LinearPart]:
    """The dampings of bodies that turn with them, on all degrees of freedom of a machine with n of them."""
    first = 0
    for body in bodies:
        if body.internal is not None:
            yield LinearPart.turning(body.internal).seen_by(np.eye(body.size, size, first))
        first += body.size


def _nodes(bodies: Sequence[Body], size: int) -> dict[str, Array]:
    """Names and maps of all nodes of a machine with n degrees of freedom, a row for each of the COORDINATES: nodes of
    bodies that do not tilt have none there."""
    found: dict[str, Array] = {}
    first = 0
    for body in bodies:
        for name, place in body.nodes:
            found[name] = np.zeros((len(COORDINATES), size))
            found[name][: len(place), first : first + body.size] = place
        first += body.size
    return found


def _bordered(matrix: Array, other: Array) -> Array:
    """Both matrices on the diagonal of a larger one."""
    n, m = len(matrix), len(other)
    return np.block([[matrix, np.zeros((n, m))], [np.zeros((m, n)), other]])
