"""Machines at rest whose films keep their oil: the dynamic stiffness of the films, and eigenvalues of machine and oil.

The eigenvalues s are those of M s^2 + (D + Omega G) s + K + sum of P^T Z(s) P, by nonlinear inverse iteration from the
eigenvalues of a machine on films with a few states each (projections, see film/cells/dynamic_stiffness.py).

How a film answers depends on where its fronts lie between its cells: fronts cross cells one at a time, and the
derivative jumps. So Z is the mean over PLACES of the cells. Its error is of first order in the size of the cells:
MESHES extrapolates two sizes, and the difference to the finer one is the expected error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cells.dynamic_stiffness import (
    DynamicStiffness,
    dynamic_stiffness,
    stiffness_at,
    weighted,
    without_memory,
)
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.linearised import LinearFilm, linear_film, lying
from frbcli.film.cells.mesh.grid import run_grid
from frbcli.film.rectangles.film import FilmForce
from frbcli.rotor.linear import LinearRotor

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MESHES = (((96, 12), 2.0), ((48, 6), -1.0))  # cells around and along, with their weights in the extrapolation
PLACES = 8  # of the cells, over one cell
PROJECTED = (0.25, 0.5, 1.0, 4.0)  # frequencies over the rotor's speed
DAMPED = 1.0  # over the rotor's speed: motions that decay faster are none of interest
TRUSTED = 1e-2  # relative error of the projection at an eigenvalue, beyond which this is not one of the machine
ITERATIONS, CLOSE = 30, 1e-10  # of the inverse iteration, and its last step over |s|
NO_STIFFNESS = without_memory(np.zeros((2, 2)), np.zeros((2, 2)))
EQUAL = 1e-6  # relative: the same eigenvalue, from two starts


@dataclass(frozen=True)
class DynamicFilm:
    """A film that may keep its oil. own: extrapolated; fine: of the finer mesh alone; one: of the cells in one place,
    exact: the film that this is a projection of, None of a film without memory; summits: which all of them have beside
    the oil, but for `exact`."""

    own: DynamicStiffness
    fine: DynamicStiffness
    one: DynamicStiffness
    exact: LinearFilm | None = None
    summits: DynamicStiffness = NO_STIFFNESS

    def on(self, summits: FilmForce) -> DynamicFilm:
        """The film with the summits of rough surfaces beside it, which have no memory."""
        more = without_memory(-summits.by_displacement, -summits.by_velocity)
        own, fine, one = (weighted([(each, 1.0), (more, 1.0)]) for each in (self.own, self.fine, self.one))
        return DynamicFilm(own, fine, one, self.exact, more)


def dynamic_film(film: VolumeFilm, place: Array, total: float, omega: float) -> DynamicFilm:
    """A film that keeps its oil, its journal at rest at `place` (2,) in m. total: omega_J + omega_S; omega: speed of
    the rotor, rad/s. Raises NotConverged."""
    frequencies = [share * abs(omega) for share in PROJECTED]
    means: list[DynamicStiffness] = []
    begun: list[tuple[DynamicStiffness, LinearFilm]] = []
    for cells, _ in MESHES:
        mesh = VolumeFilm(film.section, run_grid(film.section, cells), film.law, film.scales.reference)
        parts: list[tuple[DynamicStiffness, float]] = []
        start: Array | None = None
        for number in range(PLACES):
            linear = linear_film(lying(mesh, number / PLACES), place, total, start)
            start = linear.field
            parts.append((dynamic_stiffness(linear, frequencies), 1.0 / PLACES))
            begun.append((parts[-1][0], linear))
        means.append(weighted(parts))
    own = weighted([(mean, weight) for mean, (_, weight) in zip(means, MESHES, strict=True)])
    return DynamicFilm(own, means[0], *begun[0])


def constant_film(force: FilmForce) -> DynamicFilm:
    """A film without memory: stiffness and damping of its force at all frequencies."""
    same = without_memory(-force.by_displacement, -force.by_velocity)
    return DynamicFilm(same, same, same)


@dataclass(frozen=True)
class Oscillator:
    """A machine of n degrees of freedom on its films: mass, damping with the gyroscopic term, stiffness (n, n); maps
    (films, 2, n) onto the journals, multiplicity (films,)."""

    mass: Array
    damping: Array
    stiffness: Array
    journals: Array
    multiplicity: Array

    def at(self, s: complex, films: Sequence[DynamicStiffness]) -> tuple[Complex, Complex]:
        """(n, n) what multiplies the motion exp(s t), and its derivative by s."""
        matrix: Complex = np.asarray(self.mass * s * s + self.damping * s + self.stiffness, dtype=complex)
        slope: Complex = np.asarray(2.0 * s * self.mass + self.damping, dtype=complex)
        for many, journal, film in zip(self.multiplicity, self.journals, films, strict=True):
            z, by_s = film.at(s)
            matrix = matrix + many * (journal.T @ z @ journal)
            slope = slope + many * (journal.T @ by_s @ journal)
        return matrix, slope

    def starts(self, films: Sequence[DynamicStiffness]) -> list[tuple[complex, Complex]]:
        """Eigenvalues with their shapes (n,), of films with few states: a dense problem."""
        from scipy.linalg import eig

        n, sizes = len(self.mass), [len(film.delays) for film in films]
        size = 2 * n + sum(sizes)
        rate, own = np.eye(size, dtype=complex), np.zeros((size, size), dtype=complex)
        rate[n : 2 * n, n : 2 * n] = self.mass
        own[:n, n : 2 * n] = np.eye(n)
        own[n : 2 * n, :n], own[n : 2 * n, n : 2 * n] = -self.stiffness, -self.damping
        begin = 2 * n
        for many, journal, film, count in zip(self.multiplicity, self.journals, films, sizes, strict=True):
            oil = slice(begin, begin + count)
            begin += count
            own[n : 2 * n, :n] -= many * (journal.T @ film.place @ journal)
            own[n : 2 * n, n : 2 * n] -= many * (journal.T @ film.rate @ journal)
            own[n : 2 * n, oil] = -many * (journal.T @ film.left)
            own[oil, :n], own[oil, n : 2 * n] = film.right_place @ journal, film.right_rate @ journal
            own[oil, oil], rate[oil, oil] = -np.eye(count), np.diag(film.delays)
        values, shapes = eig(own, rate)
        return [(complex(values[i]), shapes[:n, i]) for i in np.flatnonzero(np.isfinite(values))]


def oscillator(rotor: LinearRotor, omega: float) -> Oscillator:
    """The machine at omega rad/s without its films."""
    here = rotor.at(omega)
    return Oscillator(
        here.mass, here.damping + omega * here.gyroscopic, here.stiffness, here.journals, here.multiplicity
    )


def modes(
    machine: Oscillator, films: Sequence[DynamicFilm], own: Sequence[DynamicStiffness], omega: float
) -> list[tuple[complex, Complex]]:
    """Eigenvalues in 1/s with their shapes (n,), of pairs the one with positive imaginary part: all that grow, and
    those that decay by less than DAMPED.

    own: the films' dynamic stiffness, `own` or `fine` of the films. Eigenvalues at which the projections are not to be
    trusted are none of the machine."""
    found: list[tuple[complex, Complex]] = []
    for start, shape in machine.starts([film.one for film in films]):
        if start.imag < -EQUAL * abs(start) or start.real < -DAMPED * abs(omega):
            continue
        value, vector = _iterated(machine, own, start, shape)
        if not math.isfinite(value.real) or value.real < -DAMPED * abs(omega) or value.imag < -EQUAL * abs(value):
            continue
        if any(abs(value - other) < EQUAL * abs(value) for other, _ in found):
            continue
        if all(_trusted(film, value) for film in films):
            found.append((value, vector))
    return found


def _iterated(
    machine: Oscillator, films: Sequence[DynamicStiffness], s: complex, shape: Complex
) -> tuple[complex, Complex]:
    """The eigenvalue that the inverse iteration leads to from s, with its shape; NaN if it leads nowhere."""
    real = abs(s.imag) < EQUAL * abs(s)
    vector: Complex = np.asarray(shape / np.linalg.norm(shape))
    for _ in range(ITERATIONS):
        matrix, slope = machine.at(s, films)
        try:
            following = np.linalg.solve(matrix, slope @ vector)
        except np.linalg.LinAlgError:  # s is an eigenvalue to the last bit
            return s, vector
        step = complex((vector.conj() @ vector) / (vector.conj() @ following))
        s -= step
        if real:
            s = complex(s.real)
        vector = np.asarray(following / np.linalg.norm(following))
        if abs(step) < CLOSE * abs(s):
            return s, vector
    return complex(math.nan, math.nan), vector


def _trusted(film: DynamicFilm, s: complex) -> bool:
    if film.exact is None:
        return True
    exact = stiffness_at(film.exact, s) + film.summits.at(s)[0]
    return bool(np.abs(film.one.at(s)[0] - exact).max() < TRUSTED * np.abs(exact).max())
