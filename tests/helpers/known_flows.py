"""Motions whose cycles are known, in place of the time loop: what shooting asks of PeriodMap, by Runge and Kutta."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np

from frbcli.cycles.shooting.period_map import SAMPLES, Passage, Wet

Array = np.ndarray
NO_OIL = np.zeros((1, 1, 1))


@dataclass(frozen=True)
class KnownFlow:
    """rate: (4,) of a state z (4,) at a speed; its first two numbers are the displacement, told over `scale`; after:
    (z, omega, step, count) to the state after so many steps, compiled where more of them are needed."""

    rate: Callable[[Array, float], Array]
    scale: float = 1.0
    after: Callable[[Array, float, float, int], Array] | None = None
    system: SimpleNamespace = field(
        default_factory=lambda: SimpleNamespace(rotor=SimpleNamespace(size=2), ring_count=0, spins=(), names=("film",))
    )
    limit: float = 0.99
    smooth: bool = False
    places: tuple[float, ...] = ()
    held: Array = field(default_factory=lambda: np.ones(1))
    slow: int = 4
    size: int = 4
    driven: float = 0.0

    def wet(self, z: Array, omega: float) -> Wet:
        return Wet(z[:2].copy(), z[2:].copy(), self.rate(z, omega), NO_OIL, NO_OIL, NO_OIL, NO_OIL[0, 0])

    def packed(self, wet: Wet, omega: float) -> Array:
        return np.concatenate([wet.q, 2.0 * wet.v / omega]) / self.scale

    def unpacked(self, x: Array, near: Wet, omega: float) -> Wet:
        return replace(near, q=x[:2] * self.scale, v=0.5 * omega * x[2:] * self.scale)

    def motion_of(self, wet: Wet, omega: float) -> Array:
        return np.concatenate([wet.a[:2], 2.0 * wet.a[2:] / omega]) / self.scale

    def middles(self, d: Array) -> Array:
        return d

    def states_on(self, _: KnownFlow, states: Array) -> Array:
        return states

    def wet_on(self, _: KnownFlow, wet: Wet, __: float) -> Wet:
        return wet

    def lying(self, _: float) -> KnownFlow:
        return self

    def moved(self, wet: Wet, _: float) -> Wet:
        return wet

    def passage(self, wet: Wet, time: float, omega: float, steps: int, samples: int = SAMPLES) -> Passage:
        """In steps that hold a whole number of samples' spans."""
        count = math.ceil(steps / samples)
        z, places = np.concatenate([wet.q, wet.v]), [wet.q / self.scale]
        for _ in range(samples):
            z = (self.after or self.stepped)(z, omega, time / (samples * count), count)
            places.append(z[:2] / self.scale)
        return Passage(self.wet(z, omega), np.array(places)[:, None])

    def stepped(self, z: Array, omega: float, h: float, count: int) -> Array:
        for _ in range(count):
            a = self.rate(z, omega)
            b = self.rate(z + 0.5 * h * a, omega)
            c = self.rate(z + 0.5 * h * b, omega)
            z = z + h / 6.0 * (a + 2.0 * (b + c) + self.rate(z + h * c, omega))
        return z


def round_cycles(decay: Callable[[float], tuple[float, float]], turn: float, twisted: bool) -> KnownFlow:
    """The displacement whirls on a circle of the radius sqrt(mu) / 2 with half of the speed, mu = omega - 1. About it
    the other two numbers u keep to themselves: they decay with decay(omega) and turn with `turn` times the whirl, along
    axes that stand still or, twisted, turn by pi in a period. With a whirl of period T the multipliers of u are
    exp((decay + i turn omega / 2) T), twisted and without a turn -exp(decay T)."""

    def rate(z: Array, omega: float) -> Array:
        x, y, u = z[0], z[1], z[2:]
        nu, square = 0.5 * omega, 4.0 * (x * x + y * y)
        grows = omega - 1.0 - square
        first, second = decay(omega)
        if twisted and square > 0.0:
            c, s = 2.0 * x / math.sqrt(square), 2.0 * y / math.sqrt(square)
            mean, half = 0.5 * (first + second), 0.5 * (first - second)
            du = (mean + half * c) * u[0] + half * s * u[1], (mean - half * c) * u[1] + half * s * u[0]
            spin = 0.5 * nu
        else:
            du, spin = (first * u[0], second * u[1]), turn * nu
        return np.array([grows * x - nu * y, grows * y + nu * x, du[0] - spin * u[1], du[1] + spin * u[0]])

    return KnownFlow(rate)
