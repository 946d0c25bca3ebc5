"""`frb runup`: run a rotor up and write the run to a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.picture_options import picture_options
from frbcli.cli.transient import run_options, transient

if TYPE_CHECKING:
    from frbcli.case.schema import Case


@click.command()
@case_argument
@run_options
@click.option(
    "--onset-spread",
    is_flag=True,
    help="Run again with other ramps, steps and cells: between which speeds a whirl begins.",
)
@click.option("--explain", is_flag=True, help="Name the Hopf point or fold behind each onset and offset of a whirl.")
@picture_options
@output_options
def command(
    case: Case,
    output: Path | None,
    resume: bool,
    force: bool,
    picture: bool,
    verify: bool,
    onset_spread: bool,
    explain: bool,
    terminal: Terminal,
) -> int:
    """Run the rotor of CASE up and write the run to a file, with a summary picture beside it."""
    from frbcli.runs.run import runup

    return transient("runup", runup, case, output, resume, force, picture, verify, terminal, onset_spread, explain)
