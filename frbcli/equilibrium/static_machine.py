"""The machine of a case at rest at any speed, with its heat if it has any, and the coefficients of its films."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.equilibrium.coefficients import (
    LEAST,
    FilmsAtRest,
    RestingFilm,
    coefficient_error,
    films_at_rest,
    place_error,
    resting_film,
)
from frbcli.equilibrium.dynamic_films import DynamicFilm, Oscillator, constant_film, dynamic_film, followed, modes
from frbcli.equilibrium.linearised import oscillator
from frbcli.equilibrium.newton import Search
from frbcli.equilibrium.resting import SEARCH, held_in_plane, resting_position
from frbcli.equilibrium.static_films import MeshFilms, StaticFilms, static_films
from frbcli.equilibrium.warm_machine import WarmMachine, WarmMachines
from frbcli.errors import NotConverged
from frbcli.rotor.assembly import HeldRotor
from frbcli.scene.gate.rule import STILL
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan

ON_CELLS = replace(SEARCH, negligible=SEARCH.step)
SCOUT = replace(SEARCH, step=1e-6)  # of a coarse mesh: the step after it is a hundredth of that at most
# Of other meshes, whose differences are shown to one or two digits, from 3e-5 on: slopes of finite-volume films lack
# what the law follows, slopes of others are exact, and a step leaves its square over the gap.
NEARLY, NEARLY_ON_CELLS = replace(SEARCH, step=1e-4), replace(SEARCH, step=1e-5, negligible=1e-6)
NEARLY_CARRIED = LEAST  # share of the load that may be left over on other meshes than cells
# Differences of coefficients between meshes of cells scatter, and may be so much less than is to be expected. Where all
# meshes agree by chance, they may still be off by so much of the square of a cell's length over 1 - e, the narrow gap.
SCATTER, NARROW = 1.25, 0.15
CLOSE = 1e-6  # of the speed: closer machines do not show how their places change


@dataclass(frozen=True)
class MachineAtRest:
    """A machine at omega rad/s. static: its films at their viscosities; films: coefficients and their error; at_rest:
    its position and the films as they are solved; warm: the heat of the machine, None without; others: the same on
    other meshes, each with the share of the difference that is the error, see MeshFilms; none without errors; dynamic:
    the films with the memory of their oil, of machines that were asked for with it and have such films, whose
    coefficients in `films` are then one-sided ones without error; by_omega: (n,) how its displacements change with the
    speed in m s, as from a machine near it, 0 without one."""

    static: StaticFilms
    omega: float
    films: tuple[RestingFilm, ...]
    at_rest: FilmsAtRest
    warm: WarmMachine | None = None
    others: tuple[tuple[FilmsAtRest, float], ...] = ()
    dynamic: tuple[DynamicFilm, ...] = ()
    by_omega: Array | float = 0.0

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

    def foreseen(self, omega: float) -> Array:
        """(n,) displacements at another speed in rad/s, on a straight line."""
        return self.at_rest.position.displacements + self.by_omega * (omega - self.omega)


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

    def _check_axis(self, omega: float) -> None:
        """Raises NotConverged where an axial load is carried by no film."""
        if self._case.loads_a_collar:
            from frbcli.elements.collar import collar_at_rest, collar_of  # films on pads take long to import

            if (collar := collar_of(self._case)) is not None:
                collar_at_rest(collar, omega)

    def at(self, omega: float, near: MachineAtRest | None = None, with_error: bool = True) -> MachineAtRest:
        """The machine at omega rad/s, sought from one near it; with_error: whether errors of the coefficients are
        wanted, else they are NaN. Raises NotConverged."""
        self._check_axis(omega)
        warm, static = None, self._static
        start = None if near is None else near.foreseen(omega)
        if self._heat is not None:
            warm = self._heat.at(omega, None if near is None else near.warm)
            viscosities, clearances = (
                np.array([getattr(film, name) for film in warm.films]) for name in ("viscosity", "clearance")
            )
            static, start = static.warm(viscosities, clearances), warm.resting.displacements
        settled, with_error = not self._memory, with_error and not self._memory
        held = held_in_plane(static.system, omega)
        remembers = static.system.remembers
        others: list[tuple[FilmsAtRest, float]] | None = None
        # what fronts of oil leave differs from speed to speed: only what the memory of the oil needs follows them
        follows = near is not None and not (remembers and (with_error or self._heat))
        neighbour = near.at_rest.position if near is not None and follows and static.on_cells else None
        if not follows and static.on_cells:  # a coarse mesh also brings the journals near to where they rest
            coarse = static.others if with_error else static.others[:1]
            start, others = _on_others(coarse, omega, start, NEARLY_ON_CELLS, held, settled)
        position = resting_position(static.system, omega, start, self._search, held, neighbour)
        at_rest = films_at_rest(static.system, omega, position, settled)
        if with_error and others is None:
            search = NEARLY_ON_CELLS if static.on_cells else _nearly(static.system, held)
            _, others = _on_others(static.others, omega, position.displacements, search, held, settled, near)
        counted = others if with_error and others else []
        films = tuple(_resting_film(static, omega, i, at_rest, counted) for i in range(len(at_rest.forces)))
        dynamic = _dynamic(static.system, omega, at_rest) if self._memory else ()
        changes = _by_omega(near, omega, position.displacements)
        return MachineAtRest(static, omega, films, at_rest, warm, tuple(counted), dynamic, changes)


def _nearly(system: System, held: HeldRotor) -> Search:
    """How closely rest is sought on another mesh than cells. LEAST of the load moves a journal by less than LEAST of
    its clearance, the least error that is stated of its place: solving the films once more would add nothing. Moments
    on films that see tilts have another scale."""
    if system.films.coordinates > 2:
        return NEARLY
    return replace(NEARLY, force=NEARLY_CARRIED * float(np.linalg.norm(held.load)))


def _by_omega(near: MachineAtRest | None, omega: float, displacements: Array) -> Array | float:
    """Derivative by speed, see MachineAtRest; reuses the neighbour's if the speeds nearly coincide."""
    if near is None:
        return 0.0
    if abs(omega - near.omega) < CLOSE * omega:
        return near.by_omega
    return (displacements - near.at_rest.position.displacements) / (omega - near.omega)


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


def _on_others(
    meshes: tuple[MeshFilms, ...], omega: float, start: Array | None, search: Search, held: HeldRotor,
    settled: bool = True, near: MachineAtRest | None = None,
) -> tuple[Array | None, list[tuple[FilmsAtRest, float]]]:  # fmt: skip
    """The displacements on the last of several meshes, each sought from those on the one before, or where the machine
    `near` has the same meshes, from `start` as far off and with the films as there; and the films of all; meshes on
    which no position is found are left out."""
    others, same = [], near is not None and len(near.others) == len(meshes)
    for number, mesh in enumerate(meshes):
        neighbour, begun = None, start
        if near is not None and same and start is not None:
            neighbour = near.others[number][0].position
            begun = start + neighbour.displacements - near.at_rest.position.displacements
        try:
            position = resting_position(mesh.system, omega, begun, search, held, neighbour)
            others.append((films_at_rest(mesh.system, omega, position, settled), mesh.share))
            start = start if same else position.displacements
        except NotConverged:
            continue
    return start, others
