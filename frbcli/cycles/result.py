"""What `limit_cycles` returns: static equilibria, branches of cycles, special points; frozen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, table_of
from frbcli.cycles.method.balance import motion_along

SPEED = "speed"  # what diagrams go over
SUBCRITICAL, SUPERCRITICAL = "subcritical", "supercritical"


def hertz(omega: float) -> float:
    """An angular speed in rad/s as a frequency in Hz."""
    return float(omega) / (2.0 * math.pi)


@dataclass(frozen=True)
class RestingPoint:
    """A static equilibrium. value: of the number that the diagram goes over; displacement: (F, 2) of the journals over
    the clearance; ring_speeds_Hz: (R,); eigenvalues: (N,) 1/s; stable: whether all of them decay; temperatures_K: (F,)
    of the films, empty without heat; end_eccentricity: (F,) the larger one of both ends, empty of films that do not
    tilt."""

    value: float
    speed_Hz: float
    displacement: Array
    ring_speeds_Hz: Array
    eigenvalues: Complex
    stable: bool
    temperatures_K: Array = field(default_factory=lambda: np.zeros(0))
    end_eccentricity: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def eccentricity(self) -> Array:
        """(F,)."""
        return np.asarray(np.hypot(self.displacement[:, 0], self.displacement[:, 1]))


@dataclass(frozen=True)
class CyclePoint:
    """A limit cycle. value: of the number that the diagram goes over; speed_Hz: of the rotor; frequency_Hz: of the
    cycle; eccentricity_max: (F,); ring_speeds_Hz: (R,) mean; torque_N_m: mean, that turns the rotor against its films;
    stable: whether all disturbances decay; multipliers: (N,) the trivial one first, then by falling size; harmonics: (H
    + 1, F, 2) complex, of the displacements over the clearance; kind: "", the kind of a special point, or "asked" at a
    speed that was asked for; temperatures_K: (F,) of the films, empty without heat; value_uncertainty: of a fold;
    frequency_uncertainty_Hz, eccentricity_max_uncertainty (F,): by the mesh of the films, at the same value, NaN where
    no such cycle was found on films of another mesh; the latter is None if none was sought; end_eccentricity_max: (F,)
    the larger one of both ends, empty of films that do not tilt. """

    value: float
    speed_Hz: float
    frequency_Hz: float
    eccentricity_max: Array
    ring_speeds_Hz: Array
    torque_N_m: float
    stable: bool
    multipliers: Complex
    harmonics: Complex
    kind: str = ""
    temperatures_K: Array = field(default_factory=lambda: np.zeros(0))
    value_uncertainty: float = math.nan
    frequency_uncertainty_Hz: float = math.nan
    eccentricity_max_uncertainty: Array | None = None
    end_eccentricity_max: Array = field(default_factory=lambda: np.zeros(0))

    def orbit(self, film: int = 0, count: int = 360) -> Array:
        """(count, 2) displacements of a journal over the clearance, at equal moments of a period."""
        count = max(count, 2 * len(self.harmonics))
        return motion_along(self.harmonics[:, film], count)[0]


@dataclass(frozen=True)
class SpectralLine:
    """A harmonic of a motion with unbalance. name: such as "Omega / 2" of the whirl, "Omega" of the rotor or
    "3 Omega / 2"; amplitude: (F,) half the longer axis of its ellipse over the clearance."""

    name: str
    frequency_Hz: float
    amplitude: Array


@dataclass(frozen=True)
class UnbalancedWhirl:
    """A whirl that has locked in with the unbalance, at half the speed. speed_Hz: of the rotor; frequency_Hz: of the
    whirl; eccentricity_max: (F,); ring_speeds_Hz: (R,) mean; lines: of whirl and unbalance, then the largest others;
    stable: whether all disturbances decay; temperatures_K: (F,) of the films, empty without heat."""

    speed_Hz: float
    frequency_Hz: float
    eccentricity_max: Array
    ring_speeds_Hz: Array
    lines: tuple[SpectralLine, ...]
    stable: bool
    temperatures_K: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class MissingWhirl:
    """A speed with a stable cycle at which no whirl locks in with the unbalance. reason: without a full stop."""

    speed_Hz: float
    reason: str


@dataclass(frozen=True)
class CycleBranch:
    """Cycles in their order from a Hopf point on. start: its number among the special points, None where the Hopf point
    lies outside of the range; note: why it ends; with_unbalance: what some of the stable ones lock in with, if asked
    for; missing: the ones that do not lock in."""

    start: int | None
    points: tuple[CyclePoint, ...]
    note: str
    with_unbalance: tuple[UnbalancedWhirl, ...] = ()
    missing: tuple[MissingWhirl, ...] = ()


@dataclass(frozen=True)
class SpecialPoint:
    """kind: "hopf", "fold", "flip" or "torus"; branch: number of the branch, None if none was followed from a Hopf
    point; value: of the number that the diagram goes over; criticality: of a Hopf point, None of others and where it is
    uncertain, with lyapunov and its uncertainty (1/s, for an amplitude over the clearance): Re c_1 of equilibria.py;
    eccentricity_max: (F,); value_uncertainty, frequency_uncertainty_Hz: of the value of Hopf points and folds and of
    the frequency, by the mesh of the films; eccentricity_max_uncertainty: of cycles, see CyclePoint; certain: whether a
    fold was found on films of another mesh, None of others and where it was not sought; synchronous: whether it is of
    the synchronous response. """

    kind: str
    branch: int | None
    value: float
    speed_Hz: float
    frequency_Hz: float
    eccentricity_max: Array
    criticality: str | None = None
    lyapunov: float = math.nan
    lyapunov_uncertainty: float = math.nan
    value_uncertainty: float = math.nan
    frequency_uncertainty_Hz: float = math.nan
    eccentricity_max_uncertainty: Array | None = None
    certain: bool | None = None
    synchronous: bool = False


@dataclass(frozen=True)
class Cost:
    """cpu_s: of all; cycles: how many were computed."""

    cpu_s: float
    cycles: int


@dataclass(frozen=True, repr=False)
class LimitCycles(Tabular):
    """The diagram of a case. over, unit: what it goes over, "speed" in Hz or a key of the case; films: their names;
    notes: what is to be said of it; synchronous: the nonlinear response to the unbalance, descending in speed."""

    case: Case
    over: str
    unit: str
    films: tuple[str, ...]
    equilibria: tuple[RestingPoint, ...]
    branches: tuple[CycleBranch, ...]
    special: tuple[SpecialPoint, ...]
    notes: tuple[str, ...]
    cost: Cost
    synchronous: tuple[CyclePoint, ...] = ()

    @property
    def tilts(self) -> bool:
        """Whether the journals tilt in their films."""
        return any(len(point.end_eccentricity) for point in self.equilibria)

    def of(self, kind: str) -> tuple[SpecialPoint, ...]:
        """The special points of a kind, except on the synchronous response."""
        return tuple(point for point in self.special if point.kind == kind and not point.synchronous)

    def table(self) -> Table:
        """One row per static equilibrium and cycle, and per whirl with unbalance, if they were asked for."""
        from frbcli.cycles.columns import diagram_columns  # of what is declared here

        numbered = list(enumerate(self.branches))
        whirls = [(number, whirl) for number, branch in numbered for whirl in branch.with_unbalance]
        rows: list[tuple[int, object]] = [(-1, point) for point in self.equilibria]
        rows += [(number, point) for number, branch in numbered for point in branch.points]
        rings = max((len(point.ring_speeds_Hz) for point in self.equilibria), default=0)
        lines = list(dict.fromkeys(line.name for _, whirl in whirls for line in whirl.lines))
        columns = diagram_columns(
            self.over, self.films, rings, lines, bool(whirls), self.case.heat is not None, self.tilts
        )
        return table_of(columns, [*rows, *whirls])
