"""The machine of a case at rest at any speed, with its heat if it has any, and the coefficients of its films.

The machine at a constant speed with its heat: temperatures, static equilibrium and ring speeds together.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.elements.ball import BallBearingElement
from frbcli.equilibrium.dynamic_films import DynamicFilm, Oscillator, constant_film, dynamic_film, followed, modes
from frbcli.equilibrium.linearised import (
    LEAST,
    FilmsAtRest,
    RestingFilm,
    coefficient_error,
    films_at_rest,
    oscillator,
    place_error,
    resting_film,
)
from frbcli.equilibrium.resting import (
    REMEMBERED,
    SEARCH,
    RestingPosition,
    Search,
    foreseen,
    resting_position,
    weighted,
    weights_at,
)
from frbcli.equilibrium.static_films import MeshFilms, StaticFilms, static_films
from frbcli.errors import NotConverged
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import HEAT, STILL
from frbcli.scene.machine.heat import Heat, heat_of, warm_system
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import make_plan
from frbcli.thermal.model import FilmHeat, SteadyHeat, steady_heat

CLOSE_ON_CELLS = replace(SEARCH, negligible=1e-8)  # temperatures settle to 1e-6 K, 1e-8 of a viscosity


@dataclass(frozen=True)
class FilmTemperature:
    """One film of a warm machine: temperature K, viscosity Pa s, clearance m, power W, flow through the ends m^3/s, of
    one bearing."""

    film: str
    temperature: float
    viscosity: float
    clearance: float
    power: float
    flow: float


@dataclass(frozen=True)
class RingTemperature:
    """One ring: inner and outer temperature K; its speed over the rotor's."""

    ring: str
    inner: float
    outer: float
    speed_ratio: float


@dataclass(frozen=True)
class WarmMachine:
    """A machine whose heat balances. system: at its viscosities and clearances; resting: where it rests;
    steady: what the balance says; films, rings: the same by name."""

    system: System
    resting: RestingPosition
    steady: SteadyHeat
    films: tuple[FilmTemperature, ...]
    rings: tuple[RingTemperature, ...]

    @property
    def omega(self) -> float:
        """Speed of the rotor in rad/s."""
        return float(self.steady.films.speeds[0])

    @property
    def balance(self) -> float:
        """Power that the balances of heat leave over, as a share of all power."""
        return self.steady.balance


def warm_machine(case: Case, speed_Hz: float | None = None) -> WarmMachine:
    """Compute the machine of a case with heat at a rotor speed, when everything is warm.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speed_Hz : float, optional
        Rotor speed in Hz; by default the highest of the run.

    Returns
    -------
    WarmMachine
        Temperatures in K, viscosities in Pa s, losses in W, ring speeds.

    Raises
    ------
    InputError
        For a case that cannot be modelled or has no heat.
    NotConverged
        Where its heat does not balance.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.warm_machine(frbcli.load_case("floating-ring-heat"))  # doctest: +SKIP
    """
    require(case, HEAT)
    plan = make_plan(case)
    top = max(abs(case.speed.start), abs(case.speed.end)) if speed_Hz is None else speed_Hz
    return WarmMachines(case, plan, make_system(case, plan)).at(2.0 * math.pi * top)


def film_temperatures(balance: SteadyHeat, names: Sequence[str]) -> tuple[FilmTemperature, ...]:
    """The films of these names, "" for a film that is alone, in a balance of heat."""
    heat = balance.films
    rows = zip(balance.temperatures, balance.viscosities, balance.clearances, heat.power, heat.flow, strict=False)
    return tuple(FilmTemperature(name or "film", *map(float, row)) for name, row in zip(names, rows, strict=True))


