"""Natural frequencies and shapes of a rotor, free or on isotropic springs, over its speed.

The rotor is undamped and not reduced; bearings are springs, without any film.

The undamped critical speed map: critical speeds of a rotor over the stiffness of its bearings. With equal stiffness in
all directions a whirl has one complex coordinate, and at a rotor speed that equals its frequency the equation of the
rotor becomes

    k u = omega^2 (m - g) u forward,      k u = omega^2 (m + g) u backward,

m, g and k being mass, gyroscopic term and stiffness of one plane. Rings are left out: a bearing is one spring.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Column, Table, Tabular, named, spread_table, table_of
from frbcli.elements.coefficients import GivenCoefficients
from frbcli.errors import Fault
from frbcli.linear.columns import NATURAL_MODES, SPEED
from frbcli.rotor.assembly import Link, assembled
from frbcli.rotor.loads import first_largest, ranks
from frbcli.rotor.reduction import FreeModes, Reduction, ReductionError, whirl_modes
from frbcli.scene.films import bearing_springs
from frbcli.scene.gate.gate import require
from frbcli.scene.machine.findings import findings
from frbcli.scene.machine.rotor import element_springs, first_without_film, support_faults
from frbcli.scene.machine.turbocharger import shaft_of

if TYPE_CHECKING:
    from frbcli.equilibrium.linearised import RestingFilm
    from frbcli.linear.stability_point import StabilityPoint

SPEEDS = 25  # of the default sweep
SHOWN = 4  # slowest modes of each direction
NO_STIFFNESS = 1e-9  # direct over largest stiffness of a film that is round-off
TINY = 1e-300  # N/m
RIGID_SHARE = 0.5  # of the kinetic energy, from which on a motion counts as rigid-body motion


@dataclass(frozen=True)
class Mode:
    """direction: "forward" | "backward" whirl; kind: "conical" | "cylindrical" | "bending"; shape: (k,) deflection
    along the shaft, the largest 1."""

    frequency_Hz: float
    direction: str
    kind: str
    shape: Array


@dataclass(frozen=True)
class ModesAtSpeed:
    """The slowest modes of each direction at a rotor speed, ascending in frequency; still: motions of a rigid body that
    nothing holds, of 0 Hz, which are none of them."""

    speed_Hz: float
    modes: tuple[Mode, ...]
    still: int = 0

    def directed(self, direction: str) -> tuple[Mode, ...]:
        """The "forward" or "backward" modes."""
        return tuple(mode for mode in self.modes if mode.direction == direction)


@dataclass(frozen=True, repr=False)
class Modes(Tabular):
    """Modes over speed.

    stiffness_N_m: of each bearing, those with a film first, at the highest speed; empty for the free rotor;
    positions_m: (k,) along the shaft; bearings, disks: names and positions in m; free_Hz: slowest bending frequencies
    of the free rotor at rest; kept: modes of each plane after the reduction of the case; error: what it leaves out at
    the highest speed, None for the free rotor.
    """

    case: Case
    stiffness_N_m: tuple[float, ...]
    positions_m: Array
    bearings: tuple[tuple[str, float], ...]
    disks: tuple[tuple[str, float], ...]
    mass_kg: float
    free_Hz: tuple[float, ...]
    kept: int
    points: tuple[ModesAtSpeed, ...]
    error: ReductionError | None

    def table(self) -> Table:
        """One row per mode."""
        columns = *named((SPEED,), "", itemgetter(0)), *named(NATURAL_MODES, "", itemgetter(1))
        return table_of(columns, ((point, mode) for point in self.points for mode in point.modes))


def natural_modes(
    case: Case,
    stiffness: float | Sequence[float] | Literal["bearings"] | None = None,
    speeds_Hz: Sequence[float] | None = None,
) -> Modes:
    """Compute the undamped natural modes of a rotor, without bearings or on springs.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    stiffness : float or sequence of float or "bearings", optional
        Stiffness in N/m of each bearing with a film, or of all alike, the same in all directions. Bearings of given
        coefficients are springs of their own, but where no bearing has a film the stiffness replaces them; "bearings"
        takes theirs. None leaves the rotor free, and its rings are apart.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz; by default from standstill to the highest speed of the case.

    Returns
    -------
    Modes
        Frequencies in Hz and shapes at each speed.

    Raises
    ------
    InputError
        With a stiffness: if bearings have supports, or balls beside films, if it is not greater than 0, or if there are
        not as many as bearings; with "bearings" if these have films, balls or a stiffness that differs with the
        direction. If a speed is negative.

    Examples
    --------
    >>> import frbcli
    >>> modes = frbcli.natural_modes(frbcli.load_case("turbocharger-car"), 1e7)  # doctest: +SKIP
    """
    require(case)
    if stiffness is not None:
        _check_held(case)
    if stiffness == "bearings":
        _check_own(case)
        stiffness = []
    shaft = shaft_of(case)
    speeds = np.linspace(0.0, max(case.speed.start, case.speed.end), SPEEDS) if speeds_Hz is None else speeds_Hz
    springs = _springs(case, stiffness)
    _check(case, springs, speeds)
    modes, reduced = shaft.free_modes(), shaft.reduction
    held = np.zeros((0, len(modes.frequencies))) if stiffness is None else shaft.held
    bending = modes.frequencies[modes.frequencies > 0.0]
    bearings, disks = _places(case, modes)

    def on(omega: float) -> Array:
        """(b,) N/m of all bearings."""
        if stiffness is None:
            return springs
        return np.concatenate([springs, element_springs(case, omega)[max(0, len(springs) - len(case.bearings)) :]])

    omega = 2 * math.pi * np.asarray(speeds, dtype=np.float64)
    top = float(np.max(omega))
    return Modes(
        case,
        tuple(on(top)[: len(case.placed_bearings)].tolist()),
        modes.positions,
        bearings,
        disks,
        shaft.mass,
        tuple((bending[:SHOWN] / (2 * math.pi)).tolist()),
        len(modes.frequencies if reduced is None else reduced.modes.frequencies),
        tuple(_at_speed(modes, held, on(float(value)), value) for value in omega),
        shaft.free().reduction_error(on(top), top) if len(held) and reduced is not None else None,
    )


def _places(case: Case, modes: FreeModes) -> tuple[tuple[tuple[str, float], ...], tuple[tuple[str, float], ...]]:
    """Names and positions of bearings and of disks, on a symmetric rotor over its length."""
    if case.rotor.symmetric:
        middle = (("disk", 0.5),) if len(modes.positions) > 2 else ()
        return (("bearing", 0.0), ("bearing", 1.0)), middle
    disks = ((disk.name or str(number), disk.position) for number, disk in enumerate(case.disks, start=1))
    return tuple((each.name, each.position or 0.0) for each in case.placed_bearings), tuple(disks)


def film_springs(case: Case, films: Sequence[RestingFilm]) -> tuple[float, ...]:
    """Isotropic stiffness in N/m of each bearing of a case out of its films at rest: the mean of both directions, in
    series where a ring floats between two films. Cross stiffness is left out: it excites a whirl and carries no load.
    Empty where a bearing has none, see direct_springs, and without films."""
    springs = direct_springs(case, films)
    return () if any(map(math.isnan, springs)) else springs


def direct_springs(case: Case, films: Sequence[RestingFilm]) -> tuple[float, ...]:
    """As film_springs; NaN for a bearing with a film without direct stiffness, such as a full film in its centre."""
    means = [0.5 * float(np.trace(film.stiffness)) for film in films]
    sizes = [float(np.abs(film.stiffness).max()) for film in films]
    some = [mean if mean > NO_STIFFNESS * size else math.nan for mean, size in zip(means, sizes, strict=True)]
    return bearing_springs(case, some)


def own_reduction(case: Case, points: Sequence[StabilityPoint]) -> Reduction | None:
    """The reduction of a shaft with its changes on the bearings of its case: given coefficients and films at rest, at
    the slowest, the middle and the fastest of some speeds. The stiffness of a film is its largest in any direction,
    which counts the cross-coupled one. On bearings of any stiffness where none is known; None for a shaft that is not
    reduced."""
    shaft = shaft_of(case)
    if shaft.reduction is None:
        return None
    free, known = shaft.free(), [point for point in points if point.rests and len(point.films) >= len(case.films)]
    top = 2.0 * math.pi * max([point.speed_Hz for point in points], default=0.0)
    reductions: list[Reduction] = []
    for point in {id(each): each for each in (*known[:1], *known[len(known) // 2 :][:1], *known[-1:])}.values():
        sizes = bearing_springs(case, [max(float(np.linalg.norm(film.stiffness, 2)), TINY) for film in point.films])
        springs = np.concatenate([sizes, element_springs(case, 2.0 * math.pi * point.speed_Hz)])
        each = free.reduced_on(springs[: len(free.journals)], top)
        if not math.isnan(each.frequency):
            reductions.append(each)
    if not reductions:
        return shaft.reduction
    frequency, amplitude = max(each.frequency for each in reductions), max(each.amplitude for each in reductions)
    own = "the stiffness of its own bearings"
    return replace(shaft.reduction, frequency=frequency, amplitude=amplitude, bearings=own)


def _springs(case: Case, stiffness: float | Sequence[float] | None) -> Array:
    """(b,) N/m of the bearings with films, or of all where none has one; empty for a free rotor, or on its own."""
    given = [] if stiffness is None else [stiffness] if isinstance(stiffness, int | float) else list(stiffness)
    count = len(case.bearings or case.elements)
    if len(given) == 1:
        given *= count
    if len(given) not in (0, count):
        fault = Fault("stiffness", f"{len(given)} values", None, "are not as many as bearings.", "Give one for each.")
        raise case.refused(fault)
    return np.array(given, dtype=np.float64)


def _check_held(case: Case) -> None:
    """Raises InputError where the bearings of a case have supports."""
    what = "these are the modes of a shaft on springs to the ground"
    remedy = "Leave the stiffness out, or take the damped modes, frb stability --shapes SPEED, which have supports."
    if faults := support_faults(case, what, remedy):
        raise case.refused(*faults)
    if case.bearings:  # the stiffness is of these alone
        _check_springs(case, ("ball",), "Take the damped modes, frb stability --shapes SPEED.")


def _check_springs(case: Case, kinds: Sequence[str], remedy: str) -> None:
    """Raises InputError where bearings of a case are of these kinds, which are no springs."""
    for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
        if bearing.kind in kinds:
            what = "balls" if bearing in case.elements else "films"
            problem = f"has {what}, whose stiffness follows from the static equilibrium."
            raise case.refused(Fault(f"{key}.kind", bearing.kind, None, problem, remedy))


def _check_own(case: Case) -> None:
    """Raises InputError where the bearings of a case are no springs that are the same in all directions."""
    remedy = "Take the damped modes, frb stability --shapes SPEED, or give a stiffness."
    _check_springs(case, ["ball", *(bearing.kind for bearing in case.bearings)], remedy)
    for element in GivenCoefficients.of(case):
        k = element.linear.stiffness
        if not np.allclose(k, 0.5 * np.trace(k, axis1=1, axis2=2)[:, None, None] * np.eye(2), rtol=1e-9):
            problem = "differs with the direction or is cross-coupled: natural modes are those on isotropic springs."
            raise case.refused(Fault(f"{element.key}.stiffness", "", None, problem, remedy))


def _at_speed(modes: FreeModes, springs: Array, stiffness: Array, omega: float) -> ModesAtSpeed:
    whirls = whirl_modes(modes, springs, stiffness, omega)
    shown: list[Mode] = []
    for sign, direction in ((1, "forward"), (-1, "backward")):
        for index in np.flatnonzero(whirls.frequencies * sign > 0)[:SHOWN]:
            coordinates = whirls.coordinates[:, index]
            shape = modes.shapes @ coordinates
            frequency = abs(float(whirls.frequencies[index])) / (2 * math.pi)
            kind = _kind(modes.frequencies, coordinates, shape)
            shown.append(Mode(frequency, direction, kind, shape / shape[first_largest(shape)]))
    frequencies = ranks(np.array([mode.frequency_Hz for mode in shown]))  # forward before backward where both are equal
    still = 2 * len(modes.frequencies) - len(whirls.frequencies)
    ordered = tuple(shown[i] for i in np.argsort(frequencies, kind="stable"))
    return ModesAtSpeed(omega / (2 * math.pi), ordered, still)


def _kind(frequencies: Array, coordinates: Array, shape: Array) -> str:
    """The kind of a motion of unit length in free modes with these frequencies and this shape; a conical one has a node
    on the shaft."""
    rigid = coordinates[frequencies == 0.0]
    if rigid @ rigid < RIGID_SHARE:
        return "bending"
    return "conical" if shape.min() < 0 < shape.max() else "cylindrical"


def _check(case: Case, springs: Array, speeds: Sequence[float] | Array) -> None:
    faults = [
        Fault("stiffness", f"{spring:g} N/m", None, "must be greater than 0.", 'Write e.g. "5e6 N/m".')
        for spring in springs
        if not (math.isfinite(spring) and spring > 0)
    ]
    if not len(speeds):
        faults.append(Fault("speed", "", None, "is missing.", 'Write e.g. "350 Hz".'))
    faults += [
        Fault("speed", f"{speed:g} Hz", None, "must be at least 0.", 'Write e.g. "350 Hz".')
        for speed in speeds
        if not (math.isfinite(speed) and speed >= 0)
    ]
    if faults:
        raise case.refused(*faults)


STIFFNESSES = 61
DECADES = (-3.0, 2.0)  # about the stiffness on which the rotor as a rigid mass has its highest speed as frequency


def _nth(direction: str, number: int) -> Callable[[Any], Array]:
    return lambda criticals: np.asarray(getattr(criticals, direction)[:, number])


# Of a CriticalMap, over the stiffness
CRITICAL_SPEEDS = (
    Column("stiffness", "N/m", "stiffness of every bearing"),
    *(Column(f"{direction}_{number + 1}", "Hz", f"critical speed of a {direction} whirl", _nth(direction, number))
      for direction in ("forward", "backward") for number in range(SHOWN)),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class CriticalMap(Tabular):
    """stiffness: (k,) N/m of every bearing; forward, backward: (k, SHOWN) Hz, ascending, NaN where there are fewer;
    films: (speeds in Hz, stiffness in N/m of each bearing (n, b)) of the films of the case at rest, empty if they are
    not known, NaN for a bearing without direct stiffness: where a curve of a film crosses one of the map, the rotor has
    a critical speed."""

    case: Case
    stiffness: Array
    forward: Array
    backward: Array
    film_speeds_Hz: Array
    film_stiffness: Array

    def table(self) -> Table:
        """One row per stiffness."""
        return spread_table(CRITICAL_SPEEDS, self)


def critical_map(
    case: Case, stiffness: Sequence[float] | None = None, resting: Sequence[StabilityPoint] = ()
) -> CriticalMap:
    """Map the undamped critical speeds of a rotor over the stiffness of its bearings.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    stiffness : sequence of float, optional
        Stiffness in N/m of each bearing, above 0; by default over several decades.
    resting : sequence of StabilityPoint
        Points of `stability`, for the stiffness of the films.

    Returns
    -------
    CriticalMap
        Critical speeds in Hz at each stiffness.

    Raises
    ------
    InputError
        If a stiffness is not positive.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.critical_map(frbcli.load_case("turbocharger-car"), [1e6, 1e7])  # doctest: +SKIP
    """
    require(case)
    if case.elements:
        problem = "has coefficients of its own, and the map is of a rotor on springs of one stiffness."
        key, kind = first_without_film(case)
        remedy = "Leave --map out: the response has its own peaks."
        raise case.refused(Fault(key, kind, None, problem, remedy))
    on_ground = "the map is of a rotor on springs to the ground"
    if faults := support_faults(case, on_ground, "Leave --map out: the response has its own peaks."):
        raise case.refused(*faults)
    given = _default(case) if stiffness is None else np.array(sorted(stiffness), dtype=np.float64)
    if not len(given) or not (np.isfinite(given).all() and given[0] > 0.0):
        raise case.refused(Fault("stiffness", "", None, "must be greater than 0.", 'Write e.g. "5e6 N/m".'))
    plane = _plane(case)
    forward, backward = (np.array([_criticals(plane, k, sign) for k in given]) for sign in (-1.0, 1.0))
    known = [(point.speed_Hz, direct_springs(case, point.films)) for point in resting if point.rests and point.films]
    films = [(speed, springs) for speed, springs in known if not all(map(math.isnan, springs))]
    speeds, springs = np.array([speed for speed, _ in films]), np.array([each for _, each in films])
    return CriticalMap(case, given, forward, backward, speeds, springs.reshape(len(speeds), len(case.bearings)))


def _default(case: Case) -> Array:
    top = 2.0 * math.pi * max(case.speed.top, 1.0)
    usual = (findings(case).mass or 1.0) * top**2 / 2.0
    return np.asarray(usual * np.logspace(*DECADES, STIFFNESSES), dtype=np.float64)


def _plane(case: Case) -> tuple[Array, Array, Array, Array]:
    """Mass, gyroscopic term, stiffness of the rotor without rings and damping, with all its modes, and the stiffness of
    springs of 1 N/m in all bearings, (n, n) of one plane."""
    shaft = shaft_of(case)
    films = [Link(shaft.journal(bearing.name), count=float(shaft.equal_bearings)) for bearing in case.bearings]
    rotor = assembled([shaft.undamped_body()], films)
    n = rotor.size // 2
    bearings = rotor.multiplicity[:, None, None] * np.swapaxes(rotor.journals, 1, 2)
    springs = (bearings @ rotor.journals).sum(axis=0)
    return rotor.mass[:n, :n], rotor.gyroscopic[:n, n:], rotor.stiffness[:n, :n], springs[:n, :n]


def _criticals(plane: tuple[Array, Array, Array, Array], stiffness: float, sign: float) -> Array:
    """(SHOWN,) Hz; sign: of g in the equation above."""
    from scipy.linalg import eigh

    mass, gyroscopic, own, springs = plane
    n = len(mass)
    largest = (max(n - SHOWN, 0), n - 1)  # of 1 / omega^2: the slowest
    k = own + stiffness * springs
    inverse = eigh(mass + sign * gyroscopic, k, eigvals_only=True, subset_by_index=largest)[::-1]
    speeds = 1.0 / (2.0 * math.pi * np.sqrt(inverse[inverse > 0.0]))
    return np.asarray(np.append(speeds, np.full(SHOWN, np.nan))[:SHOWN], dtype=np.float64)
