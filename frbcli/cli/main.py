"""`frb`: the table of commands, and the one place where errors become exit codes.

Exit codes: 0 done; 2 the input is wrong; 3 the run ended early for a reason that it names; 130 interrupted; 1 a bug, or
too little memory; `process.main` adds the codes for streams that cannot be written. docs/command-line.md lists the
codes of each command.
"""

from __future__ import annotations

import errno
import importlib
import os
import sys
from collections.abc import Sequence

import click

from frbcli import __version__
from frbcli.cli.process import require_memory, reserve, shortage
from frbcli.errors import INTERRUPTED, FrbError, InputError, input_error, printable

# name: (module of the command, with its name there where a module has several; one line of help; an example);
# the module is imported when its command is called
COMMANDS = {
    "check": (
        "frbcli.cli.check",
        "Validate a case; show its loads, speeds and what will be modelled.",
        "frb check jeffcott --set bearing.clearance='40 um'",
    ),
    "rotation": (
        "frbcli.cli.studies.bearing:rotation",
        "Turn a journal at a displacement or under a load; compare models.",
        "frb rotation bearing-axial-groove --cavitation half-sommerfeld,elrod",
    ),
    "squeeze": (
        "frbcli.cli.studies.bearing:squeeze",
        "Move a journal up and down: force over time.",
        "frb squeeze squeeze --set motion.periods=1",
    ),
    "whirl": (
        "frbcli.cli.studies.bearing:whirl",
        "Move a journal on a circle: pressure over time.",
        "frb whirl whirl --set motion.periods=1",
    ),
    "runup": (
        "frbcli.cli.transient:runup",
        "Run a rotor up and write the run to a file.",
        "frb runup jeffcott -o run.h5",
    ),
    "rundown": (
        "frbcli.cli.transient:rundown",
        "Run a rotor up, hold it, run it down.",
        "frb rundown run-down -o down.h5",
    ),
    "waterfall": (
        "frbcli.cli.run_files:waterfall",
        "Draw the spectra of a run or a measurement over time or speed.",
        "frb waterfall run.h5 --over speed --rpm",
    ),
    "plot": (
        "frbcli.cli.run_files:plot",
        "Draw eccentricities, orbits, temperatures or film signals of runs.",
        "frb plot run.h5 --what orbit --from '1 s' --to '1.1 s'",
    ),
    "compare": (
        "frbcli.cli.studies.compare:compare_models",
        "Compare models of one case, or a run with a measurement.",
        "frb compare jeffcott --cavitation half-sommerfeld,reynolds",
    ),
    "bearing": (
        "frbcli.cli.studies.bearing:bearing",
        "Static equilibrium, K, C, loss, flow of every film over speed or eccentricity.",
        "frb bearing jeffcott --speed '50 Hz' --speed '100 Hz' --csv sheet.csv",
    ),
    "thrust": (
        "frbcli.cli.studies.bearing:thrust",
        "Load, loss, flow, K and C of thrust bearings over gap, load or speed.",
        "frb thrust thrust --gap '12 um' --gap '20 um' --speed '900 Hz'",
    ),
    "fit": (
        "frbcli.cli.studies.measurements:fit_case",
        "Find numbers of a case from a measured run-up.",
        "frb fit jeffcott --measured run.h5 --vary rotor.unbalance,bearing.clearance",
    ),
    "stability": (
        "frbcli.cli.studies.stability",
        "Static equilibria, linear coefficients, eigenvalues, threshold speed.",
        "frb stability jeffcott --speed '100 Hz' --speed '200 Hz'",
    ),
    "response": (
        "frbcli.cli.studies.response",
        "Linear unbalance response over speed; map of critical speeds.",
        "frb response jeffcott --csv response.csv",
    ),
    "balance": (
        "frbcli.cli.studies.measurements:balance_rotor",
        "Correction masses from a run, by influence coefficients.",
        "frb balance run.h5 --planes disk",
    ),
    "limit-cycles": (
        "frbcli.cli.studies.limit_cycles",
        "Hopf points, limit cycles and folds over speed, stable or not.",
        "frb limit-cycles jeffcott --set film.theory=short",
    ),
    "accuracy": (
        "frbcli.cli.studies.compare:accuracy_ladder",
        "Compare cost and error of theories, meshes, tolerances, couplings.",
        "frb accuracy jeffcott --until '1 s'",
    ),
    "sweep": (
        "frbcli.cli.studies.sweep",
        "Run one case with many settings, on all cores or a cluster.",
        "frb sweep jeffcott --set bearing.clearance='30 um,35 um,40 um' --stability",
    ),
    "report": (
        "frbcli.cli.run_files:report",
        "Write a run as one page: machine, events, waterfall, orbits, errors.",
        "frb report run.h5 --speed '100 Hz'",
    ),
    "export": (
        "frbcli.cli.run_files:export",
        "Write the signals of a run as CSV, Parquet or MAT.",
        "frb export run.h5 --format mat",
    ),
    "warm-up": (
        "frbcli.cli.cases:warm_up_cases",
        "Compile the kernels of cases, or of all shipped ones, once.",
        "frb warm-up jeffcott floating-ring-heat",
    ),
    "docs": (
        "frbcli.cli.cases:docs",
        "Open the documentation that is installed with frb.",
        "frb docs tutorial",
    ),
    "cases": ("frbcli.cli.cases:cases", "List, show or copy the shipped cases.", "frb cases jeffcott -o my.toml"),
    "schema": (
        "frbcli.cli.cases:schema",
        "Print the JSON Schema of a case file for editors.",
        "frb schema > schema.json",
    ),
}

