"""Limit cycles of a machine with heat: its temperatures are those at which the means over a period balance.

Temperatures are slow: over a period they stay, and the heat that the films dissipate on the mean leaves with the oil
and through the walls. So they follow from a motion y: T(y), by H(T, P(y, T), Q(y, T)) = 0. Cycles satisfy the equations
of the machine at T(y); their derivatives by y include the part by T(y). A cycle is stable if both the motion (at fixed
temperatures) and the temperatures (with the motion following) recover from a disturbance.

What the films dissipate and let out over a periodic motion, on the mean, is as in docs/heat.md

    P = K slip^2 + (e x F) (omega_J + omega_S) / 2 - F . e',      Q = C q(d, w),      w = d' - (omega/2) J d.

A film of s times the viscosity has the force of s times the velocities, and s times K. """

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.cycles.method.balance import Multipliers, harmonics_of, loads_along, motion_along, packed, through
from frbcli.cycles.method.continuation import Equations, Unreachable
from frbcli.cycles.method.equilibria import EquationsOf, MachineCourse
from frbcli.cycles.method.machine import Loads, Machine, film_loads, make_machine, transfer
from frbcli.equilibrium.resting import RestingPosition
from frbcli.equilibrium.static_machine import WarmMachines
from frbcli.film.cells.mean_film import MeanEndFlow, mean_end_flows
from frbcli.film.kinds.contract import drag_factor
from frbcli.film.rectangles.end_flow import EndFlow, end_flows
from frbcli.rotor.loads import largest_first
from frbcli.scene.films import film_places
from frbcli.scene.machine.heat import Heat, heat_of
from frbcli.scene.machine.system import System
from frbcli.scene.planning.film_choice import Plan
from frbcli.thermal.model import rates, viscosities_at

Ends = tuple[EndFlow | MeanEndFlow, ...]
NUDGE = 1e-6  # of displacements over the clearance, and of velocities over the largest one
# Of Newton's method; the longest of its steps and the last one, K: behind it 1e-11 K are left, for steps become shorter
# as their squares.
ITERATIONS, LONGEST, SETTLED = 50, 30.0, 1e-5
DIFFERENCE = 1e-4  # K
MOST_GROWTH = 50.0  # logarithm of a multiplier that counts as infinite


@dataclass(frozen=True)
class FilmHeats:
    """power (F,) W, flow (F,) m^3/s: means over a period; power_by, flow_by: (F, N) derivatives by the motion as a real
    vector y of balance.py; power_by_scale, flow_by_scale: (F,) by the logarithm of the viscosity of each film;
    loads_by_scale: (F, n, c) likewise of the loads at n moments, see Loads."""

    power: Array
    flow: Array
    power_by: Array
    flow_by: Array
    power_by_scale: Array
    flow_by_scale: Array
    loads_by_scale: Array


@dataclass(frozen=True)
class _Moments:
    """One film at n moments: displacement and rate over the clearance (n, 2), omega_J + omega_S and omega_J - omega_S
    in rad/s (n,); force (n, 2) N and its derivatives by d and v (n, 2, 2), and by the total (n, 2)."""

    d: Array
    v: Array
    total: Array
    slip: Array
    force: Array
    by_d: Array
    by_v: Array
    by_total: Array


@dataclass(frozen=True)
class _Rate:
    """A power or a flow at n moments, with its derivatives by d, v (n, 2), total and slip (n,), and by the logarithm of
    the viscosity (n,)."""

    value: Array
    by_d: Array
    by_v: Array
    by_total: Array
    by_slip: Array
    by_scale: Array


