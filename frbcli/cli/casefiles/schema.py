"""`frb schema`: the JSON Schema of a case file, for editors."""

from __future__ import annotations

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.options import Command


@click.command(cls=Command)
@output_options
def command(terminal: Terminal) -> None:  # noqa: ARG001  # every command takes --json; this one prints JSON anyway
    """Print the JSON Schema of a case file: editors complete and check case files with it."""
    from frbcli.case.schema import json_schema

    Terminal(json=True).emit(json_schema())
