"""The inputs over time of a run: what the time loop follows, and their signals; and the numbers of the films that heat
and inputs over time change, at the samples of the run.

How the rotor turns in a run: by the profile of its speed, or freely by its drive; what the time loop needs for the
latter, and its signals.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from frbcli.arrays import Array
from frbcli.case.over_time import OverTime
from frbcli.case.reading.time_tables import inputs_of
from frbcli.case.run import GOVERNED
from frbcli.case.schema import Case
from frbcli.film.cells.balance.boundaries import opening_pressures
from frbcli.results.columns import DRIVE_SIGNALS, FRICTION_SIGNAL
from frbcli.rotor.loads import LinearPart, SpeedProfile
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import heat_of
from frbcli.scene.machine.system import System
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.solve.drive import NOW, DrivenRotor, driving_along
from frbcli.solve.inputs import Inputs
from frbcli.solve.state import SLIP, TIME, State

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


SLOW = 1e-9  # share of the highest speed of a run that counts as standstill
TURN = 2.0 * math.pi
TORQUE, POWER = (column.name for column in DRIVE_SIGNALS)


class Rotation(Protocol):
    """How the rotor turns at k output times."""

    @property
    def speeds(self) -> Array:
        """(k,) rad/s."""
        ...

    @property
    def states(self) -> Array:
        """(3, k) angular acceleration in rad/s^2, speed in rad/s and angle in rad."""
        ...


@dataclass(frozen=True)
class GivenRotation:
    """Along a profile, at times (k,) in s."""

    profile: SpeedProfile
    times: Array

    @property
    def speeds(self) -> Array:
        """See Rotation."""
        return self.profile.speed(self.times)

    @property
    def states(self) -> Array:
        """See Rotation."""
        return np.array([self.profile.rotation(float(t)) for t in self.times]).reshape(-1, 3).T


@dataclass(frozen=True)
class FreeRotation:
    """By columns (k,) of its degree of freedom: angle, speed, and acceleration where the run notes it."""

    angles: Array
    speeds: Array
    accelerations: Array

    @property
    def states(self) -> Array:
        """See Rotation."""
        return np.array([self.accelerations, self.speeds, self.angles])


def rotation_at(system: System, profile: SpeedProfile, times: Array, q: Array, v: Array, noted: Array) -> Rotation:
    """The rotation at output times (k,) in s, with the motion q, v and what is noted (k, ...) of Samples."""
    place = system.rotation
    if place is None:
        return GivenRotation(profile, times)
    return FreeRotation(q[:, place].copy(), v[:, place].copy(), noted[:, place] if noted.size else np.zeros(len(times)))


def rotation_of(system: System, profile: SpeedProfile, state: State) -> tuple[float, float, float]:
    """Angular acceleration, speed and angle of the rotor in a state, rad and s."""
    place = system.rotation
    if place is None:
        return profile.rotation(float(state.numbers[TIME]))
    return float(state.a[place]), float(state.v[place]), float(state.q[place])


def loop_drive(case: Case, system: System) -> DrivenRotor | tuple[()]:
    """The drive of a case as the time loop takes it."""
    drive, place = case.drive, system.rotation
    if drive is None or place is None:
        return ()
    points, unit = np.array([[0.0, 1.0], [drive.torque, drive.torque]]), 1.0
    over_time = drive.points is not None and drive.points.over == "time"
    if drive.points is not None:
        unit = 1.0 if over_time else TURN
        points = np.array([drive.points.at, drive.points.torque])
    highest = math.inf if drive.end is None else TURN * drive.end
    return DrivenRotor(
        place,
        case.polar_inertia,
        points * [[unit], [1.0]],
        over_time,
        drive.duration,
        (highest if drive.end is None else (1.0 - GOVERNED) * highest, highest),
        np.array([drive.load.constant, drive.load.linear, drive.load.square]),
        _thrust(case),
        _internal(case),
        drive.reaction,
        _weight(case) if drive.reaction else (0.0, 0.0),
        SLOW * TURN * max(case.speed.start, case.speed.end),
        np.zeros(NOW),
    )


def _thrust(case: Case) -> Array:
    """(2, k) speeds in rad/s with the torques in N m that a thrust bearing under the axial load has at rest there."""
    if not case.loads_a_collar:
        return np.zeros((2, 1))
    from frbcli.elements.collar import collar_of, rests_over_speed  # films on pads take a second to import

    collar = collar_of(case)
    rests = () if collar is None else rests_over_speed(collar)
    return np.array([[0.0, 0.0], *([rest.omega, rest.torque] for rest in rests)]).T.copy()


def _internal(case: Case) -> Array:
    """(2, m, m): see DrivenRotor."""
    damping = shaft_of(case).body().internal
    if damping is None:
        return np.zeros((2, 0, 0))
    turning, fixed, _ = LinearPart.turning(damping).at(1.0)
    return np.array([fixed, -turning])


def _weight(case: Case) -> tuple[float, float]:
    """N m: what the weight of the unbalance turns the rotor with, times the cosine and the sine of its angle."""
    body = shaft_of(case).body()
    if body.inertia is None:
        return 0.0, 0.0
    lifted = case.rotor.gravity * np.linalg.solve(body.mass, body.inertia[1])
    return float(lifted @ body.unbalance_cos), float(lifted @ body.unbalance_sin)


def begin_to_turn(case: Case, system: System, state: State) -> None:
    """Give a state at the start of a run the speed of its drive, and the acceleration but for the friction of films,
    which the first step of 1e-7 s finds."""
    drive, place = case.drive, system.rotation
    if drive is not None and place is not None:
        state.v[place] = TURN * drive.start
        state.a[place] = drive.net(0.0, TURN * drive.start)[0] / case.polar_inertia


def drive_signals(drive: DrivenRotor | tuple[()], times: Array, speeds: Array) -> dict[str, Array]:
    """Torque and power of the drive at times (k,) in s and speeds (k,) in rad/s; nothing without one."""
    if not drive:
        return {}
    torques = np.empty(len(times))
    driving_along(drive, times, speeds, torques)
    return {TORQUE: torques, POWER: torques * speeds}


def drive_units(system: System) -> dict[str, str]:
    """Names and units of the signals of a drive."""
    recorded = () if system.rotation is None else DRIVE_SIGNALS
    return {column.name: column.unit for column in (*recorded, *((FRICTION_SIGNAL,) if brakes(system) else ()))}


def brakes(system: System) -> bool:
    """Whether a run records the torque with which films and ports brake a rotor whose speed is free: films that follow
    its tilt are not noted."""
    if system.rotation is None or (system.names and system.films.stations > 1):
        return False
    return bool(system.names) or any(port.law.brakes for port in system.rotor.ports)


def friction_of_films(system: System, torques: Array) -> Array:
    """(k,) the torque with which all films brake a rotor; torques: (k, films) on the journals of one bearing each."""
    on_rotor = (system.bodies[:, 0] < 0) & (system.turning[:, SLIP, 0] > 0.0)
    return np.asarray(-torques @ (system.rotor.multiplicity * on_rotor))
