"""Data of a run for pictures: motions, lengths, names, events; and the envelope of a signal with many samples: the
lowest and the highest value of each short span.

A run is read a piece at a time, so that a long run needs no more memory than a short one.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.order_tracking import CELLS
from frbcli.analysis.signals import SignalColumn, bearing_clearance, films, in_film, located, point_of, points, speed_at
from frbcli.arrays import Array
from frbcli.case.reading.settings import TomlFault, parse
from frbcli.case.reading.tables import table
from frbcli.film.cavitation.table import label_of
from frbcli.plot.style import MOST_MARKED, plain
from frbcli.results.container import refuse
from frbcli.results.records import SPEED, TIME, Signal, pieces
from frbcli.results.store import Run

DRAWN_POINTS = 4000  # more than a picture has columns of pixels
SHORTEST = 4  # samples of a span; with fewer, all are drawn
SPANS = 120  # of an envelope: some pixels each
MICRO = 1e6
NO_CLEARANCE = "Run the case again; of a measurement give --clearance, or --linear for amplitudes in um."
RAMP_s = 5e-3  # before and after an event, in which its ramp is taken
MOST_SEARCHED = 2_000_000  # samples in which events are sought
_MODEL = re.compile("[a-z-]{1,40}")


class Envelope:
    """Fewer points that draw the same line: the lowest and the highest of each span at their places, and the last.

    count: of the points that will come, in their order.
    """

    def __init__(self, count: int) -> None:
        stretch = count // (DRAWN_POINTS // 2)
        self._stretch = stretch if stretch >= SHORTEST else 1
        self._kept: list[Array] = []
        self._rest = np.empty((2, 0))

    def add(self, place: Array, values: Array) -> None:
        """Take the next points: values (m,) at places (m,)."""
        points = np.concatenate([self._rest, np.stack([place, values])], axis=1)
        whole = max(points.shape[1] - 1, 0) // self._stretch * self._stretch  # the last point is for `points` to keep
        rows = points[1, :whole].reshape(-1, self._stretch)
        first = np.arange(0, whole, self._stretch)
        kept = np.unique(np.concatenate([first + rows.argmin(axis=1), first + rows.argmax(axis=1)]))
        self._kept.append(points[:, kept])
        self._rest = points[:, whole:]

    def points(self) -> tuple[Array, Array]:
        """Places and values (k,) of the line."""
        values = self._rest[1]
        whole = len(values) == self._stretch
        kept = np.unique([values.argmin(), values.argmax(), len(values) - 1]) if whole else np.arange(len(values))[-1:]
        place, values = np.concatenate([*self._kept, self._rest[:, kept]], axis=1)
        return place, values


def curve(run: Run, column: SignalColumn, first: int = 0, last: int | None = None) -> tuple[Array, Array]:
    """Times and values (k,) that draw the samples of a column from `first` to before `last`, by default all."""
    last = len(run) if last is None else last
    line = Envelope(last - first)
    for start, stop in pieces(first, last):
        line.add(run.read(TIME, start, stop), column[start:stop])
    return line.points()


def envelope(run: Run, column: SignalColumn) -> tuple[Array, Array, Array]:
    """Times (k,), and the lowest and the highest value (k,) of spans that begin there."""
    times, values = curve(run, column)
    if len(times) < SHORTEST * SPANS:
        return times, values, values
    first = np.unique(np.searchsorted(times, np.linspace(times[0], times[-1], SPANS, endpoint=False)))
    return times[first], np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)


def extremes(column: SignalColumn, first: int, last: int) -> tuple[float, float]:
    """The lowest and the highest value of some samples; what is no number does not count. (inf, -inf) without any."""
    lowest, highest = np.inf, -np.inf
    for start, stop in pieces(first, last):
        values = column[start:stop]
        lowest = float(np.fmin.reduce(values, initial=lowest))
        highest = float(np.fmax.reduce(values, initial=highest))
    return lowest, highest


def at_times(run: Run, column: SignalColumn, times: Array) -> Array:
    """The values (k,) of a column at ascending times (k,) in s, on the line between the samples."""
    values = np.empty(len(times))
    for start, stop in pieces(0, len(run)):
        stop = min(stop + 1, len(run))  # up to the first sample of the next piece
        time_s = run.read(TIME, start, stop)
        first = 0 if start == 0 else np.searchsorted(times, time_s[0])
        here = slice(first, len(times) if stop == len(run) else np.searchsorted(times, time_s[-1]))
        values[here] = np.interp(times[here], time_s, column[start:stop])
    return values


def motion(run: Run, node: str) -> tuple[Signal, Signal]:
    """x and y (n,) in m of a point, see located."""
    point = point_of(run, node)
    x, y = run.signal(f"{point}_x_m"), run.signal(f"{point}_y_m")
    ends(run)
    return x, y


def bearing_of(run: Run, node: str) -> str:
    """The bearing that a point belongs to: for a disk the bearing of the same name, or else the first one."""
    bearings = list(points(run.signals, "journal"))
    name = located(run, node)[1]
    return name if name in bearings or not bearings else bearings[0]


def ends(run: Run) -> tuple[float, float]:
    """The first and the last time in s; raises RunFileError if there is nothing to draw."""
    if len(run) < 2:
        raise refuse(run.path, "holds no samples yet.", "Resume the run with --resume.")
    return float(run.read(TIME, 0, 1)[0]), float(run.read(TIME, len(run) - 1)[0])


def cut(run: Run, from_time: float | None, to_time: float | None) -> tuple[int, int]:
    """The samples from from_time to to_time in s (None: to the end of the run), as the first and that after the last.
    Raises RunFileError if there are not two."""
    begin, end = ends(run)
    samples = range(len(run))

    def time_at(sample: int) -> float:
        return float(run.read(TIME, sample, sample + 1)[0])

    first = 0 if from_time is None else bisect_left(samples, from_time, key=time_at)
    last = len(run) if to_time is None else bisect_right(samples, to_time, key=time_at)
    if last - first < 2:
        remedy = f"The run goes from {begin:g} s to {end:g} s."
        raise refuse(run.path, "has no samples between the times asked for.", remedy)
    return first, last


def clearance(run: Run, bearing: str = "") -> float:
    """How far in m a journal can move in a bearing: its clearance, of a floating ring C_i + C_o; of a machine without
    films the length that replaces it. Raises RunFileError where the run does not state it."""
    known = [length for name, length in run.references.items() if is_length(name)]
    length = bearing_clearance(run, bearing) or next(iter(known), 0.0)
    if length > 0.0:
        return length
    raise refuse(run.path, "lacks the clearance to which amplitudes refer.", NO_CLEARANCE)


def is_length(reference: str) -> bool:
    """Whether a reference of a run is a length that amplitudes refer to."""
    return reference.startswith(("clearance_m", "length_m"))


def shell(run: Run, bearing: str = "") -> float | None:
    """The clearance of a bearing in m, None of one without a film, where no shell is drawn."""
    has_films = any(True for _ in films(run.signals))  # a measured run may not say where it has films
    room = in_film(run, bearing) if has_films else "length_m" not in run.references
    return clearance(run, bearing) if room else None


def case_tables(run: Run) -> dict[str, Any]:
    """The tables of the case that a run was made of. Raises RunFileError if its text is not a case."""
    try:
        return parse(run.case_text)
    except TomlFault as error:
        raise refuse(run.path, f"has no readable case: {error}", "Run the case again.") from None


def model(run: Run) -> str:
    """The models of the film in words, as far as the run's case says them. Raises as case_tables."""
    film = table(case_tables(run), "film")
    laws = table(film, "cavitation")  # of earlier versions: the law's numbers in a table of its name
    theory, cavitation = film.get("theory"), str(next(iter(laws), "") if laws else film.get("cavitation", ""))
    cavitation = cavitation if _MODEL.fullmatch(cavitation) else ""
    words = [label_of(cavitation)]
    if table(laws or film, cavitation).get("form") == "published":
        words.append("published form")
    if theory in ("short", "finite"):
        words.append(f"{theory} bearing")
    return ", ".join(word for word in words if word)


