"""Limit cycles and static equilibria of machines on the time loop, found by shooting.

A cycle is a fixed point of the map of the time loop over its period (period_map.py). Besides the state x, the period
and the speed are unknowns, p = (ln(T unit), ln(Omega / unit)); the cycle is held in time by a phase condition, and on a
branch by the plane across the direction of the last step (branch.py). With unbalance the phase condition is replaced by
T Omega = 2 pi, the period of the rotor: the unbalance holds the motion in time.

Cells that turn with the oil hardly move against a whirl of half the speed: a cycle depends a little on how they lie at
its start. In a run they pass all places in turn, within some ten periods. A cycle is therefore stated as the mean over
several places of the cells; the scatter of these is part of the error of the cells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.columns import hertz
from frbcli.cycles.method.balance import Multipliers
from frbcli.cycles.method.continuation import Unreachable, halved_until, unit_vector
from frbcli.cycles.shooting.fixed_point import (
    CLOSE,
    DIFFERENCE,
    Conditions,
    SlowSpace,
    direction_along,
    fixed_point,
    ritz,
    slow_space,
)
from frbcli.cycles.shooting.period_map import STEPS_PER_REVOLUTION, Passage, PeriodMap, Wet
from frbcli.equilibrium import hopf
from frbcli.rotor.loads import largest_first

# The differences and the cells leave so much of a multiplier; differences without cells, and by what they disturb.
BLURRED, SMOOTH_BLUR, SMOOTH_DIFFERENCE = 5e-3, 2e-5, 1e-5
SLOWEST = 0.05  # frequency over the speed above which a slow motion at rest is a whirl
REMEMBERED = 0.1  # multiplier of a motion that is looked for again in the next cycle
AT_REST_DIFFERENCE = 2e-2  # by which states with oil are disturbed at rest: the kinks blur less, and the gap is wide
DOUBLE = 0.02  # distance of a second multiplier from 1 below which both are separated by their sum
WIDE = 0.2  # smallest gap from which on disturbances have their full size
SMALLEST_SHARE = 1.0 / 32.0  # of the unbalance in a step


@dataclass(frozen=True)
class Shot:
    """A cycle. x, p: see above, at the start of the period; wet: the machine there; displacements: see Passage;
    space: slow motions about it; tangent: (N + 2,) of the branch; multipliers; steps: of the period; others:
    (p, displacements) with the cells in other PLACES; kind: of a special one, else ""."""

    x: Array
    p: Array
    wet: Wet
    displacements: Array
    space: SlowSpace
    tangent: Array
    multipliers: Multipliers
    steps: int
    others: tuple[tuple[Array, Array], ...] = ()
    kind: str = ""

    @property
    def mean_p(self) -> Array:
        """(2,) mean over the places of the cells."""
        return np.asarray(np.mean([self.p, *(p for p, _ in self.others)], axis=0))

    @property
    def orbits(self) -> tuple[Array, ...]:
        """(SAMPLES + 1, J, 2) displacements with the cells in each place."""
        return (self.displacements, *(orbit for _, orbit in self.others))

    @property
    def eccentricity_max(self) -> Array:
        """(J,) mean over the places of the cells."""
        return np.asarray(np.mean([largest(orbit) for orbit in self.orbits], axis=0))

    @property
    def blur(self) -> Array:
        """(2,) by how much p differs between places of the cells."""
        return np.asarray(np.ptp([self.p, *(p for p, _ in self.others)], axis=0))

    @property
    def amplitude(self) -> float:
        """Half of the largest width of the orbit over the clearance."""
        return float(0.5 * np.ptp(self.displacements, axis=0).max())


@dataclass(frozen=True)
class Rest:
    """A static equilibrium. x, wet: its state; omega: rad/s; displacement: (J, 2), see PeriodMap; eigenvalues: (k,) 1/s
    of slow motions, and their states (N, k)."""

    x: Array
    wet: Wet
    omega: float
    displacement: Array
    eigenvalues: Complex
    states: Complex

    @property
    def value(self) -> float:
        """Speed of the rotor in rad/s."""
        return self.omega

    @property
    def whirls(self) -> NDArray[np.int64]:
        """Numbers of the eigenvalues of whirls, by falling growth."""
        return hopf.whirls(self.eigenvalues, SLOWEST * self.omega)

    @property
    def growing(self) -> int:
        """How many whirls grow."""
        return int(np.count_nonzero(self.eigenvalues[self.whirls].real > 0.0))

    @property
    def nearest_to_neutral(self) -> int:
        """Number of the eigenvalue of the whirl that grows or decays most slowly."""
        return int(self.whirls[np.argmin(np.abs(self.eigenvalues[self.whirls].real))])

    def growth_of(self, number: int) -> float:
        """Growth in 1/s of the whirl number 0, 1, ... by falling growth, -inf if there are not as many."""
        return hopf.growth_of(self.eigenvalues, number, SLOWEST * self.omega)

    @property
    def stable(self) -> bool:
        """Whether every slow motion decays."""
        return bool(np.all(self.eigenvalues.real < 0.0))


class Shooting:
    """Finds cycles and static equilibria of one machine, or, where its unbalance acts, synchronous motions. unit: of
    speeds and frequencies, in rad/s."""

    def __init__(self, flow: PeriodMap, unit: float) -> None:
        self.flow, self.unit = flow, unit

    @property
    def free(self) -> bool:
        """Whether the period is of a whirl, not of the rotor."""
        return self.flow.driven == 0.0

    @property
    def with_all_unbalance(self) -> Shooting:
        """The same machine with its unbalance."""
        return Shooting(replace(self.flow, driven=1.0), self.unit)

    def speed_Hz(self, shot: Shot) -> float:
        """The rotor speed of a cycle in Hz."""
        return math.exp(float(shot.mean_p[1])) * hertz(self.unit)

    @property
    def at_rest_difference(self) -> float:
        """Difference by which states are disturbed at rest."""
        if self.flow.smooth:
            return SMOOTH_DIFFERENCE
        return AT_REST_DIFFERENCE if self.flow.held.any() else DIFFERENCE

    def difference(self, displacements: Array) -> float:
        """Difference by which the states of a cycle are disturbed; displacements: see Passage."""
        if self.flow.smooth:
            return SMOOTH_DIFFERENCE
        gap = 1.0 - float(np.hypot(displacements[:, :, 0], displacements[:, :, 1]).max())
        return DIFFERENCE * min(1.0, max(gap, 0.0) / WIDE)

    def multipliers(self, space: SlowSpace, held: Array) -> Multipliers:
        """The multipliers of a cycle. held: (N + 2,) what holds it in time."""
        blur = SMOOTH_BLUR if self.flow.smooth else BLURRED
        return multipliers_of(space, held[:-2], blur) if self.free else driven_multipliers(space, blur)

    def rest(self, near: Wet, omega: float, wider: float = 1.0) -> Rest | None:
        """The static equilibrium at a speed, as a fixed point of the map over half a revolution: whirls of up to the
        speed of the rotor have frequencies of their own in it. None if it does not converge. wider: factor of what
        states are disturbed by."""
        time, none, difference = math.pi / omega, np.zeros(0), wider * self.at_rest_difference
        asked = _Asked(self, near, STEPS_PER_REVOLUTION // 2)

        def mapped(x: Array, _: Array) -> Array:
            return asked.image(x, time, omega)

        try:
            x = self.flow.packed(near, self.unit)
            space = slow_space(mapped, x, none, self._first(x), difference)
            free = Conditions(np.zeros((0, len(x))), np.zeros((0, 0)))
            fixed = fixed_point(mapped, x, none, space, free)
            if fixed is None:
                return None
            x, passage = fixed.x, asked.passage
            asked.settle(x)
            space = slow_space(mapped, x, none, self._first(x, fixed.space), difference)
        except Unreachable:
            return None
        values, states = ritz(space)
        decaying = np.maximum(np.abs(values), 1e-12)
        rates = (np.log(decaying) + 1j * np.angle(values)) / time
        return Rest(x, asked.near, omega, passage.displacements.mean(axis=0), rates, states)

    def stepped(self, shot: Shot, length: float, along: Array) -> Shot | None:
        """The cycle behind a step along a direction (N + 2,) of length 1; None if it is not found."""
        size = len(shot.x)
        conditions = both(self.held(shot.wet), along)
        guess_x, guess_p = shot.x + length * along[:size], shot.p + length * along[size:]
        return self._solved(replace(shot, tangent=along), guess_x, guess_p, conditions)

    def direction(self, shot: Shot, after: Shot) -> Array:
        """(N + 2,) direction of length 1 from one cycle to the next, without what they differ by in time.

        A branch is followed along it: where multipliers lie next to 1 their error turns the tangent to and fro."""
        phase = self.held(after.wet) / float(np.linalg.norm(self.held(after.wet)))
        chord = np.concatenate([after.x - shot.x, after.p - shot.p])
        chord = chord - phase * (phase @ chord)
        return np.asarray(chord / np.linalg.norm(chord))

    def at_speed(self, shot: Shot, other: Shot, omega: float) -> Shot | None:
        """The cycle at a speed in rad/s between two, found from the nearer one's slow motions or from the other's."""
        share = (math.log(omega / self.unit) - shot.p[1]) / (other.p[1] - shot.p[1])
        x, p = shot.x + share * (other.x - shot.x), shot.p + share * (other.p - shot.p)
        for one in (shot, other) if share < 0.5 else (other, shot):
            cycle = self._solved(one, x, p, both(self.held(one.wet), unit_vector(len(x) + 2)))
            if cycle is not None:
                return cycle
        return None

    def from_rest(self, rest: Rest, number: int, length: float) -> Shot | None:
        """The cycle of a small size next to a Hopf point; number: of the eigenvalue that crosses there."""
        mode, nu = rest.states[:, number], rest.eigenvalues[number].imag
        steps = round(STEPS_PER_REVOLUTION * rest.omega / nu)
        along, across = mode.real / np.linalg.norm(mode.real), -mode.imag
        across = across - along * (along @ across)
        p = np.log([2.0 * math.pi / nu * self.unit, rest.omega / self.unit])
        guess = rest.x + length * along
        tangent = np.concatenate([along, np.zeros(2)])
        rows = np.stack([np.append(across / np.linalg.norm(across), np.zeros(2)), tangent])
        start = self._near(rest.wet, p, tangent, steps)
        cycle = self.begun(start, guess, both(*rows))
        return None if cycle is None else replace(cycle, tangent=self.direction(start, cycle))

    def with_unbalance(self, rest: Rest) -> Shot | None:
        """The synchronous motion at the speed of a static equilibrium, the tangent to lower speeds; None if it is not
        found. The unbalance is raised in steps where one step does not lead there."""
        size, speed = len(rest.x), math.log(rest.omega / self.unit)
        p = np.array([math.log(2.0 * math.pi) - speed, speed])
        down = np.append(np.zeros(size), [1.0, -1.0]) / math.sqrt(2.0)
        cycle, share = self._near(rest.wet, p, down, STEPS_PER_REVOLUTION), 0.0

        def raised(by: float) -> Shot | None:
            partly = Shooting(replace(self.flow, driven=(share + by) * self.flow.driven), self.unit)
            held = both(self.held(cycle.wet), unit_vector(size + 2))
            return partly.begun(cycle, cycle.x, held)

        while share < 1.0:
            there, step = halved_until(raised, 1.0 - share, SMALLEST_SHARE)
            if there is None:
                return None
            cycle, share = there, share + step
        return cycle

    def _near(self, wet: Wet, p: Array, tangent: Array, steps: int) -> Shot:
        """A machine as a motion of which nothing is known."""
        x = self.flow.packed(wet, self.unit)
        nothing = np.zeros((len(x), 0))
        none = Multipliers(np.ones(1, dtype=complex), 0.0)
        space = SlowSpace(nothing, nothing, np.zeros((len(x), 2)))
        return Shot(x, p, wet, np.zeros((1, 1, 2)), space, tangent, none, steps)

    def locked_in(self, wet: Wet, omega: float) -> Shot | None:
        """The motion of two periods of the rotor next to a machine at a speed in rad/s; None if it is not found."""
        x, speed = self.flow.packed(wet, self.unit), math.log(omega / self.unit)
        p = np.array([math.log(4.0 * math.pi) - speed, speed])
        start = self._near(wet, p, unit_vector(len(x) + 2), 2 * STEPS_PER_REVOLUTION)
        return self.begun(start, x, both(self.held(wet), unit_vector(len(x) + 2)))

    def begun(self, start: Shot, guess: Array, conditions: Conditions) -> Shot | None:
        """The motion near a guess about which the slow motions are still to be found; None if it is not found."""
        try:
            asked = _Asked(self, start.wet, start.steps)
            by = SMOOTH_DIFFERENCE if self.flow.smooth else DIFFERENCE
            space = slow_space(asked.at, guess, start.p, self._first(guess), by)
        except Unreachable:
            return None
        return self._solved(replace(start, space=space), guess, start.p, conditions)

    def _solved(self, shot: Shot, x: Array, p: Array, conditions: Conditions) -> Shot | None:
        asked = _Asked(self, shot.wet, shot.steps)
        try:
            fixed = fixed_point(asked.at, x, p, shot.space, conditions)
            if fixed is None:
                return None
            x, p = fixed.x, fixed.p
            asked.settle(x)
            passage, wet = asked.passage, asked.near
            space = slow_space(asked.at, x, p, self._first(x, fixed.space), self.difference(passage.displacements))
        except Unreachable:
            return None
        held = self.held(wet)
        tangent = direction_along(space, held, shot.tangent)
        others = tuple(self._elsewhere(place, asked, p, space, conditions) for place in self.flow.places)
        return Shot(
            x, p, wet, passage.displacements, space, tangent, self.multipliers(space, held), shot.steps,
            tuple(each for each in others if each is not None),
        )  # fmt: skip

    def again(
        self, near: Wet, p: Array, space: SlowSpace, conditions: Conditions, steps: int, close: float
    ) -> tuple[tuple[Array, Array], ...]:
        """(p, displacements) of the cycle next to a machine, with the cells in each place in which it is found; none if
        not in the first. steps: of the period; close: see fixed_point."""
        asked = _Asked(self, near, steps)
        try:
            fixed = fixed_point(asked.at, self.flow.packed(near, self.unit), p, space, conditions, close)
        except Unreachable:
            fixed = None
        if fixed is None:
            return ()
        asked.settle(fixed.x)
        first = fixed.p, asked.passage.displacements
        others = (self._elsewhere(place, asked, fixed.p, fixed.space, conditions, close) for place in self.flow.places)
        return (first, *(each for each in others if each is not None))

    def _elsewhere(
        self, place: float, here: _Asked, p: Array, space: SlowSpace, conditions: Conditions, close: float = CLOSE
    ) -> tuple[Array, Array] | None:
        """(p, displacements) of a cycle with its cells at another place of PLACES; None if it is not found."""
        there = self.flow.moved(here.near, place)
        asked = _Asked(self, there, here.steps, self.flow.lying(place))
        try:
            fixed = fixed_point(asked.at, self.flow.packed(there, self.unit), p, space, conditions, close)
        except Unreachable:
            return None
        return None if fixed is None else (fixed.p, asked.passage.displacements)

    def held(self, wet: Wet) -> Array:
        """(N + 2,) what holds a motion in time: nothing along the direction in which its state moves, of the rotor
        alone; with the unbalance no change of T Omega."""
        if not self.free:
            return np.append(np.zeros(self.flow.size), np.ones(2))
        motion = self.flow.motion_of(wet, self.unit)
        return np.append(motion / float(np.linalg.norm(motion)), np.zeros(2))

    def _first(self, x: Array, known: SlowSpace | None = None) -> Array:
        """(N, j) unit states of the rotor and of fillings, and the slow motions that are known already, oil that stays
        among them."""
        rotor = np.eye(len(x))[:, : self.flow.slow]
        if known is None:
            return rotor
        values, states = ritz(known)
        slow = states[:, np.abs(values) > REMEMBERED]
        return np.hstack([rotor, slow.real, slow.imag])


class _Asked:
    """The map as shooting asks for it; near: the machine whose guesses the next evaluation takes; passage: the last."""

    def __init__(self, shooting: Shooting, near: Wet, steps: int, flow: PeriodMap | None = None) -> None:
        self.shooting, self.near, self.steps = shooting, near, steps
        self.flow = shooting.flow if flow is None else flow
        self.passage: Passage

    def image(self, x: Array, time: float, omega: float) -> Array:
        flow, unit = self.flow, self.shooting.unit
        self.passage = flow.passage(flow.unpacked(x, self.near, unit), time, omega, self.steps)
        return flow.packed(self.passage.end, unit)

    def at(self, x: Array, p: Array) -> Array:
        unit = self.shooting.unit
        return self.image(x, math.exp(p[0]) / unit, math.exp(p[1]) * unit)

    def settle(self, x: Array) -> None:
        """Take the guesses of the last evaluation, which has ended where it began, for the next."""
        self.near = self.flow.unpacked(x, self.passage.end, self.shooting.unit)


def both(held: Array, along: Array) -> Conditions:
    """Nothing along two directions (N + 2,)."""
    rows = np.stack([held, along])
    return Conditions(rows[:, :-2], rows[:, -2:])


def largest(displacements: Array) -> Array:
    """(J,) largest eccentricity of an orbit (SAMPLES + 1, J, 2), between samples by parabolas."""
    e = np.hypot(displacements[:-1, :, 0], displacements[:-1, :, 1])
    at, films = e.argmax(axis=0), np.arange(e.shape[1])
    before, here, after = e[at - 1, films], e[at, films], e[(at + 1) % len(e), films]
    bend = np.maximum(2.0 * here - before - after, 1e-300)
    return np.asarray(here + (after - before) ** 2 / (8.0 * bend))


def driven_multipliers(space: SlowSpace, blur: float = BLURRED) -> Multipliers:
    """The multipliers of a motion with the unbalance; none is trivial; the first one is set to 1. blur: their error."""
    return Multipliers(np.append(1.0 + 0.0j, ritz(space)[0]), blur)


def multipliers_of(space: SlowSpace, phase: Array, blur: float = BLURRED) -> Multipliers:
    """The multipliers of a cycle, the trivial one first. phase: (N,) unit direction in which its state moves in time;
    blur: their error at least.

    Next to a fold two multipliers are 1, with one disturbance for both, and an error enters each with its root: the
    other one is then what their sum, which has the error itself, is beyond the trivial one."""
    values, states = ritz(space)
    near = np.abs(values - 1.0) < 0.2
    along = np.where(near, np.abs(phase @ states) / np.linalg.norm(states, axis=0), -1.0)
    trivial = int(np.argmax(along))
    first, others = values[trivial], np.delete(values, trivial)
    defect = max(blur, float(abs(first - 1.0)))
    if first.imag != 0.0:  # both have become a pair
        second, defect = int(np.argmin(np.abs(others - first.conjugate()))), blur
    else:
        second = int(np.argmin(np.abs(others - 1.0)))
    if first.imag != 0.0 or abs(others[second] - 1.0) < DOUBLE:
        first, others[second] = 1.0, (first + others[second]).real - 1.0
    others = others[largest_first(others)]
    return Multipliers(np.concatenate([[first], others]), defect)


