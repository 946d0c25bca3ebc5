"""`frb plot`: eccentricities, ring speeds and pins, oil content, heat, what a run records and keeps of its films,
orbits, displacements, or the summary of a run; the cavitation laws of a case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import SETTING, Terminal, output_options
from frbcli.cli.files import INPUT, check_outputs, force_option, forced, here, next_to
from frbcli.cli.options import TIME_OPTION, Command, film_option, gathered, look_options, over_option, signal_option
from frbcli.cli.progress import display, draw_wanted, picture_option

if TYPE_CHECKING:
    from frbcli.plot.curves import Over
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run

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
def command(
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
    from frbcli.plot.machine.law import law_figure

    case = load_case(source, settings)
    target = output or here(case.name, f"-{LAW}.png")
    check_outputs(picture=target)
    draw_wanted(terminal, lambda: law_figure(case), target, LAW)
    terminal.emit({"command": "plot", "case": case.name, "output": target, "what": LAW})


def _figure(
    what: str, runs: Sequence[Run], span: tuple[float | None, float | None], over: Over, point: str | None
) -> Picture:
    """point: the point or film that is asked for."""
    from frbcli.plot.moving import film_moments_figure
    from frbcli.plot.run.motion import displacement_figure, eccentricity_figure, orbit_figure
    from frbcli.plot.run.quantities import quantity_figure
    from frbcli.plot.run.summary import ring_speed_figure, summary_figure

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
