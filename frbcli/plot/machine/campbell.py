"""The Campbell diagram: eigenfrequencies over rotor speed, growing motions marked, and their growth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.linear.stability import Stability
from frbcli.linear.stability_point import StabilityPoint
from frbcli.linear.threshold import Threshold
from frbcli.plot.style import BAND, BLACK, BLUE, GREY, VERMILION, new_figure, styled
from frbcli.units import SpeedUnit

ABOVE_LOWEST = 1.2  # the frequency axis ends with the rotor speed, but not below the slowest mode
DOT, SMALL_DOT = 15.0, 6.0  # pt^2
BESIDE_ONE, BESIDE_LAST = 1.1, 1.01  # times the last speed: the edge would cut its points
GROWTH_FLOOR = 1.0  # 1/s, smallest half height of the growth panel, above round-off


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
    for label, order, dashes in (("rotor speed", 1.0, (0, (5, 3))), ("half the rotor speed", 0.5, (0, (1, 2)))):
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
    axes.set_xlim(0.0, fastest * (BESIDE_LAST if len(points) > 1 else BESIDE_ONE))
    axes.set_ylim(0.0, top)
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
    axes.set_xlabel("rotor speed in Hz")
    axes.set_ylabel("growth in 1/s")


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
