"""Runs in one picture: several models of the films, with eccentricities overlaid, and their events; ridges of runs over
each other: a fit before and after, and a computed run next to a measured one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.resonance import Ridges
from frbcli.analysis.signals import films
from frbcli.case.run import speed_unit_of
from frbcli.film.cavitation.table import label_of
from frbcli.plot.motion import Line, draw_largest
from frbcli.plot.signals import MICRO, ends
from frbcli.plot.style import (
    BLACK,
    BLUE,
    COLOURS,
    MOST_MARKED,
    VERMILION,
    in_words,
    legend_below,
    name_of_key,
    new_figure,
    styled,
)
from frbcli.plot.waterfall import draw_levels, level_label, run_spectra
from frbcli.results.columns import touching_name
from frbcli.results.store import Run
from frbcli.studies.against import AgainstMeasured
from frbcli.studies.compare import Comparison, Variant
from frbcli.studies.fit import Fit
from frbcli.units import display

LINES: tuple[Line, ...] = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.5, 1.5, 1.5)))
MARKS = {"critical-speed": "o", "self-excited": "D", "onset": "^", "offset": "v", "lock-in": "s", "contact": "X",
         "touch": "1", "lift-off": "2", "clearance-step": "|", "loss": "|",
         "top-speed": "*", "standstill": "P"}  # fmt: skip
WORDS = {"critical-speed": "critical", "self-excited": "self-excited", "onset": "whirl", "offset": "whirl ends",
         "lock-in": "locks in", "contact": "contact", "clearance-step": "step", "loss": "loss",
         "top-speed": "top speed", "standstill": "stands"}  # fmt: skip
ROW_HEIGHT = 0.32  # inches of a variant's row
LEFT_SHARE = 0.85  # of the time axis; the label of an event beyond stands left of it


def comparison_figure(comparison: Comparison) -> Figure:
    """Eccentricity over time and rotor speed, one colour and line style per variant; below, a row of events for each.

    Raises RunFileError if a run holds no samples.
    """
    runs = [result.run for result in comparison.results]
    spans = [ends(run) for run in runs]
    count = len(runs)
    with styled():
        title = comparison.case.heading
        models = {(result.variant.cavitation, result.variant.theory) for result in comparison.results}
        what = "models of the films" if len(models) > 1 else "couplings of rotor and films"
        figure = new_figure(title, f"run-up with {count} {what}", height=4.4 + ROW_HEIGHT * count)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3.6, ROW_HEIGHT * count))
        above.set_xlim(min(span[0] for span in spans), max(span[-1] for span in spans))
        for row, run in enumerate(runs):
            colour, line = COLOURS[row % len(COLOURS)], LINES[row % len(LINES)]
            for film in films(run.signals):
                draw_largest(above, run, film, colour, line)
            _draw_events(below, run, row, colour, line)
        _speed_axis(above, comparison)
        below.set_yticks(range(count), [_name(result.variant, len(models) > 1) for result in comparison.results])
        below.set_ylim(count - 0.5, -0.5)
        below.tick_params(axis="y", length=0)
        below.grid(axis="y", visible=False)
        below.spines["left"].set_visible(False)
        below.set_xlabel("time in s")
    return figure


def _draw_events(axes: Axes, run: Run, row: int, colour: str, line: Line) -> None:
    """A run as a line as long as it lasts, with its events on it."""
    left, right = axes.get_xlim()
    unit = speed_unit_of(run)
    axes.plot(ends(run), [row, row], color=colour, linestyle=line)
    for event in run.events[:MOST_MARKED]:
        at = event["t_s"]
        axes.plot(at, row, marker=MARKS.get(event["kind"], "."), markersize=6.0, color=colour, clip_on=False)
        after = at < left + LEFT_SHARE * (right - left)
        axes.annotate(
            f"{touching_name(event) or WORDS.get(event['kind'], event['kind'])} {unit.words(event['speed_Hz'], 1)}",
            (at, row),
            xytext=(6 if after else -6, 3),
            textcoords="offset points",
            ha="left" if after else "right",
            va="bottom",
            fontsize=7.5,
        )


def _speed_axis(axes: Axes, comparison: Comparison) -> None:
    """The rotor speed above the time, where it rises from the beginning to the end."""
    speed = comparison.case.speed
    rate = (speed.end - speed.start) / speed.duration
    if rate == 0.0 or speed.times:
        return

    def at_time(time_s: Any) -> Any:
        return speed.start + rate * time_s

    def at_speed(speed_hz: Any) -> Any:
        return (speed_hz - speed.start) / rate

    axes.secondary_xaxis("top", functions=(at_time, at_speed)).set_xlabel("rotor speed in Hz")


def _name(variant: Variant, several: bool) -> str:
    """several: models, not only couplings of one."""
    if not several:
        return variant.coupled
    name = f"{label_of(variant.cavitation)}, {variant.theory}"
    return name if variant.coupling == "auto" else f"{name},\n{variant.coupling}"


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
        figure = new_figure(found.run.title, f"compared with {found.measurement.path.name}", 9.0, 9.0)
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
        whirls[0].set_ylabel("whirl in Hz\n(dotted: onset)")
        whirls[1].set_ylabel("whirl in µm")
        whirls[1].set_ylim(bottom=0.0)
    for axes in panels[:-1]:
        axes.tick_params(labelbottom=False)
    panels[-1].set_xlabel("rotor speed in Hz")