def film_heats(machine: Machine, ends: Ends, motion: Complex, nu: float, omega: float) -> FilmHeats:
    """Means over the period of a motion (H + 1, c) with the frequency nu, rotor speed omega, in rad/s. ends: the flows
    through the ends of the films. Raises OutOfGap."""
    loads, rate = loads_along(replace(machine, cones=()), motion, nu, omega)
    u, _ = motion_along(motion, len(rate))
    powers, flows, by_scale = _rates(machine, ends, loads, (u, nu * rate), omega)
    h = len(motion) - 1
    return replace(
        _means(powers, flows, by_scale),
        power_by=np.array([_by_motion(machine, f, each, rate, nu, h) for f, each in enumerate(powers)]),
        flow_by=np.array([_by_motion(machine, f, each, rate, nu, h) for f, each in enumerate(flows)]),
    )


def heats_at(machine: Machine, ends: Ends, u: Array, v: Array, omega: float) -> FilmHeats:
    """Means over n moments of a motion that is given: u, v (n, c), see film_loads; no derivative by it, N = 0. Raises
    OutOfGap."""
    loads = film_loads(replace(machine, cones=()), u, v, omega)
    powers, flows, by_scale = _rates(machine, ends, loads, (u, v), omega)
    return _means(powers, flows, by_scale)


def _means(powers: list[_Rate], flows: list[_Rate], loads_by_scale: Array) -> FilmHeats:
    """Means over moments, without derivatives by a motion."""
    return FilmHeats(
        power=np.array([float(each.value.mean()) for each in powers]),
        flow=np.array([float(each.value.mean()) for each in flows]),
        power_by=np.zeros((len(powers), 0)),
        flow_by=np.zeros((len(flows), 0)),
        power_by_scale=np.array([float(each.by_scale.mean()) for each in powers]),
        flow_by_scale=np.array([float(each.by_scale.mean()) for each in flows]),
        loads_by_scale=loads_by_scale,
    )


def _rates(
    machine: Machine, ends: Ends, loads: Loads, motion: tuple[Array, Array], omega: float
) -> tuple[list[_Rate], list[_Rate], Array]:
    """Power and flow of each film at n moments of a motion, u and its rate (n, c), and loads_by_scale of FilmHeats."""
    u, v = motion
    speeds = np.column_stack([np.full(len(u), omega), machine.pace * u[:, 2 * machine.film_count :]])
    powers, flows = [], []
    by_scale = np.zeros((machine.film_count, *loads.values.shape))
    for f, end in enumerate(ends):
        at = _moments(machine, f, loads, u, v, speeds)
        powers.append(_power(machine, f, at))
        flows.append(_flow(machine, f, end, at))
        by_scale[f] = _loads_by_scale(machine, f, at)
    return powers, flows, by_scale


def _moments(machine: Machine, f: int, loads: Loads, u: Array, v: Array, speeds: Array) -> _Moments:
    own, shares = slice(2 * f, 2 * f + 2), machine.turning[f]
    turns = int(np.argmax(np.abs(shares[0])))  # the rotor, or a ring, by whose speed the total changes
    by_speed = loads.by_speed[:, own] if turns == 0 else loads.by_u[:, own, 2 * machine.film_count + turns - 1]
    share = float(shares[0, turns]) or 1.0  # nothing turns in the film of a damper, whose derivative is 0
    by_total = by_speed / (share * (1.0 if turns == 0 else machine.pace))
    return _Moments(
        d=u[:, own],
        v=v[:, own],
        total=speeds @ shares[0],
        slip=speeds @ shares[1],
        force=loads.values[:, own],
        by_d=loads.by_u[:, own, own],
        by_v=loads.by_v[:, own, own],
        by_total=by_total,
    )


def _force_by_scale(at: _Moments) -> Array:
    """(n, 2): the derivative of the force by the logarithm of the viscosity."""
    return np.asarray(np.einsum("nij,nj->ni", at.by_v, at.v) + at.by_total * at.total[:, None])


def _moment_of(d: Array, force: Array) -> Array:
    """d x F of displacements (n, 2) and forces (n, 2) or their derivatives (n, 2, k)."""
    x, y = (d[:, i].reshape(-1, *[1] * (force.ndim - 2)) for i in (0, 1))
    return np.asarray(x * force[:, 1] - y * force[:, 0])


