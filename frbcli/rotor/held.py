"""A rotor as its bearings feel it at rest: with its journals held at given places, or in all its degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.rotor.body import PLANE
from frbcli.rotor.linear import LinearRotor


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
        found = unknowns if self.journals is None else self.journals @ unknowns
        return np.asarray(found.reshape(films, -1))


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
    do not hold the rotor."""
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


def preset(rotor: LinearRotor, films: Sequence[int]) -> LinearRotor:
    """The rotor with the springs beside these films set so that they carry its static load with the shells in their
    centres, as far as the other films let the shells feel it. Raises NotConverged as held_rotor."""
    if not films:
        return rotor
    places = rotor.journals[:, : len(PLANE)]
    load = held_rotor(replace(rotor, journals=places)).load.reshape(-1, len(PLANE))
    return replace(rotor, static_load=rotor.static_load - sum(places[i].T @ load[i] for i in films))
