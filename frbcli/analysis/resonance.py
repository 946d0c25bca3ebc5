"""Vibrations near the rotor speed: critical speeds and self-excited vibrations.

At a critical speed unbalance excites a mode of the rotor in its films: the synchronous motion has a peak there and
turns its phase. In a starved film the journal may vibrate with a frequency of its own near the rotor speed, which
stays constant while the rotor speed changes: this is not a critical speed, though it may begin as one.

The ridges of a run-up: what its synchronous motion and its whirl are at chosen rotor speeds.

They are what a computed and a measured run are compared by: both have them, whatever their samples, and neither needs
a common zero of time, of phase or of place.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.analysis.order_tracking import STEPS, Revolutions, Tracked, order_track
from frbcli.analysis.signals import joined, located
from frbcli.analysis.spectrum import (
    Peak,
    Spectrogram,
    intervals_above,
    prominent_peaks,
    summit,
    swings,
    waterfall,
    window_length,
)
from frbcli.arrays import Array, Complex, Truths
from frbcli.results.records import SPEED, TIME
from frbcli.results.store import Run

REVOLUTIONS = 8  # of the window: a resonance is passed in many more
WHIRL = 0.5  # order of oil whirl
WITHOUT_MOTION = 1.5  # neither whirl nor unbalance nor its harmonics: what is seen there is the background
PROMINENCE = 0.25  # share of its height by which a peak stands out of the higher of its two sides
# The same of the highest peak of a run that begins or ends close to a resonance, or of one that is strongly damped: a
# known critical speed of the machine, and a phase that turns by LAG between the lowest points of both sides, decide.
LOW_PROMINENCE = 0.02
OVER_BACKGROUND = 5.0
FLOOR = 1e-4  # amplitude relative to the clearance; less is round-off of a rotor without unbalance
# By how much the motion falls behind the unbalance from half-way up a peak to half-way down. It is 60 to 130 degrees
# for critical speeds of rotors in oil films, and next to nothing where a film alone changes, because oil goes or comes.
LAG = np.radians(30.0)
NEAR = 0.15  # share of a frequency by which a resonance may differ from a mode: films are not as full, nor as linear
LATE = 1.5  # a ramp of r Hz/s passes a lightly damped mode by up to this times sqrt(r) before the motion is largest

TURNS_BACK = 0.1  # share of the range of speeds by which a speed goes back where a pass ends
LEAST_SWEPT = 2e-3  # share of the speed that passes in a resonance
SAME = 0.02  # share of the speed within which peaks of several points are one resonance
# A ramp of r Hz/s leaves a free vibration behind a resonance, which beats with the unbalance until this times sqrt(r)
# further; its phase turns back between two of these beats.
BEATS, TURNED = 6.0, np.radians(45.0)

WIDE, NARROW = 4, 32  # revolutions: windows for what differs from the order 1, and for what is at it
FURTHEST = 2.0 / NARROW  # from order 1: the long window is blind to what lies further off
BEGINS, ENDS = 0.05, 0.025  # amplitude relative to the clearance, as of whirls
SUSTAINED_REVOLUTIONS = 20.0  # likewise: what dies sooner is the end of a resonance


@dataclass(frozen=True)
class Vibration:
    """A vibration with a frequency of its own: from when, and at which rotor speed, until when it is seen; amplitude:
    the largest one over the clearance, along the longer axis of the orbit."""

    time_s: float
    until_s: float
    speed_Hz: float
    frequency_Hz: float
    amplitude: float


def resonant(kind: str, name: str) -> tuple[Tracked, ...]:
    """The tracks of a disk or journal whose resonance is sought: synchronous motion, background, whirl."""
    orders = (1.0, WITHOUT_MOTION, WHIRL)
    return tuple(Tracked(kind, name, order, REVOLUTIONS) for order in orders)


def near_synchronous(kind: str, name: str) -> tuple[Tracked, ...]:
    """The tracks in which vibrations close to the synchronous one are sought: two windows, both senses."""
    return tuple(Tracked(kind, name, order, window) for order in (1.0, -1.0) for window in (WIDE, NARROW))


def near(frequency: float, modes: Iterable[float], late: float = 0.0) -> bool:
    """Whether a frequency in Hz belongs to one of the modes; late: by how much a ramp may have moved it, Hz."""
    return any(abs(frequency - mode) <= NEAR * mode + late for mode in modes)


@dataclass(frozen=True)
class _Passage:
    """A resonance at a step of the revolutions, in the motion of a point by its number; mode: the known critical speed
    in Hz next to it, None if none is known; turn: by how much the phase turns from the lowest point before the
    resonance to that behind it, rad."""

    step: int
    point: int
    prominence: float
    height: float
    mode: float | None
    turn: float


def critical_steps(
    motions: Sequence[Sequence[Complex]],
    turns: Revolutions,
    floor: float,
    quiet: Sequence[tuple[float, float]],
    modes: Sequence[float] | None,
    vibrations: Sequence[Vibration],
) -> list[tuple[int, int]]:
    """Which of the points shows each critical speed the clearest, and at which step of `turns`, in their order.

    motions: of each disk, or else journal, tracked by `resonant`, in m; floor: m, less is round-off; quiet: spans of
    time in s without whirl; modes: critical speeds in Hz of the linearised machine, None if they are not known; a
    resonance that begins one of the vibrations is none then. Each way up and down in speed has resonances of its own.
    """
    chosen: list[_Passage] = []
    modes = None if modes is None else distinct_modes(modes)
    for pass_ in passes(turns.speed_Hz):
        for span in quiet:
            resonances = [
                each
                for point, tracked in enumerate(motions)
                for each in _in_pass(tracked, turns, (floor, point), pass_, span, modes, vibrations)
            ]
            chosen += _distinct(resonances, turns, modes)
    return [(each.point, each.step) for each in sorted(chosen, key=lambda each: each.step)]


def passes(speed_Hz: Array) -> list[tuple[int, int]]:
    """First and one past the last step of each way up or down of a speed (m,), which may scatter."""
    size = np.abs(speed_Hz)
    least = TURNS_BACK * float(np.ptp(size)) if len(size) else 0.0
    ends = sorted([*swings(size, least), *swings(-size, least)]) if least > 0.0 else []
    inner = [end for end in ends if 0 < end < len(size) - 1]
    return list(itertools.pairwise([0, *inner, len(size)]))


def distinct_modes(modes: Sequence[float]) -> list[float]:
    """Critical speeds in Hz, ascending; of several that share a peak the lowest."""
    kept: list[float] = []
    for mode in modes:
        if not kept or mode > (1.0 + SAME) * kept[-1]:
            kept.append(mode)
    return kept


def _in_pass(
    tracked: Sequence[Complex],
    turns: Revolutions,
    numbers: tuple[float, int],
    pass_: tuple[int, int],
    quiet: tuple[float, float],
    modes: Sequence[float] | None,
    vibrations: Sequence[Vibration],
) -> Iterator[_Passage]:
    """The resonances of a point in one pass and one span of time without whirl. numbers: (floor, number of the point);
    others: see critical_steps."""
    half = REVOLUTIONS * STEPS // 2
    floor, point = numbers
    begins, ends = (int(step) for step in np.searchsorted(turns.time_s, quiet))
    first = max(turns.settled, begins if begins else 0, pass_[0] - half)
    # A whirl may break out in the resonance, whose peak is over a window later.
    cut = pass_[1] < ends
    last, until = (pass_[1] - half, pass_[1] - half) if cut else (ends + half, ends - half)
    motion = [each[first:last] for each in tracked]
    for peak in _resonances(motion, floor, until - first):
        step = first + peak.place + half
        if any(own.time_s <= turns.time_s[step] <= own.until_s for own in vibrations):
            continue
        speed, late = abs(float(turns.speed_Hz[step])), LATE * np.sqrt(_ramp(turns, step))
        swept = abs(float(turns.speed_Hz[first + peak.after + half] - turns.speed_Hz[first + peak.before + half]))
        if swept < LEAST_SWEPT * speed:  # the speed is held: no resonance is passed
            continue
        own = modes is None and near(speed, (vibration.frequency_Hz for vibration in vibrations), late)
        known = not peak.low if modes is None else near(speed, modes, late)
        if known and not own:
            mode = None if modes is None else min(modes, key=lambda each: abs(each - speed))
            yield _Passage(step, point, peak.prominence, peak.height, mode, peak.turn)


def _distinct(passages: Sequence[_Passage], turns: Revolutions, modes: Sequence[float] | None) -> list[_Passage]:
    """The clearest of the resonances of one pass that belong together: of several points, of one mode, and those that
    the free vibration behind a resonance makes by beating with the unbalance, in which the phase turns back."""
    kept: list[_Passage] = []
    for each in sorted(passages, key=lambda each: -each.prominence):
        speed, ramp = abs(float(turns.speed_Hz[each.step])), _ramp(turns, each.step)
        same = max(SAME * speed, 0.0 if modes is not None else 2.0 * LATE * np.sqrt(ramp))
        others = [abs(abs(float(turns.speed_Hz[other.step])) - speed) for other in kept]
        if modes is not None and any(other.mode == each.mode for other in kept):
            continue
        if any(apart <= same for apart in others):
            continue
        if any(apart <= BEATS * np.sqrt(ramp) for apart in others) and each.turn < TURNED:
            continue
        kept.append(each)
    return kept


def synchronous_amplitude(motions: Sequence[Complex], step: int) -> float:
    """Amplitude in m of the synchronous motion of a point at a step of its revolutions; motions: as by `resonant`,
    whose windows are half of REVOLUTIONS behind."""
    return float(np.abs(motions[0][step - REVOLUTIONS * STEPS // 2]))


@dataclass(frozen=True)
class _Resonance:
    """A peak of the synchronous motion, see Peak. height: of it; low: whether its prominence is so low that only a
    known critical speed makes it one; turn: see _Passage."""

    place: int
    before: int
    after: int
    prominence: float
    height: float
    low: bool
    turn: float


def _resonances(motions: Sequence[Complex], floor: float, until: int) -> list[_Resonance]:
    """The resonances with the unbalance up to a sample; motions (n,): as by `resonant`."""
    synchronous, background, whirl = motions
    amplitude: Array = np.abs(synchronous)
    if len(amplitude) == 0:
        return []
    phase = np.unwrap(np.angle(synchronous))
    least = max(floor, OVER_BACKGROUND * float(np.median(np.abs(background))))
    peaks = prominent_peaks(amplitude, least)
    whole = [peak for peak in peaks if peak.prominence >= PROMINENCE * amplitude[peak.place]]
    known = {peak.place for peak in whole}
    until_whirl = amplitude[: max(0, until + 1)]
    more = [
        peak
        for peak in _cut_off(until_whirl, least, max((peak.after for peak in whole), default=0))
        if peak.place not in known
    ]
    low = [] if whole + more else _low(until_whirl, least)
    return [
        _Resonance(
            peak.place,
            peak.before,
            min(peak.after, len(amplitude) - 1),
            peak.prominence,
            float(amplitude[peak.place]),
            bool(low),
            _turned(amplitude, phase, peak.place),
        )
        for peak in whole + more + low
        if peak.place < until
        and abs(whirl[peak.place]) <= amplitude[peak.place]  # whirl that is about to break out spills over
        and abs(phase[min(peak.after, until)] - phase[peak.before]) >= LAG
    ]


def _turned(amplitude: Array, phase: Array, place: int) -> float:
    """By how much the phase (n,) turns, to a whole turn, from the lowest point before a peak to that behind it, each
    up to where the amplitude (n,) is higher than in the peak."""
    height = amplitude[place]
    higher = np.flatnonzero(amplitude > height)
    left, right = higher[higher < place], higher[higher > place]
    begin, end = int(left[-1]) if len(left) else 0, int(right[0]) if len(right) else len(amplitude) - 1
    foot, beyond = (
        begin + int(np.argmin(amplitude[begin : place + 1])),
        place + int(np.argmin(amplitude[place : end + 1])),
    )
    return abs(float(np.angle(np.exp(1j * (phase[beyond] - phase[foot])))))


def _cut_off(amplitude: Array, least: float, begin: int) -> list[Peak]:
    """The highest peak, from a sample on, of a curve (n,) that ends with the run or a whirl, which cuts off the far
    side of the peak: its prominence is how far it rises.

    How far it would fall is not known, so its phase decides: where one mode moves, the amplitude goes with the cosine
    of the phase, and LAG between the middles of the flanks is a fall by 7 %.
    """
    highest = begin + int(np.argmax(amplitude[begin:])) if len(amplitude) > begin else 0
    return [
        replace(peak, prominence=peak.rise)
        for peak in prominent_peaks(amplitude, least)
        if peak.place == highest and peak.rise >= PROMINENCE * amplitude[highest]
    ]


def _low(amplitude: Array, least: float) -> list[Peak]:
    """The highest peak of a curve (n,) with LOW_PROMINENCE, its flanks reaching to the lowest point of each side."""
    highest = int(np.argmax(amplitude)) if len(amplitude) else 0
    return [
        replace(peak, before=int(np.argmin(amplitude[:highest])), after=highest + int(np.argmin(amplitude[highest:])))
        for peak in prominent_peaks(amplitude, least)
        if peak.place == highest and peak.prominence >= LOW_PROMINENCE * amplitude[highest]
    ]


def vibrations_beside(
    tracked: Sequence[Complex], turns: Revolutions, clearance: float, before_s: float, modes: Sequence[float] | None
) -> Iterator[Vibration]:
    """Vibrations of a disk or journal with frequencies of their own near the rotor speed, before the first whirl.

    tracked: by `near_synchronous`, in m; clearance: m. A vibration with the frequency of a mode of the machine, see
    critical_steps, is the decay of a resonance.
    """
    half, more = NARROW * STEPS // 2, (NARROW - WIDE) * STEPS // 2
    if len(tracked[1]) < 2:
        return
    forward, backward = (wide[more:-more] - narrow for wide, narrow in (tracked[:2], tracked[2:]))
    speed = turns.speed_Hz[half:-half]
    order = 1.0 + np.sign(speed) * np.gradient(np.unwrap(np.angle(forward))) * STEPS / (2.0 * np.pi)
    amplitude = (np.abs(forward) + np.abs(backward)) / clearance  # along the longer axis of the orbit
    apart = np.where(np.abs(order - 1.0) >= FURTHEST, amplitude, 0.0)
    settled, until = turns.settled, max(0, int(np.searchsorted(turns.time_s, before_s)) - 2 * half)
    sustained = round(SUSTAINED_REVOLUTIONS * STEPS)
    for first, last in intervals_above(apart[settled:until], BEGINS, ENDS, sustained):
        if last - first < sustained:
            continue
        seen = slice(settled + first, settled + last)
        frequency = float(np.median((order * np.abs(speed))[seen]))
        if modes is None or not near(frequency, modes):
            begins, ends = settled + first + half, settled + last - 1 + half
            time_s, largest = turns.time_s, float(np.max(apart[seen]))
            began = float(turns.speed_Hz[begins])
            yield Vibration(float(time_s[begins]), float(time_s[ends]), began, frequency, largest)


def _ramp(turns: Revolutions, step: int) -> float:
    """How fast in Hz/s the speed changes about a step."""
    around = slice(max(0, step - STEPS), step + STEPS + 1)
    return float(np.ptp(turns.speed_Hz[around]) / max(float(np.ptp(turns.time_s[around])), 1e-12))


BAND = (0.25, 0.8)  # of the rotor speed, in which a whirl is looked for
SEEN = 0.05  # of the clearance: a smaller line in the band is no whirl
BEYOND = 1.3  # times the highest of its band: up to where spectra are computed
MOST_SPEEDS = 60
LOWEST = 0.1  # of the highest speed: below it a run-up is hardly in its order
LARGEST_OVERLAP = 0.8


@dataclass(frozen=True)
class Ridges:
    """Ridges of the way up.

    speed_Hz: (n,) ascending; synchronous: (n, 2) peak amplitudes of x and y with the rotor speed, m;
    whirl_Hz, whirl: (n,) frequency and amplitude in m of the largest line of x within BAND of the rotor speed, which is
    a whirl where `whirls` (n,); onset_Hz: rotor speed at the first onset of whirl, NaN if there is none. What lies
    outside of the run is NaN."""

    speed_Hz: Array
    synchronous: Array
    whirl_Hz: Array
    whirl: Array
    whirls: Truths
    onset_Hz: float


def ridge_speeds(run: Run) -> Array:
    """(n,) rotor speeds in Hz that suit a run: as far from each other as its windows reach, at most MOST_SPEEDS."""
    speed, time = np.abs(run[SPEED]), run[TIME]
    top = int(np.argmax(speed))
    window = window_length(run.signal(TIME), run.signal(SPEED))
    count = int(min(MOST_SPEEDS, max(4.0, (time[top] - time[0]) / window)))
    low, high = max(LOWEST * speed[top], float(speed[0])), float(speed[top])
    reach = 0.5 * window * (high - float(speed[0])) / max(float(time[top] - time[0]), 1e-12)
    assert located(run, "journal")
    return np.linspace(low + reach, high - 1.5 * reach, count)


def ridges(run: Run, speeds_Hz: Array, clearance: float, signal: str = "journal") -> Ridges:
    """The ridges of a run at rotor speeds (n,) in Hz; clearance in m. Raises InputError as order_track and waterfall
    do, of a run that is too short for them."""
    track = order_track(run, 1.0, signal)
    rising = _rising(track.speed_Hz)
    synchronous = np.stack(
        [_at(speeds_Hz, track.speed_Hz[rising], track.amplitude(axis)[rising]) for axis in ("x", "y")], axis=1
    )
    found = _spectra(run, signal, clearance)
    frequency, amplitude = _lines(found)
    rising = _rising(found.speed_Hz)
    whirl_Hz = _at(speeds_Hz, found.speed_Hz[rising], frequency[rising])
    whirl = _at(speeds_Hz, found.speed_Hz[rising], amplitude[rising])
    here = (None, joined(*located(run, signal)))  # events of earlier versions name no point
    onsets = (event["speed_Hz"] for event in run.events if event["kind"] == "onset" and event.get("point") in here)
    onset = next(onsets, np.nan)
    return Ridges(speeds_Hz, synchronous, whirl_Hz, whirl, whirl > SEEN * clearance, float(onset))


def _spectra(run: Run, signal: str, clearance: float) -> Spectrogram:
    point = joined(*located(run, signal))
    x, y = run.signal(f"{point}_x_m"), run.signal(f"{point}_y_m")
    top = float(np.max(np.abs(run[SPEED])))
    return waterfall(
        run.signal(TIME), x, y, run.signal(SPEED), clearance, overlap=LARGEST_OVERLAP,
        max_frequency_Hz=BEYOND * BAND[1] * top,
    )  # fmt: skip


def _rising(speed: Array) -> Truths:
    """(m,) where a speed has not been reached before: the way up."""
    before = np.concatenate([[-np.inf], np.maximum.accumulate(speed)[:-1]])
    return np.asarray(speed > before)


def _at(wanted: Array, speed: Array, values: Array) -> Array:
    return np.asarray(np.interp(wanted, speed, values, left=np.nan, right=np.nan))


def _lines(found: Spectrogram) -> tuple[Array, Array]:
    """(m,) frequency in Hz and amplitude of the largest line within the band of each spectrum, between the lines of the
    spectrum by a parabola through their logarithms."""
    step = float(found.frequency_Hz[1] - found.frequency_Hz[0])
    frequency, amplitude = np.full(len(found.time_s), np.nan), np.zeros(len(found.time_s))
    for column, speed in enumerate(np.abs(found.speed_Hz)):
        band = np.flatnonzero((found.frequency_Hz > BAND[0] * speed) & (found.frequency_Hz < BAND[1] * speed))
        band = band[(band > 0) & (band < len(found.frequency_Hz) - 1)]
        if not len(band):
            continue
        place = int(band[np.argmax(found.amplitude[band, column])])
        left, middle, right = np.log(np.maximum(found.amplitude[place - 1 : place + 2, column], 1e-300))
        off = summit(left, middle, right)
        frequency[column] = found.frequency_Hz[place] + off * step
        amplitude[column] = np.exp(middle - 0.25 * (left - right) * off)
    return frequency, amplitude
