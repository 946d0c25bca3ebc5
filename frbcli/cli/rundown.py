"""`frb rundown`: run a rotor up, hold it, and run it down again."""

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
    explain: bool,
    terminal: Terminal,
) -> int:
    """Run the rotor of CASE up, hold it, and run it down again; write the run to a file, with a picture beside it."""
    from frbcli.runs.run import rundown

    return transient("rundown", rundown, case, output, resume, force, picture, verify, terminal, explain=explain)
