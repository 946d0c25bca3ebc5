"""Displacements and eccentricities of runs.

Eccentricity over time or rotor speed, of one run or of several.

Displacement over time, of one run or of several.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import SignalColumn, films, joined, located, points
from frbcli.arrays import Array
from frbcli.plot.curves import HEIGHT, Over, Span, curves_figure, draw_curves
from frbcli.plot.signals import MICRO, curve, cut, heading, labels, motion
from frbcli.plot.style import legend_below, new_figure, styled
from frbcli.results.store import Run

SIDES = ("inner", "outer")
PANEL_HEIGHT = 2.6  # inches


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
