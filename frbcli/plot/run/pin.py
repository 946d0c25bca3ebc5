"""Rings with a pin: the angle that they have turned by, and the torque of the pin."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import joined
from frbcli.plot.curves import Over, ScaledSignal, curves_figure, draw_curves
from frbcli.results.files.container import refuse
from frbcli.results.store import Run

PANELS = (("pin_angle", "rad", "angle of the ring in mrad", 1e3),
          ("pin_torque", "N_m", "torque of the pin in N mm", 1e3))  # fmt: skip


def pin_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Angle and torque of each ring with a pin, the runs overlaid, from from_time to to_time in s. Raises RunFileError
    if a run has no ring with a pin."""
    (first, unit, *_), *_ = PANELS
    names = [name.removeprefix(first).removesuffix(unit).strip("_") for name in runs[0].signals if first in name]
    for run in runs:
        if not names or any(joined(first, name, unit) not in run.signals for name in names):
            raise refuse(run.path, "has no ring with a pin.", "Draw a run of a case with [bearing.pin].")

    def panel(quantity: str, unit: str, words: str, factor: float, axes: Axes) -> None:
        curves = [
            (name, [ScaledSignal(run.signal(joined(quantity, name, unit)), factor) for run in runs]) for name in names
        ]
        draw_curves(axes, runs, curves, over, (from_time, to_time))
        axes.set_ylabel(words)

    return curves_figure(runs, [partial(panel, *each) for each in PANELS], over, 5.6)

