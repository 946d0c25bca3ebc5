"""Limit cycles of machines whose films keep their oil: found by shooting, and followed by their arc length in speed.

A cycle is a fixed point of the map of the time loop over its period (period_map.py). Beside the state x, the period and
the speed are unknowns, p = (ln(T unit), ln(Omega / unit)); the cycle is held in time by a phase condition, and on
the branch by the plane across the tangent.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.cycles.branch import ASKED, AT_REST, FLIP, FOLD, LEFT, TORUS
from frbcli.cycles.continuation import Unreachable
from frbcli.cycles.floquet import Multipliers
from frbcli.cycles.period_map import STEPS_PER_REVOLUTION, Passage, PeriodMap, Wet
from frbcli.cycles.result import hertz
from frbcli.cycles.shooting import DIFFERENCE, Conditions, SlowSpace, direction_along, fixed_point, ritz, slow_space

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

FIRST, SHORTEST, LONGEST = 0.1, 2e-3, 0.15  # steps along a branch
MOST_POINTS = 80
LONGER, STRAIGHT, SHARPEST = 1.5, 0.98, 0.8  # growth of a step where tangents differ by little; by most
SMALL = 0.02  # amplitude over the clearance below which a branch has come back to rest
# The differences and the cells leave so much of a multiplier.
BLURRED = 5e-3
WIDE = 0.2  # smallest gap from which on disturbances have their full size
REFINED = 6  # evaluations that locate a special point


@dataclass(frozen=True)
class Shot:
    """A cycle. x, p: see above, at the start of the period; wet: the machine there; displacements: see Passage; space:
    slow motions about it; tangent: (N + 2,) of the branch; multipliers; kind: of a special one, else ""."""

    x: Array
    p: Array
    wet: Wet
    displacements: Array
    space: SlowSpace
    tangent: Array
    multipliers: Multipliers
    kind: str = ""

    @property
    def eccentricity_max(self) -> Array:
        """(F,)."""
        return np.asarray(np.hypot(self.displacements[:, :, 0], self.displacements[:, :, 1]).max(axis=0))

    @property
    def amplitude(self) -> float:
        """Half of the largest width of the orbit over the clearance."""
        return float(0.5 * np.ptp(self.displacements, axis=0).max())


@dataclass(frozen=True)
class Rest:
    """A resting position. x, wet: its state; omega: rad/s; displacement: (F, 2); rates: (k,) 1/s by which slow motions
    grow, and their states (N, k)."""

    x: Array
    wet: Wet
    omega: float
    displacement: Array
    rates: Complex
    states: Complex

    @property
    def whirling(self) -> int | None:
        """Number of the rate that oscillates and grows fastest, None without one."""
        oscillating = np.flatnonzero(self.rates.imag > 0.05 * self.omega)
        return int(oscillating[np.argmax(self.rates[oscillating].real)]) if len(oscillating) else None

    @property
    def growth(self) -> float:
        """Its real part, 1/s."""
        number = self.whirling
        return float(self.rates[number].real) if number is not None else -math.inf

    @property
    def stable(self) -> bool:
        """Whether every slow motion decays."""
        return bool(np.all(self.rates.real < 0.0))


class Shooting:
    """Finds cycles and resting positions of one machine. unit: rad/s, of speeds and frequencies."""

    def __init__(self, flow: PeriodMap, unit: float) -> None:
        self.flow, self.unit = flow, unit

    def speed_Hz(self, shot: Shot) -> float:
        """The rotor speed of a cycle."""
        return math.exp(float(shot.p[1])) * hertz(self.unit)

    def rest(self, near: Wet, omega: float) -> Rest | None:
        """The resting position at a speed, as a fixed point of the map over half a revolution: whirls of up to the
        speed of the rotor have frequencies of their own in it. None if it does not converge."""
        time, none = math.pi / omega, np.zeros(0)
        asked = _Asked(self, near, STEPS_PER_REVOLUTION // 2)

        def mapped(x: Array, _: Array) -> Array:
            return asked.image(x, time, omega)

        try:
            x = self.flow.packed(near, self.unit)
            space = slow_space(mapped, x, none, self._first(x))
            free = Conditions(np.zeros((0, len(x))), np.zeros((0, 0)))
            found = fixed_point(mapped, x, none, space, free)
            if found is None:
                return None
            x, _, _ = found
            asked.settle(x)
            space = slow_space(mapped, x, none, self._first(x))
        except Unreachable:
            return None
        values, states = ritz(space)
        decaying = np.maximum(np.abs(values), 1e-12)
        rates = (np.log(decaying) + 1j * np.angle(values)) / time
        return Rest(x, asked.near, omega, asked.passage.displacements.mean(axis=0), rates, states)

    def stepped(self, shot: Shot, length: float) -> Shot | None:
        """The cycle behind a step along the tangent; None if it is not found."""
        size = len(shot.x)
        row = np.stack([self._phase(shot.wet), shot.tangent[:size]])
        conditions = Conditions(row, np.stack([np.zeros(2), shot.tangent[size:]]))
        return self._found(
            shot, shot.x + length * shot.tangent[:size], shot.p + length * shot.tangent[size:], conditions
        )

    def at_speed(self, shot: Shot, other: Shot, omega: float) -> Shot | None:
        """The cycle at a speed in rad/s between two, found from the nearer one's slow motions or from the other's."""
        size = len(shot.x)
        share = (math.log(omega / self.unit) - shot.p[1]) / (other.p[1] - shot.p[1])
        x, p = shot.x + share * (other.x - shot.x), shot.p + share * (other.p - shot.p)
        for one in (shot, other) if share < 0.5 else (other, shot):
            row = np.stack([self._phase(one.wet), np.zeros(size)])
            found = self._found(one, x, p, Conditions(row, np.array([[0.0, 0.0], [0.0, 1.0]])))
            if found is not None:
                return found
        return None

    def from_rest(self, rest: Rest, length: float) -> Shot | None:
        """The cycle of a small size beside a Hopf point."""
        number = rest.whirling
        if number is None:
            return None
        mode, nu, size = rest.states[:, number], rest.rates[number].imag, len(rest.x)
        along, across = mode.real / np.linalg.norm(mode.real), -mode.imag
        across = across - along * (along @ across)
        p = np.log([2.0 * math.pi / nu * self.unit, rest.omega / self.unit])
        guess = rest.x + length * along
        tangent = np.concatenate([along, np.zeros(2)])
        rows = np.stack([across / np.linalg.norm(across), along])
        start = Shot(
            rest.x, p, rest.wet, np.zeros((1, 1, 2)), SlowSpace(np.zeros((size, 0)), np.zeros((size, 0)),
            np.zeros((size, 2))), tangent, Multipliers(np.ones(1, dtype=complex), 0.0),
        )  # fmt: skip
        try:
            asked = _Asked(self, rest.wet, 2 * STEPS_PER_REVOLUTION)
            space = slow_space(asked.at, guess, p, self._first(guess))
        except Unreachable:
            return None
        return self._found(replace(start, space=space), guess, p, Conditions(rows, np.zeros((2, 2))))

    def _found(self, shot: Shot, x: Array, p: Array, conditions: Conditions) -> Shot | None:
        asked = _Asked(self, shot.wet, 2 * STEPS_PER_REVOLUTION)
        try:
            found = fixed_point(asked.at, x, p, shot.space, conditions)
            if found is None:
                return None
            x, p, _ = found
            asked.settle(x)
            passage, wet = asked.passage, asked.near
            gap = 1.0 - float(np.hypot(passage.displacements[:, :, 0], passage.displacements[:, :, 1]).max())
            by = DIFFERENCE * min(1.0, max(gap, 0.0) / WIDE)
            space = slow_space(asked.at, x, p, self._first(x), by)
        except Unreachable:
            return None
        phase = self._phase(wet)
        tangent = direction_along(space, phase, shot.tangent)
        return Shot(x, p, wet, passage.displacements, space, tangent, _multipliers(space, phase))

    def _phase(self, wet: Wet) -> Array:
        """The direction in which a state moves in time, of the rotor alone."""
        found = self.flow.motion_of(wet, self.unit)
        return found / float(np.linalg.norm(found))

    def _first(self, x: Array) -> Array:
        """(N, 2 n) unit states of the rotor."""
        size = 2 * self.flow.system.rotor.size - self.flow.system.ring_count
        return np.eye(len(x))[:, :size]


class _Asked:
    """The map as shooting asks for it; near: the machine whose guesses the next evaluation takes; passage: the last."""

    def __init__(self, shooting: Shooting, near: Wet, steps: int) -> None:
        self.shooting, self.near, self.steps = shooting, near, steps
        self.passage: Passage

    def image(self, x: Array, time: float, omega: float) -> Array:
        flow, unit = self.shooting.flow, self.shooting.unit
        self.passage = flow.passage(flow.unpacked(x, self.near, unit), time, omega, self.steps)
        return flow.packed(self.passage.end, unit)

    def at(self, x: Array, p: Array) -> Array:
        unit = self.shooting.unit
        return self.image(x, math.exp(p[0]) / unit, math.exp(p[1]) * unit)

    def settle(self, x: Array) -> None:
        """Take the guesses of the last evaluation, which has ended where it began, for the next."""
        self.near = self.shooting.flow.unpacked(x, self.passage.end, self.shooting.unit)


def _multipliers(space: SlowSpace, phase: Array) -> Multipliers:
    values, states = ritz(space)
    near = np.abs(values - 1.0) < 0.2
    along = np.where(near, np.abs(phase @ states) / np.linalg.norm(states, axis=0), -1.0)
    trivial = int(np.argmax(along))
    others = np.delete(values, trivial)
    return Multipliers(np.concatenate([values[trivial : trivial + 1], others]), max(
        BLURRED, float(abs(values[trivial] - 1.0))))  # fmt: skip


def follow_shots(
    shooting: Shooting,
    start: Shot,
    speeds: tuple[float, float],
    asked: Sequence[float] = (),
    observe: Callable[[Shot], None] | None = None,
) -> tuple[tuple[Shot, ...], str]:
    """The cycles of a branch from one on, special ones among them, and why it ends. speeds: lowest and highest, and
    asked: those at which cycles are computed exactly, in rad/s."""
    shots, length = [start], FIRST
    limit = shooting.flow.control.contact_eccentricity
    lowest, highest = (math.log(speed / shooting.unit) for speed in speeds)
    while len(shots) < MOST_POINTS:
        shot = shots[-1]
        found = _next(shooting, shot, length)
        while found is None and length > SHORTEST:
            length *= 0.5
            found = _next(shooting, shot, length)
        if found is None:
            last = shooting.speed_Hz(shot)
            return tuple(shots), f"It could not be followed beyond {last:.4g} Hz: the steps became too short."
        if observe is not None:
            observe(found)
        if not lowest <= found.p[1] <= highest:
            limit_speed = speeds[0] if found.p[1] < lowest else speeds[1]
            end = shooting.at_speed(shot, found, limit_speed)
            return (*shots, *([] if end is None else [end])), LEFT
        shots += [*special_shots(shooting, shot, found, length, asked), found]
        if found.amplitude < SMALL:
            return tuple(shots), AT_REST
        if found.eccentricity_max.max() > limit:
            return tuple(shots), f"The journal meets its shell, at an eccentricity of {limit}."
        if shot.tangent @ found.tangent > STRAIGHT:
            length = min(LONGER * length, LONGEST)
    return tuple(shots), f"It was followed over {MOST_POINTS} cycles and goes on."


def special_shots(shooting: Shooting, shot: Shot, after: Shot, length: float, asked: Sequence[float]) -> list[Shot]:
    """Folds, flips, torus points and cycles at speeds asked for within a step."""
    found: list[Shot] = []
    fold = shot.tangent[-1] * after.tangent[-1] < 0.0
    if fold:
        there = _located(shooting, shot, after, length, lambda one: float(one.tangent[-1]))
        found.append(replace(there, kind=FOLD))
    change = abs(after.multipliers.unstable - shot.multipliers.unstable)
    worse = max(shot, after, key=lambda one: one.multipliers.unstable)
    outside = worse.multipliers.others[: worse.multipliers.unstable]
    turning = bool(len(outside)) and abs(outside[-1].imag) > 0.05 * abs(outside[-1])
    if change > 0 and (turning or (bool(len(outside)) and outside[-1].real < 0.0)):
        few = shot.multipliers.unstable
        there = _located(shooting, shot, after, length, lambda one: 0.5 - float(one.multipliers.unstable != few))
        found.append(replace(there, kind=TORUS if turning else FLIP))
    for speed in () if fold else asked:
        if min(shot.p[1], after.p[1]) < math.log(speed / shooting.unit) <= max(shot.p[1], after.p[1]):
            there_too = shooting.at_speed(shot, after, speed)
            found += [] if there_too is None else [replace(there_too, kind=ASKED)]
    return sorted(found, key=lambda one: abs(one.p[1] - shot.p[1]))


def _next(shooting: Shooting, shot: Shot, length: float) -> Shot | None:
    found = shooting.stepped(shot, length)
    return None if found is None or found.tangent @ shot.tangent < SHARPEST else found


def _located(shooting: Shooting, shot: Shot, after: Shot, length: float, told: Callable[[Shot], float]) -> Shot:
    """The cycle within a step at which a number changes its sign: between the ends by halves of the straight line."""
    low, high, at_low, at_high = 0.0, length, told(shot), told(after)
    best = shot if abs(at_low) < abs(at_high) else after
    for _ in range(REFINED):
        share = min(max(at_low / (at_low - at_high), 0.1), 0.9)
        middle = low + share * (high - low)
        there = shooting.stepped(shot, middle)
        if there is None:
            break
        value = told(there)
        if abs(value) <= abs(told(best)):
            best = there
        if value * at_low > 0.0:
            low, at_low = middle, value
        else:
            high, at_high = middle, value
    return best
