"""Supports of bearings and dampers around them.

The support of a bearing: its shell as a body.

The squeeze film damper around the shell of a bearing, or around its outer ring.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from frbcli.case.film import RingFilm
from frbcli.case.model import AlsoAs, Damping, Model, ShellMass, Stiffness


def _both_directions(given: object) -> object:
    """One quantity, used for both directions."""
    if isinstance(given, str | int | float) and not isinstance(given, bool):
        return [given, given]
    return given


DIRECTIONS = (BeforeValidator(_both_directions), AlsoAs(lambda both: [both["prefixItems"][0], both]))
Stiffnesses = Annotated[tuple[Stiffness, Stiffness], *DIRECTIONS]
Dampings = Annotated[tuple[Damping, Damping], *DIRECTIONS]


class Support(Model):
    """The shell of a bearing as a body on springs and dampers; it moves in x and y and does not turn."""

    mass: ShellMass = Field(description="of the shell and what moves with it, per bearing; above 0")
    stiffness: Stiffnesses = Field(description="of its springs to ground or housing: of both directions, or [x, y]")
    damping: Dampings = Field(
        default=(0.0, 0.0), description="of its dampers to ground or housing: of both directions, or [x, y]"
    )


NO_SPRING = (0.0, 0.0)


class Damper(RingFilm):
    """A squeeze film around the shell of a bearing, or around its outer ring; the shell moves and does not turn."""

    mass: ShellMass = Field(description="of the shell and what moves with it, per bearing; above 0")
    spring: Stiffnesses = Field(
        default=NO_SPRING,
        description="stiffness of the centring spring, or [x, y]; 0: no spring",
    )
    centred: bool = Field(
        default=False,
        description="the spring centres the shell under the static load; else it sinks by load over stiffness",
    )
