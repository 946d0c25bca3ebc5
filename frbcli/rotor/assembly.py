"""The machine without its films, as one linear system assembled of bodies and of what lies between their nodes.

M q'' + (D + Omega G) q' + K q = f_static + unbalance(alpha) + sum over films of P^T F

Elements whose forces are linear are part of M, D and K; where their coefficients depend on the speed, `over_speed`
holds what they add to the matrices, and `at` gives the rotor at a speed.

A film, a spring or a damper lies between a node of one body and a node of another, or the ground: it sees the motion of
the first against the second. One more body, such as the mass of a support or a housing, is one more entry; nothing that
uses the assembled machine changes.

A rotor as its bearings feel it at rest: with its journals held at given places, or in all its degrees of freedom.

Bodies of a machine: a shaft, a ring, a housing. Each moves by itself, and elements act between their nodes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.errors import NotConverged
from frbcli.rotor.loads import BOW, Harmonic, LinearPart, Load, bow_load, summed
from frbcli.rotor.port import ForceLaw, Port, Slope, pushed, settled

# Of a node, in the order of the rows of its map: displacements along x and y, then small rotations about x and y.
COORDINATES = ("x", "y", "tilt_x", "tilt_y")
PLANE = COORDINATES[:2]


@dataclass(frozen=True)
class Body:
    """A body with n degrees of freedom, SI units.

    mass, damping, gyroscopic, stiffness: (n, n), see LinearRotor; static_load: (n,) N; unbalance_cos, unbalance_sin:
    (n,) kg m, see LinearRotor. nodes: names and (c, n) maps of the places at which elements act and which a run
    records, with rows for the first c of the COORDINATES: the two of the PLANE, or all four of a node that tilts;
    inertia: (2, n) kg against accelerations of the ground in x and y, the mass matrix times a displacement of the whole
    body, None where that is not known. internal: (n / 2, n / 2) N s/m, damping of each plane that turns with the rotor,
    of a body with the degrees of freedom of x first, then of y; None without any. bow: (n / 2,) complex N of such a
    body, the forces that bend it to the shape that it has without any load, by the angle on the rotor of an unbalance;
    None of a straight one. """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    nodes: tuple[tuple[str, Array], ...]
    inertia: Array | None = None
    internal: Array | None = None
    bow: Complex | None = None

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)


def free_body(
    mass: Array, nodes: tuple[tuple[str, Array], ...], gravity: float, inertia: Array | None,
    damping: Array | None = None, stiffness: Array | None = None,
) -> Body:  # fmt: skip
    """A body without rotation and unbalance: mass (n, n) and, where it has any, damping and stiffness against the
    ground. inertia: see Body; its weight is known as far as that is, gravity in m/s^2."""
    nothing, none = np.zeros(len(mass)), np.zeros_like(mass)
    return Body(
        mass=mass,
        damping=none if damping is None else damping,
        gyroscopic=none,
        stiffness=none if stiffness is None else stiffness,
        static_load=nothing if inertia is None else 0.0 - gravity * inertia[1],
        unbalance_cos=nothing,
        unbalance_sin=nothing,
        nodes=nodes,
        inertia=inertia,
    )


def point_mass(
    node: str, mass: float, gravity: float, unbalance: float = 0.0, external_damping: float = 0.0, phase: float = 0.0
) -> Body:
    """A body that moves in the plane and does not tilt: a ring, the mass of a support, a rigid rotor. mass in kg,
    gravity in m/s^2, unbalance in kg m at an angle phase on the rotor, external_damping against the ground in N s/m.
    q = [x, y]."""
    plane = np.eye(2)
    body = free_body(mass * plane, ((node, plane),), gravity, mass * plane, external_damping * plane)
    cos, sin = unbalance_loads(unbalance, phase, np.ones(1))
    return replace(body, unbalance_cos=cos, unbalance_sin=sin)


def unbalance_loads(unbalance: float, phase: float, shape: Array) -> tuple[Array, Array]:
    """(2 n,) unbalance_cos and unbalance_sin in kg m of an unbalance at an angle phase in rad on the rotor; shape: (n,)
    the displacement of its place by the degrees of freedom of one plane."""
    cos, sin = unbalance * math.cos(phase), unbalance * math.sin(phase)
    return np.outer([cos, sin], shape).ravel(), np.outer([-sin, cos], shape).ravel()


def tilting_ring(node: str, mass: float, tilt_inertia: float, gravity: float) -> Body:
    """A ring that moves and tilts about its centre of mass, its only node. mass in kg, tilt_inertia about a diameter in
    kg m^2, gravity in m/s^2. q = the COORDINATES."""
    masses = np.diag([mass, mass, tilt_inertia, tilt_inertia])
    return free_body(masses, ((node, np.eye(4)),), gravity, mass * np.eye(2, 4))


def tilting_mass(nodes: tuple[str, str], mass: float, tilt_inertia: float, length: float, gravity: float) -> Body:
    """A rigid body with its nodes at both ends of a length in m and its centre of mass in the middle: the body of a
    cartridge. mass in kg; tilt_inertia about a diameter through its centre, kg m^2. q = [x, y, x, y] of both nodes; its
    centre moves with their mean, its slope is their difference over the length."""
    together, against = 0.25 * mass, tilt_inertia / length**2
    own, other = together + against, together - against
    plane = np.eye(2)
    first, second = np.hstack([plane, 0.0 * plane]), np.hstack([0.0 * plane, plane])
    x, y = (second - first) / length  # its slopes
    ends = tuple((name, np.vstack([place, -y, x])) for name, place in zip(nodes, (first, second), strict=True))
    masses = np.kron(np.array([[own, other], [other, own]]), plane)
    return free_body(masses, ends, gravity, 0.5 * mass * (first + second))


def spin(inertia: float) -> Body:
    """The angle in rad of a ring that turns or of a rotor whose speed is free, which no element between nodes acts on;
    inertia in kg m^2."""
    return free_body(inertia * np.eye(1), (), 0.0, np.zeros((2, 1)))


def jeffcott_rotor(
    mass: float,
    journal_mass: float,
    shaft_stiffness: float,
    unbalance: float,
    external_damping: float,
    shaft_damping: float,
    gravity: float,
    internal_damping: float = 0.0,
    phase: float = 0.0,
    bow: complex = 0.0,
) -> Body:
    """The symmetric Jeffcott rotor (2.4): a disk on a massless flexible shaft, two equal journals moving as one.

    Masses m_D, m_J in kg, stiffness c in N/m, unbalance U of the disk in kg m, dampings d_o, d_i in N s/m, gravity in
    m/s^2. internal_damping, N s/m, turns with the shaft, and shaft_damping does not. phase: of the unbalance, rad; bow:
    offset of the disk without load in m times exp(i its angle on the rotor). q = [x_J, x_D, y_J, y_D]."""
    coupling = np.array([[1.0, -1.0], [-1.0, 1.0]])
    masses = np.array([journal_mass, mass])
    cos, sin = unbalance_loads(unbalance, phase, np.array([0.0, 1.0]))
    return Body(
        mass=_both_planes(np.diag([journal_mass, mass])),
        damping=_both_planes(shaft_damping * coupling + np.diag([0.0, external_damping])),
        gyroscopic=np.zeros((4, 4)),
        stiffness=_both_planes(shaft_stiffness * coupling),
        static_load=np.concatenate([np.zeros(2), -gravity * masses]),
        unbalance_cos=cos,
        unbalance_sin=sin,
        nodes=(("journal", planar(4, 0, 2)), ("disk", planar(4, 1, 3))),
        inertia=np.kron(np.eye(2), masses),
        internal=internal_damping * coupling if internal_damping else None,
        bow=shaft_stiffness * coupling @ np.array([0.0, bow]) if bow else None,
    )


def planar(degrees: int, x: int, y: int) -> Array:
    """(2, degrees) map that picks the degrees of freedom x and y."""
    selection = np.zeros((2, degrees))
    selection[0, x] = selection[1, y] = 1.0
    return selection


def _both_planes(matrix: Array) -> Array:
    """The (2, 2) matrix of one plane for q = [x_J, x_D, y_J, y_D]."""
    return np.asarray(np.kron(np.eye(2), matrix), dtype=np.float64)


@dataclass(frozen=True)
class LinearRotor:
    """A machine with n degrees of freedom: a rotor, its rings and whatever else moves. SI units.

    mass, damping, gyroscopic, stiffness: (n, n); gyroscopic is multiplied by the rotor speed in rad/s. static_load:
    (n,) N. unbalance_cos, unbalance_sin: (n,) kg m: the unbalance pulls (2.3) with unbalance_cos (alpha'' cos alpha -
    alpha'^2 sin alpha) + unbalance_sin (alpha'' sin alpha + alpha'^2 cos alpha). journals: (films, c, n): P, the first
    c of the COORDINATES of each film's journal relative to its shell: x and y, and its tilts where films see them.
    multiplicity: (films,) how many equal bearings one film represents (2 in a symmetric rotor). points: names and (2,
    n) maps of the points that a run records and whose error is controlled. over_speed: what elements add to mass,
    damping and stiffness at a speed, None where nothing depends on it. loads: what else acts on it, and changes with
    the angle of the rotor or with time. cones: of bodies that turn by themselves and tilt, cartridges: each with the
    degree of freedom of its angle, and (2, n) its slopes in x and y times the root of its polar inertia: its gyroscopic
    moments pull with -(C^T J C) q' times its speed, J = [[0, 1], [-1, 0]]. ports: forces that are not linear; only
    `tangent` puts them into the matrices, and notes them as slopes. turning: degrees of freedom of rings that turn
    while it moves in small: on their angles nothing depends, on their speeds the films. """

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    journals: Array
    multiplicity: Array
    points: tuple[tuple[str, Array], ...]
    over_speed: LinearPart | None = None
    loads: tuple[Load, ...] = ()
    cones: tuple[tuple[int, Array], ...] = ()
    turning: tuple[int, ...] = ()
    ports: tuple[Port, ...] = ()
    slopes: tuple[Slope, ...] = ()

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)

    @property
    def unbalance(self) -> NDArray[np.complex128]:
        """(n,) kg m: at a constant speed Omega the unbalance pulls with Re(Omega^2 unbalance exp(i alpha))."""
        return np.asarray(self.unbalance_sin + 1j * self.unbalance_cos)

    @property
    def bent(self) -> NDArray[np.complex128]:
        """(n,) N: the forces by the bow are Re(bent exp(i alpha))."""
        bows = (load for load in self.loads if isinstance(load, Harmonic) and load.name == BOW)
        return sum((load.excitation(0.0)[1] for load in bows), np.zeros(self.size, dtype=np.complex128))

    def at(self, omega: float) -> LinearRotor:
        """The rotor at omega rad/s, with matrices that do not depend on the speed any more, but for the gyroscopic
        term."""
        if self.over_speed is None:
            return self
        stiffness, damping, mass = self.over_speed.at(omega)
        return replace(
            self,
            mass=self.mass + mass,
            damping=self.damping + damping,
            stiffness=self.stiffness + stiffness,
            over_speed=None,
        )

    def precession(self, speeds: Array) -> Array:
        """(n, n) what multiplies q' in addition to the damping, by the cones, at speeds (n,) of the angles in rad/s."""
        matrix = np.zeros_like(self.damping)
        for spin, cone in self.cones:
            matrix += speeds[spin] * (np.outer(cone[0], cone[1]) - np.outer(cone[1], cone[0]))
        return matrix

    def with_parts(self, parts: Sequence[LinearPart]) -> LinearRotor:
        """The rotor with linear parts on all of its degrees of freedom: constant ones join its matrices."""
        stiffness, damping, mass = self.stiffness, self.damping, self.mass
        for part in parts:
            if part.constant:
                stiffness, damping, mass = (
                    mine + more[0]
                    for mine, more in ((stiffness, part.stiffness), (damping, part.damping), (mass, part.mass))
                )
        own = () if self.over_speed is None else (self.over_speed,)
        changing = [*own, *(part for part in parts if not part.constant)]
        return replace(self, stiffness=stiffness, damping=damping, mass=mass, over_speed=summed(changing))


