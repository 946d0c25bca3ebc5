"""A machine at rest at one speed: the coefficients of its films, and the eigenvalues of its small motions.

The threshold of stability: the lowest speed at which a whirl begins to grow, and its error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.equilibrium import hopf
from frbcli.equilibrium.dynamic_films import DynamicFilm, place_errors
from frbcli.equilibrium.linearised import LEAST, FilmsAtRest, RestingFilm, eigenpairs, rotor_at_rest, stacked
from frbcli.equilibrium.resting import lagrange
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines, WarmMachine
from frbcli.errors import NotConverged
from frbcli.film.cells.linearised import DynamicStiffness
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import fastest_first, ranks
from frbcli.scene.supply import advised
from frbcli.units import SpeedUnit

if TYPE_CHECKING:
    from frbcli.linear.sheets.thrust import AxialState


HARDLY_KNOWN = 0.25  # error of coefficients of films that keep oil, relative, above which they are not shown
UNKNOWN_WHIRL = 0.5  # over the rotor's speed: frequency of coefficients where no motion oscillates
DIVERGENT = 1e-9  # real part over the largest absolute value from which a motion grows without oscillating


class Eigenvalue(NamedTuple):
    """An eigenvalue in 1/s, and its expected distance from the true one by the mesh, NaN if not known."""

    value: complex
    error: float


@dataclass(frozen=True)
class StabilityPoint:
    """The rotor at one speed.

    films: one per bearing of the case, of a floating ring the inner before the outer one; eigenvalues: (2 n,) in 1/s,
    on mass-conserving films only eigenvalues that grow or decay slowly, see dynamic_films.modes; ascending in
    |imaginary part|, then in the real part, of a pair the one with positive imaginary part first. ring_speeds_Hz: of
    the rings that turn; their speeds follow the motion and are states of their own; 0 against a pin. warm: the machine
    with its heat, of a case with [thermal]; its temperatures are frozen. errors: (2 n,) expected ones of the
    eigenvalues in 1/s, by the mesh of the films, empty where they were not asked for; others: stiffness and damping
    (films, c, c) on other meshes, with the share of the difference that is the error; axial: the collar under an axial
    load, None without one; rotor: the machine without its films, as small motions see it, None without rest. All others
    are empty where no static equilibrium was found; problem then says why, and is empty otherwise. """

    speed_Hz: float
    films: tuple[RestingFilm, ...]
    eigenvalues: Complex
    problem: str = ""
    ring_speeds_Hz: tuple[float, ...] = ()
    warm: WarmMachine | None = None
    errors: Array = field(default_factory=lambda: np.zeros(0))
    others: tuple[tuple[Array, Array, float], ...] = ()
    axial: AxialState | None = None
    rotor: LinearRotor | None = None

    @property
    def value(self) -> float:
        """Rotor speed in Hz, over which thresholds are sought."""
        return self.speed_Hz

    @property
    def status(self) -> str:
        """ "resting" | "not-converged"."""
        return "not-converged" if self.problem else "resting"

    @property
    def rests(self) -> bool:
        """Whether a static equilibrium was found."""
        return not self.problem

    @property
    def oscillating(self) -> Complex:
        """One eigenvalue of each oscillating pair, that with positive imaginary part, ascending in frequency."""
        return self.eigenvalues[hopf.oscillating(self.eigenvalues)]

    @property
    def modes(self) -> Complex:
        """One eigenvalue of each motion that oscillates or grows: those that grow, the fastest first, then those that
        decay, the slowest first."""
        size = np.abs(self.eigenvalues)
        divergent = (self.eigenvalues.imag >= 0.0) & (self.eigenvalues.real > DIVERGENT * size.max(initial=0.0))
        shown: Complex = self.eigenvalues[hopf.oscillating(self.eigenvalues) | divergent]
        return shown[fastest_first(shown)]

    @property
    def modes_with_errors(self) -> list[Eigenvalue]:
        """The modes with their errors."""
        return [Eigenvalue(complex(value), self.error_of(complex(value))) for value in self.modes]

    def error_of(self, value: complex) -> float:
        """The expected error of one of the eigenvalues, see Eigenvalue."""
        if not len(self.errors) or math.isnan(value.real):
            return math.nan
        return float(self.errors[int(np.argmin(np.abs(self.eigenvalues - value)))])

    @property
    def critical_error(self) -> float:
        """The expected error of the critical eigenvalue."""
        return self.error_of(self.critical)

    @property
    def growing(self) -> Complex:
        """Eigenvalues of the modes that grow."""
        modes = self.modes
        return modes[modes.real > 0.0]

    @property
    def critical(self) -> complex:
        """See critical_eigenvalue."""
        return critical_eigenvalue(self.eigenvalues)

    @property
    def growth(self) -> float:
        """Real part of the critical eigenvalue, 1/s: positive where a whirl grows; NaN without a static equilibrium."""
        return self.critical.real

    def growth_of(self, number: int) -> float:
        """Growth of the whirl number 0, 1, ... by falling growth; of the critical eigenvalue where none oscillates."""
        return hopf.growth_of(self.eigenvalues, number) if len(self.oscillating) else self.growth


def eigenvalues(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Complex:
    """(2 n,) eigenvalues in 1/s of the rotor at omega rad/s on bearings of stiffness and damping (films, 2, 2).

    Ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    """
    return _ordered(eigenpairs(rotor, omega, stiffness, damping)[0])


def _ordered(values: Complex) -> Complex:
    """Eigenvalues (N,) in the order of `eigenvalues`."""
    # frequencies that are equal but for round-off are one, and the real parts decide
    frequency = np.abs(values.imag)
    equal = ranks(frequency, float(np.max(np.abs(values), initial=0.0)))
    return values[np.lexsort((-values.imag, frequency, values.real, equal))]


def critical_eigenvalue(values: Complex) -> complex:
    """The eigenvalue with the largest real part among those that oscillate, or among all where none does; NaN of
    none."""
    whirling = hopf.oscillating(values)
    candidates = values[whirling] if whirling.any() else values
    return complex(candidates[fastest_first(candidates)[0]]) if len(candidates) else complex(math.nan, math.nan)


def machine_eigenvalues(machine: MachineAtRest, films: FilmsAtRest) -> Complex:
    """(2 n,) eigenvalues in 1/s of a machine at rest with its films as they are solved, on its own mesh or another."""
    return eigenvalues(machine_rotor(machine, films), machine.omega, *_coefficients(films))


def machine_rotor(
    machine: MachineAtRest, films: FilmsAtRest | None = None, frequency: float = math.nan
) -> LinearRotor:
    """A machine at rest without its films, as small motions see it; films: on another mesh, by default its own;
    frequency: of the motion in rad/s, above 0, where films keep oil that turns rings."""
    at_rest = machine.at_rest
    oil = None if math.isnan(frequency) else [film.oil_at(frequency) for film in machine.dynamic]
    return rotor_at_rest(machine.system, machine.omega, at_rest.position.ring_speeds, films or at_rest, oil)


def other_eigenvalues(machine: MachineAtRest) -> list[tuple[Complex, float]]:
    """The eigenvalues of a machine at rest on the other meshes of its films, each with the share of the difference that
    is the error."""
    if machine.dynamic:
        return [(_both(machine.modes_on_finer_films), 1.0)]
    return [(machine_eigenvalues(machine, films), share) for films, share in machine.others]


def point_at_rest(machine: MachineAtRest, speed: float, frequency: float | None = None) -> StabilityPoint:
    """The point at a speed in Hz of a machine that rests. frequency: in rad/s, of the coefficients of films that keep
    oil; by default of the least damped whirl."""
    rings = tuple((machine.at_rest.position.ring_speeds / (2 * math.pi)).tolist())
    others: tuple[tuple[Array, Array, float], ...]
    if machine.dynamic:
        values = _both(machine.modes)
        whirl = critical_eigenvalue(values).imag
        if frequency is None:
            frequency = whirl if whirl > 0.0 else UNKNOWN_WHIRL * machine.omega
        pairs = zip(machine.films, machine.dynamic, strict=True)
        films = tuple(_at_frequency(film, dynamic, frequency) for film, dynamic in pairs)
        _check_known(films)
        fine = [_by_journal(dynamic.fine, frequency) for dynamic in machine.dynamic]
        rotor = machine_rotor(machine, frequency=frequency)
        others = ((np.array([z.real for z in fine]), np.array([z.imag for z in fine]) / frequency, 1.0),)
        return StabilityPoint(speed, films, values, ring_speeds_Hz=rings, warm=machine.warm, others=others, rotor=rotor)
    rotor, values = machine_rotor(machine), machine_eigenvalues(machine, machine.at_rest)
    others = tuple((*_coefficients(films), share) for films, share in machine.others)
    return StabilityPoint(
        speed, machine.films, values, ring_speeds_Hz=rings, warm=machine.warm, others=others, rotor=rotor
    )


def with_errors(point: StabilityPoint, machine: MachineAtRest) -> StabilityPoint:
    """The point of a machine with the errors of its eigenvalues: the distance to the nearest ones on the other meshes,
    times their shares, at least LEAST of it, and in films that keep oil at least what the places of their cells leave.
    Real and imaginary part have the same one, since either may agree by chance."""
    others = [(values, share) for values, share in other_eigenvalues(machine) if len(values)]
    if not others:
        return point
    apart = [share * np.abs(point.eigenvalues[:, None] - values).min(axis=1) for values, share in others]
    if machine.dynamic:
        apart.append(place_errors(machine.oscillator, machine.dynamic, point.eigenvalues))
    return replace(point, errors=np.max([LEAST * np.abs(point.eigenvalues), *apart], axis=0))


def _coefficients(films: FilmsAtRest) -> tuple[Array, Array]:
    """(films, c, c) stiffness and damping of the films of a machine, as they are solved."""
    stiffness, damping = (
        -stacked([getattr(force, name) for force in films.forces]) for name in ("by_displacement", "by_velocity")
    )
    return stiffness, damping


def _check_known(films: Sequence[RestingFilm]) -> None:
    """Raises NotConverged if a film's coefficients are hardly known."""
    error, name = max((film.error, film.name) for film in films if not math.isnan(film.error))
    if error > HARDLY_KNOWN:
        which = f"The film {name}" if name else "The film"
        raise NotConverged(
            f"{which} has no linear coefficients on these cells: two meshes differ by {100.0 * error:.2g} %. "
            "Its fronts of oil cross cells at the least motion. Give it more supply pressure."
        )


