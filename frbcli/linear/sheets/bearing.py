"""The sheet of a bearing: static equilibrium, coefficients, power loss, flow and largest pressure of every film.

Over the rotor speed each film rests under its static load, which comes from the rotor of the case or is given; over the
eccentricity (Sommerfeld's chart) the load is the one that the film carries there. Positions, loads and coefficients
follow from static_films.py, as in all static results; torques, flows and pressures are solved on finite volumes in the
same places, for every gap and every cavitation model. With heat every speed has the viscosities and clearances at which
the heat of the machine balances with the films of a run. """

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.columns import Column, Table, Tabular, table_of
from frbcli.equilibrium.linearised import RestingFilm, coefficient_error, place_error, resting_film
from frbcli.equilibrium.ring_speed import dragged_speeds
from frbcli.equilibrium.static_films import StaticFilms, static_films
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.errors import NotConverged, input_error
from frbcli.film.cavitation.table import law_named
from frbcli.film.roughness.contact import closes_freely_until
from frbcli.linear.columns import sheet_columns
from frbcli.linear.sheets.film_state import FilmState, film_state, no_state, under_vertical_load
from frbcli.scene.films import bearing_films
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import BEARING, CHART, LOADED
from frbcli.scene.supply import advised

Observer = Callable[[int, int], None]

SPEEDS = 20
MIXED_SPEEDS, MIXED_RANGE = 28, 3000.0  # of rough surfaces: from boundary friction on
ECCENTRICITIES = tuple(0.05 * i for i in range(1, 20))
SPEED, ECCENTRICITY = "speed", "eccentricity"
UNRESOLVED = 0.1  # error of coefficients from which on the gap that an elastic shell keeps is too narrow


