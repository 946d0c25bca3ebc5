"""The share of machines that whirl, over the rotor speed."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from frbcli.plot.style import BLUE, VERMILION, new_figure, styled
from frbcli.studies.sweep.scatter import Scatter


def scatter_figure(title: str, found: Scatter) -> Figure:
    """The share of machines that begin to whirl below each speed, as a curve of steps, with the speed of interest."""
    speeds = found.speeds_Hz[np.isfinite(found.speeds_Hz)]
    share = 100.0 * np.arange(1, len(speeds) + 1) / found.count
    with styled():
        figure = new_figure(title, f"{found.count} machines with scattered numbers")
        axes = figure.subplots()
        axes.step(speeds, share, where="post", color=BLUE)
        axes.axvline(found.below_Hz, color=VERMILION, linestyle="--")
        low, high = (100.0 * limit for limit in found.interval)
        text = f"{100.0 * found.share:.1f} % below {found.below_Hz:.4g} Hz\n({low:.1f} to {high:.1f} %)"
        axes.annotate(text, (found.below_Hz, 0.5), xycoords=("data", "axes fraction"), ha="right", va="center",
                      xytext=(-6, 0), textcoords="offset points")  # fmt: skip
        axes.set_ylim(0.0, 100.0)
        axes.set_xlabel("rotor speed in Hz")
        axes.set_ylabel("machines that whirl in %")
    return figure
