"""Commands that look at a run file: `frb waterfall`, `frb plot`, `frb report`, `frb export`.

A waterfall is also of a measurement; `frb plot` draws the cavitation laws of a case, too."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import SETTING, Terminal, output_options
from frbcli.cli.options import (
    INPUT,
    OUTPUT,
    PAGE_FILE,
    TIME_OPTION,
    Command,
    Numbers,
    Span,
    check_outputs,
    film_option,
    force_option,
    forced,
    gathered,
    here,
    look_options,
    next_to,
    over_option,
    signal_option,
    speeds_option,
)
from frbcli.cli.progress import READING, WRITING, display, draw_wanted, drawing, picture_option
from frbcli.cli.studies.measurements import measured_options, run_of, show_columns
from frbcli.columns import table_of

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.analysis.order_tracking import OrderTrack
    from frbcli.analysis.spectrum import Direction
    from frbcli.plot.curves import Over
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run


MICRO = 1e6


@dataclass(frozen=True)
class View:
    """How a run is looked at, see the options of the command."""

    over: Over | None
    cascade: bool
    window: float | None
    direction: Direction
    log: bool
    levels: tuple[float, float] | None
    linear: bool
    lines: tuple[float, ...] | None


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN", type=INPUT)
@picture_option("RUN-waterfall.png")
@signal_option()
@click.option("--order", "orders", metavar="1,0.5", type=Numbers(),
              help="Amplitudes by order instead of spectra; exact also in a ramp of the speed.")  # fmt: skip
@over_option(None)
@click.option("--cascade", is_flag=True, help="Curves behind each other, in 3-D.")
@click.option("--window", type=TIME_OPTION, show_default="from the ramp, up to 0.2 s", help="Length of one spectrum.")
@click.option(
    "--direction",
    type=click.Choice(["x", "y", "forward"]),
    default="x",
    show_default=True,
    help="One coordinate, or the motion that turns with the rotor.",
)
@click.option("--log", is_flag=True, help="Logarithmic frequency axis; with --order logarithmic amplitudes.")
@click.option("--levels", type=Span(), metavar="A,B", show_default="-60,0",
              help="Range of the colours in dB, with --linear in um.")  # fmt: skip
@click.option("--linear", is_flag=True, help="Amplitudes in um instead of levels in dB.")
@click.option("--lines", type=Numbers(), metavar="1,0.5", show_default="orders of free whirls",
              help="Orders whose lines are drawn.")  # fmt: skip
@click.option("--columns", "listed", is_flag=True, help="List the columns of a measurement, with shapes and units.")
@measured_options
@force_option()
@look_options
@output_options
@gathered("view", View)
def waterfall(
    run_file: Path,
    output: Path | None,
    signal: str,
    orders: tuple[float, ...] | None,
    view: View,
    listed: bool,
    measurement: Measurement | None,
    terminal: Terminal,
) -> None:
    """Draw the spectra of RUN in dB relative to the clearance, over time or rotor speed; or, with --order, its
    amplitudes by order.

    RUN is a run file, or a measurement as CSV, WAV, MAT or UFF, whose columns --x, --speed-column and so on name.
    """
    from frbcli.analysis.events import about_critical_speeds
    from frbcli.analysis.subsynchronous import with_whirl_names
    from frbcli.case.run import speed_unit_of
    from frbcli.results.columns import EVENTS

    if listed:
        show_columns(run_file, terminal)
        return
    if orders is not None and (view.cascade or view.window is not None):
        raise click.UsageError("--cascade and --window belong to spectra, not to --order.")
    if orders is not None and (view.levels is not None or view.linear or view.lines is not None):
        raise click.UsageError("--levels, --linear and --lines belong to spectra, not to --order.")
    target = output or next_to(run_file, "-waterfall.png" if orders is None else "-orders.png")
    check_outputs(picture=target)
    with display(terminal, READING):
        run = run_of(run_file, measurement, terminal, relative=orders is None and not view.linear)
    terminal = terminal.with_speeds_in(speed_unit_of(run))
    if orders is None:
        drawn = _spectra(terminal, run, signal, view, target)
    else:
        drawn = _orders(terminal, run, signal, orders, view.over or "speed", view, target)
    if measurement is not None:
        drawn["events"] = run.events
        if run.events:
            terminal.show("events", table_of(EVENTS, with_whirl_names(run.events)))
            for sentence in about_critical_speeds(run, run.events, terminal.speeds):
                terminal.sentence(sentence)
    document = {"command": "waterfall", "run": run_file, "output": target, "signal": signal}
    terminal.emit({**document, "direction": view.direction, **drawn})


def _spectra(terminal: Terminal, run: Run, signal: str, view: View, target: Path) -> dict[str, Any]:
    """Draw spectra, and return their part of the JSON document."""
    from frbcli.plot.waterfall import LevelScale, natural_axis, reading, run_spectra, waterfall_figure

    with display(terminal):
        levels = run_spectra(run, signal, view.window, view.direction)
    scale, axis = LevelScale(view.linear, view.levels, view.lines), view.over or natural_axis(levels)
    draw_wanted(
        terminal,
        lambda: waterfall_figure(
            run, axis, signal, view.cascade, view.window, view.direction, view.log, levels, scale, terminal.speeds
        ),
        target,
        "waterfall",
    )
    terminal.result(reading(levels))
    return {"over": axis, "window_s": levels.window_s, "synchronous_low_dB": float(levels.low_dB.max())}


def _orders(
    terminal: Terminal, run: Run, signal: str, orders: tuple[float, ...], axis: Over, view: View, target: Path
) -> dict[str, Any]:
    """Draw amplitudes by order, and return their part of the JSON document."""
    from frbcli.analysis.order_tracking import order_tracks
    from frbcli.plot.curves import orders_figure

    with display(terminal):
        tracks = order_tracks(run, orders, signal)
    draw_wanted(terminal, lambda: orders_figure(run, tracks, axis, view.direction, view.log), target, "orders")
    rows = [_largest(track, view.direction) for track in tracks]
    for row in rows:
        most = f"{MICRO * row['amplitude_max_m']:.3g} um at {terminal.speeds.words(row['speed_Hz'], 1)}"
        terminal.result(f"order {row['order']:g}: at most {most}, {row['t_s']:.3f} s")
    return {"over": axis, "orders": rows}


def _largest(track: OrderTrack, direction: Direction) -> dict[str, float]:
    """Where the motion of an order is largest."""
    amplitude = track.amplitude(direction)
    at = int(amplitude.argmax())
    return {
        "order": track.order,
        "amplitude_max_m": float(amplitude[at]),
        "t_s": float(track.time_s[at]),
        "speed_Hz": float(track.speed_Hz[at]),
    }


LAW = "law"  # of a case, the others of runs
FILM_SIGNALS = ("force", "film-thickness", "power", "torque", "oil-flow", "tilt", "supply-pressure")
QUANTITIES = ("oil-content", "heat", "axial", "pin", *FILM_SIGNALS)
CURVES = ("eccentricity", "ring-speed", *QUANTITIES)
MOVING = ("orbit", "film")
SUBJECTS = (*CURVES, *MOVING, "displacement", "summary", LAW)


@dataclass(frozen=True)
class Times:
    """What is drawn of a run, from one time to another in s; None: from its beginning, to its end."""

    from_time: float | None
    to_time: float | None

    @property
    def both(self) -> tuple[float | None, float | None]:
        """The two times."""
        return self.from_time, self.to_time


@click.command(cls=Command)
@click.argument("run_files", metavar="RUN.h5...|CASE", type=INPUT, nargs=-1, required=True)
@click.option("--what", metavar="SUBJECT", type=click.Choice(SUBJECTS), default="eccentricity", show_default=True,
              help=f"Subject of the picture: {', '.join(SUBJECTS)}.")
@click.option("--from", "from_time", metavar="TIME", type=TIME_OPTION, help='Start of the drawn time, e.g. "6.4 s".')
@click.option("--to", "to_time", metavar="TIME", type=TIME_OPTION, help="End of the drawn time.")
@over_option("time")
@signal_option(None)
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help=f"{SETTING} With --what law.")
@click.option("--animate", is_flag=True,
              help="A moving picture of an orbit or a film: GIF, or MP4 where ffmpeg is installed.")  # fmt: skip
@film_option("The film of --what film.", "the first one")
@picture_option("RUN-WHAT.png")
@force_option()
@look_options
@output_options
@gathered("span", Times)
def plot(
    run_files: tuple[Path, ...],
    what: str,
    span: Times,
    over: Over,
    signal: str | None,
    settings: tuple[str, ...],
    animate: bool,
    film: str | None,
    output: Path | None,
    terminal: Terminal,
) -> None:
    """Draw one or several runs in one picture; with --what law, the oil fraction of a case over pressure."""
    from frbcli.case.run import speed_unit_of
    from frbcli.results.store import read_run

    if animate and what not in MOVING:
        raise click.UsageError(f"--animate belongs to --what {' and '.join(MOVING)}.")
    if film is not None and what != "film":
        raise click.UsageError("--film belongs to --what film.")
    if what == LAW:
        if len(run_files) > 1:
            raise click.UsageError("A law is of one case.")
        if span.both != (None, None) or signal is not None or over != "time":
            raise click.UsageError("--from, --to, --over and --signal belong to pictures of runs.")
        _law(str(run_files[0]), settings, output, terminal)
        return
    if settings:
        raise click.UsageError("--set belongs to --what law; a run cannot be changed.")
    if len(run_files) > 1 and (animate or what in ("summary", "film")):
        raise click.UsageError(f"{'A moving picture' if animate else f'A {what}'} is of one run.")
    if what == "summary" and span.both != (None, None):
        raise click.UsageError("A summary is of the whole run: leave --from and --to out.")
    if signal is not None and what != "displacement":
        raise click.UsageError("--signal belongs to --what displacement.")
    if over != "time" and what not in CURVES:
        raise click.UsageError(f"--over belongs to --what {', '.join(CURVES)}.")
    target = output or next_to(run_files[0], f"-{what}.gif" if animate else f"-{what}.png")
    if animate:
        _animate(run_files[0], target, span.both, what, film, terminal)
        return
    check_outputs(picture=target)
    runs = [read_run(path) for path in run_files]
    terminal = terminal.with_speeds_in(speed_unit_of(runs[0]))
    if what == "eccentricity" and over == "time" and all("length_m" in run.references for run in runs):
        what = "displacement"  # no bearing has a film
    draw_wanted(terminal, lambda: _figure(what, runs, span.both, over, film or signal), target, what)
    first = run_files[0] if len(run_files) == 1 else list(run_files)
    terminal.emit({"command": "plot", "run": first, "output": target, "what": what})


def _animate(
    run_file: Path, target: Path, span: tuple[float | None, float | None], what: str, film: str | None,
    terminal: Terminal,
) -> None:  # fmt: skip
    from frbcli.plot.moving import animate_films, animate_orbits, check_animation
    from frbcli.results.store import read_run
    from frbcli.results.write import PICTURES

    check_animation(target, forced())
    check_outputs((target, PICTURES[target.suffix.lower()]))
    run = read_run(run_file)
    with display(terminal, "Drawing.") as shown:
        observe = shown.counting("frame ")
        if what == "film":
            animate_films(run, target, film, *span, observe=observe, force=forced())
        else:
            animate_orbits(run, target, *span, observe=observe, force=forced())
    terminal.result(f"{what}: {target}")
    terminal.emit({"command": "plot", "run": run_file, "output": target, "what": what})


def _law(source: str, settings: tuple[str, ...], output: Path | None, terminal: Terminal) -> None:
    from frbcli.case.reading.load import load_case
    from frbcli.plot.machine.film import law_figure

    case = load_case(source, settings)
    target = output or here(case.name, f"-{LAW}.png")
    check_outputs(picture=target)
    draw_wanted(terminal, lambda: law_figure(case), target, LAW)
    terminal.emit({"command": "plot", "case": case.name, "output": target, "what": LAW})


def _figure(
    what: str, runs: Sequence[Run], span: tuple[float | None, float | None], over: Over, point: str | None
) -> Picture:
    """point: the point or film that is asked for."""
    from frbcli.plot.motion import displacement_figure, eccentricity_figure, orbit_figure, quantity_figure
    from frbcli.plot.moving import film_moments_figure
    from frbcli.plot.summary import ring_speed_figure, summary_figure

    if what == "summary":
        return summary_figure(runs[0])
    if what == "orbit":
        return orbit_figure(runs, *span)
    if what == "film":
        return film_moments_figure(runs[0], point, *span)
    if what == "displacement":
        return displacement_figure(runs, point, *span)
    if what in QUANTITIES:
        return quantity_figure(runs, what, *span, over)
    return (ring_speed_figure if what == "ring-speed" else eccentricity_figure)(runs, *span, over)


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN.h5", type=INPUT)
@click.option("-o", "--output", metavar="PAGE.html", type=PAGE_FILE, show_default="RUN-report.html", help="Page.")
@speeds_option("speeds at the events, and the last; orbits and spectra are drawn there")
@signal_option()
@click.option("--author", default="", metavar="NAME", help="Name on top of the page, next to date and version.")
@click.option("--both-units", is_flag=True, show_default="as the case gives them", help="Rotor speeds in Hz and rpm.")
@force_option()
@output_options
def report(
    run_file: Path, output: Path | None, speeds: tuple[float, ...], signal: str, author: str, both_units: bool,
    terminal: Terminal,
) -> None:  # fmt: skip
    """Write RUN.h5 as one page: machine, plan, events, waterfall that reads out under the pointer, orbits, spectra,
    errors, balances, cost and how to repeat it."""
    from frbcli.results.store import read_run
    from frbcli.results.write import PAGE

    target = output or next_to(run_file, "-report.html")
    check_outputs((target, PAGE))
    with drawing(terminal):
        from frbcli.report.page import write_report

        write_report(read_run(run_file), target, speeds, signal, author, both_units, forced())
    terminal.result(f"report: {target}")
    terminal.emit({"command": "report", "run": run_file, "output": target})


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN.h5", type=INPUT)
@click.option(
    "--format",
    "table_format",
    type=click.Choice(["csv", "parquet", "mat", "xlsx"]),
    show_default="as the name of -o ends, else csv",
    help="Format of the table; parquet and xlsx need the extras frbcli[parquet] and frbcli[excel].",
)
@click.option("-o", "--output", metavar="FILE", type=OUTPUT, show_default="RUN.FORMAT",
              help='Table; "-" writes CSV to stdout.')  # fmt: skip
@force_option()
@output_options
def export(run_file: Path, table_format: str | None, output: Path | None, terminal: Terminal) -> None:
    """Write the signals of RUN.h5, one column each."""
    from frbcli.results.export import FORMATS, export_run, write_csv
    from frbcli.results.store import read_run
    from frbcli.results.write import TABLES

    to_stdout = output == Path("-")
    suffix = "" if output is None or to_stdout else output.suffix.lower()[1:]
    table_format = table_format or suffix or "csv"
    if suffix not in ("", table_format) or table_format not in FORMATS:
        raise click.UsageError(f"{output} does not end with .{' or .'.join(FORMATS)}, as its format is called.")
    if to_stdout and (table_format != "csv" or terminal.json):
        raise click.UsageError("Only CSV goes to stdout, and not together with --json.")
    target = output or next_to(run_file, f".{table_format}")
    if not to_stdout:
        check_outputs((target, TABLES[table_format]))
    if to_stdout:
        write_csv(read_run(run_file), sys.stdout)  # ends where its reader does, as `head`
        sys.stdout.flush()
        return
    with display(terminal, WRITING):
        run = read_run(run_file)
        export_run(run, target, table_format, forced())
    terminal.result(f"{len(run)} samples of {len(run.signals)} signals: {target}")
    terminal.emit(
        {
            "command": "export",
            "run": run_file,
            "output": target,
            "format": table_format,
            "samples": len(run),
            "columns": list(run.signals),
        }
    )
