"""The machine linearised at rest: its matrices on films of eight coefficients each, and its state matrix.

The speeds of rings follow small motions, as the torques of films and summits have them: friction falls steeply with
them where a ring sticks. A ring with a pin leans on it, so that small motions see a spring and a damper, without play.

Stiffness and damping of films at rest, with their error: one place for all results that are made of them.

Columns of a warm machine: its films, its rings and its balance of heat.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.columns import Column, Shown, spaced
from frbcli.elements.pin import DAMPING, STIFFNESS
from frbcli.equilibrium.dynamic_films import DynamicFilm, Oscillator
from frbcli.equilibrium.resting import STILL, RestingPosition
from frbcli.equilibrium.ring_speed import SUM, memoryless, ring_torques, rubbed_rings, turned_by
from frbcli.equilibrium.static_films import StaticFilms
from frbcli.film.rectangles.film import FilmForce
from frbcli.rotor.assembly import LinearRotor, with_precession
from frbcli.rotor.port import tangent
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


def rotor_at_rest(
    system: System, omega: float, ring_speeds: Array, at_rest: FilmsAtRest,
    oil: Sequence[tuple[Array, Array]] | None = None,
) -> LinearRotor:  # fmt: skip
    """The machine at omega rad/s without its films, its rings turning with ring_speeds (rings,) in rad/s. The angles of
    its rings are degrees of freedom and see the torques of their films and summits; of rings with a pin its spring and
    its damper, too.

    oil: stiffness and damping (c + 1, c + 1) of the films without their summits, see LinearFilm.turning, by which they
    turn the rings and follow them; by default as films without memory have them."""
    rotor = with_precession(tangent(system.rotor, omega, at_rest.position.displacements), ring_speeds)
    if not system.ring_count:
        return rotor
    places, bodies = at_rest.position.journals, np.append(omega, at_rest.position.ring_speeds)
    rubbed = rubbed_rings(system, bodies, places)
    films = tuple(film.plus(summits, -1.0) for film, summits in zip(at_rest.forces, rubbed.summits, strict=True))
    if oil is None:
        oil = [memoryless(*each) for each in zip(films, places, strict=True)]
    nothing = np.zeros((places.shape[1],) * 2)
    constant = tuple(replace(film, by_displacement=nothing, by_velocity=nothing, slopes=None) for film in films)
    _, by_speeds, by_places = ring_torques(system, bodies, places, constant)
    journals, angles = rotor.journals.reshape(-1, rotor.size), np.array(system.spins)
    stiffness, damping = rotor.stiffness.copy(), rotor.damping.copy()
    stiffness[angles] -= (by_places + rubbed.torques) @ journals
    damping[angles] -= rubbed.torques_by_rate @ journals
    damping[np.ix_(angles, angles)] -= by_speeds + rubbed.torques_by_speed
    for ring in np.flatnonzero(system.pinned):
        stiffness[angles[ring], angles[ring]] += system.pins[ring, STIFFNESS]
        damping[angles[ring], angles[ring]] += system.pins[ring, DAMPING]
    for i, (push, journal) in enumerate(zip(*_beside_rings(system, rotor, bodies, places), strict=True)):
        own = rotor.multiplicity[i] * rotor.journals[i].T
        for matrix, each in zip((stiffness, damping), oil[i], strict=True):
            matrix += push @ each @ journal - own @ each[:-1, :-1] @ rotor.journals[i]
        damping[:, angles] -= own @ rubbed.forces_by_speed[i]
    return replace(rotor, stiffness=stiffness, damping=damping, turning=tuple(angles[~system.pinned].tolist()))


def _beside_rings(system: System, rotor: LinearRotor, bodies: Array, places: Array) -> tuple[Array, Array]:
    """Maps of the films next to rings, L (films, n, c + 1) and P (films, c + 1, n) of dynamic_films; bodies, places:
    see ring_torques."""
    spins, (films, c, n) = list(system.spins), rotor.journals.shape
    pushes, journals = np.zeros((films, n, c + 1)), np.zeros((films, c + 1, n))
    pushes[:, :, :c] = rotor.multiplicity[:, None, None] * np.swapaxes(rotor.journals, 1, 2)
    pushes[:, spins] += turned_by(system, bodies, places)
    journals[:, :c], journals[:, c, spins] = rotor.journals, system.turning[:, SUM, 1:]
    return pushes, journals


def oscillator(system: System, omega: float, at_rest: FilmsAtRest, films: Sequence[DynamicFilm]) -> Oscillator:
    """The machine at omega rad/s without its films, which are mass-conserving. The films turn its rings with all of
    their forces; summits, which have their own torques, are removed here."""
    off, speeds = [(-film.summits.place, -film.summits.rate) for film in films], at_rest.position.ring_speeds
    rotor = rotor_at_rest(system, omega, speeds, at_rest, off)
    here, journals = rotor.at(omega), rotor.journals
    pushes = here.multiplicity[:, None, None] * np.swapaxes(journals, 1, 2)
    if system.ring_count:
        pushes, journals = _beside_rings(system, rotor, np.append(omega, speeds), at_rest.position.journals)
    damping = here.damping + omega * here.gyroscopic
    return Oscillator(here.mass, damping, here.stiffness, journals, pushes, here.turning)


def linearised(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> tuple[Array, Array, Array]:
    """(n, n) mass, damping and stiffness at omega rad/s, the damping with the gyroscopic term, on films of stiffness
    and damping (films, c, c), SI units, by the c coordinates that the films see."""
    here = rotor.at(omega)
    bearings = here.multiplicity[:, None, None] * np.swapaxes(here.journals, 1, 2)
    k = here.stiffness + (bearings @ stiffness @ here.journals).sum(axis=0)
    d = here.damping + omega * here.gyroscopic + (bearings @ damping @ here.journals).sum(axis=0)
    return here.mass, d, k


def states(matrices: tuple[Array, Array, Array], turning: tuple[int, ...]) -> Array:
    """(2 n, 2 n) of the states (q, q') of mass, damping and stiffness (n, n), without the angles of turning rings."""
    whole = first_order(*matrices)
    kept = np.delete(np.arange(len(whole)), turning)
    return np.asarray(whole[np.ix_(kept, kept)])


def eigenpairs(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> tuple[Complex, Complex]:
    """(N,) eigenvalues in 1/s of a machine as `linearised`, and the motions (n, N) of all its degrees of freedom. The
    angles of rings on which nothing depends are no states of it."""
    return small_motions(linearised(rotor, omega, stiffness, damping), rotor.turning)


def small_motions(matrices: tuple[Array, Array, Array], turning: tuple[int, ...]) -> tuple[Complex, Complex]:
    """As eigenpairs, of mass, damping and stiffness (n, n). turning: see LinearRotor."""
    values, vectors = np.linalg.eig(states(matrices, turning))
    motions = vectors[-len(matrices[0]) :].astype(complex)  # velocities, of which each degree of freedom has one
    corrected = _grown_by_work(values.astype(complex), motions, matrices, _sensitivity(vectors, matrices[0]))
    return corrected, motions


def _sensitivity(vectors: Complex, mass: Array) -> Array:
    """(N,) by how much eigenvalues move by a small error of their motions: 0 of normal motions, whose balance of work
    is left by it to first order, and large where two are about to become one. vectors: (N, N) states, the last n of
    which are velocities."""
    n = len(mass)
    try:
        left = np.linalg.solve(mass, np.linalg.inv(vectors)[:, -n:].T)
    except np.linalg.LinAlgError:
        return np.full(len(vectors), math.inf)

    def size(motions: Complex) -> Array:
        return np.asarray(np.sqrt(np.abs(np.einsum("in,ij,jn->n", motions.conj(), mass, motions))))

    condition: Array = np.multiply(2.0 * size(vectors[-n:]), size(left.astype(complex)))  # 1 of a normal motion
    return np.asarray(np.sqrt(np.maximum(condition**2 - 1.0, 0.0)))


def _grown_by_work(
    values: Complex, motions: Complex, matrices: tuple[Array, Array, Array], sensitivity: Array
) -> Complex:
    """Eigenvalues (N,) in 1/s of mass, damping and stiffness (n, n), with the growth that the work of their motions
    (n, N) has, 0 where it is round-off.

    With its motion x an eigenvalue s solves m s^2 + (d + i g) s + k + i c = 0 for m = x^H M x, d + i g = x^H D x and
    k + i c = x^H K x. The imaginary part is the work in a period: for s = a + i w it gives the growth

        a = -(w d + c) / (2 w m + g),

    exactly 0 of an undamped motion, where the real part that a solver finds is round-off of the largest eigenvalue. A
    motion without stiffness and damping, of a free body, has a double eigenvalue 0, of which a solver finds the root of
    its round-off."""
    corrected, (mass, damping, stiffness) = values.copy(), matrices
    size, noise = float(np.max(np.abs(values), initial=0.0)), len(values) * float(np.finfo(float).eps)

    def work(matrix: Array) -> tuple[Complex, Array]:
        """x^H A x of all motions, and its round-off."""
        done = np.einsum("in,ij,jn->n", motions.conj(), matrix, motions)
        return done, noise * np.einsum("in,ij,jn->n", *(np.abs(each) for each in (motions, matrix, motions)))

    (m, _), (d, off_d), (k, off_k) = map(work, (mass, damping, stiffness))
    frequency, slow = values.imag, math.sqrt(noise) * size
    inertia = 2.0 * frequency * m.real + d.imag
    doubtful = (np.abs(values.real) <= slow) & (np.abs(inertia) > np.abs(frequency) * m.real) & (frequency != 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = -(frequency * d.real + k.imag) / inertia
        least = (np.abs(frequency) * off_d + off_k) / np.abs(inertia)
    none = (np.abs(growth) <= least) | ((growth > 0.0) & (growth <= noise * size * sensitivity))
    corrected.real[doubtful] = np.where(none, 0.0, growth)[doubtful]
    free = (np.abs(k) <= noise * size**2 * m.real) & (np.abs(d) <= noise * size * m.real + off_d)
    corrected[(np.abs(values) <= slow) & free | (np.abs(values) <= noise * size)] = 0.0
    return corrected


def first_order(mass: Array, damping: Array, stiffness: Array) -> Array:
    """(2 n, 2 n) A of x' = A x, x = (q, q'), for M q'' + D q' + K q = 0 with matrices (n, n)."""
    n = len(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, np.hstack([stiffness, damping]))]])