Real = TypeVar("Real", float, Array)


def unbalance_shares(alpha: Real, omega: Real, sine: Real, cosine: Real) -> tuple[Real, Real]:
    """What multiplies unbalance_cos and unbalance_sin in the force of the unbalance (2.3), 1/s^2, at the angular
    acceleration alpha and the speed omega of the rotor; sine and cosine: of its angle."""
    return alpha * cosine - omega**2 * sine, alpha * sine + omega**2 * cosine


def with_precession(rotor: LinearRotor, speeds: Array) -> LinearRotor:
    """The machine with the gyroscopic moments of its rings, which turn with speeds (rings,) in rad/s."""
    if not rotor.cones:
        return rotor
    turning = np.concatenate([np.zeros(rotor.size - len(speeds)), speeds])
    return replace(rotor, damping=rotor.damping + rotor.precession(turning), cones=())


def without_spins(rotor: LinearRotor, speeds: Array) -> LinearRotor:
    """The machine without its last degrees of freedom, the angles of its rings, which keep their speeds (rings,) in
    rad/s."""
    if len(speeds) == 0:
        return rotor
    rotor, kept = with_precession(rotor, speeds), np.arange(rotor.size - len(speeds))
    square = np.ix_(kept, kept)
    return replace(
        rotor,
        mass=rotor.mass[square],
        damping=rotor.damping[square],
        gyroscopic=rotor.gyroscopic[square],
        stiffness=rotor.stiffness[square],
        static_load=rotor.static_load[kept],
        unbalance_cos=rotor.unbalance_cos[kept],
        unbalance_sin=rotor.unbalance_sin[kept],
        journals=rotor.journals[:, :, kept],
        points=tuple((name, place[:, kept]) for name, place in rotor.points),
        over_speed=None if rotor.over_speed is None else rotor.over_speed.cut(kept),
        loads=tuple(load.cut(kept) for load in rotor.loads),
        ports=tuple(replace(port, place=port.place[:, kept]) for port in rotor.ports),
    )


