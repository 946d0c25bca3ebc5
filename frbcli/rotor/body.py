"""Bodies of a machine: a shaft, a ring, a housing. Each moves by itself, and elements act between their nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Complex

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
