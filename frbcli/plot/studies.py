"""Pictures of studies. Several models of the films in one picture, with eccentricities overlaid, and their events.

Ridges of runs over each other: a fit before and after, and a computed run next to a measured one.

Where the whirl begins, over one key of a sweep as a curve, over two as a map.

Error over cost of the rungs of a ladder.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.resonance import Ridges
from frbcli.analysis.signals import films
from frbcli.case.run import speed_unit_of
from frbcli.errors import input_error
from frbcli.film.cavitation.table import label_of
from frbcli.plot.motion import Line, draw_largest
from frbcli.plot.signals import MICRO, ends
from frbcli.plot.style import (
    BLACK,
    BLUE,
    COLOURS,
    GREY,
    LEVEL_MAP,
    MOST_MARKED,
    VERMILION,
    in_words,
    legend_below,
    name_of_key,
    new_figure,
    plain_numbers,
    styled,
)
from frbcli.plot.waterfall import draw_levels, level_label, run_spectra
from frbcli.results.columns import touching_name
from frbcli.results.store import Run
from frbcli.studies.accuracy import AccuracyLadder, Rung, RungResult
from frbcli.studies.against import AgainstMeasured
from frbcli.studies.compare import Comparison, Variant
from frbcli.studies.fit import Fit
from frbcli.studies.sweep import Scatter, Sweep, SweepPoint
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


KINDS = {"runup": ("onset", "onset of the whirl"), "stability": ("threshold", "threshold of stability")}
MOST_TICKS, MOST_DIGITS = 12, 6
MOST_NUMBERS = 100  # cells of a map that still have room for their value
DARK = 0.5  # share of the colour range below which white letters are read best
_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


@dataclass(frozen=True)
class _Scale:
    """The values of a key, ascending. texts: as written; unit: of all of them, None if they are no numbers in one;
    others: keys that change with it."""

    key: str
    texts: tuple[str, ...]
    unit: str | None
    others: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        own = name_of_key(self.key, self.unit or "")
        return f"{own}, with it {', '.join(map(name_of_key, self.others))}" if self.others else own

    @property
    def ticks(self) -> list[str]:
        """As written, or if that is long, with as few digits as keep all values apart."""
        if self.unit is None:
            return list(self.texts)
        counts = range(3, MOST_DIGITS + 1)
        *shorter, full = ([f"{_number(text):.{digits}g}" for text in self.texts] for digits in counts)
        if max(map(len, full)) < MOST_DIGITS:
            return full
        return next((ticks for ticks in shorter if len(set(ticks)) == len(ticks)), full)


def can_draw(sweep: Sweep) -> bool:
    """Whether `sweep_figure` can draw it: one or two keys have several values, and some point begins to whirl."""
    return len(_scales(sweep)) in (1, 2) and any(not math.isnan(_speed(sweep, point)) for point in sweep.points)


def sweep_figure(sweep: Sweep) -> Figure:
    """Onset of the whirl, or threshold of stability, in Hz, over the one or two keys that change.

    Points without one are marked. Raises InputError for what `can_draw` refuses.
    """
    if not can_draw(sweep):
        problem, remedy = "needs one or two keys with several values, and a whirl.", "See its to_pandas()."
        raise input_error("picture", "Sweep", "", problem, remedy)
    scales = _scales(sweep)
    with styled():
        subtitle = f"{KINDS[sweep.method][1]}, {len(sweep.points)} points"
        figure = new_figure(sweep.case.heading, subtitle)
        axes = figure.subplots()
        if len(scales) == 1:
            _draw_curve(axes, sweep, scales[0])
        else:
            _draw_map(figure, axes, sweep, scales[0], scales[1])
    return figure


def _draw_curve(axes: Axes, sweep: Sweep, over: _Scale) -> None:
    speeds = dict.fromkeys(over.texts, math.nan)
    speeds |= {point.settings.get(over.key, ""): _speed(sweep, point) for point in sweep.points}
    speed = np.array([speeds[text] for text in over.texts])
    at = np.arange(len(over.texts), dtype=float)
    if over.unit is None:
        axes.set_xticks(at, over.ticks)
    else:
        at = np.array([_number(text) for text in over.texts])
    axes.plot(at, speed, marker="o", color=BLUE)
    missing = np.isnan(speed)
    if missing.any():
        bottom = np.full(np.count_nonzero(missing), np.nanmin(speed))
        axes.plot(at[missing], bottom, "x", color=VERMILION, label="none found")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.set(xlabel=over.label, ylabel=f"{KINDS[sweep.method][0]} in Hz")


def _draw_map(figure: Figure, axes: Axes, sweep: Sweep, across: _Scale, up: _Scale) -> None:
    """A cell for each point; cells are equal, whatever the steps between the values."""
    speeds = np.full((len(up.texts), len(across.texts)), math.nan)
    for point in sweep.points:
        column = across.texts.index(point.settings.get(across.key, ""))
        speeds[up.texts.index(point.settings.get(up.key, "")), column] = _speed(sweep, point)
    axes.set_facecolor("#E4E4E4")
    mesh = axes.pcolormesh(np.arange(len(across.texts)), np.arange(len(up.texts)), np.ma.masked_invalid(speeds),
                           cmap=LEVEL_MAP, shading="nearest")  # fmt: skip
    figure.colorbar(mesh, ax=axes, label=f"{KINDS[sweep.method][0]} in Hz; grey: none found")
    low, high = np.nanmin(speeds), np.nanmax(speeds)
    for (row, column), speed in np.ndenumerate(speeds):
        if speeds.size <= MOST_NUMBERS and not math.isnan(speed):
            colour = "white" if speed < low + DARK * (high - low) or low == high else "black"
            axes.text(column, row, f"{speed:.0f}", ha="center", va="center", color=colour, fontsize=7.5)
    axes.grid(visible=False)
    for scale, place in ((across, axes.set_xticks), (up, axes.set_yticks)):
        every = math.ceil(len(scale.texts) / MOST_TICKS)
        place(np.arange(len(scale.texts))[::every], scale.ticks[::every])
    axes.set(xlabel=across.label, ylabel=up.label)


def _scales(sweep: Sweep) -> list[_Scale]:
    """The keys that have several values; of linked ones, which change together, the first."""
    values = {key: list(dict.fromkeys(point.settings.get(key, "") for point in sweep.points)) for key in sweep.keys}
    scales: list[_Scale] = []
    for key, texts in values.items():
        if len(texts) < 2:
            continue
        leading = next((place for place, scale in enumerate(scales) if _linked(sweep, scale.key, key)), None)
        if leading is None:
            scales.append(_scale(key, texts))
        else:
            scales[leading] = replace(scales[leading], others=(*scales[leading].others, key))
    return scales


def _linked(sweep: Sweep, key: str, other: str) -> bool:
    """Whether each value of a key goes with one of another, and the other way round."""
    pairs = {(point.settings.get(key, ""), point.settings.get(other, "")) for point in sweep.points}
    return len({one for one, _ in pairs}) == len({two for _, two in pairs}) == len(pairs)


def _scale(key: str, texts: list[str]) -> _Scale:
    read = [_QUANTITY.fullmatch(text) for text in texts]
    units = {"" if match is None else match.group(2) for match in read}
    if None in read or len(units) > 1:
        return _Scale(key, tuple(texts), None)
    return _Scale(key, tuple(sorted(texts, key=_number)), units.pop())


def _number(text: str) -> float:
    match = _QUANTITY.fullmatch(text)
    return math.nan if match is None else float(match.group(1))


def _speed(sweep: Sweep, point: SweepPoint) -> float:
    event = point.first(KINDS[sweep.method][0])
    return math.nan if event is None else float(event["speed_Hz"])


def scatter_figure(title: str, scatter: Scatter) -> Figure:
    """The share of machines that begin to whirl below each speed, as a curve of steps, with the speed of interest."""
    speeds = scatter.speeds_Hz[np.isfinite(scatter.speeds_Hz)]
    share = 100.0 * np.arange(1, len(speeds) + 1) / scatter.count
    with styled():
        figure = new_figure(title, f"{scatter.count} machines with scattered numbers")
        axes = figure.subplots()
        axes.step(speeds, share, where="post", color=BLUE)
        axes.axvline(scatter.below_Hz, color=VERMILION, linestyle="--")
        low, high = (100.0 * limit for limit in scatter.interval)
        text = f"{100.0 * scatter.share:.1f} % below {scatter.below_Hz:.4g} Hz\n({low:.1f} to {high:.1f} %)"
        axes.annotate(text, (scatter.below_Hz, 0.5), xycoords=("data", "axes fraction"), ha="right", va="center",
                      xytext=(-6, 0), textcoords="offset points")  # fmt: skip
        axes.set(ylim=(0.0, 100.0), xlabel="rotor speed in Hz", ylabel="machines that whirl in %")
    return figure


RUNGS = ("o", "s", "^", "D", "v", "P", "X")
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
                      marker=RUNGS[index % len(RUNGS)], color=COLOURS[index % len(COLOURS)], label=group)  # fmt: skip
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
        axes.set(xlabel="CPU time in s, with the tabulation of the films", ylabel="largest error of the eccentricity")
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
