"""Ridges of runs over each other: a fit before and after, and a computed run beside a measured one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.ridges import Ridges
from frbcli.plot.signals import MICRO
from frbcli.plot.spectra.waterfall import draw_levels, level_label, run_spectra
from frbcli.plot.style import BLACK, BLUE, VERMILION, in_words, legend_below, name_of_key, new_figure, styled
from frbcli.studies.against import AgainstMeasured
from frbcli.studies.fit import Fit
from frbcli.units import display

Drawn = tuple[str, Ridges, dict[str, Any]]

MEASURED: dict[str, Any] = {"color": BLACK, "marker": "o", "markersize": 3.0, "linestyle": "none", "zorder": 3.0}
COMPUTED: dict[str, Any] = {"color": BLUE, "linestyle": "-"}
BEFORE: dict[str, Any] = {"color": VERMILION, "linestyle": (0, (4, 2)), "linewidth": 0.9}


def fit_figure(found: Fit) -> Figure:
    """Synchronous amplitude, frequency and amplitude of the whirl over the rotor speed: measured, with the numbers at
    first, and with those found."""
    case = found.case
    numbers = ", ".join(
        f"{name_of_key(n.key)} {in_words(display(n.value, n.unit)) if n.unit else f'{n.value:.4g}'} "
        f"± {100.0 * n.error / n.value:.2g} %"
        for n in found.numbers
    )
    drawn: list[Drawn] = [
        ("measured", found.measured, MEASURED), ("before", found.before, BEFORE), ("after", found.after, COMPUTED),
    ]  # fmt: skip
    with styled():
        panels = 3 if any(ridges.whirls.any() for _, ridges, _ in drawn) else 1
        figure = new_figure(case.heading, numbers, height=3.0 + 2.2 * (panels - 1))
        _draw_ridges(list(figure.subplots(panels, 1, sharex=True, squeeze=False)[:, 0]), drawn)
        legend_below(figure, figure.axes[0])
    return figure


def against_figure(found: AgainstMeasured) -> Figure:
    """Both waterfalls over the rotor speed in one scale, and below them the ridges over each other."""
    with styled():
        figure = new_figure(found.run.title, f"beside {found.measurement.path.name}", 9.0, 9.0)
        grid = figure.add_gridspec(4, 2, height_ratios=(2.2, 1.0, 1.0, 1.0))
        maps = [figure.add_subplot(grid[0, column]) for column in range(2)]
        for axes, run, name in zip(maps, (found.run, found.measurement), ("computed", "measured"), strict=True):
            point = found.point if name == "computed" else "journal"
            mesh = draw_levels(axes, run, point, run_spectra(run, point, None, "x"), "time")
            axes.set_title(name)
        highest = max(axes.get_ylim()[1] for axes in maps)
        for axes in maps:
            axes.set_ylim(0.0, highest)
        maps[1].set_ylabel("")
        bar = figure.colorbar(mesh, ax=maps, pad=0.01, extend="both")
        bar.set_label(level_label(found.run, "journal"))
        bar.outline.set_visible(False)
        first = figure.add_subplot(grid[1, :])
        panels = [first, *(figure.add_subplot(grid[row, :], sharex=first) for row in (2, 3))]
        drawn: list[Drawn] = [("measured", found.measured, MEASURED), ("computed", found.computed, COMPUTED)]
        _draw_ridges(panels, drawn)
        legend_below(figure, panels[0])
    return figure


def _draw_ridges(panels: Sequence[Axes], drawn: Sequence[Drawn]) -> None:
    """Ridges of several runs: synchronous amplitude of x, and on two more axes frequency and amplitude of the whirl. A
    single point of a line has a marker."""
    above, *whirls = panels
    for name, found, look in drawn:
        above.plot(found.speed_Hz, MICRO * found.synchronous[:, 0], label=name, **look)
        alone: dict[str, Any] = {"marker": "."} if np.count_nonzero(found.whirls) == 1 else {}
        for axes, values in zip(whirls, (found.whirl_Hz, MICRO * found.whirl), strict=False):
            axes.plot(found.speed_Hz, np.where(found.whirls, values, np.nan), **alone | look)
        if whirls and np.isfinite(found.onset_Hz):
            whirls[0].axvline(found.onset_Hz, color=str(look["color"]), linewidth=0.8, linestyle=(0, (1, 2)))
    above.set_ylabel("synchronous in µm")
    above.set_ylim(bottom=0.0)
    if whirls:
        whirls[0].set_ylabel("whirl in Hz, dotted: onset")
        whirls[1].set_ylabel("whirl in µm")
        whirls[1].set_ylim(bottom=0.0)
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel("rotor speed in Hz")
