"""Oil fraction of the films, over time or rotor speed."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.film.cavitation.table import laws, names
from frbcli.plot.curves import Over, curves_figure, draw_curves
from frbcli.results.files.container import refuse
from frbcli.results.store import Run

SIGNAL = "oil_fraction"
ROOM = 0.02  # above a full film


def oil_content_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Oil fraction of each film, averaged over the gap, the runs overlaid, from from_time to to_time in s.

    Raises RunFileError if a run has none: its cavitation model does not conserve oil.
    """
    told = [name for name in runs[0].signals if name.startswith(SIGNAL)]
    for run in runs:
        if not told or any(name not in run.signals for name in told):
            keeping = ", ".join(names(law for law in laws() if law.keeps_oil))
            remedy = f"Run the case with a mass-conserving model: {keeping}."
            raise refuse(run.path, "has no oil fraction.", remedy)
    curves = [(name[len(SIGNAL) + 1 :].replace("_", " "), [run.signal(name) for run in runs]) for name in told]

    def panel(axes: Axes) -> None:
        draw_curves(axes, runs, curves, over, (from_time, to_time))
        axes.set_ylim(top=1.0 + ROOM)
        axes.set_ylabel("oil fraction")

    return curves_figure(runs, [panel], over)
