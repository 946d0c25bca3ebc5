"""`frb cases`: the shipped cases, to print and to copy."""

from __future__ import annotations

from pathlib import Path

import click

from frbcli.cli.common import SETTING, Terminal, output_options
from frbcli.cli.files import CASE_FILE, check_outputs, force_option, forced
from frbcli.cli.options import Command, complete_key


@click.command(cls=Command)
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", shell_complete=complete_key,
              help=f"{SETTING} Repeatable.")
@click.option("-o", "--output", metavar="CASE.toml", type=CASE_FILE, help="Copy the case to this file.")
@click.option("--hard", is_flag=True, help="List the hard cases instead of the others.")
@force_option("Replace a file at -o.")
@output_options
def command(
    names: tuple[str, ...], settings: tuple[str, ...], output: Path | None, hard: bool, terminal: Terminal
) -> None:
    """List the shipped cases; with NAME print that case's text, or copy it with -o FILE."""
    if not names and (output is not None or settings):
        raise click.UsageError("-o and --set need the NAME of a case.")
    if len(names) > 1:
        raise click.UsageError("One NAME at a time.")
    if names:
        _show(names[0], settings, output, hard, terminal)
    elif hard:
        from frbcli.cli.hard import list_hard

        list_hard(terminal)
    else:
        _list(terminal)


def _show(name: str, settings: tuple[str, ...], output: Path | None, hard: bool, terminal: Terminal) -> None:
    """Print a case or copy it."""
    from frbcli.case.reading.shipped import find_shipped

    if hard:
        from frbcli.cli.hard import hard_text

        text = hard_text(name)
    else:
        text = find_shipped(name)
    if settings:
        from frbcli.case.reading.load import load_case_text

        text = load_case_text(text, settings, name).source_text
    if output is not None:
        _write(text, output)
        terminal.result(f"case: {output}")
        terminal.remark(f"`frb check {output}` checks it.")
    else:
        terminal.text(text)
    terminal.emit({"command": "cases", "case": name, "output": output, "text": text})


def _list(terminal: Terminal) -> None:
    from frbcli.case.reading.shipped import shipped_cases

    cases = shipped_cases()
    terminal.table("shipped cases", ("name", "title"), list(cases.items()))
    terminal.remark(
        "`frb cases NAME` prints a case, `frb cases NAME -o FILE` copies it.\n`frb cases --hard` lists hard cases."
    )
    terminal.emit({"command": "cases", "cases": [{"name": name, "title": title} for name, title in cases.items()]})


def _write(text: str, output: Path) -> None:
    """Write a case to a new file, with --force to any."""
    from frbcli.results.write import NEW, write

    check_outputs((output, NEW))
    write(output, NEW, text, forced())
