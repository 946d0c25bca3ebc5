"""Speed of floating rings over the rotor speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import joined, points
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case_text
from frbcli.equilibrium.ring_speed import concentric_ratios
from frbcli.errors import InputError
from frbcli.plot.curves import Over, curves_figure, draw_curves
from frbcli.plot.signals import case_tables, ends, extremes
from frbcli.plot.style import GREY
from frbcli.results.files.container import refuse
from frbcli.results.records import SPEED, Signal
from frbcli.results.store import Run

SLOWEST = 0.02  # share of the highest rotor speed below which the ratio is not drawn
ROOM = 1.15  # above the highest curve
PAPER = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
START = 0.05  # share of the run after which the highest value is sought: a rotor that falls drags its rings


def ring_speed_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """omega_F / omega_R of each ring, the runs overlaid, from from_time to to_time in s; dashed the ratio of concentric
    surfaces, where the torques of both films balance.

    Raises RunFileError if a run has no ring that turns.
    """
    for run in runs:
        ends(run)
        if not _turning(run):
            raise refuse(run.path, "has no ring that turns.", "Draw a run of a case with floating rings.")
    names = _turning(runs[0])
    curves = [(name, [_Ratio.of(run, name) for run in runs]) for name in names]
    concentric = _concentric(runs[0]) if len({run.case_text for run in runs}) == 1 else {}
    highest = max(
        extremes(ratio, int(START * len(run)), len(run))[1]
        for _, each in curves
        for run, ratio in zip(runs, each, strict=True)
    )

    def panel(axes: Axes) -> None:
        draw_curves(axes, runs, curves, over, (from_time, to_time))
        _draw_concentric(axes, concentric)
        axes.set_ylim(0.0, ROOM * max(highest, *concentric.values(), 1e-3))
        axes.set_ylabel("ring speed over rotor speed")

    return curves_figure(runs, [panel], over)


def _draw_concentric(axes: Axes, concentric: dict[str, float]) -> None:
    """A dashed line for each ratio of concentric surfaces, labelled with its ring where the ratios differ."""
    for value in sorted(set(concentric.values())):
        alike = [name for name, own in concentric.items() if own == value]
        ring = alike[0] if len(alike) < len(concentric) else ""
        axes.axhline(value, color=GREY, linestyle=(0, (5, 3)), linewidth=0.9)
        axes.annotate(
            " ".join(word for word in ("torque balance, concentric", ring) if word) + f": {value:.3f}",
            (1.0, value), (-4, 3), xycoords=axes.get_yaxis_transform(), textcoords="offset points",
            ha="right", va="bottom", color=GREY, bbox=PAPER,
        )  # fmt: skip


def _turning(run: Run) -> list[str]:
    return [name for name in points(run.signals, "ring") if joined("ring_speed", name, "Hz") in run.signals]


@dataclass(frozen=True)
class _Ratio:
    """Speed of a ring over the rotor speed, NaN where the rotor hardly turns: below `least` Hz."""

    ring: Signal
    rotor: Signal
    least: float

    @classmethod
    def of(cls, run: Run, name: str) -> _Ratio:
        rotor = run.signal(SPEED)
        fastest = max(map(abs, extremes(rotor, 0, len(run))))
        return cls(run.signal(joined("ring_speed", name, "Hz")), rotor, SLOWEST * fastest)

    def __getitem__(self, part: slice) -> Array:
        speed = np.abs(self.rotor[part])
        ratio: Array = np.full(len(speed), np.nan)
        return np.divide(self.ring[part], speed, out=ratio, where=speed > self.least)


def _concentric(run: Run) -> dict[str, float]:
    """The ring speeds of the run's case, none if this version of frb would not run it."""
    case_tables(run)
    try:
        return concentric_ratios(load_case_text(run.case_text))
    except InputError:
        return {}
