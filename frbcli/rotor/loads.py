"""Loads on a machine that change with the angle of its rotor or with time, beside those of the unbalance.

A load is two columns of forces on all degrees of freedom, each times a factor that is a function of time and angle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array


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
