"""Free modes of a rotor, whirling modes on isotropic springs, and what a reduction to the lowest modes leaves out.

With the free modes as coordinates c, both planes joined to c = c_x + i c_y, a rotor on springs obeys

    c'' - i Omega G c' + (diag(omega_k^2) + sum of s p p^T) c = 0

with the modes' displacements p at a spring of stiffness s. For c = u exp(i omega t) and the velocity w = omega u this
is a symmetric eigenvalue problem, also where a rigid body can move freely:

    omega [w, e] = [[Omega G, B], [B^T, 0]] [w, e],    B B^T the stiffness, e = B^T u.

omega > 0 is a forward whirl, omega < 0 a backward one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import NotConverged
from frbcli.rotor.beam import Plane

Array = NDArray[np.float64]

RIGID = 2  # modes of a rigid body in one plane: translation, tilt
STILL = 1e-9  # of the fastest mode: slower motions are none
COMPARED = 3  # whirling modes of each direction whose frequencies a reduction is judged by
# Degrees of freedom of a plane whose modes are all computed; of more, the slowest MOST: dense matrices
# of a thousand sections would take minutes.
DENSE, MOST = 600, 240


@dataclass(frozen=True)
class FreeModes:
    """The lowest n modes of a free rotor at rest, of one plane, with unit modal mass.

    positions: (k,) m; frequencies: (n,) rad/s, ascending, the first two zero; shapes: (k, n) displacements in
    1/sqrt(kg): the first a translation, the second a tilt about the centre of mass; slopes: (k, n) in 1/(m sqrt(kg));
    polar: (n, n) inertia about the axis of rotation in these modes, internal: (n, n) 1/s, damping that turns with the
    shaft. weight: (n,) sqrt(kg), the modes' share of a uniform acceleration.
    """

    positions: Array
    frequencies: Array
    shapes: Array
    slopes: Array
    polar: Array
    internal: Array
    weight: Array

    def at(self, position: float) -> Array:
        """(n,) displacements of the modes at the node nearest to a position in m."""
        return np.asarray(self.shapes[self._node(position)], dtype=np.float64)

    def slope_at(self, position: float) -> Array:
        """(n,) slopes of the modes at the node nearest to a position in m."""
        return np.asarray(self.slopes[self._node(position)], dtype=np.float64)

    def _node(self, position: float) -> int:
        return int(np.argmin(np.abs(self.positions - position)))

    def lowest(self, count: int) -> FreeModes:
        """The lowest `count` modes."""
        return FreeModes(
            self.positions,
            self.frequencies[:count],
            self.shapes[:, :count],
            self.slopes[:, :count],
            self.polar[:count, :count],
            self.internal[:count, :count],
            self.weight[:count],
        )

    def below(self, cutoff: float) -> int:
        """How many modes are not faster than a cut-off in rad/s."""
        return int(np.count_nonzero(self.frequencies <= cutoff))


@dataclass(frozen=True)
class WhirlModes:
    """Undamped whirling modes. frequencies: (r,) rad/s, ascending in absolute value, negative where the whirl is
    backward; coordinates: (n, r) in the free modes, each of unit length."""

    frequencies: Array
    coordinates: Array

    def directed(self, sign: int) -> Array:
        """Absolute frequencies in rad/s of the forward (sign 1) or backward (-1) modes, ascending."""
        return np.abs(self.frequencies[self.frequencies * sign > 0])


@dataclass(frozen=True)
class ReductionError:
    """What a reduction leaves out. missing_flexibility: (b, b) m/N between the bearings, of one plane;
    full, reduced: (r,) rad/s of the slowest forward, then backward modes on the given springs."""

    missing_flexibility: Array
    full: Array
    reduced: Array

    @property
    def frequency(self) -> float:
        """Largest relative error of these frequencies."""
        return float(np.max(np.abs(self.reduced / self.full - 1)))


def free_modes(plane: Plane) -> FreeModes:
    """The modes of a free rotor at rest: all, or of a plane with many degrees of freedom the slowest MOST.

    Raises NotConverged if rounding leaves none: where masses or stiffnesses differ by too many powers of ten.
    """
    from scipy.linalg import eigh

    try:
        if len(plane.positions) * 2 <= DENSE:
            squares, vectors = eigh(plane.stiffness.toarray(), plane.mass.toarray())
        else:
            squares, vectors = _slowest(plane)
    except (np.linalg.LinAlgError, RuntimeError, ValueError) as error:
        raise NotConverged(f"The modes of the free rotor cannot be computed: {error}.") from None
    frequencies = np.sqrt(np.maximum(squares, 0.0))
    # A solver finds the motions of the rigid body mixed and to round-off only; they are known.
    frequencies[:RIGID], vectors[:, :RIGID] = 0.0, _rigid_motions(plane)
    uniform = _uniform(plane)
    internal = _symmetric(vectors.T @ (plane.internal @ vectors))
    internal[:RIGID] = internal[:, :RIGID] = 0.0  # a motion that does not bend is not damped
    return FreeModes(
        plane.positions,
        frequencies,
        np.asarray(vectors[::2], dtype=np.float64),
        np.asarray(vectors[1::2], dtype=np.float64),
        _symmetric(vectors.T @ (plane.polar @ vectors)),
        internal,
        np.asarray(vectors.T @ (plane.mass @ uniform), dtype=np.float64),
    )


def _slowest(plane: Plane) -> tuple[Array, Array]:
    """Squares of the frequencies (MOST,), ascending, and the modes (2 k, MOST), by Lanczos' method around a negative
    square: there the matrix of a free rotor is not singular."""
    from scipy.sparse.linalg import eigsh

    # The least that a bending rotor of its mass and length may have, by Rayleigh's quotient of a parabola.
    bent = np.column_stack([plane.positions**2, 2.0 * plane.positions]).ravel()
    square = float(bent @ (plane.stiffness @ bent)) / float(bent @ (plane.mass @ bent))
    start = np.random.default_rng(0).standard_normal(len(bent))  # the same modes at every call, to the last digit
    squares, vectors = eigsh(plane.stiffness, MOST, plane.mass, sigma=-square, v0=start)
    order = np.argsort(squares)
    return squares[order], vectors[:, order]


def whirl_modes(modes: FreeModes, springs: Array, stiffness: Array, omega: float) -> WhirlModes:
    """Whirling modes at omega rad/s. springs: (b, n) the modes' displacements there; stiffness: (b,) N/m, isotropic."""
    n = len(modes.frequencies)
    elastic = np.diag(modes.frequencies)[:, RIGID:]
    root = np.hstack([elastic, (np.sqrt(stiffness)[:, None] * springs).T])
    size = n + root.shape[1]
    matrix = np.zeros((size, size))
    matrix[:n, :n] = omega * modes.polar
    matrix[:n, n:] = root
    matrix[n:, :n] = root.T
    values, vectors = np.linalg.eigh(matrix)
    moving = np.abs(values) > STILL * np.max(np.abs(values))
    order = np.argsort(np.abs(values[moving]), kind="stable")
    coordinates = vectors[:n, moving][:, order]
    return WhirlModes(values[moving][order], coordinates / np.linalg.norm(coordinates, axis=0))


