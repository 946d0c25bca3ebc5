"""Several models of the films in one picture: eccentricities overlaid, and their events."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.signals import films, joined
from frbcli.case.course.speed import given_speed_unit
from frbcli.film.cavitation.table import label_of
from frbcli.plot.run.envelope import curve
from frbcli.plot.signals import ends
from frbcli.plot.style import COLOURS, MOST_MARKED, new_figure, styled
from frbcli.results.columns import touching_name
from frbcli.results.store import Run
from frbcli.studies.compare import Comparison, Variant

Line = Any  # a line style of matplotlib: a name, or an offset and lengths of dashes

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
                drawn = curve(run, run.signal(joined("eccentricity", film)))
                above.plot(*drawn, color=colour, linestyle=line, alpha=0.75)
            _draw_events(below, run, row, colour, line)
        above.set_ylim(0.0, 1.0)
        above.set_ylabel("eccentricity")
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
    unit = given_speed_unit(run.case_text)
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
