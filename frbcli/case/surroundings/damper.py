"""The squeeze film damper around the shell of a bearing, or around its outer ring."""

from __future__ import annotations

from pydantic import Field

from frbcli.case.film_geometry import RingFilm
from frbcli.case.quantities import ShellMass
from frbcli.case.surroundings.support import Stiffnesses

NO_SPRING = (0.0, 0.0)


class Damper(RingFilm):
    """A film around the shell of a bearing, or around its outer ring, which moves in it and does not turn; it lies in
    the support, or in the ground without one. Each of both equal bearings of a symmetric rotor has such a damper."""

    mass: ShellMass = Field(description="of the shell and what moves with it, of one bearing; above 0")
    spring: Stiffnesses = Field(
        default=NO_SPRING,
        description="stiffness of the centring spring: of both directions, or [x, y]; without a spring if not given",
    )
    centred: bool = Field(
        default=False, description="whether the spring is set so that the shell rests in the centre under the static "
        "load; else it sinks by load over stiffness",
    )  # fmt: skip