class WarmMachines:
    """Warm machines of a case at any speed; tables are made once."""

    def __init__(self, case: Case, plan: Plan, system: System) -> None:
        self._case, self._plan, self._system = case, plan, system
        self._heat: Heat = heat_of(case)

    def at(self, omega: float, path: Sequence[WarmMachine] = ()) -> WarmMachine:
        """The machine at omega rad/s, as those at other speeds, of which the last one is near, foresee it. Raises
        NotConverged."""
        search = CLOSE_ON_CELLS if self._plan.form.by_cells else SEARCH
        system, resting = self._system, None
        begin, slope = self._heat.start, np.asarray(-np.eye(len(self._heat.start)))
        speeds = np.append(omega, np.zeros(system.ring_count))
        if path:
            omegas = [machine.omega for machine in path]
            weights, resting = weights_at(omega, omegas), foreseen(omega, omegas, [each.resting for each in path])
            begin = weighted(weights, [each.steady.temperatures for each in path[-len(weights) :]])
            slope, speeds = path[-1].steady.slope, np.append(omega, resting.ring_speeds)

        def solve(viscosities: Array, clearances: Array) -> FilmHeat:
            nonlocal system, resting
            system = warm_system(self._case, self._plan, self._system, viscosities, clearances)
            if resting is not None and system.remembers:  # what fronts of oil leave differs at another speed
                resting = resting.without_films
            resting = resting_position(system, omega, None, search, resting)
            bodies = np.concatenate([[omega], resting.ring_speeds])
            power, flow = _film_heat(system, resting, bodies)
            return FilmHeat(power, self._heat.side_flow(flow, viscosities, clearances), bodies)

        steady = steady_heat(self._heat.model, system.names, solve, begin, speeds, slope)
        assert resting is not None
        t, films = steady.temperatures, steady.films
        rings = tuple(
            RingTemperature(
                ring.name or "ring",
                float(t[ring.inner]),
                float(t[ring.outer]),
                float(films.speeds[1 + ring.turning] / films.speeds[0]) if ring.turning >= 0 else 0.0,
            )
            for ring in self._heat.rings
        )
        return WarmMachine(system, resting, steady, film_temperatures(steady, system.names), rings)


def _film_heat(system: System, resting: RestingPosition, bodies: Array) -> tuple[Array, Array]:
    """Power in W and flow through the ends in m^3/s, (films,) each, of a machine at rest. bodies: (1 + rings,) speeds
    of rotor and rings in rad/s. Raises NotConverged.

    Journal and shell put P = -M_J omega_J - M_S omega_S - F . (v_J - v_S) into a film. With Couette's resistance k to
    the slip and the force F at the displacement e this is k (omega_J - omega_S)^2 + (e x F)(omega_J + omega_S)/2 -
    F . e'. Between rough surfaces the friction of the summits makes heat in the same film.
    """
    turning = (system.turning[:, :2] @ bodies).tolist()
    rows = [
        system.films.power_and_flow(i, system.felt(i, place), total, slip, drag, near)
        for i, (place, (total, slip), drag, near) in enumerate(
            zip(resting.journals, turning, system.drags, resting.films or (None,) * len(turning), strict=True)
        )
    ]
    power, flow = np.array(rows).T
    if system.asperities is not None:
        speeds = enumerate(zip(resting.journals, turning, strict=True))
        power = power + [system.rubbing(i).power(place, *turns) for i, (place, turns) in speeds]
    return power, flow


ON_CELLS = replace(SEARCH, negligible=SEARCH.step)
SCOUT = replace(SEARCH, step=1e-6)  # of a coarse mesh: the step after it is a hundredth of that at most
# Of other meshes, whose differences are shown to one or two digits, from 3e-5 on: slopes of finite-volume films lack
# what the law follows, slopes of others are exact, and a step leaves its square over the gap.
NEARLY, NEARLY_ON_CELLS = replace(SEARCH, step=1e-4), replace(SEARCH, step=1e-5, negligible=1e-6)
NEARLY_CARRIED = LEAST  # share of the load that may be left over on other meshes than cells
# Differences of coefficients between meshes of cells scatter, and may be so much less than is to be expected. Where all
# meshes agree by chance, they may still be off by so much of the square of a cell's length over 1 - e, the narrow gap.
SCATTER, NARROW = 1.25, 0.15


@dataclass(frozen=True)
class MachineAtRest:
    """A machine at omega rad/s. static: its films at their viscosities; films: coefficients and their error; at_rest:
    its position and the films as they are solved; warm: the heat of the machine, None without; others: the same on
    other meshes, each with the share of the difference that is the error, see MeshFilms; none without errors; dynamic:
    the films with the memory of their oil, of machines that were asked for with it and have such films, whose
    coefficients in `films` are then one-sided ones without error; before: machines at the speeds before it, the last
    one the nearest, themselves without any."""

    static: StaticFilms
    omega: float
    films: tuple[RestingFilm, ...]
    at_rest: FilmsAtRest
    warm: WarmMachine | None = None
    others: tuple[tuple[FilmsAtRest, float], ...] = ()
    dynamic: tuple[DynamicFilm, ...] = ()
    before: tuple[MachineAtRest, ...] = ()

    @property
    def system(self) -> System:
        """The machine."""
        return self.static.system

    @cached_property
    def oscillator(self) -> Oscillator:
        """The machine without its films, which are mass-conserving."""
        return oscillator(self.system, self.omega, self.at_rest, self.dynamic)

    @cached_property
    def modes(self) -> list[tuple[complex, Complex]]:
        """Eigenvalues in 1/s with their shapes (n,), of a machine with the memory of its oil, see dynamic_films."""
        return modes(self.oscillator, self.dynamic, [film.own for film in self.dynamic], self.omega)

    @property
    def modes_on_finer_films(self) -> list[tuple[complex, Complex]]:
        """Modes of the finer of two meshes, instead of the extrapolation from both."""
        return followed(self.oscillator, [film.fine for film in self.dynamic], self.modes)

    @property
    def path(self) -> tuple[MachineAtRest, ...]:
        """The machines from which one at another speed is foreseen, the last one this."""
        return (*self.before, replace(self, before=()))[-REMEMBERED:]


