"""The diagram of limit cycles: eccentricity over the rotor speed, stable solid, unstable dashed; below, frequency. The
stability map: curves of Hopf points and folds over the rotor speed and a number of the case, or over two numbers.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from frbcli.arrays import Array, Truths
from frbcli.cycles.columns import SPEED, SUBCRITICAL, SUPERCRITICAL, CycleBranch, CyclePoint, LimitCycles, SpecialPoint
from frbcli.cycles.stability_map import BAUTIN, CUSP, MapCurve, StabilityMap
from frbcli.plot.curves import RunTrack
from frbcli.plot.style import (
    BAND,
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    legend_below,
    name_of_key,
    new_figure,
    plain,
    styled,
)

COLOURS = (BLUE, VERMILION, PURPLE, SKY)  # of branches
RUN_COLOURS = (ORANGE, GREEN, "#8C564B", "#17BECF")  # of runs, which are none of the branches'
UP, DOWN = "-", (0, (4, 1, 1, 1))  # lines of the ways of a run
MARKS = {"hopf": ("o", "Hopf point"), "fold": ("D", "fold"), "flip": ("s", "flip"), "torus": ("^", "torus point")}
ROOM = 1.05  # top of the frequencies over the largest one
PIECES = 8  # straight pieces between two cycles
WHIRL = "whirl locked in with unbalance"
ERROR = "error by the mesh"
SEEN = 0.004  # of the largest value of a panel: a wider band is seen, and named
STABLE, UNSTABLE = "-", (0, (3, 1.5))


def limit_cycles_figure(diagram: LimitCycles, tracks: Sequence[RunTrack] = ()) -> Figure:
    """Largest eccentricities of static equilibria and cycles over the speed, a panel for each film, and below the
    frequencies of the cycles with half the rotor speed and the lines of the rings.

    tracks: of runs, drawn over it as thin lines.
    """
    case = diagram.case
    count = len(diagram.films)
    with styled():
        at = "" if diagram.over == SPEED else f" at {case.speed_unit.words(diagram.equilibria[0].speed_Hz)}"
        words = f"static equilibria and limit cycles{at}, dashed where unstable"
        figure = new_figure(case.heading, words, 7.2, 2.6 + 2.0 * count)
        panels = figure.subplots(count + 1, 1, sharex=True, height_ratios=[1.6] * count + [1.0])
        for film, axes in enumerate(panels[:-1]):
            _film(axes, diagram, film)
            _runs(axes, tracks, diagram.films[film])
        _frequencies(panels[-1], diagram)
        legend_below(figure, panels[0], panels[-1], columns=4)
    return figure


def _film(axes: Axes, diagram: LimitCycles, film: int) -> None:
    in_films = bool(diagram.case.films)  # else in springs or ball bearings, over a length of their own
    if in_films:
        axes.set_ylim(0.0, 1.0)
    speeds = np.array([point.value for point in diagram.equilibria])
    eccentricity = np.array([point.eccentricity[film] for point in diagram.equilibria])
    stable = np.array([point.stable for point in diagram.equilibria])
    _line(axes, speeds, eccentricity, stable, BLACK, "static equilibrium")
    if diagram.synchronous:
        speeds = np.array([point.value for point in diagram.synchronous])
        values = np.array([point.eccentricity_max[film] for point in diagram.synchronous])
        stable = np.array([point.stable for point in diagram.synchronous])
        _line(axes, speeds, values, stable, GREY, "synchronous motion with unbalance")
    for number, branch in _drawn(diagram):
        values = np.array([point.eccentricity_max[film] for point in branch.points])
        label = "limit cycles" if len(diagram.branches) == 1 else f"limit cycles, branch {number + 1}"
        _curve(axes, branch, values, COLOURS[number % len(COLOURS)], label)
        _band(axes, branch, values, [_eccentricity_error(point, film) for point in branch.points], number)
        _whirls(axes, branch, [whirl.eccentricity_max[film] for whirl in branch.with_unbalance], number)
    for kind, (marker, label) in MARKS.items():
        points = diagram.of(kind)
        at = [point.value for point in points], [point.eccentricity_max[film] for point in points]
        if points:
            axes.plot(*at, linestyle="", marker=marker, color=BLACK, markersize=4.5, label=label, zorder=4)
            errors = [each.value_uncertainty for each in points], [_eccentricity_error(each, film) for each in points]
            _bars(axes, *at, *errors)
    if not in_films:
        axes.set_ylim(0.0, ROOM * axes.get_ylim()[1])
    quantity = "largest eccentricity" if in_films else "displacement over length"
    axes.set_ylabel(f"{quantity}\n{diagram.films[film].replace('_', ' ')}".rstrip())


def _drawn(diagram: LimitCycles) -> list[tuple[int, CycleBranch]]:
    """The branches with points, by their numbers."""
    return [(number, branch) for number, branch in enumerate(diagram.branches) if branch.points]


def _runs(axes: Axes, tracks: Sequence[RunTrack], film: str) -> None:
    """The largest eccentricities of runs, a colour each: full lines up, dashes with dots down. Runs of one ramp have
    their names in the legend, too."""
    ramps = Counter(track.label for track in tracks)
    runs = list(dict.fromkeys(track.run for track in tracks))
    for track in tracks:
        values = track.largest.get(film)
        if values is not None:
            colour = RUN_COLOURS[runs.index(track.run) % len(RUN_COLOURS)]
            axes.plot(track.speed_Hz, values, color=colour, linestyle=UP if track.rising else DOWN, linewidth=0.8,
                      label=plain(f"{track.label}, {track.run}" if ramps[track.label] > 1 else track.label),
                      zorder=1.8)  # fmt: skip


def _frequencies(axes: Axes, diagram: LimitCycles) -> None:
    speeds = np.array([point.value for point in diagram.equilibria])
    ends = np.array([speeds.min(initial=speeds.max()), speeds.max()])
    rotor = np.array([point.speed_Hz for point in diagram.equilibria])
    axes.plot(speeds, 0.5 * rotor, color=GREY, linestyle=(0, (1, 2)), label="0.5X")
    rings = np.array([point.ring_speeds_Hz for point in diagram.equilibria])
    for ring in range(rings.shape[1] if rings.size else 0):
        own = rings[:, ring]
        labels = ("(ω$_R$ + ω$_F$)/2", "ω$_F$/2") if ring == 0 else (None, None)
        axes.plot(speeds, 0.5 * (rotor + own), color=GREY, linestyle=(0, (5, 3)), label=labels[0])
        axes.plot(speeds, 0.5 * own, color=GREY, linestyle="-", linewidth=0.7, label=labels[1])
    for number, branch in _drawn(diagram):
        values = np.array([point.frequency_Hz for point in branch.points])
        _curve(axes, branch, values, COLOURS[number % len(COLOURS)], None)
        _band(axes, branch, values, [point.frequency_uncertainty_Hz for point in branch.points], number)
        _whirls(axes, branch, [whirl.frequency_Hz for whirl in branch.with_unbalance], number, in_legend=False)
    for kind, (marker, _) in MARKS.items():
        points = diagram.of(kind)
        at = [point.value for point in points], [point.frequency_Hz for point in points]
        axes.plot(*at, linestyle="", marker=marker, color=BLACK, markersize=4.5, zorder=4)
        frequencies = [point.frequency_uncertainty_Hz for point in points]
        _bars(axes, *at, [point.value_uncertainty for point in points], frequencies)
    axes.set(xlim=(float(ends[0]), float(ends[1])), ylim=(0.0, ROOM * axes.get_ylim()[1]))
    axes.set_xlabel("rotor speed in Hz" if diagram.over == SPEED else name_of_key(diagram.over, diagram.unit))
    axes.set_ylabel("frequency in Hz")


def _curve(axes: Axes, branch: CycleBranch, y: Array, colour: str, label: str | None) -> None:
    """A branch, its cycles joined by cubics along it that go to and fro only where the cycles do."""
    x = np.array([point.value for point in branch.points])
    stable = np.array([point.stable for point in branch.points], dtype=bool)
    if len(x) > 2:
        lengths = np.hypot(np.diff(x) / max(float(np.ptp(x)), 1e-300), np.diff(y) / max(float(np.ptp(y)), 1e-300))
        along = np.concatenate([[0.0], np.cumsum(lengths + 1e-9)])
        pieces = np.arange(PIECES * (len(x) - 1) + 1)
        fine = np.interp(pieces / PIECES, np.arange(len(x)), along)
        x, y = PchipInterpolator(along, x)(fine), PchipInterpolator(along, y)(fine)
        stable = stable[pieces // PIECES] & stable[-(-pieces // PIECES)]
    _line(axes, x, y, stable, colour, label)


def _eccentricity_error(point: CyclePoint | SpecialPoint, film: int) -> float:
    """Uncertainty of the largest eccentricity in a film, NaN where it is not known."""
    uncertainties = point.eccentricity_max_uncertainty
    return np.nan if uncertainties is None else float(uncertainties[film])


def _band(axes: Axes, branch: CycleBranch, y: Array, errors: Sequence[float], number: int) -> None:
    """The uncertainty of a branch, above and below it; none next to a fold that lies elsewhere on another mesh."""
    x, half = np.array([point.value for point in branch.points]), np.array(errors)
    known = np.isfinite(half)
    if known.any():
        wide = half[known].max() > SEEN * max(axes.get_ylim()[1], y.max())
        label = ERROR if wide and ERROR not in axes.get_legend_handles_labels()[1] else None
        axes.fill_between(x, y - half, y + half, where=known.tolist(), color=COLOURS[number % len(COLOURS)], alpha=BAND,
                          linewidth=0.0, label=label)  # fmt: skip


def _bars(axes: Axes, x: Sequence[float], y: Sequence[float], by_x: Sequence[float], by_y: Sequence[float]) -> None:
    """The uncertainties of special points, where they are known."""
    halves = [np.nan_to_num(np.array(errors, dtype=float)) for errors in (by_x, by_y)]
    if any(half.any() for half in halves):
        axes.errorbar(x, y, halves[1], halves[0], linestyle="", color=BLACK, linewidth=1.0, capsize=2.0, zorder=4)


def _whirls(axes: Axes, branch: CycleBranch, values: Sequence[float], number: int, in_legend: bool = True) -> None:
    """The whirls of a branch that have locked in with the unbalance, as dots."""
    colour, named = COLOURS[number % len(COLOURS)], in_legend and WHIRL not in axes.get_legend_handles_labels()[1]
    if values:
        axes.plot([whirl.speed_Hz for whirl in branch.with_unbalance], values, linestyle="", marker="o", markersize=3.2,
                  color=colour, label=WHIRL if named else None, clip_on=False, zorder=3)  # fmt: skip


def _line(axes: Axes, x: Array, y: Array, stable: Truths, colour: str, label: str | None) -> None:
    """A curve, solid where stable and dashed where not; a piece between the two belongs to the unstable part."""
    unstable = ~stable
    dashed = unstable | np.append(unstable[1:], False) | np.insert(unstable[:-1], 0, False)
    axes.plot(x, np.where(stable, y, np.nan), color=colour, linestyle=STABLE, label=label)
    axes.plot(x, np.where(dashed, y, np.nan), color=colour, linestyle=UNSTABLE)


HOPF_STYLES = {
    SUPERCRITICAL: (BLUE, "-", "Hopf points, soft"),
    SUBCRITICAL: (VERMILION, "-", "Hopf points, hard"),
    None: (GREY, "--", "Hopf points, soft or hard unknown"),
}
MAP_MARKS = {BAUTIN: ("o", "soft changes to hard"), CUSP: ("^", "cusp of folds")}
SHADE = "#f3e3d3"
MARGIN = 0.15  # of the range of the curves, on both sides


def stability_map_figure(chart: StabilityMap) -> Figure:
    """The curves with the first number to the right and the second one upwards; shaded where rest is unstable."""
    case = chart.case
    with styled():
        figure = new_figure(case.heading, "curves of Hopf points and folds of limit cycles")
        axes = figure.subplots()
        _shade(axes, chart)
        for curve in chart.curves:
            _map_curve(axes, curve)
        for kind, (marker, label) in MAP_MARKS.items():
            at = [(point.over, point.value) for point in chart.special if point.kind == kind]
            if at:
                over, values = zip(*at, strict=True)
                axes.plot(over, values, linestyle="", marker=marker, color=BLACK, markersize=4.5, label=label)
        axes.set(xlim=_limits(chart), ylim=(chart.growth.values[0], chart.growth.values[-1]))
        axes.set_xlabel("rotor speed in Hz" if chart.over == SPEED else name_of_key(chart.over, chart.over_unit))
        axes.set_ylabel(name_of_key(chart.key, chart.unit))
        _legend_once(axes)
        legend_below(figure, axes)
    return figure


def _limits(chart: StabilityMap) -> tuple[float, float]:
    """Where the curves and the marks are, with a margin, within the range of the map; all of it without any."""
    low, high = float(chart.growth.over[0]), float(chart.growth.over[-1])
    over = np.array([point.over for curve in chart.curves for point in curve.points]
                    + [point.over for point in chart.special])  # fmt: skip
    over = over[(low <= over) & (over <= high)]
    if not len(over) or not np.ptp(over) > 0.0:
        return low, high
    margin = MARGIN * float(np.ptp(over))
    return max(low, float(over.min()) - margin), min(high, float(over.max()) + margin)


def _shade(axes: Axes, chart: StabilityMap) -> None:
    """Where the static equilibrium is unstable."""
    grid = np.where(np.isnan(chart.growth.rate), -1.0, chart.growth.rate)
    if grid.max() > 0.0:
        axes.contourf(chart.growth.over, chart.growth.values, grid, levels=[0.0, grid.max()], colors=[SHADE])
        axes.fill([], [], color=SHADE, label="static equilibrium unstable")


def _map_curve(axes: Axes, curve: MapCurve) -> None:
    if curve.kind != "hopf":
        values = [point.value for point in curve.points]
        axes.plot([point.over for point in curve.points], values, color=GREEN, label="folds")
        return
    for one, other in itertools.pairwise(curve.points):
        colour, style, label = HOPF_STYLES[one.criticality if not one.kind else other.criticality]
        axes.plot([one.over, other.over], [one.value, other.value], color=colour, linestyle=style, label=label)


def _legend_once(axes: Axes) -> None:
    """Each label at its first line only."""
    known: set[str] = set()
    for line in axes.lines:
        label = str(line.get_label())
        if label in known:
            line.set_label("_nolegend_")
        known.add(label)
