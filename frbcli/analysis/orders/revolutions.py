"""The motion of a run by orders: how far it moves with a multiple of the rotor speed, exact whatever the speed does.

A motion z of order q, z = A exp(i q phi) with the rotor's angle phi, is constant when it is multiplied by
exp(-i q phi). Its mean under a window w of R revolutions is A: with the angle psi = integral of |omega| that the rotor
has passed, either way,

    A(psi_c) = integral of z exp(-i q phi) w(psi - psi_c) dpsi / integral of w dpsi.

The samples are even in time. So the integrand is summed up from sample to sample, which neither resamples the motion
nor loses any of it, and read at even angles: what lies between two of them is a cell, on which w is constant. The
samples pass piece by piece, and only cells that a window still needs are kept.

A Hann window is blind to the orders q + j/R, |j| >= 2, and nearly blind to what lies further off; its square is blind
to the orders with |j| >= 3, and suppresses the rest far more: a whip may move a disk by millimetres where unbalance
moves it by micrometres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.analysis import signals
from frbcli.analysis.signals import RunLike
from frbcli.analysis.spectra.spectrum import fast_length, hann
from frbcli.arrays import Array, Complex

CELLS = 32  # per revolution
STEPS = 8  # angles per revolution at which orders are known
START_s = 0.3  # the rotor falls from its starting position to its place in the first tenths of a second ...
START_SWEEP = 27.0  # ... and in a ramp of r Hz/s in a time T with r T^2 of so much: small rotors run up fast
START_CORNERS = 21  # moments between which the ramp is taken
START_REVOLUTIONS = 5.0


@dataclass(frozen=True)
class Revolutions:
    """Even steps of the angle that the rotor has passed, in either sense: revolution (m,), the time (m,) when each is
    reached and the speed (m,) there, which is negative where the rotor turns the other way round."""

    revolution: Array
    time_s: Array
    speed_Hz: Array

    @property
    def settled(self) -> int:
        """The first step after the start of the run."""
        if len(self.time_s) < 2:
            return len(self.time_s)
        corners = np.linspace(self.time_s[0], self.time_s[-1], START_CORNERS)  # few: a measured speed scatters
        speed = np.interp(corners, self.time_s, self.speed_Hz)
        ramp = float(np.max(np.abs(np.diff(speed)))) / float(corners[1] - corners[0])
        start_s = min(START_s, (START_SWEEP / ramp) ** 0.5) if ramp > 0.0 else START_s
        by_angle = np.searchsorted(self.revolution, START_REVOLUTIONS)
        return int(max(by_angle, np.searchsorted(self.time_s, self.time_s[0] + start_s)))


@dataclass(frozen=True)
class Tracked:
    """A track: the order of a point's motion x + iy under windows of so many revolutions, Hann windows or
    a power of them.

    An order is positive for motion that turns with the rotor, also where that turns the other way round.
    """

    kind: str
    name: str
    order: float
    window: int
    power: int = 1

    @property
    def half(self) -> int:
        """Steps from an end of a window to its middle."""
        return self.window * STEPS // 2


def track(run: RunLike, wanted: Sequence[Tracked]) -> tuple[Revolutions, list[Complex]]:
    """The steps (m,) of a run, and of each of the motions wanted its complex amplitude (m - 2 half,) in m, seen from a
    frame that turns with its order: value i belongs to step i + half. Empty where the run is shorter than a window."""
    rotor, windows = _Rotor(), [_Window(one) for one in wanted]
    sums = {(one.kind, one.name, one.order): _Sum() for one in wanted}
    for start, stop in signals.pieces(len(run)):
        first = max(0, start - 1)  # a piece begins with the last sample of the one before
        time_s, speed = (signals.piece(run, name, first, stop) for name in ("time_s", "speed_Hz"))
        piece = rotor.take(time_s, speed)
        motions = {node: signals.motion_of(run, *node, first, stop) for node in {key[:2] for key in sums}}
        still = {order: np.exp(-2j * np.pi * order * piece.angle) for order in {abs(key[2]) for key in sums}}
        still |= {-order: np.conj(turning) for order, turning in still.items()}
        cells = {key: whole.take(motions[key[:2]] * still[key[2]], piece) for key, whole in sums.items()}
        for window in windows:
            window.take(cells[window.key])
    turns = rotor.turns()
    return turns, [window.means(len(turns.revolution)) for window in windows]


@dataclass(frozen=True)
class _Piece:
    """Samples (n,) of a run: angle, and passed angle, in revolutions; edges (k,) of cells that are among them, the
    sample before each, and how far it lies beyond that one."""

    angle: Array
    passed: Array
    edges: Array
    before: np.typing.NDArray[np.intp]
    beyond: Array


class _Rotor:
    """The rotor's angle from the beginning of a run, and the moments of even steps of it."""

    def __init__(self) -> None:
        self._angle = self._passed = 0.0
        self._edges = 0
        self._times: list[Array] = []
        self._speeds: list[Array] = []

    def take(self, time_s: Array, speed: Array) -> _Piece:
        turned = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time_s)
        angle = self._angle + np.append(0.0, np.cumsum(turned))
        passed = self._passed + np.append(0.0, np.cumsum(np.abs(turned)))
        numbers = np.arange(self._edges, np.ceil(passed[-1] * CELLS))
        edges = numbers / CELLS
        before = np.clip(np.searchsorted(passed, edges, side="right") - 1, 0, max(len(passed) - 2, 0))
        steps = edges[numbers % (CELLS // STEPS) == 0.0]
        times = np.interp(steps, passed, time_s)
        self._times.append(times)
        self._speeds.append(np.interp(times, time_s, speed))
        self._angle, self._passed = float(angle[-1]), float(passed[-1])
        self._edges += len(edges)
        return _Piece(angle, passed, edges, before, edges - passed[before])

    def turns(self) -> Revolutions:
        times, speeds = (np.concatenate([np.empty(0), *blocks]) for blocks in (self._times, self._speeds))
        return Revolutions(np.arange(len(times)) / STEPS, times, speeds)


class _Sum:
    """The integral of z exp(-i q phi) over the passed angle, from cell to cell."""

    def __init__(self) -> None:
        self._whole = self._edge = 0.0 + 0.0j  # up to the last sample, and to the last edge
        self._begun = False

    def take(self, seen: Complex, piece: _Piece) -> Complex:
        """Means over the cells that end in a piece; seen (n,): the integrand at its samples."""
        between = np.diff(piece.passed)
        whole = self._whole + np.append(0.0, np.cumsum(0.5 * (seen[1:] + seen[:-1]) * between))
        self._whole = complex(whole[-1])
        if len(piece.edges) == 0:
            return np.empty(0, dtype=np.complex128)
        here, step = piece.before, np.maximum(between[piece.before], 1e-300)
        rising = 0.5 * (seen[here + 1] - seen[here]) * np.minimum(piece.beyond / step, 1.0)
        edges = whole[here] + (seen[here] + rising) * piece.beyond  # between two samples the integrand is straight
        sums = np.diff(edges, prepend=self._edge) if self._begun else np.diff(edges)
        self._edge, self._begun = complex(edges[-1]), True
        return np.asarray(sums * CELLS)


class _Window:
    """Means of cells under a window that moves on by a step at a time."""

    def __init__(self, one: Tracked) -> None:
        self.key = one.kind, one.name, one.order
        self._half = one.half
        shape = hann(2 * CELLS * one.window)[1::2] ** one.power  # at the middles of the cells
        self._shape = shape / shape.sum()
        self._first = 0  # number of the first cell in reach
        self._reach = np.empty(0, dtype=np.complex128)
        self._means: list[Complex] = []

    def take(self, cells: Complex) -> None:
        width, every = len(self._shape), CELLS // STEPS
        reach = np.concatenate([self._reach, cells])
        if len(reach) >= width:
            length = fast_length(len(reach))
            through = np.fft.ifft(np.fft.fft(reach, length) * np.fft.fft(self._shape, length))[width - 1 : len(reach)]
            self._means.append(through[-self._first % every :: every].copy())  # a view would keep all of it
        kept = max(0, len(reach) - width + 1)
        self._first, self._reach = self._first + kept, reach[kept:].copy()

    def means(self, steps: int) -> Complex:
        """(m - 2 half,) of m steps in all."""
        means = np.concatenate([np.empty(0, dtype=np.complex128), *self._means])
        self._means.clear()
        return means[: max(0, steps - 2 * self._half)]
