"""Linear parts of a rotor: forces -K d - C d' - M d'' that elements put on it, constant or over its speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

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
        """The part on all degrees of freedom of a machine. place: (c, n) the coordinates that it sees out of those of
        the machine; count: of equal elements that it stands for."""
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
    found = [[part.at(float(omega)) for omega in speeds] for part in parts]
    stiffness, damping, mass = (
        np.sum([[matrices[i] for matrices in rows] for rows in found], axis=0) for i in range(3)
    )
    return LinearPart(speeds, stiffness, damping, mass)


def no_part(size: int) -> LinearPart:
    """At no speed, for a rotor with so many degrees of freedom."""
    nothing = np.zeros((0, size, size))
    return LinearPart(np.zeros(0), nothing, nothing, nothing)
