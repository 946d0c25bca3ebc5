"""The Campbell diagram: eigenfrequencies over rotor speed, growing motions marked, and their growth. Natural modes of a
rotor: frequencies over its speed, and the shapes at the highest one; damped modes in three dimensions: the shaft at one
moment, and the orbits of places along it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.linear.critical_speeds import BACKWARD, FORWARD
from frbcli.linear.damped_modes import DampedMode, DampedModes
from frbcli.linear.modes import SHOWN, Mode, Modes
from frbcli.linear.stability import Stability
from frbcli.linear.stability_point import StabilityPoint, Threshold
from frbcli.plot.style import BAND, BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION, new_figure, styled
from frbcli.rotor.loads import first_largest
from frbcli.units import SpeedUnit, display

ABOVE_LOWEST = 1.2  # the frequency axis ends with the rotor speed, but not below the slowest mode
DOT, SMALL_DOT = 15.0, 6.0  # pt^2
BESIDE_ONE, BESIDE_LAST = 1.1, 1.01  # times the last speed: the edge would cut its points
GROWTH_FLOOR = 1.0  # 1/s, smallest half height of the growth panel, above round-off
LINES = {"forward": (BLUE, "-"), "backward": (ORANGE, (0, (5, 2)))}
HEADROOM = 1.25  # of the frequency axis over the rotor speed, at least up to the first bending mode

COLUMNS, ROWS = 3, 2
ORBITS = 9  # of places along a shaft
TURN = 73  # points of an orbit
LETTER = 0.03  # of the shaft, of the names of places
LOWEST, ROW = -1.25, 0.32  # of these, in amplitudes
COLOUR = {FORWARD: BLUE, BACKWARD: ORANGE}


def campbell_figure(stability: Stability) -> Figure:
    """Damped eigenfrequencies of all oscillating motions over the swept speeds, and the growth of the critical one.

    Motions that grow are filled dots in both panels, at zero frequency where they do not oscillate. Motions that decay
    without oscillating have no frequency and are left out, those faster than the frequency axis as well. Bars and bands
    are the expected errors by the mesh of the films.
    """
    points = [point for point in stability.sweep if point.rests]
    case = stability.case
    with styled():
        figure = new_figure(case.heading, "eigenvalues about the static equilibrium", height=5.8)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
        draw_frequencies(above, points)
        _draw_growth(below, stability.sweep)
        if stability.threshold is not None:
            _mark_threshold((above, below), stability.threshold, stability.case.speed_unit)
        figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def draw_frequencies(axes: Axes, points: list[StabilityPoint]) -> None:
    """Damped eigenfrequencies of the points with films, with bars of their expected errors."""
    rows = [(point.speed_Hz, *mode) for point in points for mode in point.modes_with_errors]
    speeds, errors = (np.array([row[column] for row in rows], dtype=float) for column in (0, 2))
    values = np.array([value for _, value, _ in rows], dtype=complex)
    frequencies, grows = values.imag / (2 * np.pi), values.real > 0.0
    fastest = max((point.speed_Hz for point in points), default=1.0)
    critical = [point.critical.imag / (2 * np.pi) for point in points if len(point.oscillating)]
    top = max(fastest, ABOVE_LOWEST * max([*critical, *frequencies[grows]], default=0.0))
    ends = np.array([0.0, fastest])
    for label, order, dashes in (("1X", 1.0, (0, (5, 3))), ("0.5X", 0.5, (0, (1, 2)))):
        axes.plot(ends, order * ends, color=GREY, linestyle=dashes, linewidth=1.1, label=label, zorder=1.5)
    axes.scatter(
        speeds[~grows], frequencies[~grows], DOT, facecolors="white", edgecolors=BLUE, linewidths=0.9, zorder=2.0,
        label="decays" if (values.real[~grows] < 0.0).all() else "does not grow",
    )  # fmt: skip
    axes.scatter(speeds[grows], frequencies[grows], DOT, color=VERMILION, label="grows", zorder=3)
    for which, colour in ((~grows, BLUE), (grows, VERMILION)):
        some = which & (errors > 0.0)  # NaN where they are not known
        axes.errorbar(speeds[some], frequencies[some], errors[some] / (2 * np.pi), linestyle="", ecolor=colour,
                      elinewidth=0.8, capsize=1.5, zorder=1.8)  # fmt: skip
    axes.set(xlim=(0.0, fastest * (BESIDE_LAST if len(points) > 1 else BESIDE_ONE)), ylim=(0.0, top))
    axes.set_ylabel("damped frequency in Hz")


def _draw_growth(axes: Axes, points: Sequence[StabilityPoint]) -> None:
    """Growth of the critical motion, with a gap at speeds without a static equilibrium."""
    speeds = np.array([point.speed_Hz for point in points])
    growth = np.array([point.growth for point in points])
    axes.plot(speeds, growth, color=BLACK, marker="." if len(points) == 1 else "")
    at = [point.speed_Hz for point in points for _ in point.growing]
    rates = [float(value.real) for point in points for value in point.growing]
    axes.scatter(at, rates, SMALL_DOT, color=VERMILION, zorder=3)
    for sign, colour, alpha in ((1.0, VERMILION, 0.3), (-1.0, BLUE, 0.15)):
        part = sign * growth > 0.0
        axes.fill_between(speeds, growth, 0.0, where=part, interpolate=True, color=colour, alpha=alpha, linewidth=0)
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -GROWTH_FLOOR), max(high, GROWTH_FLOOR))
    error = np.array([point.critical_error for point in points])
    axes.fill_between(speeds, growth - error, growth + error, color=BLACK, alpha=BAND, linewidth=0.0, zorder=2.5)
    axes.set(xlabel="rotor speed in Hz", ylabel="growth in 1/s")


def _mark_threshold(panels: tuple[Axes, Axes], threshold: Threshold, unit: SpeedUnit) -> None:
    above, _ = panels
    error = threshold.speed_uncertainty_Hz
    for axes in panels:
        axes.axvline(threshold.speed_Hz, color=BLACK, linewidth=0.9, linestyle=(0, (4, 3)))
        if error > 0.0:
            axes.axvspan(threshold.speed_Hz - error, threshold.speed_Hz + error, color=BLACK, alpha=BAND, linewidth=0.0)
    above.plot(threshold.speed_Hz, threshold.frequency_Hz, marker="D", color=BLACK, markersize=5, zorder=4)
    left = threshold.speed_Hz > 0.5 * above.get_xlim()[1]
    above.annotate(
        f"threshold {unit.words(threshold.speed_Hz, 1)}\n"
        f"whirl {threshold.frequency_Hz:.1f} Hz = {threshold.whirl_ratio:.3f}X",
        (threshold.speed_Hz, above.get_ylim()[1]),
        xytext=(-5 if left else 5, -4),
        textcoords="offset points",
        ha="right" if left else "left",
        va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85},
    )


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
        along = "along the shaft" if case.rotor.symmetric else "along the shaft in mm"
        shapes[-1].set_xlabel(f"{along}, at {case.speed_unit.words(last.speed_Hz)}")
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
    axes.plot([0.0, fastest], [0.0, fastest], color=GREY, linestyle=(0, (1, 2)), label="1X")
    axes.set(xlim=(0.0, fastest), ylim=(0.0, HEADROOM * max([fastest, *modes.free_Hz[:1]])), xlabel="rotor speed in Hz")
    axes.set_ylabel("natural frequency in Hz")


def _draw_shape(axes: Axes, modes: Modes, mode: Mode) -> None:
    scale = 1.0 if modes.case.rotor.symmetric else 1e3
    z = scale * modes.positions_m
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(z, mode.shape, color=BLUE, linewidth=1.6)
    for places, marker, colour in ((modes.bearings, "^", VERMILION), (modes.disks, "|", BLACK)):
        for _, place in places:
            axes.plot(scale * place, 0.0, marker=marker, color=colour, markersize=7, linestyle="none")
    axes.set_title(f"{mode.frequency_Hz:.4g} Hz, {mode.kind}", fontsize=9.0)
    axes.set(ylim=(-1.15, 1.15), yticks=[])


def shapes_figure(shapes: DampedModes) -> Figure:
    """The least damped modes, each as the shaft at the moment of its largest deflection within the orbits of its
    places; a dot begins an orbit, which is drawn for five sixths of a turn in the sense of the whirl."""
    case, shown = shapes.case, shapes.modes[: COLUMNS * ROWS]
    columns = min(COLUMNS, len(shown))
    rows = math.ceil(len(shown) / COLUMNS) or 1
    with styled():
        words = f"damped modes about the static equilibrium at {case.speed_unit.words(shapes.speed_Hz)}"
        figure = new_figure(case.heading, words, width=3.3 * max(columns, 2), height=0.5 + 3.0 * rows)
        figure.set_layout_engine("constrained", w_pad=0.15)
        for number, mode in enumerate(shown):
            axes: Any = figure.add_subplot(rows, max(columns, 1), number + 1, projection="3d")
            draw_shape(axes, shapes, mode)
    return figure


def draw_shape(axes: Any, shapes: DampedModes, mode: DampedMode) -> None:
    """One mode on axes with projection="3d": z along the shaft to the right, y up."""
    z = shapes.positions * (1e3 if shapes.to_scale else 1.0)
    colour = COLOUR.get(mode.direction, GREEN)
    moment = np.exp(-1j * np.angle(_largest(mode)))
    still = (mode.shape * moment).real
    axes.plot(z, np.zeros_like(z), np.zeros_like(z), color=GREY, linewidth=0.8)
    axes.plot(z, still[:, 0], still[:, 1], color=colour, linewidth=1.8)
    turn = np.exp(2j * np.pi * np.linspace(0.0, 5.0 / 6.0, TURN))
    places = np.unique(np.linspace(0, len(z) - 1, ORBITS).round().astype(int))
    marked = [int(np.argmin(np.abs(shapes.positions - at))) for _, at in shapes.marks]
    for place in sorted({*places.tolist(), *marked}):
        orbit = (turn[:, None] * mode.shape[place] * moment).real
        thick = 1.3 if place in marked else 0.6
        axes.plot(np.full(TURN, z[place]), orbit[:, 0], orbit[:, 1], color=colour, linewidth=thick, alpha=0.8)
        axes.plot([z[place]], orbit[:1, 0], orbit[:1, 1], color=colour, marker=".", markersize=4.0)
    _label_places(axes, shapes)
    axes.set_xlabel("along the shaft in mm" if shapes.to_scale else "along the shaft", fontsize=7.0, labelpad=-2.0)
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
    decay = f"grows with {growth:.3g} 1/s" if growth > 0.0 else f"damping ratio {mode.damping_ratio:.3g}"
    axes.set_title(f"{mode.frequency_Hz:.4g} Hz, {mode.direction}\n{decay}", fontsize=8.5,
                   color=VERMILION if growth > 0.0 else "black")  # fmt: skip


def _label_places(axes: Any, shapes: DampedModes) -> None:
    """Names below the shaft, each in the lowest row in which it covers none to its left."""
    ends: list[float] = []  # of the rows
    letter = LETTER * float(np.ptp(shapes.positions))
    for name, at in sorted(shapes.marks, key=lambda mark: mark[1]):
        half = 0.5 * letter * (len(name) + 1)
        row = next((number for number, end in enumerate(ends) if end < at - half), len(ends))
        ends[row : row + 1] = [at + half]
        place = at * (1e3 if shapes.to_scale else 1.0)
        axes.text(place, 0.0, LOWEST + ROW * row, name, fontsize=6.0, ha="center", color=GREY)


def _largest(mode: DampedMode) -> complex:
    """Amplitude of x or y where it is largest."""
    return complex(mode.shape.ravel()[first_largest(mode.shape.ravel())])