def labels(runs: Sequence[Run]) -> list[str]:
    """Names of several runs in a legend: their models if these differ, else their files."""
    for names in ([model(run) for run in runs], [run.path.stem for run in runs]):
        if len(set(names)) == len(runs) and all(names):
            return [plain(name) for name in names]
    return [plain(str(run.path)) for run in runs]


def heading(runs: Sequence[Run]) -> tuple[str, str]:
    """Title and subtitle of a picture of one or several runs."""
    names = list(dict.fromkeys(run.title for run in runs))
    title = names[0] if len(names) == 1 else "Comparison of runs"
    words = [model(runs[0])] if len({model(run) for run in runs}) == 1 else []
    if len(runs) == 1 and runs[0].status != "finished":
        words.append(f"{runs[0].status} at {runs[0].t_end_s:.4g} s")
    return title, ", ".join(word for word in words if word)


def events(run: Run) -> list[dict[str, Any]]:
    """The recorded events of the run, else those found in it; none where the search would take too much memory."""
    return run.events or ([asdict(event) for event in find_events(run)] if is_searchable(run) else [])


def uncertain_times(run: Run) -> list[tuple[float, float]]:
    """Time in s of each event with an uncertainty in the rotor speed, and how much earlier or later it may be; events
    at a constant speed are left out."""
    uncertain = []
    for event in run.events[:MOST_MARKED]:
        uncertainty, t = event.get("speed_uncertainty_Hz"), event["t_s"]
        before, after = (speed_at(run, time) for time in (t - RAMP_s, t + RAMP_s))
        if uncertainty and after != before:
            uncertain.append((t, min(uncertainty * 2.0 * RAMP_s / abs(after - before), ends(run)[1])))
    return uncertain


def is_searchable(run: Run) -> bool:
    """Whether a run is short enough for a search for events, which takes it whole and at even angles of the rotor."""
    begin, end = ends(run)
    fastest = max(map(abs, extremes(run.signal(SPEED), 0, len(run))))
    return len(run) <= MOST_SEARCHED and fastest * (end - begin) * CELLS <= MOST_SEARCHED
