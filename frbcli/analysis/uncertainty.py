"""How uncertain the events and the slow signals of a run are, from a second, coarser run of the same machine.

Events of both runs belong together if they have the same kind, film and point, are near in time and in the same order.
The difference of such a pair, times SAFETY, is the uncertainty. Two runs may agree in one number by chance. So the
uncertainty of an onset, a lock-in and an offset is at least the usual one of all of them, relative to the speed and to
the frequency, and any uncertainty at least what the search does not resolve. What happens at another speed happens
with another frequency: the uncertainty of a frequency is at least the uncertainty of the speed, times their ratio.

How many times the root mean square of n differences holds an error of the same spread in 9 of 10 cases is Student's t
for n degrees of freedom: 6.3 of a single difference, 2.4 of three. SAFETY is for a single one, of a run whose
errors are half of the differences. Several whirls share their usual difference, and need less, by the share of the
differences that the errors of the run are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.analysis.events import WHIRL_BEGINS, growth, resolution
from frbcli.analysis.signals import RunLike, joined, piece, samples_about, speed_at
from frbcli.analysis.subsynchronous import BEGINS, SIDES
from frbcli.arrays import Array

BETWEEN = 0.03  # of a step of the search: how far a moment that is read between two steps may be off
NEAR = 0.1  # of the time of an event: how much earlier or later it may be in the second run
NEAR_REVOLUTIONS = 40.0  # of the rotor, or as much: at the beginning of a run a whirl settles in as many
SAFETY = 3.0  # times the difference of both runs, which may be small by chance ...
BY_SHARE = 4.0  # ... or times the share of the error, in one of three whirls or more, whose usual one counts, too
HALF = 0.5  # share of a difference to a run with three times the tolerance, if errors are proportional to it
STUDENT = (6.31, 2.92, 2.35, 2.13, 2.02, 1.94, 1.89, 1.86)  # t of 1 ... 8 differences, in 9 of 10 cases
TRIMMED = 1.5  # root mean square of normal differences over that without their largest quarter
PEAK = 0.1  # of what a search finds a frequency by: next to weaker peaks a parabola is off in both runs alike
FAINT = 1.5  # times the amplitude from which a whirl counts: weaker whirls may be found in one of both runs only
RETURNS = 3  # onsets of one whirl within so many windows are a motion that comes and goes
SMALLER = 100.0  # times: the errors of steps at a tenth of the target, from which a whirl may grow as well
LONG = 10.0  # revolutions: what comes so early before a contact is a motion close to the shell, not the fall into it
GIVEN = ("clearance-step", "loss")  # their times are given in the case
SAME = ("kind", "film", "point")
CONTACT = "contact"
OF_WHIRLS = ("onset", "lock-in", "offset")
NUMBERS = SPEED, FREQUENCY, AMPLITUDE = "speed_Hz", "frequency_Hz", "amplitude"

WINDOWS = 100  # parts of a run in which means are taken: long against a whirl, short against what warms up
SLOW = {"ring_speed": "ring_speed_uncertainty_Hz", "temperature": "temperature_uncertainty_K",
        "power": "power_uncertainty_W", "oil_fraction": "oil_fraction_uncertainty"}  # fmt: skip

Record = Mapping[str, Any]


def with_uncertainties(
    run: RunLike, events: Sequence[Record], second: Sequence[Record], amplitude: float = 0.0, share: float = HALF
) -> list[dict[str, Any]]:
    """The events of a run with the uncertainties of speed and frequency in Hz and of the amplitude.

    Parameters
    ----------
    run : RunLike
        The run that has them.
    events, second : sequence of dict
        The events of the run, and of the second run.
    amplitude : float
        Least uncertainty of an amplitude: the error of the eccentricities before a whirl, say.
    share : float
        Share of a difference of both runs that the error of the run is expected to be.

    Returns
    -------
    list of dict
        Events as `Event` has them. One that the second run does not have is not certain: its uncertainties are None,
        and `reason` says why.
    """
    others = partners(events, second)
    both = [(event, other) for event, other in zip(events, others, strict=True) if other is not None]
    usual = _Usual.of([pair for pair in both if pair[0]["kind"] in OF_WHIRLS], amplitude, share)
    alone = _Usual.of([], amplitude, share)
    by_kind = dict.fromkeys(OF_WHIRLS, usual) | {CONTACT: replace(alone, amplitude=usual.amplitude)}
    return [
        {**event, **_unmatched(event, events, second)}
        if other is None
        else {**event, **_matched(run, event, other, by_kind.get(event["kind"], alone))}
        for event, other in zip(events, others, strict=True)
    ]


@dataclass(frozen=True)
class _Usual:
    """Usual uncertainties of all events of whirls: of speed and frequency relative to them, of the amplitude; safety:
    times the difference of one of them, by the number; known: the least uncertainty of an amplitude."""

    safety: Mapping[str, float]
    known: float
    speed: float = 0.0
    frequency: float = 0.0
    amplitude: float = 0.0

    @classmethod
    def of(cls, both: Sequence[tuple[Record, Record]], amplitude: float, share: float) -> _Usual:
        """Uncertainties from pairs of events. amplitude: least one; share: see with_uncertainties."""
        kept = {key: _without_outliers([_relative(*pair, key) for pair in both]) for key in NUMBERS}
        safety = {key: min(BY_SHARE * share, SAFETY) if len(values) > 1 else SAFETY for key, values in kept.items()}
        speed, frequency, usual = (_usual(values, share) for values in kept.values())
        return cls(safety, amplitude, speed, frequency, max(amplitude, usual))


def slow_uncertainties(run: RunLike, second: RunLike) -> dict[str, float]:
    """Uncertainties of ring speeds, temperatures, losses and oil fractions over a whole run, as keys of its error: the
    largest difference of the means in WINDOWS parts of the run, times SAFETY, in the unit of the name. Of
    several signals of a kind the least certain one counts; without such signals the result is empty."""
    count = min(len(run), len(second))
    edges = np.unique(np.linspace(0, count, WINDOWS + 1).astype(np.int64))
    uncertainties = {}
    for quantity, key in SLOW.items():
        names = [name for name in run.signals if name.startswith(quantity)]
        apart = [_means(run, name, edges) - _means(second, name, edges) for name in names]
        if apart and count:
            uncertainties[key] = SAFETY * float(np.abs(apart).max())
    return uncertainties


def _means(run: RunLike, name: str, edges: NDArray[np.int64]) -> Array:
    """Means of a signal between samples (k + 1,)."""
    values = piece(run, name, 0, int(edges[-1]))
    return np.asarray(np.add.reduceat(values, edges[:-1]) / np.diff(edges))


def partners(events: Sequence[Record], second: Sequence[Record]) -> list[Record | None]:
    """The event of the second run that belongs to each event, None where there is none: the nearest pairs first, and no
    pair that crosses another one of its kind, film and point."""
    candidates = sorted(
        (abs(other["t_s"] - event["t_s"]), i, j)
        for i, event in enumerate(events)
        for j, other in enumerate(second)
        if _key(other) == _key(event) and _are_near(event, other)
    )
    partner_of: dict[int, int] = {}
    for _, i, j in candidates:
        same = [(a, b) for a, b in partner_of.items() if _key(events[a]) == _key(events[i])]
        if i not in partner_of and all((a < i) == (b < j) and b != j for a, b in same):
            partner_of[i] = j
    return [second[partner_of[i]] if i in partner_of else None for i in range(len(events))]


def _key(event: Record) -> tuple[Any, ...]:
    return tuple(event.get(name) for name in SAME)


def _are_near(event: Record, other: Record, times: float = 1.0) -> bool:
    """Whether two events are as near in time, or by the revolutions between them, as one of two runs may be; times: as
    much."""
    apart_s = abs(float(other["t_s"]) - float(event["t_s"]))
    revolutions = 0.5 * (abs(float(event["speed_Hz"])) + abs(float(other["speed_Hz"]))) * apart_s
    return apart_s <= times * NEAR * float(event["t_s"]) or revolutions <= times * NEAR_REVOLUTIONS


def _matched(run: RunLike, event: Record, other: Record, usual: _Usual) -> dict[str, Any]:
    """Keys to be added to an event that the second run has, too."""
    if event["kind"] in GIVEN:
        return {"speed_uncertainty_Hz": 0.0, "certain": True}
    step_Hz, line_Hz = resolution(run, event)
    off = {key: safety * _apart(event, other, key) for key, safety in usual.safety.items()}
    read = step_Hz if off[SPEED] == 0.0 else BETWEEN * step_Hz  # equal moments: both are no finer than a step
    line_Hz *= 1.0 if off[FREQUENCY] == 0.0 else PEAK
    speed = max(off[SPEED], usual.speed * _size(event, SPEED), read, _by_seed(run, event, usual.known))
    at_another_speed = abs(_number(event, "frequency_ratio")) * speed
    frequency = max(off[FREQUENCY], usual.frequency * _size(event, FREQUENCY), line_Hz, at_another_speed)
    near_s = _beside_the_shell(run, event, usual.amplitude)
    speed = max(speed, abs(float(event[SPEED]) - speed_at(run, float(event["t_s"]) - near_s)))
    reason = _faint(event) or _grazing(run, event, near_s)
    return {
        "speed_uncertainty_Hz": speed,
        "frequency_uncertainty_Hz": None if event.get(FREQUENCY) is None else frequency,
        "amplitude_uncertainty": None if event.get(AMPLITUDE) is None else max(off[AMPLITUDE], usual.amplitude),
        "certain": not reason,
        "reason": reason or None,
    }


def _unmatched(event: Record, events: Sequence[Record], second: Sequence[Record]) -> dict[str, Any]:
    """Keys to be added to an event that the second run does not have."""
    elsewhere = [other for other in second if _key(other) == _key(event)]
    again = [other for other in events if _key(other) == _key(event) and _are_near(event, other, RETURNS)]
    if reason := _faint(event):
        pass
    elif len(again) >= RETURNS:
        reason = "the motion comes and goes, and is chaotic"
    elif elsewhere and len(elsewhere) == sum(_key(other) == _key(event) for other in events):
        nearest = min(elsewhere, key=lambda other: abs(other["t_s"] - event["t_s"]))
        speed = float(nearest["speed_Hz"])
        reason = f"at {speed:.4g} Hz in the second run: it starts from round-off, or is near a fold"
    else:
        reason = "not in the second run: it starts from round-off, is near a fold, or chaotic"
    return {"certain": False, "reason": reason}


def _faint(event: Record) -> str:
    """Why an onset is not certain whose whirl hardly counts as one, "" for any other event."""
    amplitude = event.get("amplitude")
    begins = BEGINS if str(event["film"] or "").endswith(SIDES) else WHIRL_BEGINS
    if event["kind"] != "onset" or amplitude is None or amplitude >= FAINT * begins:
        return ""
    return f"its amplitude of at most {amplitude:.2g} is close to the {begins:g} from which a whirl counts"


def _by_seed(run: RunLike, event: Record, known: float) -> float:
    """Uncertainty in Hz of the speed of an onset whose whirl grows out of less than the error of the run: out of the
    errors of its steps, and later with smaller ones, by the logarithm."""
    rate = growth(run, event, known) if known > 0.0 else 0.0
    if rate == 0.0:
        return 0.0
    t, later_s = float(event["t_s"]), math.log(SMALLER) / rate
    return abs(speed_at(run, t + later_s) - speed_at(run, t - later_s)) / 2.0


def _grazing(run: RunLike, event: Record, near_s: float) -> str:
    """Why a contact is not certain, "" for any other event: it does not end its run, or the journal has been close to
    its shell for some time (near_s) before."""
    if event["kind"] != CONTACT or (run.status == "contact" and near_s == 0.0):
        return ""
    return "the journal grazes the shell, and may miss it by less than the error of its eccentricity"


def _beside_the_shell(run: RunLike, event: Record, amplitude: float) -> float:
    """How long in s before a contact the journal has already come as near to its shell as the amplitude is uncertain,
    to a factor of two; 0 below LONG, and of any other event."""
    name = joined("eccentricity", str(event["film"] or ""))
    if event["kind"] != CONTACT or name not in run.signals:
        return 0.0
    near = run.references.get("contact_eccentricity", 1.0) - amplitude
    t, turn_s = float(event["t_s"]), 1.0 / max(abs(float(event[SPEED])), 1.0)
    long_s, found_s = LONG * turn_s, 0.0
    while long_s < t:
        before = samples_about(run, t - 2.0 * long_s, t - long_s)
        if float(np.max(piece(run, name, *before))) < near:
            break
        found_s = long_s = 2.0 * long_s
    return min(found_s, t)


def _apart(event: Record, other: Record, key: str) -> float:
    """Difference of a number, NaN where one of both has none."""
    own, its = (_number(each, key) for each in (event, other))
    return abs(own - its)


def _relative(event: Record, other: Record, key: str) -> float:
    """Difference of a number, relative to it but for amplitudes, which are over the clearance."""
    return _apart(event, other, key) / (1.0 if key == AMPLITUDE else _size(event, key))


def _size(event: Record, key: str) -> float:
    return max(abs(_number(event, key)), 1e-300)


def _number(event: Record, key: str) -> float:
    value = event.get(key)
    return np.nan if value is None else float(value)


def _without_outliers(differences: Sequence[float]) -> Array:
    """Known values, ascending, without at least the largest quarter."""
    known = np.sort([value for value in differences if not np.isnan(value)])
    return known[: max(1, int(0.75 * len(known)))]


def _usual(kept: Array, share: float) -> float:
    """The uncertainty of an event by the differences of all of them without outliers."""
    if not len(kept):
        return 0.0
    by_count = SAFETY * TRIMMED * STUDENT[min(len(kept), len(STUDENT)) - 1] / STUDENT[0] * share / HALF
    return (min(by_count, SAFETY) if len(kept) > 1 else SAFETY) * float(np.sqrt(np.mean(kept**2)))
