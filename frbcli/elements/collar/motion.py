"""The motion of a rotor along its axis in a run: m p'' = F - W(h, h'), with the table of the films of its collar.

Pads all around do not couple it to the lateral motion, so that it is known before a run begins. Towards pads that stand
on the right the gap is h = e/2 - p, towards those on the left h = e/2 + p, or - p and p where there are no others; the
films are full, W = eta (omega w(h) - c(h) h'), with the viscosity that they have at rest at the speed of the moment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from frbcli.arrays import Array
from frbcli.case.elements import LoadAtSpeed
from frbcli.case.schema import Case
from frbcli.case.surroundings.over_time import OverTime
from frbcli.elements.collar.collar import BOTH, LEFT, Collar, collar_of, pad_of, rests_over_speed
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.film.pads.film import PadOil, RunnerMotion, pad_film
from frbcli.film.pads.geometry import COARSE, SOMMERFELD
from frbcli.film.pads.mesh import pad_mesh
from frbcli.rotor.loads import SpeedProfile

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
        load = self.collar.load
        if isinstance(load, OverTime):
            return float(np.interp(t, load.time, load.x))
        speed = float(self.profile.speed(np.array([t]))[0]) / (2.0 * math.pi)
        return load.over(speed) if isinstance(load, LoadAtSpeed) else load

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
        fault = Fault("axial.load", "", None, problem, "Let it rise more slowly.")
        raise InputError(case.name or "case", (fault,))
    return motion
