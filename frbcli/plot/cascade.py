"""The cascade, the older, three-dimensional form of the waterfall: spectra as curves behind each other."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from frbcli.analysis.spectrum import Spectrogram
from frbcli.arrays import Array
from frbcli.plot.curves import WORDS, Over
from frbcli.plot.style import BLUE, GREY

CURVES = 60
HEIGHT = 0.25  # of a curve from the lowest to the highest level, relative to the depth of the stack
SHEAR = 0.22  # how far the last curve stands to the right, relative to the frequency axis
NICE = [1, 2, 5, 10]  # steps of the ticks
ABOVE_CURVES = 10 + CURVES


def draw_cascade(
    axes: Axes,
    found: Spectrogram,
    over: Over,
    values: Array,
    limits: tuple[float, float],
    unit: str,
    lines: list[tuple[str, Array]],
) -> None:
    """Curves over frequency, shifted up and to the right with time or speed; those in front hide those behind.

    values (k, m) and their limits in a unit: heights of the curves; lines: label and frequency (m,) in Hz of each line
    to draw on the floor, e.g. the rotor speed.
    """
    depth = found.time_s if over == "time" else found.speed_Hz
    span = float(np.ptp(depth)) or 1.0
    width = float(found.frequency_Hz[-1])
    shift = SHEAR * width * (depth - depth[0]) / span
    height = HEIGHT * span / (limits[1] - limits[0])
    chosen = np.unique(np.linspace(0, len(depth) - 1, min(CURVES, len(depth))).round().astype(int))
    for layer, place in enumerate(chosen[::-1], start=10):
        curve = depth[place] + height * (np.clip(values[:, place], *limits) - limits[0])
        frequency = found.frequency_Hz + shift[place]
        axes.fill_between(frequency, depth[place], curve, facecolor="white", edgecolor="none", zorder=layer)
        axes.plot(frequency, curve, color=BLUE, linewidth=0.7, zorder=layer)
    for label, frequency in lines:
        axes.plot(frequency + shift, depth, color="black", linewidth=0.8, linestyle=(0, (2, 3)), zorder=ABOVE_CURVES)
        axes.annotate(
            label,
            (frequency[-1] + shift[-1], depth[-1]),
            xytext=(4, 1),
            textcoords="offset points",
            zorder=ABOVE_CURVES,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )
    _draw_frame(axes, depth, shift, width, span)
    right = width + shift[-1]
    axes.plot([right] * 2, [depth[-1], depth[-1] + HEIGHT * span], color="black", linewidth=1.5)
    axes.annotate(f"{limits[1] - limits[0]:.3g} {unit}", (right, depth[-1] + HEIGHT * span / 2), (-4, 0),
                  textcoords="offset points", ha="right", va="center")  # fmt: skip
    axes.set_xlabel("frequency in Hz")
    axes.set_ylabel(WORDS[over])


def _draw_frame(axes: Axes, depth: Array, shift: Array, width: float, span: float) -> None:
    """Slanting lines of equal frequency: the ticks below belong to the foremost curve."""
    ticks = [tick for tick in MaxNLocator(8, steps=NICE).tick_values(0.0, width) if 0.0 <= tick <= width]
    for tick in ticks:
        axes.plot([tick, tick + shift[-1]], [depth[0], depth[-1]], color=GREY, linewidth=0.4, alpha=0.6)
    axes.grid(False)
    axes.set_xticks(ticks)
    bottom, top = depth[0], depth[0] + (1.02 + HEIGHT) * span
    axes.set_ylim(bottom, top)
    depths = MaxNLocator(7, steps=NICE).tick_values(bottom, bottom + span)
    axes.set_yticks([tick for tick in depths if bottom <= tick <= bottom + span])
    axes.set_xlim(0.0, (width + shift[-1]) * 1.02)
    axes.margins(0.0)
