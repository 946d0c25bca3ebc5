"""Whirl and whip in floating ring bearings: which film drives them, and when they lock into a mode of the rotor.

The films of a floating ring whirl with about half the sum of the speeds of their surfaces: the inner one with
(omega_R + omega_F)/2, the outer one with omega_F/2, until the frequency locks into a natural mode. Several whirls
follow each other or go on at the same time, so each is followed as a ridge of the forward spectrum over time. A jump
of the frequency ends a ridge and begins another one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from frbcli.analysis import signals
from frbcli.analysis.signals import PIECE, RunLike, ring_speed_of, signal_of, steepest_ramp
from frbcli.analysis.spectrum import crossing, fast_length, hann, local_maxima, summit
from frbcli.arrays import Array, Complex

Side = Literal["inner", "outer"]
SIDES: tuple[Side, ...] = ("inner", "outer")

LONGEST_s = 0.1  # of a window: separates frequencies 20 Hz apart, and is short against a run-up of some seconds
SWEEP = 3.0  # r T^2 of the window T in a ramp of r Hz/s, in which a whirl moves by its width at most
HOPS = 10  # steps from window to window in the length of one
PADDING = 4
NEARER = 4  # times that the frequency of a motion without a peak is sought half a line nearer
SLOWEST = 2.0  # periods per window: what is slower is the journal that moves to its place
SYNCHRONOUS = 0.8  # share of the rotor speed above which motion is synchronous

BEGINS, ENDS = 0.025, 0.0125  # amplitude over the room that the journal has, C_i + C_o
SIDE_LOBES = 0.05  # share of the strongest ridge: less than that is its side lobe under the window
DRIFT = 0.6  # lines of the spectrum by which a ridge may move from one window to the next
PAUSE = 5  # windows that a ridge may miss
BEGINNING = 20  # windows in which a combination of two whirls shows what it is
FAINT = 0.12  # share of all others that a whirl exceeds at some time: nonlinear films also cause small lines
SAME_LINE = 0.5  # lines of the spectrum between two frequencies that are taken for one
SHORTEST = 1.5  # windows; a shorter ridge is a transient
SHORTEST_REVOLUTIONS = 20.0
RINGS_OUT = 0.4  # share of its logarithmic decay that a free vibration has had half of its time later
LEAST_FALL = np.log(1.5)  # of the amplitude in that time
GROWS = 1.25  # times the amplitude that it begins with: beyond that a self-excited motion grows, and no free vibration

OUTER_UP_TO = 1.4  # times omega_F/2: inner films whirl with a multiple of it, whips included
LEAVES_LINE = 0.95  # share of the frequency of a free whirl below which it is locked into a mode


@dataclass(frozen=True)
class WhirlMoment:
    """A moment of a whirl, as a rule between two windows, and its frequency there."""

    time_s: float
    frequency_Hz: float


@dataclass(frozen=True)
class Whirl:
    """A sub-synchronous motion; the film that drives it. lock_in, offset: None if it does not lock, or lasts up to the
    end of the run; amplitude: the largest one, over the room of the journal; free: whether it dies as a free vibration,
    or has not grown since it began."""

    side: Side
    onset: WhirlMoment
    lock_in: WhirlMoment | None
    offset: WhirlMoment | None
    amplitude: float
    free: bool = False


@dataclass
class _Ridge:
    columns: list[int] = field(default_factory=list)
    frequencies: list[float] = field(default_factory=list)
    amplitudes: list[float] = field(default_factory=list)

    def append(self, column: int, frequency: float, amplitude: float) -> None:
        self.columns.append(column)
        self.frequencies.append(frequency)
        self.amplitudes.append(amplitude)


@dataclass(frozen=True)
class _Windows:
    """Windows of the motion of a journal over its room in m: their width and the hop from one to the next in samples,
    which are step_s apart."""

    run: RunLike
    name: str
    room: float
    width: int
    hop: int
    step_s: float

    def peaks(self, highest_Hz: Array) -> Iterator[list[tuple[float, float]]]:
        """Frequency in Hz and amplitude of the peaks of each forward spectrum, up to a frequency (m,), the strongest
        first."""
        shape = self._shape()
        padded = fast_length(PADDING * self.width)
        line = 1.0 / (padded * self.step_s)
        kept = min(padded // 2, int(float(np.max(highest_Hz)) / line) + 2)
        for seen, highest in zip(self._motions(), highest_Hz, strict=True):
            level = np.abs(np.fft.fft((seen - seen @ shape) * shape, padded)[:kept])
            peaks = []
            for i in local_maxima(level, max(ENDS, SIDE_LOBES * float(level.max()))):
                place = (i + summit(*level[i - 1 : i + 2])) * line
                if SLOWEST / (self.width * self.step_s) <= place <= highest:
                    peaks.append((float(place), float(level[i])))
            yield sorted(peaks, key=lambda peak: -peak[1])

    def continued(self, frequency_Hz: Array, amplitude: Array, first: int, last: int) -> tuple[Array, Array]:
        """Frequency and amplitude of a whirl (windows,), also in the window before the first and after the last one
        that it is seen in: it is too small for a peak of its own there."""
        frequency_Hz, amplitude = frequency_Hz.copy(), amplitude.copy()
        for unseen, seen in ((first - 1, first), (last + 1, last)):
            if 0 <= unseen < len(amplitude) and amplitude[unseen] == 0.0:
                frequency_Hz[unseen], amplitude[unseen] = self._near(unseen, frequency_Hz[seen])
        return frequency_Hz, amplitude

    def _near(self, number: int, frequency_Hz: float) -> tuple[float, float]:
        """The frequency near another one at which a window has the highest level, and this level."""
        start, shape = number * self.hop, self._shape()
        seen = signals.motion_of(self.run, "journal", self.name, start, start + self.width) / self.room
        angle, line = 2.0 * np.pi * self.step_s * np.arange(self.width), 1.0 / (PADDING * self.width * self.step_s)
        weighted = (seen - seen @ shape) * shape
        level = 0.0
        for _ in range(NEARER):
            around = frequency_Hz + line * np.array([-1.0, 0.0, 1.0])
            levels = np.abs(np.exp(-1j * np.outer(around, angle)) @ weighted)
            frequency_Hz, level = frequency_Hz + line * summit(*levels), float(levels.max())
        return frequency_Hz, level

    def _shape(self) -> Array:
        window = hann(self.width)
        return np.asarray(window / window.sum())

    def _motions(self) -> Iterator[Complex]:
        """The motion (width,) in each window, read many windows at a time."""
        starts = range(0, len(self.run) - self.width + 1, self.hop)
        at_a_time = max(1, PIECE // self.hop)
        for group in (starts[first : first + at_a_time] for first in range(0, len(starts), at_a_time)):
            motion = signals.motion_of(self.run, "journal", self.name, group[0], group[-1] + self.width) / self.room
            yield from (motion[start - group[0] : start - group[0] + self.width] for start in group)


def find_whirls(run: RunLike, name: str, room: float, settled_s: float = 0.0) -> tuple[Whirl, ...]:
    """The whirls of the journal in a floating ring bearing, in the order of their beginning.

    room: C_i + C_o in m, which amplitudes are relative to. A whirl must outlast settled_s, when the run has settled;
    one that contact cuts off need not. Of each film the strongest whirl counts: a weaker one ends where it is
    overtaken.
    """
    count, cut_short = len(run), run.status == "contact"
    ends = [signals.piece(run, "time_s", place, place + 1) for place in (0, count - 1)] if count > 1 else []
    step = float(ends[1][0] - ends[0][0]) / (count - 1) if ends else 0.0
    window_s = _window_length(run)
    width, hop = (round(length / step) if step > 0.0 else 0 for length in (window_s, window_s / HOPS))
    if hop < 1 or count < 2 * width:
        return ()
    middle = np.arange(0, count - width + 1, hop) + width // 2
    columns = (signal_of(run, "time_s"), signal_of(run, "speed_Hz"), ring_speed_of(run, name))
    time, speed, ring = (signals.samples(column, middle) for column in columns)
    windows = _Windows(run, name, room, width, hop, step)
    followed = _follow(windows.peaks(SYNCHRONOUS * speed), window_s)
    ridges = [ridge for ridge in followed if max(ridge.amplitudes) >= BEGINS]
    frequencies, amplitudes = _table(ridges, len(middle))
    sides = [_side(row, ring) for row in frequencies]
    whirls = []
    for index, side in enumerate(sides):
        if _combination(index, frequencies, amplitudes, window_s):
            continue
        rivals = [row for other, row in enumerate(amplitudes) if sides[other] == side and other != index]
        strongest = np.max([np.zeros(len(middle)), *rivals], axis=0)
        leads = np.flatnonzero((amplitudes[index] > 0.0) & (amplitudes[index] >= strongest))
        if len(leads) == 0 or np.all(amplitudes[index, leads] < FAINT * amplitudes[:, leads].max(axis=0)):
            continue
        first, last = _begins(amplitudes[index], int(np.searchsorted(time, settled_s))), int(leads[-1])
        at = first + np.flatnonzero(amplitudes[index, first : last + 1])
        lasts = last >= len(middle) - 1 - PAUSE
        shortest = max(SHORTEST * window_s, SHORTEST_REVOLUTIONS / max(float(speed[first]), 1e-9))
        if time[last] - max(time[first], settled_s) < shortest and not (lasts and cut_short and len(at)):
            continue
        on_line = 0.5 * (ring[at] if side == "outer" else speed[at] + ring[at])
        locks = _lock_in(at, frequencies[index, at] - LEAVES_LINE * on_line)
        overtaken = not lasts and amplitudes[index, last + 1] > 0.0
        frequency, amplitude = windows.continued(frequencies[index], amplitudes[index], first, last)
        passed = _overtaken(amplitude - strongest, last) if overtaken else crossing(amplitude, last, ENDS, 1)
        moment = partial(_moment, time_s=time, frequency_Hz=frequency)
        lock_in, offset = None if locks is None else moment(locks), None if lasts else moment(passed)
        onset = moment(crossing(amplitude, first, BEGINS, -1))
        largest = float(amplitude[at].max())
        free = rings_out(amplitude[at]) or largest <= GROWS * amplitude[at[0]]
        whirls.append(Whirl(side, onset, lock_in, offset, largest, free))
    return tuple(sorted(whirls, key=lambda whirl: whirl.onset.time_s))


def window_step_s(run: RunLike) -> float:
    """Time from window to window, which resolves onset, lock-in and offset of a whirl in a floating ring bearing."""
    return _window_length(run) / HOPS


def _window_length(run: RunLike) -> float:
    """Length in s of the windows: a steep ramp asks for short ones."""
    ramp = steepest_ramp(signal_of(run, "time_s"), signal_of(run, "speed_Hz"))
    return min(LONGEST_s, (SWEEP / ramp) ** 0.5) if ramp > 0.0 else LONGEST_s


def _table(ridges: Sequence[_Ridge], count: int) -> tuple[Array, Array]:
    """Frequencies and amplitudes (ridges, count) over the windows, 0 where there is none."""
    frequencies, amplitudes = np.zeros((len(ridges), count)), np.zeros((len(ridges), count))
    for row, ridge in enumerate(ridges):
        frequencies[row, ridge.columns], amplitudes[row, ridge.columns] = ridge.frequencies, ridge.amplitudes
    return frequencies, amplitudes


def _begins(amplitude: Array, settled: int) -> int:
    """The window in which a ridge of an amplitude (windows,) becomes a whirl; settled: the window in which the run has
    settled. The fall of the start is a ridge, too, and may fade into a whirl which grows later; a whirl from the
    beginning of the run grows beyond what the start has left."""
    whirls, fades = amplitude >= BEGINS, (amplitude > 0.0) & (amplitude < BEGINS)
    first = int(np.argmax(whirls))
    faded = first + int(np.argmax(fades[first:]))  # itself: it never does
    falls = first <= settled and amplitude[settled:faded].max(initial=0.0) <= amplitude[first : settled + 1].max()
    return faded + int(np.argmax(whirls[faded:])) if falls and whirls[faded:].any() else first


def _side(frequency: Array, ring: Array) -> Side:
    """The film that drives a ridge (windows,)."""
    there = frequency > 0.0
    return "outer" if np.median(frequency[there]) <= OUTER_UP_TO * np.median(0.5 * ring[there]) else "inner"


def _combination(index: int, frequencies: Array, amplitudes: Array, window_s: float) -> bool:
    """Whether a ridge begins as 2 f_1, f_1 - f_2 or 2 f_1 - f_2 of one or two stronger ones."""
    begins = np.flatnonzero(frequencies[index])[:BEGINNING]
    f, a = frequencies[:, begins], amplitudes[:, begins]
    stronger = [k for k in range(len(f)) if k != index and np.median(a[k]) > np.median(a[index])]
    made = [2 * f[one] for one in stronger]
    made += [factor * f[one] - f[other] for one in stronger for other in stronger if one != other for factor in (1, 2)]
    return any(np.median(np.abs(line - f[index])) < SAME_LINE / window_s for line in made)


def whirl_names(events: Sequence[Mapping[str, Any]]) -> list[str]:
    """The whirls that onset, lock-in and offset of floating rings belong to, "" for other events, in their order.

    Of a symmetric rotor Sub_i and Sub_o, after the film. Of a rotor in several bearings the first whirls of inner films
    are one, the next whirls of inner films another, and whirls of outer films a third: Sub 1, Sub 2 and Sub 3 in the
    order in which they begin.
    """
    names, seen, known = list[str](), Counter[tuple[str, str]](), list[tuple[str, bool]]()
    for event in events:
        kind, film = event["kind"], str(event.get("film") or "")
        bearing, _, side = film.rpartition("_")
        seen[film, kind] += 1
        if kind not in ("onset", "lock-in", "offset") or side not in SIDES:
            names.append("")
        elif not bearing:
            names.append(f"Sub_{side[0]}")
        else:  # whirls end in the order in which they begin, and lock before the next one begins
            number = seen[film, "offset"] if kind == "offset" else seen[film, "onset"]
            whirl = side, side == "inner" and number > 1
            known += [] if whirl in known else [whirl]
            names.append(f"Sub {known.index(whirl) + 1}")
    return names


def with_whirl_names(events: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The events, each with the name of its whirl as "whirl", which tables and pictures show."""
    return [{**event, "whirl": name} for event, name in zip(events, whirl_names(events), strict=True)]


