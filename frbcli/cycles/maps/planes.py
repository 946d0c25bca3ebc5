"""The planes of stability maps: the rotor speed and a number of the case, or two numbers of the case at one speed.

Unknowns of curves end with the first number over its largest value and the second one over its own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache
from typing import ClassVar

import numpy as np

from frbcli.arrays import Array
from frbcli.cycles.diagram import Walk
from frbcli.cycles.family import Family
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.equilibria import resting_curve
from frbcli.cycles.method.follower import FoldFollower
from frbcli.cycles.over_key import resting_over
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.result import SPEED, hertz

FAMILIES = 8  # that are kept, of values of the second number


class MapPlane(ABC):
    """over, unit: name and unit of the first number, which times `scale` is in it; second: the machines over the second
    number; corners: the lowest and the highest of both numbers; by_difference: places of the numbers from the end that
    derivatives are differences by; shaded: values of the second number at which the growth at rest is computed."""

    by_difference: ClassVar[tuple[int, ...]]
    shaded: ClassVar[int]

    def __init__(self, over: str, unit: str, scale: float, second: Family, corners: tuple[Array, Array]) -> None:
        self.over, self.unit, self.scale, self.second, self.corners = over, unit, scale, second, corners

    @abstractmethod
    def machine(self, y: Array) -> Machine:
        """The machine at unknowns that end with both numbers."""

    @abstractmethod
    def cycle(self, y: Array) -> Array:
        """The unknowns with the speed of the rotor over the pace instead of both numbers."""

    @abstractmethod
    def walk(self, share: float) -> Walk:
        """Over the first number at a value of the second. Raises NotConverged, Unreachable."""


class SpeedPlane(MapPlane):
    """The speed of the rotor, between two in rad/s, and a number from a share of its largest value on."""

    by_difference, shaded = (-1,), 41

    def __init__(self, second: Family, speeds: tuple[float, float], lowest: float) -> None:
        slowest, fastest = (speed / second.speed for speed in speeds)
        corners = np.array([slowest, lowest]), np.array([fastest, 1.0])
        super().__init__(SPEED, "Hz", hertz(second.speed), second, corners)
        self.speeds = speeds

    def machine(self, y: Array) -> Machine:
        """See MapPlane."""
        return self.second.machine_at(float(y[-1]))

    def cycle(self, y: Array) -> Array:
        """See MapPlane."""
        return y[:-1]

    def walk(self, share: float) -> Walk:
        """See MapPlane."""
        machine, lowest = self.second.machine_at(share), float(self.corners[0][0])
        resting = resting_curve(self.second.system(share), machine, *self.speeds)
        return Walk(resting, FoldFollower(MachineCourse(machine), lowest))


class KeyPlane(MapPlane):
    """Two numbers at one speed. first: the machines over the first one at the largest value of the second; lowest: of
    both over their largest values."""

    by_difference, shaded = (-2, -1), 15

    def __init__(self, first: Family, second: Family, lowest: tuple[float, float]) -> None:
        super().__init__(first.over, first.unit, first.high, second, (np.array(lowest), np.ones(2)))
        self._omega, self._lowest = first.speed, lowest[0]
        self._family = lru_cache(FAMILIES)(lambda share: first.with_setting(second.setting(share)))

    def machine(self, y: Array) -> Machine:
        """See MapPlane."""
        return self._family(float(y[-1])).machine_at(float(y[-2]))

    def cycle(self, y: Array) -> Array:
        """See MapPlane."""
        return np.append(y[:-2], self._omega / self.machine(y).pace)

    def walk(self, share: float) -> Walk:
        """See MapPlane."""
        family, lowest = self._family(share), self._lowest
        return Walk(resting_over(family, lowest), FoldFollower(family, lowest))
