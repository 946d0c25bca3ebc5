"""Where oil enters and leaves a section: its ends z = 0 and z = 1 (sections 3.2.1 and 4.2.1.2), and openings.

The openings of a film with a flow-limited supply.

All openings of a film are one vessel. While the film takes less than the flow, they are at the pressure of the supply.
Else their pressure falls until the film takes the flow, down to the cavity pressure; where the surfaces carry away more
oil than comes even then, the openings are filled in part, as a cell of the film would be: pressure and oil fraction
follow the law of the film. What the film takes grows with either, so that there is one filling for each flow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import FilmUnsolved
from frbcli.film.gap import Section
from frbcli.film.grid import NO_SEALS

if TYPE_CHECKING:
    from frbcli.film.cells.film import VolumeFilm, VolumeSolution

BEND = 0.5  # share of the pressure of an end cell by which a parabola may change it; more than that is a front
PREFACTOR, STEEPNESS = 0.01, 100.0  # a in 1/s and b of (4.37)


class EndSlope(NamedTuple):
    """Slope at an end, rise (p_0 + bend (p_0 - p_1) - p_end), by the pressures of the last two cells."""

    rise: float
    bend: float


def end_slope(distances: Array, seal: float) -> EndSlope:
    """The slope at an end from the distances (k,) of the cells' unknowns, over the width.

    Behind a seal of this length, over the width, lies the pressure p_end: at the end of the film it is higher by the
    slope times that length.
    """
    first = float(distances[0])
    rise, bend = 1.0 / first, 0.0
    if len(distances) > 1:
        second = float(distances[1])
        rise, bend = (first + second) / (first * second), first**2 / (second**2 - first**2)
    return EndSlope(rise / (1.0 + rise * seal), bend)


def end_slopes(height: Array, seals: tuple[float, float] = NO_SEALS) -> tuple[EndSlope, EndSlope]:
    """The slopes at z = 0 and z = 1 for the places `height` (k,) of the cells' unknowns; seals: see Section."""
    return end_slope(height, seals[0]), end_slope(1.0 - height[::-1], seals[1])


RESPONSE = 2e-3  # s in which a line of the supply is filled or emptied at most
EAGER = 2.5  # what a film with an eccentric journal takes, over what a concentric one takes
ALL = 1.0  # filling of openings at the pressure of the supply
ROUND_OFF, SETTLED = 1e-12, 1e-9  # of the flow that is given; the latter where the filling is not resolved closer
MOST = 80  # fillings that are tried
SAME = 1e-15  # fillings that differ by less
Solve = Callable[[float, "VolumeSolution | None"], "VolumeSolution"]


class Feed(NamedTuple):
    """What openings hold: the share of the gauge pressures that they were made with, and the oil fraction."""

    share: float
    fraction: float


def supply_pressure(section: Section) -> float:
    """The largest gauge pressure in Pa in the openings of a section, as they were made."""
    grooves, holes = (groove.pressure for groove in section.grooves), (hole.pressure for hole in section.holes)
    return max(section.far_pressure, *grooves, *holes, 0.0)


def feed_at(film: VolumeFilm, filling: float) -> Feed:
    """What openings hold at a filling: from 1, the pressure of the supply, to 0, the pressure of the cavities, and
    below 0 as a cell of the film with this unknown."""
    supply, cavity = supply_pressure(film.section) / film.section.pressure_scale, film.scales.cavitation
    if filling > 0.0:
        return Feed((cavity + filling * (supply - cavity)) / supply if filling < ALL else 1.0, 1.0)
    state = film.law.cells(np.array([filling]), film.scales)
    return Feed(float(state.pressure[0]) / supply, min(max(float(state.fraction[0]), 0.0), 1.0))


def opening_pressures(film: VolumeFilm, fillings: Array, supplies: Array) -> Array:
    """(k,) gauge pressures in Pa in the openings at fillings (k,), with gauge pressures (k,) of their supply in Pa."""
    scale, held = film.section.pressure_scale, np.clip(fillings, _lowest(film), ALL)
    cavity = scale * film.scales.cavitation
    emptied = scale * film.law.cells(np.minimum(held, 0.0), film.scales).pressure
    return np.where(held > 0.0, cavity + held * (supplies - cavity), emptied)


