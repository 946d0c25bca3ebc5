"""How the films of a case are computed: theory, cavitation, coupling, cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from frbcli.case.film_tables import Cavitation, Theory, adopt, attribute
from frbcli.case.model import Model
from frbcli.film.cavitation.table import law_named

Coupling = Literal["auto", "monolithic", "dynamic-static", "dynamic-static-semi-implicit", "co-simulation"]


class FilmModel(Model):
    """How the films are computed."""

    theory: Theory = Field(
        default="auto", description="of the Reynolds equation"
    )
    cavitation: Cavitation = Field(default="half-sommerfeld", description="model of all films")
    cavitation_factor: Literal["global", "local", "none"] = Field(
        default="global",
        description="torque reduced by the mean oil fraction (4.46), the local one, or not",
    )
    torque: Literal["all", "couette", "simple"] = Field(
        default="all", description="on floating rings: both terms of (3.17), the first, or formula (4.6)"
    )
    coupling: Coupling = Field(default="auto", description="of rotor and films in time")
    grid: Literal["auto", "fixed", "half-speed"] = Field(
        default="auto",
        description="fixed cells, or turning with the mean surface speed; auto: turning for mass-conserving plain gaps",
    )
    solution: Literal["auto", "table", "cells"] = Field(
        default="auto", description="in runs: tabulated where possible, or finite volumes"
    )
    tilt: Literal["none", "follows"] = Field(
        default="none",
        description="gap constant along the axis, or following the tilt of journals and rings",
    )

    if TYPE_CHECKING:  # the tables of the laws, which these declare

        def __getattr__(self, name: str) -> Any: ...

    def given(self, cavitation: str) -> Any:
        """The values of the table [film.NAME] of a cavitation law by attribute, None if the law has no keys."""
        law = law_named(cavitation)
        return getattr(self, attribute(law)) if law.keys else None


adopt(FilmModel)
