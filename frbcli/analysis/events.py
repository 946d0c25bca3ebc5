"""Events of a run, found from its signals alone: critical speed, onset, offset and lock-in of whirl, contact; and when
a clearance changed.

The motion x + iy is read at even steps of the rotor's angle (revolutions.py). With a window of 4 revolutions the
amplitude for half the rotor speed sees the orders 0.2 to 0.8, and neither a static displacement (order 0) nor unbalance
(order 1). Floating rings whirl at lower orders, and with several frequencies at once: see subsynchronous.py. The
critical speed is in resonance.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.signal.windows import hann

from frbcli.analysis import signals
from frbcli.analysis.resonance import critical_sample
from frbcli.analysis.revolutions import SAMPLES_PER_REVOLUTION, Revolutions, by_angle, order_amplitude, revolutions
from frbcli.analysis.signals import Motion, RunLike, Values, joined, points
from frbcli.analysis.subsynchronous import find_whirls

Kind = Literal["critical-speed", "onset", "offset", "lock-in", "contact", "clearance-step"]

SUBSYNCHRONOUS = 0.5  # order of oil whirl, about half the rotor speed
WHIRL_REVOLUTIONS = 4  # the shortest window that is blind to the orders 0 and 1: +-2/4 about the order 0.5
WHIRL_BAND = (0.2, 0.8)  # orders in which the dominating frequency is sought
FREQUENCY_REVOLUTIONS = 16  # window for that frequency: lines 1/16 apart, and short against a ramp of some 10 s
FREQUENCY_PADDING = 16  # interpolation between these lines
WHIRL_BEGINS = 0.05  # amplitude relative to the clearance; unbalance and noise of a quiet run stay below in that order
WHIRL_ENDS = 0.025  # half of it: motion that hovers about the threshold is one whirl
SUSTAINED_REVOLUTIONS = 20.0  # ten periods of a half-frequency whirl: what dies sooner is a transient

CONTACT_ECCENTRICITY = 0.9999  # where the run does not say where its contact begins
CONTACT_PAUSE_s = 0.1  # a journal that bounces touches many times in one contact


@dataclass(frozen=True)
class Event:
    """Something that happened at t_s, at rotor speed speed_Hz. film: the name of the film, None where there is but one;
    of a whirl in floating rings the film that drives it.

    frequency_Hz, frequency_ratio (to the rotor speed): of the motion, where it has one.
    """

    kind: Kind
    film: str | None
    t_s: float
    speed_Hz: float
    frequency_Hz: float | None
    frequency_ratio: float | None


def find_events(run: RunLike) -> tuple[Event, ...]:
    """The events of a run, in the order of time.

    Needs time_s and speed_Hz; per bearing journal_x_m, journal_y_m and, for contact, eccentricity (with several
    bearings journal_NAME_x_m, eccentricity_NAME) and the reference clearance_m, one for all or one per film; uses
    ring_x_m, ring_speed_Hz and disk_x_m, disk_y_m where there are any, and the references clearance_step_1_s and so on.
    """
    time_s, speed = run["time_s"], run["speed_Hz"]
    if len(time_s) < 2:
        return ()
    events: list[Event] = []
    turns = revolutions(time_s, speed)
    bearings, rings = list(points(run.signals, "journal")), set(points(run.signals, "ring"))
    for name in bearings:
        room = signals.bearing_clearance(run, name)
        if room is not None and name in rings:
            events += _ring_whirls(run, name, room, turns)
        elif room is not None:
            motion = by_angle(run, "journal", name, turns) / room
            events += _whirl(motion, turns, name or None, run.status == "contact")
    critical = critical_sample(run, turns, bearings, min((e.t_s for e in events), default=np.inf))
    if critical is not None:
        its_speed = float(turns.speed_Hz[critical])
        events.append(Event("critical-speed", None, float(turns.time_s[critical]), its_speed, its_speed, 1.0))
    named = list(signals.films(run.signals))
    touching = max(named, key=lambda film: float(run[joined("eccentricity", film)][-1]), default="")
    for film in named:
        ended = run.status == "contact" and film == touching
        limit = run.references.get("contact_eccentricity", CONTACT_ECCENTRICITY)
        events += _contacts(time_s, speed, run[joined("eccentricity", film)] >= limit, film or None, ended)
    changes = _clearance_steps(run, time_s, speed)  # before what they bring about at the same time
    return tuple(sorted([*changes, *events], key=lambda event: event.t_s))


def _clearance_steps(run: RunLike, time_s: Values, speed: Values) -> Iterator[Event]:
    """Changes of a clearance that the run has reached: what follows may be owed to them."""
    for t in signals.clearance_steps(run):
        if t <= time_s[-1]:
            yield Event("clearance-step", None, t, float(np.interp(t, time_s, speed)), None, None)


def _ring_whirls(run: RunLike, name: str, room: float, turns: Revolutions) -> Iterator[Event]:
    """Onset, lock-in and offset of each whirl of a floating ring bearing; room in m: C_i + C_o."""
    time_s, speed_Hz = run["time_s"], run["speed_Hz"]
    settled_s = float(turns.time_s[min(turns.settled, len(turns.time_s) - 1)]) if len(turns.time_s) else 0.0
    motion = signals.motion_of(run, "journal", name) / room
    whirls = find_whirls(time_s, motion, speed_Hz, signals.ring_speed(run, name), settled_s, run.status == "contact")
    for whirl in whirls:
        moments: list[tuple[Kind, int]] = [("onset", 0)]
        if whirl.lock_in is not None:
            moments.append(("lock-in", whirl.lock_in))
        if not whirl.lasts:
            moments.append(("offset", len(whirl.time_s) - 1))
        for kind, at in moments:
            t, frequency = float(whirl.time_s[at]), float(whirl.frequency_Hz[at])
            speed = float(np.interp(t, time_s, speed_Hz))
            yield Event(kind, joined(name, whirl.side), t, speed, frequency, frequency / speed)


def _whirl(motion: Motion, turns: Revolutions, film: str | None, ends_in_contact: bool) -> Iterator[Event]:
    """Onsets and offsets; motion (m,): of the journal, relative to the clearance."""
    amplitude = order_amplitude(motion, SUBSYNCHRONOUS, WHIRL_REVOLUTIONS)
    middle = WHIRL_REVOLUTIONS * SAMPLES_PER_REVOLUTION // 2
    settled = turns.settled - middle
    sustained = round(SUSTAINED_REVOLUTIONS * SAMPLES_PER_REVOLUTION)
    for first, last in _stretches(amplitude, WHIRL_BEGINS, WHIRL_ENDS, sustained):
        lasts = last == len(amplitude)
        if last - max(first, settled) < sustained and not (lasts and ends_in_contact):
            continue
        # A stretch that the start of the run leads into began with the run.
        yield _whirl_event("onset", motion, turns, first + middle, film)
        if not lasts:
            yield _whirl_event("offset", motion, turns, last + middle, film)


def _stretches(amplitude: Values, begins: float, ends: float, pause: int) -> Iterator[tuple[int, int]]:
    """First and one past the last sample of each stretch above `begins`, where dips shorter than `pause` do not count.

    A stretch must fall below `ends` to be over, and counts to where it last was above `begins`.
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


