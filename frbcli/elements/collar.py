"""A collar under an axial load: the gap at which its films carry the load, and what they then do to its motions.

With the load F towards the pads of one side and the other side, where there are pads, at the end play less the gap,

    W(h) - W(e - h) = F.

Stiffness, damping and torque of both sides add up: a displacement changes both gaps by opposite amounts, and the forces
are opposed.

The temperature of the oil on the pads of a thrust bearing: what the film dissipates leaves with the oil and through
collar and pads, as in the films of journals (docs/heat.md).

Grooves are fed with oil of the supply temperature, as much as leaves at the inner and outer radius; what passes the
trailing edges goes on to the next pads.

The motion of a rotor along its axis in a run: m p'' = F - W(h, h'), with the table of the films of its collar.

Pads all around do not couple it to the lateral motion, so that it is known before a run begins. Towards pads that stand
on the right the gap is h = e/2 - p, towards those on the left h = e/2 + p, or - p and p where there are no others; the
films are full, W = eta (omega w(h) - c(h) h'), with the viscosity that they have at rest at the speed of the moment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from frbcli.arrays import Array
from frbcli.case.elements import AnyLoad, LoadAtSpeed, ThrustBearing
from frbcli.case.oil import Oil, Thermal, WallNode
from frbcli.case.over_time import OverTime, largest
from frbcli.case.schema import Case
from frbcli.errors import Fault, NotConverged
from frbcli.film.pad_geometry import COARSE, SOMMERFELD, Pad
from frbcli.film.pads import GapTable, PadOil, RunnerMotion, ScaledPads, gap_table, pad_film, pad_mesh
from frbcli.rotor.loads import LinearPart, SpeedProfile
from frbcli.thermal.model import FROM_SUPPLY, OIL_AT, FilmHeat, HeatModel, steady_heat
from frbcli.units import display

if TYPE_CHECKING:
    from scipy.integrate import OdeSolution

NAME = "thrust bearing"


LossAndFlow = Callable[[float], tuple[float, float]]  # W and m^3/s of all pads of a side, by the viscosity in Pa s


@dataclass(frozen=True)
class PadHeat:
    """The heat of a case, as far as it concerns thrust bearings."""

    oil: Oil
    thermal: Thermal

    def warm(self, film: LossAndFlow, omega: float, gap: float, inverse_gap: float) -> tuple[float, float]:
        """The viscosity in Pa s and the temperature in K at which the heat of a film balances.

        omega: rad/s; gap: over the lands in m; inverse_gap: integral of 1/h over the pads of a side, m. Raises
        NotConverged if the film becomes hotter than thermal.hottest_film.
        """

        def solve(viscosities: np.ndarray, _: np.ndarray) -> FilmHeat:
            loss, flow = film(float(viscosities[0]))
            return FilmHeat(np.array([loss]), np.array([flow]), np.array([omega]))

        model, start = self._model(gap, inverse_gap)
        steady = steady_heat(model, (NAME,), solve, start, np.array([omega]))
        return float(steady.viscosities[0]), float(steady.temperatures[0])

    def _model(self, gap: float, inverse_gap: float) -> tuple[HeatModel, np.ndarray]:
        """Nodes, the film first, and the temperatures in K to begin from."""
        oil, thermal = self.oil, self.thermal
        transfer = thermal.nusselt * oil.thermal_conductivity * inverse_gap
        nodes = [(1.0, thermal.start_temperature or largest(thermal.supply_temperature))]  # heat capacity, temperature
        links: list[tuple[int, int, float]] = []
        for wall in (thermal.shaft, thermal.housing):
            film = 0, len(nodes), transfer
            match wall:
                case str():  # adiabatic
                    continue
                case WallNode():
                    nodes += [(wall.capacity, largest(wall.temperature)), (math.inf, largest(wall.temperature))]
                    links += [film, (len(nodes) - 2, len(nodes) - 1, wall.conductance)]
                case _:
                    nodes.append((math.inf, largest(wall)))
                    links.append(film)
        first, last = (oil.density * oil.heat_capacity_at(at) for at in OIL_AT)
        slope, law = (last - first) / (OIL_AT[1] - OIL_AT[0]), oil.law
        assert law is not None  # the checks of a case see to it
        model = HeatModel(
            capacity=np.array([capacity for capacity, _ in nodes]),
            links=np.array([link[:2] for link in links], dtype=np.int64).reshape(-1, 2),
            conductance=np.array([link[2] for link in links]),
            of_film=np.full(len(links), -1),
            supply=np.array([largest(thermal.supply_temperature)]),
            inlet=np.array([FROM_SUPPLY]),
            mixing=thermal.mixing,
            oil_heat=np.array([first - slope * OIL_AT[0], slope]),
            viscosity=np.array([law.eta_0, law.a, law.c]),
            clearance=np.array([gap]),
            reference=np.array([gap]),
            expansion=np.zeros((1, len(nodes))),
            growth=np.zeros((1, 1)),
            hottest=thermal.hottest_film,
        )
        return model, np.array([temperature for _, temperature in nodes])


BOTH, LEFT, RIGHT = "both", "left", "right"
LEAST_GAP = 1e-6  # m, of a load that is carried: thinner films lie below the roughness of surfaces
WIDEST = 100.0  # gap over the taper
CLOSER = 1.25  # than a gap whose load is too small
# Of coefficients over the speed: slowest and fastest over the top speed of the case, and their number. Between them
# they are linear, with an error below 1e-4, and with heat, whose balance takes longer, below 1e-3.
SLOWEST, FASTEST, SPEEDS, WARM_SPEEDS = 0.01, 4.0, 128, 48


class NotCarried(NotConverged):
    """No film carries the axial load. most: what the films carry at most, N."""

    def __init__(self, load: float, most: float, gap: float, omega: float, why: str) -> None:
        self.most = most
        super().__init__(
            f"The axial load of {abs(load):.4g} N is carried by no film at {omega / (2.0 * math.pi):.4g} Hz: the most "
            f"is {most:.4g} N, at a gap of {display(gap, 'm')}, {why}."
        )


@dataclass(frozen=True)
class CollarRest:
    """A collar at rest at one speed. omega: rad/s; load: on the rotor, towards larger positions, N; gap: over the lands
    on the side that it presses on, m; torque: that resists the rotation, N m; stiffness in N/m, damping in N s/m:
    axial; tilt_stiffness, tilt_damping: (2, 2) over x and y, in N m and N m s per rad; viscosities: in Pa s, of the
    loaded side and of the other one."""

    omega: float
    load: float
    gap: float
    torque: float
    stiffness: float
    damping: float
    tilt_stiffness: Array
    tilt_damping: Array
    viscosities: tuple[float, ...]


@dataclass(frozen=True)
class _Side:
    """The pads of one side at a gap: films, and viscosity in Pa s."""

    films: ScaledPads
    viscosity: float


def _load(load: AnyLoad, speed: float, t: float | None) -> float:
    """An axial load in N at a speed in Hz and a time in s; the largest one of a table over time without a time."""
    match load:
        case LoadAtSpeed():
            return load.over(speed)
        case OverTime() if t is not None:
            return float(np.interp(t, load.time, load.x))
        case _:
            return largest(load)


@dataclass(frozen=True)
class Collar:
    """A collar with its pads, oil and load. course: times in s and speeds in Hz of the case, () without; viscosity in
    Pa s and temperature in K without heat."""

    bearing: ThrustBearing
    load: AnyLoad
    course: tuple[tuple[float, ...], ...]
    oil: Oil
    viscosity: float
    thermal: Thermal | None

    @property
    def top(self) -> float:
        """Top speed in rad/s, 0 of a case without speeds."""
        return 2.0 * math.pi * max(map(abs, self.course[1]), default=0.0) if self.course else 0.0

    @property
    def is_ambiguous(self) -> bool:
        """Whether its load changes over time in a course that has a speed more than once."""
        return isinstance(self.load, OverTime) and bool(self.course) and not np.all(np.diff(self.course[1]) > 0.0)

    @property
    def wide(self) -> float:
        """The widest gap in m on the loaded side."""
        play = self.bearing.end_play
        return 0.5 * play if self.bearing.side == BOTH and play is not None else WIDEST * self.bearing.taper

    @property
    def thin(self) -> float:
        """The thinnest gap in m."""
        return min(LEAST_GAP, 0.1 * self.wide)

    @cached_property
    def _table(self) -> GapTable:
        play = self.bearing.end_play
        wide = play if self.bearing.side == BOTH and play is not None else self.wide
        return gap_table(pad_of(self.bearing), self.bearing.pads, self.thin, wide)

    def load_at(self, omega: float) -> float:
        """The load in N at a speed in rad/s; of a table over time that at the time at which the run has the speed."""
        speed = omega / (2.0 * math.pi)
        if not self.course:
            return _load(self.load, speed, None)
        times, speeds = self.course
        return _load(self.load, speed, float(np.interp(speed, speeds, times)))

    def films(self, gap: float) -> ScaledPads:
        """The films of one side at a gap in m, at the nearest gap of the table."""
        table = self._table
        return table.at(min(max(gap, table.thin), table.wide))

    def torques(self, gaps: Array) -> Array:
        """(k,) torques of one side over viscosity and speed, in m^3, at gaps in m."""
        table = self._table
        return table.torques(np.clip(gaps, table.thin, table.wide))

    def rest(self, omega: float) -> CollarRest:
        """Where the collar rests at a speed in rad/s. Raises NotCarried if no film carries its load."""
        load = self.load_at(omega)
        gap = self._gap(abs(load), omega)
        sides = self._sides(gap, omega)
        drag = [side.viscosity * omega for side in sides]
        pairs = list(zip(sides, drag, strict=True))
        return CollarRest(
            omega=omega,
            load=load,
            gap=gap,
            torque=sum(each * side.films.torque for side, each in pairs),
            stiffness=sum(each * side.films.stiffness for side, each in pairs),
            damping=sum(side.viscosity * side.films.damping for side in sides),
            tilt_stiffness=np.sum([each * side.films.tilt_stiffness for side, each in pairs], axis=0),
            tilt_damping=np.sum([side.viscosity * side.films.tilt_damping for side in sides], axis=0),
            viscosities=tuple(side.viscosity for side in sides),
        )

    def position(self, rest: CollarRest) -> float:
        """Axial position of the collar in m: from the middle of the end play, or from the pads of its only side."""
        side = self.bearing.side
        if side == BOTH:
            return math.copysign(self.wide - rest.gap, rest.load)
        return rest.gap if side == LEFT else -rest.gap

    def carried(self, gap: float, omega: float) -> float:
        """The load in N that both sides carry at a gap in m. Raises NotConverged where, with heat, a film becomes too
        hot."""
        first, *others = (side.viscosity * omega * side.films.load for side in self._sides(gap, omega))
        return first - sum(others)

    def _gap(self, load: float, omega: float) -> float:
        """The gap in m that carries a load in N. From the widest one on: thin films may become too hot."""
        above, most = self.wide, self.carried(self.wide, omega)
        if load <= most:
            return above
        while True:
            below = max(above / CLOSER, self.thin)
            try:
                carried = self.carried(below, omega)
            except NotConverged:
                if self.thermal is None:
                    raise
                raise NotCarried(load, most, above, omega, "and thinner films become too hot") from None
            if carried >= load:
                break
            above, most = below, carried
            if below <= self.thin:
                raise NotCarried(load, most, below, omega, "below which lies the roughness of surfaces")
        logs = math.log(below), math.log(above)
        return math.exp(float(brentq(lambda each: self.carried(math.exp(each), omega) / load - 1.0, *logs, xtol=1e-13)))

    def _sides(self, gap: float, omega: float) -> list[_Side]:
        play = self.bearing.end_play
        gaps = [gap, play - gap] if self.bearing.side == BOTH and play is not None else [gap]
        return [self._side(each, omega) for each in gaps]

    def _side(self, gap: float, omega: float) -> _Side:
        films = self.films(gap)
        if self.thermal is None or omega == 0.0:
            return _Side(films, self.viscosity)

        def loss_and_flow(viscosity: float) -> tuple[float, float]:
            return viscosity * omega**2 * films.torque, omega * films.side_flow

        heat = PadHeat(self.oil, self.thermal)
        return _Side(films, heat.warm(loss_and_flow, omega, gap, films.inverse_gap)[0])


def pad_of(bearing: ThrustBearing) -> Pad:
    """One pad of a thrust bearing, lengths in m and angles in rad."""
    return Pad(bearing.inner_radius, bearing.outer_radius, bearing.pad_angle,
               min(bearing.taper_angle, bearing.pad_angle), bearing.taper, bearing.profile)  # fmt: skip


def collar_of(case: Case) -> Collar | None:
    """The collar of a case whose thrust bearing carries its axial load, None without such a load."""
    if case.axial is None or len(case.thrust_bearings) != 1:
        return None
    return collar_under(case, case.thrust_bearings[0], case.axial.load)


def collar_under(case: Case, bearing: ThrustBearing, load: AnyLoad) -> Collar:
    """The collar of a thrust bearing of a case under a load."""
    course = () if case.given_speed is None else case.speed.course
    return Collar(bearing, load, course, case.oil, case.oil_viscosity, case.heat)


@lru_cache(maxsize=8)
def rests_over_speed(collar: Collar) -> tuple[CollarRest, ...]:
    """Where a collar rests, by ascending speed, at all speeds of its table at which its load is carried."""
    rests = []
    count = SPEEDS if collar.thermal is None else WARM_SPEEDS
    below, above = np.geomspace(SLOWEST, 1.0, 3 * count // 4), np.geomspace(1.0, FASTEST, count // 4)
    for share in (*below.tolist(), *above[1:].tolist()):
        try:
            rests.append(collar.rest(share * collar.top))
        except NotCarried:
            if rests:
                break
    return tuple(rests)


def tilt_part(collar: Collar) -> LinearPart:
    """Stiffness and damping in tilt over the speed, on the two tilts of the collar; none where nothing is carried."""
    rests = rests_over_speed(collar)
    if not rests:
        return LinearPart.of(np.zeros((2, 2)))
    return LinearPart(
        np.array([rest.omega for rest in rests]),
        np.array([rest.tilt_stiffness for rest in rests]),
        np.array([rest.tilt_damping for rest in rests]),
        np.zeros((len(rests), 2, 2)),
    )


def collar_at_rest(collar: Collar, omega: float) -> CollarRest:
    """Where a collar rests at a speed in rad/s at which the machine knows its coefficients. Raises NotConverged."""
    rest = collar.rest(omega)
    rests = rests_over_speed(collar)
    known = (rests[0].omega, rests[-1].omega) if rests else (math.inf, 0.0)
    if not known[0] * (1.0 - 1e-9) <= omega <= known[1] * (1.0 + 1e-9):
        low, high = (each / (2.0 * math.pi) for each in known)
        raise NotConverged(
            f"The collar's stiffness in tilt is known from {low:.4g} to {high:.4g} Hz, and not at "
            f"{omega / (2.0 * math.pi):.4g} Hz. Give the case another speed.to."
        )
    return rest


def uncarried_faults(case: Case) -> list[Fault]:
    """The fault of an axial load that no film carries at the slowest speed of a case, or where a drive begins: a rotor
    that slows down by itself runs until its collar touches."""
    collar = collar_of(case)
    if collar is None or not collar.top:
        return []
    speeds = collar.course[1] if case.drive is None else collar.course[1][:1]
    slowest = 2.0 * math.pi * min(map(abs, speeds))
    try:
        collar.rest(slowest)
    except NotCarried as error:
        rests = rests_over_speed(collar)
        lifted = f'Begin at speed.from = "{1.01 * rests[0].omega / (2.0 * math.pi):.4g} Hz", or let' if rests else "Let"
        remedy = f'{lifted} it grow with the square of the speed, load = {{ at = "1000 Hz", load = "40 N" }}.'
        return [Fault("axial.load", "", None, f"presses the collar onto its pads. {error}", remedy)]
    return []


TO_RIGHT, TO_LEFT = -1.0, 1.0  # change of the gap by a displacement, of pads on that side
RELATIVE, ABSOLUTE = 1e-6, (1e-11, 1e-7)  # tolerances: m and m/s
LOOKED_AT = 400  # times at which the films are looked at for cavitation, those where the collar lifts fastest
SOLVED, CUT = 8, 0.01  # of them those whose pressure is solved, and the share of the load that may be missing


@dataclass(frozen=True)
class AxialMotion:
    """A motion along the axis. mass: of the rotor in kg; pieces: displacement in m and velocity in m/s over time in s;
    end: time in s up to which it is known, before the end of the profile where the collar touches its pads."""

    collar: Collar
    profile: SpeedProfile
    mass: float
    pieces: tuple[OdeSolution, ...] = ()
    end: float = 0.0

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """(k,) each at times in s: position in m, smaller gap over the lands in m, loss in W. Beyond its end it stays
        as it is there."""
        known = np.minimum(times, self.end)
        which = np.searchsorted([piece.t_max for piece in self.pieces], known)
        position = np.empty(len(times))
        for number in np.unique(which).tolist():
            inside = which == number
            position[inside] = self.pieces[number](known[inside])[0]
        gaps = [self._gap(side, position) for side in self._sides]
        omegas, loss = self.profile.speed(times), np.zeros(len(times))
        for side, gap in zip(self._sides, gaps, strict=True):
            pairs = zip(times.tolist(), omegas.tolist(), strict=True)
            viscosities = np.array([self._viscosity(side, t, omega) for t, omega in pairs])
            loss += viscosities * omegas**2 * self.collar.torques(gap)
        return position, np.min(gaps, axis=0), loss

    @property
    def _sides(self) -> tuple[float, ...]:
        side = self.collar.bearing.side
        return (TO_RIGHT, TO_LEFT) if side == BOTH else (TO_LEFT,) if side == LEFT else (TO_RIGHT,)

    def _gap(self, side: float, position: Array) -> Array:
        return (self.collar.wide if self.collar.bearing.side == BOTH else 0.0) + side * position

    def _state(self, t: float) -> Array:
        piece = next(each for each in self.pieces if t <= each.t_max)
        return np.asarray(piece(t))

    def load(self, t: float) -> float:
        """The load in N at a time in s, towards larger positions."""
        return _load(self.collar.load, float(self.profile.speed(np.array([t]))[0]) / (2.0 * math.pi), t)

    def _viscosity(self, side: float, t: float, omega: float) -> float:
        """Viscosity of the oil on a side in Pa s, with heat the one of a collar that rests at this speed."""
        if self.collar.thermal is None:
            return self.collar.viscosity
        is_loaded = (side == TO_RIGHT) == (self.load(t) >= 0.0) or len(self._sides) == 1
        rests = rests_over_speed(self.collar)
        values = [rest.viscosities[0 if is_loaded else -1] for rest in rests]
        return float(np.interp(omega, [rest.omega for rest in rests], values))

    def slope(self, t: float, state: Array) -> list[float]:
        """Velocity in m/s and acceleration in m/s^2."""
        omega, force = float(self.profile.speed(np.array([t]))[0]), self.load(t)
        for side in self._sides:
            gap = self._gap(side, state[:1])
            films, viscosity = self.collar.films(float(gap[0])), self._viscosity(side, t, omega)
            force += side * viscosity * (omega * films.load - films.damping * side * state[1])
        return [float(state[1]), force / self.mass]

    def room(self, t: float, state: Array) -> float:
        """The smaller gap less the gap at contact, in m."""
        return min(float(self._gap(side, state[:1])[0]) for side in self._sides) - self.collar.thin

    def missing(self) -> tuple[float, float]:
        """The largest part of the load in N that a full film carries only by pressures below the cavitation pressure,
        as its collar lifts, and its time in s."""
        times = np.linspace(0.0, self.end, LOOKED_AT)
        lifts = []
        for t in times.tolist():
            position, velocity = self._state(t)
            for side in self._sides:
                gap, rate = float(self._gap(side, np.array([position]))[0]), side * velocity
                bound = self.collar.viscosity * self.collar.films(gap).damping * max(rate, 0.0)
                lifts.append((bound, t, gap, rate))
        candidates = [(self._cut(*lift), lift[1]) for lift in sorted(lifts, reverse=True)[:SOLVED]]
        return max(candidates)

    def _cut(self, bound: float, t: float, gap: float, rate: float) -> float:
        """That part of one film; bound: what it can be at most."""
        largest = max(abs(self.load(each)) for each in np.linspace(0.0, self.end, LOOKED_AT).tolist())
        if bound <= CUT * largest:
            return 0.0
        collar, pad = self.collar, pad_of(self.collar.bearing)
        mesh, oil = pad_mesh(pad, *COARSE), PadOil(collar.viscosity, SOMMERFELD)
        omega = float(self.profile.speed(np.array([t]))[0])
        film = pad_film(mesh, gap + pad.depth(mesh.theta), oil, omega, RunnerMotion(rate=(rate, 0.0, 0.0)))
        below = collar.oil.cavitation_pressure - collar.oil.ambient_pressure - mesh.value @ film.pressure
        cut = collar.bearing.pads * float((mesh.weights * mesh.r) @ np.maximum(below, 0.0))
        return cut / largest


def axial_motion(case: Case, profile: SpeedProfile, mass: float) -> AxialMotion | None:
    """The motion of a rotor of a mass in kg in a run; None without an axial load. It begins at rest.

    Raises InputError where the collar lifts so fast that its films would cavitate, NotConverged where it is not found.
    """
    from scipy.integrate import solve_ivp

    collar = collar_of(case)
    if collar is None:
        return None
    moving = AxialMotion(collar, profile, mass)
    start = replace(collar, load=moving.load(float(profile.times[0]))).rest(float(profile.speeds[0]))
    state, pieces, end = np.array([collar.position(start), 0.0]), [], 0.0

    def touch(t: float, state: Array) -> float:
        return moving.room(t, state)

    touch.terminal = True  # type: ignore[attr-defined]
    for begin, stop in zip(profile.times[:-1].tolist(), profile.times[1:].tolist(), strict=True):
        solution = solve_ivp(moving.slope, (begin, stop), state, "LSODA", dense_output=True, events=touch,
                          rtol=RELATIVE, atol=ABSOLUTE)  # fmt: skip
        if not solution.success:
            raise NotConverged(f"The motion along the axis was not found at {begin:.4g} s: {solution.message}")
        pieces.append(solution.sol)
        state, end = solution.y[:, -1], float(solution.t[-1])
        if solution.status == 1:
            break
    motion = AxialMotion(collar, profile, mass, tuple(pieces), end)
    share, t = motion.missing()
    if share > CUT:
        problem = (
            f"changes so fast that the collar lifts off its pads: at {t:.4g} s pressures below oil.cavitation_pressure "
            f"would carry {share:.0%} of the load, and the films of a run are full."
        )
        raise case.refused(Fault("axial.load", "", None, problem, "Let it rise more slowly."))
    return motion
