"""Machines at rest whose films are mass-conserving: the dynamic stiffness of the films, and eigenvalues of machine and
oil.

The eigenvalues s of M s^2 + (D + Omega G) s + K + sum of L Z(s) P follow by nonlinear inverse iteration from the
eigenvalues of a machine on films with a few states each (projections, see film/cells/dynamic_stiffness.py). P maps the
motion of the machine onto the motion of the journals, and of the angles of rings onto the angle by which journal and
shell turn together; L maps forces onto the machine, and onto the rings their moments and what missing oil leaves of the
drag.

How a film answers depends on where its fronts lie between its cells: fronts cross cells one at a time, and the
derivative jumps. So Z is the mean over PLACES of the cells. Its error is of first order in the size of the cells:
MESHES extrapolates two sizes, and the difference to the finer one is the expected error. What the mean over the places
leaves is a part of the error of its own: see place_errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.equilibrium.ring_speed import memoryless
from frbcli.film.cells.dynamic_stiffness import (
    DynamicStiffness,
    dynamic_stiffness,
    stiffness_at,
    weighted,
    without_memory,
)
from frbcli.film.cells.linearised import LinearFilm
from frbcli.film.kinds.contract import LinearOf
from frbcli.film.rectangles.film import FilmForce

# Cells around, and along a half of the width, with their weights in the extrapolation.
MESHES = (((96, 12), 2.0), ((48, 6), -1.0))
PLACES = 8  # of the cells, over one cell
SPREAD = 2.0  # standard deviations of the mean over the places that are stated as its error
PROJECTED = (0.25, 0.5, 1.0, 4.0)  # frequencies over the rotor's speed
DAMPED = 1.0  # over the rotor's speed: motions that decay faster are none of interest
TRUSTED = 1e-2  # relative error of the projection at an eigenvalue, beyond which this is not one of the machine
# Relative distance to a pole of a projection within which a motion belongs to the projection alone: the projection of a
# film with gas has some that grow and move nothing, next to which the inverse iteration ends at once.
POLE = 1e-8
# Difference of the films of both meshes over the smaller one. Next to a pole of the finer mesh it is 1, next to one of
# the coarser mesh more; at eigenvalues of machines it is 0.01 to 0.3, of those that hardly oscillate up to 0.5.
KNOWN = 0.75
# From a start to its eigenvalue, over the larger of start and speed of the rotor: it is up to 0.1. The iteration from a
# start of which the films have no eigenvalue wanders, and ends by chance.
MOVED = 0.25
ITERATIONS, CLOSE = 30, 1e-10  # of the inverse iteration, and its last step over |s|
CENTRE = 1e-9  # m: off the centre by less, a journal takes no notice of both surfaces turning
EQUAL = 1e-6  # relative: the same eigenvalue, from two starts
NEARLY_REAL = 1e-3  # imaginary part over |s|: round-off of a start that is real
INSTANT = 1e-5  # delay over the longest one of all films, below which the oil of a state answers at once


@dataclass(frozen=True)
class DynamicFilm:
    """A film that may be mass-conserving. own: extrapolated; fine: of the finer mesh alone; one: of the cells in one
    place, exact: the film that this is a projection of, None of a film without memory; summits: asperities, which all
    of them include in addition to the oil, except `exact`; lying: of each of MESHES with its cells in each of PLACES,
    times the weight of the mesh. `turns`: whether it is next to a ring, see LinearFilm.turning."""

    own: DynamicStiffness
    fine: DynamicStiffness
    one: DynamicStiffness
    summits: DynamicStiffness
    exact: LinearFilm | None = None
    lying: tuple[tuple[DynamicStiffness, ...], ...] = ()

    def oil_at(self, frequency: float) -> tuple[Array, Array]:
        """Stiffness and damping (c, d) at a frequency in rad/s, above 0, without the summits."""
        z = self.own.at(1j * frequency)[0] - self.summits.at(1j * frequency)[0]
        return z.real, z.imag / frequency

    def on(self, summits: FilmForce) -> DynamicFilm:
        """The film with the summits of rough surfaces in parallel, which have no memory, and whose friction does not
        follow the angle by which journal and shell turn together."""
        more = without_memory(*np.zeros((2, *self.own.place.shape)))
        at = slice(0, len(summits.force))
        more.place[at, at], more.rate[at, at] = memoryless(summits)
        own, fine, one = (weighted([(each, 1.0), (more, 1.0)]) for each in (self.own, self.fine, self.one))
        return DynamicFilm(own, fine, one, more, self.exact, self.lying)


def dynamic_film(
    film: Callable[[tuple[int, int]], LinearOf], place: Array, total: float, omega: float, turns: bool = False
) -> DynamicFilm:
    """A mass-conserving film, its journal at rest at `place` (c,) in m and rad. film: on any cells, see Films.linear;
    total: omega_J + omega_S; omega: speed of the rotor, rad/s; turns: see DynamicFilm. Raises NotConverged."""
    frequencies = [share * abs(omega) for share in PROJECTED]
    lying: list[tuple[DynamicStiffness, ...]] = []
    means: list[DynamicStiffness] = []
    begun: list[tuple[DynamicStiffness, LinearFilm]] = []
    for cells, weight in MESHES:
        on_cells = film(cells)
        parts: list[tuple[DynamicStiffness, float]] = []
        start: Array | None = None
        for number in range(PLACES):
            linear = on_cells(number / PLACES, place, total, start)
            start = linear.field
            linear = linear.turning() if turns else linear
            parts.append((dynamic_stiffness(linear, frequencies), 1.0 / PLACES))
            begun.append((parts[-1][0], linear))
        means.append(weighted(parts))
        lying.append(tuple(weighted([(part, weight)]) for part, _ in parts))
    own = weighted([(mean, weight) for mean, (_, weight) in zip(means, MESHES, strict=True)])
    one, exact = begun[0]
    return DynamicFilm(own, means[0], one, _nothing(one), exact, tuple(lying))


def constant_film(force: FilmForce, place: Array, turns: bool = False) -> DynamicFilm:
    """A film without memory: stiffness and damping of its force at all frequencies; turns: see DynamicFilm."""
    same = without_memory(*memoryless(force, place if turns else None))
    return DynamicFilm(same, same, same, _nothing(same))


def _nothing(film: DynamicStiffness) -> DynamicStiffness:
    """No film, of as many coordinates."""
    return without_memory(np.zeros_like(film.place), np.zeros_like(film.rate))


@dataclass(frozen=True)
class Oscillator:
    """A machine of n degrees of freedom on its films: mass, damping with the gyroscopic term, stiffness (n, n); maps
    journals (films, d, n), P, and pushes (films, n, c), L; turning: see LinearRotor.

    The coordinates of what turns are the speeds, so that nothing is at rest at any angle: theirs are `at` and the
    shapes of motions."""

    mass: Array
    damping: Array
    stiffness: Array
    journals: Array
    pushes: Array
    turning: tuple[int, ...] = ()

    def at(self, s: complex, films: Sequence[DynamicStiffness]) -> tuple[Complex, Complex]:
        """(n, n) what multiplies the motion exp(s t), and its derivative by s."""
        matrix: Complex = np.asarray(self.mass * s * s + self.damping * s + self.stiffness, dtype=complex)
        slope: Complex = np.asarray(2.0 * s * self.mass + self.damping, dtype=complex)
        for push, journal, film in zip(self.pushes, self.journals, films, strict=True):
            z, by_s = film.at(s)
            matrix, slope = matrix + push @ z @ journal, slope + push @ by_s @ journal
        spins = list(self.turning)
        matrix[:, spins] /= s
        slope[:, spins] = (slope[:, spins] - matrix[:, spins]) / s
        return matrix, slope

    def starts(self, films: Sequence[DynamicStiffness]) -> list[tuple[complex, Complex]]:
        """Eigenvalues with their shapes (n,), of films with few states: a dense problem, of displacements, velocities
        and the states of the oil.

        Most projections have directions that store no oil, whose delays are round-off. As states they would spoil all
        eigenvalues: they answer at once, as stiffness and damping."""
        n, longest = len(self.mass), max((np.abs(film.delays).max(initial=0.0) for film in films), default=0.0)
        stiffness, damping = self.stiffness.astype(complex), self.damping.astype(complex)
        oil: list[tuple[Complex, ...]] = []
        for push, journal, film in zip(self.pushes, self.journals, films, strict=True):
            stores = np.abs(film.delays) > INSTANT * longest
            at_once, slow = film.left[:, ~stores], film.left[:, stores]
            stiffness += push @ (film.place + at_once @ film.right_place[~stores]) @ journal
            damping += push @ (film.rate + at_once @ film.right_rate[~stores]) @ journal
            by_state = film.delays[stores, None]
            place, rate = (each[stores] @ journal / by_state for each in (film.right_place, film.right_rate))
            oil.append((push @ slow, place, rate, 1.0 / film.delays[stores]))
        left = np.hstack([np.zeros((n, 0)), *(each[0] for each in oil)])
        place, rate = (np.vstack([np.zeros((0, n)), *(each[part] for each in oil)]) for part in (1, 2))
        decay = np.diag(np.concatenate([np.zeros(0), *(each[3] for each in oil)]))
        own = np.block(
            [
                [np.zeros((n, n)), np.eye(n), np.zeros_like(left)],
                [-np.linalg.solve(self.mass, np.hstack([stiffness, damping, left]))],
                [place, rate, -decay],
            ]
        )
        spins = np.array(self.turning, dtype=np.int64)
        kept = np.delete(np.arange(len(own)), spins)
        values, states = np.linalg.eig(own[np.ix_(kept, kept)])
        shapes = np.zeros((len(own), len(kept)), dtype=complex)
        shapes[kept] = states
        shapes[spins] = shapes[n + spins]
        return [(complex(value), shapes[:n, i]) for i, value in enumerate(values)]


def modes(
    machine: Oscillator, films: Sequence[DynamicFilm], own: Sequence[DynamicStiffness], omega: float
) -> list[tuple[complex, Complex]]:
    """Eigenvalues in 1/s with their shapes (n,), of pairs the one with positive imaginary part: all that grow, and
    those that decay by less than DAMPED.

    own: the films' dynamic stiffness. None of the machine are eigenvalues at which the projections are not to be
    trusted, at which the films of the two meshes are not the same, and those far from where the iteration began."""
    pairs: list[tuple[complex, Complex]] = []
    for start, shape in machine.starts([film.one for film in films]):
        if start.imag < -NEARLY_REAL * abs(start) or start.real < -DAMPED * abs(omega):
            continue
        value, vector = _iterated(machine, own, start, shape)
        if value.imag < 0.0:
            value, vector = value.conjugate(), vector.conj()
        if not abs(value - start) < MOVED * max(abs(start), abs(omega)) or value.real < -DAMPED * abs(omega):
            continue
        if any(abs(value - other) < EQUAL * abs(value) for other, _ in pairs):
            continue
        if any((np.abs(1.0 + value * film.delays) < POLE).any() for film in own):
            continue
        if all(_trusted(film, value) and _known(film, value) for film in films):
            pairs.append((value, vector))
    return pairs


def followed(
    machine: Oscillator, films: Sequence[DynamicStiffness], known: Sequence[tuple[complex, Complex]]
) -> list[tuple[complex, Complex]]:
    """The eigenvalues of `modes` on other films, those that are known leading to them."""
    refined = [_iterated(machine, films, value, shape) for value, shape in known]
    return [each for each in refined if math.isfinite(each[0].real)]


def place_errors(machine: Oscillator, films: Sequence[DynamicFilm], values: Complex) -> Array:
    """(N,) 1/s by how much eigenvalues (N,) are expected to be off since the films are means over few PLACES.

    Over the place of the cells, which comes round after one cell, Z rises evenly by J and jumps back where a front
    passes into the next cell. The mean over P places misses that by J (1/2 - x) / P, with x as likely anywhere from 0
    to 1: in the square by J^2 / (12 P^2). Neighbours among the places differ by J / P, or by J (1 - 1 / P) across the
    jump: the sum of their squares is J^2 (1 - 1 / P). Several fronts add up in the square."""
    own, errors = [film.own for film in films], np.zeros(len(values))
    for number, s in enumerate(values.tolist()):
        matrix, slope = machine.at(s, own)
        left, _, right = np.linalg.svd(matrix)
        balance, shape = left[:, -1].conj(), right[-1].conj()
        moved = shape.copy()
        moved[list(machine.turning)] /= s  # see Oscillator: of what turns, the shape has the speed
        scale, square = balance @ slope @ shape, 0.0
        for push, journal, film in zip(machine.pushes, machine.journals, films, strict=True):
            for places in film.lying:
                shifts = np.array([balance @ push @ part.at(s)[0] @ journal @ moved for part in places]) / scale
                count = len(places)
                square += float(np.sum(np.abs(shifts - np.roll(shifts, 1)) ** 2)) / (12.0 * count * max(count - 1, 1))
        errors[number] = SPREAD * math.sqrt(square)
    return errors


def _iterated(
    machine: Oscillator, films: Sequence[DynamicStiffness], s: complex, shape: Complex
) -> tuple[complex, Complex]:
    """The eigenvalue that the inverse iteration leads to from s, with its shape; NaN if it leads nowhere."""
    real = abs(s.imag) < EQUAL * abs(s)
    vector: Complex = np.asarray(shape / np.linalg.norm(shape))
    before = math.inf
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
        # round-off may leave more than CLOSE of a slow motion; its steps then no longer fall
        if abs(step) < CLOSE * abs(s) or before <= 2.0 * abs(step) < EQUAL * abs(s):
            return (complex(s.real) if abs(s.imag) < EQUAL * abs(s) else s), vector
        before = abs(step)
    return complex(math.nan, math.nan), vector


def _known(film: DynamicFilm, s: complex) -> bool:
    """Whether the films of both meshes are the same at s: not near a pole, which is the motion of the oil of one mesh.
    By the blocks of forces by displacements and of moments by tilts."""
    own, fine = film.own.at(s)[0], film.fine.at(s)[0]
    blocks = [(slice(first, first + 2),) * 2 for first in range(0, len(own), 2)]
    sizes = [min(np.abs(own[block]).max(), np.abs(fine[block]).max()) for block in blocks]
    return all(np.abs((own - fine)[block]).max() <= KNOWN * size for block, size in zip(blocks, sizes, strict=True))


def _trusted(film: DynamicFilm, s: complex) -> bool:
    if film.exact is None:
        return True
    exact, own = stiffness_at(film.exact, s) + film.summits.at(s)[0], film.one.at(s)[0]
    scale, plain = np.ones(len(exact)), len(exact) // 2 * 2  # of displacements, and of tilts
    for first in range(0, plain, 2):
        scale[first : first + 2] = math.sqrt(np.abs(exact[first : first + 2, first : first + 2]).max())
    own, exact = own / scale[:, None], exact / scale[:, None]
    turned = np.abs(exact[:plain, plain:]).max(axis=0)  # by the angle that both surfaces turn; round-off in the centre
    scale[plain:] = np.maximum(turned, CENTRE * scale[:plain].max())
    own, exact = own / scale, exact / scale
    largest = np.abs(exact).max(axis=1, keepdims=True)
    largest[:plain] = largest[:plain].max()
    return bool((np.abs(own - exact) <= TRUSTED * largest).all())
