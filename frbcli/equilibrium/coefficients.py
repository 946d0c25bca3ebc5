"""Stiffness and damping of films at rest, with their error: one place for all results that are made of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.equilibrium.resting import STILL, RestingPosition
from frbcli.equilibrium.static_films import StaticFilms
from frbcli.film.rectangles.film import FilmForce
from frbcli.scene.machine.system import System

LEAST = 3e-5  # of the error: what the interpolation of tables leaves, the same on every mesh
SLIGHT = 0.1  # of omega times the damping: stiffness of a film that hardly counts
DIFFERENCE = 1e-4  # of the gap, and of the velocity that moves the journal by it in 1 / omega


@dataclass(frozen=True)
class TiltingFilm:
    """A film whose journal tilts, at rest. tilt: (2,) of the journal against its shell about x and y, rad; stiffness,
    damping: (4, 4) of forces and moments by displacements and tilts, SI units."""

    tilt: Array
    stiffness: Array
    damping: Array

    @property
    def tilt_stiffness(self) -> Array:
        """(2, 2) -dM/dtilt in N m."""
        return self.stiffness[2:, 2:]

    @property
    def tilt_damping(self) -> Array:
        """(2, 2) -dM/dtilt' in N m s."""
        return self.damping[2:, 2:]


@dataclass(frozen=True)
class RestingFilm:
    """A film at its static equilibrium.

    displacement: (2,) of the journal over the clearance; attitude_deg: from the load line to the displacement, positive
    counter-clockwise, NaN where nothing is carried; stiffness (2, 2) in N/m, damping (2, 2) in N s/m, -dF/dD and
    -dF/dD': of one bearing, of films that keep oil when this has settled; name: as in the signals of a run, "" of a
    single film without a name; error: expected one of stiffness and damping, over the largest entry of each, from other
    meshes, NaN where it is not known; load: (2,) N on the journal; place_error: expected one of the displacement, over
    the clearance, likewise; tilting: of a film whose journal tilts.
    """

    displacement: Array
    attitude_deg: float
    stiffness: Array
    damping: Array
    name: str = ""
    error: float = math.nan
    load: tuple[float, float] = (math.nan, math.nan)
    place_error: float = math.nan
    tilting: TiltingFilm | None = None

    @property
    def eccentricity(self) -> float:
        """Relative eccentricity of the journal."""
        return math.hypot(*self.displacement)

    def seen(self, displacement: Array) -> Array:
        """(c,) what the film sees of its journal at a displacement (2,) in any unit: with its tilt, where it tilts."""
        return displacement if self.tilting is None else np.concatenate([displacement, self.tilting.tilt])


def coefficients_of(films: Sequence[RestingFilm]) -> tuple[Array, Array]:
    """(films, c, c) stiffness and damping of films at rest, or of none, by the c coordinates that they see."""
    whole = [film if film.tilting is None else film.tilting for film in films]
    return stacked([film.stiffness for film in whole]), stacked([film.damping for film in whole])


def stacked(matrices: Sequence[Array]) -> Array:
    """(films, c, c) the matrices of films, or of none."""
    return np.array(matrices) if matrices else np.zeros((0, 2, 2))


def settled_force(
    system: System, i: int, place: Array, total: float, near: FilmForce | None = None, slip: float | None = None
) -> FilmForce:
    """Force and derivatives of film i with its journal at rest at `place` (c,) in m, of a film that keeps oil when this
    has settled in each of two neighbouring motions. total: omega_J + omega_S; slip: see System.force. Raises
    NotConverged."""
    force = system.force(i, place, np.zeros_like(place), total, near, slip)
    if not system.remembering[i]:
        return force
    size = len(place)

    def moved(motion: Array) -> Array:
        """(stations,) displacements in m along the film of a motion (c,)."""
        seen = system.films.seen(np.tile(motion, (system.films.count, 1)))
        return np.asarray(np.hypot(*seen.reshape(system.films.count, -1, 2)[i].T))

    gap = system.clearances[i] - float(moved(system.felt(i, place)).max())
    by_displacement, by_velocity = np.empty((size, size)), np.empty((size, size))
    for column, unit in enumerate(np.eye(size)):
        step = DIFFERENCE * gap / float(moved(unit).max())
        pace = step * max(abs(total), 1.0)
        ahead, behind = (
            system.force(i, place + side * step * unit, 0.0 * unit, total, None, slip).force for side in (1.0, -1.0)
        )
        by_displacement[:, column] = (ahead - behind) / (2.0 * step)
        ahead, behind = (
            system.force(i, place, side * pace * unit, total, None, slip).force for side in (1.0, -1.0)
        )
        by_velocity[:, column] = (ahead - behind) / (2.0 * pace)
    return replace(force, by_displacement=by_displacement, by_velocity=by_velocity)


