"""Cells of finite-volume films: the fewest that hold a target, and what a plan expects before anything is solved.

The error of the eccentricities before a whirl grows is the sum of the errors of the cells around and along, measured on
the shipped cases and some changes of them against 144 x 10 or 192 x 6 cells (docs/accuracy.md).

The eccentricity that a run-up is expected to reach before a whirl follows from static load and unbalance by the theory
of the short bearing. A journal without mass falls from where it starts, in the first revolutions, while the oil turns
it; later it rests under its weight and unbalance. Openings, supply pressure and mass are left out. scipy is not asked
for the two numbers, since its import takes longer than a whole plan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film import FilmGeometry
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.cells.mesh.grid import least_around
from frbcli.film.section_faults import no_inflow
from frbcli.rotor.loads import SpeedProfile, speed_profile
from frbcli.scene.changes import input_faults, input_times
from frbcli.scene.films import FilmPlace, film_places, film_section, is_plain
from frbcli.scene.machine.rotor import element_parts, table_faults, table_times
from frbcli.scene.machine.turbocharger import shaft_of

# The mean error of a short section is SHORT (b/D)^2 (1 - eps)^-SHORT_POWER, to 20 % for b/D <= 0.4.
SHORT, SHORT_POWER = 0.45, 1.3
CLOSEST = 0.02  # smallest gap over the clearance that is distinguished


def slenderness_of(film: FilmGeometry) -> float:
    """Width of a section over the diameter."""
    return film.width / film.diameter / (2 if film.supply.splits else 1)


def short_error(slender: float, eccentricity: float) -> float:
    """Relative error of the force of the short-bearing theory, for sections of b/D = slender."""
    return float(SHORT * slender**2 * (1.0 - eccentricity) ** -SHORT_POWER)


def mobility(e: Array, slender: float) -> Array:
    """(2,) velocity over the clearance of a journal at e (2,) in a film that cavitates, under a load W along -y, over
    psi^2 W / (b D eta), in addition to the mean velocity of the oil.

    The mobility of the short bearing (Booker, "Dynamically loaded journal bearings: mobility method of solution",
    J. Basic Eng. 87, 1965), and more by the force that a longer bearing lacks.
    """
    room = max(1.0 - float(np.hypot(*e)), CLOSEST)
    along, left = -e[1], e[0]  # of the load, and to the left of it
    ahead = max(1.0 - along, CLOSEST)
    size = (1.0 + short_error(slender, 1.0 - room)) / slender**2
    return size * np.array([-4.0 * left * ahead**1.5 / math.pi**2, -(ahead**2.5) / math.pi])


def resting_load(eccentricity: float, slender: float) -> float:
    """Load of a journal at rest over b D eta omega / psi^2, omega being the mean speed of both surfaces: Ocvirk's, less
    by the error of the short bearing."""
    e = eccentricity
    short = slender**2 * e * math.hypot(4.0 * e, math.pi * math.sqrt(1.0 - e * e)) / (1.0 - e * e) ** 2
    return short / (1.0 + short_error(slender, e))


FALL = 10.0 * 2.0 * math.pi  # rad until which a journal has fallen
STEP, MOST_STEPS, FEWEST_STEPS = 0.01, 5000, 200  # of the fall: its length over the clearance; their number
RISEN = 0.95  # share of the largest eccentricity below which the journal has risen again
LARGEST = 1.0 - CLOSEST
ECCENTRICITIES = np.linspace(0.0, LARGEST, 500)


def expected_eccentricity(case: Case) -> float | None:
    """The largest one of all films, at most LARGEST; None without films, and with rings or dampers, whose motion is not
    known before a run."""
    if len(case.films) != len(case.bearings) or not case.bearings:
        return None
    return max(_expected(case, film) for film in case.films)


def heavily_loaded(case: Case) -> bool:
    """Whether a film carries a mean pressure from which on its law needs shorter steps; False where the static load of
    the films is not known, as above."""
    if len(case.films) != len(case.bearings) or not case.bearings:
        return False
    load = _weight(case)
    return any(load > law_named(case.cavitation(film)).heavy * film.width * film.diameter for film in case.films)


def _expected(case: Case, film: FilmGeometry) -> float:
    """The largest eccentricity that is expected of one film in a run-up."""
    profile, slender = run_up_profile(case), slenderness_of(film)
    softness = (2.0 * film.clearance / film.diameter) ** 2 / (film.width * film.diameter * case.viscosity(film))
    weight, top = softness * _weight(case), 0.5 * abs(float(profile.speeds[-1]))
    unbalance = softness * _unbalance(case, 2.0 * top)
    return max(_fallen(case, profile, weight, slender), _resting(weight + unbalance, top, slender))


def _fallen(case: Case, profile: SpeedProfile, load: float, slender: float) -> float:
    """The largest eccentricity in the first revolutions, by the midpoint rule. load: over b D eta / psi^2, 1/s."""

    def velocity(time: float, e: Array) -> Array:
        turning = 0.5 * float(profile.speed(np.array([time]))[0])
        return load * mobility(e, slender) + turning * np.array([-e[1], e[0]])

    e, time, largest = np.array(case.start.displacement or (0.0, 0.0)), float(profile.times[0]), 0.0
    longest = (profile.end - time) / FEWEST_STEPS
    for _ in range(MOST_STEPS):
        largest = max(largest, float(np.hypot(*e)))
        if largest >= LARGEST or np.hypot(*e) < RISEN * largest:
            break
        if time >= profile.end or abs(profile.angle(time)) > FALL:
            break
        rate = velocity(time, e)
        step = min(STEP / max(float(np.hypot(*rate)), 1e-300), longest)
        e = e + step * velocity(time + 0.5 * step, e + 0.5 * step * rate)
        time += step
    return min(largest, LARGEST)


def _resting(load: float, turning: float, slender: float) -> float:
    """The eccentricity of a journal at rest under a load as above; turning: mean speed of the surfaces, rad/s."""
    if turning == 0.0:
        return 0.0
    carried = [turning * resting_load(e, slender) for e in ECCENTRICITIES.tolist()]
    return float(np.interp(load, carried, ECCENTRICITIES))


def _weight(case: Case) -> float:
    """Static load of a film, N, shared by all of them."""
    x, y = 0.0, -shaft_of(case).mass * case.rotor.gravity
    for force in element_parts(case).forces:
        x, y = x + force.force[0], y + force.force[1]
    return math.hypot(x, y) / _films(case)


def _unbalance(case: Case, omega: float) -> float:
    """Force of unbalance and bow on a film, N, with omega rad/s, or with the natural frequency of the shaft, if that is
    lower: a faster rotor turns about its centre of mass. A bow bends a shaft as an unbalance of that eccentricity."""
    shaft = shaft_of(case)
    square = omega**2 if shaft.compliance == 0.0 else min(omega**2, 1.0 / shaft.compliance)
    return shaft.disk_mass * (shaft.eccentricity + shaft.bow) * square / _films(case)


def _films(case: Case) -> int:
    return shaft_of(case).equal_bearings * len(case.bearings)


def run_up_profile(case: Case) -> SpeedProfile:
    """From the first to the last speed of the case, or through its points. Raises InputError for a table over time that
    ends before."""
    times, speeds = case.speed.course
    return _with_tables(case, list(times), list(speeds))


def run_down_profile(case: Case) -> SpeedProfile:
    """Up, hold, and back down (section 7.2.2). Raises InputError for a speed through points, which define the way down
    themselves, for an axial load over time, and for a table over time that ends before."""
    speed = case.speed
    if case.drive is not None:
        whole = case.drive.duration + case.drive.down_duration
        return _with_tables(case, *map(list, case.drive.course(case.polar_inertia, whole)))
    if speed.times:
        problem = "say how the speed goes down, too."
        raise case.refused(Fault("speed.points", f"{len(speed.times)} points", None, problem, "Call `frb runup`."))
    if case.axial is not None and case.axial.changes:
        problem = "changes over time, and a run-down has each speed twice: a speed has more than one load."
        fault = Fault("axial.load", "over time", None, problem, "Give one load, or one with the square of the speed.")
        raise case.refused(fault)
    times, speeds = [0.0, speed.duration], [speed.start, speed.end]
    if speed.hold > 0.0:
        times.append(times[-1] + speed.hold)
        speeds.append(speed.end)
    times.append(times[-1] + speed.down_duration)
    speeds.append(speed.start)
    return _with_tables(case, times, speeds)


def _with_tables(case: Case, times: list[float], speeds: list[float]) -> SpeedProfile:
    """The profile through speeds in Hz at times in s, with kinks of no angle at the rows of tables over time."""
    faults = (*table_faults(case, times[0], times[-1]), *input_faults(case, times[0], times[-1]))
    if faults:
        raise case.refused(*faults)
    stops = (*table_times(case).tolist(), *input_times(case), *(() if case.drive is None else case.drive.stops))
    return speed_profile(times, [2 * math.pi * value for value in speeds]).with_stops(stops)


USUAL = (48, 6)  # cells around and along for which the errors are tabulated
FEWEST = (12, 3)
AROUND = (32, 40, 48, 56, 64, 72, 80, 96, 112, 128, 144, 160, 192)
# Lengths of columns that have a fast elimination (film/cells/block_cyclic.py), except too few cells.
ALONG = (4, 5, 6, 8, 10)
FEWER_AROUND = (12, 16, 20, 24, 28)  # to compare with
COARSER, FEWER = 1.5, (0.5, 0.85)  # by how much at least; share of the cells in each direction
# The same with feed holes, if there are such cells: of cells that differ less, holes that lie badly between the coarser
# ones dominate. floating-ring-table-7-1 on 80 x 10 cells states 7.6 times its error compared with 64 x 8, 5.4 times
# compared with 56 x 8.
OF_HOLES = 2.2
FAST, SLOW = (3, *ALONG), 3.0  # what others cost more
FAST_TILTED = (*ALONG, 12, 14, 16)  # of films that follow a tilt
ALONG_TILTED = (8, 10, 12, 14, 16)  # over the whole width
CELLS_DOUBLE = 16.0  # cells along that double the time of a cell
MOST_STATES, FEWEST_STATES = 8, 2
KNEE = 1.5  # error over the least one that can be had, where the target is out of reach: less costs twice as much
BEYOND = 2.0  # order of the cells along outside of what was measured
MEASURED_AT = 0.85  # largest eccentricity of the films with these errors; growth counts from there on


@dataclass(frozen=True)
class CellError:
    """The error of films of one kind by their cells. around: of USUAL cells around, of an order; along: by the cells
    along; least: cells around, below which the error is a matter of chance; growth: power of the smallest gap with
    which the error of the cells around grows; coarser: error of cells to compare with over the error of the cells."""

    around: float
    order: float
    along: Mapping[int, float]
    least: int = AROUND[0]
    growth: float = 0.0
    coarser: float = COARSER

    def at(self, eccentricity: float) -> CellError:
        """This error for a journal that goes up to an eccentricity."""
        return replace(self, around=self.around * float(gap_ratio(MEASURED_AT, eccentricity) ** self.growth))

    def of(self, cells: tuple[int, float]) -> float:
        """Error of the eccentricities with cells (around, along)."""
        return float(self.around * (USUAL[0] / cells[0]) ** self.order) + self._along(cells[1])

    def _along(self, k: float) -> float:
        known = sorted(self.along)
        if not known[0] <= k <= known[-1]:
            end = known[0] if k < known[0] else known[-1]
            return float(self.along[end] * (end / k) ** BEYOND)
        below, above = max(n for n in known if n <= k), min(n for n in known if n >= k)
        share = 0.0 if below == above else math.log(k / below) / math.log(above / below)
        return float(self.along[below] ** (1.0 - share) * self.along[above] ** share)


# Without openings, with lobes, with grooves across, with bores or pockets; mass-conserving films are carried on by
# cells that turn with it where there are no openings, by cells at rest else. Plain films of laws that keep no oil,
# eccentricities of 0.92 to 0.98: 1.2e-3 to 3e-3, of others up to 0.8e-3.
PLAIN = CellError(3.5e-4, 2.0, {4: 4.8e-3, 5: 2.2e-3, 6: 1.1e-3, 8: 5e-4, 10: 3e-4}, growth=1.0)
PLAIN_OIL = replace(PLAIN, growth=0.5)
LOBES = CellError(4e-4, 2.0, {4: 3e-4, 6: 1e-4, 8: 5e-5})
LOBES_OIL = CellError(1.2e-3, 1.5, {4: 1.5e-4, 6: 1e-4, 8: 5e-5})
# One groove; more of them leave shorter lands, with fewer cells each. Of 20 films, one to three grooves of 10 to 40
# degrees, five laws, eccentricities up to 0.1 to 0.9: 0.7e-3 to 6.6e-3, 1.4e-3 to 6e-3, 0.6e-3 to 9.5e-3. 32 around
# have up to three times the error of 48.
GROOVE = CellError(3e-3, 2.0, {4: 3e-4, 6: 1e-4, 8: 5e-5}, least=40)
# The same of laws that keep oil, between several grooves and in bearings narrower than NARROW: oil goes out of and into
# the grooves over a length of half the width, which few cells around have, and its fronts are carried from cell to
# cell. 22 films of this kind at eccentricities of 0.86 to 0.99: 0.4e-3 to 8e-3 per groove, and one of 5e-2, of orders
# 0.9 to 1.9; 6 others, wide and with one groove: 0.8e-3 to 2e-3.
NARROW = 0.65  # width over diameter
GROOVE_OIL = CellError(8e-3, 1.5, GROOVE.along, least=40)
# In a film that empties, cells fill and rupture one by one; below 48 around the error is several times as large.
EMPTYING = CellError(4e-3, 1.0, {4: 6e-3, 5: 3e-3, 6: 2e-3, 8: 8e-4, 10: 5e-4}, least=48)
BORES = CellError(1.8e-3, 3.0, {4: 1.2e-2, 5: 2.6e-3, 6: 2.5e-3, 8: 9e-4, 10: 4e-4}, least=40, coarser=OF_HOLES)
BORES_OIL = CellError(3.5e-3, 2.0, {4: 1.4e-2, 5: 6e-3, 6: 3e-3, 8: 1.4e-3, 10: 9e-4}, least=40, coarser=OF_HOLES)
# Pockets and slots: their edges lie between cells. 23 films of laws that keep no oil: 0.7e-3 to 1.2e-2 on 40 x 5 cells,
# where 10 with feed holes had 0.6e-3 to 3.4e-3; on 56 x 8 cells a half of it, not a third. 20 films of laws that keep
# oil on 48 x 6 cells: 0.5e-3 to 1.1e-2, two of them, nearly unstable, 3e-2 and 7e-2.
RECESSES = CellError(4.5e-3, 1.5, BORES.along, least=40)
RECESSES_OIL = CellError(6e-3, 1.5, BORES_OIL.along, least=40)


@dataclass(frozen=True)
class WorstFilm:
    """The error of a machine by its cells: the errors of all of its films. fewest: cells around that each of them
    can have: the arrays of a machine have films of equal numbers of cells."""

    films: tuple[CellError, ...]
    fewest: int = FEWEST[0]

    def of(self, cells: tuple[int, float]) -> float:
        """Expected error of the eccentricities with cells (around, along), of the worst film."""
        return max(film.of(cells) for film in self.films)

    @property
    def least(self) -> int:
        """Cells around, below which the error is a matter of chance."""
        return max(self.fewest, *(film.least for film in self.films))

    @property
    def coarser(self) -> float:
        """Error of cells to compare with over the error of the cells."""
        return max(film.coarser for film in self.films)


def worst_film(case: Case, eccentricity: float | None) -> WorstFilm:
    """The errors of the films of a case up to the largest eccentricity, where that is known."""
    places = film_places(case)
    kinds = (_kind(case, place) for place in places)
    around = (least_around(film_section(case, place.geometry, place.feed_holes)) for place in places)
    limited = tuple(kind if eccentricity is None else kind.at(eccentricity) for kind in kinds)
    return WorstFilm(limited, max(FEWEST[0], *around))


def gap_ratio(expected: float, reached: float) -> float:
    """The smallest gap at the one eccentricity over that at the other, where the other is larger."""
    return max(1.0, (1.0 - expected) / max(1.0 - reached, CLOSEST))


def fewest_cells(
    worst: WorstFilm, allowed: float, most: float, lengths: tuple[int, ...] = ALONG, share: float = 1.0
) -> tuple[int, int]:
    """The cheapest cells (around, along) with no more than the allowed error. If there are none: the most exact, or
    where their error is above `most`, so that the target is out of reach, the cheapest with little more than it.

    lengths: of the columns to choose from, which all have a fast elimination; share: of their cells that a film without
    tilt has which is as exact."""
    around = [m for m in AROUND if m >= worst.least]
    choices = [(m, k) for m in around for k in lengths]
    choices.sort(key=lambda cells: cells_time(cells[0], cells[1], lengths))
    errors = {(m, k): worst.of((m, share * k)) for m, k in choices}
    best = min(errors.values())
    if best > allowed:
        allowed = best if best <= most else KNEE * best
    return next(cells for cells in choices if errors[cells] <= allowed)


def given_cells(mesh: tuple[int, int], fewest: int = FEWEST[0]) -> tuple[tuple[int, int], str]:
    """Cells (around, along) for a mesh (along, around) that a case sets, and why. fewest: around."""
    along, around = mesh
    cells = max(around, fewest), max(along, FEWEST[1])
    if cells == (around, along):
        return cells, "set in the case"
    return cells, f"[{along}, {around}] is set in the case, fewer than a film needs"


def cells_time(around: int, along: int, fast: tuple[int, ...] = FAST) -> float:
    """Time of a film solve by its cells, in any unit. fast: lengths of columns that have a fast elimination."""
    return around * along * (1.0 + (along / CELLS_DOUBLE) ** 2) * (1.0 if along in fast else SLOW)


def coarser_cells(worst: WorstFilm, cells: tuple[int, int]) -> tuple[int, int] | None:
    """The most exact cells that are FEWER in both directions, with at least COARSER times the error, with feed holes
    OF_HOLES times if such cells are not too few for their error to be known; None if there are none."""
    low, high = FEWER
    around = [m for m in (*FEWER_AROUND, *AROUND) if low * cells[0] <= m <= high * cells[0]]
    choices = [(m, k) for m in around for k in FAST if m >= worst.fewest and low * cells[1] <= k <= high * cells[1]]
    errors = {choice: worst.of(choice) for choice in choices}
    tried = [(COARSER, 0)] if worst.coarser == COARSER else [(worst.coarser, worst.least), (COARSER, 0)]
    for times, fewest in tried:
        coarser = [one for one in choices if errors[one] >= times * worst.of(cells) and one[0] >= fewest]
        if coarser:
            return min(coarser, key=lambda choice: errors[choice])
    return None


def compared_states(cells: tuple[int, int]) -> int:
    """At how many states of a run the forces are solved again on finer cells: fewer where that takes long."""
    return max(FEWEST_STATES, round(MOST_STATES * cells_time(*USUAL) / max(cells_time(*cells), cells_time(*USUAL))))


def _kind(case: Case, place: FilmPlace) -> CellError:
    law = law_named(case.cavitation(place.geometry))
    keeps = law.keeps_oil
    section = film_section(case, place.geometry, place.feed_holes)
    if section.holes:
        if _recessed(place):
            return RECESSES_OIL if keeps else RECESSES
        return BORES_OIL if keeps else BORES
    if law.empties and no_inflow(section):
        return EMPTYING
    if is_plain(place.geometry):
        return PLAIN_OIL if keeps else PLAIN
    if section.grooves:
        short = len(section.grooves) > 1 or place.geometry.width < NARROW * place.geometry.diameter
        one = GROOVE_OIL if keeps and short else GROOVE
        return replace(one, around=one.around * len(section.grooves))
    return LOBES_OIL if keeps else LOBES


def _recessed(place: FilmPlace) -> bool:
    """Whether a film has openings that do not go through the body around it."""
    film = place.geometry
    return not all(outline.through for outline in film.supply.outlines(0.5 * film.diameter, film.width))