def _power(machine: Machine, f: int, at: _Moments) -> _Rate:
    c = machine.clearances[f]
    factor, factor_by = drag_factor(at.d)
    resistance, half = machine.drags[f] * machine.scales[f] * factor, 0.5 * c * at.total

    def pushed(force: Array) -> Array:
        return np.asarray(half * _moment_of(at.d, force) - c * np.sum(force * at.v, axis=1))

    def pushed_by(force_by: Array) -> Array:
        return np.asarray(half[:, None] * _moment_of(at.d, force_by) - c * np.einsum("ni,nij->nj", at.v, force_by))

    moment = _moment_of(at.d, at.force)
    turned = np.column_stack([at.force[:, 1], -at.force[:, 0]])
    by_d = (machine.drags[f] * machine.scales[f] * at.slip**2)[:, None] * factor_by + half[:, None] * turned
    return _Rate(
        value=resistance * at.slip**2 + pushed(at.force),
        by_d=by_d + pushed_by(at.by_d),
        by_v=pushed_by(at.by_v) - c * at.force,
        by_total=0.5 * c * moment + pushed(at.by_total),
        by_slip=2.0 * resistance * at.slip,
        by_scale=resistance * at.slip**2 + pushed(_force_by_scale(at)),
    )


def _flow(machine: Machine, f: int, end: EndFlow | MeanEndFlow, at: _Moments) -> _Rate:
    """Flow and its derivatives by central differences: the flow of a table has none of its own."""
    c, scale, half = machine.clearances[f], float(machine.scales[f]), 0.5 * at.total[:, None]
    across = np.column_stack([at.d[:, 1], -at.d[:, 0]])
    w = at.v + half * across
    pace = NUDGE * max(float(np.abs(w).max()), 1.0)
    motions, steps = np.hstack([at.d, w]), (NUDGE, NUDGE, pace, pace)

    def flows(moved: Array, thicker: float = 1.0) -> Array:
        if isinstance(end, MeanEndFlow):
            return np.asarray(c * mean_end_flows(end, moved, at.total, thicker * scale))
        return np.asarray(c * end_flows(end, moved, thicker * scale))

    slopes = [
        (flows(motions + step * np.eye(4)[i]) - flows(motions - step * np.eye(4)[i])) / (2.0 * step)
        for i, step in enumerate(steps)
    ]
    by_d, by_w = np.column_stack(slopes[:2]), np.column_stack(slopes[2:])
    thicker, thinner = (flows(motions, 1.0 + sign * NUDGE) for sign in (1.0, -1.0))
    return _Rate(
        value=flows(motions),
        by_d=by_d + half * np.column_stack([-by_w[:, 1], by_w[:, 0]]),
        by_v=by_w,
        by_total=0.5 * np.sum(by_w * across, axis=1),
        by_slip=np.zeros(len(w)),
        by_scale=(thicker - thinner) / (2.0 * NUDGE),
    )


def _loads_by_scale(machine: Machine, f: int, at: _Moments) -> Array:
    """(n, c): the derivative of all loads by the logarithm of the viscosity of one film, see film_loads."""
    by_scale, own = np.zeros((len(at.d), machine.size)), slice(2 * f, 2 * f + 2)
    by_scale[:, own] = _force_by_scale(at)
    factor, _ = drag_factor(at.d)
    couette = -machine.drags[f] * machine.scales[f] * factor * at.slip
    moment = -0.5 * machine.moment * machine.clearances[f] * _moment_of(at.d, by_scale[:, own])
    for body, sign in zip(machine.bodies[f].tolist(), (1.0, -1.0), strict=True):
        if body >= 0:
            scale = 1.0 / (machine.held[body] * machine.pace)
            by_scale[:, 2 * machine.film_count + body] += scale * (sign * couette + moment)
    return by_scale


