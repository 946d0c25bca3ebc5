"""The sheet of a bearing over rotor speed or eccentricity: position, coefficients, loss and flow, pressure; of ball
bearings: stiffness and largest pressures over speed or load; of a thrust bearing: load, loss and stiffness over the
gap, and the pressure on the pads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from frbcli.elements.collar import pad_of
from frbcli.film.pad_geometry import MESH
from frbcli.film.pads import pad_mesh
from frbcli.linear.sheets.ball import BallSheet
from frbcli.linear.sheets.bearing import ECCENTRICITY, BearingSheet
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.sheets.thrust import ThrustSheet, ThrustState
from frbcli.plot.style import COLOURS, LEVEL_MAP, legend_above, legend_below, new_figure, plain_numbers, styled

Reading = Callable[[FilmState], float]
DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (5, 1, 1, 1)))  # of the films of a machine
MARKERS = ("o", "s", "^", "D")  # likewise, of a sheet of one point, through which no line goes
ZERO_CELSIUS = 273.15
AXES = ("xx", "xy", "yx", "yy")
UNLIKE = 30.0  # ratio of the largest coefficients of two films from which on no even scale shows both
PRESSURES = (("inner ring", "inner_p_max"), ("outer ring", "outer_p_max"))


def bearing_figure(sheet: BearingSheet) -> Figure:
    """Eight panels over the rotor speed, or over the eccentricity, two more with heat, and two between rough surfaces,
    one of which is the Stribeck curve; films by their dashes, quantities by their colours."""
    case, chart = sheet.case, sheet.over == ECCENTRICITY
    models = ", ".join(dict.fromkeys(sheet.labels))
    with styled():
        rows = 4 + (case.heat is not None) + case.contact.rough
        figure = new_figure(case.heading, f"bearing sheet, {models}", width=9.6, height=1.4 + 2.0 * rows)
        panels = figure.subplots(rows, 2, sharex=True)
        first: Reading = (lambda s: s.sommerfeld_number) if chart else (lambda s: s.eccentricity)
        _curves(panels[0, 0], sheet, "Sommerfeld number" if chart else "eccentricity", [("", first)])
        _curves(panels[0, 1], sheet, "attitude angle in °", [("", lambda s: s.attitude_deg)])
        draw_coefficient(panels[1, 0], sheet, "stiffness")
        draw_coefficient(panels[1, 1], sheet, "damping")
        _curves(panels[2, 0], sheet, "power loss in W", [("", lambda s: s.power)])
        _curves(panels[2, 1], sheet, "side flow in l/min", [("", lambda s: 6e4 * s.side_flow)])
        _curves(panels[3, 0], sheet, "smallest film in µm", [("", lambda s: 1e6 * s.film_thickness_min)])
        _curves(panels[3, 1], sheet, "largest pressure in bar", [("", lambda s: 1e-5 * s.p_max)])
        if case.heat is not None:
            _curves(panels[4, 0], sheet, "film temperature in °C", [("", lambda s: s.temperature - ZERO_CELSIUS)])
            _curves(panels[4, 1], sheet, "viscosity in mPa s", [("", lambda s: 1e3 * s.viscosity)])
        if case.contact.rough:
            _draw_friction(panels[-1], sheet)
        for panel in panels[-1]:
            panel.set_xlabel("eccentricity" if chart else "rotor speed in Hz")
        for panel in panels[2:4].ravel():
            panel.set_yscale("log")
            plain_numbers(panel.yaxis)
        if chart:
            panels[0, 0].set_yscale("log")
            plain_numbers(panels[0, 0].yaxis)
            for panel in panels[1]:
                panel.set_yscale("symlog")
        if len(sheet.films) > 1:
            handles = [panels[0, 0].plot([], [], color="black", **style)[0] for style in _styles(sheet)]
            names = [film.replace("_", " ") for film in sheet.films]
            figure.legend(handles, names, loc="outside lower center", ncols=len(handles))
    return figure


def _draw_friction(panels: Sequence[Axes], sheet: BearingSheet) -> None:
    """Stribeck curve and share of the asperities on two axes of a figure; speeds from boundary friction on are many
    times apart."""
    _curves(panels[0], sheet, "coefficient of friction", [("", lambda s: s.friction_coefficient)])
    _curves(panels[1], sheet, "share of asperities in the load", [("", _asperity_share)])
    panels[0].set_yscale("log")
    plain_numbers(panels[0].yaxis)
    if sheet.over != ECCENTRICITY:
        panels[0].set_xscale("log")  # of all panels, which share it
        plain_numbers(panels[0].xaxis)


def _asperity_share(state: FilmState) -> float:
    return math.nan if state.mixed is None else state.mixed.share


def draw_coefficient(axes: Axes, sheet: BearingSheet, quantity: str) -> None:
    """The four entries of "stiffness" or "damping" on axes of a figure."""
    unit, scale, letter = {"stiffness": ("N/µm", 1e-6, "k"), "damping": ("N s/mm", 1e-3, "c")}[quantity]
    entries = [(f"{letter}{name}", _entry(quantity, i, scale)) for i, name in enumerate(AXES)]
    _curves(axes, sheet, f"{quantity} in {unit}", entries)
    largest = [[float(np.abs(getattr(state, quantity)).max()) for state in sheet.of(film)] for film in sheet.films]
    sizes = [max(each) for each in largest if any(each)]
    if sizes and max(sizes) > UNLIKE * min(sizes):
        axes.set_yscale("symlog", linthresh=scale * min(sizes))


def _styles(sheet: BearingSheet) -> list[dict[str, Any]]:
    """How the curve of each film is drawn, but for its colour."""
    alone = all(len(sheet.of(film)) == 1 for film in sheet.films)
    return [
        {"linestyle": DASHES[number % len(DASHES)]} | ({"marker": MARKERS[number % len(MARKERS)]} if alone else {})
        for number in range(len(sheet.films))
    ]


def _curves(axes: Axes, sheet: BearingSheet, label: str, readings: list[tuple[str, Reading]]) -> None:
    """Readings over the abscissa of the sheet, without those that are not known of any state."""
    points = [state for film in sheet.films for state in sheet.of(film)]
    readings = [each for each in readings if not points or not all(math.isnan(each[1](state)) for state in points)]
    for number, (film, style) in enumerate(zip(sheet.films, _styles(sheet), strict=True)):
        states = sheet.of(film)
        x = [state.eccentricity if sheet.over == ECCENTRICITY else state.speed_Hz for state in states]
        for colour, (name, reading) in zip(COLOURS, readings, strict=False):
            shown = name if number == 0 and name else None
            axes.plot(x, [reading(state) for state in states], color=colour, label=shown, **style)
    axes.set_ylabel(readings[0][0] or label if len(readings) == 1 else label)
    if len(readings) > 1:
        legend_above(axes)


def _entry(name: str, index: int, scale: float) -> Reading:
    def read(state: FilmState) -> float:
        return scale * float(np.ravel(getattr(state, name))[index])

    return read


def ball_figure(sheet: BallSheet) -> Figure:
    """Stiffness and Hertz pressure of the first bearing over the number of which the sheet has several values."""
    states = [state for state in sheet.of(sheet.bearings[0]) if state.stiffness is not None]
    over_load = len({state.speed_Hz for state in states}) == 1 < len(states)
    along = [math.hypot(*state.load) if over_load else state.speed_Hz for state in states]
    name = " ".join(filter(None, ("ball bearing", sheet.bearings[0])))
    with styled():
        figure = new_figure(sheet.case.heading, name, width=9.6, height=4.6)
        stiffness, pressure = figure.subplots(1, 2)
        radial = np.array([state.stiffness for state in states]).reshape(-1, 2, 2)
        axial = np.array([state.axial_stiffness for state in states])
        curves = {"xx": radial[:, 0, 0], "yy": radial[:, 1, 1], "axial": axial}
        for number, (label, values) in enumerate(curves.items()):
            stiffness.plot(along, 1e-6 * values, color=COLOURS[number], marker=".", label=label)
        for number, (label, quantity) in enumerate(PRESSURES):
            pressures = [1e-6 * getattr(state, quantity) for state in states]
            pressure.plot(along, pressures, color=COLOURS[number], marker=".", label=label)
        for panel, label in ((stiffness, "stiffness in N/µm"), (pressure, "largest pressure in MPa")):
            panel.set(xlabel="load in N" if over_load else "rotor speed in Hz", ylabel=label, ylim=(0.0, None))
            panel.legend(loc="lower right" if panel is pressure else "best")
    return figure


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