@dataclass(frozen=True)
class WhirlSpan:
    """A whirl of a run from its events: name, as Sub 1, "" where one has none; film: where it is driven, or the point
    that shows it; begin, locked, end: its events, None where it does not lock in or lasts until the end."""

    name: str
    film: str
    begin: Mapping[str, Any]
    locked: Mapping[str, Any] | None = None
    end: Mapping[str, Any] | None = None


def whirls(events: Sequence[Mapping[str, Any]]) -> list[WhirlSpan]:
    """All whirls of a run in the order in which they begin; whirls of a film end in this order, too."""
    spans: list[WhirlSpan] = []
    for event in with_whirl_names(events):
        film = str(event.get("film") or event.get("point") or "")
        own = [number for number, whirl in enumerate(spans) if whirl.film == film and whirl.end is None]
        if event["kind"] == "onset":
            spans.append(WhirlSpan(event["whirl"], film, event))
        elif event["kind"] == "lock-in" and own:
            spans[own[-1]] = replace(spans[own[-1]], locked=event)
        elif event["kind"] == "offset" and own:
            spans[own[0]] = replace(spans[own[0]], end=event)
    return spans


def _follow(spectra: Iterator[list[tuple[float, float]]], window_s: float) -> list[_Ridge]:
    """Peaks of neighbouring spectra that are one motion; a stronger peak takes its ridge first."""
    ridges: list[_Ridge] = []
    active: list[_Ridge] = []
    for column, peaks in enumerate(spectra):
        active = [ridge for ridge in active if column - ridge.columns[-1] <= PAUSE]
        for frequency, amplitude in peaks:
            near = _nearest(active, column, frequency, window_s)
            if near is None:
                near = _Ridge()
                ridges.append(near)
                active.append(near)
            near.append(column, frequency, amplitude)
    return ridges


