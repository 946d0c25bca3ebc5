"""Free modes of a rotor, whirling modes on isotropic springs, and what a reduction to the lowest modes leaves out.

With the free modes as coordinates c, both planes joined to c = c_x + i c_y, a rotor on springs obeys

    c'' - i Omega G c' + (diag(omega_k^2) + sum of s p p^T) c = 0

with the modes' displacements p at a spring of stiffness s. For c = u exp(i omega t) and the velocity w = omega u this
is a symmetric eigenvalue problem, also where a rigid body can move freely:

    omega [w, e] = [[Omega G, B], [B^T, 0]] [w, e],    B B^T the stiffness, e = B^T u.

omega > 0 is a forward whirl, omega < 0 a backward one.

A force at a place also bends the rotor in the modes that a reduction leaves out, at once and by their static
flexibility. Static modes of the places where bearings and unbalances act have this bending (residual attachment modes:
MacNeal, Computers & Structures 1, 1971; Rubin, AIAA Journal 13, 1975). They are combined so that they look like further
free modes: a rotor in soft bearings at its ends then needs few of these.

A turbocharger's rotor (2.1.3): rigid wheels on an elastic shaft, reduced to its lowest free modes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.errors import NotConverged
from frbcli.rotor.assembly import Body, unbalance_loads
from frbcli.rotor.beam import BeamSection, Plane, beam

RIGID = 2  # modes of a rigid body in one plane: translation, tilt
STILL = 1e-9  # of the fastest mode: slower motions are none
DEPENDENT = 1e-6  # size of a static mode over the largest, below which it is one of the others
COUNTS = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 28)  # of free modes that a reduction is tried with
EXACT = 40  # free modes of what reductions are compared with
STIFFNESSES = np.logspace(-3.0, 2.0, 6)  # of a bearing, over that on which a rigid rotor has its top speed as frequency
ABOVE = 1.2  # times the top speed: a mode a little above it is felt below
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
    shaft, damping: (n, n) 1/s, that which does not. weight: (n,) sqrt(kg), the modes' share of a uniform acceleration.
    """

    positions: Array
    frequencies: Array
    shapes: Array
    slopes: Array
    polar: Array
    internal: Array
    damping: Array
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
            self.damping[:count, :count],
            self.weight[:count],
        )

    def below(self, cutoff: float) -> int:
        """How many modes are not faster than a cut-off in rad/s."""
        return int(np.count_nonzero(self.frequencies <= cutoff))


@dataclass(frozen=True)
class PointForces:
    """Forces (k,) in N on places of a shaft, in one plane, complex by their angles on the rotor. positions: (k,) m."""

    positions: tuple[float, ...]
    forces: tuple[complex, ...]

    def of(self, modes: FreeModes) -> Complex:
        """(n,) N of modes."""
        return np.asarray(np.array(self.forces) @ np.stack([modes.at(place) for place in self.positions]))


def bending_forces(modes: FreeModes, positions: Sequence[float], offsets: Sequence[complex]) -> PointForces:
    """The forces that bend a free shaft to offsets (k,) in m at distinct positions (k,) in m: of all shapes through
    these the one of least energy, which is the shape of a shaft loaded there alone. modes: all of it."""
    at, count = np.stack([modes.at(place) for place in positions]), len(positions)
    bent = at[:, RIGID:] / modes.frequencies[RIGID:]
    flexibility, rigid = bent @ bent.T, at[:, :RIGID]
    size = flexibility.max()
    whole = np.block([[flexibility / size, rigid], [rigid.T, np.zeros((RIGID, RIGID))]])
    forces = np.linalg.solve(whole, np.concatenate([np.asarray(offsets), np.zeros(RIGID)]))[:count] / size
    return PointForces(tuple(positions), tuple(forces.tolist()))


@dataclass(frozen=True)
class Places:
    """Where a rotor is loaded: positions in m of its bearings, its wheels, and collars, which are held in tilt; bow:
    the forces that bend it without load."""

    bearings: tuple[float, ...]
    wheels: tuple[float, ...]
    collars: tuple[float, ...] = ()
    bow: PointForces | None = None

    def of(self, modes: FreeModes) -> Array:
        """(p, n) displacements of modes at bearings and wheels, their slopes at collars, and the shares of the bow."""
        slopes = [modes.slope_at(collar) for collar in self.collars]
        rows = [*(modes.at(place) for place in (*self.bearings, *self.wheels)), *slopes]
        if self.bow is not None:
            shares = self.bow.of(modes) / max(map(abs, self.bow.forces))
            rows += [shares.real, shares.imag]
        return np.stack(rows)


