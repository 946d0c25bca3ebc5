"""A line on the error of the coefficients that a static result is made of."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from frbcli.cli.common import Terminal
    from frbcli.linear.stability_point import StabilityPoint


def errors_of(points: Iterable[StabilityPoint]) -> list[tuple[float, float]]:
    """Error of the coefficients of each film, and its speed in Hz."""
    return [(film.error, point.speed_Hz) for point in points for film in point.films]


def tell_coefficient_error(terminal: Terminal, errors: Iterable[tuple[float, float]]) -> None:
    """The largest of some errors, with their speeds in Hz."""
    known = [(error, speed) for error, speed in errors if not math.isnan(error)]
    if known:
        error, speed = max(known)
        terminal.result(
            "Expected error of the films' stiffness and damping, from other meshes: up to\n"
            f"{100.0 * error:.1g} % of their largest entry, at {speed:.4g} Hz."
        )
