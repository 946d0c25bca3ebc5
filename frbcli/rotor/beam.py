"""The shaft as a Timoshenko beam: finite elements of one plane, free at both ends.

A node has a displacement v and a slope psi, the tilt of the cross-section. In the x-z plane psi is the rotation about
y, in the y-z plane the negative rotation about x, so that both planes share their matrices. The shear coefficient is
Cowper's (Journal of Applied Mechanics 33, 1966). An element interpolates with the exact static solution of the beam;
its mass has the rotary inertia, its polar inertia turns with the same slopes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_array


SAME_PLACE = 1e-6  # of the shaft's length: nodes that are closer are one
ELEMENTS = 80  # of a shaft, at least


@dataclass(frozen=True)
class BeamSection:
    """A cylindrical section of a shaft: lengths in m, density in kg/m^3, youngs_modulus in Pa; internal_damping in s,
    over its stiffness, turns with it; mass_damping in 1/s and stiffness_damping in s, over its mass and its stiffness,
    do not turn."""

    length: float
    diameter: float
    inner_diameter: float
    density: float
    youngs_modulus: float
    poisson_ratio: float
    internal_damping: float = 0.0
    mass_damping: float = 0.0
    stiffness_damping: float = 0.0

    @property
    def area(self) -> float:
        """Area of the cross-section, m^2."""
        return math.pi / 4 * (self.diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter, m^4."""
        return math.pi / 64 * (self.diameter**4 - self.inner_diameter**4)

    @property
    def shear_coefficient(self) -> float:
        """Cowper's coefficient of a circle or a ring."""
        nu, ratio = self.poisson_ratio, (self.inner_diameter / self.diameter) ** 2
        square = (1 + ratio) ** 2
        return 6 * (1 + nu) * square / ((7 + 6 * nu) * square + (20 + 12 * nu) * ratio)

    @property
    def shear_stiffness(self) -> float:
        """Shear force over shear angle, N."""
        return self.shear_coefficient * self.area * self.youngs_modulus / (2 * (1 + self.poisson_ratio))


@dataclass(frozen=True)
class Plane:
    """A free rotor in one plane with the degrees of freedom v_1, psi_1, v_2, psi_2, ... of its k nodes.

    positions: (k,) m along the shaft, ascending. mass, stiffness, polar: (2 k, 2 k), sparse; polar is the inertia about
    the axis of rotation that the slopes carry along, internal the damping C that turns with the shaft,
    mass_damping D_m and bending_damping D_b those that do not:
    M v'' - i Omega G v' + C (v' - i Omega v) + (D_m + D_b) v' + K v = f for v = x + i y.
    """

    positions: Array
    mass: csc_array
    stiffness: csc_array
    polar: csc_array
    internal: csc_array
    mass_damping: csc_array
    bending_damping: csc_array

    def node(self, position: float) -> int:
        """Index of the node at a position in m. Raises ValueError if there is none."""
        index = int(np.argmin(np.abs(self.positions - position)))
        if abs(self.positions[index] - position) > 2.0 * SAME_PLACE * np.ptp(self.positions):  # the last one is moved
            raise ValueError(f"no node at {position} m")
        return index


