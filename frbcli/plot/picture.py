"""A picture, its size, limits and unit of speeds.

The picture of any result, which its command writes and a notebook shows.

A finished picture in another size, with other limits, or with its rotor speeds per minute.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from frbcli.errors import input_error
from frbcli.plot.style import Picture, new_figure, styled, wrap_title

PICTURES = {  # class of a result: module in this room, and its function
    "AccuracyLadder": "studies:accuracy_figure",
    "AgainstMeasured": "studies:against_figure",
    "BallSheet": "machine.bearing:ball_figure",
    "BearingSheet": "machine.bearing:bearing_figure",
    "Comparison": "studies:comparison_figure",
    "CriticalMap": "machine.response:critical_map_figure",
    "DampedModes": "machine.modes:shapes_figure",
    "Fit": "studies:fit_figure",
    "KinematicTest": "machine.film:kinematic_figure",
    "LimitCycles": "machine.limit_cycles:limit_cycles_figure",
    "Modes": "machine.modes:modes_figure",
    "Response": "machine.response:response_figure",
    "Run": "summary:summary_figure",
    "Stability": "machine.modes:campbell_figure",
    "StabilityMap": "machine.limit_cycles:stability_map_figure",
    "Sweep": "studies:sweep_figure",
    "ThrustSheet": "machine.bearing:thrust_figure",
}
OVERLAYS = {  # of several results over each other
    "BearingSheet": "axes:bearing",
    "Response": "axes:response",
    "Run": "axes:eccentricity",
    "Stability": "axes:campbell",
}


def picture(result: object) -> Picture:
    """The picture of a result, as its command draws it.

    Parameters
    ----------
    result : object, or list of objects
        A run, or what a function of `frbcli` returned: `stability`, `response`, `bearing_sheet`, `ball_bearing_sheet`,
        `critical_map`, `natural_modes`, `damped_modes`, `limit_cycles`, `stability_map`, `rotation`, `squeeze`,
        `whirl`, `compare`, `against_measured`, `accuracy`, `fit`, `sweep`. Several runs, or several results of
        `stability`, `response` or `bearing_sheet`, are drawn over each other.

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it where a cell ends with it; `figure.savefig("a.png")` writes it.

    Raises
    ------
    InputError
        If there is no picture of it.

    Examples
    --------
    >>> import frbcli
    >>> analysis = frbcli.stability(frbcli.load_case("jeffcott", ["film.theory=short"]))
    >>> figure = frbcli.picture(analysis)
    >>> len(figure.axes)
    2
    """
    if not isinstance(result, list | tuple):
        figure: Picture = _drawn_by(result, PICTURES)(result)
        return figure
    draw = _drawn_by(result[0], OVERLAYS) if result else None
    if draw is None or len({type(each) for each in result}) > 1:
        raise input_error("picture", "result", "", "are not results of one kind.", "Draw them one by one.")
    return overlaid(draw, result)


def overlaid(draw: Callable[..., Axes], results: Sequence[Any]) -> Picture:
    """Results over each other, by a function that draws one on axes; they are named by their cases, or numbered."""
    cases = [getattr(each, "case_name", "") or each.case.name for each in results]
    names = cases if len(set(cases)) == len(cases) else [f"{name} {n}" for n, name in enumerate(cases, start=1)]
    with styled():
        figure = new_figure("Comparison", ", ".join(dict.fromkeys(cases)))
        axes = figure.subplots()
        for each, name in zip(results, names, strict=True):
            draw(each, ax=axes, label=name)
    return figure


def _drawn_by(result: object, table: dict[str, str]) -> Any:
    """The function of a table that draws a result. Raises InputError if there is none."""
    kinds = (kind.__name__ for kind in type(result).__mro__ if kind.__module__.startswith("frbcli."))
    place = next((table[kind] for kind in kinds if kind in table), None)
    if place is None:
        problem, remedy = "has no picture.", f"There are pictures of: {', '.join(table)}."
        raise input_error("picture", type(result).__name__, "", problem, remedy)
    module, _, name = place.partition(":")
    return getattr(import_module(f"frbcli.plot.{module}"), name)


SECONDS = 60.0  # of a minute
SPEED, PER_MINUTE = "speed in Hz", "speed in rpm"
COLOURS = "<colorbar>"  # how matplotlib labels the axes of a scale of colours
ALONG = ("time in", "speed in", "frequency in", "eccentricity")  # begin or end the names of axes that limits are for

Span = tuple[float, float]


class _PerMinute(MaxNLocator):
    """Round numbers of revolutions per minute on an axis in Hz."""

    def tick_values(self, vmin: float, vmax: float) -> Any:
        return np.asarray(super().tick_values(SECONDS * vmin, SECONDS * vmax)) / SECONDS


def fit(
    figure: Figure,
    size_in: Span | None = None,
    x_limits: Span | None = None,
    y_limits: Span | None = None,
    rpm: bool = False,
) -> Figure:
    """Change a figure, and return it. size_in: inches; limits in the units of the axes: x_limits of all that share the
    axis of the first panel that has one along the run, y_limits of all that are named as the first panel; rpm: axes of
    rotor speeds in Hz are shown in revolutions per minute."""
    panels = [axes for axes in figure.axes if axes.get_label() != COLOURS]
    if rpm:
        for axes in panels:
            for axis in (axes.xaxis, axes.yaxis, *(child.xaxis for child in axes.child_axes)):
                _per_minute(axis)
    if x_limits is not None:
        for axes in _along(panels):
            axes.set_xlim(*_in_hertz(axes.xaxis, x_limits))
    if y_limits is not None:
        first = panels[0].get_ylabel()
        for axes in panels:
            if axes.get_ylabel() == first:
                axes.set_ylim(*_in_hertz(axes.yaxis, y_limits))
    if size_in is not None:
        figure.set_size_inches(*size_in)
        wrap_title(figure)
    return figure


def _along(panels: list[Axes]) -> Iterable[Axes]:
    """Panels over time, speed or frequency; if there are none, all with the label of the first panel."""
    named = [axes for axes in panels if any(word in axes.get_xlabel() for word in ALONG)]
    return named or [axes for axes in panels if axes.get_xlabel() == panels[0].get_xlabel()]


def _per_minute(axis: Axis) -> None:
    name = axis.get_label_text()
    if SPEED in name and axis.get_scale() != "log":
        axis.set_label_text(name.replace(SPEED, PER_MINUTE))
        axis.set_major_locator(_PerMinute(7, steps=[1, 2, 2.5, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{SECONDS * value:.6g}"))


def _in_hertz(axis: Axis, limits: Span) -> Span:
    per_minute = PER_MINUTE in axis.get_label_text()
    return (limits[0] / SECONDS, limits[1] / SECONDS) if per_minute else limits