def limited(film: VolumeFilm, solve: Solve) -> VolumeSolution:
    """The film with openings that are filled so that it takes no more than what its supply gives.

    solve: the film with a filling, begun from another solution. Raises FilmUnsolved.
    """
    section, given = film.section, given_flow(film.section)

    def tried(filling: float, near: VolumeSolution) -> tuple[VolumeSolution, float]:
        try:
            trial = solve(filling, near)
        except FilmUnsolved:  # it runs dry, and takes nothing
            return near, -1.0
        return trial, trial.flows.supply / given - 1.0

    solution = solve(ALL, None)
    if (excess := solution.flows.supply / given - 1.0) <= 0.0:
        return solution
    high, low, shortfall = ALL, 0.0, -1.0
    if section.far != "groove" or not film.law.empties:  # else nothing flows in at the pressure of the cavities
        solution, off = tried(0.0, solution)
        if off > 0.0:
            high, excess, low = 0.0, off, _lowest(film)
        else:
            shortfall = off
    return _between(tried, solution, (low, shortfall), (high, excess))


def _between(
    tried: Callable[[float, VolumeSolution], tuple[VolumeSolution, float]], solution: VolumeSolution,
    low: tuple[float, float], high: tuple[float, float],
) -> VolumeSolution:  # fmt: skip
    """The solution that takes what is given, by Illinois' method (M. Dowell and P. Jarratt, BIT 11, 1971). low, high:
    fillings, and by what share less or more is taken there. tried: the film at a filling, from one near by, and that
    share there."""
    (low_at, short), (high_at, excess), last, off = low, high, 0.0, math.inf
    for _ in range(MOST):
        filling = (low_at * excess - high_at * short) / (excess - short)
        solution, off = tried(filling, solution)
        closed = high_at - low_at < SAME * max(1.0, abs(high_at))
        if abs(off) < (SETTLED if closed else ROUND_OFF):
            return solution
        if closed:
            break
        repeated = off * last > 0.0  # the same end moves again: the other one counts half
        if off > 0.0:
            high_at, excess, short = filling, off, 0.5 * short if repeated else short
        else:
            low_at, short, excess = filling, off, 0.5 * excess if repeated else excess
        last = off
    raise FilmUnsolved(f"at no filling of its openings does the film take the flow that is given: off by {off:.0e}")


def _lowest(film: VolumeFilm) -> float:
    """Filling at which openings hold neither oil nor, where the law lets it fall, pressure."""
    scales = film.scales
    return -1.0 if film.law.empties else -1.0 - (scales.cavitation + scales.ambient) / scales.reference


def given_flow(section: Section) -> float:
    """The flow that the supply of a section gives at most, in the units of its film, 1/s."""
    return section.largest_flow / (section.radius * section.width * section.clearance)


class SupplyLine(NamedTuple):
    """The line between a supply and its openings in the time loop: given, the flow in 1/s, 0 where the supply holds its
    pressure; line, what the line takes up for a filling of 1; lowest: filling."""

    given: float
    line: float
    lowest: float

    def filled(self, filling: float, outflow: float, dt: float) -> float:
        """The filling after a step of dt in s in which the openings took a flow, 1/s."""
        return min(max(filling + dt * (self.given - outflow) / self.line, self.lowest), ALL)


def supply_line(film: VolumeFilm, response: float = RESPONSE) -> SupplyLine:
    """The line of the supply of a film, of which the oil is the state: filling' = (given - outflow) / line.

    response: s; the line holds what the film may take in it at most, so that steps as short as that are stable."""
    section, scales = film.section, film.scales
    if not is_limited(section):
        return SupplyLine(0.0, 0.0, 0.0)
    given, rise = given_flow(section), supply_pressure(section) / section.pressure_scale - scales.cavitation
    openings = len(section.grooves) + len(section.holes)
    demand = section.aspect * (2.0 * math.pi * rise + openings * scales.reference)
    return SupplyLine(given, response * max(given, EAGER * demand), _lowest(film))


def is_limited(section: Section) -> bool:
    """Whether the supply of a section is flow-limited."""
    return math.isfinite(section.largest_flow)
