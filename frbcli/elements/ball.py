"""A ball bearing: its geometry, contacts and frequencies.

The contact angle without load is given by the grooves, or follows from the radial clearance G, by which one ring moves
from one side to the other: cos(alpha_0) = 1 - G / (2 A), A = (f_i + f_o - 1) d (Harris, Rolling Bearing Analysis,
chapter 2).

Static equilibrium of a ball bearing at a displacement, and the loads of its balls there.

A ball bearing between shaft and shell: its rings, by the keys of the case.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Any, ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import OPPOSED, AnyRollingMaterial, AxialOffset, BallBearingKeys, BallFriction, LoadAtSpeed
from frbcli.case.over_time import largest
from frbcli.case.schema import Case
from frbcli.elements.ball_force import (
    BELOW,
    KNOWN,
    RINGS,
    BallNumbers,
    HertzContact,
    ball,
    ball_bearing_force,
    ball_friction,
    ball_numbers,
    contact,
    of_balls,
    rings,
)
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.errors import Fault
from frbcli.materials import ROLLING, Elastic
from frbcli.rotor.assembly import COORDINATES, PLANE, Link
from frbcli.rotor.loads import LinearPart, piecewise_linear
from frbcli.rotor.port import ANGLE, D_X, D_Y, F_X, F_Y, GRIP, SPEED, TORQUE, XX, XY, YX, YY, ForceLaw
from frbcli.units import display

SMALL_APPROACH, ROUND = 1e-6, 1e-15  # m: the latter a deflection that is round-off of the places
PER_TURN = 1e6 * 30.0 / math.pi  # nu n in mm^2/s rpm of nu omega in m^2/s rad/s
RATING_PRESSURE = 4.2e9  # Pa, of a static load rating (ISO 76): a dent of 1e-4 of the ball diameter
MEAN_POINTS = 24  # at which balls that are spread evenly are summed, at least; twice as many balls are as good


@dataclass(frozen=True)
class BallBearing:
    """One or two equal rows of balls between two rings, SI units.

    balls: of one row; pitch_diameter: of the circle of their centres; contact_angle: without load, rad; inner, outer:
    radii of the grooves over the diameter of a ball; ball, ring: their materials; rows: 1 or 2; preload: along the axis
    on each row, N, or None where the rings are held at `offset`, the axial displacement in m from their first contact;
    turning: whether the balls pass, or act as if they were spread evenly; thrust: on all rows in addition to the
    preload, in N, and over the square of the speed of the shaft, in N s^2; pair: whether two rows, moved against each
    other by the offset, share the thrust, which presses the first one; f_1, f_0: of Palmgren's friction, see
    ball_friction; viscosity: kinematic, of the lubricant, m^2/s; deep_groove: whether its load rating is for angle 0.
    """

    balls: int
    ball_diameter: float
    pitch_diameter: float
    contact_angle: float
    inner: float
    outer: float
    ball: Elastic
    ring: Elastic
    rows: int = 1
    preload: float | None = None
    offset: float = 0.0
    turning: bool = True
    thrust: tuple[float, float] = (0.0, 0.0)
    pair: bool = False
    f_1: float = 0.0
    f_0: float = 0.0
    viscosity: float = 0.0
    deep_groove: bool = False

    @property
    def gamma(self) -> float:
        """d cos(alpha_0) / D."""
        return self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter

    @property
    def cage_ratio(self) -> float:
        """Speed of the cage over the speed of the shaft."""
        return 0.5 * (1.0 - self.gamma)

    @property
    def pass_outer(self) -> float:
        """Balls that pass a place of the outer ring, per revolution of the shaft."""
        return self.balls * self.cage_ratio

    @property
    def pass_inner(self) -> float:
        """Balls that pass a place of the inner ring, per revolution of the shaft."""
        return 0.5 * self.balls * (1.0 + self.gamma)

    @property
    def ball_spin(self) -> float:
        """Turns of a ball about its own axis, per revolution of the shaft."""
        return 0.5 * self.pitch_diameter / self.ball_diameter * (1.0 - self.gamma**2)

    @property
    def grooves(self) -> float:
        """A: distance of the groove centres where a ball just touches both, m."""
        return (self.inner + self.outer - 1.0) * self.ball_diameter

    @cached_property
    def contacts(self) -> tuple[HertzContact, HertzContact]:
        """Contacts of a ball with the inner and the outer ring."""
        d, gamma = self.ball_diameter, self.gamma
        inner = 2.0 / d + 2.0 / d * gamma / (1.0 - gamma), 2.0 / d - 1.0 / (self.inner * d)
        outer = 2.0 / d - 2.0 / d * gamma / (1.0 + gamma), 2.0 / d - 1.0 / (self.outer * d)
        return contact(self.ball, self.ring, *inner), contact(self.ball, self.ring, *outer)

    @property
    def centrifugal(self) -> float:
        """Centrifugal force of a ball over the square of the speed of the shaft, N s^2."""
        mass = self.ball.density * math.pi / 6.0 * self.ball_diameter**3
        return 0.5 * mass * self.pitch_diameter * self.cage_ratio**2

    @property
    def free(self) -> float:
        """Radial way in m of the inner ring from the middle until it meets a ball, without preload."""
        if self.preload is not None:
            return 0.0
        radial, axial = (self.grooves * each for each in (math.cos(self.contact_angle), math.sin(self.contact_angle)))
        gap = self.grooves**2 - (axial + self.offset) ** 2
        return max(math.sqrt(max(gap, 0.0)) - radial, 0.0)

    @property
    def approach(self) -> float:
        """Of rings and balls under the preload, a length over which forces change, m; at least SMALL_APPROACH."""
        inner, outer = (each.stiffness ** (-2.0 / 3.0) for each in self.contacts)
        along = max(math.sin(self.contact_angle), 0.1)
        load = (self.preload or 0.0) / (self.balls * along)
        pressed = max(self.offset, 0.0) * along if self.preload is None else (inner + outer) * load ** (2.0 / 3.0)
        return max(pressed, SMALL_APPROACH)

    @property
    def preload_pressure(self) -> float:
        """Largest Hertz pressure in Pa under the preload alone."""
        alone = replace(self, pair=False, thrust=(0.0, 0.0))
        load = float(at_displacement(alone, np.zeros(2), 0.0).balls.inner_load.max())
        return max(each.pressure(load) for each in self.contacts)

    @property
    def points(self) -> int:
        """Places around at which balls are summed."""
        return self.balls if self.turning else max(MEAN_POINTS, 4 * -(-self.balls // 2))

    @cached_property
    def numbers(self) -> BallNumbers:
        """What it is to the kernels."""
        inner, outer = self.contacts
        gives_inner, gives_outer = (each.stiffness ** (-2.0 / 3.0) for each in (inner, outer))
        lubricant = self.rows * self.f_0 * self.pitch_diameter**3
        return BallNumbers(
            points=self.points,
            share=(1 if self.pair else self.rows) * self.balls / self.points,
            axial=self.grooves * math.sin(self.contact_angle),
            radial=self.grooves * math.cos(self.contact_angle),
            inner=(self.inner - 0.5) * self.ball_diameter,
            outer=(self.outer - 0.5) * self.ball_diameter,
            k_inner=inner.stiffness,
            k_outer=outer.stiffness,
            centrifugal=self.centrifugal,
            held=float(self.preload is None and not self.pair),
            preload=self.offset if self.preload is None else self.rows * self.preload + self.thrust[0],
            cage=self.cage_ratio if self.turning else 0.0,
            thrust=self.thrust[1],
            split=gives_inner / (gives_inner + gives_outer),
            turn_cos=math.cos(2.0 * math.pi / self.points),
            turn_sin=math.sin(2.0 * math.pi / self.points),
            load_friction=self.f_1 * self.pitch_diameter,
            viscous_friction=0.1 * lubricant * (PER_TURN * self.viscosity) ** (2.0 / 3.0),
            least_friction=16.0 * lubricant,
            rows=2 if self.pair else 1,
            load=self.thrust[0] if self.pair else 0.0,
        )

    @property
    def memory(self) -> Array:
        """(m,) for the kernels: nothing is known yet."""
        return np.zeros(RINGS + KNOWN * self.numbers.rows * self.points)

    def in_middle(self, omega: float) -> tuple[BallNumbers, float]:
        """The numbers with one ball for all, which are alike with the rings in the middle, and the displacement in m
        along the axis at omega rad/s."""
        of, memory = self.numbers, self.memory
        of = of._replace(points=1, share=of.share * of.points)
        ball_bearing_force(of, 0.0, 0.0, omega, 0.0, memory)
        return of, of.preload if of.held else float(memory[0])

    def apart(self, omega: float) -> tuple[BallBearing, BallBearing]:
        """The rows of a pair at omega rad/s with its rings in the middle, each held where the load has moved it."""
        one, moved = replace(self, rows=1, thrust=(0.0, 0.0), pair=False), self.in_middle(omega)[1]
        return replace(one, offset=self.offset + moved), replace(one, offset=self.offset - moved)


@dataclass(frozen=True)
class Balls:
    """The balls of one row at rest, or of both rows of a pair, one row after the other. angles: from the x-axis, rad;
    inner_angle, outer_angle: contact angles in rad, NaN without contact; inner_load, outer_load: N. All but the angles
    (..., n)."""

    angles: Array
    inner_angle: Array
    outer_angle: Array
    inner_load: Array
    outer_load: Array


@dataclass(frozen=True)
class RestingRings:
    """A ball bearing at rest. displacement: (3,) of the inner ring, m; force: (3,) on it, N; stiffness: (2, 2) N/m,
    under a preload by a constant force with the rings free along the axis; axial_stiffness: with the ring held in x and
    y, N/m."""

    displacement: Array
    force: Array
    stiffness: Array
    axial_stiffness: float
    balls: Balls


def at_displacement(bearing: BallBearing, place: Array, omega: float, cage: float = 0.0) -> RestingRings:
    """The bearing with its inner ring at a place (2,) in m, at omega rad/s and an angle of the cage in rad."""
    of, memory = bearing.numbers, bearing.memory
    x, y = float(place[0]), float(place[1])
    f_x, f_y, *k = ball_bearing_force(of, x, y, omega, cage, memory)
    z = of.preload if of.held else float(memory[0])
    sums = rings(of, x, y, z, omega, cage, memory)
    force = np.array([f_x, f_y, -sums[2]])
    return RestingRings(np.array([x, y, z]), force, np.reshape(k, (2, 2)), sums[8], balls_of(of, memory, cage))


def balls_of(of: BallNumbers, memory: Array, cage: float) -> Balls:
    """The balls that the kernel has left in its memory (..., w)."""
    known = memory[..., RINGS:].reshape(*memory.shape[:-1], of.rows * of.points, KNOWN)
    a, r, u, v = np.moveaxis(known[..., :4], -1, 0)
    inner, outer = np.hypot(a - u, r - v) - of.inner, np.hypot(u, v) - of.outer
    inner_load, outer_load = (
        k * np.where(each > ROUND, each, 0.0) ** 1.5 for k, each in ((of.k_inner, inner), (of.k_outer, outer))
    )
    inner_angle = np.where(inner_load > 0.0, np.arctan2(a - u, r - v), np.nan)
    outer_angle = np.where(outer_load > 0.0, np.arctan2(u, v), np.nan)
    around = BELOW + cage + 2.0 * math.pi * np.arange(of.points) / of.points
    return Balls(np.tile(around, of.rows), inner_angle, outer_angle, inner_load, outer_load)


TILTED = np.arange(2, 4)  # among the COORDINATES
FIRST_SPEEDS = np.linspace(0.0, 4.0, 17)  # of the table of the stiffness in tilt, over the highest one of the case
LINE_ERROR = 1e-3  # of lines between its speeds


def row_in_tilt(row: BallBearing, place: float, sense: float, omega: float) -> tuple[float, float]:
    """Of one row with its ring in the middle: force in N and moment in N m by a slope of the shaft, about a point on
    the axis from which the middle of the row is at `place` in m; sense: 1 if the ring is pressed towards larger
    positions, else -1.

    The centre of the inner groove lies at R across and z along the axis from the point. A slope t moves it by z t
    across and by -R t cos(psi) along the axis, and turns the lever of the force of each ball.
    """
    of, z = row.in_middle(omega)
    q_a, q_r, aa, ar, rr = ball(of, of.axial + z, of.radial, *of_balls(of, omega), row.memory, RINGS)
    across = 0.5 * row.pitch_diameter + of.inner * math.cos(row.contact_angle)
    along = place + sense * of.inner * math.sin(row.contact_angle)
    half = 0.5 * row.balls
    force = half * (rr * along - sense * ar * across)
    moment = half * (rr * along**2 - 2.0 * sense * ar * along * across + aa * across**2)
    return force, moment - half * (q_r * across + 2.0 * sense * q_a * along)


@dataclass(frozen=True)
class BallForce(ForceLaw):
    """The force of a ball bearing on the shaft. Its cage turns with the shaft, from where a ball is below."""

    rings: BallBearing

    quantity: ClassVar[str] = "ball_force"

    @property
    def turns(self) -> bool:  # type: ignore[override]
        """See ForceLaw: with a cage that turns."""
        return self.rings.turning

    @property
    def brakes(self) -> bool:  # type: ignore[override]
        """See ForceLaw: with numbers of its friction."""
        return self.rings.f_1 > 0.0 or self.rings.f_0 > 0.0

    def inside(self, memories: Array) -> dict[str, tuple[str, Array]]:
        of, (at_inner, at_outer) = self.rings.numbers, self.rings.contacts
        balls = balls_of(of, memories, 0.0)
        inner, outer = balls.inner_load.max(axis=1), balls.outer_load.max(axis=1)
        # of a Hertz contact in proportion to the cube root of its load
        pressure = np.maximum(at_inner.pressure(1.0) * np.cbrt(inner), at_outer.pressure(1.0) * np.cbrt(outer))
        return {
            "ball_inner_load": ("N", inner),
            "ball_outer_load": ("N", outer),
            "ball_contact_angle": ("rad", np.nan_to_num(balls.inner_angle).max(axis=1)),
            "ball_pressure": ("Pa", pressure),
            "balls_apart": ("", (balls.inner_load <= 0.0).sum(axis=1) * (self.rings.balls / of.points)),
        }

    @property
    def numbers(self) -> Array:
        return np.array(self.rings.numbers, dtype=np.float64)

    @property
    def length(self) -> float:
        """What a ball gives way under a preload, beyond the clearance."""
        return self.rings.approach + self.rings.free

    @property
    def memory(self) -> Array:
        return self.rings.memory

    @staticmethod
    def force(numbers: Any, memory: Any, motion: Any, answer: Any) -> None:
        of = ball_numbers(numbers)
        f_x, f_y, xx, xy, yx, yy = ball_bearing_force(
            of, motion[D_X], motion[D_Y], motion[SPEED], of.cage * motion[ANGLE], memory
        )
        for i in range(len(answer)):
            answer[i] = 0.0
        answer[F_X], answer[F_Y] = f_x, f_y
        if of.load_friction > 0.0 or of.least_friction > 0.0:
            answer[TORQUE], answer[GRIP] = ball_friction(of, motion[SPEED], memory)
        answer[XX], answer[XY], answer[YX], answer[YY] = -xx, -xy, -yx, -yy


@dataclass(frozen=True)
class BallBearingElement(MachineElement):
    """A ball bearing of a case. thrust: the axial load that presses its rings together, in N, and over the square of
    the speed of the shaft, in N s^2; top: the highest speed of the case, rad/s."""

    given: BallBearingKeys
    thrust: tuple[float, float] = (0.0, 0.0)
    top: float = 0.0

    symbol: ClassVar[str] = "spring"

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.bearing_keys, case.placed_bearings, strict=True):
            if bearing.kind == "ball":
                top = 0.0 if case.given_speed is None else max(map(abs, case.given_speed.course[1]))
                yield cls(key, bearing, _thrust(case, bearing), 2.0 * math.pi * top)

    @property
    def rings(self) -> BallBearing:
        """Its mechanics. Rings of a deep groove without preload are held in the middle of their axial play."""
        given = self.given
        grooves = (given.inner_curvature + given.outer_curvature - 1.0) * given.ball_diameter
        angle = given.contact_angle
        if angle is None:
            angle = math.acos(1.0 - 0.5 * (given.radial_clearance or 0.0) / grooves)
        force, offset = None, -grooves * math.sin(angle)
        if isinstance(given.preload, AxialOffset):
            offset = given.preload.offset
        elif given.preload:
            force, offset = given.preload, 0.0
        friction = given.friction or BallFriction()
        return BallBearing(
            balls=given.balls, ball_diameter=given.ball_diameter, pitch_diameter=given.pitch_diameter,
            contact_angle=angle, inner=given.inner_curvature, outer=given.outer_curvature,
            ball=_material(given.ball_material), ring=_material(given.ring_material),
            rows=1 if given.arrangement == "single" else 2, preload=force, offset=offset,
            turning=given.cage == "turning", thrust=self.thrust, pair=given.locating == "both",
            f_1=friction.f1, f_0=friction.f0, viscosity=friction.viscosity or 0.0,
            deep_groove=given.contact_angle is None,
        )  # fmt: skip

    @property
    def rows(self) -> tuple[tuple[str, BallBearing], ...]:
        """Rows that act together, by the ends of the names of their signals: all, or the left and the right one, of
        which one alone carries the axial load."""
        rings = self.rings
        if self.given.arrangement not in OPPOSED or rings.pair or not any(self.thrust):
            return (("", rings),)
        loaded, other = replace(rings, rows=1), replace(rings, rows=1, thrust=(0.0, 0.0))
        # back to back, the left row is pressed as the shaft moves to the right
        left = (self.given.arrangement == "back-to-back") == (self.given.locating == "right")
        return (("left", loaded if left else other), ("right", other if left else loaded))

    @property
    def uneven(self) -> bool:
        """Whether an axial load presses one row of a pair more than the other."""
        return len(self.rows) > 1 or self.rings.pair

    def link(self, site: Site, sees: tuple[str, ...] = PLANE) -> Link:
        """Where its force acts."""
        return Link(site.journal(self.given.name), site.shell(self.given.name), site.count, sees)

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals of its force, by its rows."""
        return tuple("_".join(filter(None, (BallForce.quantity, self.given.name, end))) for end, _ in self.rows)

    @property
    def tilt(self) -> LinearPart | None:
        """Stiffness and damping of two opposed rows in tilt over the speed, with the ring in the middle."""
        return None if self.given.row_distance is None else tilt_over_speed(self, self.given.row_distance)

    def in_tilt(self, distance: float, omega: float) -> Array:
        """(2,) of both rows by a slope of the shaft at omega rad/s, see row_in_tilt: the force times their distance,
        and the moment, in N m."""
        one = replace(self.rings, rows=1, turning=False)
        both = [replace(row, rows=1, turning=False) for _, row in self.rows] if len(self.rows) > 1 else [one, one]
        sense = 1.0 if self.given.arrangement == "back-to-back" else -1.0  # of the left row, which then is the first
        if one.pair:
            both = list(one.apart(omega)[:: int(sense)])
        left = row_in_tilt(both[0], -0.5 * distance, sense, omega)
        return np.add(left, row_in_tilt(both[1], 0.5 * distance, -sense, omega)) * [distance, 1.0]

    def stiffness(self, omega: float) -> Array:
        place = np.array([0.0, -BallForce(self.rings).length])  # a little beyond the clearance
        return at_displacement(self.rings, place, omega).stiffness

    def parts(self, site: Site) -> Parts:
        link = self.link(site)
        damping = LinearPart.of(np.zeros((2, 2)), self.given.damping * np.eye(2))
        links = [(link, damping)] if self.given.damping else []
        if (tilt := self.tilt) is not None:
            links.append((self.link(site, COORDINATES), tilt))
        ports = ((name, link, BallForce(row)) for name, (_, row) in zip(self.signals, self.rows, strict=True))
        return Parts(links=tuple(links), ports=tuple(ports))

    def plan_line(self, site: Site) -> Line:
        return self.line

    def preload_left(self, omega: float) -> float:
        """What the axial load leaves of the preload at omega rad/s, N; infinite where it does not act on it."""
        if self.given.locating is None or self.rings.pair:
            return math.inf
        rows = 1 if self.given.arrangement in OPPOSED else self.rings.rows
        return rows * (self.rings.preload or 0.0) + self.thrust[0] + self.thrust[1] * omega**2

    def faults(self) -> list[Fault]:
        """An axial load that takes the preload away."""
        if (least := min(self.preload_left(0.0), self.preload_left(self.top))) > 0.0:
            return []
        other = "left" if self.given.locating == "right" else "right"
        left = f"{display(least, 'N')} of its preload is left"
        problem = f"pulls the rings of the bearing {self.given.name} apart: {left}."
        remedy = f'Write {self.key}.locating = "{other}", or raise its preload.'
        return [Fault("axial.load", "", None, problem, remedy)]

    @property
    def line(self) -> Line:
        """Its line of the plan, also of one without a machine."""
        given, rings = self.given, self.rings
        rows = f"two rows {given.arrangement}, each of " if rings.rows > 1 else ""
        value = f"{given.name}: {rows}{given.balls} balls of {display(given.ball_diameter, 'm')}".removeprefix(": ")
        angle = f"{math.degrees(rings.contact_angle):.3g} deg without load"
        preload = f"preload {display(rings.preload, 'N')} by a spring" if rings.preload else "rings held along the axis"
        if given.locating is not None:
            towards = "both directions" if rings.pair else f"the {given.locating}"
            preload += f", and the axial load to {towards}"
        friction = "" if BallForce(rings).brakes else ", friction"
        reason = f"Hertz contacts, centrifugal force of the balls, {angle}, {preload}"
        tilt = "" if self.tilt is not None else ", moments of the rings"
        return "bearings", value, f"{reason}; left out: gyroscopic moments of the balls{tilt}{friction}"


