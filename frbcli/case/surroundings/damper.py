"""The squeeze film damper around the shell of a bearing, or around its outer ring."""

from __future__ import annotations

from pydantic import Field

from frbcli.case.film_geometry import RingFilm
from frbcli.case.quantities import ShellMass
from frbcli.case.surroundings.support import Stiffnesses

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