GROUND = ""
HELD = 1e-10  # over the length of a port: where it rests
SINGULAR, SCALINGS = 1e13, 4  # condition number of balanced matrices, and the passes that balance them


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
    damped = ((body.internal, at) for body, at in _within(bodies, size) if body.internal is not None)
    machine = machine.with_parts([*own, *(LinearPart.turning(damping).seen_by(at) for damping, at in damped)])
    constant = (nodes[each.node][: len(PLANE)].T @ np.array(each.force) for each in forces)
    if all(body.inertia is not None for body in bodies):
        nodes[GROUND] = -np.concatenate([body.inertia for body in bodies if body.inertia is not None], axis=1)
    laws = tuple(Port(name, relative(link), link.count, law) for name, link, law in ports)
    varying = (load.seen_by(nodes[node][: len(PLANE)]) for node, load in loads)
    bent = (bow_load(body.bow).seen_by(at) for body, at in _within(bodies, size) if body.bow is not None)
    return replace(machine, static_load=sum(constant, machine.static_load), loads=(*bent, *varying), ports=laws)


def _within(bodies: Sequence[Body], size: int) -> Iterator[tuple[Body, Array]]:
    """Bodies with the maps (m, n) from the degrees of freedom of a machine with n of them to their own."""
    first = 0
    for body in bodies:
        yield body, np.eye(body.size, size, first)
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
    """A rotor at given places D (2 films,) of its journals in m, at which it is held.

    load: (2 films,) force in N that it puts on the films at D = 0, and stiffness (2 films, 2 films) N/m: it puts on
    load - stiffness @ D; shape: (n,) m its deflection at D = 0, and following (n, 2 films): its deflection is shape +
    following @ D.
    """

    load: Array
    stiffness: Array
    shape: Array
    following: Array


