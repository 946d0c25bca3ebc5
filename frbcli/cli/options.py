"""Options that several commands have, each declared once, and the kinds of their values; what the shell completes
besides commands and options: shipped cases, files, keys of a case; and the look of pictures, by options of all commands
that draw: size, resolution, limits, speeds per minute.

The files of a command are options, too: those that it reads, and where its results go, which do not replace them.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.results.write import Kind


Function = TypeVar("Function", bound=Callable[..., Any])

# Options that many commands share, by the head under which a help lists them below the options of the command itself.
SECTIONS = {
    "Measurement": ("--x", "--y", "--time", "--rate", "--speed-column", "--speed-time", "--speed-at", "--tacho",
                    "--pulses", "--slow-roll", "--unit", "--time-unit", "--speed-unit", "--clearance"),
    "Picture": ("--picture", "--size", "--dpi", "--xlim", "--ylim", "--rpm"),
    "Output": ("--csv", "--force", "--json", "--quiet", "--help"),
}  # fmt: skip


class Command(click.Command):
    """A command whose help lists its own options first, then SECTIONS."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, section by section."""
        sections: dict[str, list[tuple[str, str]]] = {name: [] for name in ("Options", *SECTIONS)}
        for param in self.get_params(ctx):
            row = param.get_help_record(ctx) if isinstance(param, click.Option) else None
            if row is not None:
                own = (name for name, shared in SECTIONS.items() if param.opts[-1] in shared)
                sections[next(own, "Options")].append(row)
        for name, rows in sections.items():
            if rows:
                with formatter.section(name):
                    formatter.write_dl(rows)


PER_MINUTE = "frbcli.per_minute"  # of the context: whether an option gives a speed in rpm
_LOOK = "frbcli.look"
NUMBER = "0123456789.eE+-"  # letters of one
INCH = 0.0254  # m
DPI = 150
COMMON = ("rotor.unbalance", "bearing.clearance", "oil.viscosity", "film.theory", "film.cavitation", "speed.from",
          "speed.to", "speed.duration", "accuracy.target", "output.step")  # fmt: skip


