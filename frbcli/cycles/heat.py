"""Limit cycles of a machine with heat: its temperatures are those at which the means over a period balance.

Temperatures are slow: over a period they stay, and the heat that the films dissipate on the mean leaves with the oil
and through the walls. So they follow from a motion y: T(y), by H(T, P(y, T), Q(y, T)) = 0. Cycles satisfy the equations
of the machine at T(y); their derivatives by y include the part by T(y). A cycle is stable if both the motion (at fixed
temperatures) and the temperatures (with the motion following) recover from a disturbance. """

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.cycles.method.balance import Multipliers, harmonics_of, packed, through
from frbcli.cycles.method.continuation import Equations, Unreachable
from frbcli.cycles.method.equilibria import EquationsOf, MachineCourse
from frbcli.cycles.method.film_heat import Ends, FilmHeats, film_heats, heats_at
from frbcli.cycles.method.machine import Machine, make_machine, transfer
from frbcli.equilibrium.resting import RestingPosition
from frbcli.equilibrium.static_machine import WarmMachines
from frbcli.rotor.loads import largest_first
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import heat_of
from frbcli.scene.machine.system import System
from frbcli.scene.planning.film_choice import Plan
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
    ends: Ends
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

        t, heat, gain_by, by_heat, slopes = self._balanced(heats, near)
        by_motion = by_heat[0] @ heat.power_by + by_heat[1] @ heat.flow_by
        warmer = np.linalg.solve(gain_by, -by_motion)
        return WarmMotion(self.machine(t), slopes @ warmer, heat.loads_by_scale, t, gain_by, by_motion, slopes)

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
            heat = self._with_flow(heats(self.machine(t)), t)
            gain, by_heat, slopes = self._gain(t, heat)
            by_own = by_heat[0] * heat.power_by_scale + by_heat[1] * heat.flow_by_scale
            gain_by = self._gain_by_temperature(t, heat) + by_own @ slopes
            step = np.linalg.solve(gain_by, -gain[free])
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
            t[free] += step
            if not np.isfinite(t).all() or t[: len(slopes)].max() >= self.model.hottest:
                raise Unreachable
            if float(np.abs(step).max()) < SETTLED:
                return t, heat, gain_by, by_heat, slopes
        raise Unreachable

    def _with_flow(self, heat: FilmHeats, t: Array) -> FilmHeats:
        """What films do at temperatures t, with the flow of concentric ones where that is asked for."""
        if self.concentric is None:
            return heat
        machine = self.machine(t)
        flow = self.concentric * machine.clearances**3 / (machine.scales * self.made)
        return replace(heat, flow=flow, flow_by=np.zeros_like(heat.flow_by), flow_by_scale=-flow)

    def _rates(self, t: Array, power: Array, flow: Array) -> Array:
        return rates(self.model, t, power, flow, self.base.clearances)

    def _gain(self, t: Array, heat: FilmHeats) -> tuple[Array, tuple[Array, Array], Array]:
        """W gained by all nodes (n,); derivatives of the gain of free nodes by power and flow (free, F) of each film;
        slopes of WarmMotion."""
        count, free = len(heat.power), self.free
        gain = self._rates(t, heat.power, heat.flow)
        by_power = np.column_stack([self._rates(t, heat.power + one, heat.flow) - gain for one in np.eye(count)])
        unit = 1e-6  # m^3/s: the gain is linear in the flows
        by_flow = np.column_stack([self._rates(t, heat.power, heat.flow + unit * one) for one in np.eye(count)])
        slopes = np.zeros((count, len(t)))
        _, a, c = self.model.viscosity
        slopes[:, :count] = np.diag(-a / (t[:count] + c) ** 2)
        return gain, (by_power[free], (by_flow - gain[:, None])[free] / unit), slopes[:, free]

    def _gain_by_temperature(self, t: Array, heat: FilmHeats) -> Array:
        """(free, free) W/K while power and flow stay."""
        free = self.free
        ahead, behind = (
            np.column_stack(
                [self._rates(t + sign * DIFFERENCE * one, heat.power, heat.flow) for one in np.eye(len(t))[free]]
            )
            for sign in (1.0, -1.0)
        )
        return np.asarray((ahead - behind)[free] / (2.0 * DIFFERENCE))