@dataclass(frozen=True)
class Reduction:
    """A reduced rotor: its modes, and the largest relative changes of its critical speeds and of the height of the
    peaks there; bearings: the stiffness of the bearings for which this holds, in words."""

    modes: FreeModes
    free: int
    frequency: float
    amplitude: float
    bearings: str = "bearings of any stiffness"

    @property
    def words(self) -> str:
        """What it keeps, and what it changes."""
        kept = len(self.modes.frequencies)
        static = f" and {kept - self.free} static ones of bearings and disks" if kept > self.free else ""
        if math.isnan(self.frequency):
            return f"{self.free} free modes{static} of each plane, whose error is not known: nothing holds the shaft"
        speeds, peaks = (f"{float(f'{100.0 * each:.1g}'):g} %" for each in (self.frequency, self.amplitude))
        return (
            f"{self.free} free modes{static} of each plane: critical speeds are off by at most {speeds}, "
            f"heights of peaks by at most {peaks}, on {self.bearings}"
        )


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
    internal, bending = (_symmetric(vectors.T @ (each @ vectors)) for each in (plane.internal, plane.bending_damping))
    for each in (internal, bending):  # a motion that does not bend is not damped
        each[:RIGID] = each[:, :RIGID] = 0.0
    return FreeModes(
        plane.positions,
        frequencies,
        np.asarray(vectors[::2], dtype=np.float64),
        np.asarray(vectors[1::2], dtype=np.float64),
        _symmetric(vectors.T @ (plane.polar @ vectors)),
        internal,
        bending + _symmetric(vectors.T @ (plane.mass_damping @ vectors)),
        np.asarray(vectors.T @ (plane.mass @ uniform), dtype=np.float64),
    )


def modes_of_plane(mass: Array, stiffness: Array, positions: Array, places: Array) -> FreeModes:
    """The modes of a rotor that does not tilt: mass, stiffness (n, n) of one plane, places (k, n) its displacements."""
    from scipy.linalg import eigh

    squares, vectors = eigh(stiffness, mass)
    squares[squares < STILL * squares.max(initial=0.0)] = 0.0
    shapes, none = np.asarray(places @ vectors, dtype=np.float64), np.zeros_like(mass)
    weight = np.abs(vectors.T @ mass @ np.ones(len(mass)))
    frequencies, slopes = np.sqrt(np.maximum(squares, 0.0)), np.zeros_like(shapes)
    return FreeModes(positions, frequencies, shapes, slopes, none, none, none, weight)


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
    elastic = np.diag(modes.frequencies)[:, modes.frequencies > 0.0]
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


def with_static_modes(modes: FreeModes, count: int, places: Places) -> FreeModes:
    """The lowest `count` of all modes and the static modes of places, as far as they differ, as modes of unit mass."""
    left = places.of(modes)[:, count:] / modes.frequencies[count:]  # by the energy of its bending
    if left.shape[1] == 0:
        return modes
    shapes, sizes, _ = np.linalg.svd(left.T, full_matrices=False)
    bent = shapes[:, sizes > DEPENDENT * sizes[0]] / modes.frequencies[count:, None]
    squares, turns = np.linalg.eigh(bent.T @ bent)  # of the inverse frequencies, ascending
    squares, turns = squares[::-1], turns[:, ::-1]
    basis = np.zeros((len(modes.frequencies), count + len(squares)))
    basis[:count, :count] = np.eye(count)
    basis[count:, count:] = bent @ turns / np.sqrt(squares)
    return FreeModes(
        modes.positions,
        np.append(modes.frequencies[:count], 1.0 / np.sqrt(squares)),
        modes.shapes @ basis,
        modes.slopes @ basis,
        _symmetric(basis.T @ modes.polar @ basis),
        _symmetric(basis.T @ modes.internal @ basis),
        _symmetric(basis.T @ modes.damping @ basis),
        modes.weight @ basis,
    )


