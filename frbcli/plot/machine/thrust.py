"""The sheet of a thrust bearing: load, loss and stiffness over the gap, and the pressure on the pads."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from frbcli.elements.collar import pad_of
from frbcli.film.pad_geometry import MESH
from frbcli.film.pads import pad_mesh
from frbcli.linear.sheets.thrust import ThrustSheet, ThrustState
from frbcli.plot.style import COLOURS, LEVEL_MAP, legend_below, new_figure, plain_numbers, styled

LEVELS = 12
PANELS = (("load in N", "load"), ("power loss in W", "power"))

Curves = list[tuple[str, list[ThrustState]]]  # the name of each, and its states


def thrust_figure(sheet: ThrustSheet) -> Figure:
    """The pressure where the gap is least; and load and loss over the gap, a curve for each bearing and speed, or over
    the speed, where each speed has one gap."""
    name, of = "gap in µm", _over_gap
    if not any(len(states) > 1 for _, states in _over_gap(sheet)):
        name, of = "speed in Hz", _over_speed
    curves = of(sheet) if len(sheet.points) > len(sheet.bearings) else []
    with styled():
        figure = new_figure(sheet.case.heading, _subtitle(sheet), width=9.6 if curves else 5.6, height=4.6)
        *panels, pads = _panels(figure, bool(curves))
        for panel, (label, quantity) in zip(panels, PANELS, strict=False):
            for number, (curve, states) in enumerate(curves):
                along = [state.speed_Hz if of is _over_speed else 1e6 * state.gap for state in states]
                values = [getattr(state, quantity) for state in states]
                panel.plot(along, values, color=COLOURS[number % len(COLOURS)], marker=".", label=curve)
            panel.set(xlabel=name, ylabel=label, yscale="log")
            plain_numbers(panel.yaxis)
        if curves:
            legend_below(figure, panels[0])
        _pads(figure, pads, sheet, min(sheet.points, key=lambda point: (point.gap, -point.p_max)))
    return figure


def _subtitle(sheet: ThrustSheet) -> str:
    """With the gap, if all states have the same, and the load of a single one."""
    words, gaps = ["thrust bearing"], {state.gap for state in sheet.points}
    words += [f"gap {1e6 * gap:.3g} µm" for gap in gaps if len(gaps) == 1 < len(sheet.points)]
    words += [f"load {state.load:.4g} N" for state in sheet.points if len(sheet.points) == 1]
    return ", ".join(words)


def _panels(figure: Figure, curves: bool) -> list[Axes]:
    """Two for curves, if there are any, and one for the pads."""
    if not curves:
        return [figure.subplots()]
    return list(figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.2)))


def _over_gap(sheet: ThrustSheet) -> Curves:
    """Each bearing and speed."""
    return [
        (
            " ".join(filter(None, (name, f"{speed:g} Hz"))),
            sorted((state for state in sheet.of(name) if state.speed_Hz == speed), key=lambda state: state.gap),
        )
        for name in sheet.bearings
        for speed in dict.fromkeys(state.speed_Hz for state in sheet.of(name))
    ]


def _over_speed(sheet: ThrustSheet) -> Curves:
    """Each bearing."""
    return [(name, sorted(sheet.of(name), key=lambda state: state.speed_Hz)) for name in sheet.bearings]


def _pads(figure: Figure, axes: Axes, sheet: ThrustSheet, state: ThrustState) -> None:
    bearing = next(each for each in sheet.case.thrust_bearings if each.name == state.bearing)
    mesh = pad_mesh(pad_of(bearing), *MESH)
    low, high = 1e-5 * state.pressure.min(), 1e-5 * state.pressure.max()
    levels = MaxNLocator(LEVELS).tick_values(low, high)
    filled = None
    for phase in 2.0 * np.pi * np.arange(bearing.pads) / bearing.pads:
        angle, radius = mesh.nodes[0] + phase, 1e3 * mesh.nodes[1]
        plane = Triangulation(radius * np.cos(angle), radius * np.sin(angle), mesh.triangles)
        filled = axes.tricontourf(plane, 1e-5 * state.pressure, levels=levels, cmap=LEVEL_MAP)
    axes.set(aspect="equal", xlabel="mm", ylabel="mm", title=f"gap {1e6 * state.gap:.3g} µm, {state.speed_Hz:.4g} Hz")
    axes.grid(visible=False)
    if filled is not None:
        figure.colorbar(filled, ax=axes, label="pressure in bar", shrink=0.8)
