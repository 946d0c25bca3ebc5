"""Whirls with the unbalance in films on cells, as closed curves that the map over a period of the rotor maps onto
themselves (period_map.py).

Seen once in each period of the rotor, a motion of two frequencies nu and Omega is a point x(a) of a closed curve that
moves on by rho = nu / Omega of a turn, M(x(a)) = x(a + 2 pi rho). The curve has N points at equal phases a, and is a
trigonometric polynomial between them, so that turned back by S(rho) it is a fixed point,

    x = S(rho) M(x),

with a shift of a excluded by <dx_0/da, x - x_0> = 0. As in fixed_point.py the derivative of M is taken in the slow
motions alone: at each point those of the rotor, and what of the oil of a film moves along with them one period later.
The rest of the oil is repeated, and stays in a film for a few periods: next to half the speed, where two turns of the
curve nearly close, what it leaves of a correction is enlarged so much that repetition alone does not end. Each step
therefore is the combination of the last corrections that leaves least (Anderson, J. ACM 12, 1965).

The eigenvalues of the derivative lie on circles about 0, one for each Lyapunov exponent, and those of smooth
disturbances tell their radii: one is 1, of a shift of a, and the motion is stable if no other one is above 1. For them
the oil is followed over three periods: with one of them the radius of the shift is known to 3 % only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.shooting.fixed_point import DIFFERENCE
from frbcli.cycles.shooting.period_map import STEPS_PER_REVOLUTION, Passage, PeriodMap, Wet
from frbcli.cycles.shooting.shots import BLURRED, WIDE, Shooting, Shot

POINTS = (33, 65, 129)  # of a curve, odd: the number is raised until the last harmonics are small
PER_CELL = 2  # least points over the cells around of films with oil: where its edge crosses cells, the curve bends
TAIL, TAIL_AT_MOST = 1e-4, 1e-3  # of a displacement over the clearance in the last eighth of the harmonics
ITERATIONS = 30
CLOSE, NOISE = 3e-6, 1e-4  # corrections of the rotor that end the iteration: always, and if they become no smaller
PATIENCE = 4  # iterations in which corrections have to become half of what they were
RENEWED = 2  # times that the derivative is computed
REMEMBERED, INDEPENDENT = 12, 1e-8  # corrections that are combined, and the smallest singular value of those that count
STRAY = 0.5  # a correction beyond which the iteration is given up
NEW = 0.01  # oil that moves along with the rotor by less is not a direction of its own
FOR_STEPS, FOR_RADII = 1, 3  # periods over which the oil that moves along with the rotor is followed
SMOOTH, LOW = 0.9, 6  # share of a disturbance in the lowest N / LOW harmonics from which on it is smooth


@dataclass(frozen=True)
class InvariantCurve:
    """wets: the machine at N equal phases; states: (N, n) x; rho: turns of the whirl in a turn of the rotor; omega:
    rad/s; displacements: (N, SAMPLES + 1, J, 2) over the period behind each point, see Passage; radii: of the circles
    on which multipliers lie, by falling size, that of a shift among them."""

    wets: tuple[Wet, ...]
    states: Array
    rho: float
    omega: float
    displacements: Array
    radii: Array

    @property
    def stable(self) -> bool:
        """Whether all disturbances decay."""
        shift = int(np.argmin(np.abs(self.radii - 1.0)))
        others = np.delete(self.radii, shift)
        return bool(np.all(others < 1.0 + max(BLURRED, abs(self.radii[shift] - 1.0))))

    @property
    def largest(self) -> Array:
        """(J,) largest eccentricity."""
        fine = between(len(self.states), 2.0 * np.pi * np.arange(8 * len(self.states)) / (8 * len(self.states)))
        found = np.tensordot(fine, self.displacements, axes=1)
        return np.asarray(np.hypot(found[..., 0], found[..., 1]).max(axis=(0, 1)))

    def harmonics(self, displacements: Array) -> tuple[NDArray[np.int64], Complex]:
        """(l, 2) orders (j, k) and (l, ...) harmonics u of displacements (N, SAMPLES + 1, ...), which are the sum of
        u exp(i (j a + k b)) and of what is conjugate to it; a, b: phases of the whirl and of the rotor."""
        found, count = displacements[:, :-1], len(displacements)
        samples, rest = found.shape[1], (1,) * (found.ndim - 2)
        j = np.fft.fftfreq(count, 1.0 / count).round().astype(int)
        k = np.fft.fftfreq(samples, 1.0 / samples).round().astype(int)
        by_j = np.fft.fft(found, axis=0, norm="forward")
        turned = np.exp(-2j * np.pi * self.rho * np.outer(j, np.arange(samples)) / samples)
        both = np.fft.fft(by_j * turned.reshape(*turned.shape, *rest), axis=1, norm="forward")
        orders = np.array([(one, other) for one in j for other in k])
        half = (orders[:, 1] > 0) | ((orders[:, 1] == 0) & (orders[:, 0] >= 0))
        return orders[half], both.reshape(len(orders), *found.shape[2:])[half]


def between(count: int, phases: Array, slope: bool = False) -> Array:
    """(len(phases), count) matrix that gives a curve of an odd number of equal phases, or its slope, at others."""
    orders = np.arange(1, (count - 1) // 2 + 1)
    apart = (phases[:, None] - 2.0 * np.pi * np.arange(count) / count)[..., None] * orders
    if slope:
        return np.asarray(-2.0 / count * (np.sin(apart) @ orders))
    return np.asarray((1.0 + 2.0 * np.cos(apart).sum(axis=-1)) / count)


def along_cycle(shooting: Shooting, shot: Shot) -> tuple[tuple[Wet, ...], float]:
    """The machine at the first number of POINTS of equal phases of a cycle, and rho. Raises Unreachable."""
    omega, time, count = shooting.unit * math.exp(shot.p[1]), math.exp(shot.p[0]) / shooting.unit, POINTS[0]
    wets = [shot.wet]
    while len(wets) < count:
        wets.append(shooting.flow.passage(wets[-1], time / count, omega, math.ceil(shot.steps / count), 1).end)
    return tuple(wets), 2.0 * math.pi / (time * omega)


def combined(known: list[tuple[Array, Array]]) -> Array:
    """The unknowns behind a step, of the last ones and their corrections (n,): where a linear correction of what they
    differ by is smallest."""
    (at, correction), count = known[-1], len(known)
    if count == 1:
        return at + correction
    before = [np.transpose([known[i][part] - known[i - 1][part] for i in range(1, count)]) for part in (0, 1)]
    shares = np.linalg.lstsq(before[1], correction, rcond=INDEPENDENT)[0]
    return np.asarray(at + correction - (before[0] + before[1]) @ shares)


class _Curves:
    """Finds the curve of a machine at a speed in rad/s. unit: of its states, rad/s."""

    def __init__(self, flow: PeriodMap, unit: float, omega: float) -> None:
        self.flow, self.unit, self.omega = flow, unit, omega

    def passage(self, x: Array, near: Wet) -> Passage:
        wet = self.flow.unpacked(x, near, self.unit)
        return self.flow.passage(wet, 2.0 * math.pi / self.omega, self.omega, STEPS_PER_REVOLUTION)

    def image(self, x: Array, near: Wet) -> Array:
        return self.flow.packed(self.passage(x, near).end, self.unit)

    def changed(self, x: Array, near: Wet, directions: Array, by: float) -> Array:
        """(n, k) what the map makes of directions (n, k) at a state."""
        return np.transpose([
            (self.image(x + by * each, near) - self.image(x - by * each, near)) / (2.0 * by) for each in directions.T
        ])  # fmt: skip

    def slow(
        self, states: Array, near: tuple[Wet, ...], turn: Array, gap: float, generations: int
    ) -> tuple[Array, Array]:
        """(N, n, k) slow motions at each point, of length 1 or 0, and what the map makes of them: those of the rotor,
        and of the oil as often as `generations` says what the last ones have moved one period later. turn: S(rho)."""
        slow, by = self.flow.slow, DIFFERENCE * min(1.0, max(gap, 0.0) / WIDE)
        rotor = np.eye(states.shape[1])[:, :slow]
        images = np.array([self.changed(x, wet, rotor, by) for x, wet in zip(states, near, strict=True)])
        directions, moved = np.broadcast_to(rotor, images.shape), images
        for _ in range(generations if self.flow.held.any() else 0):
            oil = np.tensordot(turn, moved, axes=1)
            oil[:, :slow] = 0.0
            outside = oil - directions @ (directions.transpose(0, 2, 1) @ oil)
            along, sizes, _ = np.linalg.svd(outside, full_matrices=False)
            some = sizes.max(axis=0) > NEW
            if not some.any():
                break
            along = (along * (sizes > NEW)[:, None, :])[..., some]
            change = [self.changed(x, wet, each, by) for x, wet, each in zip(states, near, along, strict=True)]
            directions = np.concatenate([directions, along], axis=2)
            images = np.concatenate([images, np.array(change)], axis=2)
            moved = images @ (directions.transpose(0, 2, 1) @ oil)
        return directions, images

    def solved(self, wets: tuple[Wet, ...], states: Array, rho: float) -> InvariantCurve | None:
        """The curve next to a guess; None if it does not converge. Raises Unreachable."""
        count, slow = len(states), self.flow.slow
        phases = 2.0 * np.pi * np.arange(count) / count
        row = (between(count, phases, slope=True) @ states)[:, :slow]
        first, sizes, renewed, age = states, [np.inf], 0, 0
        directions = images = np.zeros((0, 0, 0))
        known: list[tuple[Array, Array]] = []
        for _ in range(ITERATIONS):
            passages = [self.passage(x, wet) for x, wet in zip(states, wets, strict=True)]
            found = np.array([self.flow.packed(each.end, self.unit) for each in passages])
            orbits = np.array([each.displacements for each in passages])
            gap = 1.0 - float(np.hypot(orbits[..., 0], orbits[..., 1]).max())
            turn = between(count, phases - 2.0 * np.pi * rho)
            turned = turn @ found
            by_rho = -2.0 * np.pi * between(count, phases - 2.0 * np.pi * rho, slope=True) @ found
            residual = turned - states
            stays = age > PATIENCE and sizes[-1] > 0.5 * min(sizes[:-PATIENCE])
            if sizes[-1] < CLOSE or (stays and min(sizes) < NOISE):
                return InvariantCurve(wets, states, rho, self.omega, orbits, np.zeros(0))
            if stays and renewed == RENEWED:
                return None
            if renewed == 0 or stays:
                directions, images = self.slow(states, wets, turn, gap, FOR_STEPS)
                renewed, age, known = renewed + 1, 0, []
            reduced = np.einsum("ina,ij,jnb->iajb", directions, turn, images, optimize=True)
            k = directions.shape[2]
            matrix = np.eye(count * k + 1)
            matrix[:-1, :-1] -= reduced.reshape(count * k, count * k)
            matrix[:-1, -1] = -np.einsum("ina,in->ia", directions, by_rho).ravel()
            matrix[-1, :-1] = np.einsum("in,ina->ia", row, directions[:, :slow]).ravel()
            matrix[-1, -1] = 0.0
            right = np.append(
                np.einsum("ina,in->ia", directions, residual).ravel(), -np.sum(row * (states - first)[:, :slow])
            )
            answer = np.linalg.solve(matrix, right)
            step, on = answer[:-1].reshape(count, k), float(answer[-1])
            change = residual + np.einsum("ij,jna,ja->in", turn, images, step, optimize=True) + by_rho * on
            if not np.isfinite(change).all() or np.abs(change[:, :slow]).max() > STRAY:
                return None
            known = [*known[-REMEMBERED:], (np.append(states, rho), np.append(change, on))]
            there = combined(known)
            states, rho = there[:-1].reshape(states.shape), float(there[-1])
            beside = np.round(np.arange(count) - count * rho).astype(int) % count
            wets = tuple(passages[each].end for each in beside)
            sizes.append(float(np.abs(change[:, :slow]).max()))
            age += 1
        return None

    def with_radii(self, curve: InvariantCurve) -> InvariantCurve:
        """A curve with the moduli of the eigenvalues of smooth disturbances, by falling size. Raises Unreachable."""
        count, orbits = len(curve.states), curve.displacements
        gap = 1.0 - float(np.hypot(orbits[..., 0], orbits[..., 1]).max())
        phases = 2.0 * np.pi * np.arange(count) / count
        turn = between(count, phases - 2.0 * np.pi * curve.rho)
        directions, images = self.slow(curve.states, curve.wets, turn, gap, FOR_RADII)
        k = directions.shape[2]
        reduced = np.einsum("ina,ij,jnb->iajb", directions, turn, images, optimize=True)
        values, vectors = np.linalg.eig(reduced.reshape(count * k, count * k))
        waves = np.abs(np.fft.fft(vectors.reshape(count, k, -1), axis=0)) ** 2
        waves = waves.sum(axis=1)
        low = np.abs(np.fft.fftfreq(count, 1.0 / count)) <= count / LOW
        smooth = waves[low].sum(axis=0) > SMOOTH * waves.sum(axis=0)
        return replace(curve, radii=np.sort(np.abs(values[smooth]))[::-1])


def invariant_curve(
    flow: PeriodMap, unit: float, omega: float, start: tuple[tuple[Wet, ...], float]
) -> InvariantCurve | None:
    """The curve next to machines at equal phases and rho, with as many points as it needs; None if it is not found."""
    wets, rho = start
    states = np.array([flow.packed(wet, unit) for wet in wets])
    curves = _Curves(flow, unit, omega)
    enough = min(PER_CELL * flow.held.shape[1], POINTS[-1]) if flow.held.any() else 0
    found = None
    try:
        for count in POINTS:
            if count != len(states):
                phases = 2.0 * np.pi * np.arange(count) / count
                places = np.round(phases / (2.0 * np.pi) * len(wets)).astype(int) % len(wets)
                wets, states = tuple(wets[each] for each in places), between(len(states), phases) @ states
            found = curves.solved(wets, states, rho)
            if found is None or (_tail(found) < TAIL and count >= enough):
                break
            wets, states, rho = found.wets, found.states, found.rho
        return None if found is None or _tail(found) > TAIL_AT_MOST else curves.with_radii(found)
    except (Unreachable, np.linalg.LinAlgError):
        return None


def _tail(curve: InvariantCurve) -> float:
    """The largest displacement over the clearance in the last eighth of the harmonics."""
    sizes = np.abs(np.fft.rfft(curve.displacements[:, 0], axis=0, norm="forward")).max(axis=(1, 2))
    return float(sizes[-(len(sizes) // 8 + 1) :].max())
