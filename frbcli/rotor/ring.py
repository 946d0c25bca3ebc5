"""Floating rings: each puts a second film in series with the first and adds a body that moves in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.over_speed import LinearPart

Array = NDArray[np.float64]


def with_rings(
    rotor: LinearRotor, ring_masses: Sequence[float | None], gravity: float, names: Sequence[str] = ("",)
) -> LinearRotor:
    """The rotor with a floating ring in each bearing that has one.

    ring_masses: kg of one ring for each film of `rotor`, None where a bearing has no ring; gravity in m/s^2;
    names: of the bearings, as the recorded rings are called. The films are then those of the bearings in their order,
    the inner before the outer one: journal against ring, ring against shell. Where a film stands for several equal
    bearings their rings move as one, with the mass of all of them. Rings come last among the degrees of freedom, x, y
    of each.
    """
    ringed = [index for index, mass in enumerate(ring_masses) if mass is not None]
    masses = np.array([rotor.multiplicity[i] * (ring_masses[i] or 0.0) for i in ringed])
    n, added = rotor.size, 2 * len(ringed)
    films: list[Array] = []
    counts: list[float] = []
    points = [(name, _widened(place, added)) for name, place in rotor.points]
    for index, (journal, count) in enumerate(zip(rotor.journals, rotor.multiplicity, strict=True)):
        place = _widened(journal, added)
        if index in ringed:
            ring = np.zeros_like(place)
            first = n + 2 * ringed.index(index)
            ring[:, first : first + 2] = np.eye(2)
            films += [place - ring, ring]
            points.append((f"ring_{names[index]}".rstrip("_"), ring))
        else:
            films.append(place)
        counts += [float(count)] * (2 if index in ringed else 1)
    both = np.repeat(masses, 2)
    return replace(
        rotor,
        mass=_bordered(rotor.mass, np.diag(both)),
        damping=_bordered(rotor.damping, np.zeros((added, added))),
        gyroscopic=_bordered(rotor.gyroscopic, np.zeros((added, added))),
        stiffness=_bordered(rotor.stiffness, np.zeros((added, added))),
        static_load=np.concatenate([rotor.static_load, -gravity * both * np.tile([0.0, 1.0], len(ringed))]),
        unbalance_cos=np.concatenate([rotor.unbalance_cos, np.zeros(added)]),
        unbalance_sin=np.concatenate([rotor.unbalance_sin, np.zeros(added)]),
        journals=np.stack(films),
        multiplicity=np.array(counts),
        points=tuple(points),
        over_speed=_bordered_part(rotor, added),
    )


def with_spins(rotor: LinearRotor, inertias: Sequence[float]) -> LinearRotor:
    """The rotor with a last degree of freedom for each ring's angle, rad; inertias in kg m^2, of one ring each."""
    added = len(inertias)
    nothing = np.zeros((added, added))
    return replace(
        rotor,
        mass=_bordered(rotor.mass, np.diag(np.asarray(inertias, dtype=np.float64))),
        damping=_bordered(rotor.damping, nothing),
        gyroscopic=_bordered(rotor.gyroscopic, nothing),
        stiffness=_bordered(rotor.stiffness, nothing),
        static_load=np.concatenate([rotor.static_load, np.zeros(added)]),
        unbalance_cos=np.concatenate([rotor.unbalance_cos, np.zeros(added)]),
        unbalance_sin=np.concatenate([rotor.unbalance_sin, np.zeros(added)]),
        journals=np.concatenate([rotor.journals, np.zeros((*rotor.journals.shape[:2], added))], axis=2),
        points=tuple((name, _widened(place, added)) for name, place in rotor.points),
        over_speed=_bordered_part(rotor, added),
    )


def without_spins(rotor: LinearRotor, count: int) -> LinearRotor:
    """The rotor without its last `count` degrees of freedom, the angles of its rings."""
    if count == 0:
        return rotor
    return replace(
        rotor,
        mass=rotor.mass[:-count, :-count],
        damping=rotor.damping[:-count, :-count],
        gyroscopic=rotor.gyroscopic[:-count, :-count],
        stiffness=rotor.stiffness[:-count, :-count],
        static_load=rotor.static_load[:-count],
        unbalance_cos=rotor.unbalance_cos[:-count],
        unbalance_sin=rotor.unbalance_sin[:-count],
        journals=rotor.journals[:, :, :-count],
        points=tuple((name, place[:, :-count]) for name, place in rotor.points),
        over_speed=None if rotor.over_speed is None else rotor.over_speed.cut(count),
    )


def _bordered_part(rotor: LinearRotor, added: int) -> LinearPart | None:
    return None if rotor.over_speed is None else rotor.over_speed.bordered(added)


def _widened(place: Array, added: int) -> Array:
    return np.hstack([place, np.zeros((2, added))])


def _bordered(matrix: Array, ring: Array) -> Array:
    """Both matrices on the diagonal of a larger one."""
    n, m = len(matrix), len(ring)
    return np.block([[matrix, np.zeros((n, m))], [np.zeros((m, n)), ring]])
