"""The static equilibrium of a rotor at a given speed: K q = f_static + sum over films of m P^T F(P q, 0, omega).

The rotor is linear, and the films see its journals only. So it is condensed first to the force that it exerts on its
films with the journals held at given places; Newton's method then runs on the two coordinates of each journal. Floating
rings turn with the speeds at which the torques on them balance (ring_speed.py), which follow from the places of the
journals: they are no unknowns of their own. Films that see tilts have the rotor in all its degrees of freedom, and its
load does not determine the force of each; there the speeds of the rings are unknowns instead of their angles. """

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.equilibrium.newton import ForceBalance, Search, search_rest
from frbcli.equilibrium.ring_speed import (
    NUDGE,
    SUM,
    balanced_speeds,
    by_total,
    drags,
    pin_angles,
    ring_speeds,
    ring_torques,
)
from frbcli.errors import NotConverged
from frbcli.film.contact_gap import ELASTIC_LIMIT
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.roughness.elastic_shell import ElasticShell
from frbcli.rotor.assembly import HeldRotor, held_rotor, whole_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.port import pushed, settled
from frbcli.scene.machine.system import System

SEARCH = Search(step=1e-10, force=0.0, share=1e-8, gap=1.0 - LARGEST_ECCENTRICITY)
STILL = 1e-6  # N: round-off of the films of a rotor without weight
ARM = 100.0  # clearances: torques on rings over it count next to forces, and not too much before the speeds are near
OUTER_START = 0.9  # eccentricity of the last start that is tried


@dataclass(frozen=True)
class RestingPosition:
    """A machine at rest. displacements: (n,) in m, rings at their angle 0, or against their pin; journals: (films, c)
    in m, with the tilts in rad that films see; ring_speeds: (rings,) rad/s at which the torques on the rings balance,
    0 of those against a pin; films: the films there, () where nothing turns and nothing has to be carried;
    lacking: what their slopes were seen to lack, see SearchEnd, None where nothing was sought."""

    displacements: Array
    journals: Array
    ring_speeds: Array
    films: tuple[FilmForce, ...]
    lacking: Array | None = None

    def velocities(self, system: System) -> Array:
        """(n,) velocities of all degrees of freedom: the rings turn."""
        speeds = np.zeros_like(self.displacements)
        speeds[list(system.spins)] = self.ring_speeds
        return speeds


def resting_position(
    system: System,
    omega: float,
    start: Array | None = None,
    search: Search = SEARCH,
    held: HeldRotor | None = None,
    neighbour: RestingPosition | None = None,
) -> RestingPosition:
    """Where the machine rests at omega rad/s, sought from the displacements `start` (n,), if journals are within their
    gaps there, then from the centre. held: the rotor with its journals held in their planes, if it is at hand;
    neighbour: a position near the start; its film fields and the corrections of their slopes start the search.

    Raises NotConverged if no start leads to one.
    """
    if system.rotor.ports:
        return _at_ports(system, omega, start, search, neighbour)
    held, clearances = held or held_in_plane(system, omega), np.array(system.clearances)[:, None]
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
        starts = [_with_rings(system, held, omega, each) for each in starts]
    films, lacking = ((), None) if neighbour is None else (neighbour.films, neighbour.lacking)
    balance = partial(_balance, system, held, omega, films)
    if held.journals is not None:
        balance = partial(_whole_balance, system, held, held.journals, omega, films)
    tries = [(each, 1.0) for each in starts]
    if system.shell is not None:
        pressed = _on_shells(system, system.shell, _still(system, omega), starts, loads)
        tries += [(each, ELASTIC_LIMIT) for each in pressed]
    if start is not None:
        near = system.rotor.journals @ start if held.journals is None else _with_rings(system, held, omega, start)
        reach = 1.0 if system.shell is None or _outmost(system, held, 1.0, near) < 1.0 else ELASTIC_LIMIT
        if _outmost(system, held, reach, near) < LARGEST_ECCENTRICITY:
            tries.insert(0, (near, reach))
    left = np.inf
    for first, reach in (each for each in tries if _outmost(system, held, each[1], each[0]) < 1.0):
        end = search_rest(balance, first, partial(_ends, system, held, reach), search, lacking)
        if end.settled and _outmost(system, held, reach, end.position) < LARGEST_ECCENTRICITY:
            displacements = held.shape + held.following @ end.position.ravel()
            return replace(_position(system, held, omega, displacements, end.balance.films), lacking=end.lacking)
        left = min(left, end.balance.left)
    if not loads.any() and left < STILL:  # films that do not turn hold nothing, and have nothing to hold
        return _position(system, held, omega, held.shape, ())
    raise NotConverged(
        f"No static equilibrium at {omega / (2 * np.pi):.4g} Hz below an eccentricity of {LARGEST_ECCENTRICITY}: "
        f"{len(tries)} starts, residual {left:.3g} N of {np.linalg.norm(loads):.3g} N. {_remedy(system, omega)}"
    )


