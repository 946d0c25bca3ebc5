"""What acts on a rotor beside its films: loads, linear parts of elements, and its speed.

- Loads are in addition to weight and unbalance, and change with the angle of the rotor or with time. A load is two
  columns of forces on all degrees of freedom, each times a factor that is a function of time and angle.
- Linear parts are forces -K d - C d' - M d'' that elements put on the rotor, constant or over its speed.
- The prescribed speed is piecewise linear in time, with the angle that belongs to it.

Equal eigenvalues, motions on a circle and shapes that are symmetric leave to round-off which of them comes first or is
the largest. Numbers that are as near to each other as EQUAL count as one here, and the next rule decides, so that
order and choice are the same on every processor.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex


@dataclass(frozen=True)
class Load:
    """name: which load of the case it is; columns: (2, n) N, or N of each unit of the factors."""

    name: str
    columns: Array

    @property
    def strays(self) -> str:
        """Why it does not repeat with the revolutions of the rotor, empty if it does."""
        return "changes with time and does not repeat, so that no motion under it is periodic"

    @property
    def largest(self) -> Array:
        """(2, n) N: the columns at their largest factors."""
        return self.columns

    def factors(self, t: Array, angle: Array) -> Array:
        """(k, 2) factors of the columns at times (k,) in s and angles (k,) of the rotor in rad."""
        raise NotImplementedError

    def seen_by(self, place: Array) -> Self:
        """A load with columns (2, 2) on a place, on all degrees of freedom; place: (2, n) its x and y by them."""
        return replace(self, columns=self.columns @ place)

    def cut(self, kept: NDArray[np.int64]) -> Self:
        """The load on the degrees of freedom `kept` alone."""
        return replace(self, columns=self.columns[:, kept])


@dataclass(frozen=True)
class Harmonic(Load):
    """The factors cos(theta) and sin(theta) with theta = order alpha + frequency t, alpha the angle of the rotor.

    frequency: rad/s.
    """

    order: float
    frequency: float

    def factors(self, t: Array, angle: Array) -> Array:
        theta = self.order * angle + self.frequency * t
        return np.column_stack([np.cos(theta), np.sin(theta)])

    @property
    def synchronous(self) -> bool:
        """Whether it turns or swings once in a revolution of the rotor."""
        return abs(self.order) == 1.0 and self.frequency == 0.0

    @property
    def strays(self) -> str:
        if self.frequency:
            return "has a frequency of its own, so that no motion under it repeats with a whirl or with the rotor"
        if not self.order.is_integer():
            return "has an order that is no whole number, so that no motion under it repeats with the rotor"
        return ""

    @property
    def turning(self) -> str:
        """Its order or its frequency in words."""
        return f"order {self.order:g}" if self.order else f"{self.frequency / (2.0 * math.pi):g} Hz"

    def excitation(self, omega: float) -> tuple[float, NDArray[np.complex128]]:
        """Frequency in rad/s, not below 0, and (n,) complex amplitudes A in N of the load Re(A exp(i frequency t)) of a
        rotor that turns with omega rad/s."""
        frequency, load = self.order * omega + self.frequency, self.columns[0] - 1j * self.columns[1]
        return (frequency, load) if frequency >= 0.0 else (-frequency, np.conj(load))


BOW = "bow"  # the name of its load


def bow_load(bow: Complex) -> Harmonic:
    """The load of the forces (n,) in N that bend a shaft to its bow in one plane: the bow b, which turns with the
    rotor, replaces K q by K (q - b). Degrees of freedom of x come first, then of y; a bow of angle 0 points to where an
    unbalance of phase 0 does."""
    turning = np.concatenate([1j * bow, bow])
    return Harmonic(BOW, np.array([turning.real, -turning.imag]), 1.0, 0.0)


@dataclass(frozen=True)
class Tabulated(Load):
    """Factors that are cubics of time between the times of a table, and end with it.

    times: (k,) s, ascending; cubics: (k - 1, 2, 4) coefficients of both factors, of powers 0 to 3 of the time since the
    start of a piece.
    """

    times: Array
    cubics: Array

    @property
    def largest(self) -> Array:
        return np.asarray(np.abs(self.factors(self.times, self.times)).max(axis=0)[:, None] * self.columns)

    def factors(self, t: Array, angle: Array) -> Array:  # noqa: ARG002
        piece = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.cubics) - 1)
        powers = (t - self.times[piece])[:, None] ** np.arange(4)
        return np.asarray(np.einsum("kcp,kp->kc", self.cubics[piece], powers))


def linear_table(
    name: str, columns: Array, times: Sequence[float], x: Sequence[float], y: Sequence[float]
) -> Tabulated:
    """The load of a table with factors x and y (k,) at times (k,) in s, linear between them."""
    t, values = np.asarray(times, dtype=float), np.array([x, y], dtype=float)
    cubics = np.zeros((len(t) - 1, 2, 4))
    cubics[:, :, 0], cubics[:, :, 1] = values[:, :-1].T, (np.diff(values) / np.diff(t)).T
    return Tabulated(name, columns, t, cubics)


def loads_at(loads: Sequence[Load], size: int, t: Array, angle: Array) -> Array:
    """(k, size) N of all loads at times (k,) in s and angles (k,) of the rotor in rad then."""
    total = np.zeros((len(t), size))
    for load in loads:
        total += load.factors(t, angle) @ load.columns
    return total


EQUAL = 1e-9  # of the largest size


def ranks(values: Array, size: float | None = None) -> NDArray[np.intp]:
    """(n,) ranks of numbers (n,) in ascending order, from 0; neighbours nearer than EQUAL times `size`, default the
    largest size, share one."""
    if not len(values):
        return np.zeros(0, dtype=np.intp)
    order = np.argsort(values, kind="stable")
    apart = np.diff(values[order]) > EQUAL * (float(np.max(np.abs(values))) if size is None else size)
    ranks_ = np.empty(len(values), dtype=np.intp)
    ranks_[order] = np.concatenate([[0], np.cumsum(apart)])
    return ranks_


def fastest_first(eigenvalues: NDArray[np.complex128]) -> NDArray[np.intp]:
    """(n,) order of eigenvalues by falling real part; those that grow alike in ascending order of the frequency, of a
    pair the one with positive imaginary part first."""
    size = float(np.max(np.abs(eigenvalues), initial=0.0))
    by_frequency = ranks(np.abs(eigenvalues.imag), size)
    return np.lexsort((-eigenvalues.imag, by_frequency, ranks(-eigenvalues.real, size)))


def largest_first(multipliers: NDArray[np.complex128]) -> NDArray[np.intp]:
    """(n,) order of multipliers by falling size; of equal size in ascending order of the angle, of a pair the one with
    positive imaginary part first."""
    by_angle = ranks(np.abs(np.angle(multipliers)), np.pi)
    return np.lexsort((-multipliers.imag, by_angle, ranks(-np.abs(multipliers))))


def first_largest(values: NDArray[np.complex128] | Array) -> int:
    """Index of the largest size: the first one of those that are equal to it."""
    size = np.abs(values)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))


FASTEST = 1e6  # rad/s, above the speed of any rotor


@dataclass(frozen=True)
class LinearPart:
    """Coefficients at s >= 1 speeds of the rotor, linear between them and constant beyond the first and the last.

    speeds: (s,) rad/s, ascending, with the sign of the rotation; stiffness in N/m, damping in N s/m, mass in kg: (s, c,
    c) on the c coordinates that an element sees, or on all degrees of freedom of a rotor. At one speed they are
    constant.
    """

    speeds: Array
    stiffness: Array
    damping: Array
    mass: Array

    @classmethod
    def of(cls, stiffness: Array, damping: Array | None = None, mass: Array | None = None) -> Self:
        """Constant coefficients (c, c); those that are None are 0."""
        given = (np.zeros_like(stiffness) if each is None else each for each in (damping, mass))
        return cls(np.zeros(1), stiffness[None], *(each[None] for each in given))

    @classmethod
    def turning(cls, damping: Array) -> Self:
        """A damping C (n, n) of one plane that turns with the rotor: for v = x + i y the force -C (v' - i Omega v), on
        the x of n degrees of freedom and then their y.

        The term with Omega is a stiffness that couples the planes and feeds forward whirls slower than the rotor. It
        is a line through zero, which ends at FASTEST."""
        both, across = np.kron(np.eye(2), damping), np.kron([[0.0, FASTEST], [-FASTEST, 0.0]], damping)
        stiffness, rates = np.stack([-across, across]), np.stack([both, both])
        return cls(FASTEST * np.array([-1.0, 1.0]), stiffness, rates, np.zeros_like(rates))

    @property
    def constant(self) -> bool:
        """Whether the coefficients do not depend on the speed."""
        return len(self.speeds) == 1

    def at(self, omega: float) -> tuple[Array, Array, Array]:
        """(c, c) stiffness, damping and mass at omega rad/s."""
        place = int(np.searchsorted(self.speeds, omega, side="right")) - 1
        below, above = max(place, 0), min(place + 1, len(self.speeds) - 1)
        width = self.speeds[above] - self.speeds[below]
        share = (omega - self.speeds[below]) / width if place >= 0 and width > 0.0 else 0.0
        stiffness, damping, mass = (
            each[below] + share * (each[above] - each[below]) for each in (self.stiffness, self.damping, self.mass)
        )
        return stiffness, damping, mass

    def seen_by(self, place: Array, count: float = 1.0) -> LinearPart:
        """The part on all degrees of freedom of a machine. place: (c, n) the coordinates that it sees out of the
        machine's; count: of equal elements that it represents."""
        stiffness, damping, mass = (count * (place.T @ each @ place) for each in self._matrices)
        return LinearPart(self.speeds, stiffness, damping, mass)

    def cut(self, kept: NDArray[np.int64]) -> LinearPart:
        """The part of a rotor with its degrees of freedom `kept` alone."""
        return LinearPart(self.speeds, *(each[:, kept[:, None], kept] for each in self._matrices))

    @property
    def _matrices(self) -> tuple[Array, Array, Array]:
        return self.stiffness, self.damping, self.mass


def summed(parts: Sequence[LinearPart]) -> LinearPart | None:
    """All parts of a rotor as one, at the speeds of all of them: the sum of lines between speeds is such a line. None
    without any."""
    if not parts:
        return None
    speeds = np.unique(np.concatenate([part.speeds for part in parts]))
    evaluated = [[part.at(float(omega)) for omega in speeds] for part in parts]
    stiffness, damping, mass = (
        np.sum([[matrices[i] for matrices in rows] for rows in evaluated], axis=0) for i in range(3)
    )
    return LinearPart(speeds, stiffness, damping, mass)


NARROW = 1e-4  # over the largest speed: steps of a table that are not halved any more


def piecewise_linear(at: Callable[[float], Array], speeds: Array, error: float) -> dict[float, Array]:
    """Values of a function at speeds, ascending from the given ones, and at as many between as leave lines between them
    off by no more than `error` of the largest one there."""
    table = {speed: at(speed) for speed in speeds.tolist()}
    spans = list(itertools.pairwise(table))
    while spans:
        low, high = spans.pop()
        middle = 0.5 * (low + high)
        table[middle] = at(middle)
        off = float(np.abs(table[middle] - 0.5 * (table[low] + table[high])).max())
        if off > error * float(np.abs(table[middle]).max()) and high - low > NARROW * speeds[-1]:
            spans += [(low, middle), (middle, high)]
    return dict(sorted(table.items()))


def no_part(size: int) -> LinearPart:
    """At no speed, for a rotor with so many degrees of freedom."""
    nothing = np.zeros((0, size, size))
    return LinearPart(np.zeros(0), nothing, nothing, nothing)


@dataclass(frozen=True)
class SpeedProfile:
    """times: (k,) s, ascending; speeds: (k,) rad/s at these times; angles: (k,) rad."""

    times: Array
    speeds: Array
    angles: Array

    @property
    def end(self) -> float:
        """Time at the end of the profile, s."""
        return float(self.times[-1])

    def speed(self, t: Array) -> Array:
        """Rotor speed in rad/s at the times t (n,)."""
        return np.interp(t, self.times, self.speeds)

    def rotation(self, t: float) -> tuple[float, float, float]:
        """Angular acceleration in rad/s^2, speed in rad/s and angle in rad at the time t; at a kink, just after it."""
        piece = min(max(int(np.searchsorted(self.times, t, side="right")) - 1, 0), len(self.times) - 2)
        acceleration, speed, angle = rotation(self.times, self.speeds, self.angles, piece, t)
        return float(acceleration), float(speed), float(angle)

    def angle(self, t: float) -> float:
        """Angle of the rotor in rad at the time t."""
        return self.rotation(t)[2]

    def with_stops(self, times: Iterable[float]) -> SpeedProfile:
        """The same speeds with additional points at the times in s that lie within the profile."""
        kinks = [t for t in times if self.times[0] < t < self.times[-1]]
        t = np.union1d(self.times, np.array(kinks))
        return speed_profile(t.tolist(), self.speed(t).tolist())

    def until(self, t: float) -> SpeedProfile:
        """The profile up to one of its own times, s."""
        kept = slice(int(np.searchsorted(self.times, t, side="right")))
        return SpeedProfile(self.times[kept], self.speeds[kept], self.angles[kept])


def speed_profile(times: list[float], speeds: list[float]) -> SpeedProfile:
    """Profile through the given speeds (rad/s) at the given times (s), linear in between."""
    t, omega = np.asarray(times, dtype=float), np.asarray(speeds, dtype=float)
    angles = np.concatenate([[0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * np.diff(t))])
    return SpeedProfile(t, omega, angles)


def rotation(times: Array, speeds: Array, angles: Array, piece: int, t: float) -> tuple[float, float, float]:
    """Angular acceleration, speed and angle at the time t inside the given piece of a profile."""
    start = t - times[piece]
    acceleration = (speeds[piece + 1] - speeds[piece]) / (times[piece + 1] - times[piece])
    speed = speeds[piece] + acceleration * start
    return acceleration, speed, angles[piece] + start * (speeds[piece] + 0.5 * acceleration * start)
