"""Amplitudes by order: motion of a journal or a disk at a multiple of the rotor speed, exact whatever the speed does,
also in a ramp.

A motion z of order q, z = A exp(i q phi) with the rotor's angle phi, is constant when it is multiplied by exp(-i q
phi). Its mean under a window w of R revolutions is A: with the angle psi = integral of |omega| that the rotor has
passed, either way,

    A(psi_c) = integral of z exp(-i q phi) w(psi - psi_c) dpsi / integral of w dpsi.

The samples are even in time. So the integrand is summed up from sample to sample, which neither resamples the motion
nor loses any of it, and read at even angles: what lies between two of them is a cell, on which w is constant. The
samples pass piece by piece, and only cells that a window still needs are kept.

A Hann window is blind to the orders q + j/R, |j| >= 2, and nearly blind to what lies further off; its square is blind
to the orders with |j| >= 3, and suppresses the rest far more: a whip may move a disk by millimetres where unbalance
moves it by micrometres.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.analysis import signals
from frbcli.analysis.signals import RunLike, located, point_of
from frbcli.analysis.spectrum import DIRECTIONS, Direction, fast_length, hann
from frbcli.arrays import Array, Complex
from frbcli.errors import input_error

CELLS = 32  # per revolution
STEPS = 8  # angles per revolution at which orders are known
START_s = 0.3  # the rotor falls from its starting position to its place in the first tenths of a second ...
START_SWEEP = 27.0  # ... and in a ramp of r Hz/s in a time T with r T^2 of so much: small rotors run up fast
START_CORNERS = 21  # moments between which the ramp is taken
START_REVOLUTIONS = 5.0
REVOLUTIONS = 16  # of the window, by default: it parts orders that are a fifth from each other
FEWEST, MOST = 3, 1024
HIGHEST = 100.0  # order


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


@dataclass(frozen=True)
class OrderTrack:
    """The motion of a point with an order of the rotor speed, at even angles of the rotor.

    order: multiple of the rotor speed; signal: the point; revolutions: of the windows; time_s (m,), speed_Hz (m,):
    middle of each window and rotor speed there; forward, backward (m,): complex amplitudes in m of what turns with the
    rotor and against it, x + iy = forward exp(i order phi) + backward exp(-i order phi) with the rotor's angle phi.
    """

    order: float
    signal: str
    revolutions: int
    time_s: Array
    speed_Hz: Array
    forward: Complex
    backward: Complex

    def after(self, time_s: float) -> OrderTrack:
        """The windows that begin after a time in s, all if that is before the run; maybe none."""
        if time_s < 0.0:
            return self
        half = self.revolutions * STEPS // 2  # a window begins where another one has its middle
        first = int(np.searchsorted(self.time_s, time_s)) + half
        parts = {name: getattr(self, name)[first:] for name in ("time_s", "speed_Hz", "forward", "backward")}
        return replace(self, **parts)

    def along(self, direction: Direction = "x") -> Complex:
        """Complex amplitude (m,) in m of x = Re(A exp(i order phi)), y = Re(A exp(i order phi)), or the forward one.

        direction: "x", "y" or "forward"; InputError for any other."""
        if direction not in DIRECTIONS:
            raise input_error("orders", "direction", direction, "is unknown.", f"Use one of {', '.join(DIRECTIONS)}.")
        if direction == "forward":
            return self.forward
        against = np.conj(self.backward)
        return self.forward + against if direction == "x" else -1j * (self.forward - against)

    def amplitude(self, direction: Direction = "x") -> Array:
        """Peak amplitude (m,) in m."""
        return np.asarray(np.abs(self.along(direction)))

    def phase_deg(self, direction: Direction = "x") -> Array:
        """Phase (m,) in deg to the rotor's angle, continuous."""
        return np.asarray(np.degrees(np.unwrap(np.angle(self.along(direction)))))


def order_track(run: RunLike, order: float, signal: str = "journal", revolutions: int = REVOLUTIONS) -> OrderTrack:
    """Compute the motion of a point with a multiple of the rotor speed, however fast that changes.

    Parameters
    ----------
    run : Run
        A run, which is read in pieces.
    order : float
        Multiple of the rotor speed, above 0.
    signal : str
        The point: "journal", "disk", or the name of a bearing or disk.
    revolutions : int
        Length of the windows, squares of Hann windows, which part orders that are 3/revolutions from each other.

    Returns
    -------
    OrderTrack
        Complex amplitudes in m over time and rotor speed.

    Raises
    ------
    InputError
        For an invalid order or window, a point that the run does not have, or a run that is shorter than a window.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> track = frbcli.order_track(run, 0.5)  # doctest: +SKIP
    >>> track.amplitude("x").max()  # doctest: +SKIP
    """
    return order_tracks(run, (order,), signal, revolutions)[0]


def order_tracks(
    run: RunLike, orders: Sequence[float], signal: str = "journal", revolutions: int = REVOLUTIONS
) -> tuple[OrderTrack, ...]:
    """Several orders at once, in their order; otherwise as order_track. Raises what order_track raises, and InputError
    without an order."""
    wrong = [order for order in orders if not (math.isfinite(order) and 0.0 < order <= HIGHEST)]
    if wrong or not orders:
        value = ", ".join(f"{order:g}" for order in wrong)
        raise input_error("orders", "order", value, f"is not between 0 and {HIGHEST:g}.", "Use e.g. 1 or 0.5.")
    if not FEWEST <= revolutions <= MOST or int(revolutions) != revolutions:
        limits = f"Use {FEWEST} to {MOST} whole revolutions."
        raise input_error("orders", "revolutions", f"{revolutions:g}", "is not a valid window length.", limits)
    point_of(run, signal)  # raises for none
    kind, name = located(run, signal)
    signs = [sign * order for order in orders for sign in (1.0, -1.0)]
    wanted = [Tracked(kind, name, order, int(revolutions), power=2) for order in signs]
    turns, motions = track(run, wanted)
    if len(motions[0]) == 0:
        turned = f"{turns.revolution[-1]:.3g}" if len(turns.revolution) else "no"
        problem = f"of {revolutions} revolutions is longer than the run, which makes {turned}."
        raise input_error("orders", "window", "", problem, "Resume the run, or take a shorter window.")
    inside = slice(wanted[0].half, -wanted[0].half)
    return tuple(
        OrderTrack(order, signal, int(revolutions), turns.time_s[inside], turns.speed_Hz[inside], forward, backward)
        for order, forward, backward in zip(orders, motions[::2], motions[1::2], strict=True)
    )
