"""A whirl of nearly half the speed that beats with the unbalance, as a first guess of a motion of two frequencies.

The beat is slow, so that the whirl is at each moment nearly the cycle that exists with the unbalance shifted against it
by an angle theta (locked.py), which turns by

    d theta / dt = Omega - 2 mu(theta).

It lingers where mu is next to Omega / 2. alpha = b - 2 a is theta's phase in uniform time, and nu = Omega / 2 less half
of the frequency of the beat.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.balance import unpacked
from frbcli.cycles.method.continuation import Unreachable
from frbcli.cycles.parts.machine import Machine
from frbcli.cycles.unbalance.locked import padded, shifted
from frbcli.cycles.unbalance.synchronous import first_harmonics
from frbcli.cycles.unbalance.two_frequencies import Torus

ANGLES, MOMENTS = 24, 512  # at which cycles are taken; of a beat
FAINT = 1e-7  # of the clearance: harmonics of a guess that are left out
CLOSER = 8  # iterations for theta(alpha)


def beating(machine: Machine, motion: Complex, nu: float, omega: float) -> Torus:
    """The guess for the motion that a cycle becomes with the unbalance. motion: (H + 1, c) harmonics of the cycle; nu,
    omega: its frequency and the rotor's in rad/s. Raises Unreachable, also where the whirl locks in."""
    motion = padded(motion, first_harmonics(machine, 2))
    cycles = shifted(machine, motion, nu, omega, 1.0, _phases(ANGLES))
    alpha = _phases(MOMENTS)
    turning = omega - 2.0 * machine.pace * np.array([y[-2] for y in cycles])
    rate = _between(turning, alpha)
    if rate.min() * rate.max() <= 0.0:
        raise Unreachable
    beat = 1.0 / float((1.0 / rate).mean())
    theta = _in_uniform_time(beat / rate)
    motions = _between(np.array([unpacked(y[:-2], machine.size) for y in cycles]), theta)
    ahead = np.exp(-0.5j * np.outer(theta - alpha, np.arange(len(motion))))
    found = np.fft.fft(ahead[:, :, None] * motions, axis=0, norm="forward")
    return _torus(found, 0.5 * (omega - beat), omega)


def _phases(count: int) -> Array:
    return 2.0 * np.pi * np.arange(count) / count


def _orders(count: int) -> Array:
    return np.asarray(np.fft.fftfreq(count, 1.0 / count))


def _between(values: NDArray[Any], theta: Array) -> NDArray[Any]:
    """Values (n, ...) of equal steps of theta at other ones, by their Fourier series."""
    waves = np.exp(1j * np.outer(theta, _orders(len(values))))
    found = np.tensordot(waves, np.fft.fft(values, axis=0, norm="forward"), axes=1)
    return np.asarray(found if np.iscomplexobj(values) else found.real)


def _in_uniform_time(slope: Array) -> Array:
    """(MOMENTS,): theta at equal steps of alpha. slope: d alpha / d theta at equal steps of theta, of the mean 1."""
    orders, alpha = _orders(MOMENTS), _phases(MOMENTS)
    slopes = np.fft.fft(slope, norm="forward")
    waves = np.append(0.0, slopes[1:] / (1j * orders[1:]))

    def reached(theta: Array) -> Array:
        return np.asarray(theta + (np.exp(1j * np.outer(theta, orders)) @ waves).real)

    turns = 2.0 * np.pi * np.array([-1.0, 0.0, 1.0])[:, None]
    theta = np.interp(alpha, (turns + reached(alpha)).ravel(), (turns + alpha).ravel())
    for _ in range(CLOSER):
        theta = theta - (reached(theta) - alpha) / _between(slope, theta)
    return theta


def _torus(found: Complex, nu: float, omega: float) -> Torus:
    """found: (MOMENTS, H + 1, c): u of exp(i (h a + q alpha)), which is exp(i ((h - 2 q) a + q b))."""
    kept: dict[tuple[int, int], Complex] = {(0, 0): found[0, 0]}
    for q, by_order in zip(_orders(MOMENTS).astype(int), found, strict=True):
        for h in np.flatnonzero(np.abs(by_order).max(axis=1) > FAINT):
            j, k, value = int(h) - 2 * int(q), int(q), by_order[h]
            if (k, j) < (0, 0):
                j, k, value = -j, -k, np.conj(value)
            kept[j, k] = value
    return Torus(np.array(list(kept)), np.array(list(kept.values())), nu, omega)
