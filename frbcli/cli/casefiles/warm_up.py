"""`frb warm-up`: the kernels of cases, compiled once."""

from __future__ import annotations

import click

from frbcli.cli.common import SETTING, Terminal, output_options
from frbcli.cli.options import Command, complete_case, complete_key
from frbcli.cli.progress import display


@click.command(cls=Command)
@click.argument("sources", nargs=-1, metavar="[CASE]...", shell_complete=complete_case)
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", shell_complete=complete_key,
              help=f"{SETTING} Repeatable.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", show_default="one for each core",
              help="Processes.")  # fmt: skip
@output_options
def command(sources: tuple[str, ...], settings: tuple[str, ...], jobs: int | None, terminal: Terminal) -> None:
    """Compile the kernels of CASE, or of all shipped cases, once, on all cores: for run-ups, stability, bearing sheets
    and kinematic tests."""
    if settings and not sources:
        raise click.UsageError("--set is of a CASE.")
    with display(terminal) as shown:
        shown.line("Looking for the kernels; those that are missing are compiled, once.")
        from frbcli.case.reading.load import load_case
        from frbcli.studies.warm_up import warm_up

        cases = [load_case(source, settings) for source in sources]
        built = warm_up(cases, jobs or -1, lambda what, number, count: shown.line(f"{number} of {count}: {what}"))
    if built.compiled:
        terminal.show("compiled", built.table())
        terminal.result(
            f"Compiled kernels: {built.functions} functions in {built.wall_s:.0f} s, {built.cpu_s:.0f} s of CPU time."
        )
    else:
        terminal.result("Nothing to compile: all kernels are on the disk.")
    terminal.emit(
        {
            "command": "warm-up",
            "cases": built.cases,
            "compiled": built.table().documents(),
            "functions": built.functions,
            "cpu_s": built.cpu_s,
            "wall_s": built.wall_s,
        }
    )
