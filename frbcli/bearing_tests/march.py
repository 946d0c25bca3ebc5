"""A film along a given motion of its journal, squeeze (4.47) or whirl (4.48), (4.49), moment by moment."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.film.cells.balance.feed import ALL, RESPONSE, supply_line
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.balance import Carried, KeptGas
from frbcli.film.cells.motion import Motion, Path
from frbcli.film.cells.solver import FilmSolver

RISE_TIME = 0.01  # s, t_1 of (4.49)
FAST = 1e6  # 1/s: oil that is replaced so fast has no time for an exchange of gas
MOST_HALVINGS = 6  # of a step whose equations do not converge
FilmAt = Callable[[float, Motion], VolumeFilm]


def squeeze_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """D_y = -C eps sin(2 pi f t) (4.47)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        y, v = -eccentricity * math.sin(rate * t), -eccentricity * rate * math.cos(rate * t)
        return Motion((0.0, y), (0.0, v), omega)

    return path


def whirl_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """A circle (4.48) that is reached within some t_1 (4.49)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        fading = math.exp(-t / RISE_TIME)
        e, growth = eccentricity * (1.0 - fading), eccentricity * fading / RISE_TIME
        c, s = math.cos(rate * t), math.sin(rate * t)
        return Motion((e * c, e * s), (growth * c - e * rate * s, growth * s + e * rate * c), omega)

    return path


def inclined_path(path: Path, slope: tuple[float, float]) -> Path:
    """The path of a journal that keeps a tilt against its shell. slope: see Motion."""
    return lambda time: replace(path(time), slope=slope)


@dataclass(frozen=True)
class Moment:
    """A film at a time in s: its motion and its solution."""

    time: float
    motion: Motion
    solution: VolumeSolution


def march(
    film: VolumeFilm, path: Path, times: Array, start: Array | None = None, film_at: FilmAt | None = None
) -> Iterator[Moment]:
    """The film for each of the times (n,) after the first, in s and rising; a generator, so that it may be left early.

    start: (m, k) unknown at the first time, else a full film at the ambient pressure; film_at: the film with its supply
    and law as they are at a time and a motion, else it stays the same. A step that does not converge is taken in
    halves. Raises NotConverged.

    A mass-conserving law stores oil as implicit Euler steps do, but lets it flow through the gap of the middle of the
    step, which makes the pressure of a full film second order; moments are then at that time. Other films follow from
    the motion of the moment. Openings whose supply is flow-limited are full at first; their filling stays
    during a step, as in runs.
    """
    steps = _Steps(film, path, film.full() if start is None else start, times, film_at)
    for time in times[1:]:
        yield steps.to(float(time), MOST_HALVINGS)


class _Steps:
    """The past that the next step needs."""

    def __init__(self, film: VolumeFilm, path: Path, w: Array, times: Array, film_at: FilmAt | None) -> None:
        time = float(times[0])
        self._film_at, self._path, self._solver = film_at, path, FilmSolver(film)
        self._w, self._time, self._content = w, time, film.content(path(time), w)
        self._gas: KeptGas | None = None  # H theta c, and what was carried last
        if film.law.carries_gas:
            free = film.law.free_gas(film.cells(w), film.scales)
            self._gas = KeptGas(self._content * free, Carried(free, np.full(w.shape, FAST)))
        self._drift: Array | None = None  # how fast w changed in the step before, and the gas that cells were given
        self._gas_drift: Array | float = 0.0
        self._line, self._filling = supply_line(film, max(RESPONSE, float(np.diff(times).max(initial=0.0)))), ALL

    def to(self, time: float, halvings: int) -> Moment:
        """One step to the time, or two of half its size."""
        try:
            return self._step(time)
        except NotConverged:
            if halvings == 0:
                raise
        self.to(0.5 * (self._time + time), halvings - 1)
        return self.to(time, halvings - 1)

    def _step(self, time: float) -> Moment:
        dt, end = time - self._time, self._path(time)
        if not self._solver.film.law.keeps_oil:
            solution = self._at(time, end).steady(end, self._w)
            self._w, self._time = solution.w, time
            return Moment(time, end, solution)
        middle = 0.5 * (self._time + time)
        flowing = self._path(middle)
        begin = self._w if self._drift is None else self._w + dt * self._drift
        solver = self._at(middle, flowing)
        kept, gas = None, self._gas
        if gas is not None:
            carried, turnover = gas.guess
            kept = KeptGas(gas.past / dt, Carried(carried + dt * self._gas_drift, turnover))
        if self._line.given > 0.0:
            solver.fill(self._filling)
        solution, content = solver.keep(end, flowing, begin, 1.0 / dt, self._content / dt, kept)
        if self._line.given > 0.0:
            solution = replace(solution, filling=self._filling)
            self._filling = self._line.filled(self._filling, solution.flows.supply, dt)
        if gas is not None and solution.gas is not None:
            self._gas = KeptGas(content * solution.gas.free, solution.gas.carried)
            self._gas_drift = (solution.gas.carried.gas - gas.guess.gas) / dt
        self._drift = (solution.w - self._w) / dt
        self._w, self._time, self._content = solution.w, time, content
        return Moment(middle, flowing, solution)

    def _at(self, time: float, motion: Motion) -> FilmSolver:
        film = self._solver.film if self._film_at is None else self._film_at(time, motion)
        if film is not self._solver.film:
            self._solver = FilmSolver(film)
        return self._solver