def _both(pairs: Sequence[tuple[complex, Complex]]) -> Complex:
    """The eigenvalues of modes, both of each pair, in the order of `eigenvalues`."""
    values = np.array([value for value, _ in pairs]).astype(complex)
    return _ordered(np.concatenate([values, values[hopf.oscillating(values)].conj()]))


def _by_journal(film: DynamicStiffness, frequency: float) -> Complex:
    """(c, c) Z(i frequency) of forces and moments by the coordinates of the journal."""
    c = len(film.place) // 2 * 2
    return film.at(1j * frequency)[0][:c, :c]


def _at_frequency(film: RestingFilm, dynamic: DynamicFilm, frequency: float) -> RestingFilm:
    """The film with K = Re Z(i frequency) and D = Im Z(i frequency) / frequency in rad/s, above 0."""
    own, fine = (_by_journal(each, frequency) for each in (dynamic.own, dynamic.fine))
    error, size = film.error, len(own)
    if dynamic.exact is not None:
        blocks = [(slice(first, first + 2),) * 2 for first in range(0, size, 2)]  # forces, and moments by tilts
        pairs = [(part(own[block]), part(fine[block])) for block in blocks for part in (np.real, np.imag)]
        error = max(float(np.abs(mine - other).max() / np.abs(mine).max()) for mine, other in pairs)
    stiffness, damping = own.real, own.imag / frequency
    tilting = film.tilting and replace(film.tilting, stiffness=stiffness, damping=damping)
    return replace(film, stiffness=stiffness[:2, :2], damping=damping[:2, :2], error=error, tilting=tilting)


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
