"""Linear stability: static equilibria, coefficients of the films, and eigenvalues.

In its static equilibrium films and shaft carry the static load of the rotor. Linearised there, each film is a stiffness
K = -dF/dD and a damping D = -dF/dD' per bearing, and the rotor has 2 n eigenvalues: a positive real part is a motion
that grows. Films that keep oil are linearised together with it (dynamic_films.py); K and D are then those at the
frequency of the least damped whirl. The threshold is the lowest speed at which one of the oscillating motions, a whirl,
begins to grow. """

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter

import numpy as np

from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, named, table_of
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.errors import Fault, NotConverged
from frbcli.linear.columns import AXIAL, film_columns, point_columns
from frbcli.linear.stability_point import (
    StabilityPoint,
    Threshold,
    deciding,
    find_threshold,
    point_at_rest,
    with_errors,
)
from frbcli.scene.course import default_speeds
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import FILMS, RANGE, STABILITY
from frbcli.scene.machine.system import System
from frbcli.scene.supply import advised
from frbcli.units import SpeedUnit

NOT_SOUGHT = "Given speeds alone are computed: --threshold seeks the threshold of stability, too."
SCOUTED = 4  # every which speed is tried on the coarsest mesh
TRIED = 5  # speeds at which rest is sought before it is given up, where there is none at the highest one


@dataclass(frozen=True, repr=False)
class Stability(Tabular):
    """Linear stability of a case.

    points: at the speeds asked for; sweep: at all speeds that were computed, ascending; threshold: None if none lies
    in the swept range or none was sought; note then says why, and where the rotor is stable once more above it.
    """

    case: Case
    points: tuple[StabilityPoint, ...]
    sweep: tuple[StabilityPoint, ...]
    threshold: Threshold | None
    note: str

    def table(self) -> Table:
        """One row per point: speed, static equilibrium and coefficients of each film, critical eigenvalue."""
        films = max((point.films for point in self.points), key=len, default=())
        names = [film.name for film in films]
        axial = named(AXIAL, "collar", attrgetter("axial")) if self.case.loads_a_collar else ()
        return table_of((*point_columns(names, film_columns(films)), *axial), self.points)


def stability(
    case: Case,
    speeds_Hz: Sequence[float] | None = None,
    observe: Callable[[int, int], None] | None = None,
    threshold: bool = False,
) -> Stability:
    """Compute static equilibria, linear coefficients, eigenvalues, and the threshold of stability.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz, above 0, of the points; by default the sweep in which the threshold is sought,
        which is the speed range of the case.
    observe : callable, optional
        Called with each speed's number and their number.
    threshold : bool
        Whether the threshold is sought with given speeds, too; without speeds it always is.

    Returns
    -------
    Stability
        Points and threshold; a speed without a static equilibrium gives a point that says so.

    Raises
    ------
    InputError
        If the case cannot be modelled or a speed is not positive.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.stability(case)
    >>> found.threshold is not None
    True
    """
    require(case, RANGE if speeds_Hz is None else FILMS)
    asked = default_speeds(case) if speeds_Hz is None else tuple(float(speed) for speed in speeds_Hz)
    threshold = threshold or speeds_Hz is None
    _check_speeds(case, asked)
    speeds = sorted(set(default_speeds(case) if threshold else ()) | set(asked))
    check_machine(case, speeds)
    machines = StaticMachines(case, memory=True)
    sweep = _sweep(case, machines, speeds, observe)
    by_speed = {point.speed_Hz: point for point in sweep}
    limit, note = find_threshold(case, machines, sweep) if threshold else (None, NOT_SOUGHT)
    return Stability(case, tuple(by_speed[speed] for speed in asked), sweep, limit, note)


def threshold_alone(case: Case) -> Stability:
    """Threshold only, without errors at the points, of which finite-volume films have fewer, most on the coarsest mesh.
    Raises InputError."""
    require(case, RANGE)
    speeds = default_speeds(case)
    check_machine(case, speeds)
    machines = StaticMachines(case, memory=True)
    sweep = _scouted(case, machines, speeds) or _sweep(case, machines, speeds, with_error=False)
    return Stability(case, sweep, sweep, *find_threshold(case, machines, sweep))


def _scouted(case: Case, machines: StaticMachines, speeds_Hz: Sequence[float]) -> tuple[StabilityPoint, ...]:
    """Points at some of speeds_Hz on the coarsest mesh, of which the ones that decide where the threshold lies are
    replaced by points of `machines`: at every SCOUTED-th speed, and at all where growth may pass zero between these.

    () where this decides nothing: films are not on cells or keep oil, whose eigenvalues scatter from mesh to mesh,
    there is no rest at some speed, or the meshes differ in whether a deciding point is stable.
    """
    if not machines.static.on_cells or machines.system.remembers:
        return ()
    scout = StaticMachines(case, coarse=True)
    points = list(_sweep(case, scout, [*speeds_Hz[:-1:SCOUTED], speeds_Hz[-1]], with_error=False))
    if not all(point.rests for point in points):
        return ()
    known, spans = {point.speed_Hz for point in points}, open_spans(points)
    between = [speed for speed in speeds_Hz if any(low < speed < high for low, high in spans)]
    if untried := [speed for speed in between if speed not in known]:
        points += _sweep(case, scout, untried, with_error=False)
        points.sort(key=lambda point: point.speed_Hz)
    if not all(point.rests for point in points):
        return ()
    near: MachineAtRest | None = None
    for number in deciding(points):
        own, near = _point(case, machines, points[number].speed_Hz, near, None, with_error=False)
        if not own.rests or (own.growth > 0.0) != (points[number].growth > 0.0):
            return ()
        points[number] = own
    return tuple(points)


