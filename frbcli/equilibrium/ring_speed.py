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
from frbcli.film.roughness.rubbing import BY_SLIP, BY_V_X, BY_X, F_X, F_Y, ON_JOURNAL, VALUE
from frbcli.rotor.assembly import HeldRotor
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.system import System, film_drag

NUDGE = 1e-6  # of the clearance: of the differences by which the drag follows a journal
CLOSE, ROUND_OFF = 1e-13, 1e-14  # of the rotor's speed and of a ring's, to which the speed of a ring is found
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


def ring_speeds(
    system: System, held: HeldRotor, omega: float, position: Array, films: Sequence[FilmForce] = ()
) -> Array:
    """(rings,) speeds in rad/s at which the torques on the rings balance, their journals in `position` (films, 2) in m,
    where the rotor's load determines the forces of the films; 0 of rings with a pin, which takes what is left over.
    films: see drags."""
    if not system.ring_count:
        return np.zeros(0)
    return balanced_speeds(system, held, omega, position, drags(system, position, films))


def balanced_speeds(system: System, held: HeldRotor, omega: float, position: Array, drag: Array) -> Array:
    """(..., rings) ring_speeds with the journals in `position` (..., films, 2) and the drags (..., films) of films."""
    drag = np.broadcast_to(drag, np.broadcast_shapes(drag.shape, position.shape[:-1]))
    position = np.broadcast_to(position, (*drag.shape, 2))
    outer, inner = (system.bodies[:, side, None] == np.arange(system.ring_count) for side in (0, 1))
    carried = (held.load - position.reshape(*drag.shape[:-1], -1) @ held.stiffness.T).reshape(position.shape)
    moment = 0.5 * (position[..., 0] * carried[..., 1] - position[..., 1] * carried[..., 0])
    moment = moment / system.rotor.multiplicity
    touched = outer | inner  # of a cartridge at both ends
    driving = omega * drag @ inner + (moment @ touched if system.torque == "all" else 0.0)
    held_by = drag @ touched
    speeds = np.where(system.pinned, 0.0, driving / held_by)
    for at in np.ndindex(speeds.shape[:-1]) if system.rough_rings else ():
        for ring in np.flatnonzero(~system.pinned):
            speeds[at][ring] = _rubbed(system, int(ring), omega, position[at], speeds[at], float(held_by[at][ring]))
    return speeds


def _rubbed(system: System, ring: int, omega: float, position: Array, speeds: Array, drag: float) -> float:
    """The speed of a ring that its films alone would turn with speeds[ring], under films and summits together. drag:
    decrease of the film torque per speed, N m s. The friction torque falls with the speed, too, so that there is one
    root only."""
    from scipy.optimize import brentq  # takes long to load

    free = float(speeds[ring])

    def surplus(speed: float) -> float:
        """In rad/s."""
        bodies = speeds.copy()
        bodies[ring] = speed
        return summit_torque(system, ring, omega, position, bodies) / drag - (speed - free)

    end = free + 2.0 * surplus(free)
    close = CLOSE * (abs(omega) or abs(end - free))  # the rotor may stand still
    return free if end == free else float(brentq(surplus, *sorted((free, end)), xtol=close, rtol=ROUND_OFF))


def summit_torque(system: System, ring: int, omega: float, places: Array, speeds: Array) -> float:
    """Torque in N m on a ring by the friction of rough surfaces, at speeds (rings,) in rad/s. What the rotor puts on a
    film is carried by the summits in part, whose force has no share in the moment of the film."""
    torque, totals, slips = 0.0, system.omegas(omega, speeds), system.slips(omega, speeds)
    for i in np.flatnonzero((system.bodies == ring).any(axis=1)):
        shell = 0.5 * float(totals[i] - slips[i])
        on_journal, on_shell, moment = system.rubbing(int(i)).pulled(places[i], float(slips[i]), shell)
        torque += on_journal if system.bodies[i, 0] == ring else on_shell
        torque += 0.5 * moment if system.torque == "all" else 0.0
    return torque


def across(place: Array) -> Array:
    """(c,) how a gap that turns backwards with 1 rad/s moves, of a journal at `place` (c,). The moment of a force (c,)
    about the middle of the shell is place @ across(force)."""
    return np.column_stack([place[1::2], -place[::2]]).ravel()


