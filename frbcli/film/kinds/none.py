"""The films of a machine that has none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from frbcli.arrays import Array
from frbcli.film.kinds.contract import Films
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.rectangles.film_force import FilmData


@dataclass(frozen=True)
class NoFilms(Films):
    """No film at all."""

    clearances: tuple[float, ...] = ()

    @property
    def loop(self) -> Any:
        """No films for the time loop."""
        return ()

    def force(self, i: int, place: Array, rate: Array, total: float, near: FilmForce | None = None) -> FilmForce:
        """Raises IndexError: there is no film."""
        raise IndexError(i)

    def heat_ends(self) -> Any:
        return ()

    def smooth(self, ring_shares: Sequence[float]) -> tuple[FilmData, ...]:
        return ()