def _at_ports(
    system: System, omega: float, start: Array | None, search: Search, neighbour: RestingPosition | None
) -> RestingPosition:
    """resting_position of a machine with ports, from the given start, the centre, and where the static load pushes each
    port over its length: a stop that nothing touches holds nothing."""

    def rest(flat: LinearRotor, q: Array) -> tuple[Array, RestingPosition]:
        position = resting_position(replace(system, rotor=flat), omega, q, search, None, neighbour)
        return position.displacements, position

    starts = [] if start is None else [start]
    starts += [np.zeros(system.rotor.size), pushed(system.rotor)]
    return settled(system.rotor, omega, starts, rest, search.step)


def _remedy(system: System, omega: float) -> str:
    usual = "Ask for a higher speed, or give the bearing more viscosity, more width or less clearance."
    if system.shell is None and _still(system, omega).any():
        return f"{usual} A film between surfaces that do not turn carries nothing: a spring or an elastic shell does."
    return usual


def held_in_plane(system: System, omega: float) -> HeldRotor:
    """The rotor at omega rad/s as the journals see it in their planes, whatever the films. Raises NotConverged."""
    return held_rotor(replace(system.rotor, journals=system.rotor.journals[:, :2]), omega)


def _position(
    system: System, held: HeldRotor, omega: float, displacements: Array, films: tuple[FilmForce, ...]
) -> RestingPosition:
    speeds: Array | None = None
    if held.journals is not None:
        if not films:
            displacements = _with_rings(system, held, omega, displacements)
        displacements, speeds = _parted(system, omega, displacements)
    journals = system.rotor.journals @ displacements + system.films.standing
    speeds = ring_speeds(system, held, omega, journals, films) if speeds is None else speeds
    if system.pinned.any():
        displacements = displacements.copy()
        displacements[list(system.spins)] = pin_angles(system, omega, journals, films)
    return RestingPosition(displacements, journals, speeds, films)


def _ring_unit(system: System, omega: float) -> float:
    """Speed of a ring in rad/s per unknown of 1 m: the speed of the rotor over a film's clearance."""
    return max(abs(omega), 1.0) / system.clearances[0]


def _parted(system: System, omega: float, unknowns: Array) -> tuple[Array, Array]:
    """(n,) displacements and (rings,) speeds in rad/s out of the unknowns of a whole rotor."""
    spins, displacements = list(system.spins), unknowns.copy()
    displacements[spins] = 0.0
    return displacements, unknowns[spins] * _ring_unit(system, omega)


def _with_rings(system: System, held: HeldRotor, omega: float, displacements: Array) -> Array:
    """(n,) unknowns of a whole rotor at displacements (n,), with its rings at the speeds given by the drag of their
    films."""
    drag, unknowns = drags(system, _places(system, held, displacements)), displacements.copy()
    for ring, spin in enumerate(system.spins):
        outer, inner = (system.bodies == ring).T
        free = 0.0 if system.pinned[ring] else omega
        unknowns[spin] = free * drag[inner].sum() / drag[inner | outer].sum() / _ring_unit(system, omega)
    return unknowns


def _forces(
    system: System, omega: float, speeds: Array, places: Array, near: tuple[FilmForce, ...]
) -> tuple[FilmForce, ...]:
    """The films with journals at rest at places (films, c) and rings at speeds (rings,) in rad/s; near: those near by,
    from whose fields finite-volume films are sought, if there are any."""
    omegas, slips = (each.tolist() for each in (system.omegas(omega, speeds), system.slips(omega, speeds)))
    return tuple(
        system.force(i, place, np.zeros_like(place), omegas[i], near[i] if near else None, slips[i])
        for i, place in enumerate(places)
    )