@lru_cache(maxsize=8)
def tilt_over_speed(element: BallBearingElement, distance: float) -> LinearPart:
    """See BallBearingElement.tilt; distance: of the rows, m."""
    table = piecewise_linear(partial(element.in_tilt, distance), element.top * FIRST_SPEEDS, LINE_ERROR)
    stiffness, damping = np.zeros((len(table), 4, 4)), np.zeros((len(table), 4, 4))
    damping[:, TILTED, TILTED] = 0.25 * element.given.damping * distance**2
    for matrix, (force, moment) in zip(stiffness, table.values(), strict=True):
        matrix[0, 3] = matrix[3, 0] = force / distance  # tilt_y is the slope of x, tilt_x that of -y
        matrix[1, 2] = matrix[2, 1] = -force / distance
        matrix[TILTED, TILTED] = moment
    return LinearPart(np.array(list(table)), stiffness, damping, np.zeros_like(damping))


def _thrust(case: Case, bearing: BallBearingKeys) -> tuple[float, float]:
    """See BallBearingElement: of a load towards the side to which the bearing holds the shaft, of both to the right."""
    if case.axial is None or bearing.locating is None:
        return 0.0, 0.0
    load, sign = case.axial.load, -1.0 if bearing.locating == "left" else 1.0
    if isinstance(load, LoadAtSpeed):
        return 0.0, sign * load.load / (2.0 * math.pi * load.at) ** 2
    return sign * largest(load), 0.0


def _material(given: AnyRollingMaterial) -> Elastic:
    return ROLLING[given] if isinstance(given, str) else given.solid
