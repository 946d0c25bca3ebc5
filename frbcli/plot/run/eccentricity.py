"""Eccentricity over time or rotor speed, of one run or of several."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import films, joined
from frbcli.plot.curves import HEIGHT, Over, Span, curves_figure, draw_curves
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
    told = [_without_side(name) if len(names) < len(list(films(runs[0].signals))) else name for name in names]
    curves = [
        (label.replace("_", " "), [run.signal(joined("eccentricity", name)) for run in runs])
        for label, name in zip(told, names, strict=True)
    ]
    draw_curves(axes, runs, curves, over, span)
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("eccentricity")


def _groups(run: Run) -> list[tuple[str, list[str]]]:
    """The films of a panel: those inside of rings, those outside of them, those without."""
    found = list(films(run.signals)) or [""]
    groups = [(side, [name for name in found if name.split("_")[-1] == side]) for side in SIDES]
    groups.append(("", [name for name in found if name.split("_")[-1] not in SIDES]))
    return [(side, names) for side, names in groups if names]


def _without_side(name: str) -> str:
    return "_".join(word for word in name.split("_") if word not in SIDES)
