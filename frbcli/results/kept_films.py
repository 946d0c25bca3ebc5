"""The films that a run keeps at some moments of its way (`output.films`), in the arrays of its checkpoint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.nearest import did_you_mean
from frbcli.results.files.container import refuse
from frbcli.results.store import Run

# Arrays: (n, 1 + 3 films) times in s, then angle of the grid in rad and displacement over the clearance of each film;
# (n, films, m, k) oil fractions, and free gas over the oil, of no films where the oil of none carries any; (films, m +
# 1) boundaries of the cells around in rad.
MOMENTS, OIL, GAS, EDGES = "kept_moments", "kept_oil", "kept_gas", "kept_edges"
OF_A_FILM = 3
REMEDY = 'Run the case again with --set \'output.films={from="0.1 s", to="0.2 s"}\', and its own times.'


@dataclass(frozen=True)
class KeptFilm:
    """One film at n moments. times: (n,) s; angles: (n,) of its grid, rad; places: (n, 2) displacement of the journal
    over the clearance; edges: (m + 1,) boundaries of its cells in rad, in its grid; oil: (n, m, k) oil fractions; gas:
    (n, m, k) volume of the free gas at saturation pressure over the oil's volume, None of oil without gas."""

    name: str
    times: Array
    angles: Array
    places: Array
    edges: Array
    oil: Array
    gas: Array | None

    def around(self, frame: int, values: Array, count: int) -> Array:
        """(count, k) values of (m, k) cells at even angles of the lab, from 0 on, in the middles of equal parts."""
        angle = (np.arange(count) + 0.5) * 2.0 * np.pi / count - self.angles[frame] - self.edges[0]
        cells = np.searchsorted(self.edges - self.edges[0], np.mod(angle, 2.0 * np.pi), side="right") - 1
        return np.asarray(values[np.minimum(cells, len(values) - 1)])

    def narrowest(self, frame: int) -> float:
        """The angle phi in rad where H = 1 + d_x sin(phi) - d_y cos(phi) is smallest."""
        x, y = self.places[frame]
        return float(np.mod(np.arctan2(-x, y), 2.0 * np.pi))

    def between(self, from_time: float | None, to_time: float | None) -> tuple[int, int]:
        """The frames from from_time to to_time in s, as the first and that after the last."""
        first = 0 if from_time is None else int(np.searchsorted(self.times, from_time))
        last = len(self.times) if to_time is None else int(np.searchsorted(self.times, to_time, side="right"))
        return first, last


def kept_film(run: Run, films: Sequence[str], name: str | None = None) -> KeptFilm:
    """A film that a run has kept, by default the first one. films: the names of all films of the run, in their order.

    Raises RunFileError if the run has kept none, or none of that name.
    """
    arrays: Mapping[str, Any] = run.checkpoint or {}
    if MOMENTS not in arrays:
        raise refuse(run.path, "has not kept the oil of its films.", REMEDY)
    if name is not None and name not in films:
        choices = ", ".join(films) if any(films) else "Its only film has no name: leave --film out."
        raise refuse(run.path, f'has no film "{name}".', did_you_mean(name, [film for film in films if film], choices))
    film, count = 0 if name is None else films.index(name), len(films)
    moments, oil, gas, edges = (np.asarray(arrays.get(part, np.zeros(0))) for part in (MOMENTS, OIL, GAS, EDGES))
    n = len(moments)
    fits = (
        moments.shape == (n, 1 + OF_A_FILM * count)
        and oil.ndim == 4
        and oil.shape[:2] == (n, count)
        and edges.shape == (count, oil.shape[2] + 1)
        and gas.shape in (oil.shape, (n, 0, *oil.shape[2:]))
        and all(np.isfinite(part).all() for part in (moments, oil, gas, edges))
        and np.all(np.diff(moments[:, 0]) >= 0.0)
    )
    if not fits:
        raise refuse(run.path, "holds films of a wrong form.", "Run the case again.")
    if n == 0:
        raise refuse(run.path, "ended before the films that it was to keep.", REMEDY)
    own = moments[:, 1 + OF_A_FILM * film : 1 + OF_A_FILM * (film + 1)]
    free = gas[:, film] if gas.shape[1] else None
    return KeptFilm(films[film], moments[:, 0], own[:, 0], own[:, 1:], edges[film], oil[:, film], free)
