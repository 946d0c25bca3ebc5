"""Natural modes of a rotor: frequencies over its speed, and the shapes at the highest one."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.linear.modes import SHOWN, Mode, Modes
from frbcli.plot.style import BAND, BLACK, BLUE, GREY, ORANGE, VERMILION, new_figure, styled
from frbcli.units import display

LINES = {"forward": (BLUE, "-"), "backward": (ORANGE, (0, (5, 2)))}
HEADROOM = 1.25  # of the frequency axis over the rotor speed, at least up to the first bending mode


def modes_figure(modes: Modes) -> Figure:
    """Left the Campbell diagram of the undamped rotor, right its slowest forward shapes at the highest speed."""
    case = modes.case
    springs = ", ".join(display(spring, "N/m") for spring in dict.fromkeys(modes.stiffness_N_m))
    on = f"on bearings of {springs}" if springs else "free rotor"
    with styled():
        figure = new_figure(case.heading, f"natural modes, undamped, {on}", width=9.0, height=5.0)
        grid = figure.add_gridspec(SHOWN, 2, width_ratios=(1.3, 1.0))
        campbell = figure.add_subplot(grid[:, 0])
        _draw_campbell(campbell, modes)
        last = max(modes.points, key=lambda point: point.speed_Hz)
        shapes = [figure.add_subplot(grid[row, 1]) for row in range(SHOWN)]
        for axes, mode in zip(shapes, last.directed("forward"), strict=False):
            _draw_shape(axes, modes, mode)
        shapes[-1].set_xlabel(f"along the shaft in mm, at {last.speed_Hz:.4g} Hz")
        for axes in shapes[:-1]:
            axes.tick_params(labelbottom=False)
        figure.legend(*campbell.get_legend_handles_labels(), loc="outside lower left", ncols=3)
    return figure


def _draw_campbell(axes: Axes, modes: Modes) -> None:
    """Frequencies over the speed, with bands of what the reduction of the shaft changes."""
    error = 0.0 if modes.error is None else modes.error.frequency
    points = sorted(modes.points, key=lambda point: point.speed_Hz)
    fastest = points[-1].speed_Hz or 1.0
    for direction, (colour, dashes) in LINES.items():
        for number in range(max(len(point.directed(direction)) for point in points)):
            with_mode = [point for point in points if len(point.directed(direction)) > number]
            speeds = [point.speed_Hz for point in with_mode]
            frequencies = np.array([point.directed(direction)[number].frequency_Hz for point in with_mode])
            label = f"{direction} whirl" if number == 0 else None
            axes.plot(speeds, frequencies, color=colour, linestyle=dashes, linewidth=1.4, label=label)
            low, high = (1.0 - error) * frequencies, (1.0 + error) * frequencies
            axes.fill_between(speeds, low, high, color=colour, alpha=BAND, linewidth=0.0)
    axes.plot([0.0, fastest], [0.0, fastest], color=GREY, linestyle=(0, (1, 2)), label="rotor speed")
    axes.set_xlim(0.0, fastest)
    axes.set_ylim(0.0, HEADROOM * max(fastest, modes.free_Hz[0]))
    axes.set_xlabel("rotor speed in Hz")
    axes.set_ylabel("natural frequency in Hz")


def _draw_shape(axes: Axes, modes: Modes, mode: Mode) -> None:
    z = 1e3 * modes.positions_m
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(z, mode.shape, color=BLUE, linewidth=1.6)
    for places, marker, colour in ((modes.bearings, "^", VERMILION), (modes.disks, "|", BLACK)):
        for _, place in places:
            axes.plot(1e3 * place, 0.0, marker=marker, color=colour, markersize=7, linestyle="none")
    axes.set_title(f"{mode.frequency_Hz:.4g} Hz, {mode.kind}", fontsize=9.0)
    axes.set_ylim(-1.15, 1.15)
    axes.set_yticks([])
