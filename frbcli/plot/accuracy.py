"""Error over cost of the rungs of a ladder."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.film.cavitation.table import label_of
from frbcli.plot.style import BLACK, COLOURS, GREY, legend_below, new_figure, plain_numbers, styled
from frbcli.studies.ladder import AccuracyLadder, Rung, RungResult

MARKS = ("o", "s", "^", "D", "v", "P", "X")
SMALLEST = 1e-16  # drawn for no deviation at all
COST_SPAN = 4.0  # of the axis at least: costs that differ by the noise of a clock lie side by side


def accuracy_figure(ladder: AccuracyLadder) -> Figure:
    """Largest deviation of the eccentricity over CPU time, both logarithmic: one colour and mark for each theory, mesh
    and coupling, joined in the order of their tolerances; Pareto's front, the choice of the plan, and the
    reference uncertainty. Raises ValueError for a ladder without rungs.
    """
    if not ladder.ladder:
        raise ValueError("a ladder needs a rung")
    reference = ladder.reference.rung
    with styled():
        name = label_of(reference.cavitation)
        window = min(item.error.until_s for item in ladder.ladder)
        tolerances = sorted({item.rung.tolerance for item in ladder.ladder}, reverse=True)
        several = len({item.rung.coupling for item in ladder.ladder}) > 1
        subtitle = (
            f"{name}: error over cost of a run-up, first {window:.3g} s, "
            f"tolerances from {tolerances[0]:.0e} to {tolerances[-1]:.0e}"
        ).replace("e-0", "e-")
        figure = new_figure(ladder.case.heading, subtitle, height=4.8)
        axes = figure.subplots()
        axes.margins(x=0.08, y=0.08)
        axes.set_xscale("log")
        plain_numbers(axes.xaxis)
        axes.set_yscale("log")
        rungs = sorted((item.rung for item in ladder.ladder), key=lambda rung: np.prod(rung.mesh or (0,)))
        groups = dict.fromkeys(_group(rung, several) for rung in rungs)
        for index, group in enumerate(groups):
            items = [item for item in ladder.ladder if _group(item.rung, several) == group]
            items.sort(key=lambda item: item.rung.tolerance)
            axes.plot([_cost(item) for item in items], [_error(item) for item in items], linewidth=0.7, markersize=5.0,
                      marker=MARKS[index % len(MARKS)], color=COLOURS[index % len(COLOURS)], label=group)  # fmt: skip
        least, most = axes.get_xlim()
        wider = max(1.0, np.sqrt(COST_SPAN * least / most))
        axes.set_xlim(least / wider, most * wider)
        _draw_front(axes, ladder)
        for item in ladder.ladder:
            if item.planned:
                axes.plot(_cost(item), _error(item), "o", markersize=13.0, color=BLACK, markerfacecolor="none",
                          label="choice of the plan")  # fmt: skip
        change = max(ladder.reference.error.eccentricity_largest, SMALLEST)
        axes.set_ylim(bottom=min(axes.get_ylim()[0], change / 3.0))
        axes.axhspan(axes.get_ylim()[0], change, color=GREY, alpha=0.15, linewidth=0.0)
        axes.annotate("reference uncertainty", (1.0, change), xycoords=("axes fraction", "data"),
                      xytext=(-4, -3), textcoords="offset points", ha="right", va="top", fontsize=7.5,
                      color=GREY)  # fmt: skip
        axes.set_xlabel("CPU time in s, with the tabulation of the films")
        axes.set_ylabel("largest error of the eccentricity")
        axes.grid(which="minor", visible=False)
        legend_below(figure, axes)
    return figure


def _draw_front(axes: Axes, ladder: AccuracyLadder) -> None:
    """The front as steps."""
    front = ladder.front
    cost, error = [_cost(item) for item in front], [_error(item) for item in front]
    dearest = max(_cost(item) for item in ladder.ladder)
    axes.step([*cost, dearest], [*error, error[-1]], where="post", color=GREY, linewidth=3.0, alpha=0.35, zorder=1.0,
              label="Pareto front")  # fmt: skip


def _group(rung: Rung, several: bool) -> str:
    """several: couplings, so that they are named, too."""
    mesh = "" if rung.mesh is None else f" {rung.mesh[0]} x {rung.mesh[1]}"
    return f"{rung.theory}{mesh}, {rung.coupling}" if several else f"{rung.theory}{mesh}"


def _cost(item: RungResult) -> float:
    return max(item.cpu_s, 1e-6)


def _error(item: RungResult) -> float:
    error = item.error.eccentricity_largest
    return max(error, SMALLEST) if np.isfinite(error) else np.nan