def by_total(force: FilmForce, place: Array) -> Array:
    """(c,) derivative of a film's force by omega_J + omega_S, from the motion of its gap, as if its journal moved
    across. With a law that follows the speed itself Newton's method is a little slower, with the same result."""
    return np.asarray(0.5 * force.by_velocity @ across(place))


def _drag_slopes(system: System, places: Array, films: Sequence[FilmForce]) -> Array:
    """(films, c) derivatives of the drags by the coordinates of the journals, the oil remaining as it is."""
    slopes = np.zeros_like(places)
    for k, unit in enumerate(np.eye(places.shape[1])):
        ahead = np.tile(unit, (len(places), 1))
        reach = np.abs(system.films.ends(ahead)).reshape(len(places), -1).max(axis=1)
        step = NUDGE / reach[:, None] * ahead
        slopes[:, k] = (drags(system, places + step, films) - drags(system, places - step, films)) / (2.0 * step[:, k])
    return slopes


def ring_torques(
    system: System, bodies: Array, places: Array, films: tuple[FilmForce, ...]
) -> tuple[Array, Array, Array]:
    """(rings,) torques on the rings in N m, with films at places (films, c), and their derivatives by the speeds of the
    rings (rings, rings) and by the places (rings, c films). bodies: (1 + rings,) speeds of the rotor and the rings in
    rad/s."""
    rings = np.arange(system.ring_count)
    around, inside = (system.bodies[:, side, None] == rings for side in (1, 0))
    pulled, touched = around.astype(float) - inside, (around | inside).astype(float)
    drag, slips = drags(system, places, films), system.turning[:, SLIP]
    torque = pulled.T @ (drag * (slips @ bodies))
    by_speeds = (pulled.T * drag) @ slips[:, 1:]
    slopes, c = _drag_slopes(system, places, films) * (slips @ bodies)[:, None], places.shape[1]
    by_places = np.asarray(np.repeat(pulled.T, c, axis=1) * slopes.ravel())
    for i, (place, film) in enumerate(zip(places, films, strict=True) if system.torque == "all" else ()):
        turned, pull = across(place), across(film.force)
        torque -= 0.5 * touched[i] * (place @ pull)
        by_places[:, c * i : c * (i + 1)] -= 0.5 * np.outer(touched[i], pull - film.by_displacement.T @ turned)
        by_speeds += 0.5 * np.outer(touched[i], (turned @ by_total(film, place)) * system.turning[i, SUM, 1:])
    return torque, by_speeds, by_places


def pin_angles(system: System, omega: float, places: Array, films: tuple[FilmForce, ...]) -> Array:
    """(rings,) angles in rad at which pins hold their rings, 0 of other rings, with films at places (films, c) and the
    rotor at omega rad/s; films: () where they put no force on their journals."""
    angles = np.zeros(system.ring_count)
    if system.pinned.any():
        bodies = np.append(omega, np.zeros(system.ring_count))
        torques, _, _ = ring_torques(system, bodies, places, films or (none_of(places.shape[1]),) * len(places))
        for ring in np.flatnonzero(system.pinned):
            rubbed = summit_torque(system, int(ring), omega, places, bodies[1:]) if system.rough_rings else 0.0
            angles[ring] = pin_angle(system.pins[ring], float(torques[ring]) + rubbed)
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
    """How the summits between rough surfaces follow a machine about its rest. summits: their forces; torques,
    torques_by_rate: (rings, c films) on the rings, derivatives by the places of the journals and by their velocities;
    torques_by_speed: (rings, rings) by the speeds of the rings; forces_by_speed: (films, c, rings) of the forces."""

    summits: tuple[FilmForce, ...]
    torques: Array
    torques_by_rate: Array
    torques_by_speed: Array
    forces_by_speed: Array


def rubbed_rings(system: System, bodies: Array, places: Array) -> RubbedRings:
    """Of a machine at rest at places (films, c); bodies: see ring_torques."""
    rings, (count, c) = system.ring_count, places.shape
    torques, by_rate, by_speed = np.zeros((rings, count * c)), np.zeros((rings, count * c)), np.zeros((rings, rings))
    forces, alone = np.zeros((count, c, rings)), []
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
                torques[ring, own] += torque[BY_X:BY_V_X]
                by_rate[ring, own] += torque[BY_V_X:BY_SLIP]
                by_speed[ring] += torque[BY_SLIP:] @ shares[:, 1:]
    return RubbedRings(tuple(alone), torques, by_rate, by_speed, forces)
