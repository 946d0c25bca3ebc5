"""The resting position of a rotor at a given speed: K q = f_static + sum over films of m P^T F(P q, 0, omega).

The rotor is linear, and the films see its journals only. So it is condensed first to the force that it exerts on its
films with the journals held at given places; Newton's method then runs on the two coordinates of each journal. Floating
rings turn with the speeds at which the torques on them balance (ring_speeds), which follow from the places of the
journals: they are no unknowns of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from frbcli.equilibrium.newton import ForceBalance, Search, search_rest
from frbcli.errors import NotConverged
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.rectangles.film import FilmForce
from frbcli.rotor.held import HeldRotor, held_rotor, whole_rotor
from frbcli.scene.machine.system import System

Array = NDArray[np.float64]

SEARCH = Search(step=1e-10, force=0.0, share=1e-8, gap=1.0 - LARGEST_ECCENTRICITY)
STILL = 1e-6  # N: round-off of the films of a rotor without weight
OUTER_START = 0.9  # eccentricity of the last start that is tried
NUDGE = 1e-6  # of the clearance: of the differences by which the rings' speeds follow a journal


@dataclass(frozen=True)
class RestingPosition:
    """A machine at rest. displacements: (n,) in m, rings at their angle 0; journals: (films, c) in m, with the
    tilts in rad that films see; ring_speeds:
    (rings,) rad/s at which the torques on the rings balance; films: the films there, () where nothing turns and nothing
    has to be carried."""

    displacements: Array
    journals: Array
    ring_speeds: Array
    films: tuple[FilmForce, ...]

    def velocities(self, system: System) -> Array:
        """(n,) those of all degrees of freedom: the rings turn."""
        found = np.zeros_like(self.displacements)
        found[list(system.spins)] = self.ring_speeds
        return found


def resting_position(
    system: System, omega: float, start: Array | None = None, search: Search = SEARCH
) -> RestingPosition:
    """Where the machine rests at omega rad/s, sought from the displacements `start` (n,), if journals are within their
    gaps there, then from the centre.

    Raises NotConverged if no start leads to one.
    """
    in_plane = replace(system.rotor, journals=system.rotor.journals[:, :2])
    held, clearances = held_rotor(in_plane, omega), np.array(system.clearances)[:, None]
    loads = held.load.reshape(-1, 2)
    size = np.linalg.norm(loads, axis=1, keepdims=True)
    along = np.divide(loads, size, out=np.zeros_like(loads), where=size > 0.0)
    if not system.names:
        return _position(system, held, omega, held.shape, ())
    starts = [np.zeros_like(loads), OUTER_START * clearances * along]
    if system.asperities is not None:
        carried = size[:, 0] / system.rotor.multiplicity
        starts.append(along * [[system.rubbing(i).standing(load)] for i, load in enumerate(carried.tolist())])
    if system.films.coordinates > 2:
        starts = [held.shape + held.following @ each.ravel() for each in starts]
        held = whole_rotor(system.rotor, omega)
    ends = partial(_ends, system, held)
    if start is not None:
        near = system.rotor.journals @ start if held.journals is None else start
        if np.linalg.norm(ends(near), axis=1).max() < LARGEST_ECCENTRICITY:
            starts.insert(0, near)
    left = np.inf
    for first in starts:
        found = search_rest(partial(_balance, system, held, omega), first, ends, search)
        within = np.linalg.norm(ends(found.position), axis=1).max() < LARGEST_ECCENTRICITY
        if found.settled and within:
            displacements = held.shape + held.following @ found.position.ravel()
            return _position(system, held, omega, displacements, found.balance.films)
        left = min(left, found.balance.left)
    if not loads.any() and left < STILL:  # films that do not turn hold nothing, and have nothing to hold
        return _position(system, held, omega, held.shape, ())
    raise NotConverged(
        f"No resting position at {omega / (2 * np.pi):.4g} Hz below an eccentricity of {LARGEST_ECCENTRICITY}: "
        f"{len(starts)} starts, residual {left:.3g} N of {np.linalg.norm(loads):.3g} N. "
        "Ask for a higher speed, or give the bearing more viscosity, more width or less clearance."
    )


def _position(
    system: System, held: HeldRotor, omega: float, displacements: Array, films: tuple[FilmForce, ...]
) -> RestingPosition:
    journals = system.rotor.journals @ displacements + system.films.standing
    return RestingPosition(displacements, journals, ring_speeds(system, held, omega, journals), films)


def ring_speeds(system: System, held: HeldRotor, omega: float, position: Array) -> Array:
    """(rings,) speeds in rad/s at which the torques (4.17) on the rings balance, films full of oil, at rest in
    `position` (films, 2) in m.

    Couette's terms pull towards the rotor and towards the housing, Poiseuille's is half the moment of the film's force.
    """
    if not system.ring_count:
        return np.zeros(0)
    eccentricity = np.linalg.norm(position, axis=1) / np.array(system.clearances)
    sheared = system.films.sheared * np.array(system.drags)
    drag = sheared * 2.0 * np.pi / np.sqrt(np.maximum(1.0 - eccentricity**2, 1e-6))
    carried = (held.load - held.stiffness @ position.ravel()).reshape(-1, 2) / system.rotor.multiplicity[:, None]
    moment = 0.5 * (position[:, 0] * carried[:, 1] - position[:, 1] * carried[:, 0])
    if system.torque != "all":
        moment = np.zeros_like(moment)
    speeds = np.zeros(system.ring_count)
    for ring in range(system.ring_count):
        outer, inner = (system.bodies == ring).T
        driving = omega * drag[inner] + moment[inner] + moment[outer]  # of a cartridge at both ends
        speeds[ring] = np.sum(driving) / np.sum(drag[inner] + drag[outer])
    return speeds


def _balance(
    system: System, held: HeldRotor, omega: float, position: Array, before: ForceBalance[tuple[FilmForce, ...]] | None
) -> ForceBalance[tuple[FilmForce, ...]]:
    """What rotor and films put on the journals; before: at a place near by, from whose fields films on cells are
    sought.

    The derivative by the speed of a film is that of the motion of its gap, as if its journal moved across: a law that
    follows the speed itself makes Newton's method a little slower, and the position no other one.
    """
    surplus = held.load - held.stiffness @ position.ravel()
    slope = -held.stiffness.copy()
    places = _places(system, held, position)
    omegas = system.omegas(omega, ring_speeds(system, held, omega, position))
    following = _following_omegas(system, held, omega, places)
    on_films, by_places = surplus, slope
    if held.journals is not None:
        on_films, by_places = np.zeros(places.size), np.zeros((places.size, places.size))
    forces = []
    for i, many in enumerate(system.rotor.multiplicity):
        near = before.films[i] if before else None
        place = places[i]
        force = system.force(i, place, np.zeros_like(place), float(omegas[i]), near)
        own = slice(len(place) * i, len(place) * (i + 1))
        on_films[own] += many * force.force
        by_places[own, own] += many * force.by_displacement
        by_omega = 0.5 * force.by_velocity @ _across(place)
        by_places[own] += many * np.outer(by_omega, following[i])
        forces.append(force)
    if held.journals is not None:
        surplus += held.journals.T @ on_films
        slope += held.journals.T @ by_places @ held.journals
    return ForceBalance(surplus, slope, tuple(forces))


def _places(system: System, held: HeldRotor, position: Array) -> Array:
    """(films, c) coordinates of the journals in their shells; position: the unknowns of the rotor."""
    found = held.places(position, len(system.names))
    return found if held.journals is None else found + system.films.standing


def _ends(system: System, held: HeldRotor, position: Array) -> Array:
    """See Films.ends; position: the unknowns of the rotor."""
    return system.films.ends(_places(system, held, position))


def _across(place: Array) -> Array:
    """(c,) how a gap that turns backwards with 1 rad/s moves, of a journal at `place` (c,)."""
    return np.column_stack([place[1::2], -place[::2]]).ravel()


def _following_omegas(system: System, held: HeldRotor, omega: float, position: Array) -> Array:
    """(films, c films) derivatives of the films' speeds by the places of the journals, in rad/s over m."""
    found = np.zeros((len(position), position.size))
    for column in range(position.size if system.ring_count else 0):
        step = np.zeros(position.size)
        step[column] = NUDGE * system.clearances[column // 2]
        ahead, behind = (
            system.omegas(omega, ring_speeds(system, held, omega, position + side * step.reshape(-1, 2)))
            for side in (1.0, -1.0)
        )
        found[:, column] = (ahead - behind) / (2.0 * step[column])
    return found
