"""`frb`: the table of commands, and the one place where errors become exit codes.

Exit codes: 0 done; 2 the input is wrong; 3 the run ended early for a reason that it names; 130 interrupted; 1 a bug, or
too little memory; `process.main` adds the codes of streams that cannot be written. docs/command-line.md lists those of
each command.
"""

from __future__ import annotations

import errno
import importlib
import io
from collections.abc import Sequence

import click

from frbcli.cli.common import Terminal
from frbcli.cli.runs.memory import require_memory, reserve, shortage
from frbcli.errors import INTERRUPTED, Fault, FrbError, InputError, NotConverged, printable
from frbcli.nearest import did_you_mean
from frbcli.version import __version__

# name: (module, one line of help); the module is imported when its command is called
COMMANDS = {
    "check": ("frbcli.cli.check", "Validate a case; show its loads, speeds and what will be modelled."),
    "rotation": ("frbcli.cli.bearings.rotation", "Turn a journal at a displacement or under a load; compare models."),
    "squeeze": ("frbcli.cli.bearings.squeeze", "Move a journal up and down: force over time."),
    "whirl": ("frbcli.cli.bearings.whirl", "Move a journal on a circle: pressure over time."),
    "runup": ("frbcli.cli.runs.runup", "Run a rotor up and write the run to a file."),
    "rundown": ("frbcli.cli.runs.rundown", "Run a rotor up, hold it, run it down."),
    "waterfall": ("frbcli.cli.pictures.waterfall", "Draw the spectra of a run or a measurement over time or speed."),
    "plot": ("frbcli.cli.pictures.plot", "Draw eccentricities, orbits, temperatures or film signals of runs."),
    "compare": ("frbcli.cli.studies.compare", "Compare models of one case, or a run with a measurement."),
    "bearing": (
        "frbcli.cli.bearings.bearing",
        "Resting position, K, D, loss, flow of every film over speed or eccentricity.",
    ),
    "fit": ("frbcli.cli.studies.fit", "Find numbers of a case from a measured run-up."),
    "stability": (
        "frbcli.cli.machines.stability",
        "Resting positions, linear coefficients, eigenvalues, threshold speed.",
    ),
    "response": ("frbcli.cli.machines.response", "Linear unbalance response over speed; map of critical speeds."),
    "limit-cycles": (
        "frbcli.cli.machines.limit_cycles",
        "Hopf points, limit cycles and folds over speed, stable or not.",
    ),
    "accuracy": ("frbcli.cli.studies.accuracy", "Compare cost and error of theories, meshes, tolerances, couplings."),
    "sweep": ("frbcli.cli.studies.sweep", "Run one case with many settings, on all cores or a cluster."),
    "report": ("frbcli.cli.pictures.report", "Write a run as one page: machine, events, waterfall, orbits, errors."),
    "export": ("frbcli.cli.pictures.export", "Write the signals of a run as CSV, Parquet or MAT."),
    "cases": ("frbcli.cli.cases", "List, show or copy the shipped cases."),
    "schema": ("frbcli.cli.schema", "Print the JSON Schema of a case file for editors."),
}

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # a disk
LIGHT = ("cases", "schema")  # compute nothing


class LazyGroup(click.Group):
    """A group that imports only the command that is called."""

    def list_commands(self, _ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, _ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        if name not in LIGHT:
            require_memory()
        module, summary = COMMANDS[name]
        command: click.Command = importlib.import_module(module).command
        command.name = name
        command.help = command.help or summary
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does; a name that is no command is told with the nearest ones."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            ctx.fail(f"No such command {name!r}. {did_you_mean(name, COMMANDS, '`frb --help` lists them.')}")
        return super().resolve_command(ctx, args)

    def format_commands(self, _ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, summary) for name, (_, summary) in COMMANDS.items()])


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="frb", message="%(prog)s %(version)s")
def frb() -> None:
    """Rotordynamics of light, fast rotors in fluid film bearings.

    CASE is a TOML file that describes rotor, bearings and oil, or the name of a shipped case.
    """


def run(arguments: Sequence[str]) -> int:
    """Run `frb` with `arguments` and return its exit code. What is neither FrbError nor click's is a bug and passes."""
    spare: bytearray | None = None
    try:
        spare = reserve()
        code = frb.main(list(arguments), prog_name="frb", standalone_mode=False)
    except click.Abort:  # click turns KeyboardInterrupt into it
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except click.exceptions.NoArgsIsHelpError as nothing_asked:
        nothing_asked.show()
        return nothing_asked.exit_code
    except click.ClickException as wrong_usage:
        told = io.StringIO()
        wrong_usage.show(told)
        click.echo(printable(told.getvalue()), nl=False, err=True)
        _emit_error(arguments, InputError("command line", (_usage_fault(wrong_usage),)))
        return wrong_usage.exit_code if isinstance(wrong_usage, click.UsageError) else InputError.exit_code
    except FrbError as error:
        return _tell_error(arguments, error)
    except Exception as error:
        del spare
        if isinstance(error, OSError) and error.errno in FULL:  # temporary files, or numba's cache
            where = "" if error.filename is None else f": {error.filename}"
            return _tell_error(arguments, FrbError(f"{error.strerror}{where}"))
        short = shortage(error)
        if short is None:
            raise
        return _tell_error(arguments, short)
    return code if isinstance(code, int) else 0


def _tell_error(arguments: Sequence[str], error: FrbError) -> int:
    click.echo(printable(f"frb: {error}"), err=True)
    _emit_error(arguments, error)
    return error.exit_code


def _usage_fault(error: click.ClickException) -> Fault:
    context = getattr(error, "ctx", None)
    path = "frb" if context is None else context.command_path
    return Fault("command line", "", None, error.format_message(), f"See `{path} --help`.")


def _emit_error(arguments: Sequence[str], error: FrbError) -> None:
    """With --json an error is one JSON document on stdout as well."""
    if "--json" not in arguments:
        return
    document: dict[str, object] = {"command": next((word for word in arguments if word in COMMANDS), None)}
    if isinstance(error, InputError):
        faults = [
            {"key": f.key, "value": f.value, "line": f.line, "problem": f.problem, "remedy": f.remedy}
            for f in error.faults
        ]
        document |= {"status": "input-error", "source": error.source, "faults": faults}
    else:
        document |= {"status": "not-converged" if isinstance(error, NotConverged) else "error", "message": str(error)}
    Terminal(json=True).emit(document)
