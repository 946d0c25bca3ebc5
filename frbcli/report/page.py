"""The report of a run: one page that needs nothing else, neither files nor a network.

The waterfall of a page: an image with axes of its own, and the numbers that the page's script reads out.
"""

from __future__ import annotations

import base64
import datetime
import json
import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from frbcli import __version__
from frbcli.analysis.signals import films
from frbcli.analysis.subsynchronous import with_whirl_names
from frbcli.arrays import Array
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case_text
from frbcli.case.run import speed_unit_of
from frbcli.errors import FrbError, input_error, printable
from frbcli.plot import style as plot_style
from frbcli.plot.motion import SUBJECTS, displacement_figure, eccentricity_figure, quantity_figure
from frbcli.plot.signals import bearing_of, clearance, ends, events, heading
from frbcli.plot.style import Picture, narrowed
from frbcli.plot.summary import FEWEST_SAMPLES, ring_speed_figure, speeds_figure, times_of_speeds
from frbcli.plot.waterfall import (
    Levels,
    LEVELS_dB,
    LOWEST_dB,
    STEP_dB,
    level_label,
    levels,
    reading,
    run_spectra,
    scale_colours,
    ticks,
)
from frbcli.report.sketch import curve, drawing, element, film_sketches, line, rotor_sketch, text
from frbcli.results.columns import amplitude_text, event_name, frequency_text
from frbcli.results.records import SPEED
from frbcli.results.store import Run
from frbcli.results.write import MARK, PAGE, require_places, write
from frbcli.runs.header import FILM_SIGNALS, POWER
from frbcli.runs.second_run import about_certainty, account, grows_late
from frbcli.scene.machine.findings import findings
from frbcli.scene.planning.plan import make_plan
from frbcli.units import HERTZ, SpeedUnit

WIDTH, HEIGHT = 900.0, 500.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 90.0, 84.0, 46.0
FLAG_ROWS, FLAG_ROW = 4, 16.0  # of the numbers of events above the picture
BAR, BAR_WIDTH = WIDTH - RIGHT + 18.0, 14.0
FLAG = 7.5  # radius of the number of an event


@dataclass(frozen=True)
class Waterfall:
    """svg: the picture; data: JSON for the script, see waterfall.js."""

    svg: str
    data: str


def page_waterfall(
    spectra: Levels, clearance: float, events: Sequence[dict[str, Any]], unit: SpeedUnit = HERTZ
) -> Waterfall:
    """The waterfall of the levels of a run over the clearance in m; events: of the run, numbered from 1 on; unit: of
    the rotor speeds above it."""
    return Waterfall(_picture(spectra, events, unit), _numbers(spectra, clearance))


def _numbers(spectra: Levels, clearance: float) -> str:
    """Times and speeds per column, frequencies per row and levels as bytes, row by row."""
    return json.dumps(
        {
            "box": [LEFT, TOP, WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM],
            "times": [round(float(value), 5) for value in spectra.time_s],
            "speeds": [round(float(value), 4) for value in spectra.speed_Hz],
            "frequencies": [round(float(value), 4) for value in spectra.frequency_Hz],
            "lowest": LOWEST_dB,
            "step": STEP_dB,
            "clearance": clearance,
            "levels": base64.b64encode(spectra.level.tobytes()).decode(),
        }
    )


