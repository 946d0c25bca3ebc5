"""How fast a floating ring turns, by the torques (4.17) on it, with everything at rest.

Between rough surfaces the friction of the summits pulls, too: a ring may stick to its rotor, or to its shell. How fast
it turns then follows small motions, as it does of a ring with a pin: both are part of the linearised machine.

A ring with a pin does not turn: the torques hold it at the angle at which the spring of the pin balances them.

Couette's terms pull towards the rotor and towards the housing, Poiseuille's is half the moment of the film's force.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.elements.pin import pin_angle
from frbcli.film.rectangles.film import FilmForce, none_of
from frbcli.film.roughness.contact import BY_SLIP, BY_V_X, BY_X, F_X, F_Y, ON_JOURNAL, VALUE
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.system import System, film_drag

NUDGE = 1e-6  # of the clearance: of the differences by which the drag follows a journal
SUM, SLIP = range(2)  # of the speeds of journal and shell in System.turning


def concentric_ratios(case: Case) -> dict[str, float]:
    """omega_F / omega_R of each ring, by its bearing's name, where everything is concentric and the films are full:
    the torques of (4.6) balance, k_i (omega_R - omega_F) = k_o omega_F with k = eta R^3 B / C, of a cartridge the sum
    of both ends."""
    ratios: dict[str, float] = {}
    for around in turning_rings(case):
        inner = sum(film_drag(case, bearing.inner) for bearing in around)
        outer = sum(film_drag(case, bearing.outer) for bearing in around)
        ratios |= {bearing.name: inner / (inner + outer) for bearing in around}
    return ratios


def drags(system: System, places: Array, films: Sequence[FilmForce] = ()) -> Array:
    """(films,) Couette's torque per slip in N m s, with the journals at places (films, coordinates); films: as they are
    solved, without them full of oil."""
    sheared = system.films.sheared * np.array(system.drags)
    if films:
        sheared = sheared * system.films.sheared_oil(places, films)
    if system.shell is not None:
        places = np.array([system.felt(i, place) for i, place in enumerate(places)])
    return np.asarray(sheared * 2.0 * np.pi / system.films.harmonic_gaps(places))


def dragged_speeds(system: System, omega: float, places: Array) -> Array:
    """(rings,) speeds in rad/s at which Couette's torques on the rings balance, with full films and journals at places
    (films, coordinates); 0 of rings with a pin, which takes what is left over."""
    drag, rings = drags(system, places), np.arange(system.ring_count)
    outer, inner = (system.bodies[:, side, None] == rings for side in (0, 1))
    return np.asarray(np.where(system.pinned, 0.0, omega) * (drag @ inner) / (drag @ (inner | outer)))


def across(place: Array) -> Array:
    """(c,) how a gap that turns backwards with 1 rad/s moves, of a journal at `place` (c,). The moment of a force (c,)
    about the middle of the shell is place @ across(force)."""
    return np.column_stack([place[1::2], -place[::2]]).ravel()


def by_total(force: FilmForce, place: Array) -> Array:
    """(c,) derivative of a film's force by omega_J + omega_S, from the motion of its gap, as if its journal moved
    across. With a law that follows the speed itself Newton's method is a little slower, with the same result."""
    return np.asarray(0.5 * force.by_velocity @ across(place))


def following(force: FilmForce, place: Array) -> Array:
    """(c,) derivative of a film's force by omega_J + omega_S, its oil following where it is known how."""
    return by_total(force, place) if force.slopes is None else force.slopes.force


