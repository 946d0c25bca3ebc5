"""The sheet of a thrust bearing: load, loss and stiffness over the gap, and the pressure on the pads."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from frbcli.film.pads.geometry import MESH
from frbcli.film.pads.mesh import pad_mesh
from frbcli.linear.thrust.sheet import ThrustSheet
from frbcli.linear.thrust.state import ThrustState, pad_of
from frbcli.plot.style import COLOURS, LEVEL_MAP, legend_below, new_figure, styled

LEVELS = 12
PANELS = (("load in N", "load"), ("power loss in W", "power"))


def thrust_figure(sheet: ThrustSheet) -> Figure:
    """Load and loss over the gap, a curve for each bearing and speed, and the pressure where the gap is least."""
    with styled():
        figure = new_figure(sheet.case.heading, "thrust bearing", width=9.6, height=4.6)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.2))
        for panel, (label, quantity) in zip((left, middle), PANELS, strict=True):
            _curves(panel, sheet, quantity)
            panel.set(xlabel="gap in µm", ylabel=label, yscale="log")
        legend_below(figure, left)
        _pads(figure, right, sheet, min(sheet.points, key=lambda point: point.gap))
    return figure


def _curves(axes: Axes, sheet: ThrustSheet, quantity: str) -> None:
    curves = [
        (" ".join(filter(None, (name, f"{speed:g} Hz"))), [s for s in sheet.of(name) if s.speed_Hz == speed])
        for name in sheet.bearings
        for speed in dict.fromkeys(state.speed_Hz for state in sheet.of(name))
    ]
    for number, (label, states) in enumerate(curves):
        states = sorted(states, key=lambda state: state.gap)
        gaps, values = [1e6 * state.gap for state in states], [getattr(state, quantity) for state in states]
        axes.plot(gaps, values, color=COLOURS[number % len(COLOURS)], marker=".", label=label)


def _pads(figure: Figure, axes: Axes, sheet: ThrustSheet, state: ThrustState) -> None:
    bearing = next(each for each in sheet.case.thrust_bearings if each.name == state.bearing)
    mesh = pad_mesh(pad_of(bearing), *MESH)
    low, high = 1e-5 * state.pressure.min(), 1e-5 * state.pressure.max()
    room = 1e-6 * max(high - low, high)  # so that round-off at the edges stays within the levels
    levels = np.linspace(low - room, high + room, LEVELS)
    filled = None
    for phase in 2.0 * np.pi * np.arange(bearing.pads) / bearing.pads:
        angle, radius = mesh.nodes[0] + phase, 1e3 * mesh.nodes[1]
        plane = Triangulation(radius * np.cos(angle), radius * np.sin(angle), mesh.triangles)
        filled = axes.tricontourf(plane, 1e-5 * state.pressure, levels=levels, cmap=LEVEL_MAP)
    axes.set(aspect="equal", xlabel="mm", ylabel="mm", title=f"gap {1e6 * state.gap:.3g} µm, {state.speed_Hz:.4g} Hz")
    axes.grid(visible=False)
    if filled is not None:
        figure.colorbar(filled, ax=axes, label="pressure in bar", shrink=0.8, format="%.3g")
