"""The films that a run keeps on its way (`output.films`): oil fractions and free gas of their cells at some moments."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from frbcli.arrays import Array
from frbcli.case.course.run import FilmFrames
from frbcli.film.cells.data import GAS, OIL
from frbcli.film.cells.motion import Motion, turned
from frbcli.results import kept_films
from frbcli.runs.oil import displacement, grid_angle
from frbcli.runs.record.restored import array
from frbcli.scene.machine.system import System
from frbcli.solve.state import TIME, State


class KeptFilms:
    """The films kept so far: each at the end of the first step that reaches a moment. Without any asked for, empty."""

    def __init__(self, wanted: FilmFrames | None, system: System) -> None:
        self._times = np.zeros(0) if wanted is None else np.linspace(wanted.begin, wanted.end, wanted.frames)
        films = system.films.with_fields if wanted is not None else ()
        self._gassy = len(films) if any(film.law.carries_gas for film in films) else 0
        shape = films[0].grid.shape if films else (0, 0)
        self._moments = np.empty((0, 1 + kept_films.OF_A_FILM * len(films)))
        self._oil, self._gas = np.empty((0, len(films), *shape)), np.empty((0, self._gassy, *shape))
        self._edges = np.array([film.grid.phi for film in films])

    def steps(self, t: float, longest: float, budget: int) -> int:
        """At most `budget` steps from a time t in s on, each at most `longest` s, that end before the next moment; one
        where that is near."""
        if len(self._moments) == len(self._times):
            return budget
        return max(1, min(budget, int((self._times[len(self._moments)] - t) / longest)))

    def take(self, system: System, state: State, angle: float) -> None:
        """Keep the films of a state if a moment has come; angle: of the rotor in rad."""
        t, kept = float(state.numbers[TIME]), len(self._moments)
        due = int(np.searchsorted(self._times, t, side="right")) - kept
        if due <= 0:
            return
        moment, oils, gases = [t], [], []
        for i, film in enumerate(system.films.with_fields):
            place, turn = displacement(system, state, i), grid_angle(system, state, i, angle)
            oil, fixed = state.wet[OIL, i], film.grid.fixed
            gaps = film.gaps(Motion(turned(place, -turn), (0.0, 0.0), 0.0))
            oils.append(np.where(fixed, 1.0, oil / gaps))
            if self._gassy:
                carried = state.wet[GAS, i] / np.where(fixed, 1.0, oil)
                gases.append(np.where(fixed, film.law.supplied_gas, carried))
            moment += [turn, *place]
        # Several moments in one step have the same films.
        self._moments = np.concatenate([self._moments, np.tile(moment, (due, 1))])
        self._oil = np.concatenate([self._oil, np.repeat(np.array(oils)[None], due, axis=0)])
        if self._gassy:
            self._gas = np.concatenate([self._gas, np.repeat(np.array(gases)[None], due, axis=0)])
        else:
            self._gas = np.empty((len(self._moments), *self._gas.shape[1:]))

    def snapshot(self) -> dict[str, Array]:
        """The arrays of a checkpoint."""
        if not len(self._times):
            return {}
        parts = (self._moments, self._oil, self._gas, self._edges)
        return dict(zip((kept_films.MOMENTS, kept_films.OIL, kept_films.GAS, kept_films.EDGES), parts, strict=True))

    def restore(self, checkpoint: Mapping[str, Array], t: float) -> None:
        """Take up what a checkpoint at the time t in s holds. Raises WrongCheckpoint if it is not one of this run."""
        if not len(self._times):
            return
        n = int(np.searchsorted(self._times, t, side="right"))
        self._moments = array(checkpoint, kept_films.MOMENTS, (n, *self._moments.shape[1:]))
        self._oil = array(checkpoint, kept_films.OIL, (n, *self._oil.shape[1:]))
        self._gas = array(checkpoint, kept_films.GAS, (n, *self._gas.shape[1:]))