def _drag_slopes(system: System, places: Array, films: Sequence[FilmForce]) -> tuple[Array, Array]:
    """Derivatives of the drags by the coordinates of the journals (films, c), and by omega_J + omega_S of each film
    (films,), the oil following where it is known how."""

    follows = any(system.remembering)  # other films are full

    def change(step: Array, faster: float = 0.0) -> Array:
        return moved(step, faster) - moved(-step, -faster)

    def moved(step: Array, faster: float) -> Array:
        oil = films if not follows else [
            film if film.slopes is None else film.foreseen(place, film.slopes.total + faster)
            for film, place in zip(films, places + step, strict=True)
        ]  # fmt: skip
        return drags(system, places + step, oil)

    slopes = np.zeros_like(places)
    for k, unit in enumerate(np.eye(places.shape[1])):
        ahead = np.tile(unit, (len(places), 1))
        reach = np.abs(system.films.ends(ahead)).reshape(len(places), -1).max(axis=1)
        step = NUDGE / reach[:, None] * ahead
        slopes[:, k] = change(step) / (2.0 * step[:, k])
    if not follows:
        return slopes, np.zeros(len(films))
    faster = NUDGE * max([1.0, *(abs(film.slopes.total) for film in films if film.slopes)])
    return slopes, change(np.zeros_like(places), faster) / (2.0 * faster)


def ring_torques(
    system: System, bodies: Array, places: Array, films: tuple[FilmForce, ...]
) -> tuple[Array, Array, Array]:
    """(rings,) torques on the rings in N m, with films at places (films, c), and their derivatives by the speeds of the
    rings (rings, rings) and by the places (rings, c films), the oil following where it is known how. bodies:
    (1 + rings,) speeds of the rotor and the rings in rad/s."""
    rings = np.arange(system.ring_count)
    around, inside = (system.bodies[:, side, None] == rings for side in (1, 0))
    pulled, touched = around.astype(float) - inside, (around | inside).astype(float)
    drag, slips, turned = drags(system, places, films), system.turning[:, SLIP], system.turning[:, SUM, 1:]
    torque = pulled.T @ (drag * (slips @ bodies))
    by_place, by_turning = _drag_slopes(system, places, films)
    by_speeds = (pulled.T * drag) @ slips[:, 1:] + (pulled.T * (by_turning * (slips @ bodies))) @ turned
    slopes, c = by_place * (slips @ bodies)[:, None], places.shape[1]
    by_places = np.asarray(np.repeat(pulled.T, c, axis=1) * slopes.ravel())
    for i, (place, film) in enumerate(zip(places, films, strict=True) if system.torque == "all" else ()):
        turning, pull = across(place), across(film.force)
        torque -= 0.5 * touched[i] * (place @ pull)
        by_places[:, c * i : c * (i + 1)] -= 0.5 * np.outer(touched[i], pull - film.by_displacement.T @ turning)
        by_speeds += 0.5 * np.outer(touched[i], (turning @ following(film, place)) * turned[i])
    return torque, by_speeds, by_places


@dataclass(frozen=True)
class RingBalance:
    """What acts on the rings of a machine at rest. torques: (rings,) N m; torques_by_speed (rings, rings) and
    torques_by_place (rings, c films): their derivatives by the speeds of the rings and the places of the journals;
    forces_by_speed: (films, c, rings) of the forces of the films."""

    torques: Array
    torques_by_speed: Array
    torques_by_place: Array
    forces_by_speed: Array


def ring_balance(system: System, bodies: Array, places: Array, films: tuple[FilmForce, ...]) -> RingBalance:
    """Of films with their summits; bodies, places: see ring_torques."""
    rubbed = rubbed_rings(system, bodies, places)
    alone = tuple(film.plus(summits, -1.0) for film, summits in zip(films, rubbed.summits, strict=True))
    torques, by_speed, by_place = ring_torques(system, bodies, places, alone)
    along = np.array([following(film, place) for film, place in zip(alone, places, strict=True)])
    forces = along[:, :, None] * system.turning[:, None, SUM, 1:] + rubbed.forces_by_speed
    return RingBalance(torques + rubbed.pulls, by_speed + rubbed.torques_by_speed, by_place + rubbed.torques, forces)


def pin_angles(system: System, omega: float, places: Array, films: tuple[FilmForce, ...]) -> Array:
    """(rings,) angles in rad at which pins hold their rings, 0 of other rings, with films at places (films, c) and the
    rotor at omega rad/s; films: () where they put no force on their journals."""
    angles = np.zeros(system.ring_count)
    if system.pinned.any():
        bodies = np.append(omega, np.zeros(system.ring_count))
        torques = ring_balance(system, bodies, places, films or (none_of(places.shape[1]),) * len(places)).torques
        for ring in np.flatnonzero(system.pinned):
            angles[ring] = pin_angle(system.pins[ring], float(torques[ring]))
    return angles


