"""The look of pictures, by options of all commands that draw: size, resolution, limits, speeds per minute."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import click

Function = TypeVar("Function", bound=Callable[..., Any])

_LOOK = "frbcli.look"
INCH = 0.0254  # m
DPI = 150


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
