"""Linear stability: resting positions, coefficients of the films, and eigenvalues.

In its resting position films and shaft carry the static load of the rotor. Linearised there, each film is a stiffness
K = -dF/dD and a damping D = -dF/dD' per bearing, and the rotor has 2 n eigenvalues: a positive real part is a motion
that grows. The threshold is the lowest speed at which one of the oscillating motions, a whirl, begins to grow.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.columns import Table, table_of
from frbcli.equilibrium.coefficients import RestingFilm, coefficients_of
from frbcli.equilibrium.linearised import state_matrix
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.equilibrium.warm_machine import WarmMachine
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.film.cavitation.table import law_named
from frbcli.html import Tabular
from frbcli.linear.columns import point_columns
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.order import fastest_first, ranks
from frbcli.rotor.ring import without_spins
from frbcli.scene.channels import coupled
from frbcli.scene.film_faults import require_films
from frbcli.scene.keys import bearing_key, cavitation_keys
from frbcli.scene.machine.system import System
from frbcli.scene.remedies import advised

Array = NDArray[np.float64]
Eigenvalues = NDArray[np.complex128]

SPEEDS = 60  # of the default sweep: 5 Hz apart from 0 to 300 Hz
THRESHOLD_TOLERANCE = 1e-9  # relative tolerance of the speed: one step of brentq beyond 1e-6
OSCILLATING = 1e-9  # imaginary part over absolute value from which an eigenvalue oscillates
DIVERGENT = 1e-9  # real part over the largest absolute value from which a motion grows without oscillating


@dataclass(frozen=True)
class StabilityPoint:
    """The rotor at one speed.

    films: one per bearing of the case, of a floating ring the inner before the outer one; eigenvalues: (2 n,) in 1/s,
    ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    ring_speeds_Hz: of the rings that turn; their speeds stand while the rotor moves. warm: the machine with its heat,
    of a case that has it; its temperatures stand, too. All are empty where no resting
    position was found; problem then says why, and is empty otherwise.
    """

    speed_Hz: float
    films: tuple[RestingFilm, ...]
    eigenvalues: Eigenvalues
    problem: str = ""
    ring_speeds_Hz: tuple[float, ...] = ()
    warm: WarmMachine | None = None

    @property
    def status(self) -> str:
        """ "resting" | "not-converged"."""
        return "not-converged" if self.problem else "resting"

    @property
    def rests(self) -> bool:
        """Whether a resting position was found."""
        return not self.problem

    @property
    def oscillating(self) -> Eigenvalues:
        """One eigenvalue of each oscillating pair, that with positive imaginary part, ascending in frequency."""
        return self.eigenvalues[self.eigenvalues.imag > OSCILLATING * np.abs(self.eigenvalues)]

    @property
    def modes(self) -> Eigenvalues:
        """One eigenvalue of each motion that oscillates or grows: those that grow, the fastest first, then those that
        decay, the slowest first."""
        size = np.abs(self.eigenvalues)
        divergent = (self.eigenvalues.imag >= 0.0) & (self.eigenvalues.real > DIVERGENT * size.max(initial=0.0))
        told: Eigenvalues = self.eigenvalues[(self.eigenvalues.imag > OSCILLATING * size) | divergent]
        return told[fastest_first(told)]

    @property
    def growing(self) -> Eigenvalues:
        """Those of the modes that grow."""
        modes = self.modes
        return modes[modes.real > 0.0]

    @property
    def critical(self) -> complex:
        """The eigenvalue with the largest real part among those that oscillate, or among all where none does."""
        candidates = self.oscillating if len(self.oscillating) else self.eigenvalues
        return complex(candidates[fastest_first(candidates)[0]]) if len(candidates) else complex(math.nan, math.nan)

    @property
    def growth(self) -> float:
        """Real part of the critical eigenvalue, 1/s: positive where a whirl grows; NaN without a resting position."""
        return self.critical.real


@dataclass(frozen=True)
class Threshold:
    """Where a whirl begins to grow: rotor speed and frequency of the whirl."""

    speed_Hz: float
    frequency_Hz: float

    @property
    def whirl_ratio(self) -> float:
        """Frequency of the whirl over the rotor speed."""
        return self.frequency_Hz / self.speed_Hz


@dataclass(frozen=True)
class Stability(Tabular):
    """Linear stability of a case.

    points: at the speeds asked for; sweep: at all speeds that were computed, ascending; threshold: None if none lies
    in the swept range; note then says why, and where the rotor is stable once more above it.
    """

    case: Case
    points: tuple[StabilityPoint, ...]
    sweep: tuple[StabilityPoint, ...]
    threshold: Threshold | None
    note: str

    def table(self) -> Table:
        """One row per point: speed, resting position and coefficients of each film, critical eigenvalue."""
        films = max((tuple(film.name for film in point.films) for point in self.points), key=len, default=())
        return table_of(point_columns(films), self.points)


def stability(
    case: Case, speeds_Hz: Sequence[float] | None = None, observe: Callable[[int, int], None] | None = None
) -> Stability:
    """Resting positions, linear coefficients and eigenvalues at speeds_Hz (> 0), and the threshold of stability.

    The threshold is sought in the speed range of the case, whatever speeds_Hz; without speeds_Hz the points are those
    of this sweep. A speed without a resting position gives a point that says so. observe: called with each speed's
    number and their number.

    Raises InputError if the case cannot be modelled or a speed is not positive.
    """
    require_films(case)
    asked = default_speeds(case) if speeds_Hz is None else tuple(float(speed) for speed in speeds_Hz)
    _check_speeds(case, asked)
    speeds = sorted(set(default_speeds(case)) | set(asked))
    check_machine(case, speeds)
    machines, sweep = _sweep(case, speeds, observe)
    found = {point.speed_Hz: point for point in sweep}
    threshold, note = _threshold(case, machines, sweep)
    return Stability(case, tuple(found[speed] for speed in asked), sweep, threshold, note)


def stability_points(
    case: Case, speeds_Hz: Sequence[float], observe: Callable[[int, int], None] | None = None
) -> tuple[System, tuple[StabilityPoint, ...]]:
    """The machine, and its points at speeds_Hz, ascending.

    observe: called with each speed's number and their number. Raises InputError if the case cannot be modelled, a speed
    is not positive, or a film has no eight coefficients.
    """
    check_machine(case, speeds_Hz)
    machines, points = _sweep(case, speeds_Hz, observe)
    return machines.system, points


def check_machine(case: Case, speeds_Hz: Sequence[float]) -> None:
    """Raises InputError if a case cannot be modelled, a speed is not positive, or a film has no eight coefficients."""
    require_films(case)
    _check_speeds(case, speeds_Hz)
    if faults := _without_coefficients(case):
        raise InputError(case.name or "case", tuple(faults))


def _sweep(
    case: Case, speeds_Hz: Sequence[float], observe: Callable[[int, int], None] | None = None
) -> tuple[StaticMachines, tuple[StabilityPoint, ...]]:
    """As stability_points, with the machines at further speeds."""
    machines = StaticMachines(case)
    points: list[StabilityPoint] = []
    near: MachineAtRest | None = None
    for speed in sorted(speeds_Hz, reverse=True):  # from near the centre, where a fast journal rests, outwards
        point, near = _point(case, machines, speed, near)
        points.append(point)
        if observe is not None:
            observe(len(points), len(speeds_Hz))
    return machines, tuple(reversed(points))


def default_speeds(case: Case, count: int = SPEEDS) -> tuple[float, ...]:
    """Speeds in Hz, greater than zero, that sweep the range of the case."""
    low, high = sorted((case.speed.start, case.speed.end))
    if low > 0.0:
        return tuple(np.unique(np.linspace(low, high, count)).tolist())
    return tuple(np.linspace(0.0, high, count + 1)[1:].tolist()) if high > 0.0 else ()


def eigenvalues(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Eigenvalues:
    """(2 n,) eigenvalues in 1/s of the rotor at omega rad/s on bearings of stiffness and damping (films, 2, 2).

    Ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    """
    values = np.linalg.eigvals(state_matrix(rotor, omega, stiffness, damping)).astype(complex)
    # frequencies that are equal but for round-off are one, and the real parts decide
    frequency = np.abs(values.imag)
    equal = ranks(frequency, float(np.max(np.abs(values))))
    return values[np.lexsort((-values.imag, frequency, values.real, equal))]


def _point(
    case: Case, machines: StaticMachines, speed: float, near: MachineAtRest | None
) -> tuple[StabilityPoint, MachineAtRest | None]:
    """The point at a speed in Hz, sought from the machine `near`, and that from which to seek the next one."""
    try:
        with advised(case):
            machine = machines.at(2 * math.pi * speed, near)
            return _at_rest(machine, speed), machine
    except NotConverged as error:
        return StabilityPoint(speed, (), np.zeros(0, dtype=complex), str(error)), near


def _at_rest(machine: MachineAtRest, speed: float) -> StabilityPoint:
    """The point at a speed in Hz of a machine that rests."""
    system, films = machine.system, machine.films
    stiffness, damping = coefficients_of(films)
    values = eigenvalues(without_spins(system.rotor, system.ring_count), machine.omega, stiffness, damping)
    rings = tuple((machine.at_rest.ring_speeds / (2 * math.pi)).tolist())
    return StabilityPoint(speed, films, values, ring_speeds_Hz=rings, warm=machine.warm)


def _threshold(case: Case, machines: StaticMachines, sweep: Sequence[StabilityPoint]) -> tuple[Threshold | None, str]:
    """The lowest speed at which the growth passes zero from below; a note where there is none, or where the rotor
    becomes stable once more."""
    resting = [point for point in sweep if point.rests]
    if not resting:
        return None, "No threshold: there is no resting position in the whole range of speeds."
    slowest, fastest = resting[0], resting[-1]
    if len(resting) == 1:
        return None, _one_speed(slowest, len(sweep))
    if slowest.growth > 0.0:
        unstable = "Unstable from the lowest speed on: a threshold, if there is one, lies below"
        beyond = "" if slowest is sweep[0] else " Below it there is no resting position."
        return None, f"{unstable} {slowest.speed_Hz:.4g} Hz.{beyond}{_stable_again(resting)}"
    for place, (below, above) in enumerate(itertools.pairwise(resting)):
        if above.growth > 0.0:
            threshold, problem = _crossing(case, machines, below.speed_Hz, above.speed_Hz)
            return threshold, problem + _stable_again(resting[place + 1 :])
    return None, f"Stable up to the highest speed: a threshold, if there is one, lies above {fastest.speed_Hz:.4g} Hz."


def _one_speed(point: StabilityPoint, tried: int) -> str:
    """Why a single speed has no threshold."""
    speed, found = f"{point.speed_Hz:.4g} Hz", "a motion grows" if point.growth > 0.0 else "every motion decays"
    if tried > 1:
        return f"No threshold: the journals rest at one of {tried} speeds only, {speed}, where {found}."
    return (
        f"No threshold is sought: there is one speed only, {speed}, where {found}. "
        "Widen the range of speed.from and speed.to."
    )


def _stable_again(points: Sequence[StabilityPoint]) -> str:
    """Where no motion grows any more, of points that begin with an unstable one."""
    stable = [point.speed_Hz for point in points if point.growth <= 0.0]
    if not stable:
        return ""
    return f" No motion grows at {len(stable)} higher speeds, from {stable[0]:.4g} to {stable[-1]:.4g} Hz."


def _crossing(case: Case, machines: StaticMachines, low: float, high: float) -> tuple[Threshold | None, str]:
    """The threshold between two speeds in Hz."""
    from scipy.optimize import brentq  # runs, which need eigenvalues alone, need not wait for its import

    def at(speed: float) -> StabilityPoint:
        return _at_rest(machines.at(2 * math.pi * speed, with_error=False), speed)

    try:
        with advised(case):
            speed = brentq(lambda s: at(s).growth, low, high, xtol=THRESHOLD_TOLERANCE * low, rtol=THRESHOLD_TOLERANCE)
            return Threshold(speed, at(speed).critical.imag / (2 * math.pi)), ""
    except NotConverged as error:
        return None, f"A threshold lies between {low:.4g} and {high:.4g} Hz, but was not found: {error}"


def _without_coefficients(case: Case) -> list[Fault]:
    """The faults of films that eight coefficients do not describe."""
    faults = []
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and coupled(bearing):
            problem = "couples the two films of a ring: neither has coefficients of its own."
            key = f"{bearing_key(case, index)}.channels"
            faults.append(Fault(key, "coupled", None, problem, 'Write channels = "pressure" here.'))
    problem = "is mass-conserving: eight coefficients per speed do not determine stability."
    remedy = "Take half-sommerfeld, reynolds or penalty here, and a run-up for this model."
    named = dict(cavitation_keys(case))
    faults += [Fault(key, name, None, problem, remedy) for key, name in named.items() if law_named(name).keeps_oil]
    return faults


def _check_speeds(case: Case, speeds: Sequence[float]) -> None:
    if not speeds:
        given, problem = f"{case.speed.end:g} Hz", "leaves no speed above zero."
        remedy = 'Write e.g. speed.to = "300 Hz", or ask for a speed, "25 Hz".'
        raise InputError(case.name or "case", (Fault("speed.to", given, None, problem, remedy),))
    wrong = [speed for speed in speeds if not (math.isfinite(speed) and speed > 0.0)]
    if wrong:
        faults = [Fault("speed", f"{s:g} Hz", None, "must be greater than 0.", 'Write e.g. "25 Hz".') for s in wrong]
        raise InputError(case.name or "case", tuple(faults))