class WarmSpeed(MachineCourse):
    """The speed of the rotor of a machine with heat: its temperatures follow the motion."""

    def __init__(self, heat: HeatOfMotions) -> None:
        super().__init__(heat.base)
        self._heat = heat
        self._latest: tuple[Array, WarmMotion] | None = None
        self.at_its_heat = heat.machine_along

    def machine(self, y: Array) -> Machine:
        """The machine at the temperatures of a motion."""
        return self._warm(y).machine

    def equations(self, of: EquationsOf, near: Array | None = None) -> Equations:
        """See MachineCourse."""
        start = None if near is None else self._warm(near).temperatures

        def at(y: Array) -> tuple[Array, Array]:
            warm = self._warm(y, start)
            residual, slope = of(warm.machine)(y)
            pushed = self._pushed(warm, y)
            rests = len(y) == self.top.size + 1
            slope[: len(pushed)] += pushed @ (np.delete(warm.by_motion, -2, axis=1) if rests else warm.by_motion)
            return residual, slope

        return at

    def multipliers(self, fast: Multipliers, y: Array, slope: Callable[[Machine], Array]) -> Multipliers:
        """Multipliers of the motion while the temperatures stay, and of the temperatures while the motion follows."""
        warm = self._warm(y)
        by_own = slope(warm.machine)
        pushed = np.zeros((len(by_own), len(warm.pushed)))
        pushed[: len(y) - 2] = self._pushed(warm, y)
        follows = np.linalg.solve(by_own, -pushed @ warm.slopes)  # of the motion, by the temperatures
        capacity = self._heat.model.capacity[self._heat.free]
        by_motion = warm.gain_by_motion[:, : len(by_own)]
        growth = np.linalg.eigvals((warm.gain_by + by_motion @ follows) / capacity[:, None])
        period = 2.0 * np.pi / (y[-2] * self.top.pace)
        slow = np.exp(np.clip((growth * period).real, None, MOST_GROWTH) + 1j * (growth * period).imag)
        others = np.concatenate([fast.others, slow])
        return replace(fast, values=np.concatenate([fast.values[:1], others[largest_first(others)]]))

    def _warm(self, y: Array, near: Array | None = None) -> WarmMotion:
        """The motion or the static equilibrium y at its temperatures, see HeatOfMotions.warm; the latest one is
        kept."""
        if near is not None:
            return self._heat.warm(*self.harmonics(y), near)
        if self._latest is None or not np.array_equal(self._latest[0], y):
            self._latest = y.copy(), self._heat.warm(*self.harmonics(y))
        return self._latest[1]

    def _pushed(self, warm: WarmMotion, y: Array) -> Array:
        """(c (2 H + 1), F): the derivative of the balance of a motion by the logarithms of the viscosities."""
        motion, nu, omega = self.harmonics(y)
        h = len(motion) - 1
        passing = transfer(warm.machine, nu * np.arange(h + 1.0), omega).values
        return np.column_stack([-packed(through(passing, harmonics_of(loads, h))) for loads in warm.pushed])


def warm_courses(
    case: Case, plan: Plan, system: System, fastest: float
) -> tuple[Callable[[System], WarmSpeed], RestingPosition]:
    """What makes the course of a system of a case with heat, the machine itself or that on films of another mesh, and
    the static equilibrium at the fastest speed in rad/s. Raises NotConverged without one."""
    assert case.heat is not None
    heat = heat_of(case)
    made = np.array([case.viscosity(place.geometry) for place in film_places(case)])
    concentric = heat.concentric if case.heat.side_flow == "concentric" else None
    top = WarmMachines(case, plan, system).at(fastest)

    def course(its: System) -> WarmSpeed:
        base = make_machine(its, fastest)
        ends = its.films.smooth_ends(base.films)
        return WarmSpeed(HeatOfMotions(base, heat.model, made, ends, concentric, top.steady.temperatures))

    return course, top.resting
