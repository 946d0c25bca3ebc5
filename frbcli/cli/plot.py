"""`frb plot`: eccentricities, orbits, displacements, or the summary of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.runs import OUTPUT, RUN, SECONDS, beside

if TYPE_CHECKING:
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run

PICTURES = ("eccentricity", "orbit", "displacement", "summary")


@click.command()
@click.argument("run_files", metavar="RUN.h5...", type=RUN, nargs=-1, required=True)
@click.option("--what", type=click.Choice(PICTURES), default="eccentricity", show_default=True, help="The picture.")
@click.option("--from", "from_time", metavar="TIME", type=SECONDS, help='Begin, e.g. "6.4 s".')
@click.option("--to", "to_time", metavar="TIME", type=SECONDS, help="End.")
@click.option("--signal", help="Of a displacement: disk or journal; journal_NAME of a bearing.")
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [RUN-WHAT.png]")
@output_options
def command(
    run_files: tuple[Path, ...],
    what: str,
    from_time: float | None,
    to_time: float | None,
    signal: str | None,
    output: Path | None,
    terminal: Terminal,
) -> None:
    """Draw one picture of one or several runs, overlaid."""
    from frbcli.plot.style import check_picture, save_figure
    from frbcli.results.store import read_run

    if what == "summary" and len(run_files) > 1:
        raise click.UsageError("A summary is of one run.")
    if what == "summary" and (from_time is not None or to_time is not None):
        raise click.UsageError("A summary is of the whole run: leave --from and --to out.")
    if signal is not None and what != "displacement":
        raise click.UsageError("--signal belongs to --what displacement.")
    target = output or beside(run_files[0], f"-{what}.png")
    check_picture(target)
    save_figure(_draw(what, [read_run(path) for path in run_files], from_time, to_time, signal), target)
    terminal.say(f"{what}: {target}")
    first = run_files[0] if len(run_files) == 1 else list(run_files)
    terminal.emit({"command": "plot", "run": first, "output": target, "what": what})


def _draw(
    what: str, runs: Sequence[Run], from_time: float | None, to_time: float | None, signal: str | None
) -> Picture:
    from frbcli.plot.displacement import displacement_figure
    from frbcli.plot.eccentricity import eccentricity_figure
    from frbcli.plot.orbit import orbit_figure
    from frbcli.plot.summary import summary_figure

    if what == "summary":
        return summary_figure(runs[0])
    if what == "orbit":
        return orbit_figure(runs, from_time, to_time)
    if what == "displacement":
        return displacement_figure(runs, signal, from_time, to_time)
    return eccentricity_figure(runs, from_time, to_time)
