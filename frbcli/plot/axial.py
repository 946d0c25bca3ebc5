"""The axis of a run: position of the collar of a thrust bearing, thickness of its films, and its loss."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.plot.curves import Over, ScaledSignal, curves_figure, draw_curves
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.results.files.container import refuse
from frbcli.results.store import Run

PANELS = (("axial position in µm", 1e6), ("thrust film in µm", 1e6), ("thrust loss in W", 1.0))


def axial_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Axial position, smallest thickness of the films on the pads and their loss, the runs overlaid, from from_time to
    to_time in s. Raises RunFileError if a run has no axial load."""
    for run in runs:
        if AXIAL_SIGNALS[0].name not in run.signals:
            raise refuse(run.path, "has no axis.", "Draw a run of a case with [[thrust_bearing]] and [axial].")

    def panel(name: str, words: str, factor: float, axes: Axes) -> None:
        draw_curves(axes, runs, [("collar", [ScaledSignal(run.signal(name), factor) for run in runs])], over,
                    (from_time, to_time))  # fmt: skip
        axes.set_ylabel(words)

    told = zip(AXIAL_SIGNALS, PANELS, strict=True)
    return curves_figure(runs, [partial(panel, column.name, *each) for column, each in told], over, 6.5)
