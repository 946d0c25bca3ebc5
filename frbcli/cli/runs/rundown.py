"""`frb rundown`: run a rotor up, hold it, and run it down again."""

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
@picture_options
@output_options
def command(
    case: Case,
    options: RunOptions,
    terminal: Terminal,
) -> int:
    """Run the rotor of CASE up, hold it, and run it down again; write the run to a file, with a picture beside it."""
    from frbcli.runs.run import rundown

    return transient("rundown", rundown, case, options, terminal)
