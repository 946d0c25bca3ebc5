"""Names of the signals of a run, and access to them.

Times of measured samples: which rise, which are even but rounded, and signals at even steps.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.errors import did_you_mean, input_error
from frbcli.results.measured_columns import Columns, wrong_file
from frbcli.results.records import TIME
from frbcli.results.store import CLEARANCE_STEP, CRITICAL_SPEED, CRITICAL_SPEEDS, LOSS

KINDS = ("journal", "disk", "ring", "shell", "support", "housing")  # of points
END = "_x_m"
FORCED = "forced"  # begins the names of the references that are frequencies and orders of what forces a run
PIECE = 2**17  # samples of a signal that are looked at together: 1 MB
CORNERS = 400  # intervals of a run in which its ramp is determined


class SignalColumn(Protocol):
    """Values (n,) that are given in slices: an array, or a signal of a run that is too long to be read at once."""

    def __len__(self) -> int: ...
    def __getitem__(self, where: slice, /) -> Array: ...


class RunLike(Protocol):
    """A run as the analysis reads it: its signals by name, lengths in m to compare them with, how it ended."""

    @property
    def signals(self) -> Iterable[str]:
        """The names of the signals of the run."""
        ...

    @property
    def references(self) -> dict[str, float]:
        """Lengths in m that signals are compared with, such as the clearance of a film, by their names."""
        ...

    @property
    def status(self) -> str:
        """How the run ended: "finished", "standstill", "contact", "starved", "not-converged" or
        "interrupted"."""
        ...

    def __getitem__(self, name: str) -> Array: ...
    def __len__(self) -> int: ...


@dataclass(frozen=True)
class SlicedColumn:
    """Values (n,) that are read, or computed of others, slice by slice. of: from one sample to before another."""

    length: int
    of: Callable[[int, int], Array]

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, where: slice, /) -> Array:
        first, last, _ = where.indices(self.length)
        return self.of(first, last)


def signal_of(run: RunLike, name: str) -> SlicedColumn:
    """A signal (n,) of a run."""
    return SlicedColumn(len(run), partial(piece, run, name))


def ring_speed_of(run: RunLike, name: str) -> SlicedColumn:
    """The speed (n,) in Hz of the ring of a bearing with a name; 0 of one that does not turn."""
    return SlicedColumn(len(run), partial(ring_speed, run, name))


def piece(run: RunLike, name: str, start: int, stop: int) -> Array:
    """The samples from start to stop of a signal; a run that can read them alone does so."""
    read = getattr(run, "read", None)
    return np.asarray(run[name][start:stop] if read is None else read(name, start, stop))


def samples(column: SignalColumn, places: NDArray[np.int64]) -> Array:
    """The values at some samples (k,), ascending, read in pieces."""
    if len(places) == 0:
        return np.empty(0)
    first, last = int(places[0]), int(places[-1])
    parts = []
    for start in range(first, last + 1, PIECE):
        here = places[(places >= start) & (places < start + PIECE)]
        if len(here):
            begin = int(here[0])
            parts.append(column[begin : int(here[-1]) + 1][here - begin])
    return np.concatenate(parts)


def course(time_s: SignalColumn, speed_Hz: SignalColumn) -> tuple[Array, Array]:
    """Time in s and rotor speed in Hz at the ends of CORNERS intervals of a run (n,)."""
    count = len(time_s)
    places = np.unique(np.linspace(0, count - 1, CORNERS + 1).round().astype(np.int64))
    return samples(time_s, places), samples(speed_Hz, places)


def steepest_ramp(time_s: SignalColumn, speed_Hz: SignalColumn) -> float:
    """The largest change of the rotor speed of a run (n,) in Hz/s, 0 at a constant speed."""
    time, speed = course(time_s, speed_Hz)
    return float(np.max(np.abs(np.diff(speed) / np.diff(time)), initial=0.0)) if time[-1] > time[0] else 0.0


def pieces(count: int) -> Iterator[tuple[int, int]]:
    """(start, stop) of the pieces of a run of so many samples."""
    return ((start, min(start + PIECE, count)) for start in range(0, count, PIECE))


def located(run: RunLike, node: str) -> tuple[str, str]:
    """Kind and name of "disk", "journal" (the first, if there are several), "journal_NAME" or "shell_NAME" of a
    bearing or "disk_NAME" of a disk; NAME alone, of a bearing its journal, will do where a bearing and a disk do not
    share it."""
    alone = [kind for kind in ("journal", "disk") if node in points(run.signals, kind)]
    if len(alone) == 1 and node not in KINDS:
        return alone[0], node
    kind, _, name = node.partition("_")
    return kind, name or next(points(run.signals, kind), "")


def point_of(run: RunLike, node: str) -> str:
    """The name of a point, as `located` finds it, in the names of its signals. Raises InputError if the run has no such
    point."""
    kind, name = located(run, node)
    if kind not in KINDS or name not in points(run.signals, kind):
        known = [joined(each, one) for each in KINDS for one in points(run.signals, each)]
        problem = "is not a point of the run."
        raise input_error("signals", "signal", node, problem, did_you_mean(node, known))
    return joined(kind, name)


def joined(*words: str) -> str:
    """Words that are not empty, as names of signals and films join them."""
    return "_".join(word for word in words if word)


def points(names: Iterable[str], kind: str) -> Iterator[str]:
    """The names behind one of KINDS in the signals: "" of one alone, or the name of a bearing or a wheel."""
    for name in names:
        if name.endswith(END) and (name == kind + END or name.startswith(kind + "_")):
            yield name[len(kind) + 1 : -len(END)]


def films(names: Iterable[str]) -> Iterator[str]:
    """The films whose eccentricities are among the signals: "" alone, or their names."""
    return (name[len("eccentricity_") :] for name in names if f"{name}_".startswith("eccentricity_"))


def motion_of(run: RunLike, kind: str, name: str, start: int = 0, stop: int | None = None) -> Complex:
    """x + iy (n,) in m of a point, from one sample to another."""
    node, stop = joined(kind, name), len(run) if stop is None else stop
    return np.asarray(piece(run, node + END, start, stop) + 1j * piece(run, f"{node}_y_m", start, stop))


def ring_speed(run: RunLike, name: str, start: int = 0, stop: int | None = None) -> Array:
    """Speed (n,) in Hz of the ring of a bearing, from one sample to another; 0 of a ring that does not turn."""
    signal, stop = joined("ring_speed", name, "Hz"), len(run) if stop is None else stop
    return piece(run, signal, start, stop) if signal in set(run.signals) else np.zeros(stop - start)


def in_film(run: RunLike, bearing: str) -> bool:
    """Whether the journal of a bearing is in a film; elsewhere nothing says how far it can move."""
    known = set(films(run.signals))
    own = {bearing, *(joined(bearing, side) for side in ("inner", "damper"))}
    return bool(known) and (not bearing or bool(own & known))


def samples_about(run: RunLike, begin_s: float, end_s: float) -> tuple[int, int]:
    """(start, stop) of the samples, at even times, from the one before begin_s to the one after end_s."""
    count = len(run)
    first, last = (float(piece(run, TIME, place, place + 1)[0]) for place in (0, count - 1))
    step = (last - first) / max(count - 1, 1)
    if not step > 0.0:
        return 0, count
    start, stop = int((begin_s - first) / step) - 1, int((end_s - first) / step) + 3
    return min(max(0, start), max(0, count - 2)), min(max(2, stop), count)


def speed_at(run: RunLike, t_s: float) -> float:
    """The rotor speed in Hz at a time."""
    where = samples_about(run, t_s, t_s)
    return float(np.interp(t_s, piece(run, TIME, *where), piece(run, "speed_Hz", *where)))


def critical_speeds(run: RunLike) -> list[float] | None:
    """Critical speeds of the linearised machine in Hz, ascending; None if the run does not know them."""
    if CRITICAL_SPEEDS not in run.references:
        return None
    numbers = range(1, int(run.references[CRITICAL_SPEEDS]) + 1)
    known = (run.references.get(f"{CRITICAL_SPEED}_{number}_Hz") for number in numbers)
    return sorted(speed for speed in known if speed is not None)


def is_forced(name: str, kind: str) -> bool:
    """Whether a reference is a frequency ("Hz") or an order ("order") of what forces a run."""
    return name.startswith(f"{FORCED}_") and name.endswith(f"_{kind}")


def times_of(run: RunLike, change: str) -> list[tuple[float, str]]:
    """Times in s of sudden changes, CLEARANCE_STEP or LOSS, ascending, each with the name of the part that changes, ""
    of one alone; whether the run has reached them or not."""
    found = ((re.fullmatch(rf"{change}_\d+_(?:(.+)_)?s", name), time) for name, time in run.references.items())
    return sorted((time, name[1] or "") for name, time in found if name is not None)


def last_change(run: RunLike) -> float:
    """When a part was lost or a clearance changed for the last time, s; -inf if nothing changes."""
    end = float(piece(run, TIME, len(run) - 1, len(run))[0])
    changes = (time for change in (LOSS, CLEARANCE_STEP) for time, _ in times_of(run, change))
    return max((time for time in changes if time < end), default=-math.inf)


def bearing_clearance(run: RunLike, name: str = "") -> float | None:
    """How far in m the journal of a bearing can move: the clearance, of a floating ring the sum of both, plus the
    damper's."""
    lengths = run.references
    damper, common = lengths.get(joined("clearance_m", name, "damper")), lengths.get("clearance_m")
    room = lengths.get(joined("clearance_m", name), common)
    if name in points(run.signals, "ring"):
        both = [lengths.get(joined("clearance_m", name, side)) for side in ("inner", "outer")]
        known = [length for length in both if length is not None]
        room = sum(known) if len(known) == 2 else room
    elif damper is not None and name not in films(run.signals):
        return damper  # the shaft is in no film of its own
    return room if damper is None or room is None else room + damper


