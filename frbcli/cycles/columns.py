"""The columns of limit cycles: static equilibria, cycles, whirls with unbalance, special points and maps.

What `limit_cycles` returns: static equilibria, branches of cycles, special points; frozen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter, itemgetter
from typing import Any, ClassVar

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, named, speed_shown, table_of, uncertain_speed
from frbcli.cycles.method.balance import motion_along
from frbcli.units import with_uncertainty

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
    kind: ClassVar[str] = ""

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
    kind: ClassVar[str] = "locked"


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


MULTIPLIERS = 6  # of a cycle in JSON: the trivial one and the largest others

SPEED_COLUMN = Column("speed", "Hz", "rotor speed")
FREQUENCY = Column("frequency", "Hz", "frequency of the cycle")
STABLE = Column("stable", "", "all disturbances decay")
VALUE = Column("value", "", "value of the varied key", flat=False)
TEMPERATURE = "of a film, with heat"
END_MEANING = "larger one of both ends of tilting films"
RINGS = Column("ring_speeds", "Hz", "mean speeds of the rings", flat=False)
CRITICALITY = Column("criticality", "", "`subcritical` or `supercritical`, of a Hopf point")
LYAPUNOV = Column("lyapunov", "1/s", "first Lyapunov coefficient, of a Hopf point")
FREQUENCY_UNCERTAINTY = Column("frequency_uncertainty", "Hz", "its uncertainty")
DIGITS = 6  # of a value that is varied, in the terminal


def by_film(films: Sequence[str], array: Any) -> dict[str, Any]:
    """The values of an array (F, ...) by the names of the films."""
    return dict(zip(films, array, strict=True))


def _of_films(films: Sequence[str], name: str, unit: str, meaning: str, attribute: str = "") -> Column:
    """Values (F, ...) of a result by film; None where it has none. attribute: of the result, if not `name`."""
    values = attrgetter(attribute or name)

    def by_name(result: Any) -> dict[str, Any] | None:
        array = values(result)
        return None if array is None else by_film(films, array)

    return Column(name, unit, f"{meaning}, by film", by_name, flat=False)


def _largest(films: Sequence[str]) -> Column:
    return _of_films(films, "eccentricity_max", "", "largest eccentricity")


def _largest_uncertainty(films: Sequence[str]) -> Column:
    return _of_films(films, "eccentricity_max_uncertainty", "", "its uncertainty")


def _temperatures(films: Sequence[str], heat: bool) -> tuple[Column, ...]:
    return (_of_films(films, "temperatures", "K", "with heat", "temperatures_K"),) if heat else ()


def _at_ends(films: Sequence[str], name: str, tilts: bool) -> tuple[Column, ...]:
    return (_of_films(films, name, "", END_MEANING),) if tilts else ()


def equilibrium_columns(films: Sequence[str], heat: bool = False, tilts: bool = False) -> tuple[Column, ...]:
    """The columns of a RestingPoint in JSON. heat: whether films have temperatures; tilts: whether journals tilt."""
    return (
        VALUE,
        SPEED_COLUMN,
        Column("displacement", "", "of the first journal over the clearance",
               lambda point: point.displacement[0], flat=False),
        STABLE,
        _of_films(films, "films", "", "displacements", "displacement"),
        RINGS,
        *_temperatures(films, heat),
        *_at_ends(films, "end_eccentricity", tilts),
    )  # fmt: skip


def cycle_columns(films: Sequence[str], heat: bool = False, tilts: bool = False) -> tuple[Column, ...]:
    """The columns of a CyclePoint in JSON. heat: whether films have temperatures; tilts: whether journals tilt."""
    return (
        VALUE,
        SPEED_COLUMN,
        FREQUENCY,
        _largest(films),
        STABLE,
        Column("multipliers", "", "Floquet multipliers (real, imaginary): the trivial one, then the largest",
               lambda point: [[value.real, value.imag] for value in point.multipliers[:MULTIPLIERS].tolist()],
               flat=False),
        RINGS,
        *_temperatures(films, heat),
        Column("torque", "N m", "mean torque against its films"),
        Column("kind", "", "of a special point, or `asked`", lambda p: p.kind or None),
        FREQUENCY_UNCERTAINTY,
        _largest_uncertainty(films),
        *_at_ends(films, "end_eccentricity_max", tilts),
    )  # fmt: skip


def line_columns(films: Sequence[str]) -> tuple[Column, ...]:
    """The columns of a SpectralLine in JSON."""
    return (
        Column("name", "", "such as `Omega / 2`"),
        FREQUENCY,
        _of_films(films, "amplitude", "", "larger semi-axis over the clearance"),
    )  # fmt: skip


def whirl_columns(films: Sequence[str], heat: bool = False) -> tuple[Column, ...]:
    """The columns of an UnbalancedWhirl in JSON, without its lines. heat: whether films have temperatures."""
    return (
        SPEED_COLUMN,
        FREQUENCY,
        Column("locked", "", "true: lock-in at half the speed", lambda _: True),
        _largest(films),
        RINGS,
        *_temperatures(films, heat),
        STABLE,
    )


# Of a MissingWhirl in JSON
MISSING = (SPEED_COLUMN, Column("reason", "", "why no whirl locks in"))


def _other_line(whirl: UnbalancedWhirl) -> str:
    return ", ".join(f"{line.amplitude.max():.2g} at {line.name}" for line in whirl.lines[2:3])


# Of the number of a branch and one of its whirls with unbalance, for the terminal
WHIRLS = (
    Column("branch", "", "number of the branch", lambda item: item[0] + 1, shown=(Shown("branch"),)),
    *named((replace(SPEED_COLUMN, shown=(speed_shown(".2f"),)), replace(FREQUENCY, shown=(Shown("whirl Hz", ".3f"),)),
            Column("eccentricity_max", "", "largest eccentricity", lambda whirl: whirl.eccentricity_max.max(),
                   shown=(Shown("eps max", ".4f"),)),
            Column("at_half", "", "amplitude of the whirl", lambda whirl: whirl.lines[0].amplitude.max(),
                   shown=(Shown("at Omega/2", ".4f"),)),
            Column("at_omega", "", "amplitude at the rotor speed", lambda whirl: whirl.lines[1].amplitude.max(),
                   shown=(Shown("at Omega", ".2g"),)),
            Column("other", "", "largest other line", _other_line, shown=(Shown("largest other line"),))),
           "", itemgetter(1)),
)  # fmt: skip


def _in_last_digits(head: str, digits: int, value: str, uncertainty: Callable[[SpecialPoint], float]) -> Column:
    """A number of a SpecialPoint, for the terminal, with the uncertainty of its last digits. value: its attribute."""
    return Column(value, "", "", lambda point: with_uncertainty(getattr(point, value), uncertainty(point), digits),
                  shown=(Shown(head),), key="", flat=False)  # fmt: skip


def _largest_shown(point: SpecialPoint) -> str:
    film = int(point.eccentricity_max.argmax())
    error = point.eccentricity_max_uncertainty
    return with_uncertainty(float(point.eccentricity_max[film]), None if error is None else float(error[film]), 4)


def special_columns(films: Sequence[str], over: str = SPEED, unit: str = "Hz") -> tuple[Column, ...]:
    """The columns of a SpecialPoint of a diagram over the speed or another number."""
    own, along_speed = attrgetter("value_uncertainty"), over == SPEED
    value = Column("value", "", "", _value_shown, shown=(Shown(unit or over),), key="", flat=False)
    return (
        Column("kind", "", "`hopf`, `fold`, `flip` or `torus`", shown=(Shown("point"),)),
        Column("branch", "", "number from 0; none if not followed"),
        Column("synchronous", "", "of the synchronous response"),
        Column("branch", "", "",
               lambda point: "synchronous" if point.synchronous else None if point.branch is None else point.branch + 1,
               shown=(Shown("branch"),), key="", flat=False),
        VALUE,
        replace(value, value=lambda point: (point.value, own(point)), shown=(uncertain_speed("Hz", 2),))
        if along_speed else value,
        SPEED_COLUMN,
        FREQUENCY,
        _in_last_digits("whirl Hz", 2, "frequency_Hz", attrgetter("frequency_uncertainty_Hz")),
        Column("ratio", "", "frequency over the rotor speed", lambda point: point.frequency_Hz / point.speed_Hz,
               shown=(Shown("ratio", ".4f"),), key="", flat=False),
        _largest(films),
        Column("largest", "", "", _largest_shown, shown=(Shown("eps max"),), key="", flat=False),
        CRITICALITY,
        Column("criticality", "", "", _remark, shown=(Shown(""),), key="", flat=False),
        LYAPUNOV,
        Column("lyapunov_uncertainty", "1/s", "its uncertainty"),
        Column("value_uncertainty", "", "uncertainty of a Hopf point or a fold", flat=False),
        Column("speed_uncertainty", "Hz", "uncertainty over the speed", own if along_speed else lambda _: math.nan),
        FREQUENCY_UNCERTAINTY,
        _largest_uncertainty(films),
        Column("certain", "", "a fold exists on another mesh, too; none if unknown"),
    )  # fmt: skip


def _value_shown(point: SpecialPoint) -> str:
    if math.isnan(point.value_uncertainty):
        return f"{point.value:.{DIGITS}g}"
    before = 1 + math.floor(math.log10(abs(point.value)))
    return with_uncertainty(point.value, point.value_uncertainty, max(DIGITS - before, 0))


def _remark(point: SpecialPoint) -> str:
    return "uncertain" if point.certain is False else point.criticality or ""


def map_point_columns(films: Sequence[str]) -> tuple[Column, ...]:
    """The columns of a MapPoint in JSON."""
    return (
        Column("over_value", "", "value of the first number", attrgetter("over")),
        replace(VALUE, meaning="value of the second number"),
        SPEED_COLUMN,
        FREQUENCY,
        _largest(films),
        CRITICALITY,
        LYAPUNOV,
        Column("kind", "", "`bautin` or `cusp`", lambda point: point.kind or None),
    )


def map_columns(over: str, over_unit: str, key: str, unit: str) -> tuple[Column, ...]:
    """The columns of a map in pandas: of the number of a curve, the curve and one of its points."""
    first = (
        Column(over, "", "value of the first number", lambda item: item[2].over),
        Column("over_unit", "", "its unit", lambda _: over_unit),
    )
    return (
        *(() if over == SPEED else first),
        Column(key, "", "value of the second number", lambda item: item[2].value),
        Column("unit", "", "its unit", lambda _: unit),
        Column("curve", "", "number of the curve, from 0", itemgetter(0)),
        Column("kind", "", "`hopf`, `fold`, `bautin` or `cusp`",
               lambda item: item[2].kind or item[1].kind),
        *named((SPEED_COLUMN, FREQUENCY,
                Column("eccentricity_max", "", "largest of all films",
                       lambda point: float(point.eccentricity_max.max())),
                CRITICALITY, LYAPUNOV), "", itemgetter(2)),
    )  # fmt: skip


def diagram_columns(
    over: str, films: Sequence[str], rings: int, lines: Sequence[str], unbalance: bool, heat: bool = False,
    tilts: bool = False,
) -> tuple[Column, ...]:  # fmt: skip
    """The columns of a diagram in pandas: of the number of a branch, -1 for none, and one of its points.

    over: the number that is varied; films: their names; rings: their number; lines: names of the spectral lines of
    whirls with unbalance; unbalance: whether there are any; heat: whether films have temperatures; tilts: whether
    journals tilt. """
    value = Column(over, "", "value of the varied key", _number("value"))
    whirl = Column("unbalance", "", "true: whirl with unbalance",
                   lambda point: True if point.kind == "locked" else None)  # fmt: skip
    per_film = [
        ("eccentricity_max", "", "largest eccentricity", "eccentricity"),
        ("eccentricity_max_uncertainty", "", "uncertainty of a cycle", ""),
        *([("end_eccentricity_max", "", END_MEANING, "end_eccentricity")] if tilts else []),
        *([("temperatures_K", "K", TEMPERATURE, "")] if heat else []),
    ]

    def of_point(*columns: Column, film: str = "") -> tuple[Column, ...]:
        return named(columns, film, itemgetter(1))

    return (
        *of_point(*(() if over == SPEED else (value,))),
        Column("branch", "", "number from 0; -1 of a static equilibrium", itemgetter(0)),
        *of_point(
            SPEED_COLUMN,
            replace(FREQUENCY, value=_number("frequency_Hz")),
            STABLE,
            Column("kind", "", "of a special point, or `asked`; `locked` of a whirl with unbalance"),
        ),
        *(column for quantity, unit, meaning, at_rest in per_film for film, name in enumerate(films)
          for column in of_point(Column(quantity.replace("temperatures_K", "temperature"), unit, meaning,
                                        _number(quantity, at_rest, place=film)), film=name if len(films) > 1 else "")),
        *of_point(
            *(Column(f"ring_speed_{ring}", "Hz", "mean speed of a ring", _number("ring_speeds_Hz", place=ring))
              for ring in range(rings)),
            Column("torque", "N m", "mean torque of a cycle against its films",
                   _number("torque_N_m")),
            Column(*(("speed_uncertainty", "Hz") if over == SPEED else ("value_uncertainty", "")),
                   "uncertainty of a fold", _number("value_uncertainty")),
            Column("frequency_uncertainty", "Hz", "uncertainty of a cycle",
                   _number("frequency_uncertainty_Hz")),
            *([whirl] if unbalance else []),
            *(Column(f"amplitude of {line}", "", "line amplitude over the clearance, of the film "
                                                 "where it is largest", _amplitude(line)) for line in lines),
        ),
    )  # fmt: skip


def _number(*names: str, place: int | None = None) -> Callable[[Any], float]:
    """A number of a point by the first of its names that the point knows, and place in an array; NaN where the point
    has none."""

    def value(point: Any) -> float:
        number = next((getattr(point, name) for name in names if hasattr(point, name)), None)
        if number is None:
            return math.nan
        return float(number if place is None else number[place])

    return value


def _amplitude(name: str) -> Callable[[Any], float]:
    def value(point: Any) -> float:
        lines = (line for line in getattr(point, "lines", ()) if line.name == name)
        return next((float(line.amplitude.max()) for line in lines), math.nan)

    return value
