"""`frb runup`: run a rotor up and write the run to a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.pictures.picture_options import picture_options
from frbcli.cli.runs.transient import RunOptions, run_options, transient

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
@picture_options
@output_options
def command(
    case: Case,
    options: RunOptions,
    onset_spread: bool,
    terminal: Terminal,
) -> int:
    """Run the rotor of CASE up and write the run to a file, with a summary picture beside it."""
    from frbcli.runs.run import runup

    return transient("runup", runup, case, options, terminal, onset_spread)
