"""Curves of torus and flip points in a plane of two numbers, see planes.py and curves.py.

A disturbance of a cycle of the frequency nu that neither grows nor decays is v = sum over l of v_l exp(i (l nu + s) t),
with s = nu / 2 at a flip and any other s at a torus point (Hill). With the harmonics G and G' of the films' derivatives
by the displacements and their rates, and w_l = l nu + s, it exists where

    L = 1 - T(w_k) (G_(k - l) + i w_l G'_(k - l) + kappa delta_kl)

is singular: g = 0 of a bordered system as in curves.py, complex for the unknown s and one number, and real at a flip.
The unknowns are those of a fold, y = (motion, nu / pace, numbers), and at a torus point s / pace before them.

How g changes is a difference along s and along both directions in which motions go on; across these the equations of
the motion alone lead Newton's method to them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.cycles.branch import crossing
from frbcli.cycles.maps.curves import DIFFERENCE, fitted, require_positive
from frbcli.cycles.maps.planes import MapPlane
from frbcli.cycles.method.balance import harmonics_of, loads_along, unpacked
from frbcli.cycles.method.continuation import Equations, Place, unit_vector
from frbcli.cycles.method.cycle import FLIP, TORUS, Cycle
from frbcli.cycles.parts.machine import Machine, transfer

Motions = Callable[[Machine, Complex], Equations]  # of a machine and a motion whose phase others have

SPARE = 4  # harmonics of a disturbance beyond those of the motion
MERGED = "Its pair of multipliers meets on the real axis."


@dataclass(frozen=True)
class CrossingStart:
    """A torus or flip point in which a curve begins; y: see CrossingCurve."""

    kind: str
    synchronous: bool
    y: Array


def starts_of(cycles: Sequence[Cycle], share: float, synchronous: bool) -> Iterator[CrossingStart]:
    """Starts of a branch, or of the synchronous response, at a share of the second number."""
    for cycle in cycles:
        if cycle.kind in (TORUS, FLIP):
            shift = abs(float(np.angle(crossing(cycle)))) / (2.0 * np.pi) * float(cycle.place.y[-2])
            before = [shift] if cycle.kind == TORUS else []
            yield CrossingStart(cycle.kind, synchronous, np.concatenate([before, cycle.place.y, [share]]))


@dataclass(frozen=True)
class CrossingCurve:
    """Points where a multiplier crosses the unit circle. plane: of both numbers; motions: the equations of the motion
    that loses its stability, in its harmonics, its frequency and the speed; torus: whether a pair crosses, else one
    at -1."""

    plane: MapPlane
    motions: Motions
    torus: bool

    def motion_of(self, y: Array) -> Array:
        """The unknowns of the motion alone, with both numbers."""
        return y[1:] if self.torus else y

    def shift(self, y: Array) -> float:
        """s over nu."""
        return float(y[0] / y[-3]) if self.torus else 0.5

    def equations(self, y: Array) -> Equations:
        """Equations of a torus or flip point, with the bordering vectors and the phase of a y near to it."""
        size = self.plane.machine(y).size
        reference = unpacked(self.motion_of(y)[:-3], size)
        left, _, right = np.linalg.svd(self._hill(y))
        b, c = (each if self.torus else _symmetric(each, size) for each in (left[:, -1], right[-1].conj()))
        row = np.append(np.zeros(len(b)), 1.0)

        def g(y: Array) -> Array:
            matrix = np.block([[self._hill(y), b[:, None]], [c.conj()[None], np.zeros((1, 1))]])
            found = np.linalg.solve(matrix, row)[-1]
            return np.array([found.real, found.imag] if self.torus else [found.real])

        def equations(y: Array) -> tuple[Array, Array]:
            require_positive(y)
            residual, slope = self._motion(self.motion_of(y), reference)
            along = np.linalg.qr(slope.T, mode="complete")[0][:, len(slope) :].T
            if self.torus:
                slope = np.column_stack([np.zeros(len(slope)), slope])
                along = np.vstack([unit_vector(len(y), 0), np.column_stack([np.zeros(len(along)), along])])
            changes = [(g(y + DIFFERENCE * one) - g(y - DIFFERENCE * one)) / (2.0 * DIFFERENCE) for one in along]
            return np.concatenate([residual, g(y)]), np.vstack([slope, np.transpose(changes) @ along])

        return equations

    def fitted(self, place: Place) -> Place | None:
        """A place with as many harmonics as it needs, up to a largest number."""
        return fitted(self.plane, self.equations, place, int(self.torus))

    def ends(self, place: Place) -> str:
        """Why a curve ends in a place, or nothing."""
        return "" if not self.torus or 0.0 < self.shift(place.y) < 0.5 else MERGED

    def _motion(self, z: Array, reference: Complex) -> tuple[Array, Array]:
        """Residual (n,) of the motion and its derivative (n, n + 2)."""
        plane = self.plane

        def at(z: Array) -> tuple[Array, Array]:
            return self.motions(plane.machine(z), reference)(plane.cycle(z))

        residual, slope = at(z)
        matrix = np.zeros((len(residual), len(z)))
        matrix[:, :-1] = slope
        for number in plane.by_difference:
            step = DIFFERENCE * unit_vector(len(z), number)
            matrix[:, number] = (at(z + step)[0] - at(z - step)[0]) / (2.0 * DIFFERENCE)
        return residual, matrix

    def _hill(self, y: Array) -> Complex:
        """L of the unknowns; at a flip of the orders -K - 1 ... K, so that their frequencies are those of each sign."""
        machine, here = self.plane.machine(y), self.plane.cycle(self.motion_of(y))
        motion, c = unpacked(here[:-2], machine.size), machine.size
        nu, omega = float(here[-2] * machine.pace), float(here[-1] * machine.pace)
        most = len(motion) - 1 + SPARE
        orders = np.arange(-most - (not self.torus), most + 1)
        frequencies = np.asarray((orders + self.shift(y)) * nu, dtype=float)
        loads, _ = loads_along(machine, motion, nu, omega)
        apart = orders[:, None] - orders[None, :]
        by_u, by_v = (_of_order(slope, apart) for slope in (loads.by_u, loads.by_v))
        passing = transfer(machine, frequencies, omega)
        slope = by_u + 1j * frequencies[None, :, None, None] * by_v
        same = np.arange(len(orders))
        slope[same, same] += passing.kappa[:, :, None] * np.eye(c)
        matrix = -np.einsum("kab,klbd->kald", passing.values, slope).reshape(len(orders) * c, -1)
        return np.asarray(matrix + np.eye(len(matrix)))


def _of_order(samples: Array, orders: NDArray[np.int64]) -> Complex:
    """Harmonics of samples (n, ...) of orders of both signs; zero where there are more than samples tell apart."""
    most = len(samples) // 2 - 1
    one = harmonics_of(samples, most)
    kept = np.minimum(np.abs(orders), most)
    found = np.where((orders < 0)[..., None, None], np.conj(one[kept]), one[kept])
    return np.asarray(np.where((np.abs(orders) > most)[..., None, None], 0.0, found))


def _symmetric(vector: Complex, c: int) -> Complex:
    """A vector of the orders -K - 1 ... K, turned so that harmonics of frequencies +- w are conjugate."""
    mirrored = np.conj(vector.reshape(-1, c)[::-1].ravel())
    turn = complex(np.vdot(vector, mirrored))
    return np.asarray(vector * np.sqrt(turn / abs(turn)))
