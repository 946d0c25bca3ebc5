"""Temperatures, viscosities and losses of a run with heat, over time or rotor speed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.columns import ZERO_CELSIUS
from frbcli.plot.curves import Over, ScaledSignal, curves_figure, draw_curves
from frbcli.plot.style import draw_bands
from frbcli.results.files.container import refuse
from frbcli.results.store import Run

PANELS = (
    ("temperature", "_K", "temperature in degC", 1.0, -ZERO_CELSIUS),
    ("viscosity", "_Pa_s", "viscosity in mPa s", 1e3, 0.0),
    ("power", "_W", "loss in W", 1.0, 0.0),
    ("flow", "_m3_s", "side flow in ml/s", 1e6, 0.0),
)

UNCERTAINTIES = {"temperature": "temperature_uncertainty_K", "power": "power_uncertainty_W"}  # of the error of a run


def heat_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Temperatures of films, rings and walls, viscosities, losses and flows of the films, the runs overlaid, from
    from_time to to_time in s; of one run with bands of their uncertainties.

    Raises RunFileError if a run has no heat."""
    for run in runs:
        if not _told(run, *PANELS[0][:2]) or set(_told(run, *PANELS[0][:2])) != set(_told(runs[0], *PANELS[0][:2])):
            raise refuse(run.path, "has no such heat.", "Draw a run of a case with [thermal].")

    def panel(quantity: str, end: str, words: str, factor: float, offset: float, axes: Axes) -> None:
        curves = [
            (name[len(quantity) + 1 : -len(end)].replace("_", " ") or "film",
             [ScaledSignal(run.signal(name), factor, offset) for run in runs])
            for name in _told(runs[0], quantity, end)
        ]  # fmt: skip
        draw_curves(axes, runs, curves, over, (from_time, to_time))
        if len(runs) == 1:  # several are distinguished by their lines
            _part(axes)
            draw_bands(axes, runs[0].error.get(UNCERTAINTIES.get(quantity, "")))
        axes.set_ylabel(words)

    return curves_figure(runs, [partial(panel, *told) for told in PANELS], over, 9.0)


def _part(axes: Axes) -> None:
    """Rings dashed and walls dotted, films in full lines: there are more of them than colours."""
    for line in axes.lines:
        words = str(line.get_label()).split()
        line.set_linestyle("--" if "ring" in words else ":" if {"shaft", "housing"} & set(words) else "-")


def _told(run: Run, quantity: str, end: str) -> list[str]:
    return [name for name in run.signals if name.startswith(quantity) and name.endswith(end)]
