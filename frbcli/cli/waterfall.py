"""`frb waterfall`: the spectra of a run over time or rotor speed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.pictures import draw_wanted
from frbcli.cli.runs import OUTPUT, RUN, SECONDS, beside

if TYPE_CHECKING:
    from frbcli.analysis.spectrum import Direction
    from frbcli.plot.waterfall import Over


@click.command()
@click.argument("run_file", metavar="RUN.h5", type=RUN)
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [RUN-waterfall.png]")
@click.option("--signal", default="journal", show_default=True, help="journal or disk; journal_NAME, disk_NAME.")
@click.option("--over", type=click.Choice(["time", "speed"]), default="time", show_default=True, help="The axis.")
@click.option("--cascade", is_flag=True, help="Curves behind each other, in 3-D.")
@click.option("--window", type=SECONDS, default="0.2 s", show_default=True, help="Length of one spectrum.")
@click.option(
    "--direction",
    type=click.Choice(["x", "y", "forward"]),
    default="x",
    show_default=True,
    help="One coordinate, or the motion that turns with the rotor.",
)
@click.option("--log", is_flag=True, help="Logarithmic frequency.")
@output_options
def command(
    run_file: Path,
    output: Path | None,
    signal: str,
    over: Over,
    cascade: bool,
    window: float,
    direction: Direction,
    log: bool,
    terminal: Terminal,
) -> None:
    """Draw the spectra of RUN.h5 in dB relative to the clearance, over time or rotor speed."""
    from frbcli.plot.style import check_picture
    from frbcli.plot.waterfall import waterfall_figure
    from frbcli.results.store import read_run

    target = output or beside(run_file, "-waterfall.png")
    check_picture(target)
    run = read_run(run_file)
    draw_wanted(
        terminal, lambda: waterfall_figure(run, over, signal, cascade, window, direction, log), target, "waterfall"
    )
    terminal.emit(
        {
            "command": "waterfall",
            "run": run_file,
            "output": target,
            "signal": signal,
            "over": over,
            "direction": direction,
            "window_s": window,
        }
    )
