"""Damped mode shapes in three dimensions: the shaft at one moment, and the orbits of places along it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from frbcli.linear.damped_modes import BACKWARD, FORWARD, DampedMode, DampedModes
from frbcli.plot.style import BLUE, GREEN, GREY, ORANGE, VERMILION, new_figure, styled
from frbcli.rotor.order import first_largest

COLUMNS, ROWS = 3, 2
ORBITS = 9  # of places along a shaft
TURN = 73  # points of an orbit
COLOUR = {FORWARD: BLUE, BACKWARD: ORANGE}


def shapes_figure(found: DampedModes) -> Figure:
    """The least damped modes, each as the shaft at the moment of its largest deflection within the orbits of its
    places; a dot begins an orbit, which is drawn for five sixths of a turn in the sense of the whirl."""
    case, shown = found.case, found.modes[: COLUMNS * ROWS]
    columns = min(COLUMNS, len(shown))
    rows = math.ceil(len(shown) / COLUMNS) or 1
    with styled():
        words = f"damped modes about the resting position at {found.speed_Hz:.4g} Hz"
        figure = new_figure(case.heading, words, width=3.3 * max(columns, 2), height=0.5 + 3.0 * rows)
        for number, mode in enumerate(shown):
            axes: Any = figure.add_subplot(rows, max(columns, 1), number + 1, projection="3d")
            draw_shape(axes, found, mode)
    return figure


def draw_shape(axes: Any, found: DampedModes, mode: DampedMode) -> None:
    """One mode on axes with projection="3d": z along the shaft to the right, y up."""
    z = found.positions * (1e3 if found.to_scale else 1.0)
    colour = COLOUR.get(mode.direction, GREEN)
    moment = np.exp(-1j * np.angle(_largest(mode)))
    still = (mode.shape * moment).real
    axes.plot(z, np.zeros_like(z), np.zeros_like(z), color=GREY, linewidth=0.8)
    axes.plot(z, still[:, 0], still[:, 1], color=colour, linewidth=1.8)
    turn = np.exp(2j * np.pi * np.linspace(0.0, 5.0 / 6.0, TURN))
    places = np.unique(np.linspace(0, len(z) - 1, ORBITS).round().astype(int))
    marked = [int(np.argmin(np.abs(found.positions - at))) for _, at in found.marks]
    for place in sorted({*places.tolist(), *marked}):
        orbit = (turn[:, None] * mode.shape[place] * moment).real
        thick = 1.3 if place in marked else 0.6
        axes.plot(np.full(TURN, z[place]), orbit[:, 0], orbit[:, 1], color=colour, linewidth=thick, alpha=0.8)
        axes.plot([z[place]], orbit[:1, 0], orbit[:1, 1], color=colour, marker=".", markersize=4.0)
    for name, at in found.marks:
        axes.text(at * (1e3 if found.to_scale else 1.0), 0.0, -1.25, name, fontsize=6.0, ha="center", color=GREY)
    axes.set_xlabel("along the shaft in mm" if found.to_scale else "along the shaft", fontsize=7.0, labelpad=-2.0)
    axes.set_ylabel("x", fontsize=7.0, labelpad=-10.0)
    axes.set_zlabel("y", fontsize=7.0, labelpad=-10.0)
    axes.set_ylim(1.1, -1.1)  # looking along the shaft, x points to the right
    axes.set_zlim(-1.1, 1.1)
    axes.set_yticklabels([])
    axes.set_zticklabels([])
    axes.tick_params(labelsize=6.0, pad=-2.0)
    axes.set_box_aspect((2.2, 1.0, 1.0), zoom=1.15)
    axes.view_init(elev=18.0, azim=-62.0)
    growth = mode.eigenvalue.real
    told = f"grows with {growth:.3g} 1/s" if growth > 0.0 else f"damping ratio {mode.damping_ratio:.3g}"
    axes.set_title(f"{mode.frequency_Hz:.4g} Hz, {mode.direction}\n{told}", fontsize=8.5,
                   color=VERMILION if growth > 0.0 else "black")  # fmt: skip


def _largest(mode: DampedMode) -> complex:
    """Amplitude of x or y where it is largest."""
    return complex(mode.shape.ravel()[first_largest(mode.shape.ravel())])
