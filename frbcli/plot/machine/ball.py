"""The sheet of ball bearings: stiffness and largest pressures over speed, or over the load."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from frbcli.linear.sheets.ball import BallSheet, BallState
from frbcli.plot.style import COLOURS, new_figure, styled

PRESSURES = (("inner ring", "inner_p_max"), ("outer ring", "outer_p_max"))


def ball_figure(sheet: BallSheet) -> Figure:
    """Stiffness and Hertz pressure of the first bearing over the number of which the sheet has several values."""
    states = [state for state in sheet.of(sheet.bearings[0]) if state.stiffness is not None]
    over_load = len({state.speed_Hz for state in states}) == 1 < len(states)
    along = [_load(state) if over_load else state.speed_Hz for state in states]
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


def _load(state: BallState) -> float:
    return math.hypot(*state.load)
