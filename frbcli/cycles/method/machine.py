"""A machine as limit cycles see it: a linear rotor behind its films, and what the films put on it.

The films see the rotor only through its journals and rings. Of all that a motion is made of, u = (d, s) is kept: the
displacements d of the journals over the clearance, two for each film, and the speeds s of the rings over a fixed speed.
For a harmonic u_k exp(i k nu t) and the loads g_k of the films,

    u_k = T_k (g_k + kappa_k u_k) + rest (k = 0),      T_k = P Z_k^-1 P^T m,
    Z_k = K - (k nu)^2 M + i k nu (D + Omega G) + P^T m kappa_k P,

is exact, however many degrees of freedom the rotor has. kappa is a spring and a dashpot parallel to each film, added on
both sides: without it a free rotor could not be solved for k = 0, nor near its free natural frequencies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.continuation import Unreachable
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.kinds.contract import BY_D, BY_OMEGA, BY_V, FORCE, at_viscosity, drag_factor, film_samples
from frbcli.film.rectangles.film_force import FilmData
from frbcli.film.roughness.asperities import Asperities
from frbcli.film.roughness.contact import BY_SLIP, BY_V_X, BY_X, F_X, F_Y, ON_JOURNAL, ON_SHELL, VALUE, rub_slopes
from frbcli.rotor.assembly import LinearRotor, without_spins
from frbcli.rotor.loads import Harmonic
from frbcli.scene.films import ROTOR
from frbcli.scene.machine.system import System

NEAR = 0.1  # eccentricity at which the dashpots parallel to the films are taken from these


class OutOfGap(Unreachable):
    """A motion leaves the gap of a film, where its force ends."""


@dataclass(frozen=True)
class Cone:
    """A cartridge, whose gyroscopic moments change with the speed of its ring along a motion: its films see how it
    tilts, so that forces on their journals do what the moments do. ring: its number; moments: (2 F, 2 F) N s^2 that
    these forces fall by, per rate of the displacements over the clearance and per speed of the ring in rad/s."""

    ring: int
    moments: Array


@dataclass(frozen=True)
class Machine:
    """F films, R rings that turn, c = 2 F + R coordinates u.

    rotor: without the angles of its rings; films, clearances (F,) m; pace: rad/s, by which the rings' speeds and the
    frequency are divided; spring, dashpot: (F,) N and N s per displacement over the clearance; turning: (F, 2, 1 + R)
    shares of the speeds of rotor and rings in omega_J + omega_S and omega_J - omega_S; bodies: see System; drags: (F,)
    N m s; moment: 1 if the moments of the film forces turn the rings, else 0; inertia: (R,) s, of the rings over the
    Couette torques per speed in concentric films, which are held: (R,) N m s; scales: (F,) viscosity of each film over
    that which it was made with; temperatures: (F,) K of the films, empty without heat; orders: how often in a
    revolution what drives the rotor swings, 1 of the unbalance, and then of the forces that change with its angle;
    asperities: of rough surfaces; cones: of cartridges, see Cone.
    """

    rotor: LinearRotor
    films: tuple[FilmData, ...]
    names: tuple[str, ...]
    clearances: Array
    pace: float
    spring: Array
    dashpot: Array
    turning: Array
    bodies: NDArray[np.int64]
    drags: Array
    moment: float
    inertia: Array
    held: Array
    scales: Array
    temperatures: Array
    orders: tuple[int, ...]
    asperities: Asperities | None = None
    cones: tuple[Cone, ...] = ()

    @property
    def film_count(self) -> int:
        """F."""
        return len(self.films)

    @property
    def ring_count(self) -> int:
        """R."""
        return len(self.inertia)

    @property
    def size(self) -> int:
        """c."""
        return 2 * self.film_count + self.ring_count

    @cached_property
    def rest(self) -> Array:
        """(c,): u at rest without films but on kappa."""
        return _moved_by(self, self.rotor.static_load, 0, 0.0).real

    @cached_property
    def held_up(self) -> tuple[Array, Array]:
        """(n, n) damping and stiffness of the rotor on kappa."""
        dashpots, springs = (
            self.pulls @ (np.repeat(each, 2)[:, None] * self.places) for each in (self.dashpot, self.spring)
        )
        return self.rotor.damping + dashpots, self.rotor.stiffness + springs

    @property
    def places(self) -> Array:
        """(2 F, n): the displacements of the journals over the clearance."""
        return self.rotor.journals.reshape(-1, self.rotor.size) / np.repeat(self.clearances, 2)[:, None]

    @property
    def pulls(self) -> Array:
        """(n, 2 F): what the forces of the films put on the rotor."""
        return self.rotor.journals.reshape(-1, self.rotor.size).T * np.repeat(self.rotor.multiplicity, 2)


@dataclass(frozen=True)
class Loads:
    """What the films put on journals (N) and rings (N m over `held` and the pace) at n moments.

    values: (n, c); by_u, by_v: (n, c, c) derivatives by u and by its rate in 1/s (that by the rate of a ring's speed is
    zero); by_speed: (n, c) by the speed of the rotor in rad/s; drive: (n,) N m that turns the rotor against its films.
    """

    values: Array
    by_u: Array
    by_v: Array
    by_speed: Array
    drive: Array


@dataclass(frozen=True)
class Transfer:
    """T of harmonics at m frequencies: values (m, c, c), derivatives by their frequency and by Omega; kappa: (m, c),
    and its derivative by the frequency."""

    values: Complex
    by_frequency: Complex
    by_speed: Complex
    kappa: Complex
    kappa_by_frequency: Complex


def make_machine(system: System, top: float) -> Machine:
    """The machine of a system. top: largest speed of the rotor, rad/s."""
    films = smooth_films(system)
    drags = np.array(system.drags)
    held = np.zeros(system.ring_count)
    for ring in range(system.ring_count):
        held[ring] = 2.0 * math.pi * drags[np.any(system.bodies == ring, axis=1)].sum()
    inertia = system.rotor.mass[list(system.spins), list(system.spins)]
    at, still, speed = np.array([[NEAR, 0.0]]), np.zeros((1, 2)), np.array([top])
    damping = [-0.5 * np.sum(film_samples(film, at, still, speed)[0, [BY_V, BY_V + 3]]) for film in films]
    return Machine(
        rotor=without_spins(system.rotor, np.zeros(system.ring_count)),  # whose speed turns no ring that tilts
        films=films,
        names=system.names,
        clearances=np.array(system.clearances),
        pace=top,
        spring=0.5 * top * np.array(damping),
        dashpot=np.array(damping),
        turning=system.turning[:, :2],
        bodies=system.bodies,
        drags=drags,
        moment=1.0 if system.torque == "all" else 0.0,
        inertia=inertia / held,
        held=held,
        scales=np.ones(len(films)),
        temperatures=np.zeros(0),
        orders=(1, *(abs(round(load.order)) for load in turning_loads(system.rotor))),
        asperities=system.asperities,
        cones=_cones(system),
    )


def _cones(system: System) -> tuple[Cone, ...]:
    """Forces on the journals that do the work of the gyroscopic moments of cartridges, in shells that are fixed."""
    rotor, cones = system.rotor, []
    seen = rotor.journals.reshape(-1, rotor.size)
    for spin, cone in rotor.cones:
        x, y = np.linalg.lstsq(seen.T, cone.T, rcond=None)[0].T
        pulls = np.outer(x, y) - np.outer(y, x)
        moved, many = np.repeat(system.clearances, 2), np.repeat(rotor.multiplicity, 2)[:, None]
        cones.append(Cone(spin - system.spins[0], pulls * moved / many))
    return tuple(cones)


def turning_loads(rotor: LinearRotor) -> tuple[Harmonic, ...]:
    """The loads of a rotor that change with its angle alone."""
    return tuple(each for each in rotor.loads if isinstance(each, Harmonic) and each.frequency == 0.0)


def film_loads(machine: Machine, u: Array, v: Array, omega: float) -> Loads:
    """Loads of the films at n moments. u: (n, c); v: (n, c) its rate in 1/s; omega: speed of the rotor in rad/s.

    Raises OutOfGap where a journal leaves the gap.
    """
    n, c, films = len(u), machine.size, machine.film_count
    d = u[:, : 2 * films].reshape(n, films, 2)
    if not np.all(np.sum(d**2, axis=2) < LARGEST_ECCENTRICITY**2):
        raise OutOfGap
    speeds = np.column_stack([np.full(n, omega), machine.pace * u[:, 2 * films :]])
    values, by_u, by_v = np.zeros((n, c)), np.zeros((n, c, c)), np.zeros((n, c, c))
    by_speed, drive = np.zeros((n, c)), np.zeros(n)
    for f, film in enumerate(machine.films):
        own, scale = slice(2 * f, 2 * f + 2), float(machine.scales[f])
        shares = machine.turning[f, 0]
        rate = scale * np.ascontiguousarray(v[:, own])  # s times the viscosity has the force of s times the velocities
        thicker = at_viscosity(film, scale)
        samples = film_samples(thicker, np.ascontiguousarray(d[:, f]), rate, scale * (speeds @ shares))
        by_omega = scale * samples[:, BY_OMEGA:]
        values[:, own] = samples[:, FORCE:BY_D]
        by_u[:, own, own] = samples[:, BY_D:BY_V].reshape(n, 2, 2)
        by_v[:, own, own] = scale * samples[:, BY_V:BY_OMEGA].reshape(n, 2, 2)
        by_u[:, own, 2 * films :] = machine.pace * by_omega[:, :, None] * shares[1:]
        by_speed[:, own] = by_omega * shares[0]
    loads = Loads(values, by_u, by_v, by_speed, drive)
    _add_torques(machine, d, speeds, loads)
    if machine.asperities is not None:
        _add_summits(machine, machine.asperities, u, v, speeds, loads)
    for cone in machine.cones:  # behind the torques, which are of the films alone
        _add_moments(machine, cone, u, v, loads)
    return loads


def _add_moments(machine: Machine, cone: Cone, u: Array, v: Array, loads: Loads) -> None:
    """The gyroscopic moments of a cartridge."""
    films = slice(0, 2 * machine.film_count)
    column = films.stop + cone.ring
    speed, pull = machine.pace * u[:, column], -v[:, films] @ cone.moments.T
    loads.values[:, films] += speed[:, None] * pull
    loads.by_u[:, films, column] += machine.pace * pull
    loads.by_v[:, films, films] -= speed[:, None, None] * cone.moments


def _add_summits(machine: Machine, asperities: Asperities, u: Array, v: Array, speeds: Array, loads: Loads) -> None:
    """Force and friction of the summits of rough surfaces, which turn rings, or hold them."""
    first = 2 * machine.film_count
    for f in range(machine.film_count):
        own, c = slice(2 * f, 2 * f + 2), float(machine.clearances[f])
        total, slip = machine.turning[f]
        shares = np.array([slip, 0.5 * (total - slip)])  # of rotor and rings in slip and speed of the shell
        rubs = rub_slopes(asperities, f, c, np.column_stack([c * u[:, own], c * v[:, own], speeds @ shares.T]))
        by_bodies = rubs[:, :, BY_SLIP:] @ shares
        rows: list[tuple[slice, slice, float]] = [(own, slice(F_X, F_Y + 1), 1.0)]
        for body, pulled in zip(machine.bodies[f].tolist(), (ON_JOURNAL, ON_SHELL), strict=True):
            if body >= 0:
                ring, held = first + body, float(machine.held[body] * machine.pace)
                rows.append((slice(ring, ring + 1), slice(pulled, pulled + 1), 1.0 / held))
        for row, side, scale in rows:
            loads.values[:, row] += scale * rubs[:, side, VALUE]
            loads.by_u[:, row, own] += scale * c * rubs[:, side, BY_X:BY_V_X]
            loads.by_v[:, row, own] += scale * c * rubs[:, side, BY_V_X:BY_SLIP]
            loads.by_u[:, row, first:] += scale * machine.pace * by_bodies[:, side, 1:]
            loads.by_speed[:, row] += scale * by_bodies[:, side, 0]
        if machine.bodies[f, 0] == ROTOR:
            loads.drive[:] -= rubs[:, ON_JOURNAL, VALUE]


def _add_torques(machine: Machine, d: Array, speeds: Array, loads: Loads) -> None:
    """The torques (4.17) on the rings over `held` and the pace, and on the rotor: Couette's term against the slip, and
    half of the moment of the film's force."""
    first = 2 * machine.film_count
    for f in range(machine.film_count):
        own, c = slice(2 * f, 2 * f + 2), machine.clearances[f]
        inside, outside = machine.bodies[f]
        if inside < 0 and outside < 0 and inside != ROTOR:
            continue
        shares = machine.turning[f, 1]
        factor, by_d = drag_factor(d[:, f])
        slip, drag = speeds @ shares, machine.scales[f] * machine.drags[f]
        couette = -drag * factor * slip
        force = loads.values[:, own]
        x, y = d[:, f, 0], d[:, f, 1]
        half = -0.5 * machine.moment * c
        moment = half * (x * force[:, 1] - y * force[:, 0])
        if inside == ROTOR:
            loads.drive[:] -= couette + moment
        for body, sign in ((inside, 1.0), (outside, -1.0)):
            if body < 0:
                continue
            row, scale = first + body, 1.0 / (machine.held[body] * machine.pace)
            loads.values[:, row] += scale * (sign * couette + moment)
            for column, by in ((loads.by_u[:, row], loads.by_u), (loads.by_v[:, row], loads.by_v)):
                column += scale * half * (x[:, None] * by[:, own.start + 1] - y[:, None] * by[:, own.start])
            loads.by_u[:, row, own] += scale * (
                -sign * drag * slip[:, None] * by_d + half * np.column_stack([force[:, 1], -force[:, 0]])
            )
            rate = -scale * sign * drag * factor
            loads.by_u[:, row, first:] += machine.pace * rate[:, None] * shares[1:]
            by_speed = loads.by_speed[:, own]
            loads.by_speed[:, row] += rate * shares[0] + scale * half * (x * by_speed[:, 1] - y * by_speed[:, 0])


