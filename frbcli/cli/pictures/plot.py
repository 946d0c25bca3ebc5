"""`frb plot`: eccentricities, ring speeds, oil content, heat, what a run records of its films, orbits, displacements,
or the summary of a run; the cavitation laws of a case."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import SETTING, Terminal, output_options
from frbcli.cli.files import INPUT, beside, check_outputs, here
from frbcli.cli.looks import look_options
from frbcli.cli.options import TIME_OPTION, over_option, signal_option
from frbcli.cli.outputs import draw_wanted, picture_option

if TYPE_CHECKING:
    from frbcli.plot.curves import Over
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run

LAW = "law"  # of a case, the others of runs
FILM_SIGNALS = ("force", "film-thickness", "power", "torque", "oil-flow", "tilt", "supply-pressure")
CURVES = ("eccentricity", "ring-speed", "oil-content", "heat", "axial", *FILM_SIGNALS)
SUBJECTS = (*CURVES, "orbit", "displacement", "summary", LAW)


@click.command()
@click.argument("run_files", metavar="RUN.h5...|CASE", type=INPUT, nargs=-1, required=True)
@click.option("--what", type=click.Choice(SUBJECTS), default="eccentricity", show_default=True, help="Subject.")
@click.option("--from", "from_time", metavar="TIME", type=TIME_OPTION, help='Begin of what is drawn, e.g. "6.4 s".')
@click.option("--to", "to_time", metavar="TIME", type=TIME_OPTION, help="End of what is drawn.")
@over_option("time")
@signal_option(None)
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help=f"{SETTING} With --what law.")
@click.option("--animate", is_flag=True, help="A moving picture of an orbit: GIF, or MP4 where ffmpeg is installed.")
@picture_option("RUN-WHAT.png")
@look_options
@output_options
def command(
    run_files: tuple[Path, ...],
    what: str,
    from_time: float | None,
    to_time: float | None,
    over: Over,
    signal: str | None,
    settings: tuple[str, ...],
    animate: bool,
    output: Path | None,
    terminal: Terminal,
) -> None:
    """Draw one or several runs in one picture; with --what law, the oil fraction of a case over pressure."""
    from frbcli.results.store import read_run

    if animate and (what != "orbit" or len(run_files) > 1):
        raise click.UsageError("--animate belongs to --what orbit, of one run.")
    if what == LAW:
        if len(run_files) > 1:
            raise click.UsageError("A law is of one case.")
        if from_time is not None or to_time is not None or signal is not None or over != "time":
            raise click.UsageError("--from, --to, --over and --signal belong to pictures of runs.")
        _law(str(run_files[0]), settings, output, terminal)
        return
    if settings:
        raise click.UsageError("--set belongs to --what law; a run cannot be changed.")
    if what == "summary" and len(run_files) > 1:
        raise click.UsageError("A summary is of one run.")
    if what == "summary" and (from_time is not None or to_time is not None):
        raise click.UsageError("A summary is of the whole run: leave --from and --to out.")
    if signal is not None and what != "displacement":
        raise click.UsageError("--signal belongs to --what displacement.")
    if over != "time" and what not in CURVES:
        raise click.UsageError(f"--over belongs to --what {', '.join(CURVES)}.")
    target = output or beside(run_files[0], f"-{what}.gif" if animate else f"-{what}.png")
    if animate:
        _animate(run_files[0], target, (from_time, to_time), terminal)
        return
    check_outputs(picture=target)
    runs = [read_run(path) for path in run_files]
    if what == "eccentricity" and over == "time" and all("length_m" in run.references for run in runs):
        what = "displacement"  # no bearing has a film
    draw_wanted(terminal, lambda: _figure(what, runs, (from_time, to_time), over, signal), target, what)
    first = run_files[0] if len(run_files) == 1 else list(run_files)
    terminal.emit({"command": "plot", "run": first, "output": target, "what": what})


def _animate(
    run_file: Path, target: Path, span: tuple[float | None, float | None], terminal: Terminal
) -> None:
    from frbcli.plot.run.animation import animate_orbits, check_animation
    from frbcli.results.files import kinds
    from frbcli.results.store import read_run

    check_animation(target)
    check_outputs((target, kinds.PICTURES[target.suffix.lower()]))
    animate_orbits(read_run(run_file), target, *span)
    terminal.result(f"orbit: {target}")
    terminal.emit({"command": "plot", "run": run_file, "output": target, "what": "orbit"})


def _law(source: str, settings: tuple[str, ...], output: Path | None, terminal: Terminal) -> None:
    from frbcli.case.reading.load import load_case
    from frbcli.plot.machine.law import law_figure

    case = load_case(source, settings)
    target = output or here(case.name, f"-{LAW}.png")
    check_outputs(picture=target)
    draw_wanted(terminal, lambda: law_figure(case), target, LAW)
    terminal.emit({"command": "plot", "case": case.name, "output": target, "what": LAW})


def _figure(
    what: str, runs: Sequence[Run], span: tuple[float | None, float | None], over: Over, signal: str | None
) -> Picture:
    from frbcli.plot.axial import axial_figure
    from frbcli.plot.run.displacement import displacement_figure
    from frbcli.plot.run.eccentricity import eccentricity_figure
    from frbcli.plot.run.film_signals import film_signal_figure
    from frbcli.plot.run.heat import heat_figure
    from frbcli.plot.run.oil_content import oil_content_figure
    from frbcli.plot.run.orbit import orbit_figure
    from frbcli.plot.run.ring_speed import ring_speed_figure
    from frbcli.plot.run.summary import summary_figure

    if what == "summary":
        return summary_figure(runs[0])
    if what == "orbit":
        return orbit_figure(runs, *span)
    if what == "displacement":
        return displacement_figure(runs, signal, *span)
    if what in FILM_SIGNALS:
        return film_signal_figure(runs, what, *span, over)
    known = {"ring-speed": ring_speed_figure, "oil-content": oil_content_figure, "heat": heat_figure,
             "axial": axial_figure}  # fmt: skip
    return known.get(what, eccentricity_figure)(runs, *span, over)