def _picture(spectra: Levels, events: Sequence[dict[str, Any]], unit: SpeedUnit) -> str:
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    begin, end = _edges(spectra.time_s)
    top_Hz = _edges(spectra.frequency_Hz)[1]

    def across(t: float) -> float:
        return LEFT + (right - LEFT) * (t - begin) / (end - begin)

    def up(f: float) -> float:
        return bottom - (bottom - TOP) * f / top_Hz

    picture = base64.b64encode(spectra.image).decode()
    parts = [
        element(
            "image", x=LEFT, y=TOP, width=right - LEFT, height=bottom - TOP, preserveAspectRatio="none",
            href=f"data:image/png;base64,{picture}",
        )
    ]  # fmt: skip
    for name, frequency in spectra.lines:
        shown = [(across(t), up(f)) for t, f in zip(spectra.time_s.tolist(), np.abs(frequency).tolist(), strict=True)]
        inside = [point for point in shown if point[1] >= TOP][:: max(1, len(shown) // 200)]
        if len(inside) > 1:
            parts.append(curve(inside, "order"))
            x, y = inside[int(0.86 * len(inside))]
            label = re.sub("_(.)", r'<tspan font-size="9" dy="3">\1</tspan><tspan dy="-3">&#8203;</tspan>', name)
            parts.append(element("text", label, x=x - 4.0, y=y - 5.0, kind="ordername", text_anchor="end"))
    for t in ticks(begin, end):
        parts.append(line(across(t), bottom, across(t), bottom + 4.0, "tick"))
        parts.append(text(across(t), bottom + 16.0, f"{t:g}"))
        speed = float(np.interp(t, spectra.time_s, spectra.speed_Hz))
        parts.append(text(across(t), TOP - 8.0, unit.number(speed), "small"))
    for f in ticks(0.0, top_Hz):
        parts.append(line(LEFT - 4.0, up(f), LEFT, up(f), "tick"))
        parts.append(text(LEFT - 8.0, up(f) + 4.0, f"{f:g}", anchor="end"))
    parts.append(text(0.5 * (LEFT + right), HEIGHT - 8.0, "time in s"))
    parts.append(text(LEFT - 8.0, TOP - 8.0, f"rotor, {unit.name}", "small", "end"))
    parts.append(
        element("text", "frequency in Hz", kind="label", text_anchor="middle",
                transform=f"translate(16 {0.5 * (TOP + bottom):.0f}) rotate(-90)")
    )  # fmt: skip
    parts += _bar(bottom)
    parts += _flags(events, across, bottom, (begin, end))
    parts.append(element("g", id="pointer"))
    width, height = right - LEFT, bottom - TOP
    parts.append(element("rect", x=LEFT, y=TOP, width=width, height=height, id="sense", fill="transparent"))
    return drawing(WIDTH, HEIGHT, parts, "waterfall: amplitude over time and frequency")


def _bar(bottom: float) -> list[str]:
    """The scale of the levels."""
    colours = scale_colours()
    low, high = LEVELS_dB
    step = (bottom - TOP) / len(colours)
    parts = [
        element("rect", x=BAR, y=bottom - (i + 1) * step, width=BAR_WIDTH, height=step + 0.5, fill=colour)
        for i, colour in enumerate(colours)
    ]
    for level in ticks(low, high, 6):
        y = bottom - (bottom - TOP) * (level - low) / (high - low)
        parts.append(line(BAR + BAR_WIDTH, y, BAR + BAR_WIDTH + 4.0, y, "tick"))
        parts.append(text(BAR + BAR_WIDTH + 7.0, y + 4.0, f"{level:g}", anchor="start"))
    parts.append(text(BAR + 0.5 * BAR_WIDTH, bottom + 16.0, "dB"))
    return parts


def _flags(events: Sequence[dict[str, Any]], across: Any, bottom: float, span: tuple[float, float]) -> list[str]:
    """Numbered lines of the events; numbers that would meet move to a higher row, and where all rows are full the
    line has none."""
    lines, flags, free = list[str](), list[str](), [-1e9] * FLAG_ROWS
    for number, event in enumerate(events, start=1):
        if not span[0] <= event["t_s"] <= span[1]:
            continue
        x = across(event["t_s"])
        row = next((row for row, until in enumerate(free) if x - FLAG > until), None)
        if row is None:
            lines.append(line(x, TOP, x, bottom, "event"))
            continue
        free[row] = x + FLAG
        y = TOP - 26.0 - FLAG_ROW * row
        lines.append(line(x, y + FLAG, x, bottom, "event"))
        flags.append(element("circle", cx=x, cy=y, r=FLAG, kind="flag"))
        flags.append(text(x, y + 3.5, str(number), "flagname"))
    return lines + flags


def _edges(middles: Array) -> tuple[float, float]:
    """From the beginning of the first to the end of the last of even spans, by their middles."""
    half = 0.5 * float(middles[-1] - middles[0]) / max(len(middles) - 1, 1)
    return float(middles[0]) - half, float(middles[-1]) + half


MOST_EVENTS = 60  # of the table and the picture
CHOSEN = 4  # moments of orbits and spectra, where none are asked for
SPEEDS_NOTE = "Orbits of the last revolutions before a moment, and the spectrum about it."
NARROW_COLUMNS = 2  # of the legends of narrow pictures
NARROW = 4.9  # inches: the width of one of two pictures side by side
COURSES = {
    "pin": "Angle of the rings with a pin, and its torque on them.",
    "oil-content": "Oil fraction of the films.",
    "heat": "Temperatures, viscosities, losses and side flows.",
    "axial": "Axial position, films and loss of the thrust bearing.",
}
TEXTS = ("page.html", "style.css", "waterfall.js")


@dataclass(frozen=True)
class ShownRun:
    """A picture as a data URI, and what it shows."""

    data: str
    caption: str


def write_report(
    run: Run, path: str | Path, speeds_Hz: Sequence[float] = (), signal: str = "journal", author: str = "",
    both_units: bool = False, force: bool = False,
) -> Path:  # fmt: skip
    """Write the page of a run.

    Parameters
    ----------
    run : Run
        A run, see `read_run`, `runup` and `measured_run`.
    path : str or Path
        An HTML file, which holds all that it shows.
    speeds_Hz : sequence of float
        Rotor speeds in Hz at which spectra and orbits are shown.
    signal : str
        The point: "journal", "disk", or the name of a bearing or disk.
    author : str
        Who made it, for the line on top, which also has the date and the version.
    both_units : bool
        Rotor speeds in Hz and in rpm; without it in rpm where the case gives them so, else in Hz.
    force : bool
        Also replace a file that frb did not write.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the run does not have the point or a speed, or the file cannot be written.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> frbcli.write_report(run, "run.html")  # doctest: +SKIP
    """
    path = Path(path)
    require_places([(path, PAGE)], force=force)
    write(path, PAGE, report(run, speeds_Hz, signal, author, both_units), force)
    return path


def report(
    run: Run, speeds_Hz: Sequence[float] = (), signal: str = "journal", author: str = "", both_units: bool = False
) -> str:
    """The page as HTML. speeds_Hz: of orbits and spectra, by default at the events and the last one; signal: of
    waterfall, orbits and spectra, as in `frb waterfall`; author and both_units: see write_report.

    Raises RunFileError for a run without samples, InputError for a speed that the run does not reach.
    """
    end = ends(run)[1]
    shown = with_whirl_names(events(run)[:MOST_EVENTS])
    unit = replace(speed_unit_of(run), both=both_units)
    spectra = run_spectra(run, signal, None, "x") if len(run) >= FEWEST_SAMPLES else None
    waterfall: Waterfall | None = None
    if spectra is not None and min(spectra.level_dB.shape) > 1:  # else it has no area
        room = clearance(run, bearing_of(run, signal))
        waterfall = page_waterfall(levels(run, signal, spectra), room, shown, unit)
    times = _moments(run, speeds_Hz, shown, end)
    title, words = heading([run])
    environment = Environment(
        loader=PackageLoader("frbcli.report", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    style, script = (Markup(_text(environment, name)) for name in TEXTS[1:])
    return environment.get_template(TEXTS[0]).render(
        mark=MARK,
        title=printable(title),
        subtitle=printable(", ".join(word for word in (run.command.replace("run", "run-"), words, run.status) if word)),
        made=printable(", ".join(word for word in (_today(), f"frb {__version__}", author) if word)),
        style=style,
        script=script,
        cards=_cards(run, shown, unit),
        events=[_event(number, event, unit) for number, event in enumerate(shown, start=1)],
        certainty=about_certainty(run, shown, unit),
        speed_unit=unit.head,
        waterfall=None if waterfall is None else Waterfall(Markup(waterfall.svg), Markup(waterfall.data)),
        waterfall_note="" if spectra is None else _note(run, signal, reading(spectra)),
        courses=_courses(run),
        speeds=None if spectra is None else _shown(speeds_figure(run, times, spectra, signal, unit.words), SPEEDS_NOTE),
        account=account(run) if run.cost and run.error else [],
        file=f"{run.case_name or 'case'}.toml",
        commands=_commands(run),
        versions=printable(", ".join(f"{name} {version}" for name, version in run.versions.items())),
        case_text=run.case_text,
        **_machine(run),
    )


def _machine(run: Run) -> dict[str, Any]:
    """The case on the page, as far as its text is one of this version."""
    nothing: dict[str, Any] = {
        "sketch": "", "sketch_note": "", "films": (), "mass": "", "loads": (), "values": (), "plan": (), "problem": "",
    }  # fmt: skip
    try:
        case = load_case_text(run.case_text, name=run.case_name)
        static, plan, (sketch, note) = findings(case), make_plan(case), rotor_sketch(case)
    except FrbError as error:
        return nothing | {"problem": f"The case of this run is not read by this version: {printable(str(error))}"}
    return nothing | {
        "sketch": Markup(sketch),
        "sketch_note": note,
        "films": [(name.replace("_", " "), Markup(drawing)) for name, drawing in film_sketches(case)],
        "mass": static.rotor,
        "loads": [_load(each) for each in static.films],
        "values": [(each.key, *each.cells) for each in values(case)],
        "plan": [(each.choice, each.value, each.reason) for each in plan.decisions],
    }


def _load(film: Any) -> tuple[str, ...]:
    number = "-" if np.isnan(film.sommerfeld_number) else f"{film.sommerfeld_number:.3g}"
    return (film.film or "film", f"{film.load:.4g}", f"{1e-5 * film.mean_pressure:.3g}", number, film.supply)


def _today() -> str:
    return datetime.datetime.now(tz=datetime.UTC).astimezone().date().isoformat()


def _cards(run: Run, shown: Sequence[dict[str, Any]], unit: SpeedUnit) -> list[tuple[str, str]]:
    """The figures that are asked for first."""
    fastest = max(float(np.max(np.abs(run[SPEED]))), 0.0)
    cards = [(unit.words(fastest, 1), "highest speed")]
    for kind, words in (("critical-speed", "critical speed"), ("onset", "onset of whirl")):
        first = next((event for event in shown if event["kind"] == kind), None)
        if first is None:
            cards.append(("none", words))
            continue
        ratio = first["frequency_ratio"]
        share = "" if ratio in (None, 1.0) else f", {ratio:.3f}X"
        cards.append((unit.words(first["speed_Hz"], 1), words + share))
    eccentricities = [float(np.max(run[name])) for name in run.signals if name.startswith("eccentricity")]
    if eccentricities:
        cards.append((f"{max(max(eccentricities), 0.0):.3f}", "largest eccentricity"))
    if run.error.get("eccentricity") is not None:
        until = f", until {run.error['quiet_until_s']:.3g} s" if "quiet_until_s" in run.error else ""
        words = f"stated error of the eccentricity{until}{grows_late(run.error)}"
        cards.append((f"{run.error['eccentricity']:.1e}", words))
    if "cpu_s" in run.cost:
        cards.append((f"{run.cost['cpu_s']:.3g} s", "CPU time"))
    return cards


def _event(number: int, event: dict[str, Any], unit: SpeedUnit) -> tuple[str, ...]:
    def cell(key: str, form: str) -> str:
        return "-" if event[key] is None else format(event[key], form)

    speed = unit.cell(event["speed_Hz"], event.get("speed_uncertainty_Hz"))
    return (str(number), event_name(event), cell("t_s", ".3f"), speed, frequency_text(event),
            cell("frequency_ratio", ".3f"), amplitude_text(event))  # fmt: skip


def _note(run: Run, signal: str, words: str) -> str:
    label = level_label(run, signal).replace("C$_i$ + C$_o$", "Cᵢ + Cₒ")
    point = signal.replace("_", " ")
    return f"{label[:1].upper()}{label[1:]}, x of the {point}; {words}. Numbers refer to the events."


def _courses(run: Run) -> list[ShownRun]:
    """Pictures over time of all that the run holds."""
    figures = [(displacement_figure([run]), "Displacement.")]
    if any(True for _ in films(run.signals)):
        figures = [(eccentricity_figure([run]), "Eccentricity.")]
    if any(name.startswith("ring_speed") for name in run.signals):
        figures.append((ring_speed_figure([run]), "Speed of the rings over the rotor speed."))
    captions = {kind: f"{name[:1].upper()}{name[1:].replace('_', ' ')}." for kind, (name, *_) in FILM_SIGNALS.items()}
    if any(name.startswith("temperature") for name in run.signals):
        del captions[POWER]  # it is drawn with the heat
    for what, words in (COURSES | captions).items():
        if SUBJECTS[what].panels[0].signals(run):
            figures.append((quantity_figure([run], what), words))
    for figure, _ in figures:
        narrowed(figure, NARROW, NARROW_COLUMNS)
    return [_shown(*figure) for figure in figures]


def _shown(figure: Picture, caption: str) -> ShownRun:
    figure.suptitle("")
    data = base64.b64encode(plot_style.picture(figure, ".svg", own_letters=True)).decode()
    return ShownRun(f"data:image/svg+xml;base64,{data}", caption)


def _moments(run: Run, speeds_Hz: Sequence[float], marked: Sequence[dict[str, Any]], end: float) -> list[float]:
    """Times in s of orbits and spectra."""
    if speeds_Hz:
        times = times_of_speeds(run, speeds_Hz)
        if len(times) < len(speeds_Hz):
            fastest = float(np.max(np.abs(run[SPEED])))
            problem = "a speed is asked for that the run does not reach."
            raise input_error("report", "output", "", problem, f"It turns with up to {fastest:.4g} Hz.")
        return times
    kinds = dict[str, float]()
    for event in marked:
        kinds.setdefault(event["kind"], event["t_s"])
    return sorted({*list(kinds.values())[: CHOSEN - 1], end})


def _commands(run: Run) -> str:
    name = shlex.quote(f"{run.case_name or 'case'}.toml")
    target = shlex.quote(run.path.name)
    return f"frb {run.command} {name} -o {target}\nfrb report {target}"


def _text(environment: Environment, name: str) -> str:
    assert environment.loader is not None
    return environment.loader.get_source(environment, name)[0]