class WrittenOption(click.ParamType[Any]):
    """A value that is written as text; a default, which has its form already, stays."""

    def read(self, text: str) -> Any:
        """The value of a text. Raises ValueError with what is wrong."""
        raise ValueError(text)

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The value of an option, which fails where the text is none."""
        try:
            return self.read(value) if isinstance(value, str) else value
        except ValueError as fault:
            listed = isinstance(param, click.Option) and param.multiple and "," in str(value)
            self.fail(f"{value!r} {fault}{' Repeat the option for several values.' if listed else ''}", param, ctx)


@dataclass(frozen=True)
class QuantityOption(WrittenOption):
    """A quantity with a unit, as in the example; a bare number is in `unit`, SI. positive: it must be above 0."""

    name: str
    unit: str
    example: str
    positive: bool = True

    def read(self, text: str) -> Any:
        """The number of a quantity in `unit`."""
        from frbcli.units import is_per_minute, quantity

        given: object = text
        with suppress(ValueError):  # then it has a unit
            given = float(text)
        number = quantity(given, self.unit, self.example)
        context = click.get_current_context(silent=True)
        if self.unit == "Hz" and context is not None and is_per_minute(text):
            context.meta[PER_MINUTE] = True
        if self.positive and number <= 0.0:
            raise ValueError(f'is not greater than 0. Write e.g. "{self.example}".')
        return number


@dataclass(frozen=True)
class UnitOption(QuantityOption):
    """A unit, alone, such as "um", or as a multiple of one, such as "125 um"."""

    def read(self, text: str) -> Any:
        """The size of the unit in `unit`: 1e-6 for "um" in m."""
        text = text.strip()
        return super().read(f"1 {text}" if text[:1].isalpha() or text.startswith("1/") else text)


def range_ends(text: str) -> tuple[str, str] | None:
    """The ends of a range such as "30..45 um": a unit at the end holds for both. None for no range."""
    low, _, high = (part.strip() for part in text.partition(".."))
    if not low or not high:
        return None
    return (f"{low} {high.lstrip(NUMBER)}".strip() if not low.lstrip(NUMBER) else low), high


@dataclass(frozen=True)
class RangeOption(QuantityOption):
    """Two quantities, as "8000..12000 rpm": a unit at the end holds for both."""

    def read(self, text: str) -> Any:
        """The lower and the upper one in `unit`."""
        texts = range_ends(text)
        if texts is None:
            raise ValueError(f'is no range. Write e.g. "{self.example}".')
        low, high = map(super().read, texts)
        if low > high:
            raise ValueError(f'does not ascend. Write e.g. "{self.example}".')
        return low, high


@dataclass(frozen=True)
class SupportOption(QuantityOption):
    """The support of a rotor: "free", "bearings" as in the case, or a stiffness."""

    def read(self, text: str) -> Any:
        """The word, or the stiffness in `unit`."""
        return text if text in ("free", "bearings") else super().read(text)


@dataclass(frozen=True)
class KeyRange:
    """A number of a case, from a value to another one, as texts with units."""

    key: str
    low: str
    high: str


class KeyRangeOption(WrittenOption):
    """A key and its range, as bearing.clearance=30..45 um."""

    name = "range"

    def read(self, text: str) -> KeyRange:
        """Key and range."""
        key, _, span = text.partition("=")
        ends = range_ends(span)
        if not key.strip() or ends is None:
            raise ValueError("is no range of a key. Write e.g. bearing.clearance='30..45 um'.")
        return KeyRange(key.strip(), *ends)


class GradeOption(WrittenOption):
    """A balance quality grade, in mm/s."""

    name = "grade"

    def read(self, text: str) -> float:
        """Its number."""
        from frbcli.linear.balance_quality import read_grade

        return read_grade(text)


KEY_RANGE = KeyRangeOption()
OPERATING_OPTION = RangeOption("range", "Hz", "8000..12000 rpm")
SPEED_OPTION = QuantityOption("speed", "Hz", "25 Hz")
REST_OPTION = QuantityOption("speed", "Hz", "25 Hz", positive=False)
TIME_OPTION = QuantityOption("time", "s", "0.2 s", positive=False)
LENGTH_OPTION = QuantityOption("length", "m", "35 um")
LOAD_OPTION = QuantityOption("load", "N", "30 N")
STIFFNESS_OPTION = SupportOption("stiffness", "N/m", "5e6 N/m")


class Names(WrittenOption):
    """Names separated by commas."""

    name = "names"

    def read(self, text: str) -> tuple[str, ...]:
        """The names without spaces around them."""
        return tuple(name.strip() for name in text.split(",") if name.strip())


class Numbers(WrittenOption):
    """Numbers separated by commas."""

    name = "numbers"

    def read(self, text: str) -> tuple[float, ...]:
        """The numbers in their order."""
        try:
            return tuple(map(float, text.split(",")))
        except ValueError:
            raise ValueError("is not a list of numbers, such as 1,0.5.") from None


def _models(name: str, what: str, of: str, default: str = "as in CASE") -> Callable[[Function], Function]:
    """of: the names that the case file knows; written here, for a help that imports none of them."""
    return click.option(name, type=Names(), default=(), metavar="A,B", show_default=default, help=f"{what}: {of}.")


cavitation_option = _models(
    "--cavitation", "Cavitation models",
    "sommerfeld, half-sommerfeld, reynolds, penalty, peeken, barotropic, elrod, two-phase, bubbly",
)  # fmt: skip
coupling_option = _models(
    "--coupling", "Couplings of rotor and films",
    "auto, monolithic, dynamic-static, dynamic-static-semi-implicit, co-simulation",
)  # fmt: skip
thermal_option = _models("--thermal", "Models of heat", "none, lumped")


def theory_option(default: str) -> Callable[[Function], Function]:
    """Give a command the option --theory."""
    return _models("--theory", "Film theories", "short, finite, auto", default)


def speeds_option(default: str, kind: QuantityOption = SPEED_OPTION) -> Callable[[Function], Function]:
    """Give a command the option --speed, which may be repeated; default: the speeds without it, for the help."""
    return click.option("--speed", "speeds", multiple=True, type=kind, metavar="SPEED", show_default=default,
                        help='Rotor speed, e.g. "25 Hz". Repeatable.')  # fmt: skip


def _name(_: click.Context, __: click.Parameter, name: str | None) -> str | None:
    """A name of the results, in which tables and pictures show spaces."""
    return None if name is None else name.strip().replace(" ", "_")


def signal_option(default: str | None = "journal") -> Callable[[Function], Function]:
    """Give a command the option --signal, a point of the rotor."""
    words = "Point of the machine: journal, disk or support; NAME of a bearing or disk."
    return click.option("--signal", default=default, show_default=default is not None, metavar="POINT", callback=_name,
                        help=words)  # fmt: skip


def film_option(words: str, default: str) -> Callable[[Function], Function]:
    """Give a command the option --film, the name of a film."""
    return click.option("--film", metavar="FILM", callback=_name, show_default=default, help=words)


def over_option(default: str | None) -> Callable[[Function], Function]:
    """Give a command the option --over, the axis of a picture."""
    shown = default or "speed where it rises or falls all the time"
    return click.option("--over", type=click.Choice(["time", "speed"]), default=default, show_default=shown,
                        help="Horizontal axis.")  # fmt: skip


def gathered(name: str, record: type) -> Callable[[Function], Function]:
    """Give a command the options that are named as the fields of a dataclass as one argument; below the options."""
    names = [field.name for field in fields(record)]

    def decorated(function: Function) -> Function:
        @wraps(function)
        def command(**options: Any) -> Any:
            options[name] = record(**{option: options.pop(option) for option in names})
            return function(**options)

        return command  # type: ignore[return-value]

    return decorated


def complete_case(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Shipped cases that begin so, then files."""
    from frbcli.case.reading.shipped import shipped_names

    shipped = [CompletionItem(name) for name in shipped_names() if name.startswith(incomplete)]
    return [*shipped, CompletionItem(incomplete, type="file")]


