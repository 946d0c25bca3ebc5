"""A turbocharger's rotor (2.1.3): rigid wheels on an elastic shaft, reduced to its lowest free modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.rotor.beam import BeamSection, Plane, beam
from frbcli.rotor.body import Body, unbalance_loads
from frbcli.rotor.reduction import FreeModes, PointForces


@dataclass(frozen=True)
class Wheel:
    """A rigid body on the shaft. position in m; mass in kg; inertias about the axis of rotation and about a diameter in
    kg m^2; unbalance in kg m; phase: its angle on the rotor in rad."""

    name: str
    position: float
    mass: float
    polar_inertia: float
    diametral_inertia: float
    unbalance: float
    phase: float


@dataclass(frozen=True)
class Journal:
    """The place of a bearing, with a film or without one. position: of its middle, m."""

    name: str
    position: float


def wheels_on_shaft(sections: Sequence[BeamSection], wheels: Sequence[Wheel], journals: Sequence[Journal]) -> Plane:
    """The free rotor in one plane, with nodes at all wheels and journals."""
    from scipy.sparse import diags_array

    places = [wheel.position for wheel in wheels] + [journal.position for journal in journals]
    shaft = beam(sections, places)
    mass, polar = np.zeros((2, 2 * len(shaft.positions)))  # diagonals
    for wheel in wheels:
        v = 2 * shaft.node(wheel.position)
        mass[v : v + 2] += wheel.mass, wheel.diametral_inertia
        polar[v + 1] += wheel.polar_inertia
    heavier, turning = shaft.mass + diags_array(mass), shaft.polar + diags_array(polar)
    return replace(shaft, mass=heavier.tocsc(), polar=turning.tocsc())


def turbocharger_rotor(
    modes: FreeModes,
    wheels: Sequence[Wheel],
    journals: Sequence[Journal],
    modal_damping: float,
    external_damping: float,
    gravity: float,
    collars: Sequence[Journal] = (),
    bow: PointForces | None = None,
) -> Body:
    """The rotor in the given modes, which are its degrees of freedom: n of the x-plane, then n of the y-plane.

    journals: the places of all bearings, with a film or without one; collars: of thrust bearings. modal_damping: ratio
    to the critical damping of every elastic mode; external_damping: of each wheel against the ground, N s/m; gravity in
    m/s^2. bow: the forces that bend a shaft to the shape that it has without load. """
    n = len(modes.frequencies)
    both, turned = np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])
    damping = modes.damping + np.diag(2 * modal_damping * modes.frequencies)
    unbalance_cos, unbalance_sin = np.zeros(2 * n), np.zeros(2 * n)
    for wheel in wheels:
        shape = modes.at(wheel.position)
        damping += external_damping * np.outer(shape, shape)
        cos, sin = unbalance_loads(wheel.unbalance, wheel.phase, shape)
        unbalance_cos += cos
        unbalance_sin += sin
    tilting = [(f"journal_{each.name}", each.position) for each in journals]
    tilting += [(each.name, each.position) for each in collars]
    nodes = [
        (name, np.vstack([_of(both, modes.at(position)), _of(-turned, modes.slope_at(position))]))
        for name, position in tilting
    ]
    nodes += [(f"disk_{wheel.name}", _of(both, modes.at(wheel.position))) for wheel in wheels]
    return Body(
        mass=np.eye(2 * n),
        damping=_of(both, damping),
        gyroscopic=_of(turned, modes.polar),
        stiffness=_of(both, np.diag(modes.frequencies**2)),
        static_load=np.concatenate([np.zeros(n), -gravity * modes.weight]),
        unbalance_cos=unbalance_cos,
        unbalance_sin=unbalance_sin,
        nodes=tuple(nodes),
        inertia=_of(both, modes.weight[None, :]),
        internal=modes.internal if modes.internal.any() else None,
        bow=None if bow is None else bow.of(modes),
    )


def _of(planes: Array, modes: Array) -> Array:
    """Both planes, coupled by `planes` (2, 2), out of the modes of one."""
    return np.asarray(np.kron(planes, modes), dtype=np.float64)
