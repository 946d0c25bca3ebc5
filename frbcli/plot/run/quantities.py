"""Signals of a run as curves, a panel for each quantity: what runs record of films, their oil, heat, pins and the axis.

A subject is a row of SUBJECTS.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frbcli.columns import ZERO_CELSIUS
from frbcli.film.cavitation.table import laws, names
from frbcli.plot.curves import HEIGHT, Over, ScaledSignal, Span, curves_figure, draw_curves
from frbcli.plot.style import draw_bands
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.results.container import refuse
from frbcli.results.store import Run
from frbcli.runs.header import FILM_SIGNALS

WALLS = {"ring", "shaft", "housing"}
PANEL_HEIGHT = 2.4  # inches


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
    return curves_figure(runs, panels, over, subject.height or max(HEIGHT, 0.8 + PANEL_HEIGHT * len(panels)))


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
         [ScaledSignal(run.signal(name), panel.factor, panel.offset) for run in runs])
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
