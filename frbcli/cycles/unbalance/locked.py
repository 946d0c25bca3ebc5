"""A whirl of nearly half the speed that locks in with the unbalance: a motion of two periods of the rotor.

With an unbalance at 2 mu, which is shifted against the whirl by an angle theta, a cycle of some frequency mu(theta)
exists; it goes on from the one without unbalance, mu = nu. Where mu = Omega / 2 for some theta the whirl locks in, for
one theta with a stable motion, for another one with an unstable one. If there is no such theta, the whirl does not lock
in. """

from __future__ import annotations

import itertools

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import Balance, packed, unpacked
from frbcli.cycles.method.continuation import Equations, Place, Unreachable, corrected, oriented, unit_vector
from frbcli.cycles.method.courses import MachineCourse
from frbcli.cycles.method.cycle import Cycle, largest
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.unbalance.synchronous import WHIRLS, Synchronous, driven_motion, first_harmonics

ANGLES = 12  # at which theta is tried
SMALLEST = 1.0 / 64.0  # share of the unbalance, and step to a larger one, at which it is tried last
SHARP = 1e-5  # of theta
PERIODS = 2  # of the rotor in one of the motion


def locked_whirl(machine: Machine, motion: Complex, nu: float, omega: float) -> Cycle | None:
    """The stable motion of two periods of the rotor with the unbalance that a cycle locks in with, None if none was
    found. motion: (H + 1, c) harmonics of the cycle; nu: its frequency; omega: rad/s.

    Where it cannot be reached with the whole unbalance it is looked for with a part of it, which is raised then.
    """
    motion = padded(motion, first_harmonics(machine, PERIODS))
    share = 1.0
    while share >= SMALLEST:
        try:
            guesses = _guesses(machine, motion, nu, omega, share)
        except Unreachable:
            share *= 0.5
            continue
        for guess in guesses:
            locked = locked_near(machine, guess, omega, share)
            if locked is not None:
                return _raised(machine, locked, omega, share)
        return None
    return None


def locked_near(machine: Machine, motion: Complex, omega: float, share: float = 1.0) -> Cycle | None:
    """The stable motion of two periods of the rotor next to one with harmonics (H + 1, c); None if there is none."""
    follower, speed = Synchronous(MachineCourse(machine), 0.0, 1.0, PERIODS, share), omega / machine.pace
    guess = np.concatenate([packed(motion), [0.5 * speed, speed]])
    along = unit_vector(len(guess))
    place = corrected(follower.equations(Place(guess, along)), guess, along)
    near = None if place is None else follower.refitted(oriented(place, along))
    fitted = None if near is None else follower.entered(near.y, speed)
    if fitted is None or largest(machine, fitted.y) > 1.0:
        return None
    whirl = unpacked(fitted.y[:-2], machine.size)[1::2, : 2 * machine.film_count]
    cycle = follower.cycle(fitted)
    return cycle if cycle.multipliers.stable and np.abs(whirl).max() > WHIRLS else None


def _raised(machine: Machine, locked: Cycle, omega: float, share: float) -> Cycle | None:
    """The motion with the whole unbalance that goes on from one with a share of it."""
    step = share
    while share < 1.0:
        higher = min(1.0, share + step)
        there = locked_near(machine, unpacked(locked.y[:-2], machine.size), omega, higher)
        if there is not None:
            locked, share, step = there, higher, 2.0 * step
        elif step < SMALLEST:
            return None
        else:
            step *= 0.5
    return locked


def _guesses(machine: Machine, motion: Complex, nu: float, omega: float, share: float) -> list[Complex]:
    """The cycles with a share of the unbalance and mu = Omega / 2, shifted in time so that theta is zero. Raises
    Unreachable."""
    from scipy.optimize import brentq

    angles = 2.0 * np.pi * np.arange(ANGLES + 1) / ANGLES
    known = dict(zip(angles, shifted(machine, motion, nu, omega, share, angles), strict=True))

    def off(theta: float) -> float:
        if theta not in known:
            near = known[min(known, key=lambda other: abs(other - theta))]
            known[theta] = _shifted(machine, motion, near, share, theta)
        return float(known[theta][-2]) - 0.5 * omega / machine.pace

    guesses, orders = [], np.arange(len(motion))[:, None]
    for low, high in itertools.pairwise(angles):
        if off(low) * off(high) <= 0.0:
            theta = float(brentq(off, low, high, xtol=SHARP))
            off(theta)
            guesses.append(unpacked(known[theta][:-2], machine.size) * np.exp(-0.5j * theta * orders))
    return guesses


def shifted(machine: Machine, motion: Complex, nu: float, omega: float, share: float, angles: Array) -> list[Array]:
    """The cycles with a share of the unbalance shifted by angles theta, each from the one before it. Raises
    Unreachable."""
    y, cycles = np.concatenate([packed(motion), [nu / machine.pace, omega / machine.pace]]), []
    for theta in angles:
        y = _shifted(machine, motion, y, share, float(theta))
        cycles.append(y)
    return cycles


def _shifted(machine: Machine, reference: Complex, y: Array, share: float, theta: float) -> Array:
    """The cycle with a share of the unbalance shifted by theta, next to y; its phase is the phase of the reference.
    Raises Unreachable."""
    place = corrected(_equations(machine, reference, share, theta), y, unit_vector(len(y)))
    if place is None:
        raise Unreachable
    return place.y


def _equations(machine: Machine, reference: Complex, share: float, theta: float) -> Equations:
    """Equations of a cycle with a share of the unbalance in its second harmonic, the rotor ahead by theta."""
    balance = Balance(machine, reference)

    def at(y: Array) -> tuple[Array, Array]:
        residual, slope = balance(y)
        residual[:-1] -= share * driven_motion(machine, balance.harmonics, PERIODS, float(y[-1]), theta)
        return residual, slope

    return at


def padded(motion: Complex, harmonics: int) -> Complex:
    """(H + 1, c) harmonics with zeros behind them, so that H is not below `harmonics`."""
    more = max(0, harmonics + 1 - len(motion))
    return np.concatenate([motion, np.zeros((more, motion.shape[1]))])