def _nearest(active: Sequence[_Ridge], column: int, frequency: float, window_s: float) -> _Ridge | None:
    free = [ridge for ridge in active if ridge.columns[-1] < column]
    nearest = min(free, key=lambda ridge: abs(ridge.frequencies[-1] - frequency), default=None)
    if nearest is None or abs(nearest.frequencies[-1] - frequency) > DRIFT / window_s:
        return None
    return nearest


def _moment(place: float, time_s: Array, frequency_Hz: Array) -> WhirlMoment:
    """The moment at a place between windows at even steps of time (m,), in which a whirl has a frequency (m,), 0 where
    it is not seen."""
    at = np.flatnonzero(frequency_Hz)
    when = np.interp(place, np.arange(len(time_s)), time_s)
    return WhirlMoment(float(when), float(np.interp(place, at, frequency_Hz[at])))


def _overtaken(ahead: Array, last: int) -> float:
    """Where a whirl is overtaken that is ahead of all others in the window `last` for the last time; ahead (windows,):
    by how much."""
    here, beyond = float(ahead[last]), float(ahead[last + 1])
    return last + here / (here - beyond)


def rings_out(amplitude: Array) -> bool:
    """Whether a motion (n,) dies at one rate from its largest amplitude on, as a free vibration does that the start of
    a run or a resonance leaves; a whirl keeps its amplitude, and then falls faster and faster."""
    largest = int(np.argmax(amplitude))
    falls = np.log(np.maximum(amplitude[largest:], 1e-300))
    half = falls[0] - falls[len(falls) // 2]
    fallen = falls[0] - falls[-1]
    return len(falls) > len(amplitude) // 2 and bool(fallen >= LEAST_FALL and half >= RINGS_OUT * fallen)


def _lock_in(at: NDArray[np.intp], over: Array) -> float | None:
    """Where a whirl that is seen in the windows `at` (k,) leaves the frequency of a free one for good; over (k,): by
    how much its frequency is above the one at which it does."""
    follows = np.flatnonzero(over >= 0.0)
    if len(follows) == 0 or follows[-1] + 1 >= len(over):
        return None
    begin, end = follows[-1], follows[-1] + 1
    return float(at[begin] + (at[end] - at[begin]) * over[begin] / (over[begin] - over[end]))