@dataclass(frozen=True)
class FilmsAtRest:
    """The films of a machine at rest. position: of the machine; totals, slips: (films,) omega_J + omega_S and omega_J -
    omega_S; forces: of the films."""

    position: RestingPosition
    totals: Array
    slips: Array
    forces: tuple[FilmForce, ...]


def films_at_rest(system: System, omega: float, position: RestingPosition, settled: bool = True) -> FilmsAtRest:
    """The films of a machine that rests at omega rad/s. settled: whether the derivatives of mass-conserving films come
    from settled_force, else one-sided ones. Raises NotConverged."""
    speeds, near = position.ring_speeds, position.films
    totals, slips = system.omegas(omega, speeds), system.slips(omega, speeds)

    def force(i: int, place: Array) -> FilmForce:
        if near and not (settled and system.remembering[i]):
            return near[i]
        return settled_force(system, i, place, float(totals[i]), near[i] if near else None, float(slips[i]))

    return FilmsAtRest(position, totals, slips, tuple(force(i, place) for i, place in enumerate(position.journals)))


def coefficient_error(own: FilmForce, others: Sequence[tuple[FilmForce, float]], omega: float) -> float:
    """Expected error of stiffness and damping over the largest entry of each, from the same film on other meshes and
    the share of the difference that is the error; NaN without others. omega: rad/s of the rotor. The film of a damper
    does not turn and has no stiffness but round-off: that error counts over what its damping does at this speed."""
    errors = []
    for first in range(0, len(own.force), 2):  # forces by displacements, moments by tilts
        block = slice(first, first + 2), slice(first, first + 2)
        least = SLIGHT * abs(omega) * float(np.abs(own.by_velocity[block]).max())
        for other, share in others:
            for name, nothing in (("by_displacement", least), ("by_velocity", 0.0)):
                mine, theirs = getattr(own, name)[block], getattr(other, name)[block]
                size, off = float(np.abs(mine).max()), float(np.abs(mine - theirs).max())
                errors.append(max(share * off / max(size, nothing), LEAST) if off else LEAST)
    return max(errors, default=math.nan)


def place_error(own: Array, others: Sequence[tuple[Array, float]]) -> float:
    """Expected error of a displacement (2,) over the clearance, from those on other meshes and the share of the
    difference that is the error; NaN without others."""
    errors = [max(share * float(np.hypot(*(own - other))), LEAST) for other, share in others]
    return max(errors, default=math.nan)


def force_error(static: StaticFilms, i: int, place: Array, total: float, load: tuple[float, float]) -> float:
    """Relative error of the force of film i at `place` (c,), where it carries `load`, from another mesh; NaN where it
    is not known."""
    if not static.others:
        return math.nan
    other = static.others[0]
    still = np.zeros_like(place)
    off, size = other.system.force(i, place, still, total).force[:2] + load, float(np.hypot(*load))
    return other.share * float(np.hypot(*off)) / size if size > 0.0 else 0.0


def resting_film(
    name: str, force: FilmForce, displacement: Array, error: float, off: float = math.nan, tilt: Array | None = None
) -> RestingFilm:
    """The film of a force; displacement (2,) over the clearance, and off, its error; tilt: (2,) rad, of a film that
    sees it."""
    load, attitude, k, d = -force.force[:2], math.nan, -force.by_displacement, -force.by_velocity
    if np.hypot(*load) > STILL and displacement.any():
        across = load[0] * displacement[1] - load[1] * displacement[0]
        attitude = math.degrees(math.atan2(across, load @ displacement))
    x, y = load.tolist()
    tilting = None if tilt is None else TiltingFilm(tilt, k, d)
    return RestingFilm(displacement, attitude, k[:2, :2], d[:2, :2], name, error, (x, y), off, tilting)