class StaticMachines:
    """Machines of a case at rest at any speed; their films are made once. load, top_Hz: as static_films; memory:
    whether films that keep oil are wanted with its memory; coarse: see StaticFilms.

    With heat, the temperatures are those at which the heat balances with the films of a run; positions and coefficients
    are then of static films with these viscosities and clearances."""

    def __init__(
        self,
        case: Case,
        load: float | None = None,
        top_Hz: float | None = None,
        memory: bool = False,
        coarse: bool = False,
    ) -> None:
        self._case = case
        films, self._heat = static_films(case, load, top_Hz), None
        own = ON_CELLS if films.on_cells else SEARCH
        self._static, self._search = (films.coarse, SCOUT) if coarse else (films, own)
        self._memory = memory and self._static.system.remembers
        if case.heat is not None:
            plan = make_plan(case, STILL)
            self._heat = WarmMachines(case, plan, make_system(case, plan))

    @property
    def static(self) -> StaticFilms:
        """The films, without heat."""
        return self._static

    @property
    def system(self) -> System:
        """The machine, without heat."""
        return self._static.system

    def _check_speed(self, omega: float) -> None:
        """Raises NotConverged where an axial load is carried by no film, or parts the rings of a ball bearing, and
        where a pair of rows is not known in tilt."""
        for element in BallBearingElement.of(self._case):
            check_balls(element, omega)
        if self._case.loads_a_collar:
            from frbcli.elements.collar import collar_at_rest, collar_of  # films on pads take long to import

            if (collar := collar_of(self._case)) is not None:
                collar_at_rest(collar, omega)

    def at(self, omega: float, near: MachineAtRest | None = None, with_error: bool = True) -> MachineAtRest:
        """The machine at omega rad/s, sought from one near it; with_error: whether errors of the coefficients are
        wanted, else they are NaN. Raises NotConverged."""
        self._check_speed(omega)
        path = near.path if near else ()
        warm, static = None, self._static
        if self._heat is not None:
            warm = self._heat.at(omega, [machine.warm for machine in path if machine.warm])
            viscosities, clearances = (
                np.array([getattr(film, name) for film in warm.films]) for name in ("viscosity", "clearance")
            )
            static = static.warm(viscosities, clearances)
        with_error = with_error and not self._memory
        # what fronts of oil leave differs from speed to speed: only what the memory of the oil needs follows them
        follows = not (static.system.remembers and (with_error or warm))
        start = None if warm is None else warm.resting.without_films
        if path and warm is None:
            start = _foreseen(omega, [(each.omega, each.at_rest) for each in path]).without_films
        path, settled = path if follows else (), not self._memory
        meshes, others = static.others if with_error else (), list[tuple[FilmsAtRest, float]]()
        scouts = static.on_cells and not path  # coarse meshes bring the journals near to where they rest
        if scouts:
            start, others = _on_others(meshes or static.others[:1], omega, (), start, NEARLY_ON_CELLS, settled)
        if path:
            start = _foreseen(omega, [(each.omega, each.at_rest) for each in path])
        position = resting_position(static.system, omega, None, self._search, start)
        at_rest = films_at_rest(static.system, omega, position, settled)
        if not scouts:
            search = NEARLY_ON_CELLS if static.on_cells else _nearly(static.system, at_rest)
            _, others = _on_others(meshes, omega, path, position.without_films, search, settled)
        counted = others if with_error else []
        films = tuple(_resting_film(static, omega, i, at_rest, counted) for i in range(len(at_rest.forces)))
        dynamic = _dynamic(static.system, omega, at_rest) if self._memory else ()
        before = () if near is None else near.path
        return MachineAtRest(static, omega, films, at_rest, warm, tuple(counted), dynamic, before)