def _by_motion(machine: Machine, f: int, rate: _Rate, motion_rate: Array, nu: float, h: int) -> Array:
    """(N,): the derivative of a mean by the real vector of the motion, by nu / pace and by Omega / pace.

    motion_rate: (n, c) du/dtau."""
    own, n, c = slice(2 * f, 2 * f + 2), len(motion_rate), machine.size
    shares = machine.turning[f]
    by_u, by_v = np.zeros((n, c)), np.zeros((n, c))
    by_u[:, own], by_v[:, own] = rate.by_d, rate.by_v
    by_speeds = rate.by_total[:, None] * shares[0] + rate.by_slip[:, None] * shares[1]
    by_u[:, 2 * machine.film_count :] = machine.pace * by_speeds[:, 1:]
    a, b = (np.fft.rfft(each, axis=0)[: h + 1] / n for each in (by_u, by_v))
    k = np.arange(1, h + 1)[:, None]
    real = 2.0 * (a[1:].real + k * nu * b[1:].imag)
    imaginary = 2.0 * (a[1:].imag - k * nu * b[1:].real)
    parts = np.stack([real, imaginary], axis=1).ravel()
    by_nu = machine.pace * float(np.sum(by_v * motion_rate, axis=1).mean())
    return np.concatenate([a[0].real, parts, [by_nu, machine.pace * float(by_speeds[:, 0].mean())]])


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
    heat: Heat
    made: Array
    ends: Ends
    start: Array

    @property
    def free(self) -> NDArray[np.int64]:
        """The nodes whose temperatures are not given."""
        return np.flatnonzero(np.isfinite(self.heat.model.capacity))

    def machine(self, temperatures: Array) -> Machine:
        """The machine at temperatures (n,) in K."""
        scales = viscosities_at(self.heat.model, temperatures) / self.made
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
            if not np.isfinite(t).all() or t[: len(slopes)].max() >= self.heat.model.hottest:
                raise Unreachable
            if float(np.abs(step).max()) < SETTLED:
                return t, heat, gain_by, by_heat, slopes
        raise Unreachable

    def _with_flow(self, heat: FilmHeats, t: Array) -> FilmHeats:
        """What films do at temperatures t, with the flow of concentric ones where that is asked for."""
        if not self.heat.by_formula:
            return heat
        machine = self.machine(t)
        flow = self.heat.side_flow(heat.flow, machine.scales * self.made, machine.clearances)
        return replace(heat, flow=flow, flow_by=np.zeros_like(heat.flow_by), flow_by_scale=-flow)

    def _rates(self, t: Array, power: Array, flow: Array) -> Array:
        return rates(self.heat.model, t, power, flow, self.base.clearances)

    def _gain(self, t: Array, heat: FilmHeats) -> tuple[Array, tuple[Array, Array], Array]:
        """W gained by all nodes (n,); derivatives of the gain of free nodes by power and flow (free, F) of each film;
        slopes of WarmMotion."""
        count, free = len(heat.power), self.free
        gain = self._rates(t, heat.power, heat.flow)
        by_power = np.column_stack([self._rates(t, heat.power + one, heat.flow) - gain for one in np.eye(count)])
        unit = 1e-6  # m^3/s: the gain is linear in the flows
        by_flow = np.column_stack([self._rates(t, heat.power, heat.flow + unit * one) for one in np.eye(count)])
        slopes = np.zeros((count, len(t)))
        _, a, c = self.heat.model.viscosity
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
        capacity = self._heat.heat.model.capacity[self._heat.free]
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
    top = WarmMachines(case, plan, system).at(fastest)

    def course(its: System) -> WarmSpeed:
        base = make_machine(its, fastest)
        ends = its.films.smooth_ends(base.films)
        return WarmSpeed(HeatOfMotions(base, heat, made, ends, top.steady.temperatures))

    return course, top.resting