def memoryless(film: FilmForce, place: Array | None = None) -> tuple[Array, Array]:
    """Stiffness and damping (c, c) of a film without memory, or with its journal at `place` (c,) (c + 1, c + 1) as of a
    film next to rings, see LinearFilm.turning."""
    stiffness, damping = -film.by_displacement, -film.by_velocity
    if place is None:
        return stiffness, damping
    whole = np.zeros((2, len(place) + 1, len(place) + 1))
    whole[:, :-1, :-1] = stiffness, damping
    whole[1, :-1, -1] = -by_total(film, place)
    return whole[0], whole[1]


def turned_by(system: System, bodies: Array, places: Array) -> Array:
    """(films, rings, c + 1) torques on the rings by the forces of the films, half of their moments about the middle of
    the shell, and by the share of Couette's torque that missing oil leaves. bodies, places: see ring_torques."""
    rings = np.arange(system.ring_count)
    around, inside = (system.bodies[:, side, None] == rings for side in (1, 0))
    touched, pulled = (around | inside).astype(float), around.astype(float) - inside
    half = 0.5 * np.array([across(place) for place in places]) if system.torque == "all" else 0.0 * places
    couette = drags(system, places) * (system.turning[:, SLIP] @ bodies)
    return np.concatenate([touched[:, :, None] * half[:, None], (pulled * couette[:, None])[:, :, None]], axis=2)


@dataclass(frozen=True)
class RubbedRings:
    """How the summits between rough surfaces follow a machine about its rest. summits: their forces; pulls: (rings,)
    their torques on the rings, N m; torques, torques_by_rate: (rings, c films) derivatives of these by the places of
    the journals and by their velocities; torques_by_speed: (rings, rings) by the speeds of the rings; forces_by_speed:
    (films, c, rings) of the forces."""

    summits: tuple[FilmForce, ...]
    pulls: Array
    torques: Array
    torques_by_rate: Array
    torques_by_speed: Array
    forces_by_speed: Array


def rubbed_rings(system: System, bodies: Array, places: Array) -> RubbedRings:
    """Asperity forces and torques linearised about rest at places (films, c); bodies: see ring_torques."""
    rings, (count, c) = system.ring_count, places.shape
    torques, by_rate, by_speed = np.zeros((rings, count * c)), np.zeros((rings, count * c)), np.zeros((rings, rings))
    forces, pulls, alone = np.zeros((count, c, rings)), np.zeros(rings), []
    for i, place in enumerate(places):
        total, slip = system.turning[i, SUM], system.turning[i, SLIP]
        shares = np.array([slip, 0.5 * (total - slip)])  # of rotor and rings in slip and speed of the shell
        motion = np.concatenate([place[:2], np.zeros(2), shares @ bodies])
        (by_motion,) = system.rubbing(i).slopes(motion[None])
        own, both = slice(c * i, c * i + 2), slice(F_X, F_Y + 1)
        forces[i, :2] = by_motion[both, BY_SLIP:] @ shares[:, 1:]
        summits = none_of(c)
        summits.force[:2] = by_motion[both, VALUE]
        summits.by_displacement[:2, :2] = by_motion[both, BY_X:BY_V_X]
        summits.by_velocity[:2, :2] = by_motion[both, BY_V_X:BY_SLIP]
        alone.append(summits)
        for side, ring in enumerate(system.bodies[i].tolist()):
            if ring >= 0:
                torque = by_motion[ON_JOURNAL + side]
                pulls[ring] += torque[VALUE]
                torques[ring, own] += torque[BY_X:BY_V_X]
                by_rate[ring, own] += torque[BY_V_X:BY_SLIP]
                by_speed[ring] += torque[BY_SLIP:] @ shares[:, 1:]
    return RubbedRings(tuple(alone), pulls, torques, by_rate, by_speed, forces)
