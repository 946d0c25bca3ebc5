"""The machine linearised at rest: its matrices on films of eight coefficients each, and its state matrix.

The speeds of rings follow small motions, as the torques of films and summits have them: friction falls steeply with
them where a ring sticks. A ring with a pin leans on it, so that small motions see a spring and a damper, without play.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.elements.pin import DAMPING, STIFFNESS
from frbcli.equilibrium.coefficients import FilmsAtRest
from frbcli.equilibrium.dynamic_films import DynamicFilm, Oscillator
from frbcli.equilibrium.ring_speed import SUM, memoryless, ring_torques, rubbed_rings, turned_by
from frbcli.rotor.assembly import LinearRotor, with_precession
from frbcli.rotor.port import tangent
from frbcli.scene.machine.system import System


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
