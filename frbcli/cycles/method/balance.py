"""Harmonic balance of a periodic motion, with the loads of the films taken at moments of a period (alternating
frequency and time).

A motion u(tau) = u_0 + sum over k = 1 ... H of u_k exp(i k tau) + its conjugate, tau = nu t, is held as the real vector

    y = (u_0, Re u_1, Im u_1, ..., Re u_H, Im u_H, nu / pace, Omega / pace)

and obeys u_k - T_k (g_k + kappa_k u_k) = 0 for k = 0 ... H, g_k being the harmonics of the loads (machine.py), and the
phase condition that it is not shifted in time against a reference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.cycles.method.machine import Loads, Machine, film_loads, transfer

SAMPLES_PER_HARMONIC, FEWEST_SAMPLES = 6, 64


@dataclass(frozen=True)
class Balance:
    """The equations of a motion with H harmonics; reference: (H + 1, c) the motion that the phase is compared with."""

    machine: Machine
    reference: Complex

    @property
    def harmonics(self) -> int:
        """H."""
        return len(self.reference) - 1

    def __call__(self, y: Array) -> tuple[Array, Array]:
        """The residual (n,) and its derivative (n, n + 1), n = c (2 H + 1) + 1. Raises OutOfGap."""
        machine, h = self.machine, self.harmonics
        c = machine.size
        motion, nu, omega = unpacked(y[:-2], c), float(y[-2] * machine.pace), float(y[-1] * machine.pace)
        orders = np.arange(h + 1.0)[:, None]
        passing = transfer(machine, nu * orders[:, 0], omega)
        kappa = passing.kappa
        loads, rate = loads_along(machine, motion, nu, omega)
        values, slope = harmonics_of(loads.values, h), _derivative(loads, h, nu)
        inner = values + kappa * motion
        out = motion - through(passing.values, inner)
        out[0] -= machine.rest
        slope[np.arange(h + 1), :, h + np.arange(h + 1), :] += kappa[:, :, None] * np.eye(c)
        by_motion = -np.einsum("kij,kjlm->kilm", passing.values, slope)
        by_motion[np.arange(h + 1), :, h + np.arange(h + 1), :] += np.eye(c)
        with_nu = harmonics_of(np.einsum("nij,nj->ni", loads.by_v, rate), h)
        with_nu += orders * passing.kappa_by_frequency * motion
        by_nu = -orders * through(passing.by_frequency, inner) - through(passing.values, with_nu)
        by_omega = -through(passing.by_speed, inner) - through(passing.values, harmonics_of(loads.by_speed, h))
        n = c * (2 * h + 1)
        residual, jacobian = np.empty(n + 1), np.zeros((n + 1, n + 2))
        residual[:n], jacobian[:n, :n] = packed(out), as_real(by_motion)
        jacobian[:n, n], jacobian[:n, n + 1] = machine.pace * packed(by_nu), machine.pace * packed(by_omega)
        row = phase_row(self.reference)
        residual[n], jacobian[n, :n] = row @ y[:n], row
        return residual, jacobian


def unpacked(y: Array, c: int) -> Complex:
    """(H + 1, c) harmonics of the real vector y (c (2 H + 1),)."""
    h = (len(y) // c - 1) // 2
    motion = np.zeros((h + 1, c), dtype=complex)
    motion[0] = y[:c]
    parts = y[c:].reshape(h, 2, c)
    motion[1:] = parts[:, 0] + 1j * parts[:, 1]
    return motion


def packed(motion: Complex) -> Array:
    """The real vector of harmonics (H + 1, c)."""
    parts = np.stack([motion[1:].real, motion[1:].imag], axis=1)
    return np.concatenate([motion[0].real, parts.ravel()])


def phase_row(reference: Complex) -> Array:
    """(c (2 H + 1),): how a motion is shifted in time against a reference, the mean of u . du_ref/dtau."""
    k = np.arange(len(reference))[:, None]
    shifted = 1j * k * reference
    row = packed(shifted)
    size = float(np.linalg.norm(row))
    return row / size if size > 0.0 else row


def moments(harmonics: int) -> int:
    """At how many moments of a period the films are asked."""
    wanted = max(FEWEST_SAMPLES, SAMPLES_PER_HARMONIC * harmonics)
    return 1 << (wanted - 1).bit_length()


def motion_along(motion: Complex, count: int) -> tuple[Array, Array]:
    """(count, c) a motion at equal moments of its period, and its derivative by tau."""
    h = len(motion) - 1
    spectrum = np.zeros((count // 2 + 1, motion.shape[1]), dtype=complex)
    spectrum[: h + 1] = count * motion
    rate = 1j * np.arange(count // 2 + 1)[:, None] * spectrum
    return np.fft.irfft(spectrum, count, axis=0), np.fft.irfft(rate, count, axis=0)


def loads_along(machine: Machine, motion: Complex, nu: float, omega: float) -> tuple[Loads, Array]:
    """The loads at moments of a period, and du/dtau there (n, c). Raises OutOfGap."""
    u, rate = motion_along(motion, moments(len(motion) - 1))
    return film_loads(machine, u, nu * rate, omega), rate


def left_out(machine: Machine, y: Array) -> float:
    """Largest amplitude that the loads give to one of the four harmonics after the last one of y."""
    c, h = machine.size, (len(y) - 2) // machine.size // 2
    nu, omega = float(y[-2] * machine.pace), float(y[-1] * machine.pace)
    motion = unpacked(y[:-2], c)
    loads, _ = loads_along(machine, motion, nu, omega)
    beyond = transfer(machine, nu * np.arange(h + 1.0, h + 5.0), omega).values
    return float(np.abs(through(beyond, harmonics_of(loads.values, h + 4)[h + 1 :])).max())


def harmonics_of(samples: Array, h: int) -> Complex:
    """(h + 1, ...) of samples (n, ...) over a period."""
    return np.asarray(np.fft.rfft(samples, axis=0)[: h + 1] / len(samples))


def through(passing: Complex, harmonics: Complex) -> Complex:
    """(m, c) motions that loads with harmonics (m, c) make, each through its own matrix of passing (m, c, c)."""
    return np.asarray(np.einsum("kij,kj->ki", passing, harmonics))


def _derivative(loads: Loads, h: int, nu: float) -> Complex:
    """(h + 1, c, 2 h + 1, c): the harmonic k of the loads by u_l, l = -h ... h."""
    by_u, by_v = _both_signs(loads.by_u, 2 * h), _both_signs(loads.by_v, 2 * h)
    k, order = np.arange(h + 1)[:, None], np.arange(-h, h + 1)[None, :]
    place = k - order + 2 * h
    tensor = by_u[place] + (1j * nu * order)[..., None, None] * by_v[place]
    return np.ascontiguousarray(tensor.transpose(0, 2, 1, 3))


def _both_signs(samples: Array, h: int) -> Complex:
    """(2 h + 1, ...): the harmonics -h ... h."""
    one = harmonics_of(samples, h)
    return np.concatenate([np.conj(one[:0:-1]), one])


def as_real(slope: Complex) -> Array:
    """The derivative (k, i, l, j) of harmonics k by u_l, l = -h ... h, as a real matrix of packed vectors."""
    h, c = len(slope) - 1, slope.shape[1]
    ahead, behind = slope[:, :, h + 1 :], slope[:, :, h - 1 :: -1] if h > 0 else slope[:, :, :0]
    by_real, by_imaginary = ahead + behind, 1j * (ahead - behind)
    columns = np.empty((h + 1, c, 1 + 2 * h, c), dtype=complex)
    columns[:, :, 0] = slope[:, :, h]
    columns[:, :, 1::2], columns[:, :, 2::2] = by_real, by_imaginary
    flat = columns.reshape(h + 1, c, -1)
    rows = np.empty((1 + 2 * h, c, flat.shape[2]))
    rows[0] = flat[0].real
    rows[1::2], rows[2::2] = flat[1:].real, flat[1:].imag
    return rows.reshape((1 + 2 * h) * c, -1)