def open_spans(points: Sequence[StabilityPoint]) -> list[tuple[float, float]]:
    """Spans of speeds in Hz within which growth may pass zero: about its maxima below the first speed at which a motion
    grows, and up to this."""
    growth, last = [point.growth for point in points], len(points) - 1
    first = next((number for number, each in enumerate(growth) if each > 0.0), last)
    highest = [i for i in range(first + 1) if i == first or growth[i] >= max(growth[max(i - 1, 0)], growth[i + 1])]
    above = [i if growth[i] > 0.0 else min(i + 1, last) for i in highest]
    return [(points[max(i - 1, 0)].speed_Hz, points[j].speed_Hz) for i, j in zip(highest, above, strict=True)]


def stability_points(
    case: Case,
    speeds_Hz: Sequence[float],
    observe: Callable[[int, int], None] | None = None,
    frequency: Callable[[float], float] | None = None,
    machines: StaticMachines | None = None,
) -> tuple[System, tuple[StabilityPoint, ...]]:
    """The machine, and its points at speeds_Hz, ascending.

    observe: called with each speed's number and their number; frequency: of the motion in rad/s, by the speed of the
    rotor in rad/s, see point_at_rest; machines: of the case, where they are made already. Raises InputError if the case
    cannot be modelled, a speed is not positive, or a film cannot be linearised. """
    check_machine(case, speeds_Hz)
    machines = machines or StaticMachines(case, memory=True)
    return machines.system, _sweep(case, machines, speeds_Hz, observe, frequency)


def check_machine(case: Case, speeds_Hz: Sequence[float]) -> None:
    """Raises InputError if a case cannot be modelled, a speed is not positive, or a film cannot be linearised."""
    require(case)
    _check_speeds(case, speeds_Hz)
    require(case, STABILITY)


def _sweep(
    case: Case,
    machines: StaticMachines,
    speeds_Hz: Sequence[float],
    observe: Callable[[int, int], None] | None = None,
    frequency: Callable[[float], float] | None = None,
    with_error: bool = True,
) -> tuple[StabilityPoint, ...]:
    """The points of stability_points. with_error: whether errors of the coefficients are wanted."""
    points: list[StabilityPoint] = []
    near: MachineAtRest | None = None
    ordered = sorted(speeds_Hz, reverse=True)  # from near the centre, where a fast journal rests, outwards
    for speed in ordered:
        point, near = _point(case, machines, speed, near, frequency, with_error)
        if not points and not point.rests and len(ordered) > TRIED:
            seek = partial(_point, case, machines, near=None, frequency=frequency, with_error=with_error)
            if tried := _none_rests(seek, point, ordered, case.speed_unit):
                return tried
        points.append(point)
        if observe is not None:
            observe(len(points), len(speeds_Hz))
    return tuple(reversed(points))


def _none_rests(
    seek: Callable[[float], tuple[StabilityPoint, MachineAtRest | None]],
    fastest: StabilityPoint,
    speeds: Sequence[float],
    unit: SpeedUnit,
) -> tuple[StabilityPoint, ...]:
    """The points at descending speeds, ascending, if there is no rest at the fastest one nor at others between it and
    the slowest, TRIED in all; () if there is rest at one of them. To seek in vain takes long, and is not done at all
    speeds."""
    by_speed = {fastest.speed_Hz: fastest}
    for i in np.linspace(0, len(speeds) - 1, TRIED).round().astype(int)[:0:-1].tolist():
        point, _ = seek(speeds[i])
        if point.rests:
            return ()
        by_speed[point.speed_Hz] = point
    span = unit.span(speeds[-1], speeds[0])
    why = f"Sought at {TRIED} speeds from {span} only, since there is none at these."
    reason = f"{fastest.problem} {why}"
    left = (by_speed.get(speed, StabilityPoint(speed, (), np.zeros(0, dtype=complex), reason)) for speed in speeds)
    slowest, *others = tuple(left)[::-1]
    return replace(slowest, problem=f"{slowest.problem} {why}"), *others


def _point(
    case: Case,
    machines: StaticMachines,
    speed: float,
    near: MachineAtRest | None,
    frequency: Callable[[float], float] | None,
    with_error: bool,
) -> tuple[StabilityPoint, MachineAtRest | None]:
    """The point at a speed in Hz, sought from the machine `near`, and that from which to seek the next one."""
    try:
        with advised(case):
            machine = machines.at(2 * math.pi * speed, near, with_error)
            point = point_at_rest(machine, speed, frequency and frequency(machine.omega))
            if case.loads_a_collar:
                from frbcli.linear.sheets.thrust import axial_state  # films on pads take long to import

                point = replace(point, axial=axial_state(case, machine.omega))
            return with_errors(point, machine) if with_error else point, machine
    except NotConverged as error:
        return StabilityPoint(speed, (), np.zeros(0, dtype=complex), str(error)), near


def _check_speeds(case: Case, speeds: Sequence[float]) -> None:
    if not len(speeds):
        missing = Fault("speed", "", None, "is missing.", 'Write e.g. "25 Hz".')
        raise case.refused(missing)
    wrong = [speed for speed in speeds if not (math.isfinite(speed) and speed > 0.0)]
    if wrong:
        faults = [Fault("speed", f"{s:g} Hz", None, "must be greater than 0.", 'Write e.g. "25 Hz".') for s in wrong]
        raise case.refused(*faults)
