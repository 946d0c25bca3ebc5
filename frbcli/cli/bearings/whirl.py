"""`frb whirl`: a kinematic bearing test of section 4.2.2."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.bearings.kinematic import kinematic_options, run_test
from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.pictures.picture_options import picture_options

if TYPE_CHECKING:
    from frbcli.case.schema import Case


@click.command()
@case_argument
@kinematic_options
@picture_options
@output_options
def command(
    case: Case, cavitation: tuple[str, ...], output: Path | None, picture: bool, terminal: Terminal
) -> int | None:
    """Circular motion of a journal (4.48): pressure at the bottom of the bearing over time."""
    return run_test(case, "whirl", cavitation, output, picture, terminal)
