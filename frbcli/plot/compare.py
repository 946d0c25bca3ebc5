"""Several models of the films in one picture: eccentricities overlaid, and how far each is from the first."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.analysis.compare import Comparison, VariantResult
from frbcli.plot.signals import CAVITATION_NAMES, suffixes, thin, times
from frbcli.plot.style import COLOURS, new_figure, styled

LINES = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.5, 1.5, 1.5)))
MARKS = {"critical-speed": "o", "onset": "^", "offset": "v", "contact": "X"}
MARK_NAMES = {"critical-speed": "critical", "onset": "whirl from", "offset": "whirl until", "contact": "contact at"}
ROW_HEIGHT = 0.06  # of an event's mark above the axes, relative to them


def comparison_figure(comparison: Comparison) -> Figure:
    """Eccentricity over time and rotor speed, one colour and line style per variant, its events marked above.

    Raises RunFileError if a run holds no samples.
    """
    count = len(comparison.results)
    with styled():
        figure = new_figure(comparison.case.title or comparison.case.name, "films compared", height=4.6 + 0.25 * count)
        axes = figure.subplots()
        for row, result in enumerate(comparison.results):
            _draw(axes, result, row)
        time_s = times(comparison.results[0].run)
        axes.set_xlim(time_s[0], time_s[-1])
        axes.set_ylim(0.0, 1.0)
        axes.set_xlabel("time in s")
        axes.set_ylabel("eccentricity")
        figure.legend(loc="outside lower left", fontsize=8.0)
    return figure


def _draw(axes: Axes, result: VariantResult, row: int) -> None:
    run, colour, line = result.run, COLOURS[row % len(COLOURS)], LINES[row % len(LINES)]
    label: str | None = _words(result)
    for suffix in suffixes(run, "eccentricity"):
        axes.plot(*thin(times(run), run["eccentricity" + suffix]), color=colour, linestyle=line, label=label, alpha=0.75)
        label = None  # the legend names a variant once
    for event in run.events:
        axes.axvline(event["t_s"], color=colour, linestyle=line, linewidth=0.8)


def _words(result: VariantResult) -> str:
    """A variant and its events, for the legend."""
    variant = result.variant
    name = f"{CAVITATION_NAMES.get(variant.cavitation, variant.cavitation)}, {variant.theory} bearing"
    events = [f"{MARK_NAMES[event['kind']]} {event['speed_Hz']:.1f} Hz" for event in result.run.events]
    return ": ".join(text for text in (name, ", ".join(events)) if text)
