"""The motion of journals in a run: displacements over time, eccentricities over time or rotor speed, of one run or of
several; and the orbit of a journal inside its clearance circle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from frbcli.analysis.signals import SignalColumn, films, joined, located, points
from frbcli.arrays import Array
from frbcli.plot.curves import HEIGHT, Over, Span, curves_figure, draw_curves
from frbcli.plot.signals import MICRO, curve, cut, ends, envelope, heading, labels, motion, shell
from frbcli.plot.style import BAND, COLOURS, GREY, legend_below, new_figure, styled
from frbcli.results.records import Signal, pieces
from frbcli.results.store import Run

Line = Any  # a line style of matplotlib: a name, or an offset and lengths of dashes

SIDES = ("inner", "outer")
PANEL_HEIGHT = 2.6  # inches
LAST_s = 0.1  # what is shown if no time is given
ALL_DRAWN = 300_000  # samples of an orbit up to which every step is drawn
CELLS = 600  # in each direction, about as many as the picture has pixels
PER_STEP = 5  # places of a step at which it is seen to touch a cell


def eccentricity_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Relative eccentricity of each film, the runs overlaid, from from_time to to_time in s.

    Inner and outer films of floating rings have a panel each. Over speed, a run-down shows its hysteresis. Raises
    RunFileError if a run has no eccentricity.
    """

    def panel(side: str, names: list[str], axes: Axes) -> None:
        draw_eccentricity(axes, runs, names, (from_time, to_time), over)
        if side:
            axes.set_title(f"{side} film")

    panels = [partial(panel, *group) for group in _groups(runs[0])]
    return curves_figure(runs, panels, over, max(HEIGHT, 0.8 + PANEL_HEIGHT * len(panels)))


def draw_eccentricity(
    axes: Axes, runs: Sequence[Run], names: Sequence[str] = (), span: Span = (None, None), over: Over = "time"
) -> None:
    """The curves of some films, or of all, on axes of a figure, labelled with run and film where there are several."""
    names = names or list(films(runs[0].signals)) or [""]
    film_labels = [_without_side(name) if len(names) < len(list(films(runs[0].signals))) else name for name in names]
    curves = [
        (label.replace("_", " "), [run.signal(joined("eccentricity", name)) for run in runs])
        for label, name in zip(film_labels, names, strict=True)
    ]
    draw_curves(axes, runs, curves, over, span)
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("eccentricity")


def draw_largest(axes: Axes, run: Run, film: str, colour: str, line: Line = "-", label: str = "") -> None:
    """The largest eccentricity of a film over time as a line, and down to the smallest one a faint band: whirls of
    several films would hide each other."""
    times, lowest, highest = envelope(run, run.signal(joined("eccentricity", film)))
    axes.fill_between(times, lowest, highest, color=colour, alpha=0.5 * BAND, linewidth=0.0)
    axes.plot(times, highest, color=colour, linestyle=line, label=label.replace("_", " "))
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("largest eccentricity,\nband: down to the smallest")


def _groups(run: Run) -> list[tuple[str, list[str]]]:
    """The films of each panel: films inside of rings, films outside of rings, and all others."""
    all_films = list(films(run.signals)) or [""]
    groups = [(side, [name for name in all_films if name.split("_")[-1] == side]) for side in SIDES]
    groups.append(("", [name for name in all_films if name.split("_")[-1] not in SIDES]))
    return [(side, names) for side, names in groups if names]


def _without_side(name: str) -> str:
    return "_".join(word for word in name.split("_") if word not in SIDES)


@dataclass(frozen=True)
class Distance:
    """The distance of a point from the axis, um; read in pieces like a signal."""

    x: SignalColumn
    y: SignalColumn

    def __len__(self) -> int:
        return len(self.x)

    def __getitem__(self, where: slice) -> Array:
        return np.asarray(MICRO * np.hypot(self.x[where], self.y[where]))


def draw_distances(axes: Axes, runs: Sequence[Run]) -> None:
    """The distances of all journals and disks from the axis, for machines without films."""
    nodes = [joined(kind, name) for kind in ("journal", "disk") for name in points(runs[0].signals, kind)]
    curves = [(node.replace("_", " "), [Distance(*motion(run, node)) for run in runs]) for node in nodes]
    draw_curves(axes, runs, curves, "time", (None, None))
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("distance in µm")


