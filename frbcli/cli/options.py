"""Options that several commands have, each declared once, and the kinds of their values; what the shell completes
besides commands and options: shipped cases, files, keys of a case; and the look of pictures, by options of all commands
that draw: size, resolution, limits, speeds per minute."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

if TYPE_CHECKING:
    from frbcli.case.schema import Case

Function = TypeVar("Function", bound=Callable[..., Any])

PER_MINUTE = "frbcli.per_minute"  # of the context: whether an option gives a speed in rpm
_LOOK = "frbcli.look"
INCH = 0.0254  # m
DPI = 150
COMMON = ("rotor.unbalance", "bearing.clearance", "oil.viscosity", "film.theory", "film.cavitation", "speed.from",
          "speed.to", "speed.duration", "accuracy.target", "output.step")  # fmt: skip


@dataclass(frozen=True)
class QuantityOption(click.ParamType[float]):
    """A quantity with a unit, as in the example; a bare number is in `unit`, SI. positive: it must be above 0."""

    name: str
    unit: str
    example: str
    positive: bool = True

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number of a quantity in `unit`. Fails the option for anything else."""
        from frbcli.units import is_per_minute, quantity

        with suppress(ValueError):  # then it has a unit
            value = float(str(value))
        try:
            number = quantity(value, self.unit, self.example)
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)
        if self.unit == "Hz" and ctx is not None and is_per_minute(value):
            ctx.meta[PER_MINUTE] = True
        if self.positive and number <= 0.0:
            self.fail(f'{value!r} is not greater than 0. Write e.g. "{self.example}".', param, ctx)
        return number


@dataclass(frozen=True)
class UnitOption(QuantityOption):
    """A unit, alone, such as "um", or as a multiple of one, such as "125 um"."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The size of the unit in `unit`: 1e-6 for "um" in m."""
        text = str(value).strip()
        return super().convert(f"1 {text}" if text[:1].isalpha() or text.startswith("1/") else value, param, ctx)


@dataclass(frozen=True)
class RangeOption(QuantityOption):
    """Two quantities, as "8000..12000 rpm": a unit at the end holds for both."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The lower and the upper one in `unit`."""
        if isinstance(value, tuple):
            return value
        low, dots, high = str(value).partition("..")
        if not dots:
            self.fail(f'{value!r} is no range. Write e.g. "{self.example}".', param, ctx)
        unit = high.strip().lstrip("0123456789.eE+-")
        bare = low.strip().lstrip("0123456789.eE+-") == ""
        ends = [super(RangeOption, self).convert(end, param, ctx) for end in (low + unit if bare else low, high)]
        if ends[0] > ends[1]:
            self.fail(f'{value!r} does not ascend. Write e.g. "{self.example}".', param, ctx)
        return ends[0], ends[1]


@dataclass(frozen=True)
class SupportOption(QuantityOption):
    """The support of a rotor: "free", "bearings" as in the case, or a stiffness."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The word, or the stiffness in `unit`."""
        return value if value in ("free", "bearings") else super().convert(value, param, ctx)


