"""The argument CASE with --set, the options --json and --quiet, and the terminal of all commands.

A command is written as

    @click.command(cls=Command)
    @case_argument
    @output_options
    def command(case: Case, terminal: Terminal) -> int | None: ...

and returns its exit code (None is 0). Errors are raised as FrbError; `frbcli.cli.main` reports them.
"""

from __future__ import annotations

import functools
import itertools
import json
import logging
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from shutil import get_terminal_size
from textwrap import fill
from typing import TYPE_CHECKING, Any, TextIO, TypeVar, cast

import click

from frbcli.cli.options import INPUT, PER_MINUTE, Look, complete_case, complete_key, look_of, note_read
from frbcli.cli.process import OutputLost
from frbcli.errors import printable
from frbcli.units import HERTZ, SpeedUnit

if TYPE_CHECKING:
    from rich.console import Console

    from frbcli import columns as declared
    from frbcli.case.schema import Case

Function = TypeVar("Function", bound=Callable[..., Any])

RUN_SUFFIX = ".h5"
DEFAULT_LOOK = Look()
WIDTH = 80  # columns of sentences
LONGEST_LINE = 120  # columns of errors on a wide terminal
PIPE_WIDTH = 80  # columns of a table in a pipe or a file
BETWEEN = 3  # blanks between its columns; one more at both edges together

SETTING = "Set a key of CASE, e.g. --set bearing.clearance='40 um'."

_JSON = "frbcli.json"
_SETTINGS = "frbcli.settings"


