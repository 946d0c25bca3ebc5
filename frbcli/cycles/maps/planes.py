"""The planes of stability maps: the rotor speed and a number of the case, or two numbers of the case at one speed.

Unknowns of curves end with the first number over its largest value and the second one over its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.branch import FoldFollower
from frbcli.cycles.diagram import Walk, over_speed
from frbcli.cycles.family import Family
from frbcli.cycles.method.equilibria import OverSpeed, resting_curve
from frbcli.cycles.over_key import KeyFollower, resting_over
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.result import SPEED

Array = NDArray[np.float64]

FAMILIES = 8  # that are kept, of values of the second number


class MapPlane(Protocol):
    """over, unit: name and unit of the first number, which times `scale` is in it; by_difference: places of the numbers
    from the end that derivatives are differences by; shaded: values of the second number at which the growth at rest
    is told."""

    @property
    def over(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def scale(self) -> float: ...
    @property
    def by_difference(self) -> tuple[int, ...]: ...
    @property
    def shaded(self) -> int: ...

    @property
    def corners(self) -> tuple[Array, Array]:
        """The lowest and the highest of both numbers."""

    def machine(self, y: Array) -> Machine:
        """The machine at unknowns that end with both numbers."""

    def cycle(self, y: Array) -> Array:
        """The unknowns with the speed of the rotor over the pace in place of both numbers."""

    def walk(self, share: float) -> Walk:
        """Over the first number at a value of the second. Raises NotConverged, Unreachable."""


@dataclass(frozen=True)
class SpeedPlane:
    """family: over the second number; speeds: rad/s; shares: of the largest value of the second number."""

    family: Family
    speeds: tuple[float, float]
    shares: tuple[float, float]
    over: str = SPEED
    unit: str = "Hz"
    by_difference: tuple[int, ...] = (-1,)
    shaded: int = 41

    @property
    def scale(self) -> float:
        """Hz."""
        return self.family.omega / (2.0 * math.pi)

    @property
    def corners(self) -> tuple[Array, Array]:
        """As Plane says."""
        low, high = ((speed / self.family.omega, share) for speed, share in zip(self.speeds, self.shares, strict=True))
        return np.array(low), np.array(high)

    def machine(self, y: Array) -> Machine:
        """As Plane says."""
        return self.family.machine(float(y[-1]))

    def cycle(self, y: Array) -> Array:
        """As Plane says."""
        return y[:-1]

    def walk(self, share: float) -> Walk:
        """As Plane says."""
        machine = self.family.machine(share)
        resting = resting_curve(self.family.system(share), machine, *self.speeds)
        return over_speed(OverSpeed(machine), resting, FoldFollower(machine, *self.speeds))


@dataclass(frozen=True)
class KeyPlane:
    """first: the machines over the first number at the largest value of the second; second: that number; lowest: of
    both over their largest values."""

    first: Family
    second: Family
    lowest: tuple[float, float]
    by_difference: tuple[int, ...] = (-2, -1)
    shaded: int = 15
    _beside: dict[float, Family] = field(default_factory=dict)

    @property
    def over(self) -> str:
        """The first key."""
        return self.first.key

    @property
    def unit(self) -> str:
        """Of the first number."""
        return self.first.unit

    @property
    def scale(self) -> float:
        """The largest value of the first number."""
        return self.first.high

    @cached_property
    def corners(self) -> tuple[Array, Array]:
        """As Plane says."""
        return np.array(self.lowest), np.ones(2)

    def family(self, share: float) -> Family:
        """The machines over the first number at a value of the second."""
        if share not in self._beside:
            if len(self._beside) >= FAMILIES:
                self._beside.pop(next(iter(self._beside)))
            self._beside[share] = self.first.beside(self.second.setting(share))
        return self._beside[share]

    def machine(self, y: Array) -> Machine:
        """As Plane says."""
        return self.family(float(y[-1])).machine(float(y[-2]))

    def cycle(self, y: Array) -> Array:
        """As Plane says."""
        return np.append(y[:-2], self.first.omega / self.machine(y).pace)

    def walk(self, share: float) -> Walk:
        """As Plane says."""
        family = self.family(share)
        lowest = self.lowest[0]
        return Walk(family.key, family, resting_over(family, lowest), family.high, _KeyFoldFollower(family, lowest))


class _KeyFoldFollower(FoldFollower, KeyFollower):
    """Follows branches over a key whose folds alone are asked for."""
