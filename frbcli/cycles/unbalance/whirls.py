"""What a stable cycle becomes with the unbalance beside it: a motion of two frequencies, or one that has locked in at
half the speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import moments, motion_along, packed, unpacked
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.method.courses import AtItsHeat
from frbcli.cycles.method.cycle import MOMENTS, Cycle, largest_of
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.parts.reduced_states import reduced_space
from frbcli.cycles.result import CyclePoint, SpectralLine, UnbalancedWhirl, hertz
from frbcli.cycles.unbalance.beats import beating
from frbcli.cycles.unbalance.growth import is_stable
from frbcli.cycles.unbalance.locked import locked_near, locked_whirl
from frbcli.cycles.unbalance.two_frequencies import Orders, Torus, fitted, moments_of, of_cycle, samples, with_unbalance

ROUNDS, WARM_ENOUGH = 20, 1e-4  # of temperatures and motion in turn, and K by which the last one may differ
NEAR_HALF = 0.05  # of the speed: distance of twice the whirl from it up to which the whirl may lock in
PHASES = (256, 128)  # at which eccentricities are taken, at least
LINES, FAINT = 8, 1e-4  # beside those of whirl and unbalance: how many lines, and the smallest over the clearance


@dataclass(frozen=True)
class WhirlFound:
    """What a cycle becomes. torus: of two frequencies, None if it has locked in; cycle: y of the cycle, see
    balance.py."""

    whirl: UnbalancedWhirl
    torus: Torus | None
    cycle: Array


class Chain:
    """Motions along a branch, each from the one before it where that leads to it. at_its_heat: see MachineCourse."""

    def __init__(self, at_its_heat: AtItsHeat | None = None) -> None:
        self.at_its_heat = at_its_heat
        self.locked: Cycle | None = None
        self.last: tuple[Torus, Torus] | None = None  # without and with the unbalance

    def next(self, machine: Machine, point: CyclePoint) -> WhirlFound:
        """The motion that a cycle of a machine becomes. Raises Unreachable, with the reason, if it is not found."""
        motion = motion_of(machine, point)
        nu, omega = 2.0 * math.pi * point.frequency_Hz, 2.0 * math.pi * point.speed_Hz
        cycle = np.concatenate([packed(motion), [nu / machine.pace, omega / machine.pace]])
        try:
            machine, torus = self._settled(machine, motion, nu, omega)
        except Unreachable:
            self.last = None
            raise
        if self.locked is not None:
            return WhirlFound(_locked_whirl(machine, self.locked), None, cycle)
        assert torus is not None
        stable = is_stable(machine, reduced_space(machine), torus, cycle)
        return WhirlFound(free_whirl(machine, torus, stable), torus, cycle)

    def _settled(self, machine: Machine, motion: Complex, nu: float, omega: float) -> tuple[Machine, Torus | None]:
        """The machine, with heat at the temperatures of the motion that it then has, and this; None if it has locked
        in. Temperatures and motion are found in turn: they hardly change each other. Raises Unreachable."""
        if self.at_its_heat is None:
            return machine, self._found(machine, motion, nu, omega)
        machine = self.at_its_heat(*_moments_of_cycle(motion, nu), omega)
        for _ in range(ROUNDS):
            torus = self._found(machine, motion, nu, omega)
            if torus is not None:
                moved = moments_of(torus)
            else:
                assert self.locked is not None
                moved = _moments_of_cycle(unpacked(self.locked.y[:-2], machine.size), 0.5 * omega)
            before, machine = machine.temperatures, self.at_its_heat(*moved, omega)
            if float(np.abs(machine.temperatures - before).max()) < WARM_ENOUGH:
                return machine, torus
        raise Unreachable("its temperatures do not settle")

    def _found(self, machine: Machine, motion: Complex, nu: float, omega: float) -> Torus | None:
        """The motion of two frequencies of a machine; None if it has locked in. Raises Unreachable."""
        self.locked = self._locked(machine, motion, nu, omega)
        if self.locked is not None:
            self.last = None
            return None
        before = of_cycle(motion, nu, omega, machine.orders)
        torus = self._torus(machine, before)
        self.last = before, torus
        return torus

    def _locked(self, machine: Machine, motion: Complex, nu: float, omega: float) -> Cycle | None:
        if not nearly_half(nu, omega):
            return None
        if self.locked is not None:
            near = unpacked(self.locked.y[:-2], machine.size)
            found = locked_near(machine, near, omega)
            if found is not None:
                return found
        return locked_whirl(machine, motion, nu, omega)

    def _torus(self, machine: Machine, before: Torus) -> Torus:
        for guess in (self._beating, self._moved_on):
            try:
                return fitted(machine, guess(machine, before))
            except Unreachable:
                pass
        return with_unbalance(machine, before)

    def _beating(self, machine: Machine, before: Torus) -> Torus:
        if not nearly_half(before.nu, before.omega):
            raise Unreachable
        return beating(machine, before.motion[before.orders[:, 1] == 0], before.nu, before.omega)

    def _moved_on(self, _machine: Machine, before: Torus) -> Torus:
        if self.last is None:
            raise Unreachable
        return _moved_on(before, *self.last)


def _phases(orders: Orders) -> tuple[int, int]:
    """At how many phases of both frequencies eccentricities are taken: motions that nearly lock in have many orders."""
    a, b = (int(each) for each in np.maximum(PHASES, 4 * np.abs(orders).max(axis=0)))
    return a, b


def _moments_of_cycle(motion: Complex, nu: float) -> tuple[Array, Array]:
    """(n, c) a motion of the frequency nu in rad/s at moments of its period, and its rate in 1/s."""
    u, rate = motion_along(motion, moments(len(motion) - 1))
    return u, nu * rate


def nearly_half(nu: float, omega: float) -> bool:
    """Whether a whirl may lock in; both in rad/s."""
    return abs(2.0 * nu - omega) <= NEAR_HALF * omega


def _moved_on(cycle: Torus, cycle_before: Torus, torus_before: Torus) -> Torus:
    """The motion before with what has changed since then without the unbalance."""
    orders = {(int(j), int(k)): i for i, (j, k) in enumerate(torus_before.orders)}
    motion = torus_before.motion.copy()
    for sign, each in ((1.0, cycle), (-1.0, cycle_before)):
        for order, harmonic in zip(each.orders.tolist(), each.motion, strict=True):
            place = orders.get(tuple(order))
            if place is not None:
                motion[place] += sign * harmonic
    return Torus(torus_before.orders, motion, torus_before.nu + cycle.nu - cycle_before.nu, cycle.omega)


def motion_of(machine: Machine, point: CyclePoint) -> Complex:
    """(H + 1, c) harmonics of a cycle, of the ring speeds their mean."""
    films = 2 * machine.film_count
    motion = np.zeros((len(point.harmonics), machine.size), dtype=complex)
    motion[:, :films] = point.harmonics.reshape(len(motion), -1)
    motion[0, films:] = 2.0 * math.pi * point.ring_speeds_Hz / machine.pace
    return motion


def free_whirl(machine: Machine, torus: Torus, stable: bool | None, kind: str = "") -> UnbalancedWhirl:
    """Results of a motion of two frequencies."""
    films = 2 * machine.film_count
    displacements = samples(torus.orders, torus.motion[:, :films], _phases(torus.orders))
    return UnbalancedWhirl(
        speed_Hz=hertz(torus.omega),
        frequency_Hz=hertz(torus.nu),
        locked=False,
        eccentricity_max=largest_of(displacements.reshape(-1, films)),
        ring_speeds_Hz=hertz(machine.pace) * torus.motion[0, films:].real,
        lines=free_lines(torus.orders, torus.frequencies, torus.motion[:, :films]),
        stable=stable,
        kind=kind,
        temperatures_K=machine.temperatures,
    )


def _locked_whirl(machine: Machine, cycle: Cycle) -> UnbalancedWhirl:
    """Results of a motion of two periods of the rotor."""
    films = 2 * machine.film_count
    motion, omega = unpacked(cycle.y[:-2], machine.size), float(cycle.y[-1] * machine.pace)
    displacements, _ = motion_along(motion[:, :films], max(MOMENTS, 4 * len(motion)))
    return UnbalancedWhirl(
        speed_Hz=hertz(omega),
        frequency_Hz=0.5 * hertz(omega),
        locked=True,
        eccentricity_max=largest_of(displacements),
        ring_speeds_Hz=hertz(machine.pace) * motion[0, films:].real,
        lines=locked_lines(omega, motion[:, :films]),
        stable=cycle.multipliers.stable,
        temperatures_K=machine.temperatures,
    )


def free_lines(orders: Orders, frequencies: Array, harmonics: Complex) -> tuple[SpectralLine, ...]:
    """The lines of a motion of two frequencies. orders: (l, 2); frequencies: (l,) rad/s; harmonics: (l, 2 F) of the
    displacements over the clearance."""
    lines = [
        SpectralLine(_combination(int(j), int(k), frequency), abs(hertz(frequency)), _axis(harmonic))
        for (j, k), frequency, harmonic in zip(orders, frequencies, harmonics, strict=True)
        if (j, k) != (0, 0)
    ]
    return _main(lines, ("nu", "Omega"))


def locked_lines(omega: float, harmonics: Complex) -> tuple[SpectralLine, ...]:
    """The lines of a motion of two periods of the rotor. omega: rad/s; harmonics: (H + 1, 2 F), as for free_lines."""
    lines = [
        SpectralLine(_half(order), 0.5 * order * hertz(omega), _axis(harmonic))
        for order, harmonic in enumerate(harmonics)
        if order > 0
    ]
    return _main(lines, (_half(1), _half(2)))


def _axis(harmonic: Complex) -> Array:
    """(F,) half the longer axis of the ellipse of 2 Re(harmonic exp(i t)) in each film."""
    x, y = harmonic[0::2], harmonic[1::2]
    return np.asarray(np.abs(x + 1j * y) + np.abs(x - 1j * y))


def _main(lines: Sequence[SpectralLine], always: tuple[str, str]) -> tuple[SpectralLine, ...]:
    """Lines of whirl and unbalance, and the largest others."""
    first = [line for name in always for line in lines if line.name == name]
    others = [line for line in lines if line.name not in always and line.amplitude.max() > FAINT]
    others.sort(key=lambda line: -float(line.amplitude.max()))
    return (*first, *others[:LINES])


def _combination(j: int, k: int, frequency: float) -> str:
    """The name of j nu + k Omega, or of its negative if that is above zero."""
    sign = 1 if frequency >= 0.0 else -1
    parts = [(sign * j, "nu"), (sign * k, "Omega")]
    parts.sort(key=lambda part: -part[0])
    told = ""
    for factor, name in parts:
        if factor:
            joint = (" - " if factor < 0 else " + ") if told else ("-" if factor < 0 else "")
            told += joint + (name if abs(factor) == 1 else f"{abs(factor)} {name}")
    return told


def _half(order: int) -> str:
    """The name of a multiple of Omega / 2."""
    if order % 2 == 0:
        return "Omega" if order == 2 else f"{order // 2} Omega"
    return "Omega / 2" if order == 1 else f"{order} Omega / 2"
