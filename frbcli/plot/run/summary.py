"""Summary of a run: eccentricity or distance with its events, waterfall, rotor speed."""

from __future__ import annotations

import itertools
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from frbcli.analysis.orders.subsynchronous import whirl_names
from frbcli.analysis.signals import films, joined, points
from frbcli.case.course.run import speed_unit_of
from frbcli.plot.run.motion import draw_distances, draw_eccentricity
from frbcli.plot.signals import curve, ends, events, heading, is_searchable, uncertain_times
from frbcli.plot.style import (
    BAND,
    BLACK,
    GREY,
    MOST_MARKED,
    SKY,
    draw_bands,
    legend_beside,
    mark_times,
    new_figure,
    set_title,
    styled,
)
from frbcli.plot.waterfall import draw_levels, level_label, reading, run_spectra
from frbcli.results.columns import touching_name
from frbcli.results.records import SPEED
from frbcli.results.store import Run
from frbcli.units import SpeedUnit

SIGNAL = "journal"
FEWEST_SAMPLES = 64  # for a spectrum; a run that ends before has none

NAMES = {
    "critical-speed": "critical speed",
    "self-excited": "self-excited",
    "onset": "onset of whirl",
    "offset": "end of whirl",
    "lock-in": "lock-in",
    "contact": "contact",
    "clearance-step": "clearance step",
    "loss": "loss",
    "forced": "forced",
    "top-speed": "top speed",
    "standstill": "standstill",
}


def summary_figure(run: Run) -> Figure:
    """Eccentricity, or without films the distance of all points, with the events marked, waterfall of the journal and
    rotor speed over one time axis. Bands about the events are their uncertainties, where the run has them.

    Raises RunFileError if the run holds no samples.
    """
    begin, end = ends(run)
    title, subtitle = heading([run])
    marked = _marks(events(run), speed_unit_of(run))
    words = [subtitle]
    if not run.events and not is_searchable(run):
        words.append("too long for a search for events")
    if len(marked) > MOST_MARKED:
        words.append(f"the first {MOST_MARKED} of {len(marked)} events")
    bands = uncertain_times(run)
    if bands:
        words.append("bands: uncertainty of the events")
    with styled():
        figure = new_figure(title, ", ".join(word for word in words if word), height=7.6)
        above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 4.0, 1.4))
        draw = draw_eccentricity if any(True for _ in films(run.signals)) else draw_distances
        draw(above, [run])
        above.set_xlim(begin, end)
        legend_beside(above)
        if len(run) >= FEWEST_SAMPLES:
            spectra = run_spectra(run, SIGNAL, None, "x")
            mesh = draw_levels(middle, run, SIGNAL, spectra, "time")
            bar = figure.colorbar(mesh, ax=[above, middle, below], location="bottom", shrink=0.6, pad=0.02,
                                  extend="both", aspect=40)  # fmt: skip
            label = level_label(run, SIGNAL).replace("amplitude", "amplitude of the journal")
            bar.set_label(f"{label}; {reading(spectra)}".replace(": ", ":\n"))  # one line is wider than the picture
            bar.outline.set_visible(False)
        _draw_speed(below, run)
        for axes in (above, middle):
            axes.set_xlabel("")
        marked = marked[:MOST_MARKED]
        for axes in (above, middle):
            for time, half in bands:
                axes.axvspan(time - half, time + half, color=GREY, alpha=BAND, linewidth=0.0)
        left_out = mark_times((above, middle), [time for time, _ in marked], [text for _, text in marked])
        if left_out:
            words.append(f"{left_out} of {len(marked)} events have no room for their names")
            set_title(figure, title, ", ".join(word for word in words if word))
    return figure


def _draw_speed(axes: Axes, run: Run) -> None:
    rings = [name for name in points(run.signals, "ring") if joined("ring_speed", name, "Hz") in run.signals]
    for name, colour in zip(rings, itertools.cycle((GREY, SKY)), strict=False):
        label = ", ".join(word for word in ("ring", name) if word)
        axes.plot(*curve(run, run.signal(joined("ring_speed", name, "Hz"))), color=colour, label=label)
    draw_bands(axes, run.error.get("ring_speed_uncertainty_Hz"))
    axes.plot(*curve(run, run.signal(SPEED)), color=BLACK, label="rotor")
    legend_beside(axes)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time in s")
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.set_ylabel("speed in Hz")


def _marks(happened: list[dict[str, Any]], unit: SpeedUnit) -> list[tuple[float, str]]:
    """Time and words of what is marked; of the whirls of floating rings the first onset of each that has a name."""
    marks, known = [], set()
    for event, name in zip(happened, whirl_names(happened), strict=True):
        if not name:
            marks.append((event["t_s"], _words(event, unit)))
        elif event["kind"] == "onset" and name not in known:
            known.add(name)
            shown = name.replace("_i", "$_i$").replace("_o", "$_o$")
            marks.append((event["t_s"], _words(event | {"kind": shown}, unit)))
    return marks


def _words(event: dict[str, Any], unit: SpeedUnit) -> str:
    """Label of an event: kind or who touches what, speed, frequency."""
    film = f" {event['film'].replace('_', ' ')}" if event.get("film") else ""
    name = touching_name(event) or f"{NAMES.get(event['kind'], event['kind'])}{film}"
    ratio = event.get("frequency_ratio")
    share = f", {ratio:.2f}X" if ratio is not None and ratio != 1.0 else ""
    return f"{name}\n{unit.words(event['speed_Hz'], 1)}{share}"