def displacement_figure(
    runs: Sequence[Run],
    signal: str | None = None,
    from_time: float | None = None,
    to_time: float | None = None,
) -> Figure:
    """x and y over time, the runs overlaid, from from_time to to_time in s.

    signal: "disk", "journal" or "journal_NAME" of a bearing; None takes the disk where every run has one.
    Raises RunFileError if a run lacks the signal.
    """
    node = signal or ("disk" if all(list(points(run.signals, "disk")) for run in runs) else "journal")
    title, subtitle = heading(runs)
    what = f"displacement of the {joined(*located(runs[0], node)).replace('_', ' ')}"
    with styled():
        figure = new_figure(title, ", ".join(text for text in (subtitle, what) if text), height=5.0)
        panels = figure.subplots(2, 1, sharex=True)
        for run, label in zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True):
            shown = cut(run, from_time, to_time)
            for axes, signal_there in zip(panels, motion(run, node), strict=True):
                time_s, values = curve(run, signal_there, *shown)
                axes.plot(time_s, values * MICRO, label=label, alpha=1.0 if len(runs) == 1 else 0.75)
        for axes, name in zip(panels, "xy", strict=True):
            axes.set_ylabel(f"{name} in µm")
            axes.margins(x=0.0)
        panels[1].set_xlabel("time in s")
        legend_below(figure, panels[0])
    return figure


def orbit_figure(runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None) -> Figure:
    """Orbits of all journals from from_time to to_time in s (default: the last 0.1 s), one panel per bearing.

    A dot marks where an orbit begins. Raises RunFileError if a run has no samples between these times.
    """
    bearings = list(points(runs[0].signals, "journal")) or [""]
    end = min(ends(run)[1] for run in runs) if to_time is None else to_time
    begin = max(end - LAST_s, 0.0) if from_time is None else from_time
    title, subtitle = heading(runs)
    span = f"orbit from {begin:.4g} s to {end:.4g} s"
    with styled():
        figure = new_figure(title, ", ".join(text for text in (subtitle, span) if text), 4.8 * len(bearings), 5.2)
        for axes, bearing in zip(figure.subplots(1, len(bearings), squeeze=False)[0], bearings, strict=True):
            axes.set_title(bearing)
            draw_orbits(axes, runs, bearing, (begin, end))
        legend_below(figure, axes)
    return figure


def draw_orbits(axes: Axes, runs: Sequence[Run], bearing: str, span_s: tuple[float, float]) -> None:
    """The orbits of the journal of a bearing within a span of time in s, with its clearance."""
    widest = 0.0
    circles: set[float] = set()
    for number, (run, label) in enumerate(zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True)):
        first, last = cut(run, *span_s)
        signals = motion(run, joined("journal", bearing))
        colour = COLOURS[number % len(COLOURS)]
        x, y = (values * MICRO for values in visible_steps(*signals, first, last))
        axes.plot(x, y, color=colour, linewidth=0.9, label=label)
        axes.plot(x[:1], y[:1], color=colour, marker="o", markersize=4.0)
        room = shell(run, bearing)
        if room is not None:
            circles.add(room * MICRO)
        widest = max(widest, *circles, _reach(*signals, first, last) * MICRO)
    for radius in circles:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.2))
    if circles:
        words = ", ".join(f"{radius:.4g}" for radius in sorted(circles))
        axes.text(0.02, 0.98, f"grey: clearance\n{words} µm", transform=axes.transAxes, va="top", color=GREY)
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.axvline(0.0, color=GREY, linewidth=0.5)
    axes.set_aspect("equal")
    axes.set_xlim(-1.12 * widest, 1.12 * widest)
    axes.set_ylim(-1.12 * widest, 1.12 * widest)
    axes.set_xlabel("x in µm")
    axes.set_ylabel("y in µm")


def _reach(x: Signal, y: Signal, first: int, last: int) -> float:
    """The largest distance from the centre."""
    return max(float(np.max(np.hypot(x[start:stop], y[start:stop]))) for start, stop in pieces(first, last))


def visible_steps(x: Signal, y: Signal, first: int, last: int) -> tuple[Array, Array]:
    """x and y (k,) of an orbit from one sample to before another: of a long one only the steps that touch a part of the
    picture that no step before has touched, apart from each other by NaN."""
    if last - first <= ALL_DRAWN:
        return x[first:last], y[first:last]
    reach = _reach(x, y, first, last) or 1.0
    touched = np.zeros((CELLS, CELLS), dtype=bool)
    kept = []
    for start, stop in pieces(first, last - 1):
        steps = np.stack([np.stack([signal[start:stop], signal[start + 1 : stop + 1]]) for signal in (x, y)])
        places = steps[:, :1] + np.linspace(0.0, 1.0, PER_STEP)[:, None] * np.diff(steps, axis=1)  # (2, PER_STEP, m)
        column, row = ((0.5 + 0.5 * places / reach) * (CELLS - 1)).astype(np.int64)
        cells = CELLS * row + column
        fresh = ~touched.ravel()[cells]
        # of the steps of this piece that touch the same fresh part, the first one
        _, earliest = np.unique(cells.T[fresh.T], return_index=True)
        chosen = np.unique(np.nonzero(fresh.T)[0][earliest])
        touched.ravel()[cells[:, chosen]] = True
        gaps = np.full((2, 1, len(chosen)), np.nan)
        kept.append(np.concatenate([steps[:, :, chosen], gaps], axis=1).transpose(0, 2, 1).reshape(2, -1))
    drawn = np.concatenate(kept, axis=1)
    return drawn[0], drawn[1]
