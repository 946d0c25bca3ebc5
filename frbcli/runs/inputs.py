"""The inputs over time of a run: what the time loop follows, and their signals; and the numbers of the films that heat
and inputs over time change, at the samples of the run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.course.time_tables import inputs_of
from frbcli.case.schema import Case
from frbcli.case.surroundings.over_time import OverTime
from frbcli.film.cells.balance.boundaries import opening_pressures
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import heat_of
from frbcli.scene.machine.system import System
from frbcli.solve.inputs import Inputs

LEAST_SHARE = 1e-9  # of the largest gauge pressure: a supply at the ambient pressure counts as having so little
PRESSURE, TEMPERATURE = ("supply_pressure_{}_Pa", "Pa"), ("supply_temperature_{}_K", "K")


@dataclass(frozen=True)
class MachineInputs:
    """What changes over time in a run, in SI: temperatures of the supplies of films, and of nodes of the heat; absolute
    pressures of the supplies of films, each with the number of the film or node. ambient: Pa; largest: (films,) gauge
    pressures of all supplies, of those that change the largest one, 1 where nothing supplies; limited: films whose
    supplies are flow-limited, so that the pressure of their openings changes."""

    supplies: tuple[tuple[int, OverTime], ...]
    walls: tuple[tuple[int, OverTime], ...]
    pressures: tuple[tuple[int, OverTime], ...]
    ambient: float
    largest: Array
    limited: tuple[int, ...]

    def shares(self, times: Array) -> Array | None:
        """(k, films) shares of the largest gauge pressure at times (k,) in s; None where no pressure changes."""
        if not self.pressures:
            return None
        ratio = np.ones((len(times), len(self.largest)))
        for film, table in self.pressures:
            ratio[:, film] = (np.interp(times, table.time, table.x) - self.ambient) / self.largest[film]
        return np.maximum(ratio, LEAST_SHARE)


def machine_inputs(case: Case) -> MachineInputs | None:
    """The inputs of a case that change over time, None without any."""
    supplies = [place.geometry.supply for place in film_places(case)]
    limited = tuple(film for film, supply in enumerate(supplies) if math.isfinite(supply.largest_flow))
    if not (limited or any(True for _ in inputs_of(case))):
        return None
    ambient, heat = case.oil.ambient_pressure, None if case.heat is None else heat_of(case)
    gauges = [supply.gauge(ambient) for supply in supplies]
    fed = (supply.over_time if gauge > 0.0 else None for supply, gauge in zip(supplies, gauges, strict=True))
    inputs = MachineInputs(
        () if heat is None else _changing(enumerate(heat.supplies)),
        () if heat is None else _changing(heat.walls),
        _changing(enumerate(fed)),
        ambient,
        np.array([gauge if gauge > 0.0 else 1.0 for gauge in gauges]),
        limited,
    )
    return inputs if limited or inputs.supplies or inputs.walls or inputs.pressures else None


def films_change(case: Case) -> bool:
    """Whether clearances or scales of films change in a run: by heat, or with the pressure of their supplies."""
    inputs = None if case.heat is not None else machine_inputs(case)
    return case.heat is not None or (inputs is not None and bool(inputs.pressures))


def _changing(given: Iterable[tuple[int, float | OverTime | None]]) -> tuple[tuple[int, OverTime], ...]:
    return tuple((number, value) for number, value in given if isinstance(value, OverTime))


@dataclass(frozen=True)
class RunInputs:
    """The inputs of a run, None where nothing changes over time; names: of its films."""

    machine: MachineInputs | None
    names: tuple[str, ...]

    @classmethod
    def of(cls, case: Case, system: System) -> RunInputs:
        """The inputs of a case, with the names of the films of its machine."""
        return cls(machine_inputs(case), system.names)

    @property
    def change_films(self) -> bool:
        """Whether they change the films in addition to the heat."""
        return self.machine is not None and bool(self.machine.limited or self.machine.pressures)

    def at_start(self, system: System) -> System:
        """The machine as it is at the start of a run."""
        shares = self.shares(np.zeros(1))
        return system if shares is None else replace(system, films=system.films.supplied(shares[0]))

    def shares(self, times: Array) -> Array | None:
        """See MachineInputs.shares."""
        return None if self.machine is None else self.machine.shares(times)

    def loop(self, system: System) -> Inputs | tuple[()]:
        """The inputs as the time loop takes them."""
        machine = self.machine
        if machine is None or not (machine.supplies or machine.walls or machine.pressures):
            return ()
        groups = machine.supplies, machine.walls, machine.pressures
        tables = [table for group in groups for _, table in group]
        places, count = [], 0
        for group in groups:
            pairs = [(count + number, place) for number, (place, _) in enumerate(group)]
            places.append(np.array(pairs, dtype=np.int64).reshape(-1, 2))
            count += len(group)
        films = len(self.names)
        return Inputs(
            np.cumsum([0, *(len(table.time) for table in tables)]),
            np.array([time for table in tables for time in table.time], dtype=np.float64),
            np.array([value for table in tables for value in table.x], dtype=np.float64),
            places[0],
            places[1],
            places[2],
            machine.ambient,
            LEAST_SHARE,
            machine.largest,
            np.ones(films),
            np.ones(films),
            system.films.heat_ends() if machine.pressures else (),
        )

    def units(self) -> dict[str, str]:
        """The signals of inputs and their units."""
        known = {name: unit for name, unit, _ in self._changing_signals()}
        return known | {name: PRESSURE[1] for _, name in self._limited()}

    def signals(self, system: System, times: Array, fillings: Array) -> dict[str, Array]:
        """The signals of inputs at times (k,) in s; fillings (k, films): see opening_pressures. The pressure of a
        flow-limited supply is the pressure in its openings."""
        by_name = {name: np.interp(times, table.time, table.x) for name, _, table in self._changing_signals()}
        if self.machine is None:
            return by_name
        shares = self.machine.shares(times)
        for film, name in self._limited():
            supplies = self.machine.largest[film] * (np.ones(len(times)) if shares is None else shares[:, film])
            openings = opening_pressures(system.films.with_fields[film], fillings[:, film], supplies)
            by_name[name] = self.machine.ambient + openings
        return by_name

    @property
    def limited(self) -> bool:
        """Whether a supply is flow-limited."""
        return self.machine is not None and bool(self.machine.limited)

    def _limited(self) -> Sequence[tuple[int, str]]:
        """The films with flow-limited supplies, and the names of their signals."""
        films = () if self.machine is None else self.machine.limited
        return tuple((film, signal_of(PRESSURE[0], self.names[film])) for film in films)

    def _changing_signals(self) -> Sequence[tuple[str, str, OverTime]]:
        """Names, units and tables of the signals: of the films whose supplies change."""
        if self.machine is None:
            return ()
        groups = (PRESSURE, self.machine.pressures), (TEMPERATURE, self.machine.supplies)
        return tuple(
            (signal_of(form, self.names[film]), unit, table) for (form, unit), group in groups for film, table in group
        )


def signal_of(form: str, film: str) -> str:
    """The name of a signal of a film, which may be the only one."""
    return form.format(film) if film else form.replace("{}_", "")


@dataclass(frozen=True)
class FilmNumbers:
    """The numbers of films that heat and inputs change, at k samples, or once for all: (k, films) or (1, films) each.

    clearances m; drags N m s; scales: 12 eta / psi^2 over its value for the films as they were made, over the share of
    their gauge supply pressures.
    """

    clearances: Array
    drags: Array
    scales: Array


def unchanged(system: System) -> FilmNumbers:
    """The numbers of films without heat, with one row: clearances in m, drags in N m s, scales 1."""
    clearances, drags = np.array([system.clearances]), np.array([system.drags])
    return FilmNumbers(clearances, drags, np.ones_like(drags))


def supplied(system: System, warm: FilmNumbers | None, shares: Array | None) -> FilmNumbers | None:
    """The numbers `warm` with shares (k, films) of the gauge supply pressures; None where nothing changes."""
    if shares is None:
        return warm
    films = warm or unchanged(system)
    clearances, drags = (np.broadcast_to(each, shares.shape) for each in (films.clearances, films.drags))
    return FilmNumbers(clearances, drags, films.scales / shares)
