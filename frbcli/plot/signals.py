"""What pictures read of a run: motions, lengths, names, events."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.analysis.events import find_events
from frbcli.analysis.signals import bearing_clearance, joined, points
from frbcli.film.cavitation.table import label_of
from frbcli.results.container import refuse
from frbcli.results.store import Run

Values = NDArray[np.float64]

DRAWN_POINTS = 4000  # more than a picture has columns of pixels
MICRO = 1e6


def located(run: Run, node: str) -> tuple[str, str]:
    """Kind and name of "disk", "journal" (the first, if there are several) or "journal_NAME" of a bearing."""
    kind, _, name = node.partition("_")
    return kind, name or next(points(run.signals, kind), "")


def motion(run: Run, node: str) -> tuple[Values, Values]:
    """x and y (n,) in m of a point, see located."""
    point = joined(*located(run, node))
    x, y = run[f"{point}_x_m"], run[f"{point}_y_m"]
    if len(x) < 2:
        raise refuse(run.path, "holds no samples yet.", "Let the run go on with --resume.")
    return x, y


def bearing_of(run: Run, node: str) -> str:
    """The bearing that a point belongs to: of a disk that of the same name, or else the first one."""
    bearings = list(points(run.signals, "journal"))
    name = located(run, node)[1]
    return name if name in bearings or not bearings else bearings[0]


def times(run: Run) -> Values:
    """Time (n,) in s; raises RunFileError if there is nothing to draw."""
    time_s = run["time_s"]
    if len(time_s) < 2:
        raise refuse(run.path, "holds no samples yet.", "Let the run go on with --resume.")
    return time_s


def cut(run: Run, from_time: float | None, to_time: float | None) -> slice:
    """The samples from from_time to to_time in s (None: to the end of the run). RunFileError if there are not two."""
    time_s = times(run)
    first = 0 if from_time is None else int(np.searchsorted(time_s, from_time))
    last = len(time_s) if to_time is None else int(np.searchsorted(time_s, to_time, side="right"))
    if last - first < 2:
        remedy = f"The run goes from {time_s[0]:g} s to {time_s[-1]:g} s."
        raise refuse(run.path, "has no samples between the times asked for.", remedy)
    return slice(first, last)


def clearance(run: Run, bearing: str = "") -> float:
    """How far in m a journal can move in a bearing: its clearance, of a floating ring C_i + C_o."""
    known = [length for name, length in run.references.items() if name.startswith("clearance_m")]
    length = bearing_clearance(run, bearing) or next(iter(known), 0.0)
    if length > 0.0:
        return length
    raise refuse(run.path, "does not say the clearance that amplitudes refer to.", "Run the case again.")


def model(run: Run) -> str:
    """The models of the film in words, as far as the run's case says them."""
    try:
        film = tomllib.loads(run.case_text).get("film", {})
        theory, cavitation = film.get("theory", ""), film.get("cavitation", "")
    except (tomllib.TOMLDecodeError, AttributeError):
        return ""
    cavitation = cavitation if isinstance(cavitation, str) else next(iter(cavitation), "")
    words = [label_of(cavitation)]
    if theory in ("short", "finite"):
        words.append(f"{theory} bearing")
    return ", ".join(word for word in words if word)


def labels(runs: Sequence[Run]) -> list[str]:
    """What tells several runs apart in a legend: their models if these differ, else their files."""
    for names in ([model(run) for run in runs], [run.path.stem for run in runs]):
        if len(set(names)) == len(runs) and all(names):
            return names
    return [str(run.path) for run in runs]


def heading(runs: Sequence[Run]) -> tuple[str, str]:
    """Title and subtitle of a picture of one or several runs."""
    names = list(dict.fromkeys(run.title for run in runs))
    title = names[0] if len(names) == 1 else "Comparison of runs"
    words = [model(runs[0])] if len({model(run) for run in runs}) == 1 else []
    if len(runs) == 1 and runs[0].status != "finished":
        words.append(f"{runs[0].status} at {runs[0].t_end_s:.4g} s")
    return title, ", ".join(word for word in words if word)


def thin(time_s: Values, values: Values) -> tuple[Values, Values]:
    """Fewer points that draw the same line: the lowest and the highest of each short stretch, where it lies."""
    stretch = len(values) // (DRAWN_POINTS // 2)
    if stretch < 4:
        return time_s, values
    rows = values[: len(values) // stretch * stretch].reshape(-1, stretch)
    first = np.arange(len(rows))[:, None] * stretch
    kept = np.sort(first + np.stack([rows.argmin(axis=1), rows.argmax(axis=1)], axis=1), axis=1).ravel()
    kept = np.unique(np.concatenate([kept, [len(values) - 1]]))
    return time_s[kept], values[kept]


def events(run: Run) -> list[dict[str, Any]]:
    """The events that the run tells, or else those found in it."""
    return run.events or [asdict(event) for event in find_events(run)]
