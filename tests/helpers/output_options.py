"""All options of the commands by which results are written, from the code, and a quick call for each."""

from typing import NamedTuple

import click

from frbcli.cli.main import COMMANDS, command_named
from frbcli.cli.options import InputFile, OutputFile, OutputFolder

SETTINGS = ("film.theory=short", "speed.duration=0.1 s")  # of a run of jeffcott that takes no time
SHORT = tuple(word for setting in SETTINGS for word in ("--set", setting))
MODELS = ("--cavitation", "half-sommerfeld,sommerfeld")
CASE, RUN, TABLE = "my.toml", "whole.h5", "measured.csv"


class Option(NamedTuple):
    """An option of a command by which a file, or a directory of files, is written."""

    command: str
    name: str
    folder: bool
    suffix: str  # that its name has to have; "" for several


def parameters(command: str) -> list[click.Parameter]:
    return command_named(command).params


def output_options() -> list[Option]:
    return [
        Option(command, max(option.opts, key=len), isinstance(option.type, OutputFolder), option.type.suffix)
        for command in COMMANDS
        for option in parameters(command)
        if isinstance(option.type, OutputFile)
    ]


def other_paths() -> list[tuple[str, str | None]]:
    """Parameters that are paths and neither read nor written by the types of `frbcli.cli.options`."""
    return [
        (command, option.name)
        for command in COMMANDS
        for option in parameters(command)
        if isinstance(option.type, click.Path) and not isinstance(option.type, InputFile | OutputFile)
    ]


# What is called beside the option; the files are those that `read_files` has written.
CALLS: dict[str, list[str]] = {
    "rotation": ["rotation", "bearing.toml", "--set", "accuracy.mesh=[4, 16]", "--cavitation", "half-sommerfeld"],
    "squeeze": ["squeeze", "squeeze", "--set", "motion.periods=0.1", "--set", "accuracy.mesh=[4, 16]"],
    "whirl": ["whirl", "whirl", "--set", "motion.periods=0.1", "--set", "accuracy.mesh=[4, 16]"],
    "runup": ["runup", CASE, *SHORT],
    "rundown": ["rundown", CASE, *SHORT],
    "waterfall": ["waterfall", RUN, "--window", "10 ms"],
    "plot": ["plot", RUN],
    "compare": ["compare", CASE, *SHORT, "--cavitation", "half-sommerfeld,sommerfeld"],
    "bearing": ["bearing", CASE, "--speed", "50 Hz", "--set", "accuracy.mesh=[4, 16]"],
    "thrust": ["thrust", "thrust", "--gap", "12 um", "--speed", "900 Hz"],
    "fit": ["fit", CASE, *SHORT, "--measured", RUN, "--vary", "rotor.unbalance"],
    "balance": ["balance", RUN, "--planes", "disk"],
    "stability": ["stability", CASE, *SHORT, "--speed", "30 Hz"],
    "response": ["response", CASE, *SHORT, "--speed", "30 Hz", "--run", RUN],
    "limit-cycles": ["limit-cycles", CASE, *SHORT, "--set", "speed.to=100 Hz", "--runs", RUN],
    "accuracy": ["accuracy", CASE, *SHORT, "--theory", "short", "--until", "10 ms"],
    "sweep": ["sweep", CASE, *SHORT, "--list", "points.csv", "--stability", "--jobs", "1"],
    "report": ["report", RUN],
    "export": ["export", RUN],
    "cases": ["cases", "jeffcott"],
}
