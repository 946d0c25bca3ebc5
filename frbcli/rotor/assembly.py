"""A rotor on supports: assembly, what holds it.

The machine out of its bodies and of what lies between their nodes.

A film, a spring or a damper lies between a node of one body and a node of another, or the ground: it sees the motion of
the first against the second. One more body, such as the mass of a support or a housing, is one more entry; nothing that
uses the assembled machine changes.

A rotor as its bearings feel it at rest: with its journals held at given places, or in all its degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.rotor.body import COORDINATES, PLANE, Body
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.loads import LinearPart, Load, bow_load
from frbcli.rotor.port import ForceLaw, Port, pushed, settled

GROUND = ""
HELD = 1e-10  # over the length of a port: where it rests


@dataclass(frozen=True)
class Link:
    """Where an element acts: from the node `inside` to the node `outside`, or the ground. count: of equal elements that
    one represents, 2 in a symmetric rotor; sees: the COORDINATES of a node that it acts on."""

    inside: str
    outside: str = GROUND
    count: float = 1.0
    sees: tuple[str, ...] = PLANE


PortLink = tuple[str, Link, ForceLaw]  # name of its signal, between which nodes it acts, and how


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
    ports: Sequence[PortLink] = (),
) -> LinearRotor:
    """The machine of bodies, whose degrees of freedom follow each other in their order, with films between nodes,
    linear parts and ports on the relative motion of nodes, constant forces on nodes, and loads on the (x, y) of nodes;
    a load on the GROUND is its acceleration, in m/s^2. Raises KeyError for a node that no body has, and for the GROUND
    under bodies of unknown inertia."""
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
    laws = tuple(Port(name, relative(link), link.count, law) for name, link, law in ports)
    varying = (load.seen_by(nodes[node][: len(PLANE)]) for node, load in loads)
    loaded = (*_bows(bodies, size), *varying)
    return replace(machine, static_load=sum(constant, machine.static_load), loads=loaded, ports=laws)


def _bows(bodies: Sequence[Body], size: int) -> Iterator[Load]:
    """The loads of bodies that are bent without load, on all degrees of freedom of a machine with n of them."""
    first = 0
    for body in bodies:
        if body.bow is not None:
            yield bow_load(body.bow).seen_by(np.eye(body.size, size, first))
        first += body.size


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
    nodes: dict[str, Array] = {}
    first = 0
    for body in bodies:
        for name, place in body.nodes:
            nodes[name] = np.zeros((len(COORDINATES), size))
            nodes[name][: len(place), first : first + body.size] = place
        first += body.size
    return nodes


def _bordered(matrix: Array, other: Array) -> Array:
    """Both matrices on the diagonal of a larger one."""
    n, m = len(matrix), len(other)
    return np.block([[matrix, np.zeros((n, m))], [np.zeros((m, n)), other]])


@dataclass(frozen=True)
class HeldRotor:
    """A rotor at given u unknowns D: the places (2 films,) of its journals in m, at which it is held.

    load: (u,) force in N that it puts on the films at D = 0, and stiffness (u, u) N/m: it puts on load - stiffness @ D;
    shape: (n,) m its deflection at D = 0, and following (n, u): its deflection is shape + following @ D. journals:
    (c films, u) their coordinates by the unknowns where these are others, see whole_rotor, else None.
    """

    load: Array
    stiffness: Array
    shape: Array
    following: Array
    journals: Array | None = None

    def places(self, unknowns: Array, films: int) -> Array:
        """(films, c) coordinates of the journals."""
        coordinates = unknowns if self.journals is None else self.journals @ unknowns
        return np.asarray(coordinates.reshape(films, -1))


def whole_rotor(rotor: LinearRotor, omega: float = 0.0) -> HeldRotor:
    """The rotor at omega rad/s in all its degrees of freedom, for films that see tilts: a rigid shaft does not let all
    coordinates of its journals be held at once. What no film holds, the angle of a ring, stays at zero."""
    rotor, n = rotor.at(omega), rotor.size
    p = rotor.journals.reshape(-1, n)
    loose = ~(rotor.stiffness.any(axis=1) | p.any(axis=0))
    stiffness = rotor.stiffness + np.diag(loose.astype(float))
    return HeldRotor(np.where(loose, 0.0, rotor.static_load), stiffness, np.zeros(n), np.eye(n), p)


def held_rotor(rotor: LinearRotor, omega: float = 0.0) -> HeldRotor:
    """The rotor at omega rad/s under its static load as its journals see it; what neither spring nor film holds, the
    angle of a ring, stays at zero. The speed counts where stiffnesses depend on it. Raises NotConverged if the bearings
    do not hold the rotor. Ports count as in small motions about where the rotor rests with its journals held in the
    middle."""
    if rotor.ports:
        return _held_at_ports(rotor, omega)
    rotor = rotor.at(omega)
    n, p = rotor.size, rotor.journals.reshape(-1, rotor.size)
    count = len(p)
    loose = ~(rotor.stiffness.any(axis=1) | p.any(axis=0))
    if np.any(rotor.static_load[loose]):
        raise NotConverged("The bearings do not hold the rotor: none has a stiffness or a film. Give one to them.")
    held = np.block([[rotor.stiffness + np.diag(loose.astype(float)), p.T], [p, np.zeros((count, count))]])
    given = np.zeros((n + count, 1 + count))
    given[:n, 0] = rotor.static_load
    given[n:, 1:] = np.eye(count)
    try:
        solution = np.linalg.solve(held, given)
    except np.linalg.LinAlgError:
        raise NotConverged(
            "The bearings do not hold the rotor: it can turn about them. Give them different positions."
        ) from None
    return HeldRotor(solution[n:, 0], -solution[n:, 1:], solution[:n, 0], solution[:n, 1:])


def _held_at_ports(rotor: LinearRotor, omega: float) -> HeldRotor:
    """held_rotor by Newton's method for the ports, from the middle and from where the load pushes them."""

    def rest(flat: LinearRotor, _: Array) -> tuple[Array, HeldRotor]:
        held = held_rotor(flat, omega)
        return held.shape, held

    return settled(rotor, omega, (np.zeros(rotor.size), pushed(rotor)), rest, HELD, compiled=False)


def preset(rotor: LinearRotor, films: Sequence[int]) -> LinearRotor:
    """The rotor with the springs parallel to these films set so that they carry its static load with the shells in
    their centres, as far as the other films let the shells feel it. Raises NotConverged as held_rotor."""
    if not films:
        return rotor
    places = rotor.journals[:, : len(PLANE)]
    load = held_rotor(replace(rotor, journals=places)).load.reshape(-1, len(PLANE))
    return replace(rotor, static_load=rotor.static_load - sum(places[i].T @ load[i] for i in films))
