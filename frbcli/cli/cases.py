"""`frb cases`: the cases that come along, to read, to copy and to change."""

from __future__ import annotations

from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.errors import Fault, InputError


@click.command()
@click.argument("name", required=False)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Copy the case to this file.")
@output_options
def command(name: str | None, output: Path | None, terminal: Terminal) -> None:
    """List the shipped cases; with NAME print that case's text, or copy it with -o FILE."""
    if name is None:
        if output is not None:
            raise click.UsageError("-o needs the NAME of a case.")
        _list(terminal)
        return
    from frbcli.case.shipped import find_shipped

    text = find_shipped(name)
    if output is not None:
        _write(text, output)
        terminal.say(f"{output} written; `frb check {output}` checks it.")
    elif not terminal.json:
        click.echo(text, nl=False)
    terminal.emit({"command": "cases", "case": name, "output": output, "text": text})


def _list(terminal: Terminal) -> None:
    from frbcli.case.shipped import shipped_cases

    cases = shipped_cases()
    terminal.table("shipped cases", ("name", "title"), list(cases.items()))
    terminal.say("`frb cases NAME` prints a case, `frb cases NAME -o FILE` copies it.")
    terminal.emit({"command": "cases", "cases": [{"name": name, "title": title} for name, title in cases.items()]})


def _write(text: str, output: Path) -> None:
    try:
        with output.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        problem, remedy = "is there already.", "Name a new file; a case that you changed is not overwritten."
    except (OSError, ValueError) as error:
        problem, remedy = f"cannot be written: {getattr(error, 'strerror', None) or error}.", "Check the directory."
    else:
        return
    raise InputError(str(output), (Fault("--output", str(output), None, problem, remedy),))
