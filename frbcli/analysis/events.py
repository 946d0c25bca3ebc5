"""Events of a run, found from its signals: critical speed, onset, offset and lock-in of whirl, self-excited vibration,
contact, touch and lift-off of rough surfaces, pins and stops; when a clearance changed or a blade was lost; the top
speed and the standstill of a rotor whose speed is free.

The motion x + iy is followed order by order (order_tracking.py), piece by piece. With a window of 4 revolutions the
amplitude for half the rotor speed sees the orders 0.2 to 0.8, and neither a static displacement (order 0) nor unbalance
(order 1). Floating rings whirl at lower orders, and with several frequencies at once: see subsynchronous.py. Critical
speed and self-excited vibration are in resonance.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from frbcli.analysis import signals
from frbcli.analysis.forced import without_forced
from frbcli.analysis.order_tracking import STEPS, Revolutions, START_s, Tracked, track
from frbcli.analysis.resonance import (
    FLOOR,
    LATE,
    critical_steps,
    distinct_modes,
    near,
    near_synchronous,
    passes,
    resonant,
    synchronous_amplitude,
    vibrations_beside,
)
from frbcli.analysis.signals import RunLike, joined, pieces, points
from frbcli.analysis.spectrum import crossing, hann, intervals_above, summit
from frbcli.analysis.subsynchronous import HOPS, SIDES, WhirlMoment, find_whirls, rings_out, window_step_s
from frbcli.arrays import Array, Complex
from frbcli.results.store import CLEARANCE_STEP, LOSS
from frbcli.units import HERTZ, SpeedUnit

Kind = Literal["critical-speed", "self-excited", "onset", "offset", "lock-in", "contact", "touch", "lift-off",
               "clearance-step", "loss", "forced", "top-speed", "standstill"]  # fmt: skip

SUBSYNCHRONOUS = 0.5  # order of oil whirl, about half the rotor speed
WHIRL_REVOLUTIONS = 4  # the shortest window that is blind to the orders 0 and 1: +-2/4 about the order 0.5
WHIRL_BAND = (0.2, 0.8)  # orders in which the dominating frequency is sought
FREQUENCY_REVOLUTIONS = 16  # window for that frequency: lines 1/16 apart, and short against a ramp of some 10 s
FREQUENCY_PADDING = 16  # interpolation between these lines
SHARE_OF_LINE = 0.01  # how fine a parabola finds a peak of a spectrum next to weaker ones
FREQUENCY_SAMPLES = 32  # per revolution, there
WHIRL_BEGINS = 0.05  # amplitude relative to the clearance; unbalance and noise of a quiet run stay below in that order
WHIRL_ENDS = 0.025  # half of it: motion that hovers about the threshold is one whirl
SUSTAINED_REVOLUTIONS = 20.0  # ten periods of a half-frequency whirl: what dies sooner is a transient

CONTACT_ECCENTRICITY = 0.9999  # where the run does not say where its contact begins
COLLAR_FILM, COLLAR_TOUCHES = "thrust_film_thickness_m", 1e-6 * (1.0 + 1e-9)  # m: the roughness of surfaces
PIN, PIN_UNIT, PUSHES = "pin_torque", "_N_m", 1e-300  # N m: a pin that has any torque touches its ring
STOP, ALONG_X = "stop_force", "_x_N"
DRIVE, FALLS = "drive_torque_N_m", 0.01  # share of its top speed by which a rotor must slow down behind it
OF_SPEED = ("top-speed", "standstill")  # kinds of events that are seen in the speed itself, sample by sample
CONTACT_PAUSE_s = 0.1  # a bouncing journal touches several times in one contact
TOUCHES, LIFTED = 0.01, 0.001  # share of the force from which asperities count as touching, and below which as apart


@dataclass(frozen=True)
class Event:
    """Something that happened at t_s, at rotor speed speed_Hz. film: the name of the film, None where there is but one;
    of a whirl in floating rings the film that drives it.

    frequency_Hz, frequency_ratio (to the rotor speed): of the motion, where it has one. point: whose motion it was
    found in, or which disk has a loss, "disk" or "journal", "disk_NAME" or "journal_NAME" where there are several; None
    where no motion shows it.
    amplitude: over the clearance (C_i + C_o of a floating ring, the length of a machine without films): of an onset and
    a self-excited vibration the largest one until it ends, of a critical speed the amplitude of the synchronous motion
    there; None of others.

    speed_uncertainty_Hz, frequency_uncertainty_Hz, amplitude_uncertainty, certain, reason: see uncertainty.py; None
    where no second run was made.
    """

    kind: Kind
    film: str | None
    t_s: float
    speed_Hz: float
    frequency_Hz: float | None
    frequency_ratio: float | None
    point: str | None = None
    amplitude: float | None = None
    speed_uncertainty_Hz: float | None = None
    frequency_uncertainty_Hz: float | None = None
    amplitude_uncertainty: float | None = None
    certain: bool | None = None
    reason: str | None = None


def find_events(run: RunLike) -> tuple[Event, ...]:
    """Find the events of a run.

    Parameters
    ----------
    run : Run
        Needs time_s and speed_Hz; per bearing journal_x_m, journal_y_m and, for contact, eccentricity (with several
        bearings journal_NAME_x_m, eccentricity_NAME) and the reference clearance_m, one for all or one per film. Uses
        ring_x_m, ring_speed_Hz and disk_x_m, disk_y_m where there are any, and the references clearance_step_1_s,
        loss_1_s or loss_1_NAME_s, critical_speed_1_Hz, forced_1_Hz, forced_2_order and so on. It may be of any length.
        Motion with a frequency or order of what forces the run is neither whirl nor resonance.

    Returns
    -------
    tuple of Event
        Critical speeds, self-excited vibrations, onsets and offsets of whirl, lock-in, contact, touch and lift-off of
        rough surfaces and of rings and their pins, top speed and standstill of a driven rotor, in the order of time.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> [event.kind for event in frbcli.find_events(run)]  # doctest: +SKIP
    """
    if len(run) < 2:
        return ()
    run = without_forced(run)
    bearings, rings = list(points(run.signals, "journal")), set(points(run.signals, "ring"))
    if any(True for _ in signals.films(run.signals)):  # some journals may have no film
        bearings = [name for name in bearings if signals.in_film(run, name)]
    nodes = [("disk", name) for name in points(run.signals, "disk")] or [("journal", name) for name in bearings]
    plain = [name for name in bearings if name not in rings and signals.bearing_clearance(run, name) is not None]
    halves = [(Tracked("journal", name, SUBSYNCHRONOUS, WHIRL_REVOLUTIONS),) for name in plain]
    wanted = halves, [resonant(*node) for node in nodes], [] if rings else [near_synchronous(*node) for node in nodes]
    turns, motions = track(run, [one for groups in wanted for group in groups for one in group])
    following = iter(motions)
    whirls, resonances, besides = ([[next(following) for _ in group] for group in groups] for groups in wanted)

    events: list[Event] = []
    for name in bearings:
        room = signals.bearing_clearance(run, name)
        if room is not None and name in rings:
            events += _whirls_of_any_frequency(run, name, room, turns, in_films=True)
        elif room is not None:
            events += _whirl(run, whirls[plain.index(name)][0] / room, turns, name)
        else:
            events += _whirls_of_any_frequency(run, name, run.references.get("length_m", 0.0), turns, in_films=False)
    seen = [joined(*node) for node in nodes]
    quiet = _quiet_spans(events, float(turns.time_s[-1]) if len(turns.time_s) else 0.0)
    events += _near_the_speed(run, turns, dict(zip(seen, resonances, strict=True)), besides, quiet)
    named = list(signals.films(run.signals))
    last = {film: signals.piece(run, _nearest(run, film), len(run) - 1, len(run))[0] for film in named}
    touching = max(named, key=lambda film: float(last[film]), default="")
    on_pads = list(_collar_contact(run))
    for film in named:
        events += _contacts(run, film, run.status == "contact" and film == touching and not on_pads)
        events += _touches(run, joined("asperity_share", film), film or None)
    for signal in [name for name in run.signals if name.startswith(PIN)]:
        ring = joined("ring", signal.removeprefix(PIN).removesuffix(PIN_UNIT).strip("_"))
        events += _touches(run, signal, None, ring, (PUSHES, PUSHES))
    for signal in [name for name in run.signals if name.startswith(STOP) and name.endswith(ALONG_X)]:
        stop = joined("stop", signal.removeprefix(STOP).removesuffix(ALONG_X).strip("_"))
        events += _touches(run, signal, None, stop, (PUSHES, PUSHES))
    events += _turning(run)
    changes = _changes(run)  # before their consequences at the same time
    return tuple(sorted([*changes, *events, *on_pads], key=lambda event: event.t_s))


def resolution(run: RunLike, event: Mapping[str, Any]) -> tuple[float, float]:
    """How fine the search for an event, as in the file of a run, is, in Hz: by how much the speed changes in one of its
    steps, and how fine it finds a frequency."""
    t, speed = float(event["t_s"]), abs(float(event["speed_Hz"]))
    in_rings = str(event["film"] or "").endswith(SIDES)
    step_s = window_step_s(run) if in_rings else 1.0 / (STEPS * max(speed, 1.0))
    if event["kind"] in OF_SPEED:
        step_s = float(np.ptp(signals.piece(run, "time_s", 0, 2)))
    around = [signals.speed_at(run, t + sign * step_s) for sign in (-1.0, 1.0)]
    line_Hz = 1.0 / (HOPS * step_s) if in_rings else speed / FREQUENCY_REVOLUTIONS
    return 0.5 * abs(around[1] - around[0]), 0.0 if event["kind"] == "critical-speed" else SHARE_OF_LINE * line_Hz


def growth(run: RunLike, event: Mapping[str, Any], known: float) -> float:
    """How fast, in 1/s, the whirl of an onset in a plain bearing grows out of less than an amplitude over the clearance
    that is known. 0 where it does not, and of any other event."""
    film, least = str(event["film"] or ""), min(known, WHIRL_ENDS)
    room = signals.bearing_clearance(run, film)
    if event["kind"] != "onset" or film.endswith(SIDES) or room is None:
        return 0.0
    turns, (motion,) = track(without_forced(run), [Tracked("journal", film, SUBSYNCHRONOUS, WHIRL_REVOLUTIONS)])
    middle = WHIRL_REVOLUTIONS * STEPS // 2
    before = np.abs(motion[: max(0, int(np.searchsorted(turns.time_s, event["t_s"])) - middle)]) / room
    unknown = np.flatnonzero(before < least)
    if len(unknown) == 0 or middle + unknown[-1] < turns.settled:
        return 0.0
    return float(np.log(WHIRL_BEGINS / least) / (event["t_s"] - turns.time_s[middle + unknown[-1]]))


def _near_the_speed(
    run: RunLike,
    turns: Revolutions,
    resonances: Mapping[str, Sequence[Complex]],
    besides: Sequence[Sequence[Complex]],
    quiet: Sequence[tuple[float, float]],
) -> Iterator[Event]:
    """The critical speeds in all spans of time (begin, end) in s without whirl, and the first self-excited vibration
    before the first whirl, of all disks or else journals. resonances: by point; besides: of the same points, or
    empty."""
    before_s = quiet[0][1] if quiet and quiet[0][0] <= 0.0 else 0.0
    without_films = run.references.get("length_m", 0.0)
    clearances = (length for name, length in run.references.items() if name.startswith("clearance_m"))
    room = min(clearances, default=without_films)
    modes = signals.critical_speeds(run)
    vibrations_of = [
        (vibration, name)
        for name, motions in zip(resonances, besides, strict=False)
        if room > 0.0
        for vibration in vibrations_beside(motions, turns, room, before_s, modes)
    ]
    vibrations = sorted(vibrations_of, key=lambda each: each[0].time_s)
    own_frequencies = [vibration for vibration, _ in vibrations]
    motions = list(resonances.values())
    for number, step in critical_steps(motions, turns, FLOOR * room, quiet, modes, own_frequencies):
        point = list(resonances)[number]
        its_speed, amplitude = float(turns.speed_Hz[step]), synchronous_amplitude(resonances[point], step) / room
        yield Event("critical-speed", None, float(turns.time_s[step]), its_speed, its_speed, 1.0, point, amplitude)
    for own, point in vibrations[:1]:
        ratio = own.frequency_Hz / abs(own.speed_Hz)
        yield Event("self-excited", None, own.time_s, own.speed_Hz, ratio * own.speed_Hz, ratio, point, own.amplitude)


def about_critical_speeds(
    run: RunLike, events: Sequence[Mapping[str, Any]], unit: SpeedUnit = HERTZ
) -> list[str]:
    """Sentences on critical speeds of the linearised machine that a run passes without an event, each way up and down,
    with the reason; where they are not known, on the whirls during which none is sought. events: of the run; unit: of
    rotor speeds."""
    if len(run) < 2:
        return []
    known = [Event(**{name: each[name] for name in ("kind", "film", "t_s", "speed_Hz", "frequency_Hz",
                                                     "frequency_ratio")}) for each in events]  # fmt: skip
    time_s, speed = signals.course(signals.signal_of(run, "time_s"), signals.signal_of(run, "speed_Hz"))
    quiet = _quiet_spans(known, float(time_s[-1]))
    modes = signals.critical_speeds(run)
    if modes is None:
        begins, ends = [end for _, end in quiet], [*[begin for begin, _ in quiet[1:]], float(time_s[-1])]
        hidden = [unit.span(signals.speed_at(run, begin), signals.speed_at(run, min(end, time_s[-1])))
                  for begin, end in zip(begins, ends, strict=False) if begin < time_s[-1]]  # fmt: skip
        return [f"During whirl no critical speed is sought: {', '.join(hidden)}."] if hidden else []
    missed: dict[tuple[str, str], list[float]] = {}
    for first, last in passes(speed):
        way = slice(first, min(last + 1, len(speed)))
        t, size = time_s[way], np.abs(speed[way])
        up = size[-1] > size[0]
        ramp = float(np.ptp(size)) / max(float(np.ptp(t)), 1e-12)
        seen = [abs(each.speed_Hz) for each in known if each.kind == "critical-speed" and t[0] <= each.t_s <= t[-1]]
        for mode in distinct_modes(modes):
            if not size.min() < mode < size.max() or near(mode, seen, LATE * ramp**0.5):
                continue
            when = float(np.interp(mode, size if up else size[::-1], t if up else t[::-1]))
            left = abs(float(size[-1]) - mode)
            reason = _why_not_found(when - float(time_s[0]), quiet, left < LATE * ramp**0.5)
            missed.setdefault(("up" if up else "down", reason), []).append(mode)
    return [
        f"No critical speed at {unit.listed(speeds)} on the way {way}: {reason}."
        for (way, reason), speeds in missed.items()
    ]


def _why_not_found(when_s: float, quiet: Sequence[tuple[float, float]], at_end: bool) -> str:
    """Why a critical speed that is passed at a time is no event; at_end: whether the way ends before its peak does."""
    if when_s < START_s:
        return "the run settles when it passes it"
    if not any(begin <= when_s <= end for begin, end in quiet):
        return "none is sought during a whirl"
    if at_end:
        return "the speed turns or ends too near to it"
    return "the synchronous motion has no clear peak there, for want of unbalance or by damping"


def _quiet_spans(events: Sequence[Event], end_s: float) -> list[tuple[float, float]]:
    """Spans of time in s between whirls; a whirl lasts from its onset to the next offset of its film."""
    quiet, begin = list[tuple[float, float]](), 0.0
    for onset in sorted((event for event in events if event.kind == "onset"), key=lambda event: event.t_s):
        ends = [event.t_s for event in events if event.kind == "offset" and event.film == onset.film]
        if onset.t_s > begin:
            quiet.append((begin, onset.t_s))
        begin = max(begin, min((t for t in ends if t > onset.t_s), default=np.inf))
    return [*quiet, (begin, np.inf)] if begin < end_s else quiet


def _changes(run: RunLike) -> Iterator[Event]:
    """Changes of clearances and of the unbalance between the first and the last sample, as possible causes of later
    events."""
    count = len(run)
    begin, end = (signals.piece(run, "time_s", place, place + 1)[0] for place in (0, count - 1))
    kinds: tuple[tuple[Kind, str], ...] = (("clearance-step", CLEARANCE_STEP), ("loss", LOSS))
    for kind, change in kinds:
        for t, name in signals.times_of(run, change):
            if begin <= t <= end:
                yield Event(kind, None, t, signals.speed_at(run, t), None, None, joined("disk", name) if name else None)


def _whirls_of_any_frequency(
    run: RunLike, name: str, room: float, turns: Revolutions, in_films: bool
) -> Iterator[Event]:
    """Onset and offset of each whirl of a journal of any frequency well below the speed, relative to room in m: of
    floating ring bearings, with the lock-in, C_i + C_o. A journal that is in no film is driven by something, such as a
    seal, that has no film to give its speed; its room is the length of the machine."""
    settled_s = float(turns.time_s[min(turns.settled, len(turns.time_s) - 1)]) if len(turns.time_s) else 0.0
    for whirl in find_whirls(run, name, room, settled_s) if room > 0.0 else ():
        if whirl.free and not in_films:
            continue
        moments: dict[Kind, WhirlMoment | None] = {
            "onset": whirl.onset,
            "lock-in": whirl.lock_in,
            "offset": whirl.offset,
        }
        film, point = joined(name, whirl.side) if in_films else None, joined("journal", name)
        for kind, moment in moments.items():
            if moment is None or (kind == "lock-in" and not in_films):
                continue
            speed, frequency = signals.speed_at(run, moment.time_s), moment.frequency_Hz
            reached = whirl.amplitude if kind == "onset" else None
            yield Event(kind, film, moment.time_s, speed, frequency, frequency / speed, point, reached)


def _whirl(run: RunLike, motion: Complex, turns: Revolutions, name: str) -> Iterator[Event]:
    """Onsets and offsets; motion (m,): of a journal at half the speed, relative to the clearance."""
    amplitude = np.abs(motion)
    middle = WHIRL_REVOLUTIONS * STEPS // 2
    settled = turns.settled - middle
    sustained = round(SUSTAINED_REVOLUTIONS * STEPS)
    for first, last in intervals_above(amplitude, WHIRL_BEGINS, WHIRL_ENDS, sustained):
        lasts = last == len(amplitude)
        if last - max(first, settled) < sustained and not (lasts and run.status == "contact"):
            continue
        if not lasts and rings_out(amplitude[max(first, settled) : last]):
            continue
        # An interval that the start of the run leads into began with the run.
        begun = _whirl_event("onset", run, name, turns, middle + crossing(amplitude, first, WHIRL_BEGINS, -1))
        yield replace(begun, amplitude=float(np.max(amplitude[max(first, settled) : last], initial=0.0)))
        if not lasts:
            yield _whirl_event("offset", run, name, turns, middle + crossing(amplitude, last - 1, WHIRL_BEGINS, 1))


def _whirl_event(kind: Kind, run: RunLike, name: str, turns: Revolutions, step: float) -> Event:
    """The event at a step, or between two; its frequency is taken from the window just after an onset, just before an
    offset."""
    last, width = len(turns.time_s) - 1, FREQUENCY_REVOLUTIONS * STEPS
    begin = max(0.0, min(step if kind == "onset" else step - width, last - width))
    within = begin + np.arange(min(width, last) + 1)
    event_s, *times_s = np.interp([step, *within], np.arange(last + 1), turns.time_s)
    seen = _at_even_angles(run, name, np.asarray(times_s))
    padded = FREQUENCY_PADDING * FREQUENCY_REVOLUTIONS * FREQUENCY_SAMPLES
    lines = np.abs(np.fft.fft((seen - seen.mean()) * hann(len(seen)), padded))
    lowest, highest = (round(order * padded / FREQUENCY_SAMPLES) for order in WHIRL_BAND)
    line = lowest + int(np.argmax(lines[lowest:highest]))
    ratio = (line + summit(*lines[line - 1 : line + 2])) * FREQUENCY_SAMPLES / padded
    speed = float(np.interp(event_s, turns.time_s, turns.speed_Hz))
    return Event(kind, name or None, float(event_s), speed, ratio * speed, ratio, joined("journal", name))


def _at_even_angles(run: RunLike, name: str, times_s: Array) -> Complex:
    """x + iy of a journal, FREQUENCY_SAMPLES times per revolution, from the first to the last of the times (m,) of even
    steps; seen from behind where the rotor turns the other way round: forward motion then has a positive order."""
    start, stop = signals.samples_about(run, float(times_s[0]), float(times_s[-1]))
    time_s, speed = (signals.piece(run, signal, start, stop) for signal in ("time_s", "speed_Hz"))
    motion = signals.motion_of(run, "journal", name, start, stop)
    finer = FREQUENCY_SAMPLES // STEPS
    steps = np.arange((len(times_s) - 1) * finer) / finer
    times = np.interp(steps, np.arange(len(times_s)), times_s)
    seen = np.asarray(np.interp(times, time_s, motion))
    return np.where(np.interp(times, time_s, speed) < 0.0, np.conj(seen), seen)


def _collar_contact(run: RunLike) -> Iterator[Event]:
    """The end of a run whose collar touches its pads: its last sample."""
    if run.status != "contact" or COLLAR_FILM not in run.signals:
        return
    thickness, t, speed = (
        float(signals.piece(run, name, len(run) - 1, len(run))[0]) for name in (COLLAR_FILM, "time_s", "speed_Hz")
    )
    if thickness <= COLLAR_TOUCHES:
        yield Event("contact", None, t, speed, None, None, point="collar")


def _nearest(run: RunLike, film: str) -> str:
    """The signal of the distance of a journal to its shell: with tilt, at the closer end."""
    at_end = joined("end_eccentricity", film)
    return at_end if at_end in run.signals else joined("eccentricity", film)


def _contacts(run: RunLike, film: str, ended: bool) -> Iterator[Event]:
    """The first touch of each contact; `ended`: the run stopped because of one, which then is its last sample."""
    limit = run.references.get("contact_eccentricity", CONTACT_ECCENTRICITY)
    touched, count = -np.inf, len(run)
    for start, stop in pieces(count):
        touches = signals.piece(run, _nearest(run, film), start, stop) >= limit
        if ended and stop == count:
            touches[-1] = True
        samples = np.flatnonzero(touches)
        if len(samples) == 0:
            continue
        times, speeds = (signals.piece(run, signal, start, stop)[samples] for signal in ("time_s", "speed_Hz"))
        for first in np.flatnonzero(np.diff(times, prepend=touched) > CONTACT_PAUSE_s):
            yield Event("contact", film or None, float(times[first]), float(speeds[first]), None, None)
        touched = float(times[-1])


def _turning(run: RunLike) -> Iterator[Event]:
    """For a rotor of free speed: its highest speed, unless at the start or held up to the end, and its standstill,
    extrapolated from the last two samples."""
    if DRIVE not in run.signals:
        return
    top, top_s, count = 0.0, 0.0, len(run)
    for start, stop in pieces(count):
        speeds = signals.piece(run, "speed_Hz", start, stop)
        fastest = int(np.argmax(speeds))
        if speeds[fastest] > top:
            top, top_s = float(speeds[fastest]), float(signals.piece(run, "time_s", start, stop)[fastest])
    first, begun = (float(signals.piece(run, name, 0, 1)[0]) for name in ("speed_Hz", "time_s"))
    (before_s, last_s), (before, last) = (
        signals.piece(run, name, count - 2, count).tolist() for name in ("time_s", "speed_Hz")
    )
    if top_s > begun and top > first and last < (1.0 - FALLS) * top:
        yield Event("top-speed", None, top_s, top, None, None)
    if run.status == "standstill":
        left = last / (before - last) if before > last else 0.0
        yield Event("standstill", None, last_s + min(max(left, 0.0), 1.0) * (last_s - before_s), 0.0, None, None)


def _touches(
    run: RunLike, name: str, film: str | None, point: str | None = None, levels: tuple[float, float] = (TOUCHES, LIFTED)
) -> Iterator[Event]:
    """When surfaces touch by the size of a signal, from the first of its levels on, and when they have come apart,
    below the second, for longer than a pause; a run may begin touching."""
    together, parted, last, (touches, lifted) = False, None, (0.0, 0.0), levels
    if name not in run.signals:
        return
    for start, stop in pieces(len(run)):
        shares, times, speeds = (signals.piece(run, each, start, stop) for each in (name, "time_s", "speed_Hz"))
        for share, t, speed in zip(shares.tolist(), times.tolist(), speeds.tolist(), strict=True):
            last = t, speed
            if not together and abs(share) >= touches:
                together = True
                yield Event("touch", film, t, speed, None, None, point)
            elif together and abs(share) >= lifted:
                parted = None
            elif together and parted is None:
                parted = t, speed
            if parted is not None and t - parted[0] > CONTACT_PAUSE_s:
                yield Event("lift-off", film, *parted, None, None, point)
                together, parted = False, None
    if parted is not None and last[0] > parted[0]:  # the run has ended within the pause
        yield Event("lift-off", film, *parted, None, None, point)
