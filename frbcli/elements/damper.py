"""A squeeze film damper: the shell of a bearing is a body that moves in a film, on a centring spring, without turning.

The film is one of the machine's films, between the shell and its seat; the spring acts in parallel. Equal bearings of a
symmetric rotor move alike: one body represents both shells. """

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from frbcli.case.schema import Case
from frbcli.case.surroundings.support import Damper
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.support import directions
from frbcli.rotor.assembly import Link
from frbcli.rotor.body import point_mass
from frbcli.rotor.loads import LinearPart
from frbcli.units import display

FILM = "the shell moves without turning, and the film acts by squeezing alone"


@dataclass(frozen=True)
class DamperElement(MachineElement):
    """The shell of a bearing in a damper. bearing: its name."""

    bearing: str
    given: Damper

    symbol: ClassVar[str] = "damper"
    besides_bearings: ClassVar[bool] = True

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.damper is not None:
                yield cls(f"{key}.damper", bearing.name, bearing.damper)

    @property
    def node(self) -> str:
        """Name of the node of the shell."""
        return f"shell_{self.bearing}".rstrip("_")

    @property
    def film(self) -> str:
        """The name of its film."""
        return f"{self.bearing}_damper".lstrip("_")

    def parts(self, site: Site) -> Parts:
        spring = LinearPart.of(np.diag(self.given.spring))
        return Parts((point_mass(self.node, site.count * self.given.mass, site.gravity),), ((self.link(site), spring),))

    def link(self, site: Site) -> Link:
        """The link between shell and seat on which spring and film act."""
        return Link(self.node, site.seat(self.bearing), site.count)

    def plan_line(self, site: Site) -> Line:
        value = f"{self.bearing}: {display(self.given.mass, 'kg')} in a film".removeprefix(": ")
        spring = "no centring spring: it sinks under a static load"
        if any(self.given.spring):
            spring = f"centring spring {directions(self.given.spring, 'N/m')}, which carries the static load"
            spring += ", the shell in the centre" if self.given.centred else ""
        return "damper", value, f"{spring}; {FILM}"
