"""`frb export`: the signals of a run as a table for other programs."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.files import INPUT, OUTPUT, check_outputs, force_option, forced, next_to
from frbcli.cli.options import Command
from frbcli.cli.progress import WRITING, display


@click.command(cls=Command)
@click.argument("run_file", metavar="RUN.h5", type=INPUT)
@click.option(
    "--format",
    "table_format",
    type=click.Choice(["csv", "parquet", "mat", "xlsx"]),
    show_default="as the name of -o ends, else csv",
    help="Format of the table; parquet and xlsx need the extras frbcli[parquet] and frbcli[excel].",
)
@click.option("-o", "--output", metavar="FILE", type=OUTPUT, show_default="RUN.FORMAT",
              help='Table; "-" writes CSV to stdout.')  # fmt: skip
@force_option()
@output_options
def command(run_file: Path, table_format: str | None, output: Path | None, terminal: Terminal) -> None:
    """Write the signals of RUN.h5, one column each."""
    from frbcli.results.export import FORMATS, export_run, write_csv
    from frbcli.results.store import read_run
    from frbcli.results.write import TABLES

    to_stdout = output == Path("-")
    suffix = "" if output is None or to_stdout else output.suffix.lower()[1:]
    table_format = table_format or suffix or "csv"
    if suffix not in ("", table_format) or table_format not in FORMATS:
        raise click.UsageError(f"{output} does not end with .{' or .'.join(FORMATS)}, as its format is called.")
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
