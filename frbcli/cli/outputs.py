"""The picture and the table of a command: their options, their places, which are checked before the work, and how they
written. A picture next to results never affects them: a failure is a remark."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from frbcli.cli.common import Terminal
from frbcli.cli.files import CSV_FILE, OUTPUT, check_outputs, force_option, forced
from frbcli.cli.options import gathered, look_options
from frbcli.cli.progress import drawing
from frbcli.errors import InputError

if TYPE_CHECKING:
    from frbcli.columns import Tabular
    from frbcli.plot.style import Picture
    from frbcli.results.files.write import Kind

Function = TypeVar("Function", bound=Callable[..., object])

MISSING = re.compile(r"Glyph (\d+) .*missing from")  # how matplotlib begins its warning of a letter


@dataclass(frozen=True)
class Outputs:
    """The picture and the table that a command writes in addition to its text, None for none."""

    picture: Path | None
    csv: Path | None

    def write(
        self, terminal: Terminal, table: Tabular, what: str = "picture", picture: Callable[[], Picture] | None = None
    ) -> dict[str, Path | None]:
        """Write picture and table of a result, and return their paths as parts of a JSON document. what: the name of
        the picture in the text; picture: drawn instead of the picture of the table."""
        if self.csv is not None:
            from frbcli.results.files.write import write_table

            write_table(table.to_pandas(), self.csv, forced())
            terminal.result(f"table: {self.csv}")
        if self.picture is None:
            return {"picture": None, "csv": self.csv}
        return {"picture": draw(terminal, picture or partial(picture_of, table), self.picture, what), "csv": self.csv}


def picture_of(result: object) -> Picture:
    """The picture of a result. Raises InputError where there is none. What draws is imported here."""
    from frbcli.plot.picture import picture

    return picture(result)


@dataclass(frozen=True)
class OutputOptions:
    """The options -o, --picture and --csv of a command."""

    output: Path | None
    picture: bool
    csv: Path | None

    def check(self, default: Path, *others: tuple[Path | None, Kind]) -> Outputs:
        """The places of picture and table, default: of the picture. Raises UsageError or InputError, before the work,
        if these files, or others that the command writes, cannot be written."""
        from frbcli.results.files.write import TABLES

        if self.output is not None and not self.picture:
            raise click.UsageError("-o names the picture that --no-picture leaves out.")
        picture = self.output or default if self.picture else None
        check_outputs((self.csv, TABLES["csv"]), *others, picture=picture)
        return Outputs(picture, self.csv)


def picture_option(default: str) -> Callable[[Function], Function]:
    """Give a command the option -o, the file of its picture; default: its name, for the help."""
    words = "Picture as PNG, PDF or SVG."
    return click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, show_default=default, help=words)


picture_switch = click.option("--picture/--no-picture", default=True, show_default=True, help="Draw a picture or not.")
csv_option = click.option("--csv", metavar="FILE.csv", type=CSV_FILE, help="Write the table of all results, too.")


def outputs_options(default: str) -> Callable[[Function], Function]:
    """Give a command -o, --picture, --csv, --force and the options of the look; it receives `outputs`, which are
    OutputOptions."""
    def decorated(function: Function) -> Function:
        gathering = gathered("outputs", OutputOptions)(function)
        return picture_option(default)(picture_switch(csv_option(force_option()(look_options(gathering)))))

    return decorated


def draw(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path | None:
    """Draw a picture of printed results. None if that fails, with the reason as a remark."""
    try:
        return draw_wanted(terminal, picture, target, what)
    except InputError as error:
        reason = " ".join(f"{fault.problem} {fault.remedy}" for fault in error.faults)
    except Exception as error:  # of the fonts, of the memory, of matplotlib: the results stand without a picture
        reason = f"{type(error).__name__}: {error}"
    terminal.remark(f"No picture {target}: {_one_line(reason)}")
    return None


def draw_wanted(terminal: Terminal, picture: Callable[[], Picture], target: Path, what: str = "picture") -> Path:
    """Draw the picture that a command is for. Raises InputError if it cannot be written."""
    look = terminal.look
    with drawing(terminal), warnings.catch_warnings(record=True) as caught:
        from frbcli.plot.picture import fit
        from frbcli.plot.style import save_figure

        warnings.filterwarnings("always", message="Glyph")
        figure = fit(picture(), look.size_in, look.x_limits, look.y_limits, look.rpm)
        save_figure(figure, target, look.dpi, forced())
    terminal.result(f"{what}: {target}")
    texts = [str(warning.message) for warning in caught]
    letters = dict.fromkeys(chr(int(match[1])) for match in map(MISSING.match, texts) if match)
    if letters:
        shown = ", ".join(letter if letter.isprintable() else repr(letter) for letter in letters)
        terminal.remark(f"{target}: the font has no {shown}; boxes are drawn instead.")
    for text in dict.fromkeys(text for text in texts if not MISSING.match(text)):
        terminal.remark(f"{target}: {_one_line(text)}")
    return target


def _one_line(text: str) -> str:
    return " ".join(text.split())