def transfer(machine: Machine, frequencies: Array, omega: float) -> Transfer:
    """T of a machine at frequencies (m,) and the speed omega, rad/s; T_k is that at k nu."""
    own, rotor = slice(0, 2 * machine.film_count), machine.rotor
    s, c = (1j * frequencies[:, None, None]).astype(complex), machine.size
    values = np.zeros((len(s), c, c), dtype=complex)
    by_frequency, by_speed = np.zeros_like(values), np.zeros_like(values)
    solved = np.linalg.inv(_dynamic(machine, s, omega))
    right, left = solved @ machine.pulls, machine.places @ solved
    by_rate = 2.0 * s * rotor.mass + machine.held_up[0] + omega * rotor.gyroscopic
    values[:, own, own] = machine.places @ right
    by_frequency[:, own, own] = -1j * (left @ by_rate @ right)
    by_speed[:, own, own] = -s * (left @ rotor.gyroscopic @ right)
    rings = np.arange(own.stop, c)
    lag = 1.0 + 1j * np.outer(frequencies, machine.inertia)
    values[:, rings, rings] = 1.0 / lag
    by_frequency[:, rings, rings] = -1j * machine.inertia / lag**2
    kappa, rate = np.ones((len(s), c), dtype=complex), np.zeros((len(s), c), dtype=complex)
    rate[:, own] = 1j * np.repeat(machine.dashpot, 2)
    kappa[:, own] = np.repeat(machine.spring, 2) + frequencies[:, None] * rate[:, own]
    return Transfer(values, by_frequency, by_speed, kappa, rate)


