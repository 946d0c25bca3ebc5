"""`frb export`: the signals of a run as a table for other programs."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.files import INPUT, OUTPUT, check_outputs, force_option, forced, next_to
from frbcli.cli.progress import WRITING, display


@click.command()
@click.argument("run_file", metavar="RUN.h5", type=INPUT)
@click.option(
    "--format",
    "table_format",
    type=click.Choice(["csv", "parquet", "mat"]),
    default="csv",
    show_default=True,
    help="Format of the table; parquet needs the extra frbcli[parquet].",
)
@click.option("-o", "--output", metavar="FILE", type=OUTPUT, help='Table; "-" writes CSV to stdout. [RUN.FORMAT]')
@force_option()
@output_options
def command(run_file: Path, table_format: str, output: Path | None, terminal: Terminal) -> None:
    """Write the signals of RUN.h5, one column each."""
    from frbcli.results.export import export_run, write_csv
    from frbcli.results.files.write import TABLES
    from frbcli.results.store import read_run

    to_stdout = output == Path("-")
    if to_stdout and (table_format != "csv" or terminal.json):
        raise click.UsageError("Only CSV goes to stdout, and not together with --json.")
    target = output or next_to(run_file, f".{table_format}")
    if not to_stdout:
        check_outputs((target, TABLES[table_format]))
    if to_stdout:
        write_csv(read_run(run_file), sys.stdout)  # ends where its reader does, as `head`
        sys.stdout.flush()
        return
    with display(terminal, WRITING):
        run = read_run(run_file)
        export_run(run, target, table_format, forced())
    terminal.result(f"{len(run)} samples of {len(run.signals)} signals: {target}")
    terminal.emit(
        {
            "command": "export",
            "run": run_file,
            "output": target,
            "format": table_format,
            "samples": len(run),
            "columns": list(run.signals),
        }
    )