def complete_key(context: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Keys of the case given earlier on the line, else the most usual ones."""
    from frbcli.case.reading.listing import values

    case = _case_on_line(context)
    keys = list(COMMON) if case is None else [value.key for value in values(case)]
    return [CompletionItem(f"{key}=") for key in keys if key.startswith(incomplete)]


def _case_on_line(context: click.Context) -> Case | None:
    """The case before an option that still lacks its value, because of which click has read no word of the line."""
    from frbcli.case.reading.load import load_case
    from frbcli.errors import InputError

    for word in context.args:
        with suppress(InputError):
            return load_case(word)
    return None


@dataclass(frozen=True)
class Look:
    """size_in: width and height in inches, x_limits, y_limits: of the axes in their own units; None for those that the
    picture has itself. rpm: rotor speeds in revolutions per minute."""

    size_in: tuple[float, float] | None = None
    dpi: int = DPI
    x_limits: tuple[float, float] | None = None
    y_limits: tuple[float, float] | None = None
    rpm: bool = False


class Size(WrittenOption):
    """Width and height, such as "160 mm x 90 mm" or "160x90 mm", in inches."""

    name = "size"

    def read(self, text: str) -> tuple[float, float]:
        """Width and height in inches."""
        from frbcli.units import quantity

        width, by, height = text.partition("x")
        if not by:
            raise ValueError('is not a width and a height. Write e.g. "160 mm x 90 mm".')
        if not any(letter.isalpha() for letter in width):
            width += " " + "".join(letter for letter in height if letter.isalpha())
        try:
            across, high = (quantity(side.strip(), "m", "160 mm") / INCH for side in (width, height))
        except ValueError as fault:
            raise ValueError(f'{fault} Write e.g. "160 mm x 90 mm".') from None
        if not (0.5 <= across <= 60.0 and 0.5 <= high <= 60.0):
            raise ValueError("is no size of a picture: 13 mm to 1500 mm.")
        return across, high


class Span(WrittenOption):
    """Two numbers, the lower one first, separated by a comma."""

    name = "span"

    def read(self, text: str) -> tuple[float, float]:
        """The lower and the upper number."""
        try:
            low, high = map(float, text.split(","))
        except ValueError:
            raise ValueError("is not two numbers, such as 0,300.") from None
        if not low < high:
            raise ValueError("does not ascend: the lower number comes first.")
        return low, high


def look_options(function: Function) -> Function:
    """Give a command --size, --dpi, --xlim, --ylim and --rpm; its terminal knows them."""
    options = (
        _option("--size", "size_in", type=Size(), metavar="SIZE", help='Size of the picture, e.g. "160 mm x 90 mm".'),
        _option("--dpi", "dpi", type=click.IntRange(30, 1200), metavar="N", default=DPI, show_default=True,
                help="Resolution of a PNG."),
        _option("--xlim", "x_limits", type=Span(), metavar="A,B", help="Limits of the horizontal axis."),
        _option("--ylim", "y_limits", type=Span(), metavar="A,B", help="Limits of the vertical axis."),
        _option("--rpm", "rpm", is_flag=True, show_default="as the case gives them", help="Rotor speeds in rpm."),
    )
    for option in reversed(options):
        function = option(function)
    return function


def look_of(context: click.Context) -> Look:
    """The look that the options of a command ask for."""
    look = context.meta.get(_LOOK, Look())
    assert isinstance(look, Look)
    return look


def _option(name: str, field: str, **settings: Any) -> Callable[[Function], Function]:
    """An option that changes one field of the look, before the terminal is made of it."""

    def remember(context: click.Context, _: click.Parameter, value: Any) -> None:
        if value is not None and value is not False:
            context.meta[_LOOK] = replace(look_of(context), **{field: value})

    return click.option(name, is_eager=True, expose_value=False, callback=remember, **settings)


_READS, _FORCE = "frbcli.reads", "frbcli.force"  # in the context of a command


class InputFile(click.Path):
    """A file that the command reads, as a Path; no result of the command replaces it."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path, which the command then does not write."""
        try:
            path = Path(os.fsdecode(super().convert(value, param, ctx)))
        except ValueError as error:  # of a name that no file can have
            self.fail(f"{value!r} is no name of a file: {error}.", param, ctx)
        note_read(path, ctx)
        return path


class InputFiles(WrittenOption):
    """Several such files, separated by commas."""

    name = "files"

    def read(self, text: str) -> tuple[Path, ...]:
        """The paths, which the command then does not write."""
        context = click.get_current_context(silent=True)
        return tuple(INPUT.convert(name.strip(), None, context) for name in text.split(",") if name.strip())


class OutputFile(click.Path):
    """A file that the command writes, as a Path. suffix: the end of its name; "" for any."""

    def __init__(self, suffix: str = "") -> None:
        super().__init__(path_type=Path)
        self.suffix = suffix

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path. Fails the option for a name with another end."""
        path = super().convert(value, param, ctx)
        if self.suffix and Path(os.fsdecode(path)).suffix.lower() != self.suffix:
            name = f"{Path(os.fsdecode(path)).stem}{self.suffix}"
            self.fail(f"{os.fsdecode(path)!r} has to end with {self.suffix}. Write -o {name}.", param, ctx)
        return path


class OutputFolder(OutputFile):
    """A directory for files that the command writes, as a Path."""


INPUT, INPUTS, OUTPUT, OUTPUT_FOLDER = InputFile(), InputFiles(), OutputFile(), OutputFolder()
CASE_FILE, RUN_FILE, PAGE_FILE, CSV_FILE = map(OutputFile, (".toml", ".h5", ".html", ".csv"))


def note_read(path: Path, context: click.Context | None) -> None:
    """Remember that a command reads a file."""
    if context is not None:
        context.meta.setdefault(_READS, []).append(path)


def force_option(
    words: str = "Replace files that frb did not write.", exposed: bool = False
) -> Callable[[Function], Function]:
    """Give a command the option --force; exposed: it receives `force: bool`."""

    def remember(context: click.Context, _: click.Parameter, force: bool) -> bool:
        context.meta[_FORCE] = force
        return force

    return click.option("--force", is_flag=True, is_eager=True, expose_value=exposed, callback=remember, help=words)


def forced() -> bool:
    """Whether the command may replace files that frb did not write."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(_FORCE))


def check_outputs(*files: tuple[Path | None, Kind], picture: Path | None = None) -> None:
    """Raises InputError, before the work, if results of the command cannot have these places.

    files: with their kinds, None is no result; picture: one more that is drawn; whoever wants none does not wait for
    the library that draws.
    """
    from frbcli.results.write import PICTURES, require_places

    wanted = [(file, kind) for file, kind in files if file is not None]
    if picture is not None:
        from frbcli.plot.style import check_picture

        check_picture(picture, forced())
        wanted.append((picture, PICTURES[picture.suffix.lower()]))
    context = click.get_current_context(silent=True)
    require_places(wanted, () if context is None else context.meta.get(_READS, ()), forced())


def next_to(run: Path, what: str) -> Path:
    """The default place of a result: next to its run."""
    return run.parent / (run.stem + what)


def here(case_name: str, what: str) -> Path:
    """The default place of the result of a case: this directory, under the name of the case, not hidden."""
    return Path((re.sub(r"[^\w.-]+", "-", case_name).lstrip(".-") or "run") + what)
