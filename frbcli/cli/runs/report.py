"""`frb report`: a run as one self-contained page."""

from __future__ import annotations

from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.files import INPUT, PAGE_FILE, check_outputs, force_option, forced, next_to
from frbcli.cli.options import Command, signal_option, speeds_option
from frbcli.cli.progress import drawing


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN.h5", type=INPUT)
@click.option("-o", "--output", metavar="PAGE.html", type=PAGE_FILE, show_default="RUN-report.html", help="Page.")
@speeds_option("speeds at the events, and the last; orbits and spectra are drawn there")
@signal_option()
@click.option("--author", default="", metavar="NAME", help="Name on top of the page, next to date and version.")
@click.option("--both-units", is_flag=True, show_default="as the case gives them", help="Rotor speeds in Hz and rpm.")
@force_option()
@output_options
def command(
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
