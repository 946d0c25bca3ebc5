"""The threshold of stability: the lowest speed at which a whirl begins to grow, and its error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.equilibrium import hopf
from frbcli.equilibrium.coefficients import LEAST
from frbcli.equilibrium.resting import lagrange
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.errors import NotConverged
from frbcli.linear.stability_point import StabilityPoint, critical_eigenvalue, other_eigenvalues, point_at_rest
from frbcli.scene.supply import advised
from frbcli.units import SpeedUnit

THRESHOLD_TOLERANCE = 1e-9  # relative, of the speed
STABLE, UNSTABLE = "Stable up to the highest speed", "Unstable from the lowest speed on"  # begin a note
UNDAMPED = "no motion grows, and one that is undamped does not decay either"
AHEAD = 1e-3  # of the speed, for the derivative of the eigenvalue
# Eigenvalues on films that keep oil scatter from speed to speed, as fronts of the oil cross cells. There a threshold is
# sought as closely as NEAR, relative to its speed, and is the zero of the line through FITTED ones within AROUND of it.
NEAR, FITTED, AROUND = 0.03, 5, 0.04


@dataclass(frozen=True)
class Threshold:
    """Where a whirl begins to grow: rotor speed and frequency of the whirl, with their expected errors by the mesh of
    the films, NaN where they are not known."""

    speed_Hz: float
    frequency_Hz: float
    speed_uncertainty_Hz: float = math.nan
    frequency_uncertainty_Hz: float = math.nan

    @property
    def whirl_ratio(self) -> float:
        """Frequency of the whirl over the rotor speed."""
        return self.frequency_Hz / self.speed_Hz


def find_threshold(
    case: Case, machines: StaticMachines, sweep: Sequence[StabilityPoint]
) -> tuple[Threshold | None, str]:
    """The lowest speed at which the growth passes zero from below; a note where there is none, or where the rotor
    becomes stable once more."""
    resting = [point for point in sweep if point.rests]
    if not resting:
        return None, "No threshold: there is no static equilibrium in the whole range of speeds."
    slowest, fastest = resting[0], resting[-1]
    unit = case.speed_unit
    lowest, highest = unit.words(slowest.speed_Hz), unit.words(fastest.speed_Hz)
    if len(resting) == 1:
        return None, _one_speed(slowest, lowest, len(sweep))
    above = deciding(resting)[-1]
    if resting[above].growth == 0.0:
        return None, f"No threshold up to {highest}: {UNDAMPED}."
    if resting[above].growth < 0.0:
        return None, f"{STABLE}: a threshold, if there is one, lies above {highest}."
    if above == 0:
        unstable = f"{UNSTABLE}: a threshold, if there is one, lies below"
        beyond = "" if slowest is sweep[0] else " Below it there is no static equilibrium."
        return None, f"{unstable} {lowest}.{beyond}{_stable_again(resting, unit)}"
    near = resting[max(above - 2, 0) : above + 2]
    guess = interpolated_root([point.speed_Hz for point in near], [point.growth for point in near])
    threshold, problem = _crossing(case, machines, resting[above - 1], resting[above], guess)
    return threshold, problem + _stable_again(resting[above:], unit)


def deciding(points: Sequence[StabilityPoint]) -> tuple[int, ...]:
    """Numbers of the points, with a static equilibrium each, that decide where the threshold lies: the first one at
    which a motion grows, after the one below it; where none grows, the one that is nearest to it."""
    growing = next((number for number, point in enumerate(points) if point.growth > 0.0), None)
    if growing is None:
        return (int(np.argmax([point.growth for point in points])),)
    return (growing - 1, growing) if growing > 0 else (growing,)


def interpolated_root(speeds: Sequence[float], growth: Sequence[float]) -> float:
    """Where the growth passes zero for the first time, from below, by the polynomial through a few points, of which one
    below zero stands before one above."""
    from scipy.optimize import brentq  # takes long to load

    above = next(i for i in range(1, len(growth)) if growth[i - 1] <= 0.0 < growth[i])
    return float(brentq(lambda speed: lagrange(speed, speeds) @ growth, speeds[above - 1], speeds[above]))


def _one_speed(point: StabilityPoint, speed: str, tried: int) -> str:
    """Why a single speed has no threshold."""
    state = "a motion grows" if point.growth > 0.0 else "every motion decays" if point.growth < 0.0 else UNDAMPED
    if tried > 1:
        return f"No threshold: the journals rest at one of {tried} speeds only, {speed}, where {state}."
    return (
        f"No threshold is sought: there is one speed only, {speed}, where {state}. "
        "Widen the range of speed.from and speed.to."
    )


def _stable_again(points: Sequence[StabilityPoint], unit: SpeedUnit) -> str:
    """Where no motion grows any more, of points that begin with an unstable one."""
    stable = [point.speed_Hz for point in points if point.growth <= 0.0]
    if not stable:
        return ""
    return f" No motion grows at {len(stable)} higher speeds, from {unit.span(stable[0], stable[-1])}."


def _crossing(
    case: Case, machines: StaticMachines, low: StabilityPoint, high: StabilityPoint, guess: float
) -> tuple[Threshold | None, str]:
    """The threshold between two points; guess: a speed in Hz that may be near."""
    known: list[MachineAtRest] = []  # the last one is near to the next

    def point(speed: float) -> StabilityPoint:
        known.append(machines.at(2 * math.pi * speed, known[-1] if known else None, with_error=False))
        return point_at_rest(known[-1], speed)

    try:
        with advised(case):
            scatters = machines.system.remembers
            bracket = hopf.located(point, low, high, 0, NEAR if scatters else THRESHOLD_TOLERANCE, guess)
            near = next((each for each in known if each.omega == 2 * math.pi * bracket.speed_Hz), None)
            if scatters:
                return _fitted(machines, bracket, near), ""
            return threshold_at(machines, bracket.speed_Hz, near=near), ""
    except NotConverged as error:
        between = case.speed_unit.span(low.speed_Hz, high.speed_Hz, "and")
        return None, f"A threshold lies between {between}, but was not found: {error}"


@dataclass(frozen=True)
class _Zero:
    """Where the growth of a whirl is zero, by the straight line through its eigenvalues (N,) at several speeds in Hz:
    speed in Hz and frequency in rad/s, and how uncertain the scatter of the eigenvalues about the line leaves both, as
    two standard deviations."""

    speed: float
    frequency: float
    speed_spread: float
    frequency_spread: float

    @classmethod
    def of(cls, speeds: Array, values: Complex) -> _Zero:
        """The zero of the growth of eigenvalues (N,) in 1/s at speeds (N,)."""
        middle = float(speeds.mean())
        line = np.stack([np.ones(len(speeds)), speeds - middle], axis=1)
        here, slope = np.linalg.lstsq(line.astype(complex), values, rcond=None)[0].tolist()
        off = -here.real / slope.real
        square = float(np.sum(np.abs(values - line @ [here, slope]) ** 2)) / 2.0  # of growth or frequency alone
        spread = 2.0 * math.sqrt(square / (len(speeds) - 2) / len(speeds)) / abs(slope.real)
        return cls(middle + off, here.imag + slope.imag * off, spread, spread * abs(slope))


def _fitted(machines: StaticMachines, here: StabilityPoint, near: MachineAtRest | None) -> Threshold:
    """The threshold near a point in films that keep oil, sought from the machine near it: where the line through the
    growth at several speeds is zero. Its error is the distance to that on the finer mesh alone, or what the scatter of
    the eigenvalues leaves, where that is more. Raises NotConverged."""
    speeds = here.speed_Hz * (1.0 + np.linspace(-AROUND, AROUND, FITTED))
    own, finer = np.zeros((2, FITTED), dtype=complex)
    for number, speed in enumerate(speeds.tolist()):
        near = machines.at(2 * math.pi * speed, near, with_error=False)
        ((others, _),) = other_eigenvalues(near)
        for kept, values in ((own, point_at_rest(near, speed).eigenvalues), (finer, others)):
            kept[number] = values[np.argmin(np.abs(values - here.critical))]
    zero, other = _Zero.of(speeds, own), _Zero.of(speeds, finer)
    return Threshold(
        zero.speed,
        zero.frequency / (2 * math.pi),
        max(LEAST * zero.speed, abs(zero.speed - other.speed), zero.speed_spread),
        max(LEAST * zero.frequency, abs(zero.frequency - other.frequency), zero.frequency_spread) / (2 * math.pi),
    )


def threshold_at(
    machines: StaticMachines, speed: float, frequency_Hz: float | None = None, near: MachineAtRest | None = None
) -> Threshold:
    """The threshold at a speed in Hz, sought from the machine near it. Its error is the distance to the thresholds on
    the other meshes, to first order in the eigenvalues there.

    frequency_Hz: of the whirl whose threshold it is on films of a run, which may be others; the distance to that on
    these films is part of the error. By default it is the threshold of the least damped whirl on these films.
    """

    def critical(values: Complex) -> complex:
        if frequency_Hz is None:
            return critical_eigenvalue(values)
        return complex(values[np.argmin(np.abs(values - 2j * math.pi * frequency_Hz))])

    machine = machines.at(2 * math.pi * speed, near)
    own = critical(point_at_rest(machine, speed).eigenvalues)
    frequency = own.imag / (2 * math.pi)
    beyond = point_at_rest(machines.at(2 * math.pi * speed * (1.0 + AHEAD), machine, with_error=False), speed)
    slope = (critical(beyond.eigenvalues) - own) / (AHEAD * speed)
    known = machine.static.case.films == () or bool(machine.others)
    least = (LEAST if machine.static.case.films else THRESHOLD_TOLERANCE) if known else math.nan
    speeds, frequencies = [least * speed], [least * frequency]
    for others, share in other_eigenvalues(machine):
        apart = critical(others) - own
        further = -apart.real / slope.real
        speeds.append(share * abs(further))
        frequencies.append(share * abs(apart.imag + slope.imag * further) / (2 * math.pi))
    if frequency_Hz is None:
        return Threshold(speed, frequency, max(speeds), max(frequencies))
    off = -own.real / slope.real
    its_frequency = frequency + slope.imag * off / (2 * math.pi)
    return Threshold(speed, frequency_Hz, max(speeds) + abs(off), max(frequencies) + abs(its_frequency - frequency_Hz))
