"""The heat of a run: what the time loop carries along, its signals, and its balance.

The axis of a run: the motion along it, and how near its collar comes to its pads.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.case.over_time import first
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.kinds.contract import Films
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.results.store import Run
from frbcli.rotor.loads import SpeedProfile
from frbcli.runs.inputs import FilmNumbers, signal_of
from frbcli.runs.interruption import WrongCheckpoint, array, number_of
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import Heat, heat_of, warm_system
from frbcli.scene.machine.rotor import collar_tilt
from frbcli.scene.machine.system import System
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.film_choice import Plan
from frbcli.solve.heat import COLUMNS, NARROWEST, NO_HEAT, LumpedHeat, NoHeat, columns_of
from frbcli.thermal.exchange import (
    BOOKS,
    CARRIED,
    CHANGES,
    CLEARANCE,
    DISSIPATED,
    DRAG,
    FILM_ROWS,
    FLOW,
    GIVEN,
    HOT,
    IN_FILMS,
    POWER,
    REFERENCE,
    SHARE,
    SHARE_OF_SUPPLY,
    VISCOSITY,
    arrays_of,
)
from frbcli.thermal.model import clearances_at, closed_gap, viscosities_at

if TYPE_CHECKING:
    from frbcli.elements.collar import Collar

QUANTITIES = ("temperature_{}_K", "viscosity_{}_Pa_s", "clearance_{}_m", "power_{}_W", "flow_{}_m3_s")
AT_END = [POWER, FLOW]  # what the films did at the end of a step, from which the signals go on
UNITS = ("K", "Pa*s", "m", "W", "m^3/s")


class RunHeat:
    """The heat of one run of a case; without heat all of it is empty. start: the machine at the temperatures that a run
    begins with; films: those that the loop may change, None without heat. Raises NotConverged where these temperatures
    close a gap."""

    def __init__(self, case: Case, plan: Plan, system: System) -> None:
        self._names, self._units = system.names, tuple(heat_units(case, system))
        self._heat: Heat | None = None
        self._loop: LumpedHeat | None = None
        self._rows = np.zeros((0, 0))
        self.films: Films | None = None
        self.start = system
        if case.heat is None:
            return
        self._heat = heat_of(case, first)
        self._loop, self.films = _lumped(case, system, self._heat), system.films.changeable()
        model, start, still = self._heat.model, self._heat.start, np.zeros(1 + system.ring_count)
        clearances = clearances_at(model, start, still)
        for name, clearance, reference in zip(system.names, clearances, model.reference, strict=True):
            if clearance <= NARROWEST * reference:
                raise NotConverged(closed_gap(name, "at the temperatures that the run begins with"))
        self.start = warm_system(case, plan, system, viscosities_at(model, start), clearances)

    def take_up(self, case: Case, system: System) -> None:
        """Go on with another machine, whose clearances have changed: all temperatures and the books stay the same."""
        if self._loop is None:
            return
        before, self._heat = self._loop, heat_of(case, first)
        loop = _lumped(case, system, self._heat)._replace(state=before.state, last=before.last)
        loop.now[AT_END] = before.now[AT_END]
        self._loop, self.films = loop, system.films.changeable()

    def warm(self, case: Case, plan: Plan, system: System) -> System:
        """The machine that was taken up, at the temperatures of now; the same without heat."""
        if self._heat is None or self._loop is None:
            return system
        state, model = self._loop.state, self._heat.model
        temperatures, speeds = state[-len(model.capacity) :], state[BOOKS : -len(model.capacity)]
        clearances = np.maximum(clearances_at(model, temperatures, speeds), NARROWEST * model.reference)
        return warm_system(case, plan, system, viscosities_at(model, temperatures), clearances)

    @property
    def kind(self) -> LumpedHeat | NoHeat:
        """The data for the time loop."""
        return NO_HEAT if self._loop is None else self._loop

    def buffer(self, rows: int) -> Array:
        """(rows, columns) what the loop writes of it."""
        self._rows = np.zeros((rows, 0 if self._loop is None else columns_of(self._loop)))
        return self._rows

    def signals(self, rows: int) -> dict[str, Array]:
        """The signals of heat in the rows that the loop has written."""
        return {name: self._rows[:rows, column].copy() for column, name in enumerate(self._units)}

    def clearances(self, rows: int) -> list[Array]:
        """(rows,) m of each film in the rows that the loop has written; none without heat."""
        if self._loop is None:
            return []
        return [self._rows[:rows, COLUMNS * film + 2].copy() for film in range(len(self._names))]

    def numbers(self, rows: int) -> FilmNumbers | None:
        """The numbers of the films that heat has changed, in the rows that the loop has written; None without heat."""
        if self._loop is None or self._heat is None:
            return None
        viscosities, clearances = (self._rows[:rows, each : COLUMNS * len(self._names) : COLUMNS] for each in (1, 2))
        made = self._loop.model.films
        thicker, narrower = viscosities / made[VISCOSITY], made[REFERENCE] / clearances
        return FilmNumbers(clearances.copy(), made[DRAG] * thicker * narrower, thicker * narrower**2)

    def snapshot(self) -> dict[str, Array]:
        """The arrays of a checkpoint."""
        if self._loop is None:
            return {}
        state, last, now = self._loop.state.copy(), self._loop.last.copy(), self._loop.now[AT_END].copy()
        return {"heat": state, "heat_step": last, "heat_films": now}

    def restore(self, checkpoint: Mapping[str, Array]) -> None:
        """Take up what a checkpoint holds. Raises WrongCheckpoint if it is not one of this run."""
        if self._loop is not None and self._heat is not None:
            state = array(checkpoint, "heat", self._loop.state.shape)
            warm = np.all(state[-len(self._heat.model.capacity) :] > 0.0)
            if not warm or state[HOT] not in range(len(self._names) + 1):
                raise WrongCheckpoint("heat holds no temperatures of this machine")
            self._loop.state[:] = state
            self._loop.last[:] = array(checkpoint, "heat_step", self._loop.last.shape)
            self._loop.now[AT_END] = array(checkpoint, "heat_films", self._loop.now[AT_END].shape)

    def passed(self) -> dict[str, float]:
        """Heat in J so far, of one bearing each: dissipated by the films, carried away by the oil, taken by places of
        given temperature, kept; empty without heat."""
        if self._heat is None or self._loop is None:
            return {}
        state, model = self._loop.state, self._heat.model
        films, n = len(self._names), len(model.capacity)
        warmer = state[-n:] - self._heat.start
        bodies = films + np.flatnonzero(np.isfinite(model.capacity[films:]))
        kept = float(model.capacity[bodies] @ warmer[bodies])
        return {
            "heat_dissipated_J": float(state[DISSIPATED]),
            "heat_carried_J": float(state[CARRIED]),
            "heat_into_walls_J": float(state[GIVEN]),
            "heat_kept_J": kept + float(state[IN_FILMS]),
        }

    def balance(self) -> dict[str, float | None]:
        """The dissipated heat that is unaccounted for, relative; empty without heat."""
        energies = self.passed()
        if not energies:
            return {}
        whole, *parts = energies.values()
        return {"heat_balance_relative": abs(whole - sum(parts)) / abs(whole) if whole != 0.0 else None}


def heat_units(case: Case, system: System) -> dict[str, str]:
    """The signals of heat of a run and their units; none without heat."""
    if case.heat is None:
        return {}
    nodes = (node.replace(" ", "_") for node in heat_of(case, first).nodes[len(system.names) :])
    units = {signal_of(form, name): unit for name in system.names for form, unit in zip(QUANTITIES, UNITS, strict=True)}
    return units | {signal_of(QUANTITIES[0], node): "K" for node in nodes}


def hot_film(run: Run) -> str:
    """The name of the film that became too hot in a run, or whose gap has closed; "" if there is none."""
    begin, end = QUANTITIES[-1].split("{}")
    flows = filter(_is_flow, run.signals)
    names = [name.removeprefix(begin.rstrip("_")).removesuffix(end.lstrip("_")) for name in flows]
    number = int(number_of(run, "heat", HOT) or 0)
    return names[number - 1].strip("_") or "film" if 0 < number <= len(names) else ""


def _is_flow(name: str) -> bool:
    begin, end = QUANTITIES[-1].split("{}")
    return name.startswith(begin.rstrip("_")) and name.endswith(end)


def _lumped(case: Case, system: System, heat: Heat) -> LumpedHeat:
    model, places = heat.model, film_places(case)
    count, n, bodies = len(places), len(heat.start), 1 + system.ring_count
    state = np.zeros(BOOKS + bodies + n)
    state[BOOKS + bodies :] = heat.start
    now = np.zeros((FILM_ROWS, count))
    now[SHARE], now[SHARE_OF_SUPPLY], now[CLEARANCE] = 1.0, 1.0, system.clearances
    viscosity = np.array([case.viscosity(place.geometry) for place in places])
    return LumpedHeat(
        model=arrays_of(model, viscosity, np.array(system.drags), heat.concentric, heat.by_formula),
        ends=system.films.heat_ends(),
        state=state,
        last=np.zeros(CHANGES + n),
        ahead=np.zeros_like(state),
        now=now,
        gain=np.zeros(n),
    )


SLOWER = 1e-3  # share of a speed by which the slowest one that is known may be missed
POSITION, THICKNESS, LOSS = (column.name for column in AXIAL_SIGNALS)


@dataclass(frozen=True)
class RunAxis:
    """The axis of a run under an axial load. tilt: (2, n) of the collar against its pads, None where it does not tilt;
    step: of the output in s; course: (3, k) AxialMotion.at all output times, taken at once: the round-off of some of
    them would depend on how many are asked for, and a resumed run would differ. speeds: (k,) rad/s, None but where the
    speed is free: course is that of a collar which rests at each of them."""

    collar: Collar
    tilt: Array | None
    step: float
    course: Array
    speeds: Array | None = None

    @classmethod
    def of(cls, case: Case, profile: SpeedProfile, step: float) -> RunAxis | None:
        """The axis of a run of a case with an output step in s, None without an axial load. Raises as axial_motion."""
        from frbcli.elements.collar import axial_motion, collar_of  # films on pads take a second to import

        collar = collar_of(case)
        if collar is None:
            return None
        if case.drive is not None:
            speeds, *course = _collar_at_rest(collar)
            return cls(collar, collar_tilt(case), step, np.array(course), speeds)
        motion = axial_motion(case, profile, shaft_of(case).mass)
        assert motion is not None
        times: Array = step * np.arange(int(profile.end / step) + 2, dtype=np.float64)
        return cls(collar, collar_tilt(case), step, np.array(motion.at(times)))

    def signals(self, times: Array, speeds: Array, q: Array) -> dict[str, Array]:
        """The signals at k output times in s, with speeds in rad/s and displacements q (k, n) of the machine."""
        if self.speeds is None:
            position, gap, loss = self.course[:, np.rint(times / self.step).astype(np.int64)]
        else:
            position, gap, loss = (np.interp(speeds, self.speeds, each) for each in self.course)
            gap = np.where(speeds < self.speeds[0] * (1.0 - SLOWER), self.collar.thin, gap)
        if self.tilt is not None:
            gap = gap - self.collar.bearing.outer_radius * np.linalg.norm(q @ self.tilt.T, axis=1)
        return {POSITION: position, THICKNESS: gap, LOSS: loss}

    def touch(self, signals: Mapping[str, Array]) -> int | None:
        """The first sample at which the collar touches its pads, None where it does not."""
        touching = np.flatnonzero(signals[THICKNESS] <= self.collar.thin)
        return int(touching[0]) if len(touching) else None


def _collar_at_rest(collar: Collar) -> Array:
    """(4, k) speeds, positions, gaps and losses of a collar at rest: down to standstill where the load ends there."""
    from frbcli.elements.collar import rests_over_speed

    rests = rests_over_speed(collar)
    rows = [(rest.omega, collar.position(rest), rest.gap, rest.torque * rest.omega) for rest in rests]
    if not collar.load_at(0.0):
        rows.insert(0, (0.0, *rows[0][1:3], 0.0))
    return np.array(rows).T