def _whirl_event(kind: Kind, motion: Motion, turns: Revolutions, sample: int, film: str | None) -> Event:
    """The event at a sample; its frequency is that of the window just after an onset, just before an offset."""
    sample = min(sample, len(motion) - 1)
    width = FREQUENCY_REVOLUTIONS * SAMPLES_PER_REVOLUTION
    begin = sample if kind == "onset" else sample - width
    begin = max(0, min(begin, len(motion) - width))
    seen = motion[begin : begin + width]
    padded = FREQUENCY_PADDING * width
    lines = np.abs(np.fft.fft((seen - seen.mean()) * hann(len(seen)), padded))
    orders = np.fft.fftfreq(padded, 1.0 / SAMPLES_PER_REVOLUTION)
    band = (orders >= WHIRL_BAND[0]) & (orders <= WHIRL_BAND[1])
    ratio = float(orders[band][np.argmax(lines[band])])
    speed = float(turns.speed_Hz[sample])
    return Event(kind, film, float(turns.time_s[sample]), speed, ratio * speed, ratio)


def _contacts(
    time_s: Values, speed: Values, touches: NDArray[np.bool_], film: str | None, ended: bool
) -> Iterator[Event]:
    """The first touch of each contact; `ended`: the run stopped because of one, which then is its last sample."""
    if ended:
        touches = touches.copy()
        touches[-1] = True
    samples = np.flatnonzero(touches)
    if len(samples) == 0:
        return
    first = np.concatenate([[True], np.diff(time_s[samples]) > CONTACT_PAUSE_s])
    for sample in samples[first]:
        yield Event("contact", film, float(time_s[sample]), float(speed[sample]), None, None)