def _balance(
    system: System, held: HeldRotor, omega: float, near: tuple[FilmForce, ...], position: Array,
    before: ForceBalance[tuple[FilmForce, ...]] | None,
) -> ForceBalance[tuple[FilmForce, ...]]:  # fmt: skip
    """What rotor and films put on the journals; near: films near the first position, see _forces."""
    surplus = held.load - held.stiffness @ position.ravel()
    slope = -held.stiffness.copy()
    near = _foreseen(before.films if before else near, position)
    speeds = ring_speeds(system, held, omega, position, near)
    films = _forces(system, omega, speeds, position, near)
    changed, following = _following(system, held, omega, position, films, speeds)
    for i, (many, force) in enumerate(zip(system.rotor.multiplicity, films, strict=True)):
        own = slice(2 * i, 2 * i + 2)
        surplus[own] += many * force.force
        slope[own, own] += many * force.by_displacement
        if system.ring_count:
            spun = many * _by_total(force, position[i])
            surplus[own] += changed[i] * spun
            slope[own] += np.outer(spun, following[i])
    if system.rough_rings:
        slope += _by_rubbed_rings(system, held, omega, position, near, following)
    return ForceBalance(surplus, slope, films)


def _by_rubbed_rings(
    system: System, held: HeldRotor, omega: float, position: Array, near: tuple[FilmForce, ...], following: Array
) -> Array:
    """(2 films, 2 films) what the speeds of rings that follow the places of the journals change of the forces of the
    summits, less that as of a film. following: see _following."""
    by_rings, many, still = np.zeros((position.size,) * 2), np.repeat(system.rotor.multiplicity, 2), np.zeros(2)

    def summits(speeds: Array) -> list[FilmForce]:
        totals, slips = system.omegas(omega, speeds), system.slips(omega, speeds)
        return [
            system.rubbing(i).force(place, still, slip, 0.5 * (total - slip))
            for i, (place, total, slip) in enumerate(zip(position, totals.tolist(), slips.tolist(), strict=True))
        ]

    for i, own in enumerate(summits(ring_speeds(system, held, omega, position, near))):
        by_rings[2 * i : 2 * i + 2] -= np.outer(by_total(own, position[i]), following[i])
    for column in range(position.size):
        step = np.zeros(position.size)
        step[column] = NUDGE * system.clearances[column // 2]
        ahead, behind = (
            np.concatenate([own.force for own in summits(ring_speeds(system, held, omega, position + moved, near))])
            for moved in (step.reshape(-1, 2), -step.reshape(-1, 2))
        )
        by_rings[:, column] += (ahead - behind) / (2.0 * step[column])
    return many[:, None] * by_rings


def _whole_balance(
    system: System, held: HeldRotor, journals: Array, omega: float, near: tuple[FilmForce, ...], unknowns: Array,
    before: ForceBalance[tuple[FilmForce, ...]] | None,
) -> ForceBalance[tuple[FilmForce, ...]]:  # fmt: skip
    """What acts on a whole rotor, and the torques on its rings over an arm; near: see _balance."""
    spins, unit = list(system.spins), _ring_unit(system, omega)
    displacements, speeds = _parted(system, omega, unknowns)
    places = _places(system, held, displacements)
    films = _forces(system, omega, speeds, places, before.films if before else near)
    surplus, slope = held.load - held.stiffness @ displacements, -held.stiffness.copy()
    for i, (many, force) in enumerate(zip(system.rotor.multiplicity, films, strict=True)):
        own = many * system.rotor.journals[i].T
        surplus += own @ force.force
        slope += own @ force.by_displacement @ system.rotor.journals[i]
        slope[:, spins] += unit * np.outer(own @ _by_total(force, places[i]), system.turning[i, SUM, 1:])
    if spins:
        torques, by_speeds, by_places = ring_torques(system, np.append(omega, speeds), places, films)
        arm = ARM * system.clearances[0]
        slope[spins], surplus[spins] = by_places @ journals / arm, torques / arm
        slope[np.ix_(spins, spins)] = by_speeds * unit / arm
        stopped = np.array(spins)[system.pinned]
        surplus[stopped], slope[stopped] = -unknowns[stopped], 0.0
        slope[stopped, stopped] = -1.0
    return ForceBalance(surplus, slope, films)


def _places(system: System, held: HeldRotor, position: Array) -> Array:
    """(films, c) coordinates of the journals in their shells; position: the unknowns of the rotor."""
    coordinates = held.places(position, len(system.names))
    return coordinates if held.journals is None else coordinates + system.films.standing


def _ends(system: System, held: HeldRotor, reach: float, position: Array) -> Array:
    """See Films.ends, over the reach, 1 or an elastic shell's; position: the unknowns of the rotor."""
    return np.asarray(system.films.ends(_places(system, held, position)) / reach)


def _outmost(system: System, held: HeldRotor, reach: float, position: Array) -> float:
    """The largest eccentricity over the reach; position: the unknowns of the rotor."""
    return float(np.linalg.norm(_ends(system, held, reach, position), axis=1).max())


def _still(system: System, omega: float) -> NDArray[np.bool_]:
    """(films,) which films lie between surfaces that do not turn."""
    return np.asarray(system.omegas(omega, np.where(system.pinned, 0.0, omega)) == 0.0)


def _on_shells(
    system: System, shell: ElasticShell, still: NDArray[np.bool_], starts: list[Array], loads: Array
) -> list[Array]:
    """The starts with the journals of films that do not turn, and so carry nothing, pressed into their elastic shells;
    loads: (films, 2) N that the rotor puts on its films. None where all films turn."""
    starts_ = []
    for start in starts if still.any() else ():
        pressed = start.copy()
        for i in np.flatnonzero(still):
            carried = loads[i] / system.rotor.multiplicity[i]
            size = max(float(np.hypot(*carried)), np.finfo(float).tiny)
            pressed[i] = shell.pressed(size, system.clearances[i]) * carried / size
        starts_.append(pressed)
    return starts_


def _foreseen(films: tuple[FilmForce, ...], position: Array) -> tuple[FilmForce, ...]:
    """The films as they are to first order with their journals at other places (films, c)."""
    return tuple(film.foreseen(place) for film, place in zip(films, position, strict=False))


def _by_total(force: FilmForce, place: Array) -> Array:
    """(c,) derivative of a film's force by omega_J + omega_S, its oil following where it is known how."""
    return by_total(force, place) if force.slopes is None else force.slopes.force


def _following(
    system: System, held: HeldRotor, omega: float, position: Array, films: tuple[FilmForce, ...], speeds: Array
) -> tuple[Array, Array]:
    """How far the speeds of the films are from those at which the torques on the rings balance, (films,) in rad/s, the
    rings turning with speeds (rings,) while the films were solved, and the derivatives of these by the places of the
    journals (films, c films) in rad/s over m.

    Less oil in a film lets its ring turn otherwise, whose speed changes the oil: both to first order, as the films
    foresee their oil."""
    count, rings = len(position), system.ring_count
    if not rings:
        return np.zeros(count), np.zeros((count, position.size))
    at, drag = partial(balanced_speeds, system, held, omega), drags(system, position, films)
    steps = (NUDGE * np.repeat(system.clearances, 2))[:, None]
    moved, pulled = (steps * np.eye(position.size)).reshape(-1, count, 2), NUDGE * np.diag(drag)
    by_place = (at(position + moved, drag) - at(position - moved, drag)).T / (2.0 * steps.T)
    by_drag = (at(position, drag + pulled) - at(position, drag - pulled)).T / (2.0 * NUDGE * drag)
    along, by_total = _drag_slopes(system, omega, position, films)
    by_place += (by_drag[:, :, None] * along).reshape(rings, -1)
    off = at(position, drag) - speeds
    by_rings = system.turning[:, SUM, 1:]
    by_speeds = (by_drag * by_total) @ by_rings
    solution = np.linalg.solve(np.eye(rings) - by_speeds, np.column_stack([off, by_place]))
    return by_rings @ solution[:, 0], by_rings @ solution[:, 1:]


def _drag_slopes(
    system: System, omega: float, position: Array, films: tuple[FilmForce, ...]
) -> tuple[Array, Array]:
    """Derivatives of the drags (films,) by the coordinates of each film's journal (films, 2), and by its omega_J +
    omega_S (films,), as the films foresee their oil."""

    def moved(step: Array, faster: float) -> Array:
        oil = films if not follows else tuple(
            film if film.slopes is None else film.foreseen(place, film.slopes.total + faster)
            for film, place in zip(films, position + step, strict=True)
        )  # fmt: skip
        return drags(system, position + step, oil)

    follows = any(system.remembering)

    by_place, clearances = np.zeros_like(position), np.array(system.clearances)
    for column, unit in enumerate(np.eye(2)):
        step = NUDGE * np.outer(clearances, unit)
        by_place[:, column] = (moved(step, 0.0) - moved(-step, 0.0)) / (2.0 * NUDGE * clearances)
    if not follows:
        return by_place, np.zeros(len(films))
    still, faster = np.zeros_like(position), NUDGE * max(abs(omega), 1.0)
    return by_place, (moved(still, faster) - moved(still, -faster)) / (2.0 * faster)
