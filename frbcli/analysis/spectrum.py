"""Spectra over time of the motion of a journal or a disk.

A frequency that changes within a window lowers and widens its line. By default the length of the windows follows from
the ramp of the rotor speed, with enough resolution to separate the lines of interest; the remaining loss of the
synchronous line is computed and stated. Amplitudes of order_tracking.py do not depend on the ramp.

Peaks of a curve, how far each stands out of it, intervals in which it is high, and where between two samples it
crosses a level.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from frbcli.analysis.signals import PIECE, SignalColumn, course, steepest_ramp
from frbcli.arrays import Array, Complex
from frbcli.errors import input_error

Direction = Literal["x", "y", "forward"]
DIRECTIONS: tuple[Direction, ...] = ("x", "y", "forward")

LONGEST_s = 0.2  # of a window that nothing else asks to be longer: what lasts a fifth of a second is still seen
SWEEP = 1.0  # r T^2 of the window that a ramp of r Hz/s asks for: it reads 0.05 dB low
WINDOW = (0.4243801, 0.4973406, 0.0782793)  # Nuttall 1981, three terms: side lobes at -71.4 dB, below what is drawn
PARTED = 2.3  # widths 1 / T between two lines that this window parts
HALF = 0.5  # order of oil whirl, which has to be parted from the rotor speed ...
FROM_SPEED = 0.25  # ... from this share of the highest speed upwards
WINDOWS = 4  # a run shorter than this many windows gets shorter ones
FEWEST = 8  # samples of a window
PADDING = 4  # a sinusoid between two lines of the padded spectrum loses less than 1 % of its height
BLOCK = 2**20  # values of padded windows that are in memory at a time
FLOOR_dB = -200.0  # level of no motion
UNEVEN = 1e-3  # relative deviation of a sample's time that is more than round-off
ROUNDING = 8.0  # last bits of a time, likewise

SWEEP_OF_A_PANEL, POINTS = 8.0, 24  # a panel has at most 2 pi of phase, which so many Gauss points integrate exactly

FACTORS = (2, 3, 5)


@dataclass(frozen=True)
class Spectrogram:
    """Spectra over time.

    time_s (m,): middle of each window; speed_Hz (m,): rotor speed there; frequency_Hz (k,); amplitude (k, m): peak
    amplitude in m; level_dB (k, m): the same relative to the clearance; window_s: length of the windows; low_dB (m,):
    by how much the synchronous line reads low, because the rotor speed changes during the window. A line of order q is
    smeared by q times the ramp.
    """

    time_s: Array
    speed_Hz: Array
    frequency_Hz: Array
    amplitude: Array
    level_dB: Array
    window_s: float
    low_dB: Array


def waterfall(
    time_s: SignalColumn,
    x: SignalColumn,
    y: SignalColumn,
    speed_Hz: SignalColumn,
    clearance: float,
    window_s: float | None = None,
    overlap: float = 0.9,
    max_frequency_Hz: float | None = None,
    direction: Direction = "x",
    most: int | None = None,
) -> Spectrogram:
    """Compute short-time spectra of a motion.

    Parameters
    ----------
    time_s : array_like
        Even times (n,) in s.
    x, y : array_like
        The motion (n,) in m.
    speed_Hz : array_like
        Rotor speed (n,) in Hz. All four may be anything with a length that gives slices.
    clearance : float
        Length in m that is 0 dB.
    window_s : float, optional
        Length of the windows in s, from each of which a straight line is subtracted; by default it parts the rotor
        speed and its half. Their side lobes are at -71 dB (A. H. Nuttall, IEEE Trans. ASSP 29, 1981, three terms).
    overlap : float
        Share of a window that the next one sees again.
    max_frequency_Hz : float, optional
        Up to where spectra are kept.
    direction : {"x", "y", "forward"}
        The one-sided spectrum of a coordinate, or the part of x + iy that turns with the rotor.
    most : int, optional
        So many spectra, each of them the largest of neighbouring ones where there are more.

    Returns
    -------
    Spectrogram
        Amplitudes in m and levels in dB; a steady sinusoid of amplitude A shows as A.

    Raises
    ------
    InputError
        If the window or the overlap does not fit the samples, or these are not evenly spaced.

    Examples
    --------
    >>> import frbcli
    >>> import numpy as np
    >>> t = np.arange(8000) / 4000.0
    >>> x = 1e-5 * np.cos(2 * np.pi * 100.0 * t)
    >>> found = frbcli.waterfall(t, x, 0.0 * x, np.full(8000, 100.0), 35e-6)
    >>> bool(abs(found.amplitude.max() - 1e-5) < 1e-7)
    True
    """
    _check(direction, overlap)
    step = _step(time_s)
    if window_s is None:
        window_s = max(window_length(time_s, speed_Hz), FEWEST * step)
    length = _samples(window_s, step, len(time_s))
    first = _starts(len(time_s), length, max(1, round(length * (1.0 - overlap))))
    group = 1 if most is None else -(-len(first) // most)
    groups = [first[begin : begin + group] for begin in range(0, len(first), group)]
    transform = _transform(length, step, direction == "forward", max_frequency_Hz)
    amplitude, middles, speed, swept = _spectra(groups, transform, x, y, speed_Hz, direction)
    time = float(time_s[0:1][0]) + step * middles
    level = 20.0 * np.log10(np.maximum(amplitude / clearance, 10.0 ** (FLOOR_dB / 20.0)))
    lost = np.maximum(0.0, -20.0 * np.log10(chirp_height(swept * window_s)))
    return Spectrogram(time, speed, transform.frequency, amplitude, level, window_s, lost)


@dataclass(frozen=True)
class _Transform:
    """window: (length,) with the sum 1; trend: (length,) the time of each sample, without the mean under the window and
    divided by the square of its size there; padded: samples of a transform; frequency: (kept,) Hz of its lines."""

    window: Array
    trend: Array
    padded: int
    frequency: Array


def _transform(length: int, step: float, two_sided: bool, most_Hz: float | None) -> _Transform:
    """Windows of `length` samples that are `step` s apart. most_Hz: of the lines that are kept."""
    window, padded = cosine_window(length, WINDOW), fast_length(PADDING * length)
    window /= window.sum()
    trend = np.arange(length) - window @ np.arange(length)
    frequency = np.arange((padded + (1 if two_sided else 2)) // 2) / (padded * step)
    kept = int(np.count_nonzero(frequency <= (np.inf if most_Hz is None else most_Hz)))
    return _Transform(window, trend / np.sqrt(window @ trend**2), padded, frequency[:kept])


def _spectra(
    groups: list[NDArray[np.int64]], transform: _Transform, x: SignalColumn, y: SignalColumn, speed_Hz: SignalColumn,
    direction: Direction,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """The largest lines (kept, m) of m groups of windows that begin at samples; (m,) the sample in the middle of each,
    the speed there, and by how much it changes within a window at most."""
    length = len(transform.window)
    amplitude, (middles, speed, swept) = np.zeros((len(transform.frequency), len(groups))), np.empty((3, len(groups)))
    for column, starts in enumerate(groups):
        low, high = int(starts[0]), int(starts[-1]) + length
        middle = int(starts[len(starts) // 2]) + length // 2
        turning = speed_Hz[low:high]
        middles[column], speed[column] = middle, turning[middle - low]
        swept[column] = np.max(np.abs(turning[starts - low + length - 1] - turning[starts - low]))
        motion = x[low:high] + 1j * y[low:high] if direction == "forward" else {"x": x, "y": y}[direction][low:high]
        for lines in _lines(motion, starts - low, transform):
            np.maximum(amplitude[:, column], lines, out=amplitude[:, column])
    return amplitude, middles, speed, swept


def _check(direction: str, overlap: float) -> None:
    if direction not in DIRECTIONS:
        raise input_error("spectrum", "direction", direction, "is unknown.", f"Use one of {', '.join(DIRECTIONS)}.")
    if not 0.0 <= overlap < 1.0:
        raise input_error("spectrum", "overlap", str(overlap), "is not a share of the window.", "Use 0 to 0.99.")


def _samples(window_s: float, step: float, count: int) -> int:
    """Samples of a window. Raises InputError if it does not fit a run of `count` of them, `step` s apart."""
    length = round(window_s / step) if np.isfinite(window_s) else 0
    if not FEWEST <= length <= count:
        limits = f"Use more than {FEWEST * step:g} s, up to {step * count:g} s."
        raise input_error("spectrum", "window", f"{window_s:g} s", "does not fit the run.", limits)
    return length


def window_length(time_s: SignalColumn, speed_Hz: SignalColumn, apart_Hz: float | None = None) -> float:
    """The length in s of the windows that fit a run (n,): 1 / sqrt(r) in a ramp of r Hz/s, at most LONGEST_s; longer
    where lines that are apart_Hz from each other would else not be parted; at most a quarter of the run.

    apart_Hz: by default between the rotor speed and its half, from a quarter of the highest speed upwards.
    """
    time, speed = course(time_s, speed_Hz)
    duration, top, ramp = float(time[-1] - time[0]), float(np.max(np.abs(speed))), steepest_ramp(time_s, speed_Hz)
    length = min(LONGEST_s, (SWEEP / ramp) ** 0.5) if ramp > 0.0 else LONGEST_s
    apart = HALF * FROM_SPEED * top if apart_Hz is None else apart_Hz
    return min(max(length, PARTED / apart if apart > 0.0 else 0.0), duration / WINDOWS)


def _starts(count: int, length: int, hop: int) -> NDArray[np.int64]:
    """First samples of the windows that lie wholly inside the run; the middle of each is a multiple of `hop`."""
    middle = length // 2
    first = -(-middle // hop) * hop - middle
    return np.arange(first if first + length <= count else 0, count - length + 1, hop)


def _lines(motion: Array | Complex, starts: NDArray[np.int64], transform: _Transform) -> Iterator[Array]:
    """Peak amplitudes (kept,) of the windows of `motion` at `starts`, each without the straight line that is closest to
    it under the window: what stands or drifts is no motion, and a whirl leaves no line at 0."""
    window, trend, padded, kept = transform.window, transform.trend, transform.padded, len(transform.frequency)
    at_a_time = max(1, BLOCK // padded)
    for begin in range(0, len(starts), at_a_time):
        seen = np.stack([motion[start : start + len(window)] for start in starts[begin : begin + at_a_time]])
        seen = (seen - np.outer(seen @ window, np.ones_like(trend)) - np.outer(seen @ (window * trend), trend)) * window
        if np.iscomplexobj(seen):
            yield from np.abs(np.fft.fft(seen, padded)[:, :kept])
            continue
        lines = np.abs(np.fft.rfft(seen, padded)[:, :kept])
        lines[:, 1 : (padded + 1) // 2] *= 2.0  # the other half is at negative frequencies
        yield from lines


def _step(time_s: SignalColumn) -> float:
    """The time between two samples in s; raises InputError if there is no such thing."""
    count = len(time_s)
    if count < 2:
        raise input_error("spectrum", "time_s", "", "has fewer than two samples.", "Resume the run.")
    begin, end = float(time_s[0:1][0]), float(time_s[count - 1 : count][0])
    step = (end - begin) / (count - 1)
    pieces = ((first, time_s[first : first + PIECE]) for first in range(0, count, PIECE))
    off = (np.max(np.abs(piece - begin - step * np.arange(first, first + len(piece)))) for first, piece in pieces)
    rounding = ROUNDING * max(abs(begin), abs(end)) * float(np.finfo(float).eps)  # times since 1970 are large
    if not step > 0.0 or not all(deviation <= UNEVEN * step + rounding for deviation in off):
        raise input_error("spectrum", "time_s", "", "is not evenly spaced.", "Use the run as frb wrote it.")
    return step


def chirp_height(sweep: Array) -> Array:
    """Height of the line of a motion of amplitude 1 whose frequency rises or falls evenly, at the middle of a window.

    sweep: any shape, r T^2 for a frequency that changes by r Hz/s and a window of T s. With u = t/T from -1/2 to 1/2
    the height is | integral of w(u) exp(i pi r T^2 u^2) du | for the window w with the mean 1, twice that from 0. It
    has a closed form of Fresnel integrals, which take a tenth of the time of a picture to import.
    """
    c = np.asarray(sweep, dtype=np.float64)
    panels = 1 + int(np.max(np.abs(c), initial=0.0) / SWEEP_OF_A_PANEL)
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    total = np.zeros(c.shape, dtype=np.complex128)
    for panel in range(panels):
        for point, weight in zip(points, weights, strict=True):
            u = 0.5 * (panel + 0.5 * (1.0 + point)) / panels
            window = sum(term * np.cos(2.0 * np.pi * k * u) for k, term in enumerate(WINDOW)) / WINDOW[0]
            total += 0.5 * weight / panels * window * np.exp(1j * np.pi * c * u**2)
    return np.asarray(np.abs(total))


def hann(length: int) -> Array:
    """(n,) values of a Hann window that repeats after its length."""
    return cosine_window(length, (0.5, 0.5))


def cosine_window(length: int, terms: Sequence[float]) -> Array:
    """(n,) values of a window that repeats after its length: the sum of (-1)^k terms[k] cos(2 pi k i / n)."""
    angle = 2.0 * np.pi * np.arange(length) / length
    return np.asarray(sum((-1) ** k * term * np.cos(k * angle) for k, term in enumerate(terms)), dtype=np.float64)


def fast_length(least: int) -> int:
    """The least length of at least so much whose prime factors are 2, 3 and 5."""
    length = least
    while True:
        rest = length
        for factor in FACTORS:
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length += 1


@dataclass(frozen=True)
class Peak:
    """A local maximum. place: its sample; prominence: how far it stands out of the higher of its two sides, each of
    which reaches to the next higher sample or to the end of the curve; rise: how far it stands out of the side before
    it; before, after: the last and the first sample on its flanks that are at most half of the prominence below it, so
    to say half-way up."""

    place: int
    prominence: float
    rise: float
    before: int
    after: int


def local_maxima(values: Array, least: float = -np.inf) -> NDArray[np.intp]:
    """Samples of `values` (n,) of at least this height that are higher than both neighbours."""
    inner = values[1:-1]
    return np.flatnonzero((inner > values[:-2]) & (inner >= values[2:]) & (inner >= least)) + 1


def summit(left: float, here: float, right: float) -> float:
    """Where the parabola through three neighbouring samples, the middle one at 0, has its top: at most half-way to the
    next sample."""
    bend = left - 2.0 * here + right
    return float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if bend < 0.0 else 0.0


def crossing(values: Array, place: int, level: float, step: int) -> float:
    """Where `values` (n,), which are positive, cross a level between the sample `place`, which reaches it, and the next
    one in the direction of `step`, -1 or 1. What grows or dies is straight over the logarithm. The place itself if the
    next sample is as high, or the curve ends there."""
    if not 0 <= place + step < len(values) or values[place + step] >= level:
        return float(place)
    here, beyond = np.log(values[place]), np.log(max(values[place + step], 1e-300))
    return place + step * float((here - np.log(level)) / (here - beyond))


def prominent_peaks(values: Array, least: float) -> list[Peak]:
    """The peaks of `values` (n,) with at least this prominence, which is greater than zero."""
    if len(values) < 3:
        return []
    found = []
    for place in swings(values, least):
        height = values[place]
        left, right = _foot(values[:place][::-1], height), _foot(values[place + 1 :], height)
        prominence = float(height - max(left, right))
        if prominence >= least:
            half = height - 0.5 * prominence
            before = place - 1 - int(np.argmax(values[:place][::-1] <= half))
            after = place + 1 + int(np.argmax(values[place + 1 :] <= half))
            found.append(Peak(int(place), prominence, float(height - left), before, after))
    return found


def swings(values: Array, least: float) -> list[int]:
    """The maxima from which `values` (n,) fall by `least` before they rise beyond them: few of many in noise."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(values)), prepend=0.0) != 0.0)
    swings: list[int] = []
    lowest, top = np.inf, -1  # since the last swing; the highest sample that is `least` above the lowest one
    for place in np.append(turns, len(values) - 1).tolist():
        value = values[place]
        if top < 0:
            lowest = min(lowest, value)
            top = place if value - lowest >= least else -1
        elif value > values[top]:
            top = place
        elif values[top] - value >= least:
            swings.append(top)
            lowest, top = value, -1
    return swings


def _foot(side: Array, height: float) -> float:
    """The lowest value of a side (n,) of a peak, seen from the peak, before it rises above the peak."""
    higher = side > height
    end = int(np.argmax(higher)) if higher.any() else len(side)
    return float(side[:end].min(initial=height))


def intervals_above(amplitude: Array, begins: float, ends: float, pause: int) -> Iterator[tuple[int, int]]:
    """First and one past the last sample of each interval above `begins`, where dips shorter than `pause` do not count.

    An interval must fall below `ends` to be over, and counts to where it last was above `begins`.
    """
    above = np.flatnonzero(amplitude >= begins)
    if len(above) == 0:
        return
    low = np.concatenate([[0], np.cumsum(amplitude < ends)])
    gaps = np.diff(above)
    breaks = np.flatnonzero((gaps > pause) & (low[above[1:]] > low[above[:-1]]))
    firsts, lasts = above[np.concatenate([[0], breaks + 1])], above[np.concatenate([breaks, [len(above) - 1]])]
    for first, last in zip(firsts, lasts, strict=True):
        still_there = low[-1] == low[last]
        yield int(first), len(amplitude) if still_there else int(last) + 1