def reduction_error(modes: FreeModes, count: int, springs: Array, stiffness: Array, omega: float) -> ReductionError:
    """The error of keeping only the lowest `count` of all modes; the other arguments as in `whirl_modes`."""
    left_out = springs[:, count:] / modes.frequencies[count:]
    full = whirl_modes(modes, springs, stiffness, omega)
    reduced = whirl_modes(modes.lowest(count), springs[:, :count], stiffness, omega)
    pairs = [(full.directed(sign)[:COMPARED], reduced.directed(sign)[:COMPARED]) for sign in (1, -1)]
    shortest = [min(len(a), len(b)) for a, b in pairs]
    return ReductionError(
        left_out @ left_out.T,
        np.concatenate([a[:n] for (a, _), n in zip(pairs, shortest, strict=True)]),
        np.concatenate([b[:n] for (_, b), n in zip(pairs, shortest, strict=True)]),
    )


def _symmetric(matrix: Array) -> Array:
    """A matrix that is symmetric but for round-off, which would make work."""
    return np.asarray(0.5 * (matrix + matrix.T), dtype=np.float64)


def _uniform(plane: Plane) -> Array:
    return np.tile([1.0, 0.0], len(plane.positions))


def _rigid_motions(plane: Plane) -> Array:
    """(2 k, 2) translation and tilt about the centre of mass, with unit modal mass."""
    translation = _uniform(plane)
    moment = plane.mass @ translation
    tilt = np.column_stack([plane.positions, np.ones_like(plane.positions)]).ravel()
    tilt -= (moment @ tilt) / (moment @ translation) * translation
    motions = np.column_stack([translation, tilt])
    return np.asarray(motions / np.sqrt(np.sum(motions * (plane.mass @ motions), axis=0)), dtype=np.float64)