def check_balls(bearing: BallBearingElement, omega: float) -> None:
    """Raises NotConverged at a speed in rad/s at which a ball bearing has no force, or none that is known."""
    tilt, name, speed = bearing.tilt, bearing.given.name, omega / (2.0 * math.pi)
    if bearing.preload_left(omega) <= 0.0:
        raise NotConverged(f"The axial load pulls the rings of the bearing {name} apart at {speed:.4g} Hz.")
    if tilt is not None and omega > tilt.speeds[-1] * (1.0 + 1e-9):
        known = f"is known up to {tilt.speeds[-1] / (2.0 * math.pi):.4g} Hz, and not at {speed:.4g} Hz"
        raise NotConverged(f"The stiffness in tilt of the bearing {name} {known}. Give the case another speed.to.")


def _foreseen(omega: float, known: Sequence[tuple[float, FilmsAtRest]]) -> RestingPosition:
    """The position on one mesh at omega rad/s as those at other speeds foresee it."""
    return foreseen(omega, [each for each, _ in known], [films.position for _, films in known])


def _nearly(system: System, at_rest: FilmsAtRest) -> Search:
    """How closely rest is sought on another mesh than cells. LEAST of the load moves a journal by less than LEAST of
    its clearance, the least error that is stated of its place: solving the films once more would add nothing. Moments
    on films that see tilts have another scale."""
    if system.films.coordinates > 2:
        return NEARLY
    carried = [many * film.force for many, film in zip(system.rotor.multiplicity, at_rest.forces, strict=True)]
    return replace(NEARLY, force=NEARLY_CARRIED * float(np.linalg.norm(carried)))


def _on_others(
    meshes: tuple[MeshFilms, ...], omega: float, path: Sequence[MachineAtRest], start: RestingPosition | None,
    search: Search, settled: bool = True,
) -> tuple[RestingPosition | None, list[tuple[FilmsAtRest, float]]]:  # fmt: skip
    """The machine on several meshes, sought from `start`, at a distance as the machines of the path have it on each, or
    else from where it rests on the mesh before; the last position, without films; meshes on which no position is found
    are left out."""
    others, path = [], [machine for machine in path if len(machine.others) == len(meshes)]
    for number, mesh in enumerate(meshes):
        near = start
        if start is not None and path:
            own, its = (
                _foreseen(omega, [(each.omega, films) for each, films in zip(path, known, strict=True)])
                for known in ([each.at_rest for each in path], [each.others[number][0] for each in path])
            )
            near = its.moved(start.displacements - own.displacements, start.ring_speeds - own.ring_speeds)
        try:
            position = resting_position(mesh.system, omega, None, search, near)
            others.append((films_at_rest(mesh.system, omega, position, settled), mesh.share))
            start = start if path else position.without_films
        except NotConverged:
            continue
    return start, others


def _resting_film(
    static: StaticFilms, omega: float, i: int, at_rest: FilmsAtRest, others: Sequence[tuple[FilmsAtRest, float]]
) -> RestingFilm:
    """Film i of a machine at rest at omega rad/s, with its errors from the other meshes, NaN without any."""
    system, plan = static.system, static.own.plan
    force, clearance = at_rest.forces[i], system.clearances[i]
    at = at_rest.position.journals[i]
    place, tilt = at[:2] / clearance, at[2:] if len(at) > 2 else None
    forces = [(other.forces[i], share) for other, share in others]
    places = [(other.position.journals[i][:2] / clearance, share) for other, share in others]
    error = coefficient_error(force, forces, omega)
    if plan.edged and plan.cells:
        error = max(SCATTER * error, NARROW * (2.0 * math.pi / plan.cells[0]) ** 2 / (1.0 - float(np.hypot(*place))))
    return resting_film(system.names[i], force, place, error, place_error(place, places), tilt=tilt)


def _dynamic(system: System, omega: float, at_rest: FilmsAtRest) -> tuple[DynamicFilm, ...]:
    """The films of a machine at rest at omega rad/s with the memory of their oil. Raises NotConverged."""
    places, totals, turns = at_rest.position.journals, at_rest.totals.tolist(), system.ring_count > 0

    def film(i: int, keeps: bool) -> DynamicFilm:
        if keeps:
            own = dynamic_film(partial(system.films.linear, i), places[i], totals[i], omega, turns)
        if system.asperities is None:
            return own if keeps else constant_film(at_rest.forces[i], places[i], turns)
        slip = float(at_rest.slips[i])
        summits = system.rubbing(i).force(places[i], np.zeros(2), slip, 0.5 * (totals[i] - slip))
        own = own if keeps else constant_film(at_rest.forces[i].plus(summits, -1.0), places[i], turns)
        return own.on(summits)

    return tuple(film(i, keeps) for i, keeps in enumerate(system.remembering))
