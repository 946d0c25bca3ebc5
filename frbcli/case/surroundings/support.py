"""Supports of bearings and dampers around them.

The support of a bearing: its shell as a body.

The squeeze film damper around the shell of a bearing, or around its outer ring.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from frbcli.case.film_geometry import RingFilm
from frbcli.case.model import AlsoAs, Model
from frbcli.case.quantities import Damping, ShellMass, Stiffness


def _both_directions(given: object) -> object:
    """One quantity, used for both directions."""
    if isinstance(given, str | int | float) and not isinstance(given, bool):
        return [given, given]
    return given


DIRECTIONS = (BeforeValidator(_both_directions), AlsoAs(lambda both: [both["prefixItems"][0], both]))
Stiffnesses = Annotated[tuple[Stiffness, Stiffness], *DIRECTIONS]
Dampings = Annotated[tuple[Damping, Damping], *DIRECTIONS]


class Support(Model):
    """A shell on springs and dampers, which moves in x and y without turning."""

    mass: ShellMass = Field(description="of the moving shell, per bearing")
    stiffness: Stiffnesses = Field(description="to ground or housing")
    damping: Dampings = Field(
        default=(0.0, 0.0), description="to ground or housing"
    )


NO_SPRING = (0.0, 0.0)


class Damper(RingFilm):
    """A squeeze film around a shell or an outer ring, which moves without turning."""

    mass: ShellMass = Field(description="of the moving shell, per bearing")
    spring: Stiffnesses = Field(
        default=NO_SPRING,
        description="stiffness of the centring spring",
    )
    centred: bool = Field(
        default=False,
        description="the spring centres the shell under static load; else it sinks by load over stiffness",
    )
