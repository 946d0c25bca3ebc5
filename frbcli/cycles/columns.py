"""The columns of limit cycles: static equilibria, cycles, whirls with unbalance, special points and maps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import attrgetter, itemgetter
from typing import Any

from frbcli.columns import Column, Shown, named, speed_shown, uncertain_speed
from frbcli.cycles.result import SPEED, CyclePoint, RestingPoint, SpecialPoint, UnbalancedWhirl
from frbcli.units import with_uncertainty

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
                   lambda point: True if isinstance(point, UnbalancedWhirl) else None)  # fmt: skip
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
            Column("kind", "", "of a special point, or `asked`; `locked` of a whirl with unbalance", _kind),
        ),
        *(column for quantity, unit, meaning, at_rest in per_film for film, name in enumerate(films)
          for column in of_point(Column(quantity.replace("temperatures_K", "temperature"), unit, meaning,
                                        _number(quantity, film, at_rest)), film=name if len(films) > 1 else "")),
        *of_point(
            *(Column(f"ring_speed_{ring}", "Hz", "mean speed of a ring", _number("ring_speeds_Hz", ring))
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


def _kind(point: RestingPoint | CyclePoint | UnbalancedWhirl) -> str:
    if isinstance(point, UnbalancedWhirl):
        return "locked"
    return point.kind if isinstance(point, CyclePoint) else ""


def _number(name: str, place: int | None = None, at_rest: str = "") -> Callable[[Any], float]:
    """A number of a point by its name, and place in an array; NaN where the point has none. at_rest: its name in a
    RestingPoint, if that is another."""

    def value(point: Any) -> float:
        number = getattr(point, at_rest if at_rest and isinstance(point, RestingPoint) else name, None)
        if number is None:
            return math.nan
        return float(number if place is None else number[place])

    return value


def _amplitude(name: str) -> Callable[[Any], float]:
    def value(point: Any) -> float:
        lines = point.lines if isinstance(point, UnbalancedWhirl) else ()
        return next((float(line.amplitude.max()) for line in lines if line.name == name), math.nan)

    return value