UNEVEN = 1e-3  # of the step, by which times may be off it; beyond this the signals are interpolated to even steps
# A step may differ from the median one by this share of it. What is further apart has lost samples between: what moves
# there is not known, and what was sampled slower than elsewhere would show with wrong frequencies.
JITTER = 0.5
MOST_DECIMALS = 9
EXACT = 1e-3  # of a last decimal place, by which a rounded number may be off it
ROUNDED = 0.55  # of a last decimal place: rounding moves a time by half of it, and the fitted line a little
COARSEST = 2.5  # times a step, which the last decimal place may be
RARE = 3.0  # times the usual interval of a slow channel: a longer one is a gap


def require_rising(columns: Columns, name: str, time: Array) -> Array:
    """The times (n,) in s of a column; those that are even but rounded to few decimals are made even. Raises InputError
    if they do not rise, or have gaps."""
    even = _even_but_rounded(time)
    if even is not None:
        return even
    steps = np.diff(time)
    if not np.all(steps > 0.0):
        place = int(np.argmin(steps > 0.0)) + 1
        problem = f'has times in "{name}" that do not rise at {columns.row(place)}.'
        raise wrong_file(columns.path, problem, "Sort the rows by time, or give --rate instead of --time.")
    usual = float(np.median(steps))
    off = np.abs(steps - usual)
    place = int(np.argmax(off))
    if off[place] > JITTER * usual:
        irregular = f"has a step of {steps[place]:.4g} s"
        problem = f'{irregular} in "{name}" before {columns.row(place + 1)}, and else of {usual:.4g} s.'
        raise wrong_file(
            columns.path, problem, "Cut the file there; if no sample is missing, give --rate instead of --time."
        )
    return time