@dataclass(frozen=True, repr=False)
class BearingSheet(Tabular):
    """States of the films of a case over "speed" or "eccentricity", film by film within each of them, without dampers;
    laws: the cavitation model of each film, in the order of the films."""

    case: Case
    over: str
    films: tuple[str, ...]
    laws: tuple[str, ...]
    points: tuple[FilmState, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The model of each film in words."""
        return tuple(law_named(law).label for law in self.laws)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the sheet."""
        tilting = any(point.tilting is not None for point in self.points)
        return sheet_columns(self.case.contact.rough, tilting)

    def of(self, film: str) -> tuple[FilmState, ...]:
        """The states of one film that were found."""
        return tuple(point for point in self.points if point.film == film and not point.problem)

    @property
    def pressed(self) -> tuple[FilmState, ...]:
        """Films pressed into an elastic shell that keeps a gap too narrow for the meshes: their coefficients have large
        errors."""
        contact = self.case.contact
        if contact.policy != "elastic" or contact.rough:
            return ()
        begins = closes_freely_until(contact.eccentricity)
        return tuple(each for each in self.points if each.error > UNRESOLVED and each.eccentricity > begins)

    def table(self) -> Table:
        """One row per film and state."""
        return table_of(self.columns, self.points)


def bearing_sheet(
    case: Case, speeds_Hz: Sequence[float] | None = None, load: float | None = None, observe: Observer | None = None
) -> BearingSheet:
    """Compute the films over the rotor speed, each under its static load.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz, above 0; by default a range up to the highest of the case, or the speed of its kinematic
        test.
    load : float, optional
        Load in N along -y on a single film; by default from the rotor or [motion].
    observe : callable, optional
        Called with each speed's number and their number.

    Returns
    -------
    BearingSheet
        Position, film thickness in m, stiffness in N/m, damping in N s/m, loss in W, flow in m^3/s, pressure in Pa of
        every film at every speed. Floating rings turn as their torques balance (4.17).

    Raises
    ------
    InputError
        If the case has no film, no load or no speed, or heat and a load that does not come from its rotor.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> sheet = frbcli.bearing_sheet(case, [100.0])
    >>> len(sheet.points)
    1
    """
    require(case, BEARING if load is None and case.given_rotor is not None else LOADED)
    speeds = sorted(_speeds(case) if speeds_Hz is None else speeds_Hz)
    machines = StaticMachines(case, load, speeds[-1])
    near: MachineAtRest | None = None
    rows: list[list[FilmState]] = []
    for number, speed in enumerate(reversed(speeds)):  # from near the centre, where a fast journal rests, outwards
        try:
            with advised(case):
                near = machines.at(2.0 * math.pi * speed, near)
                rows.append(_states(near))
        except NotConverged as error:
            rows.append([no_state(place.name, speed, str(error)) for place in bearing_films(case)])
        if observe is not None:
            observe(number + 1, len(speeds))
    points = tuple(point for states in reversed(rows) for point in states)
    return _sheet(case, SPEED, points)


def _sheet(case: Case, over: str, points: tuple[FilmState, ...]) -> BearingSheet:
    names = tuple(place.name for place in bearing_films(case))
    return BearingSheet(case, over, names, case.cavitations[: len(names)], points)


def sommerfeld_chart(
    case: Case,
    eccentricities: Sequence[float] = ECCENTRICITIES,
    speed_Hz: float | None = None,
    observe: Observer | None = None,
) -> BearingSheet:
    """Compute the films over the eccentricity of their journals, under the load along -y that they carry there.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    eccentricities : sequence of float
        Displacements over the clearance, between 0 and 1.
    speed_Hz : float, optional
        Rotor speed in Hz; by default the highest of the case. Floating rings turn as they do in concentric films.
    observe : callable, optional
        Called with the number of each eccentricity and their number.

    Returns
    -------
    BearingSheet
        As `bearing_sheet`, with the Sommerfeld number.

    Raises
    ------
    InputError
        As `bearing_sheet`.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> chart = frbcli.sommerfeld_chart(case, [0.5], 100.0)
    >>> chart.points[0].eccentricity
    0.5
    """
    require(case, CHART)
    speed = max(_speeds(case)) if speed_Hz is None else speed_Hz
    static = static_films(case, 0.0, speed)
    system, volumes, omega = static.system, static.fields, 2.0 * math.pi * speed
    spins = dragged_speeds(system, omega, np.zeros((len(system.names), system.films.coordinates)))
    bodies, omegas = np.concatenate([[omega], spins]), system.omegas(omega, spins)
    points = []
    for number, eccentricity in enumerate(eccentricities):
        for i, name in enumerate(place.name for place in bearing_films(case)):
            try:
                at_rest = _at_eccentricity(static, i, eccentricity, float(omegas[i]))
                points.append(film_state(static, volumes[i], i, bodies, at_rest))
            except NotConverged as error:
                points.append(no_state(name, speed, str(error), eccentricity))
        if observe is not None:
            observe(number + 1, len(eccentricities))
    return _sheet(case, ECCENTRICITY, tuple(points))


def _states(machine: MachineAtRest) -> list[FilmState]:
    """The states of the films of a machine except dampers, which do not turn."""
    volumes = machine.static.fields[: len(bearing_films(machine.static.case))]
    bodies = np.concatenate([[machine.omega], machine.at_rest.position.ring_speeds])
    warm = (math.nan,) * len(volumes) if machine.warm is None else [film.temperature for film in machine.warm.films]
    return [
        film_state(machine.static, volume, i, bodies, film, temperature)
        for i, (volume, film, temperature) in enumerate(zip(volumes, machine.films, warm, strict=False))
    ]


def _at_eccentricity(static: StaticFilms, i: int, eccentricity: float, omega: float) -> RestingFilm:
    """Film i under the load along -y that it carries at an eccentricity."""
    place, force = under_vertical_load(static.system, i, eccentricity, omega)
    system, clearance = static.system, static.system.clearances[i]
    others = [(*under_vertical_load(films.system, i, eccentricity, omega), films.share) for films in static.others]
    error = coefficient_error(force, [(other, share) for _, other, share in others], omega)
    off = place_error(place / clearance, [(there / clearance, share) for there, _, share in others])
    return resting_film(system.names[i], force, place / clearance, error, off)


def _speeds(case: Case) -> tuple[float, ...]:
    """Default speeds in Hz, all positive."""
    if case.given_speed is not None:
        low, high = sorted((abs(case.speed.start), abs(case.speed.end)))
        if case.contact.rough:
            return tuple(np.geomspace(max(low, high / MIXED_RANGE), high, MIXED_SPEEDS).tolist())
        return tuple(np.linspace(max(low, high / SPEEDS), high, SPEEDS).tolist())
    if case.motion is not None and case.motion.speed:
        return (abs(case.motion.speed),)
    raise input_error(case.name or "case", "speed", "", "is missing.", "Give --speed, or add [speed].")
