"""The machine at a constant speed with its heat: temperatures, static equilibrium and ring speeds together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import SEARCH, RestingPosition, foreseen, resting_position, weighted, weights_at
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import HEAT
from frbcli.scene.machine.heat import Heat, heat_of, warm_system
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.planning.planned import Plan
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
        self._concentric = case.heat is not None and case.heat.side_flow == "concentric"

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
            if self._concentric:
                flow = self._heat.concentric * clearances**3 / viscosities
            return FilmHeat(power, flow, bodies)

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
