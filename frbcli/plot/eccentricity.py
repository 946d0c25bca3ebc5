"""Eccentricity over time, of one run or of several."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.plot.signals import cut, heading, labels, suffixes, thin, times
from frbcli.plot.style import legend_below, new_figure, styled
from frbcli.results.store import Run


def eccentricity_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None
) -> Figure:
    """Relative eccentricity of each film over time, the runs overlaid, from from_time to to_time in s.

    Raises RunFileError if a run has none.
    """
    with styled():
        figure = new_figure(*heading(runs))
        axes = figure.subplots()
        draw_eccentricity(axes, runs, from_time, to_time)
        legend_below(figure, axes)
    return figure


def draw_eccentricity(
    axes: Axes, runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None
) -> None:
    """The curves on axes of a figure, labelled with their run and bearing where there are several."""
    for run, label in zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True):
        shown = cut(run, from_time, to_time)
        for suffix in suffixes(run, "eccentricity") or [""]:
            name = ", ".join(word for word in (label, suffix[1:]) if word)
            axes.plot(*thin(times(run)[shown], run["eccentricity" + suffix][shown]), label=name)
    axes.set_ylim(0.0, 1.0)
    axes.margins(x=0.0)
    axes.set_xlabel("time in s")
    axes.set_ylabel("eccentricity")