# Of a FilmTemperature, all of one bearing
WARM_FILMS = (
    Column("film", "", "name of the film", shown=(Shown("film", spaced),)),
    Column("temperature", "K", "temperature of the film", shown=(Shown("degC", ".1f", "degC"),)),
    Column("viscosity", "Pa s", "viscosity of its oil", shown=(Shown("mPa*s", ".4g", "mPa s"),)),
    Column("clearance", "m", "clearance", shown=(Shown("gap, um", ".4g", "um"),)),
    Column("power", "W", "power that journal and shell put into the film", shown=(Shown("loss, W", ".4g"),)),
    Column("flow", "m^3/s", "oil that leaves at the open ends", shown=(Shown("flow, l/min", ".3g", "l/min"),)),
)

# Of a RingTemperature
WARM_RINGS = (
    Column("ring", "", "name of the ring", shown=(Shown("ring"),)),
    Column("inner", "K", "of its inner surface", shown=(Shown("inner, degC", ".1f", "degC"),)),
    Column("outer", "K", "of its outer surface", shown=(Shown("outer, degC", ".1f", "degC"),)),
    Column("speed_ratio", "", "speed of the ring over the rotor speed", shown=(Shown("speed over rotor's", ".4f"),)),
)

# Of a SteadyHeat
HEAT_BALANCE = (
    Column("carried_by_oil", "W", "heat that leaves with the oil", attrgetter("carried")),
    Column("into_walls", "W", "heat into shaft and housing", attrgetter("given")),
    Column("balance_relative", "", "unaccounted power over the power", attrgetter("balance")),
)
