"""Marching a film on volumes through time along a given motion, by implicit Euler steps or BDF2 with variable steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.cells.plain.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.plain.loads import OilBalance
from frbcli.film.cells.supply import supplied
from frbcli.film.grid import Array

Method = Literal["midpoint", "euler", "bdf2"]
MOST_HALVINGS = 6  # of a step whose equations do not converge


@dataclass(frozen=True)
class Moment:
    """A film at a time in s: its motion, solution, and oil content H theta (m, k)."""

    time: float
    motion: Motion
    solution: VolumeSolution
    content: Array


def march(
    film: VolumeFilm,
    motion: Callable[[float], Motion],
    times: Array,
    start: Array | None = None,
    method: Method = "midpoint",
    supply: Callable[[float], float] | None = None,
) -> Iterator[Moment]:
    """The film at each of the times (n,) after the first, in s and rising; a generator, so that it may be left early.

    motion: time -> motion; start: (m, k) unknown at the first time, else a full film at the ambient pressure. A step
    that does not converge is taken in halves. method: "midpoint" keeps the oil as implicit Euler steps do, but lets it
    flow through the gap of the middle of the step, which makes the pressure of a full film second order; it is of that
    time. "bdf2" smears the moment at which a film is full again. supply: time -> share of the gauge supply pressure
    (4.11), else all of it. Raises NotConverged.
    """
    w = film.full() if start is None else start
    steps = _Steps(film, motion, method, w, float(times[0]), supply)
    for time in times[1:]:
        yield steps.to(float(time), MOST_HALVINGS)


class _Steps:
    """The past that the next step needs."""

    def __init__(
        self,
        film: VolumeFilm,
        motion: Callable[[float], Motion],
        method: Method,
        w: Array,
        time: float,
        supply: Callable[[float], float] | None,
    ) -> None:
        self._supply = supply
        self._film, self._motion, self._method = film, motion, method
        self._w, self._time = w, time
        self._drift: Array | None = None  # how fast w changed in the step before
        self._content = film.content(motion(time), w)
        # A law that makes oil, or clips the pressure of a full film, knows the motion of the moment only.
        self._remembers = film.law.conserves and not film.law.clips
        self._before: tuple[float, Array] | None = None  # the step before, and the content at its start

    def to(self, time: float, halvings: int) -> Moment:
        """One step to the time, or two of half its size."""
        try:
            return self._step(time)
        except NotConverged:
            if halvings == 0:
                raise
        self.to(0.5 * (self._time + time), halvings - 1)
        return self.to(time, halvings - 1)

    def _at(self, time: float) -> VolumeFilm:
        return self._film if self._supply is None else supplied(self._film, self._supply(time))

    def _step(self, time: float) -> Moment:
        dt = time - self._time
        motion, shown = self._motion(time), time
        if not self._remembers:
            solution = self._at(time).steady(motion, self._w)
            self._w, self._time, self._content = solution.w, time, self._film.content(motion, solution.w)
            return Moment(time, motion, solution, self._content)
        rate, past, flowing = 1.0 / dt, self._content / dt, motion
        if self._method == "bdf2" and self._before is not None:
            rate, past = _bdf2(dt, *self._before, self._content)
        if self._method == "midpoint":
            shown = 0.5 * (self._time + time)
            flowing = self._motion(shown)
        begin = self._w if self._drift is None else self._w + dt * self._drift
        solution, content = self._at(shown).keep(motion, begin, rate, past, flowing)
        self._drift = (solution.w - self._w) / dt
        self._before = dt, self._content
        self._w, self._time, self._content = solution.w, time, content
        return Moment(shown, flowing, solution, content)


def total_balance(film: VolumeFilm, start: Array, times: Array, moments: Sequence[Moment]) -> OilBalance:
    """Mean flows of a march of Euler or midpoint steps over its time, and what does not balance of them.

    start: (m, k) content at the first of the times (n,); moments: one for each of the others.
    """
    section, free = film.section, ~film.grid.fixed
    scale = section.copies * section.radius * section.width * section.clearance / float(times[-1] - times[0])
    names = ("inflow", "outflow", "supply", "ends")
    steps = np.diff(times)
    inflow, outflow, supply, ends = (
        float(steps @ np.array([getattr(moment.solution.flows, name) for moment in moments])) for name in names
    )
    gained = float((film.grid.area * (moments[-1].content - start))[free].sum())
    defect = (inflow - outflow - gained) / max(inflow, outflow)
    return OilBalance(scale * inflow, scale * outflow, scale * supply, scale * ends, defect)


def _bdf2(dt: float, dt_before: float, older: Array, old: Array) -> tuple[float, Array]:
    """Weight of the new content and weighted sum of the past ones, both over the step."""
    ratio = dt / dt_before
    past = ((1.0 + ratio) * old - ratio**2 / (1.0 + ratio) * older) / dt
    return (1.0 + 2.0 * ratio) / (1.0 + ratio) / dt, past