@dataclass(frozen=True)
class Terminal:
    """Where a command speaks.

    Results, with their limits and files, go to stdout. Remarks, which are progress and advice, go to stderr. With json
    stdout holds one JSON document instead of the results; with quiet there is no text.
    """

    json: bool = False
    quiet: bool = False
    look: Look = DEFAULT_LOOK  # of the pictures
    speeds: SpeedUnit = HERTZ  # of the rotor, in tables and sentences

    def with_speeds_in(self, unit: SpeedUnit) -> Terminal:
        """This terminal, whose reader takes rotor speeds in another unit, in pictures, too; --rpm overrides Hz."""
        unit = replace(unit, rpm=unit.rpm or self.look.rpm or self.speeds.rpm)
        return replace(self, speeds=unit, look=replace(self.look, rpm=unit.rpm))

    @property
    def live(self) -> bool:
        """Whether stderr is a terminal, on which a progress line can be redrawn."""
        return not self.quiet and sys.stderr.isatty()

    def result(self, text: str = "") -> None:
        """Print a part of the results, without control characters other than new lines."""
        if not self.silent:
            _write(sys.stdout, f"{printable(text)}\n")

    def sentence(self, text: str) -> None:
        """Print sentences, a part of the results, in lines of WIDTH columns."""
        self.result(wrapped(text))

    def show(self, title: str, table: declared.Table, name: str = "") -> None:
        """Print the columns of a result that are declared for the table of the terminal with this name."""
        table = table.with_speeds_in(self.speeds)
        self.table(title, table.heads(name), table.cells(name), table.spans(name))

    def table(
        self, title: str, columns: Sequence[str], rows: Iterable[Sequence[object]], spans: Sequence[int] = ()
    ) -> None:
        """Print a table, a part of the results, without a head where no column has a name; several, which repeat the
        first column, where one would be too wide for its words. rows: as many cells as columns each, shown by str();
        spans: numbers of columns, one after another, that stay in one table."""
        if self.silent:
            return
        from rich import box
        from rich.table import Table
        from rich.text import Text

        cells = [[printable(str(cell)) for cell in row] for row in rows]
        terminal = console(sys.stdout)
        for kept in _parts(columns, cells, terminal.width, spans or (1,) * len(columns)):
            named, shown = [columns[k] for k in kept], [[row[k] for k in kept] for row in cells]
            table = Table(title=title or None, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
            table.show_header = any(named)
            for column, width in zip(named, _widths(named, shown, terminal.width), strict=True):
                table.add_column(column, overflow="fold", width=width)
            for row in shown:
                table.add_row(*map(Text, row))
            with suppress(OutputLost):
                terminal.print(table)
            title = ""

    def remark(self, text: str) -> None:
        """Print progress or advice."""
        if not self.quiet:
            _write(sys.stderr, f"{printable(text)}\n")

    def text(self, text: str) -> None:
        """Print a requested text, also with --quiet; with --json it is in the document instead."""
        if not self.json:
            _write(sys.stdout, text)

    def emit(self, document: Mapping[str, object]) -> None:
        """Print the command's one JSON document on stdout if --json was given; NaN and infinities become null."""
        if self.json:
            text = json.dumps(_plain(document), indent=2, ensure_ascii=False, allow_nan=False)
            _write(sys.stdout, "".join(map(_as_json, text)) + "\n")

    @property
    def silent(self) -> bool:
        """Whether results are not printed as text."""
        return self.quiet or self.json


def wrapped(text: str) -> str:
    """Sentences in lines of WIDTH columns."""
    return fill(text, WIDTH, break_long_words=False, break_on_hyphens=False)


def within_terminal(line: str) -> str:
    """A line as lines that fit the terminal, without a word cut; those behind the first are indented by two more."""
    indent = line[: len(line) - len(line.lstrip(" "))]
    width = min(get_terminal_size().columns, LONGEST_LINE)
    return fill(line, width, subsequent_indent=f"{indent}  ", break_long_words=False, break_on_hyphens=False)


def _parts(
    columns: Sequence[str], rows: Sequence[Sequence[str]], width: int, spans: Sequence[int]
) -> list[list[int]]:
    """The columns of each of the tables, by their numbers, in which no word is broken; each begins with the first.

    Columns of one of the spans stay in one table if they fit into one.
    """
    words = [_longest_word(column) for column in zip(columns, *rows, strict=True)]

    def fit(kept: Sequence[int]) -> bool:
        return sum(words[k] for k in kept) <= width - BETWEEN * len(kept) - 1

    parts: list[list[int]] = [[0]]
    for last, span in zip(itertools.accumulate(spans), spans, strict=True):
        together = [k for k in range(last - span, last) if k > 0]
        if len(parts[-1]) > 1 and not fit([*parts[-1], *together]) and fit([0, *together]):
            parts.append([0])
        for number in together:
            if len(parts[-1]) > 1 and not fit([*parts[-1], number]):
                parts.append([0])
            parts[-1].append(number)
    return parts


def _longest_word(column: Sequence[str]) -> int:
    return max((len(word) for cell in column for word in cell.split()), default=1)


def _widths(columns: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> list[int | None]:
    """Widths of the columns of a table wider than `width`: at least their longest words; the rest of the room goes to
    the cells, then to the heads. None where all fits, or where not even the words do."""
    cells = list(zip(*rows, strict=True)) or [()] * len(columns)
    widths = [_longest_word((head, *column)) for head, column in zip(columns, cells, strict=True)]
    rows_need = [max((_length(cell) for cell in column), default=0) for column in cells]
    whole = [max(_length(head), most) for head, most in zip(columns, rows_need, strict=True)]
    room = width - BETWEEN * len(columns) - 1
    if sum(whole) <= room or sum(widths) > room:
        return [None] * len(columns)
    for wanted in (rows_need, whole):
        widths = _widened(widths, wanted, room - sum(widths))
    return list(widths)


def _length(cell: str) -> int:
    return max(map(len, cell.split("\n")))


def _widened(widths: Sequence[int], wanted: Sequence[int], room: int) -> list[int]:
    """Widths with more room: columns that need no more than an equal share get all they need, the others a share in
    proportion to their need."""
    needs, widened = [max(most - least, 0) for most, least in zip(wanted, widths, strict=True)], list(widths)
    order = sorted(range(len(needs)), key=needs.__getitem__)
    for place, number in enumerate(order):
        more, left = needs[number], sum(needs[k] for k in order[place:])
        if more * (len(order) - place) > room:
            more = room * more // left
        widened[number], room = widened[number] + more, room - more
    return widened


def _write(stream: TextIO, text: str) -> None:
    """Write at once. `frbcli.cli.process` reports a stdout that cannot be written at the end."""
    with suppress(OutputLost):
        stream.write(text)
        stream.flush()


def console(stream: TextIO) -> Console:
    """A rich console on a stream; in a pipe or file its tables have no colours, and one width on all machines."""
    from rich.console import Console

    if stream.isatty():
        return Console(file=stream, highlight=False, markup=False, emoji=False)
    return Console(
        file=stream, force_terminal=False, no_color=True, width=PIPE_WIDTH, highlight=False, markup=False, emoji=False
    )


settings_option = click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", shell_complete=complete_key,
                               help=f"{SETTING} Repeatable.")  # fmt: skip


def case_argument(
    function: Function, load: Callable[..., object] | None = None, metavar: str = "CASE"
) -> Function:
    """Give a command the argument CASE and the option --set; it receives the loaded `case: Case`."""
    settings = click.option(
        "--set",
        multiple=True,
        metavar="KEY=VALUE",
        is_eager=True,  # CASE is loaded with the settings, so they come first
        expose_value=False,
        callback=_remember_settings,
        shell_complete=complete_key,
        help=f"{SETTING} Repeatable.",
    )
    case = click.argument("case", metavar=metavar, callback=load or _load, shell_complete=complete_case)
    return case(settings(function))


def case_or_run_argument(function: Function) -> Function:
    """Give a command the argument CASE or RUN.h5, and --set; it receives the loaded case or the path of the run."""
    return case_argument(function, _load_or_path, "CASE|RUN.h5")


def output_options(function: Function) -> Function:
    """Give a command the options --json and --quiet; it receives `terminal: Terminal`."""
    as_json = click.option(
        "--json",
        is_flag=True,
        is_eager=True,  # the terminal is made of both options, in the callback of --quiet
        expose_value=False,
        callback=_remember_json,
        help="Print the results as one JSON document.",
    )
    quiet = click.option("--quiet", "terminal", is_flag=True, callback=_terminal, help="Print errors only.")
    return as_json(quiet(_with_speeds_of_case(function)))


def _with_speeds_of_case(function: Function) -> Function:
    """Speeds in the unit of the case, or in rpm where an option asks for it or is given so."""

    @functools.wraps(function)
    def command(*arguments: Any, **options: Any) -> Any:
        case, terminal = options.get("case"), options["terminal"]
        asked = SpeedUnit(bool(click.get_current_context().meta.get(PER_MINUTE)))
        unit = getattr(case, "speed_unit", HERTZ)
        options["terminal"] = terminal = terminal.with_speeds_in(replace(unit, rpm=unit.rpm or asked.rpm))
        if case is not None and terminal.speeds.rpm and not unit.rpm and hasattr(case, "with_speed_unit"):
            options["case"] = case.with_speed_unit(terminal.speeds)
        return function(*arguments, **options)

    return cast(Function, command)


def _remember_settings(context: click.Context, _: click.Parameter, settings: tuple[str, ...]) -> None:
    context.meta[_SETTINGS] = settings


def _remember_json(context: click.Context, _: click.Parameter, as_json: bool) -> None:
    context.meta[_JSON] = as_json


def _terminal(context: click.Context, _: click.Parameter, quiet: bool) -> Terminal:
    logging.getLogger("frbcli").setLevel(logging.ERROR if quiet else logging.NOTSET)
    return Terminal(json=bool(context.meta.get(_JSON)), quiet=quiet, look=look_of(context))


def _load(context: click.Context, _: click.Parameter, source: str) -> Case:
    from frbcli.case.reading.load import load_case

    note_read(Path(source), context)
    return load_case(source, context.meta.get(_SETTINGS, ()))


def _load_or_path(context: click.Context, option: click.Parameter, source: str) -> Case | Path:
    return INPUT.convert(source, option, context) if source.endswith(RUN_SUFFIX) else _load(context, option, source)


def _as_json(letter: str) -> str:
    """A letter as JSON prints it: control characters are escaped."""
    return letter if letter.isprintable() or letter == "\n" else json.dumps(letter)[1:-1]


def _plain(value: object) -> object:
    """`value` as JSON knows it: arrays as lists, paths as text, what is not finite as null."""
    match value:
        case float():
            return value if math.isfinite(value) else None
        case None | str() | int():
            return value
        case Mapping():
            return {str(key): _plain(item) for key, item in value.items()}
        case PurePath():
            return str(value)
    if hasattr(value, "tolist"):  # arrays and scalars of numpy, without importing it
        return _plain(value.tolist())
    return [_plain(item) for item in cast("Iterable[object]", value)]
