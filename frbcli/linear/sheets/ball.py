"""The sheet of ball bearings over speed and load: where the rings rest, what the balls bear, stiffness, life.

ISO/TS 16281 (basic reference rating life), which is L10 = (C / P)^3 of ISO 281 for the distribution of loads that ISO
281 assumes: with gamma = d cos(alpha) / D, i rows of Z balls and

    rho = 1.044 ((1 - gamma) / (1 + gamma))^1.72 (f_i / f_o (2 f_o - 1) / (2 f_i - 1))^0.41
    Q_ci = C / (0.407 Z i^0.7 cos alpha) (1 + rho^(10/3))^0.3
    Q_ce = C / (0.389 Z i^0.7 cos alpha) (1 + rho^(-10/3))^0.3

where alpha is 0 of a deep groove. A ring that turns bears the cubic mean of the loads, one that stands their mean with
the power 10/3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, table_of
from frbcli.elements.ball import BallBearing, BallBearingElement, Balls, RestingRings, at_displacement
from frbcli.elements.ball_force import BallNumbers, ball_bearing_force
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines, check_balls
from frbcli.errors import Fault, NotConverged
from frbcli.linear.columns import BALL_SHEET
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import FILMS, sheet_top

Observer = Callable[[int, int], None]
SPEEDS = 10
HOUR = 3600.0


@dataclass(frozen=True)
class BallState:
    """A ball bearing at rest, SI units: the fields are described by BALL_SHEET in columns.py. problem: why there is no
    state, then the numbers are NaN."""

    bearing: str
    speed_Hz: float
    load: Array
    problem: str = ""
    axial_force: float = math.nan
    displacement: Array | None = None
    axial_displacement: float = math.nan
    stiffness: Array | None = None
    damping: Array | None = None
    axial_stiffness: float = math.nan
    inner_angle: float = math.nan
    outer_angle: float = math.nan
    inner_load: float = math.nan
    outer_load: float = math.nan
    inner_p_max: float = math.nan
    outer_p_max: float = math.nan
    balls_apart: int = 0
    cage_frequency: float = math.nan
    ball_pass_outer: float = math.nan
    ball_pass_inner: float = math.nan
    ball_spin: float = math.nan
    life_h: float | None = None

    @property
    def status(self) -> str:
        """Whether it rests."""
        return "not-converged" if self.problem else "resting"


@dataclass(frozen=True, repr=False)
class BallSheet(Tabular):
    """States of the ball bearings of a case: speed by speed, load by load, bearing by bearing."""

    case: Case
    bearings: tuple[str, ...]
    points: tuple[BallState, ...]

    def of(self, bearing: str) -> tuple[BallState, ...]:
        """The states of one bearing that rest."""
        return tuple(point for point in self.points if point.bearing == bearing and not point.problem)

    def table(self) -> Table:
        """One row per state."""
        return table_of(BALL_SHEET, self.points)


def ball_bearing_sheet(
    case: Case,
    speeds_Hz: Sequence[float] | None = None,
    loads: Sequence[float] = (),
    observe: Observer | None = None,
) -> BallSheet:
    """Compute the ball bearings of a case over rotor speed and load, with one ball in the line of the load.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`; [bearing] alone will do with loads and speeds.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz, not below 0; by default a range up to the highest of the case.
    loads : sequence of float, optional
        Loads in N along -y on each bearing; by default from the rotor.
    observe : callable, optional
        Called with each state's number and their number.

    Returns
    -------
    BallSheet
        Displacements in m, stiffness in N/m, loads of balls in N, Hertz pressures in Pa, frequencies in Hz, and the
        rating life in h of bearings with `dynamic_rating`.

    Raises
    ------
    InputError
        If the case has no ball bearing, no load or no speed.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("ball-bearing")
    >>> sheet = frbcli.ball_bearing_sheet(case, [1000.0], [60.0])
    >>> round(1e-6 * float(sheet.points[0].stiffness[0, 0]), 1)
    39.3
    """
    elements = list(BallBearingElement.of(case))
    if not elements:
        problem = "is missing: the case has no ball bearing."
        raise case.refused(Fault("bearing", "", None, problem, 'Add one of kind = "ball".'))
    for element in elements:
        if element.uneven:
            problem = "loads one row of an opposed pair: its sheet would be of two different rows."
            remedy = "Remove it for the sheet, and give each row's preload instead."
            raise case.refused(Fault(f"{element.key}.locating", "", None, problem, remedy))
    shares = range(1, SPEEDS + 1)
    speeds = sorted([sheet_top(case) * share / SPEEDS for share in shares] if speeds_Hz is None else speeds_Hz)
    carried = None if loads else _Carried(case)
    points: list[BallState] = []
    for number, speed in enumerate(speeds):
        if carried is None:
            given = [(element, np.array([0.0, -load])) for load in loads for element in elements]
            points += [_state(element, load, speed) for element, load in given]
        else:
            points += carried.states(elements, speed)
        if observe is not None:
            observe(number + 1, len(speeds))
    return BallSheet(case, tuple(element.given.name for element in elements), tuple(points))


class _Carried:
    """The loads that a machine at rest puts on its ball bearings. Raises InputError for one that has no rest."""

    def __init__(self, case: Case) -> None:
        if case.given_rotor is None:
            problem = "is missing: the load on the bearing is not known."
            raise case.refused(Fault("--load", "", None, problem, 'Give e.g. --load "60 N".'))
        require(case, FILMS)
        self._machines = StaticMachines(case)
        self._near: MachineAtRest | None = None

    def states(self, elements: Sequence[BallBearingElement], speed: float) -> Iterator[BallState]:
        """States of all bearings at a speed in Hz."""
        omega = 2.0 * math.pi * speed
        try:
            self._near = at_rest = self._machines.at(omega, self._near, with_error=False)
        except NotConverged as error:
            yield from (BallState(element.given.name, speed, np.full(2, math.nan), str(error)) for element in elements)
            return
        q = at_rest.at_rest.position.displacements
        ports = {port.name: port for port in at_rest.system.rotor.ports}
        for element in elements:
            force = sum((ports[name].at(q, np.zeros_like(q), omega).force for name in element.signals), np.zeros(2))
            yield _state(element, -force, speed)


def _state(element: BallBearingElement, load: Array, speed: float) -> BallState:
    name, rings = element.given.name, replace(element.rings, turning=True)
    omega, line = 2.0 * math.pi * speed, math.atan2(load[0], -load[1]) if load.any() else 0.0
    try:
        check_balls(element, omega)
        rest = under_load(rings, load, omega, line)
    except NotConverged as error:
        return BallState(name, speed, load, str(error))
    rating = element.given.dynamic_rating
    life = None
    if rating is not None and speed > 0.0:
        life = rating_life(rings, rest.balls, rating) / (speed * HOUR)
    return BallState(
        name, speed, load,
        axial_force=-float(rest.force[2]) / rings.rows,
        displacement=rest.displacement[:2], axial_displacement=float(rest.displacement[2]),
        stiffness=rest.stiffness, damping=element.given.damping * np.eye(2), axial_stiffness=rest.axial_stiffness,
        **_of_balls(element, rest),
        cage_frequency=speed * rings.cage_ratio, ball_pass_outer=speed * rings.pass_outer,
        ball_pass_inner=speed * rings.pass_inner, ball_spin=speed * rings.ball_spin, life_h=life,
    )  # fmt: skip


def _of_balls(element: BallBearingElement, rest: RestingRings) -> dict[str, Any]:
    """What the balls of a row bear."""
    balls, (inner, outer) = rest.balls, element.rings.contacts
    most = int(np.argmax(balls.inner_load))
    pressures = {
        "inner_p_max": inner.pressure(float(balls.inner_load.max())),
        "outer_p_max": outer.pressure(float(balls.outer_load.max())),
    }
    return pressures | {
        "inner_angle": math.degrees(balls.inner_angle[most]),
        "outer_angle": math.degrees(balls.outer_angle[most]),
        "inner_load": float(balls.inner_load.max()),
        "outer_load": float(balls.outer_load.max()),
        "balls_apart": int(np.count_nonzero(balls.inner_load == 0.0)),
    }


SETTLED, CARRIED = 1e-12, 1e-6  # of the load: what is left over at rest, and where steps no longer help
STEPS = 80
FIRST = 1e-6  # m, beyond which the place along a load's line is sought


def under_load(bearing: BallBearing, load: Array, omega: float, cage: float = 0.0) -> RestingRings:
    """The bearing under a load (2,) in N on the inner ring, at omega rad/s and an angle of the cage in rad.

    Newton's method on the displacement, from where the ring carries the load along its line; a step is halved until the
    imbalance falls. Raises NotConverged.
    """
    of, memory, size = bearing.numbers, bearing.memory, float(np.linalg.norm(load))
    place = np.zeros(2) if size == 0.0 else _along(of, memory, load / size, size, omega, cage)
    step, least = np.zeros(2), math.inf
    for _ in range(STEPS):
        x, y = (place + step).tolist()
        f_x, f_y, *k = ball_bearing_force(of, x, y, omega, cage, memory)
        missed = load + np.array([f_x, f_y])
        left = float(np.linalg.norm(missed))
        if left >= least:
            step *= 0.5
            continue
        place, least = place + step, left
        stiffness = np.reshape(k, (2, 2))
        # along what carries nothing, as a ring within its clearance, it stays
        step = np.linalg.lstsq(stiffness, missed, rcond=1e-12)[0]
        if left <= SETTLED * size:
            break
    if least <= CARRIED * size:
        return at_displacement(bearing, place, omega, cage)
    raise NotConverged(f"A ball bearing does not carry {size:.4g} N: {least:.3g} N are left.")


def _along(of: BallNumbers, memory: Array, line: Array, size: float, omega: float, cage: float) -> Array:
    """(2,) place in m on a line at which the force against it is as large as the load."""
    low, high = 0.0, FIRST

    def carried(way: float) -> float:
        x, y = (way * line).tolist()
        f_x, f_y, *_ = ball_bearing_force(of, x, y, omega, cage, memory)
        return -float(line @ [f_x, f_y])

    while carried(high) < size:
        low, high = high, 2.0 * high
        if high > of.radial:
            raise NotConverged(f"A ball bearing does not carry {size:.4g} N within its grooves.")
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if carried(middle) < size else (low, middle)
    return high * line


STANDING, TURNING, WEIBULL = 10.0 / 3.0, 3.0, 0.9


def rating_life(bearing: BallBearing, balls: Balls, rating: float) -> float:
    """L10 in revolutions under the loads of the balls of each row; rating: C of the whole bearing in N. Infinite
    without a load."""
    angle = 0.0 if bearing.deep_groove else bearing.contact_angle
    gamma = bearing.ball_diameter * math.cos(angle) / bearing.pitch_diameter
    f_i, f_o = bearing.inner, bearing.outer
    grooves = f_i / f_o * (2.0 * f_o - 1.0) / (2.0 * f_i - 1.0)
    rho = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * grooves**0.41
    each = rating / (bearing.balls * bearing.rows**0.7 * math.cos(angle))
    inner = each / 0.407 * (1.0 + rho**STANDING) ** 0.3
    outer = each / 0.389 * (1.0 + rho**-STANDING) ** 0.3
    bears_inner = float(np.mean(balls.inner_load**TURNING)) ** (1.0 / TURNING)
    bears_outer = float(np.mean(balls.outer_load**STANDING)) ** (1.0 / STANDING)
    damage = bearing.rows * ((bears_inner / inner) ** STANDING + (bears_outer / outer) ** STANDING)
    return 1e6 * damage**-WEIBULL if damage > 0.0 else math.inf