# The commands in the order of an engineer's work, as `frb --help` shows them
GROUPS = {
    "Describe a machine": ("cases", "check", "schema"),
    "Run": ("runup", "rundown"),
    "Look at a run": ("waterfall", "plot", "report", "export"),
    "Study a machine": ("stability", "response", "limit-cycles", "compare", "sweep", "accuracy"),
    "Study a bearing": ("bearing", "thrust", "rotation", "squeeze", "whirl"),
    "Use a measurement": ("fit", "balance"),
    "Help": ("docs", "warm-up"),
}
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # a disk
INSTEAD = {  # of options that only other commands have
    "--set": "It changes a CASE before it is computed, and this command takes none: `frb runup CASE --set KEY=VALUE`.",
    "--over": "It is an axis of `frb bearing` and of pictures; the range of a key is `frb limit-cycles --parameter`.",
}
LIGHT = ("cases", "schema", "docs")  # compute nothing


def command_named(name: str) -> click.Command:
    """The command of a row of the table, with its help and example."""
    place, summary, example = COMMANDS[name]
    module, _, attribute = place.partition(":")
    command: click.Command = getattr(importlib.import_module(module), attribute or "command")
    command.name, command.help = name, command.help or summary
    command.epilog = f"\b\nExample:\n  {example}"
    return command


class LazyGroup(click.Group):
    """A group that imports only the command that is called."""

    def list_commands(self, _ctx: click.Context) -> list[str]:
        """Names of all commands."""
        return list(COMMANDS)

    def get_command(self, _ctx: click.Context, name: str) -> click.Command | None:
        """Import the command of a name; None if there is no such command."""
        if name not in COMMANDS:
            return None
        if name not in LIGHT:
            require_memory()
        return command_named(name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find a command as click does; the error for an unknown name proposes the nearest ones."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            from frbcli.errors import did_you_mean

            ctx.fail(f"No such command {name!r}. {did_you_mean(name, COMMANDS, '`frb --help` lists them.')}")
        return super().resolve_command(ctx, args)

    def format_commands(self, _ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands with their help, group by group, without importing them."""
        longest = max(map(len, COMMANDS))
        for group, names in GROUPS.items():
            with formatter.section(group):
                formatter.write_dl([(f"{name:<{longest}}", COMMANDS[name][1]) for name in names])


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
    except click.Abort as aborted:  # click turns KeyboardInterrupt into it, and EOFError as well, which is a bug
        if isinstance(aborted.__cause__, EOFError):
            raise aborted.__cause__ from None
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except click.exceptions.NoArgsIsHelpError as nothing_asked:
        nothing_asked.show()
        return nothing_asked.exit_code
    except click.ClickException as wrong_usage:
        if isinstance(wrong_usage, click.NoSuchOption) and wrong_usage.option_name in INSTEAD:
            problem = f"No such option '{wrong_usage.option_name}'. {INSTEAD[wrong_usage.option_name]}"
            wrong_usage = click.UsageError(problem, wrong_usage.ctx)
        return _show_error(arguments, _usage_error(wrong_usage))
    except FrbError as error:
        return _show_error(arguments, error)
    except Exception as error:
        del spare
        known = _of_files(error) or shortage(error)
        if known is None:
            raise
        return _show_error(arguments, known)
    return code if isinstance(code, int) else 0


def _of_files(error: Exception) -> FrbError | None:
    """The error that the system had with a file, wherever that was met; None for any other one."""
    if not isinstance(error, OSError) or error.errno is None:
        return None
    if error.errno in FULL:  # temporary files, or numba's cache
        where = "" if error.filename is None else f": {error.filename}"
        return FrbError(f"{error.strerror}{where}")
    if error.filename is None:
        return None
    name = os.fsdecode(error.filename) if isinstance(error.filename, str | bytes) else str(error.filename)
    return input_error(f"file {name}", "file", "", f"cannot be used: {error.strerror}.", "Check path and permissions.")


def _show(text: str) -> None:
    """Write an error; on a terminal in lines that fit it, elsewhere a line for each fault."""
    lines = printable(text).split("\n")
    if sys.stderr.isatty():
        from frbcli.cli.common import within_terminal

        lines = [within_terminal(line) for line in lines]
    click.echo("\n".join(lines), err=True)


def _show_error(arguments: Sequence[str], error: FrbError) -> int:
    _show(f"frb: {error}")
    _emit_error(arguments, error)
    return error.exit_code


def _usage_error(error: click.ClickException) -> InputError:
    context = getattr(error, "ctx", None)
    path = "frb" if context is None else context.command_path
    return input_error("command line", path, "", error.format_message(), f"See `{path} --help`.")


def _emit_error(arguments: Sequence[str], error: FrbError) -> None:
    """With --json an error is one JSON document on stdout as well."""
    if "--json" not in arguments:
        return
    from frbcli.cli.common import Terminal

    command = next((word for word in arguments if word in COMMANDS), None)
    Terminal(json=True).emit({"command": command, **error.document})
