"""Limit cycles of a machine with heat: its temperatures are those at which the means over a period balance.

Temperatures are slow: over a period they stay, and the heat that the films dissipate on the mean leaves with the oil
and through the walls. So they follow from a motion y: T(y), by H(T, P(y, T), Q(y, T)) = 0. The equations of cycles are
those of the machine at T(y), and how they change with y has the part of T(y) in it. Whether a cycle is stable is asked
twice: of the motion while the temperatures stay, and of the temperatures while the motion follows them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.cycles.diagram import Walk, over_speed
from frbcli.cycles.method.balance import Balance, harmonics_of, packed, through, unpacked
from frbcli.cycles.method.continuation import Equations, Place, Unreachable
from frbcli.cycles.method.equilibria import (
    Equilibrium,
    at_rest,
    equations,
    equilibrium,
    place_between,
    resting_along,
)
from frbcli.cycles.method.floquet import TRIVIAL, Multipliers, multipliers
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.method.mesh_error import OtherMesh
from frbcli.cycles.parts.film_heat import FilmHeats, film_heats, heats_at
from frbcli.cycles.parts.linearised import state_space
from frbcli.cycles.parts.machine import Machine, make_machine, transfer
from frbcli.cycles.parts.other_meshes import other_films, why_no_error
from frbcli.cycles.unbalance.synchronous import driven_multipliers, synchronous_equations
from frbcli.equilibrium.warm_machine import WarmMachines
from frbcli.film.rectangles.end_flow import EndFlow
from frbcli.rotor.order import largest_first
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import heat_of
from frbcli.scene.machine.system import System
from frbcli.scene.planning.planned import Plan
from frbcli.thermal.model import HeatModel, rates, viscosities_at

# Of Newton's method; the longest of its steps and the last one, K: behind it 1e-11 K are left, for steps become shorter
# as their squares.
ITERATIONS, LONGEST, SETTLED = 50, 30.0, 1e-5
DIFFERENCE = 1e-4  # K
MOST_GROWTH = 50.0  # logarithm of a multiplier that counts as infinite


@dataclass(frozen=True)
class WarmMotion:
    """A motion with its temperatures. machine: at these; by_motion: (F, N) derivatives of the logarithms of its
    viscosities by the motion, nu / pace and Omega / pace; pushed: (F, n, c) of the loads by these logarithms;
    temperatures: (n,) K of all nodes. Of the nodes that are free: gain_by: (free, free) W/K that they gain by their
    temperatures while the motion stays, gain_by_motion: (free, N); slopes: (F, free) of the logarithms by them."""

    machine: Machine
    by_motion: Array
    pushed: Array
    temperatures: Array
    gain_by: Array
    gain_by_motion: Array
    slopes: Array


@dataclass(frozen=True)
class HeatOfMotions:
    """The heat of one machine in periodic motions. base: the machine as its films were made, with viscosities made (F,)
    Pa s; ends: the flows through the ends of its films; start: (n,) K from which temperatures are sought."""

    base: Machine
    model: HeatModel
    made: Array
    ends: tuple[EndFlow, ...]
    concentric: Array | None
    start: Array

    @property
    def free(self) -> NDArray[np.int64]:
        """The nodes whose temperatures are not given."""
        return np.flatnonzero(np.isfinite(self.model.capacity))

    def machine(self, temperatures: Array) -> Machine:
        """The machine at temperatures (n,) in K."""
        scales = viscosities_at(self.model, temperatures) / self.made
        return replace(self.base, scales=scales, temperatures=temperatures[: len(scales)].copy())

    def warm(self, motion: Complex, nu: float, omega: float, near: Array | None = None) -> WarmMotion:
        """A motion (H + 1, c) at its temperatures; frequency nu and rotor speed omega in rad/s; near: (n,) K from which
        they are sought. Raises Unreachable where a film boils, and OutOfGap."""

        def heats(machine: Machine) -> FilmHeats:
            return film_heats(machine, self.ends, motion, nu, omega)

        t, found, gain_by, by_heat, slopes = self._balanced(heats, near)
        by_motion = by_heat[0] @ found.power_by + by_heat[1] @ found.flow_by
        warmer = np.linalg.solve(gain_by, -by_motion)
        return WarmMotion(self.machine(t), slopes @ warmer, found.loads_by_scale, t, gain_by, by_motion, slopes)

    def machine_along(self, u: Array, v: Array, omega: float) -> Machine:
        """The machine at the temperatures that balance the means over moments of a motion, u and its rate (n, c), at
        the speed omega in rad/s. Raises Unreachable where a film boils, and OutOfGap."""
        return self.machine(self._balanced(lambda machine: heats_at(machine, self.ends, u, v, omega))[0])

    def _balanced(
        self, heats: Callable[[Machine], FilmHeats], near: Array | None = None
    ) -> tuple[Array, FilmHeats, Array, tuple[Array, Array], Array]:
        """Temperatures (n,) of a motion that stays; there what its films do, gain_by and slopes of WarmMotion, and the
        derivatives of what nodes gain by power and flow. heats: of the machine at some temperatures."""
        t, free = (self.start if near is None else near).copy(), self.free
        for _ in range(ITERATIONS):
            found = self._with_flow(heats(self.machine(t)), t)
            gain, by_heat, slopes = self._gain(t, found)
            by_own = by_heat[0] * found.power_by_scale + by_heat[1] * found.flow_by_scale
            gain_by = self._gain_by_temperature(t, found) + by_own @ slopes
            step = np.linalg.solve(gain_by, -gain[free])
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
            t[free] += step
            if not np.isfinite(t).all() or t[: len(slopes)].max() >= self.model.hottest:
                raise Unreachable
            if float(np.abs(step).max()) < SETTLED:
                return t, found, gain_by, by_heat, slopes
        raise Unreachable

    def _with_flow(self, found: FilmHeats, t: Array) -> FilmHeats:
        """What films do at temperatures t, with the flow of concentric ones where that is asked for."""
        if self.concentric is None:
            return found
        machine = self.machine(t)
        flow = self.concentric * machine.clearances**3 / (machine.scales * self.made)
        return replace(found, flow=flow, flow_by=np.zeros_like(found.flow_by), flow_by_scale=-flow)

    def _rates(self, t: Array, power: Array, flow: Array) -> Array:
        return rates(self.model, t, power, flow, self.base.clearances)

    def _gain(self, t: Array, found: FilmHeats) -> tuple[Array, tuple[Array, Array], Array]:
        """W that all nodes gain (n,); derivatives of that of the free ones by power and flow (free, F) of each film;
        slopes of WarmMotion."""
        count, free = len(found.power), self.free
        gain = self._rates(t, found.power, found.flow)
        by_power = np.column_stack([self._rates(t, found.power + one, found.flow) - gain for one in np.eye(count)])
        unit = 1e-6  # m^3/s: the gain is linear in the flows
        by_flow = np.column_stack([self._rates(t, found.power, found.flow + unit * one) for one in np.eye(count)])
        slopes = np.zeros((count, len(t)))
        _, a, c = self.model.viscosity
        slopes[:, :count] = np.diag(-a / (t[:count] + c) ** 2)
        return gain, (by_power[free], (by_flow - gain[:, None])[free] / unit), slopes[:, free]

    def _gain_by_temperature(self, t: Array, found: FilmHeats) -> Array:
        """(free, free) W/K while power and flow stay."""
        free = self.free
        ahead, behind = (
            np.column_stack([
                self._rates(t + sign * DIFFERENCE * one, found.power, found.flow) for one in np.eye(len(t))[free]
            ])
            for sign in (1.0, -1.0)
        )
        return np.asarray((ahead - behind)[free] / (2.0 * DIFFERENCE))


class WarmSpeed:
    """The course of a machine with heat over the speed of the rotor in rad/s, see SpeedCourse."""

    def __init__(self, heat: HeatOfMotions) -> None:
        self._heat = heat
        self._made: dict[float, Machine] = {}
        self._space = state_space(heat.base)
        passing = transfer(heat.base, np.zeros(1), heat.base.pace)
        self._through = passing.values[0].real

    @property
    def pace(self) -> float:
        """As SpeedCourse says."""
        return self._heat.base.pace

    def equations(self, y: Array) -> tuple[Array, Array]:
        """As SpeedCourse says."""
        warm = self._warm(y)
        residual, slope = equations(warm.machine)(y)
        pushed = -self._through @ warm.pushed[:, 0].T
        slope += pushed @ np.delete(warm.by_motion, -2, axis=1)  # at rest nothing has a frequency
        return residual, slope

    def _warm(self, y: Array) -> WarmMotion:
        return self._heat.warm(y[None, :-1].astype(complex), 0.0, float(y[-1] * self.pace))

    def equilibrium(self, place: Place) -> Equilibrium:
        """As SpeedCourse says."""
        machine = self._warm(place.y).machine
        found = equilibrium(machine, self._space, place)
        self._made[found.value] = machine
        return found

    def machine(self, value: float) -> Machine:
        """At the temperatures of a resting position that was found."""
        return self._made[value]

    def solved(self, low: Equilibrium, high: Equilibrium, value: float) -> Equilibrium:
        """As EquilibriumCourse says."""
        place = place_between(self, low, high, value)
        settled = replace(self.equilibrium(place), omega=value, value=value)
        self._made[value] = self._warm(place.y).machine
        return settled


class WarmFollower(Follower):
    """Follows branches of cycles with their temperatures."""

    def __init__(self, heat: HeatOfMotions, slowest: float, fastest: float, asked: Sequence[float] = ()) -> None:
        super().__init__(heat.base, slowest, fastest, asked)
        self._heat = heat

    def _warm(self, y: Array, near: Array | None = None) -> WarmMotion:
        pace = self.machine.pace
        return self._heat.warm(unpacked(y[:-2], self.machine.size), float(y[-2] * pace), float(y[-1] * pace), near)

    def machine_at(self, y: Array) -> Machine:
        """The machine at the temperatures of the cycle y."""
        return self._warm(y).machine

    def cold_equations(self, machine: Machine, reference: Complex) -> Equations:
        """Equations of the motions of a machine whose temperatures stay. reference: see Balance."""
        return Balance(machine, reference)

    def equations(self, place: Place) -> Equations:
        """Equations of the motions about a place, with temperatures that follow."""
        reference, near = self.reference(place), self._warm(place.y).temperatures

        def at(y: Array) -> tuple[Array, Array]:
            warm = self._warm(y, near)
            residual, slope = self.cold_equations(warm.machine, reference)(y)
            slope[:-1] += self._pushed(warm, y) @ warm.by_motion
            return residual, slope

        return at

    def _pushed(self, warm: WarmMotion, y: Array) -> Array:
        """(N - 2, F): the derivative of the balance of a motion by the logarithms of the viscosities."""
        machine, h = warm.machine, (len(y) - 2) // self.machine.size // 2
        nu, omega = float(y[-2] * machine.pace), float(y[-1] * machine.pace)
        passing = transfer(machine, nu * np.arange(h + 1.0), omega).values
        return np.column_stack([-packed(through(passing, harmonics_of(loads, h))) for loads in warm.pushed])

    def multipliers(self, place: Place, near: Multipliers | None = None, enough: float = TRIVIAL) -> Multipliers:
        """Multipliers of the motion while the temperatures stay, and of the temperatures while the motion follows."""
        y = place.y
        warm = self._warm(y)
        found = multipliers(warm.machine, self.space_at(y), y, near, max(TRIVIAL, enough))
        if not self.moves(y):
            return found
        slope = self.cold_equations(warm.machine, self.reference(place))(y)[1]
        return self._with_temperatures(found, warm, y, slope[:, :-1])

    def _with_temperatures(self, found: Multipliers, warm: WarmMotion, y: Array, slope: Array) -> Multipliers:
        """The multipliers of a motion y with those of its temperatures. slope: of the equations of the motion by its
        unknowns, the first of y, while the temperatures stay."""
        pushed = np.zeros((len(slope), len(warm.pushed)))
        pushed[: len(y) - 2] = self._pushed(warm, y)
        follows = np.linalg.solve(slope, -pushed @ warm.slopes)  # of the motion, by the temperatures
        capacity = self._heat.model.capacity[self._heat.free]
        by_motion = warm.gain_by_motion[:, : len(slope)]
        growth = np.linalg.eigvals((warm.gain_by + by_motion @ follows) / capacity[:, None])
        period = 2.0 * np.pi / (y[-2] * self.machine.pace)
        slow = np.exp(np.clip((growth * period).real, None, MOST_GROWTH) + 1j * (growth * period).imag)
        others = np.concatenate([found.others, slow])
        return replace(found, values=np.concatenate([found.values[:1], others[largest_first(others)]]))

    def at_its_heat(self, u: Array, v: Array, omega: float) -> Machine:
        """See HeatOfMotions.machine_along."""
        return self._heat.machine_along(u, v, omega)

    def driven(self, slowest: float, fastest: float) -> WarmSynchronous:
        """Follows the synchronous response of the same machine with its temperatures, between two speeds in rad/s."""
        return WarmSynchronous(self._heat, slowest, fastest)


class WarmSynchronous(WarmFollower):
    """Follows the synchronous response, see Synchronous, with its temperatures."""

    free = False

    def reference(self, place: Place) -> Complex:
        """The motion itself: the unbalance holds its phase."""
        return unpacked(place.y[:-2], self.machine.size)

    def cold_equations(self, machine: Machine, reference: Complex) -> Equations:
        """Equations of the synchronous motions of a machine whose temperatures stay."""
        return synchronous_equations(machine, reference)

    def multipliers(self, place: Place, _near: Multipliers | None = None, _enough: float = 0.0) -> Multipliers:
        """As Synchronous says, and those of the temperatures while the motion follows."""
        y = place.y
        warm = self._warm(y)
        found = driven_multipliers(warm.machine, self.space_at(y), y)
        slope = self.cold_equations(warm.machine, self.reference(place))(y)[1]
        return self._with_temperatures(found, warm, y, slope[:-1, :-2])


def warm_walk(
    case: Case, plan: Plan, system: System, slowest: float, fastest: float, asked: Sequence[float] = ()
) -> Walk:
    """What the diagram of a case with heat goes over, between two speeds in rad/s. Raises NotConverged without a
    resting position at the fastest one, and Unreachable."""
    assert case.heat is not None
    heat, machine = heat_of(case), make_machine(system, fastest)
    top = WarmMachines(case, plan, system).at(fastest)
    motions = HeatOfMotions(
        base=machine,
        model=heat.model,
        made=np.array([case.viscosity(place.geometry) for place in film_places(case)]),
        ends=system.films.end_flows,
        concentric=heat.concentric if case.heat.side_flow == "concentric" else None,
        start=top.steady.temperatures,
    )
    course = WarmSpeed(motions)
    resting = resting_along(course, at_rest(machine, top.resting), slowest, fastest)
    follower = WarmFollower(motions, slowest, fastest, asked)
    meshes = []
    for other in other_films(plan):
        films = other.system(case)
        its = replace(motions, base=make_machine(films, fastest), ends=films.films.end_flows)
        meshes.append(OtherMesh(WarmSpeed(its), WarmFollower(its, slowest, fastest), other.share))
    return over_speed(course, resting, follower, tuple(meshes), why_no_error(plan))
