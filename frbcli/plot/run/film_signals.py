"""Film signals that not every run records: forces, film thickness, power, torque, oil flow, tilt of the journals,
pressure of supplies that change."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import films
from frbcli.plot.curves import HEIGHT, Over, ScaledSignal, Span, curves_figure, draw_curves
from frbcli.results.files.container import refuse
from frbcli.results.store import Run
from frbcli.runs.record.header import (
    FILM_SIGNALS,
    FLOW,
    FORCE,
    FRICTION,
    POWER,
    SHARE,
    SUPPLY,
    THICKNESS,
    TILT,
    TORQUE,
    signal_names,
)

PANEL_HEIGHT = 2.4  # inches
# The name of an axis, and its unit in SI units.
AXES = {
    FORCE: ("force {} in N", 1.0),
    THICKNESS: ("film thickness in µm", 1e6),
    POWER: ("power in W", 1.0),
    TORQUE: ("torque on the journal in N mm", 1e3),
    FLOW: ("oil flow in cm³/s", 1e6),
    SHARE: ("share of the load on asperities", 1.0),
    FRICTION: ("friction power of the contact in W", 1.0),
    TILT: ("tilt about {} in mrad", 1e3),
    SUPPLY: ("pressure of the supply in bar", 1e-5),
}
REMEDIES = {
    TILT: "Run the case with --set film.tilt=follows.",
    SUPPLY: "Its supplies keep their pressure; give one a flow, or a pressure over time.",
}


def film_signal_figure(
    runs: Sequence[Run], kind: str, from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """One of FILM_SIGNALS of each film, the runs overlaid, from from_time to to_time in s; x and y of a force or a
    tilt have a panel each. Raises RunFileError if a run has not recorded it."""

    def panel(part: int, axes: Axes) -> None:
        draw_film_signal(axes, runs, kind, part, over, (from_time, to_time))

    panels = [partial(panel, part) for part in range(len(signal_names(kind, "")))]
    return curves_figure(runs, panels, over, max(HEIGHT, 0.8 + PANEL_HEIGHT * len(panels)))


def draw_film_signal(
    axes: Axes, runs: Sequence[Run], kind: str, part: int = 0, over: Over = "time", span: Span = (None, None)
) -> None:
    """The curves on axes of a figure; part: 0 and 1 are x and y of a force or a tilt. Raises as film_signal_figure."""
    known = list(films(runs[0].signals)) or [""]
    names = [name for name in known if any(signal_names(kind, name)[0] in run.signals for run in runs)]
    for run in runs:
        if not names or any(signal not in run.signals for name in names for signal in signal_names(kind, name)):
            remedy = REMEDIES.get(kind, f"Run the case with --set 'output.signals=[\"{kind}\"]'.")
            raise refuse(run.path, f"has not recorded {FILM_SIGNALS[kind][0].replace('_', ' ')}.", remedy)
    words, factor = AXES[kind]
    curves = [
        (name.replace("_", " "), [ScaledSignal(run.signal(signal_names(kind, name)[part]), factor) for run in runs])
        for name in names
    ]
    draw_curves(axes, runs, curves, over, span)
    axes.set_ylabel(words.format("xy"[part]))
    if kind == THICKNESS:
        axes.set_ylim(bottom=0.0)
