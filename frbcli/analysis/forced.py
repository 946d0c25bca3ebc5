"""Motion that is forced with a known frequency or order, which a run loses before whirl is sought in it.

Forces and the ground of a case have known frequencies f or orders k of the rotor speed. With their phase
theta = 2 pi f t, or k times the angle of the rotor, a signal holds Re(A exp(i theta)) with an amplitude A that changes
slowly. A is the mean of 2 x exp(-i theta) under a Hann window of PERIODS periods; Re(A exp(i theta)) is subtracted.

A measurement does not say what forces it. Lines that keep one frequency over a large range of rotor speeds, such as
mains hum or a shaker, are found from its spectrum.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from frbcli.analysis import signals
from frbcli.analysis.signals import RunLike
from frbcli.analysis.spectrum import fast_length, hann, local_maxima, summit
from frbcli.arrays import Array, Complex

PERIODS = 32  # of a window, which is blind to what is a sixteenth of the frequency away
FEWEST = 8  # periods of the window of a short run
CELLS = 8  # per period
PASSES = 3  # of the subtraction: what changes within a window is left by the first one
RAMP_POINTS = 200  # in which the ramp of an order is determined
CROSSING = 2.5 / PERIODS  # of a frequency: nearer to it unbalance, or a whirl of half the speed, are in the window
SAME = 2.0 / PERIODS  # of a frequency: lines that are nearer to each other are one
TRACKED = "journal", "disk"

MOST_LINES = 8
SHARE_OF_TABLE = 0.1  # of the largest line of a table over time: smaller ones are left out
LEAST_SHARE = 0.8  # share of the mean square of a table that its lines have to hold
LEAST = 0.0125  # amplitude over the clearance of a line in a measurement, half of that from which a whirl counts
WIDEST = 1.2  # ratio of the rotor speeds over which a line has to keep its frequency ...
SPEED_BINS, FEWEST_BINS = 10, 5  # ... in each of so many ranges of it
STEADY = 0.5  # share of its mean amplitude by which a line may differ from it in one range
OF_WHIRL = 0.6  # of the rotor speed: a line that is always below it may be a whip ...
CONSTANT = 1e-3  # ... unless its frequency changes by less than this share


@dataclass(frozen=True)
class ForcedLine:
    """What forces a motion: a frequency in Hz, or else an order of the rotor speed; amplitude: of a line that was found
    in a measurement, over the clearance."""

    frequency_Hz: float = 0.0
    order: float = 0.0
    amplitude: float | None = None


@dataclass(frozen=True)
class _Course:
    """A forced motion along a run: line; amplitudes by signal: passed periods and complex A there, to be summed."""

    line: ForcedLine
    amplitudes: dict[str, list[tuple[Array, Complex]]] = field(default_factory=dict)


class WithoutForced:
    """A run whose journals and disks lack the motion of some lines; a RunLike."""

    def __init__(self, run: RunLike, lines: Sequence[ForcedLine]) -> None:
        self._run = run
        self.signals, self.references, self.status = run.signals, run.references, run.status
        time_s, speed = np.asarray(run["time_s"]), np.asarray(run["speed_Hz"])
        self._time_s = time_s
        self._turned = _passed(time_s, speed) if any(line.order for line in lines) else np.empty(0)
        self._courses = [_Course(line) for line in lines]
        for name in run.signals:
            if not name.startswith(TRACKED) or not name.endswith(("_x_m", "_y_m")):
                continue
            left = np.array(run[name], dtype=float)
            for course in PASSES * self._courses:
                periods = self._periods(course.line, 0, len(left))
                amplitude = _amplitude(left, periods, speed, course.line)
                if amplitude is not None:
                    course.amplitudes.setdefault(name, []).append(amplitude)
                    left -= _motion(*amplitude, periods)

    def __len__(self) -> int:
        return len(self._run)

    def __getitem__(self, name: str) -> Array:
        return self.read(name, 0, len(self))

    def read(self, name: str, start: int, stop: int) -> Array:
        """The samples from start to stop of a signal."""
        seen = signals.piece(self._run, name, start, stop)
        for course in self._courses:
            for amplitude in course.amplitudes.get(name, []):
                seen = seen - _motion(*amplitude, self._periods(course.line, start, stop))
        return seen

    def _periods(self, line: ForcedLine, start: int, stop: int) -> Array:
        """The phase of a line over 2 pi, which rises with time."""
        if line.order:
            return abs(line.order) * self._turned[start:stop]
        return np.asarray(line.frequency_Hz * (self._time_s[start:stop] - self._time_s[0]))


def forced_lines(run: RunLike) -> list[ForcedLine]:
    """What forces a run in addition to its unbalance (order 1), from its references."""
    known = run.references
    lines = [ForcedLine(frequency_Hz=known[name]) for name in known if signals.is_forced(name, "Hz")]
    return lines + [ForcedLine(order=known[name]) for name in known if signals.is_forced(name, "order")]


def without_forced(run: RunLike) -> RunLike:
    """A run without the motion of what forces it; itself where nothing does."""
    lines = forced_lines(run)
    return WithoutForced(run, lines) if lines and len(run) > 1 else run


def lines_of_table(times_s: Array, values: Array) -> tuple[list[float], bool]:
    """Frequencies in Hz of the largest lines of a table, and whether they hold nearly all of its change.

    times_s: (k,) ascending; values: (c, k), linear in between.
    """
    count = fast_length(max(16, 2 * len(times_s)))
    even = np.linspace(times_s[0], times_s[-1], count)
    moved = np.array([np.interp(even, times_s, each) for each in values])
    moved -= moved.mean(axis=1, keepdims=True)
    level = np.sqrt((np.abs(np.fft.rfft(moved * hann(count), 4 * count)) ** 2).sum(axis=0))
    places = local_maxima(level, SHARE_OF_TABLE * float(level.max())) if level.max() > 0.0 else np.empty(0, int)
    line_Hz = (count - 1) / (count * 4 * float(times_s[-1] - times_s[0]))
    frequencies_Hz: list[float] = []
    held = np.zeros(len(level), dtype=bool)
    for place in sorted(places.tolist(), key=lambda each: -float(level[each])):
        frequency = line_Hz * (place + summit(*level[place - 1 : place + 2]))
        if frequency * float(times_s[-1] - times_s[0]) < FEWEST or len(frequencies_Hz) == MOST_LINES:
            continue
        if all(abs(frequency - other) > SAME * other for other in frequencies_Hz):
            frequencies_Hz.append(frequency)
            width = max(SAME * place, 8.0)
            held[max(0, int(place - width)) : int(place + width) + 1] = True
    whole = float((level**2).sum())
    return frequencies_Hz, whole == 0.0 or float((level[held] ** 2).sum()) >= LEAST_SHARE * whole


def constant_lines(run: RunLike, room: float) -> list[ForcedLine]:
    """Lines of a measured journal that keep their frequency over a large range of rotor speeds, the strongest first.
    room: its clearance in m."""
    time_s, speed = np.asarray(run["time_s"]), np.abs(np.asarray(run["speed_Hz"]))
    low, high = np.percentile(speed, [2.0, 98.0])
    if len(time_s) < 2 or room <= 0.0 or high < WIDEST * max(float(low), 1e-9):
        return []
    motion = signals.motion_of(run, "journal", "") / room
    count, step_s = len(motion), float(time_s[-1] - time_s[0]) / (len(motion) - 1)
    shape = hann(count)
    padded = fast_length(2 * count)
    lines = np.abs(np.fft.fft(motion * shape, padded)) / shape.sum()
    level = lines[: padded // 2] + np.append(lines[0], lines[: -(padded // 2) : -1])
    places = [int(each) for each in local_maxima(level, LEAST)]
    kept: list[ForcedLine] = []
    for place in sorted(places, key=lambda each: -float(level[each]))[: 4 * MOST_LINES]:
        frequency = (place + summit(*level[place - 1 : place + 2])) / (padded * step_s)
        near = any(abs(frequency - other.frequency_Hz) <= SAME * other.frequency_Hz for other in kept)
        if near or frequency * count * step_s < 2 * PERIODS or len(kept) == MOST_LINES:
            continue
        if line := _constant(motion, time_s, speed, frequency):
            kept.append(line)
    return kept


def _constant(motion: Complex, time_s: Array, speed: Array, frequency: float) -> ForcedLine | None:
    """The line of a frequency in Hz if it has the same amplitude and frequency in all ranges of the rotor speed."""
    periods = frequency * (time_s - time_s[0])
    line = ForcedLine(frequency_Hz=frequency)
    courses = [_amplitude(each, periods, speed, line) for each in (motion.real, motion.imag)]
    at = courses[0][0] if courses[0] is not None else np.empty(0)
    if courses[0] is None or courses[1] is None or len(at) < 2:
        return None
    both = np.array([courses[0][1], courses[1][1]])
    stronger = both[int(np.argmax(np.abs(both.mean(axis=1))))]
    turns = np.unwrap(np.angle(stronger))
    drift = np.polyfit(at, turns, 1)[0] / (2.0 * np.pi)
    still = both * np.exp(-2j * np.pi * drift * at)
    mean = still.mean(axis=1)
    size = float(np.hypot.reduce(np.abs(mean)))
    here = np.interp(at, periods, speed)
    edges = np.linspace(here.min(), here.max() * (1.0 + 1e-9), SPEED_BINS + 1)
    ranges = [still[:, (here >= low) & (here < high)] for low, high in itertools.pairwise(edges)]
    medians = [np.median(part.real, axis=1) + 1j * np.median(part.imag, axis=1) for part in ranges if part.shape[1]]
    apart = [float(np.hypot.reduce(np.abs(median - mean))) for median in medians]
    if size < LEAST or len(medians) < FEWEST_BINS or max(apart) > STEADY * size:
        return None
    half = len(at) // 2
    rates = [np.polyfit(at[part], turns[part], 1)[0] for part in (slice(half), slice(half, None))]
    wanders = abs(float(rates[1] - rates[0])) / (2.0 * np.pi) > CONSTANT
    if wanders and frequency < OF_WHIRL * float(here.min()):
        return None
    axes = abs(mean[0] + 1j * mean[1]), abs(mean[0] - 1j * mean[1])
    return ForcedLine(frequency * (1.0 + float(drift)), amplitude=0.5 * float(sum(axes)))


def _passed(time_s: Array, speed: Array) -> Array:
    """Revolutions (n,) that a rotor has passed, in either sense."""
    turned = 0.5 * np.abs(speed[1:] + speed[:-1]) * np.diff(time_s)
    return np.append(0.0, np.cumsum(turned))


def _amplitude(seen: Array, periods: Array, speed: Array, line: ForcedLine) -> tuple[Array, Complex] | None:
    """Passed periods (k,) and the amplitude (k,) of a line in a signal (n,) there; None in less than two windows.

    Where the rotor speed, or half of it, passes a frequency the amplitude is straight between both sides.
    """
    width = min(_width(periods, speed, line), int(periods[-1] / 2.0))
    if width < FEWEST:
        return None
    integrand = 2.0 * seen * np.exp(-2j * np.pi * periods)
    whole = np.append(0.0, np.cumsum(0.5 * (integrand[1:] + integrand[:-1]) * np.diff(periods)))
    edges = np.arange(int(periods[-1] * CELLS) + 1) / CELLS
    shape = hann(2 * CELLS * width)[1::2]
    length = fast_length(len(edges) + len(shape))
    cells = np.diff(np.interp(edges, periods, whole)) * CELLS
    through = np.fft.ifft(np.fft.fft(cells, length) * np.fft.fft(shape / shape.sum(), length))
    amplitude = through[len(shape) - 1 : len(cells)]
    at = edges[len(shape) // 2 :][: len(amplitude)]
    known = np.ones(len(at), dtype=bool)
    if line.frequency_Hz:
        here = np.abs(np.interp(at, periods, speed))
        swept = 0.5 * width * np.abs(np.gradient(here, at)) if len(at) > 1 else 0.0
        for share in (1.0, 0.5):
            near = CROSSING * line.frequency_Hz * PERIODS / width + share * swept
            known &= np.abs(share * here - line.frequency_Hz) > near
    return (at[known], amplitude[known]) if known.any() else (at, amplitude)


def _width(periods: Array, speed: Array, line: ForcedLine) -> int:
    """Periods of the window: fewer where an order passes a resonance quickly, which its frequency then crosses in so
    many periods that it moves by their width."""
    if not line.order:
        return PERIODS
    at = np.linspace(0.0, float(periods[-1]), RAMP_POINTS)
    frequency = abs(line.order * np.interp(at, periods, speed))
    swept = float(np.median(np.abs(np.gradient(frequency, at)))) if periods[-1] > 0.0 else 0.0  # Hz per period
    fastest = float(np.median(frequency))
    return int(np.clip(np.sqrt(fastest / swept) if swept > 0.0 else PERIODS, FEWEST, PERIODS))


def _motion(at: Array, amplitude: Complex, periods: Array) -> Array:
    """Motion (n,) of a line at passed periods (n,)."""
    there = np.interp(periods, at, amplitude)
    return np.asarray((there * np.exp(2j * np.pi * periods)).real)


def forced_references(lines: Iterable[ForcedLine]) -> dict[str, float]:
    """Lines as references of a run."""
    references: dict[str, float] = {}
    for number, line in enumerate(lines, start=1):
        kind, value = ("order", line.order) if line.order else ("Hz", line.frequency_Hz)
        references[f"{signals.FORCED}_{number}_{kind}"] = value
    return references