def _dynamic(machine: Machine, s: Complex | complex, omega: float) -> Complex:
    """(..., n, n) Z of motions exp(s t), s (..., 1, 1) in 1/s, at the speed omega in rad/s."""
    rotor, (damping, stiffness) = machine.rotor, machine.held_up
    return np.asarray(s**2 * rotor.mass + s * (damping + omega * rotor.gyroscopic) + stiffness)


def driven_motions(machine: Machine, omega: float) -> tuple[tuple[int, Complex], ...]:
    """The order k of each load that drives the rotor, and (c,): u of exp(i k Omega t) that it makes without films but
    on kappa, at the speed omega in rad/s."""
    turning = (load.excitation(1.0)[1] for load in turning_loads(machine.rotor))
    loads = (omega**2 * machine.rotor.unbalance, *turning)
    return tuple(
        (order, _moved_by(machine, 0.5 * load, order, omega))
        for order, load in zip(machine.orders, loads, strict=True)
    )


def _moved_by(machine: Machine, load: Array | Complex, order: int, omega: float) -> Complex:
    """(c,): u without films but on kappa at the speed omega in rad/s under a load (n,) that turns with `order` times
    it."""
    moved = np.zeros(machine.size, dtype=complex)
    dynamic = _dynamic(machine, 1j * omega * order, omega)
    moved[: 2 * machine.film_count] = machine.places @ np.linalg.solve(dynamic, load)
    return moved


def smooth_films(system: System) -> tuple[FilmData, ...]:
    """The films of a system; those on cells tabulated as the mean over the angle of their openings."""
    outside = (int(body) for body in system.bodies[:, 1])
    return system.films.smooth([_ring_share(system, i, ring) if ring >= 0 else 0.0 for i, ring in enumerate(outside)])


def _ring_share(system: System, film: int, ring: int) -> float:
    """The speed of a ring over omega_J + omega_S of the film inside of it, concentric."""
    drags = np.array(system.drags)
    ratio = drags[film] / drags[np.any(system.bodies == ring, axis=1)].sum()
    return float(ratio / (1.0 + ratio))