def _even_but_rounded(time: Array) -> Array | None:
    """Even times (n,) from which the given ones (n,) differ by no more than the rounding of their last decimal place;
    None if they are exact, or uneven, or rounded to more than a step."""
    count = len(time)
    if count < 3 or not time[-1] > time[0]:
        return None
    number = np.arange(count)
    step, begin = np.polynomial.polynomial.polyfit(number, time - time[0], 1)[::-1]
    even = time[0] + begin + step * number
    off = float(np.max(np.abs(time - even)))
    if off <= UNEVEN * step:
        return None
    for decimals in range(MOST_DECIMALS + 1):
        unit = 10.0**-decimals
        scaled = time / unit
        if np.max(np.abs(scaled - np.round(scaled))) <= max(EXACT, 4.0 * np.spacing(np.max(np.abs(scaled)))):
            return even if off <= ROUNDED * unit and unit <= COARSEST * step else None
    return None


def sampled_at(time: Array, columns: Columns, name: str, own: Array, values: Array) -> Array:
    """A slow channel (m,), NaN where it has no value, at the times (n,) in s, by straight lines between its values.

    own: the times (m,) in s of its values, NaN at gaps. Raises InputError if both have unequal lengths, if the channel
    has gaps among its values, or if it does not reach over the times.
    """
    if len(own) != len(values):
        problem = f'has {len(values)} values in "{name}" and {len(own)} times.'
        raise wrong_file(columns.path, problem, "Give --speed-time COLUMN, the times of the rotor speed.")
    known = np.flatnonzero(np.isfinite(values) & np.isfinite(own))
    if own is time and len(known) == len(time):
        return values
    if len(known) < 2:
        raise wrong_file(columns.path, f'has fewer than two numbers in "{name}".', "Choose another column.")
    moments, values_there = own[known], values[known]
    steps = np.diff(moments)
    if not np.all(steps > 0.0):
        place = int(known[int(np.argmin(steps > 0.0)) + 1])
        raise wrong_file(columns.path, f'has times of "{name}" that do not rise at {columns.row(place)}.', "Sort them.")
    longest = RARE * float(np.median(steps))
    missing = np.flatnonzero(steps > longest)
    if len(missing):
        place = int(known[missing[0]]) + 1
        problem = f'has no number in {columns.row(place)} of the column "{name}".'
        raise wrong_file(columns.path, problem, "Leave such rows out.")
    if moments[0] - time[0] > longest or time[-1] - moments[-1] > longest:
        problem = f'has numbers in "{name}" from {moments[0]:.4g} s to {moments[-1]:.4g} s alone.'
        remedy = f"Cut the file to these times; it lasts from {time[0]:.4g} to {time[-1]:.4g} s."
        raise wrong_file(columns.path, problem, remedy)
    return np.asarray(np.interp(time, moments, values_there))


def even_steps(time: Array, signals: Mapping[str, Array]) -> dict[str, Array]:
    """Times (m,) at even steps and signals (m,) at them. Where the times (n,) are uneven, the steps are as short as the
    shortest one, so that nothing is sampled coarser than before, and signals are interpolated by cubic splines."""
    step = (time[-1] - time[0]) / (len(time) - 1)
    even = time[0] + step * np.arange(len(time))
    if np.max(np.abs(even - time)) < UNEVEN * step:
        return {"time_s": even, **signals}
    from scipy.interpolate import CubicSpline

    count = int(np.ceil((time[-1] - time[0]) / float(np.min(np.diff(time))))) + 1
    even = np.linspace(time[0], time[-1], count)
    return {"time_s": even, **{name: CubicSpline(time, values)(even) for name, values in signals.items()}}