class GradeOption(click.ParamType[float]):
    """A balance quality grade, in mm/s."""

    name = "grade"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Its number. Fails the option for anything else."""
        from frbcli.linear.balance_quality import read_grade

        try:
            return read_grade(str(value))
        except ValueError as fault:
            self.fail(f"{value!r} {fault}", param, ctx)


OPERATING_OPTION = RangeOption("range", "Hz", "8000..12000 rpm")
SPEED_OPTION = QuantityOption("speed", "Hz", "25 Hz")
REST_OPTION = QuantityOption("speed", "Hz", "25 Hz", positive=False)
TIME_OPTION = QuantityOption("time", "s", "0.2 s", positive=False)
LENGTH_OPTION = QuantityOption("length", "m", "35 um")
LOAD_OPTION = QuantityOption("load", "N", "30 N")
STIFFNESS_OPTION = SupportOption("stiffness", "N/m", "5e6 N/m")


class Names(click.ParamType[tuple[str, ...]]):
    """Names separated by commas."""

    name = "names"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:  # noqa: ARG002
        """The names without spaces around them."""
        names = value if isinstance(value, tuple) else str(value).split(",")
        return tuple(name.strip() for name in names if name.strip())


class Numbers(click.ParamType[tuple[float, ...]]):
    """Numbers separated by commas."""

    name = "numbers"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        """The numbers in their order. Fails the option for anything else."""
        if isinstance(value, tuple):
            return value
        try:
            return tuple(float(number) for number in str(value).split(","))
        except ValueError:
            self.fail(f"{value} is not a list of numbers, such as 1,0.5.", param, ctx)


def _models(name: str, what: str, default: str = "as in CASE") -> Callable[[Function], Function]:
    return click.option(name, type=Names(), default=(), metavar="A,B", help=f"{what}, separated by commas. [{default}]")


cavitation_option = _models("--cavitation", "Cavitation models")
coupling_option = _models("--coupling", "Couplings of rotor and films")
thermal_option = _models("--thermal", "Models of heat, none or lumped")


def theory_option(default: str) -> Callable[[Function], Function]:
    """Give a command the option --theory."""
    return _models("--theory", "Film theories", default)


def speeds_option(default: str, kind: QuantityOption = SPEED_OPTION) -> Callable[[Function], Function]:
    """Give a command the option --speed, which may be repeated; default: the speeds without it, for the help."""
    words = f'Rotor speed, e.g. "25 Hz". Repeatable. [{default}]'
    return click.option("--speed", "speeds", multiple=True, type=kind, metavar="SPEED", help=words)


def signal_option(default: str | None = "journal") -> Callable[[Function], Function]:
    """Give a command the option --signal, a point of the rotor."""
    words = "Point of the machine: journal, disk or support; NAME of a bearing or disk."
    return click.option("--signal", default=default, show_default=default is not None, metavar="POINT", help=words)


def over_option(default: str | None) -> Callable[[Function], Function]:
    """Give a command the option --over, the axis of a picture."""
    words = "Horizontal axis." if default else "Horizontal axis. [speed where it rises or falls all the time]"
    return click.option("--over", type=click.Choice(["time", "speed"]), default=default,
                        show_default=default is not None, help=words)  # fmt: skip


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


@dataclass(frozen=True)
class Size(click.ParamType[tuple[float, float]]):
    """Width and height, such as "160 mm x 90 mm" or "160x90 mm", in inches."""

    name: str = "size"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Width and height in inches. Fails the option for anything but WIDTHxHEIGHT."""
        from frbcli.units import quantity

        if isinstance(value, tuple):
            return value
        width, by, height = str(value).partition("x")
        if not by:
            self.fail(f'{value!r} is not a width and a height. Write e.g. "160 mm x 90 mm".', param, ctx)
        unit = "".join(letter for letter in height if letter.isalpha())
        try:
            if not any(letter.isalpha() for letter in width):
                width = f"{width} {unit}"
            sides = tuple(quantity(side.strip(), "m", "160 mm") / INCH for side in (width, height))
        except ValueError as fault:
            self.fail(f'{value!r} {fault} Write e.g. "160 mm x 90 mm".', param, ctx)
        if not all(0.5 <= side <= 60.0 for side in sides):
            self.fail(f"{value!r} is no size of a picture: 13 mm to 1500 mm.", param, ctx)
        return sides[0], sides[1]


@dataclass(frozen=True)
class Span(click.ParamType[tuple[float, float]]):
    """Two numbers, the lower one first, separated by a comma."""

    name: str = "span"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """The lower and the upper number."""
        if isinstance(value, tuple):
            return value
        try:
            low, high = (float(number) for number in str(value).split(","))
        except ValueError:
            self.fail(f"{value!r} is not two numbers, such as 0,300.", param, ctx)
        if not low < high:
            self.fail(f"{value!r}: the lower number comes first.", param, ctx)
        return low, high


def look_options(function: Function) -> Function:
    """Give a command --size, --dpi, --xlim, --ylim and --rpm; its terminal knows them."""
    options = (
        _option("--size", "size_in", type=Size(), metavar="SIZE", help='Size of the picture, e.g. "160 mm x 90 mm".'),
        _option("--dpi", "dpi", type=click.IntRange(30, 1200), metavar="N", help=f"Resolution of a PNG. [{DPI}]"),
        _option("--xlim", "x_limits", type=Span(), metavar="A,B", help="Limits of the horizontal axis."),
        _option("--ylim", "y_limits", type=Span(), metavar="A,B", help="Limits of the vertical axis."),
        _option("--rpm", "rpm", is_flag=True, help="Rotor speeds in rpm. [as the case gives them]"),
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