def element_matrices(
    length: Array, bending: Array, shear: Array, line_mass: Array, line_inertia: Array
) -> tuple[Array, Array, Array]:
    """Mass, stiffness and polar inertia (e, 4, 4) of e elements, degrees of freedom v_1, psi_1, v_2, psi_2.

    length: (e,) m; bending: (e,) E I in N m^2; shear: (e,) kappa G A in N; line_mass: (e,) rho A in kg/m;
    line_inertia: (e,) rho I in kg m.
    """
    points, weights = np.polynomial.legendre.leggauss(4)  # exact for the products of cubics
    s = 0.5 * (1 + points)
    size = length[:, None]
    phi = (12 * bending / (shear * length**2))[:, None]  # shear flexibility over bending flexibility
    one = np.ones_like(phi)
    v = np.stack(
        [
            1 - 3 * s**2 + 2 * s**3 + phi * (1 - s),
            size * (s - 2 * s**2 + s**3 + 0.5 * phi * (s - s**2)),
            3 * s**2 - 2 * s**3 + phi * s,
            size * (s**3 - s**2 + 0.5 * phi * (s**2 - s)),
        ]
    ) / (1 + phi)
    psi = np.stack(
        [
            6 * (s**2 - s) / size,
            1 - 4 * s + 3 * s**2 + phi * (1 - s),
            6 * (s - s**2) / size,
            3 * s**2 - 2 * s + phi * s,
        ]
    ) / (1 + phi)
    curvature = np.stack(
        [6 * (2 * s - 1) / size, -4 + 6 * s - phi, 6 * (1 - 2 * s) / size, 6 * s - 2 + phi]
    ) / (size * (1 + phi))
    shearing = np.stack([-one / size, -0.5 * one, one / size, -0.5 * one]) * phi / (1 + phi) + 0 * s

    def integral(left: Array, right: Array, density: Array) -> Array:
        matrices = np.einsum("iep,jep,ep->eij", left, right, 0.5 * weights * (density * length)[:, None])
        return np.asarray(matrices, dtype=np.float64)

    rotary = integral(psi, psi, line_inertia)
    mass = integral(v, v, line_mass) + rotary
    stiffness = integral(curvature, curvature, bending) + integral(shearing, shearing, shear)
    return mass, stiffness, 2 * rotary


def beam(sections: Sequence[BeamSection], stations: Sequence[float], elements: int = ELEMENTS) -> Plane:
    """The free shaft of sections that follow each other, with nodes at all their ends and at the stations (m).

    No element is longer than the shaft over `elements`.
    """
    ends = np.concatenate([[0.0], np.cumsum([section.length for section in sections])])
    positions = _nodes(np.concatenate([ends, np.asarray(stations, dtype=np.float64)]), ends[-1], elements)
    middles = 0.5 * (positions[1:] + positions[:-1])
    owners = [sections[index] for index in np.searchsorted(ends, middles) - 1]
    local = element_matrices(
        np.diff(positions),
        np.array([owner.youngs_modulus * owner.second_moment for owner in owners]),
        np.array([owner.shear_stiffness for owner in owners]),
        np.array([owner.density * owner.area for owner in owners]),
        np.array([owner.density * owner.second_moment for owner in owners]),
    )
    turning, of_mass, of_stiffness = np.array(
        [(owner.internal_damping, owner.mass_damping, owner.stiffness_damping) for owner in owners]
    ).T[:, :, None, None]
    mass, stiffness, _ = local
    dampings = turning * stiffness, of_mass * mass, of_stiffness * stiffness
    return Plane(positions, *map(_assembled, (*local, *dampings)))


def _nodes(places: Array, length: float, elements: int) -> Array:
    """Ascending nodes (k,) at all places, and as many between them as the longest element demands."""
    places = np.sort(np.clip(places, 0.0, length))
    kept = [0.0]
    for place in places:  # each that is merged lies near the node it is merged with, however many do
        if place - kept[-1] > SAME_PLACE * length:
            kept.append(float(place))
    kept[-1] = length
    parts = np.maximum(np.ceil(np.diff(kept) * elements / length - SAME_PLACE), 1).astype(int)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(kept[:-1], kept[1:], parts, strict=True)]
    return np.concatenate([*pieces, [length]])


def _assembled(local: Array) -> csc_array:
    """The matrix (2 k, 2 k) of a chain of k - 1 elements (k - 1, 4, 4)."""
    from scipy.sparse import coo_array  # a plan, which needs the numbers above alone, need not wait for its import

    places = 2 * np.arange(len(local))[:, None] + np.arange(4)
    rows, columns = np.repeat(places, 4, axis=1).ravel(), np.tile(places, 4).ravel()
    return coo_array((local.ravel(), (rows, columns)), shape=(2 * len(local) + 2,) * 2).tocsc()
