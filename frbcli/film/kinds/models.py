"""Bearing models that were added from Python."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.bearing_model.film import NO_FLOW, BearingModelFilm, model_flow
from frbcli.film.kinds.contract import Films, couette_power
from frbcli.film.rectangles.film import FilmForce, evaluate
from frbcli.film.rectangles.film_force import FilmData


@dataclass(frozen=True)
class ModelFilms(Films):
    """data: of each film. A model may follow viscosity and clearance in any way, so that films are made anew with
    others: they are no multiples of each other."""

    data: tuple[BearingModelFilm, ...]

    @property
    def loop(self) -> Any:
        return self.data

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        return evaluate(self.data[i], self.clearances[i], place, rate, total)

    def heat_ends(self) -> Any:
        """See Films.heat_ends: the films themselves give their flow."""
        return ()

    def power_and_flow(self, i: int, place: Array, total: float, slip: float, drag: float) -> tuple[float, float]:
        """See Films.power_and_flow; the flow is NaN of a model without one."""
        film, c = self.data[i], self.clearances[i]
        x, y = (place / c).tolist()
        power = couette_power(place, c, self.force(i, place, np.zeros(2), total).force, total, slip, drag)
        return power, np.nan if film.flow == NO_FLOW else float(model_flow(film, x, y, 0.0, 0.0, total))

    def changeable(self) -> Self:
        return replace(self, data=tuple(film._replace(parameters=film.parameters.copy()) for film in self.data))

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        return self.data