def reduction(modes: FreeModes, places: Places, top: float, target: float) -> Reduction:
    """The smallest reduction with static modes whose changes are within a target, up to the speed `top` in rad/s."""
    exact = with_static_modes(modes, min(EXACT, len(modes.frequencies)), places)
    for count in COUNTS:
        model = judged(with_static_modes(modes, min(count, len(modes.frequencies)), places), exact, places, top, count)
        if max(model.frequency, model.amplitude) <= target:
            break
    return model


def judged(
    reduced: FreeModes, exact: FreeModes, places: Places, top: float, free: int, springs: Array | None = None
) -> Reduction:
    """A reduced rotor with its changes against one that is nearly exact: of critical speeds up to ABOVE times `top` in
    rad/s, at least the lowest one, forward and backward. The peak at i by an unbalance at j in slightly damped bearings
    is in proportion to u_i u_j over the work of the bearings, sum of s u_b^2. springs: (b,) N/m of the bearings, by
    default any."""
    changes = np.zeros(2)
    if len(set(places.bearings)) < RIGID:
        return Reduction(reduced, free, float(changes[0]), float(changes[1]))
    usual = exact.weight[0] ** 2 * max(top, exact.frequencies[RIGID]) ** 2 / len(places.bearings)
    for stiffness in np.outer(usual * STIFFNESSES, np.ones(len(places.bearings))) if springs is None else [springs]:
        for sign in (-1.0, 1.0):
            try:
                own, other = (_criticals(each, places, stiffness, sign) for each in (reduced, exact))
            except np.linalg.LinAlgError:  # neither bearings nor shaft hold all modes
                return Reduction(reduced, free, math.nan, math.nan)
            count = min(len(own[0]), max(1, int(np.count_nonzero(other[0] <= ABOVE * top))))
            speeds = np.abs(own[0][:count] / other[0][:count] - 1.0)
            sizes = np.abs(other[1][:count]).max(axis=(1, 2))
            peaks = np.abs(own[1][:count] - other[1][:count]).max(axis=(1, 2)) / sizes
            changes = np.maximum(changes, [speeds.max(), peaks.max()])
    return Reduction(reduced, free, float(changes[0]), float(changes[1]))


def _criticals(modes: FreeModes, places: Places, stiffness: Array, sign: float) -> tuple[Array, Array]:
    """Critical speeds (r,) in rad/s, ascending, of forward (sign -1) or backward whirls on springs (b,) in N/m, and
    what the height of a peak is in proportion to, (r, p, p)."""
    from scipy.linalg import eigh

    seen = places.of(modes)[: len(places.bearings) + len(places.wheels)]
    held = seen[: len(places.bearings)]
    inverse, motions = eigh(
        np.eye(len(modes.frequencies)) + sign * modes.polar,
        np.diag(modes.frequencies**2) + held.T @ (stiffness[:, None] * held),
    )
    order = np.flatnonzero(inverse > 0.0)[::-1]
    moved = seen @ motions[:, order]
    work = stiffness @ moved[: len(places.bearings)] ** 2
    return 1.0 / np.sqrt(inverse[order]), np.einsum("ir,jr->rij", moved, moved) / work[:, None, None]


def reduction_error(
    modes: FreeModes, reduced: FreeModes, held: Callable[[FreeModes], Array], stiffness: Array, omega: float
) -> ReductionError:
    """The error of a reduction of all modes on springs. held: (b, n) displacements of modes at the springs; stiffness:
    (b,) N/m, isotropic; omega: rad/s."""
    springs, own = held(modes), held(reduced)
    full, less = (whirl_modes(each, at, stiffness, omega) for each, at in ((modes, springs), (reduced, own)))
    pairs = [(full.directed(sign)[:COMPARED], less.directed(sign)[:COMPARED]) for sign in (1, -1)]
    shortest = [min(len(a), len(b)) for a, b in pairs]
    return ReductionError(
        _flexibility(modes, springs) - _flexibility(reduced, own),
        np.concatenate([a[:n] for (a, _), n in zip(pairs, shortest, strict=True)]),
        np.concatenate([b[:n] for (_, b), n in zip(pairs, shortest, strict=True)]),
    )