def sprung(rotor: LinearRotor) -> tuple[Array, Array]:
    """Static load (n,) in N and stiffness (n, n) of the rotor; what neither spring nor film holds, the angle of a ring,
    stays at zero."""
    loose = ~(rotor.stiffness.any(axis=1) | rotor.journals.any(axis=(0, 1)))
    return np.where(loose, 0.0, rotor.static_load), rotor.stiffness + np.diag(loose.astype(float))


def held_rotor(rotor: LinearRotor, omega: float = 0.0) -> HeldRotor:
    """The rotor at omega rad/s under its static load as its journals see it; what neither spring nor film holds, the
    angle of a ring, stays at zero. The speed counts where stiffnesses depend on it. Raises NotConverged if the bearings
    do not hold the rotor. Ports count as in small motions about where the rotor rests with its journals held in the
    middle."""
    if rotor.ports:
        return _held_at_ports(rotor, omega)
    rotor = rotor.at(omega)
    n, p, (load, stiffness) = rotor.size, rotor.journals.reshape(-1, rotor.size), sprung(rotor)
    count = len(p)
    if np.any(load != rotor.static_load):
        raise NotConverged("The bearings do not hold the rotor: none has a stiffness or a film. Give one to them.")
    held = np.block([[stiffness, p.T], [p, np.zeros((count, count))]])
    given = np.zeros((n + count, 1 + count))
    given[:n, 0] = load
    given[n:, 1:] = np.eye(count)
    scales = _scales(held)
    scaled = scales[:, None] * held * scales
    if not np.linalg.cond(scaled) < SINGULAR:  # a factorisation would find it singular or not by its last digits
        raise NotConverged("The bearings do not hold the rotor: it can turn about them. Give them different positions.")
    solution = scales[:, None] * np.linalg.solve(scaled, scales[:, None] * given)
    return HeldRotor(solution[n:, 0], -solution[n:, 1:], solution[:n, 0], solution[:n, 1:])


def _scales(matrix: Array) -> Array:
    """(n,) factors of rows and columns with which the largest entries of a symmetric matrix are near 1."""
    scales = np.ones(len(matrix))
    for _ in range(SCALINGS):
        largest = np.abs(scales[:, None] * matrix * scales).max(axis=1)
        scales = scales / np.sqrt(np.where(largest > 0.0, largest, 1.0))
    return scales


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
