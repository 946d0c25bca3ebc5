"""Signals of a run as curves. The motion of journals: displacements over time, eccentricities over time or rotor speed,
of one run or of several; and the orbit of a journal inside its clearance circle.

A panel for each quantity: what runs record of films, their oil, heat, pins and the axis. A subject is a row of
SUBJECTS.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from frbcli.analysis.signals import SignalColumn, SlicedColumn, films, joined, located, points
from frbcli.arrays import Array
from frbcli.columns import ZERO_CELSIUS
from frbcli.film.cavitation.table import laws, names
from frbcli.plot.curves import HEIGHT, Over, Span, curves_figure, draw_curves
from frbcli.plot.signals import MICRO, curve, cut, ends, envelope, heading, labels, motion, shell
from frbcli.plot.style import BAND, COLOURS, GREY, draw_bands, legend_below, new_figure, orbit_axes, styled
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.results.container import refuse
from frbcli.results.records import Signal, pieces
from frbcli.results.store import Run
from frbcli.runs.header import FILM_SIGNALS

Line = Any  # a line style of matplotlib: a name, or an offset and lengths of dashes

SIDES = ("inner", "outer")
PANEL_HEIGHT = 2.6  # inches
LAST_s = 0.1  # what is shown if no time is given
ALL_DRAWN = 300_000  # samples of an orbit up to which every step is drawn
CELLS = 600  # in each direction, about as many as the picture has pixels
PER_STEP = 5  # places of a step at which it is seen to touch a cell


def eccentricity_figure(
    runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """Relative eccentricity of each film, the runs overlaid, from from_time to to_time in s.

    Inner and outer films of floating rings have a panel each. Over speed, a run-down shows its hysteresis. Raises
    RunFileError if a run has no eccentricity.
    """

    def panel(side: str, names: list[str], axes: Axes) -> None:
        draw_eccentricity(axes, runs, names, (from_time, to_time), over)
        if side:
            axes.set_title(f"{side} film")

    panels = [partial(panel, *group) for group in _groups(runs[0])]
    return curves_figure(runs, panels, over, max(HEIGHT, 0.8 + PANEL_HEIGHT * len(panels)))


def draw_eccentricity(
    axes: Axes, runs: Sequence[Run], names: Sequence[str] = (), span: Span = (None, None), over: Over = "time"
) -> None:
    """The curves of some films, or of all, on axes of a figure, labelled with run and film where there are several."""
    names = names or list(films(runs[0].signals)) or [""]
    film_labels = [_without_side(name) if len(names) < len(list(films(runs[0].signals))) else name for name in names]
    curves = [
        (label.replace("_", " "), [run.signal(joined("eccentricity", name)) for run in runs])
        for label, name in zip(film_labels, names, strict=True)
    ]
    draw_curves(axes, runs, curves, over, span)
    axes.set(ylim=(0.0, 1.0), ylabel="eccentricity")


def draw_largest(axes: Axes, run: Run, film: str, colour: str, line: Line = "-", label: str = "") -> None:
    """The largest eccentricity of a film over time as a line, and down to the smallest one a faint band: whirls of
    several films would hide each other."""
    times, lowest, highest = envelope(run, run.signal(joined("eccentricity", film)))
    axes.fill_between(times, lowest, highest, color=colour, alpha=0.5 * BAND, linewidth=0.0)
    axes.plot(times, highest, color=colour, linestyle=line, label=label.replace("_", " "))
    axes.set(ylim=(0.0, 1.0), ylabel="largest eccentricity,\nband: down to the smallest")


def _groups(run: Run) -> list[tuple[str, list[str]]]:
    """The films of each panel: films inside of rings, films outside of rings, and all others."""
    all_films = list(films(run.signals)) or [""]
    groups = [(side, [name for name in all_films if name.split("_")[-1] == side]) for side in SIDES]
    groups.append(("", [name for name in all_films if name.split("_")[-1] not in SIDES]))
    return [(side, names) for side, names in groups if names]


def _without_side(name: str) -> str:
    return "_".join(word for word in name.split("_") if word not in SIDES)


def _distance(x: SignalColumn, y: SignalColumn) -> SlicedColumn:
    """The distance of a point from the axis, um."""
    return SlicedColumn(len(x), lambda first, last: MICRO * np.hypot(x[first:last], y[first:last]))


def _scaled(signal: SignalColumn, factor: float, offset: float) -> SlicedColumn:
    """A signal in another unit."""
    return SlicedColumn(len(signal), lambda first, last: factor * signal[first:last] + offset)


def draw_distances(axes: Axes, runs: Sequence[Run]) -> None:
    """The distances of all journals and disks from the axis, for machines without films."""
    nodes = [joined(kind, name) for kind in ("journal", "disk") for name in points(runs[0].signals, kind)]
    curves = [(node.replace("_", " "), [_distance(*motion(run, node)) for run in runs]) for node in nodes]
    draw_curves(axes, runs, curves, "time", (None, None))
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("distance in µm")


def displacement_figure(
    runs: Sequence[Run],
    signal: str | None = None,
    from_time: float | None = None,
    to_time: float | None = None,
) -> Figure:
    """x and y over time, the runs overlaid, from from_time to to_time in s.

    signal: "disk", "journal" or "journal_NAME" of a bearing; None takes the disk where every run has one.
    Raises RunFileError if a run lacks the signal.
    """
    node = signal or ("disk" if all(list(points(run.signals, "disk")) for run in runs) else "journal")
    title, subtitle = heading(runs)
    what = f"displacement of the {joined(*located(runs[0], node)).replace('_', ' ')}"
    with styled():
        figure = new_figure(title, ", ".join(text for text in (subtitle, what) if text), height=5.0)
        panels = figure.subplots(2, 1, sharex=True)
        for run, label in zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True):
            shown = cut(run, from_time, to_time)
            for axes, signal_there in zip(panels, motion(run, node), strict=True):
                time_s, values = curve(run, signal_there, *shown)
                axes.plot(time_s, values * MICRO, label=label, alpha=1.0 if len(runs) == 1 else 0.75)
        for axes, name in zip(panels, "xy", strict=True):
            axes.set_ylabel(f"{name} in µm")
            axes.margins(x=0.0)
        panels[1].set_xlabel("time in s")
        legend_below(figure, panels[0])
    return figure


def orbit_figure(runs: Sequence[Run], from_time: float | None = None, to_time: float | None = None) -> Figure:
    """Orbits of all journals from from_time to to_time in s (default: the last 0.1 s), one panel per bearing.

    A dot marks where an orbit begins. Raises RunFileError if a run has no samples between these times.
    """
    bearings = list(points(runs[0].signals, "journal")) or [""]
    end = min(ends(run)[1] for run in runs) if to_time is None else to_time
    begin = max(end - LAST_s, 0.0) if from_time is None else from_time
    title, subtitle = heading(runs)
    span = f"orbit from {begin:.4g} s to {end:.4g} s"
    with styled():
        figure = new_figure(title, ", ".join(text for text in (subtitle, span) if text), 4.8 * len(bearings), 5.2)
        for axes, bearing in zip(figure.subplots(1, len(bearings), squeeze=False)[0], bearings, strict=True):
            axes.set_title(bearing)
            draw_orbits(axes, runs, bearing, (begin, end))
        legend_below(figure, axes)
    return figure


def draw_orbits(axes: Axes, runs: Sequence[Run], bearing: str, span_s: tuple[float, float]) -> None:
    """The orbits of the journal of a bearing within a span of time in s, with its clearance."""
    widest = 0.0
    circles: set[float] = set()
    for number, (run, label) in enumerate(zip(runs, labels(runs) if len(runs) > 1 else [""], strict=True)):
        first, last = cut(run, *span_s)
        signals = motion(run, joined("journal", bearing))
        colour = COLOURS[number % len(COLOURS)]
        x, y = (values * MICRO for values in visible_steps(*signals, first, last))
        axes.plot(x, y, color=colour, linewidth=0.9, label=label)
        axes.plot(x[:1], y[:1], color=colour, marker="o", markersize=4.0)
        room = shell(run, bearing)
        if room is not None:
            circles.add(room * MICRO)
        widest = max(widest, *circles, _reach(*signals, first, last) * MICRO)
    for radius in circles:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=GREY, linewidth=1.2))
    if circles:
        words = ", ".join(f"{radius:.4g}" for radius in sorted(circles))
        axes.text(0.02, 0.98, f"grey: clearance\n{words} µm", transform=axes.transAxes, va="top", color=GREY)
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.axvline(0.0, color=GREY, linewidth=0.5)
    orbit_axes(axes, 1.12 * widest)


def _reach(x: Signal, y: Signal, first: int, last: int) -> float:
    """The largest distance from the centre."""
    return max(float(np.max(np.hypot(x[start:stop], y[start:stop]))) for start, stop in pieces(first, last))


def visible_steps(x: Signal, y: Signal, first: int, last: int) -> tuple[Array, Array]:
    """x and y (k,) of an orbit from one sample to before another: of a long one only the steps that touch a part of the
    picture that no step before has touched, apart from each other by NaN."""
    if last - first <= ALL_DRAWN:
        return x[first:last], y[first:last]
    reach = _reach(x, y, first, last) or 1.0
    touched = np.zeros((CELLS, CELLS), dtype=bool)
    kept = []
    for start, stop in pieces(first, last - 1):
        steps = np.stack([np.stack([signal[start:stop], signal[start + 1 : stop + 1]]) for signal in (x, y)])
        places = steps[:, :1] + np.linspace(0.0, 1.0, PER_STEP)[:, None] * np.diff(steps, axis=1)  # (2, PER_STEP, m)
        column, row = ((0.5 + 0.5 * places / reach) * (CELLS - 1)).astype(np.int64)
        cells = CELLS * row + column
        fresh = ~touched.ravel()[cells]
        # of the steps of this piece that touch the same fresh part, the first one
        _, earliest = np.unique(cells.T[fresh.T], return_index=True)
        chosen = np.unique(np.nonzero(fresh.T)[0][earliest])
        touched.ravel()[cells[:, chosen]] = True
        gaps = np.full((2, 1, len(chosen)), np.nan)
        kept.append(np.concatenate([steps[:, :, chosen], gaps], axis=1).transpose(0, 2, 1).reshape(2, -1))
    drawn = np.concatenate(kept, axis=1)
    return drawn[0], drawn[1]


WALLS = {"ring", "shaft", "housing"}
QUANTITY_HEIGHT = 2.4  # inches


@dataclass(frozen=True)
class Panel:
    """One quantity. begin, end: of the names of its signals, with the name of a film, ring or wall in between; label:
    of the axis, in whose unit the signals are times `factor` plus `offset`; low, high: ends of the axis, None for the
    range of the curves; uncertainty: its key in the error of a run."""

    begin: str
    end: str
    label: str
    factor: float = 1.0
    offset: float = 0.0
    low: float | None = None
    high: float | None = None
    uncertainty: str = ""

    def signals(self, run: Run) -> dict[str, str]:
        """The signals of a run by the name of the film, ring or wall in them."""
        names = (name for name in run.signals if name.startswith(self.begin) and name.endswith(self.end))
        return {name.removeprefix(self.begin).removesuffix(self.end).strip("_"): name for name in names}


@dataclass(frozen=True)
class Subject:
    """Quantities that are drawn together. missing, remedy: message for a run without them, with the mass-conserving
    models as {models}; alone: name of a signal with nothing between; height: in inches, None: the sum of its panels."""

    panels: tuple[Panel, ...]
    missing: str
    remedy: str
    alone: str = ""
    height: float | None = None


def _of_films(kind: str, *panels: Panel, remedy: str = "") -> Subject:
    """A kind of FILM_SIGNALS."""
    words = FILM_SIGNALS[kind][0].replace("_", " ")
    return Subject(
        panels, f"has not recorded {words}.", remedy or f"Run the case with --set 'output.signals=[\"{kind}\"]'."
    )


SUBJECTS = {
    "force": _of_films("force", *(Panel("film_force", f"_{axis}_N", f"force {axis} in N") for axis in "xy")),
    "film-thickness": _of_films(
        "film-thickness", Panel("film_thickness", "_m", "film thickness in µm", 1e6, low=0.0)
    ),
    "power": _of_films("power", Panel("power", "_W", "power in W")),
    "torque": _of_films("torque", Panel("torque", "_N_m", "torque on the journal in N mm", 1e3)),
    "oil-flow": _of_films("oil-flow", Panel("oil_flow", "_m3_s", "oil flow in cm³/s", 1e6)),
    "asperity-share": _of_films(
        "asperity-share", Panel("asperity_share", "", "share of the load on asperities")
    ),
    "contact-power": _of_films(
        "contact-power", Panel("contact_power", "_W", "friction power of the contact in W")
    ),
    "tilt": _of_films(
        "tilt", *(Panel("tilt", f"_{axis}_rad", f"tilt about {axis} in mrad", 1e3) for axis in "xy"),
        remedy="Run the case with --set film.tilt=follows.",
    ),
    "supply-pressure": _of_films(
        "supply-pressure", Panel("supply_pressure", "_Pa", "pressure of the supply in bar", 1e-5),
        remedy="Its supplies keep their pressure; give one a flow, or a pressure over time.",
    ),
    "oil-content": Subject(
        (Panel("oil_fraction", "", "oil fraction", high=1.02),),
        "has no oil fraction.", "Run the case with a mass-conserving model: {models}.",
    ),
    "heat": Subject(
        (
            Panel("temperature", "_K", "temperature in degC", 1.0, -ZERO_CELSIUS,
                  uncertainty="temperature_uncertainty_K"),
            Panel("viscosity", "_Pa_s", "viscosity in mPa s", 1e3),
            Panel("power", "_W", "loss in W", uncertainty="power_uncertainty_W"),
            Panel("flow", "_m3_s", "side flow in l/min", 6e4),
        ),
        "has no such heat.", "Draw a run of a case with [thermal].", "film", 9.0,
    ),
    "pin": Subject(
        (
            Panel("pin_angle", "_rad", "angle of the ring in mrad", 1e3),
            Panel("pin_torque", "_N_m", "torque of the pin in N mm", 1e3),
        ),
        "has no ring with a pin.", "Draw a run of a case with [bearing.pin].",
    ),
    "axial": Subject(
        tuple(
            Panel(column.name, "", label, factor)
            for column, label, factor in zip(
                AXIAL_SIGNALS, ("axial position in µm", "thrust film in µm", "thrust loss in W"), (1e6, 1e6, 1.0),
                strict=True,
            )
        ),
        "has no axis.", "Draw a run of a case with [[thrust_bearing]] and [axial].", "collar", 6.5,
    ),
}  # fmt: skip


def quantity_figure(
    runs: Sequence[Run], what: str, from_time: float | None = None, to_time: float | None = None, over: Over = "time"
) -> Figure:
    """A subject of SUBJECTS, the runs overlaid, from from_time to to_time in s. Raises RunFileError if a run has not
    recorded it."""
    subject, span = SUBJECTS[what], (from_time, to_time)
    panels = [
        partial(draw_quantity, runs=runs, what=what, part=part, over=over, span=span)
        for part in range(len(subject.panels))
    ]
    return curves_figure(runs, panels, over, subject.height or max(HEIGHT, 0.8 + QUANTITY_HEIGHT * len(panels)))


def draw_quantity(
    axes: Axes, runs: Sequence[Run], what: str, part: int = 0, over: Over = "time", span: Span = (None, None)
) -> None:
    """The curves of a panel of a subject on axes of a figure; of one run with bands of their uncertainties. Raises as
    quantity_figure."""
    subject = SUBJECTS[what]
    panel = subject.panels[part]
    wanted = panel.signals(runs[0])
    for run in runs:
        if not wanted or any(name not in run.signals for name in wanted.values()):
            models = ", ".join(names(law for law in laws() if law.keeps_oil))
            raise refuse(run.path, subject.missing, subject.remedy.format(models=models))
    curves = [
        (place.replace("_", " ") or subject.alone,
         [_scaled(run.signal(name), panel.factor, panel.offset) for run in runs])
        for place, name in wanted.items()
    ]  # fmt: skip
    draw_curves(axes, runs, curves, over, span)
    if what == "heat" and len(runs) == 1:  # several are distinguished by their lines
        _part(axes)
        draw_bands(axes, runs[0].error.get(panel.uncertainty))
    if panel.low is not None or panel.high is not None:
        axes.set_ylim(panel.low, panel.high)
    axes.set_ylabel(panel.label)


def _part(axes: Axes) -> None:
    """Rings dashed and walls dotted, in the colours of the films that they touch."""
    words = {line: str(line.get_label()).split() for line in axes.lines}
    films = {tuple(named): line.get_color() for line, named in words.items() if not WALLS & set(named)}
    for line, named in words.items():
        if walls := WALLS & set(named):
            place = tuple(word for word in named if word not in WALLS)
            side = "outer" if "housing" in walls else "inner"
            line.set_color(films.get(place, films.get((*place, side), line.get_color())))
            line.set_linestyle("--" if "ring" in walls else ":")