def _flexibility(modes: FreeModes, springs: Array) -> Array:
    """(b, b) m/N of the bending modes between places with displacements (b, n)."""
    known = np.maximum(modes.frequencies, math.sqrt(np.finfo(float).eps) * modes.frequencies[-1])  # of their squares
    bent = springs[:, RIGID:] / known[RIGID:]
    return np.asarray(bent @ bent.T)


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


@dataclass(frozen=True)
class Wheel:
    """A rigid body on the shaft. position in m; mass in kg; inertias about the axis of rotation and about a diameter in
    kg m^2; unbalance in kg m; phase: its angle on the rotor in rad."""

    name: str
    position: float
    mass: float
    polar_inertia: float
    diametral_inertia: float
    unbalance: float
    phase: float


@dataclass(frozen=True)
class Journal:
    """The place of a bearing, with a film or without one. position: of its middle, m."""

    name: str
    position: float


def wheels_on_shaft(sections: Sequence[BeamSection], wheels: Sequence[Wheel], journals: Sequence[Journal]) -> Plane:
    """The free rotor in one plane, with nodes at all wheels and journals."""
    from scipy.sparse import diags_array

    places = [wheel.position for wheel in wheels] + [journal.position for journal in journals]
    shaft = beam(sections, places)
    mass, polar = np.zeros((2, 2 * len(shaft.positions)))  # diagonals
    for wheel in wheels:
        v = 2 * shaft.node(wheel.position)
        mass[v : v + 2] += wheel.mass, wheel.diametral_inertia
        polar[v + 1] += wheel.polar_inertia
    heavier, turning = shaft.mass + diags_array(mass), shaft.polar + diags_array(polar)
    return replace(shaft, mass=heavier.tocsc(), polar=turning.tocsc())


def turbocharger_rotor(
    modes: FreeModes,
    wheels: Sequence[Wheel],
    journals: Sequence[Journal],
    modal_damping: float,
    external_damping: float,
    gravity: float,
    collars: Sequence[Journal] = (),
    bow: PointForces | None = None,
) -> Body:
    """The rotor in the given modes, which are its degrees of freedom: n of the x-plane, then n of the y-plane.

    journals: the places of all bearings, with a film or without one; collars: of thrust bearings. modal_damping: ratio
    to the critical damping of every elastic mode; external_damping: of each wheel against the ground, N s/m; gravity in
    m/s^2. bow: the forces that bend a shaft to the shape that it has without load. """
    n = len(modes.frequencies)
    both, turned = np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])
    damping = modes.damping + np.diag(2 * modal_damping * modes.frequencies)
    unbalance_cos, unbalance_sin = np.zeros(2 * n), np.zeros(2 * n)
    for wheel in wheels:
        shape = modes.at(wheel.position)
        damping += external_damping * np.outer(shape, shape)
        cos, sin = unbalance_loads(wheel.unbalance, wheel.phase, shape)
        unbalance_cos += cos
        unbalance_sin += sin
    tilting = [(f"journal_{each.name}", each.position) for each in journals]
    tilting += [(each.name, each.position) for each in collars]
    nodes = [
        (name, np.vstack([_of(both, modes.at(position)), _of(-turned, modes.slope_at(position))]))
        for name, position in tilting
    ]
    nodes += [(f"disk_{wheel.name}", _of(both, modes.at(wheel.position))) for wheel in wheels]
    return Body(
        mass=np.eye(2 * n),
        damping=_of(both, damping),
        gyroscopic=_of(turned, modes.polar),
        stiffness=_of(both, np.diag(modes.frequencies**2)),
        static_load=np.concatenate([np.zeros(n), -gravity * modes.weight]),
        unbalance_cos=unbalance_cos,
        unbalance_sin=unbalance_sin,
        nodes=tuple(nodes),
        inertia=_of(both, modes.weight[None, :]),
        internal=modes.internal if modes.internal.any() else None,
        bow=None if bow is None else bow.of(modes),
    )


def _of(planes: Array, modes: Array) -> Array:
    """Both planes, coupled by `planes` (2, 2), out of the modes of one."""
    return np.asarray(np.kron(planes, modes), dtype=np.float64)
