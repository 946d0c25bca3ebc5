"""A ball bearing: its geometry, contacts and frequencies.

The contact angle without load is given by the grooves, or follows from the radial clearance G, by which one ring moves
from one side to the other: cos(alpha_0) = 1 - G / (2 A), A = (f_i + f_o - 1) d (Harris, Rolling Bearing Analysis,
chapter 2).

Static equilibrium of a ball bearing, the loads of its balls there, and its basic rating life L10 from these loads.

ISO/TS 16281 (basic reference rating life), which is L10 = (C / P)^3 of ISO 281 for the distribution of loads that ISO
281 assumes: with gamma = d cos(alpha) / D, i rows of Z balls and

    rho = 1.044 ((1 - gamma) / (1 + gamma))^1.72 (f_i / f_o (2 f_o - 1) / (2 f_i - 1))^0.41
    Q_ci = C / (0.407 Z (i cos alpha)^0.7) (1 + rho^(10/3))^0.3
    Q_ce = C / (0.389 Z (i cos alpha)^0.7) (1 + rho^(-10/3))^0.3

a ring that turns bears the cubic mean of the loads, one that stands their mean with the power 10/3.

A ball bearing between shaft and shell: its rings, by the keys of the case.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import AnyRollingMaterial, AxialOffset, BallBearingKeys, LoadAtSpeed
from frbcli.case.over_time import largest
from frbcli.case.schema import Case
from frbcli.elements.ball_force import (
    BELOW,
    KNOWN,
    RINGS,
    BallNumbers,
    HertzContact,
    ball_bearing_force,
    ball_friction,
    ball_numbers,
    contact,
    rings,
)
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.errors import Fault, NotConverged
from frbcli.materials import ROLLING, Elastic
from frbcli.rotor.assembly import Link
from frbcli.rotor.loads import LinearPart
from frbcli.rotor.port import ANGLE, D_X, D_Y, F_X, F_Y, GRIP, SPEED, TORQUE, XX, XY, YX, YY, ForceLaw
from frbcli.units import display

SMALL_APPROACH = 1e-6  # m
PER_TURN = 1e6 * 30.0 / math.pi  # nu n in mm^2/s rpm of nu omega in m^2/s rad/s
MEAN_POINTS = 24  # at which balls that are spread evenly are summed, at least; twice as many balls are as good


@dataclass(frozen=True)
class BallBearing:
    """One or two equal rows of balls between two rings, SI units.

    balls: of one row; pitch_diameter: of the circle of their centres; contact_angle: without load, rad; inner, outer:
    radii of the grooves over the diameter of a ball; ball, ring: their materials; rows: 1 or 2; preload: along the axis
    on each row, N, or None where the rings are held at `offset`, the axial displacement in m from their first contact;
    turning: whether the balls pass, or act as if they were spread evenly; thrust: on all rows in addition to the
    preload, in N, and over the square of the speed of the shaft, in N s^2; f_1, f_0: of Palmgren's friction, see
    ball_friction; viscosity: kinematic, of the lubricant, m^2/s.
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
    f_1: float = 0.0
    f_0: float = 0.0
    viscosity: float = 0.0

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
            share=self.rows * self.balls / self.points,
            axial=self.grooves * math.sin(self.contact_angle),
            radial=self.grooves * math.cos(self.contact_angle),
            inner=(self.inner - 0.5) * self.ball_diameter,
            outer=(self.outer - 0.5) * self.ball_diameter,
            k_inner=inner.stiffness,
            k_outer=outer.stiffness,
            centrifugal=self.centrifugal,
            held=float(self.preload is None),
            preload=self.offset if self.preload is None else self.rows * self.preload + self.thrust[0],
            cage=self.cage_ratio if self.turning else 0.0,
            thrust=self.thrust[1],
            split=gives_inner / (gives_inner + gives_outer),
            turn_cos=math.cos(2.0 * math.pi / self.points),
            turn_sin=math.sin(2.0 * math.pi / self.points),
            load_friction=self.f_1 * self.pitch_diameter,
            viscous_friction=0.1 * lubricant * (PER_TURN * self.viscosity) ** (2.0 / 3.0),
            least_friction=16.0 * lubricant,
        )

    @property
    def memory(self) -> Array:
        """(m,) for the kernels: nothing is known yet."""
        return np.zeros(RINGS + KNOWN * self.points)


SETTLED, CARRIED = 1e-12, 1e-6  # of the load: what is left over at rest, and where steps no longer help
STEPS = 80
FIRST = 1e-6  # m, beyond which the place along a load's line is sought
ROUND = 1e-15  # m, below which a deflection is round-off of the places


@dataclass(frozen=True)
class Balls:
    """The balls of one row at rest. angles: from the x-axis, rad; inner_angle, outer_angle: contact angles in rad, NaN
    without contact; inner_load, outer_load: N. All but the angles (..., n)."""

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
    known = memory[..., RINGS:].reshape(*memory.shape[:-1], of.points, KNOWN)
    a, r, u, v = np.moveaxis(known[..., :4], -1, 0)
    inner, outer = np.hypot(a - u, r - v) - of.inner, np.hypot(u, v) - of.outer
    inner_load, outer_load = (
        k * np.where(each > ROUND, each, 0.0) ** 1.5 for k, each in ((of.k_inner, inner), (of.k_outer, outer))
    )
    inner_angle = np.where(inner_load > 0.0, np.arctan2(a - u, r - v), np.nan)
    outer_angle = np.where(outer_load > 0.0, np.arctan2(u, v), np.nan)
    around = BELOW + cage + 2.0 * math.pi * np.arange(of.points) / of.points
    return Balls(around, inner_angle, outer_angle, inner_load, outer_load)


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
    gamma, f_i, f_o = bearing.gamma, bearing.inner, bearing.outer
    grooves = f_i / f_o * (2.0 * f_o - 1.0) / (2.0 * f_i - 1.0)
    rho = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * grooves**0.41
    each = rating / (bearing.balls * (bearing.rows * math.cos(bearing.contact_angle)) ** 0.7)
    inner = each / 0.407 * (1.0 + rho**STANDING) ** 0.3
    outer = each / 0.389 * (1.0 + rho**-STANDING) ** 0.3
    bears_inner = float(np.mean(balls.inner_load**TURNING)) ** (1.0 / TURNING)
    bears_outer = float(np.mean(balls.outer_load**STANDING)) ** (1.0 / STANDING)
    damage = bearing.rows * ((bears_inner / inner) ** STANDING + (bears_outer / outer) ** STANDING)
    return 1e6 * damage**-WEIBULL if damage > 0.0 else math.inf


LEFT_OUT = "the gyroscopic moment of the balls and moments of the rings are left out"


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
            if isinstance(bearing, BallBearingKeys):
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
        return BallBearing(
            balls=given.balls, ball_diameter=given.ball_diameter, pitch_diameter=given.pitch_diameter,
            contact_angle=angle, inner=given.inner_curvature, outer=given.outer_curvature,
            ball=_material(given.ball_material), ring=_material(given.ring_material),
            rows=1 if given.arrangement == "single" else 2, preload=force, offset=offset,
            turning=given.cage == "turning", thrust=self.thrust,
            f_1=given.friction.f1, f_0=given.friction.f0, viscosity=given.friction.viscosity or 0.0,
        )  # fmt: skip

    def link(self, site: Site) -> Link:
        """Where its force acts."""
        return Link(site.journal(self.given.name), site.shell(self.given.name), site.count)

    @property
    def signal(self) -> str:
        """Name of the signal of its force."""
        return f"{BallForce.quantity}_{self.given.name}".rstrip("_")

    @property
    def linear(self) -> LinearPart:
        """Usual stiffness and damping, for estimates: without speed, a little beyond the clearance."""
        stiffness = at_displacement(self.rings, np.array([0.0, -BallForce(self.rings).length]), 0.0).stiffness
        return LinearPart.of(0.5 * float(np.trace(stiffness)) * np.eye(2), self.given.damping * np.eye(2))

    def parts(self, site: Site) -> Parts:
        link = self.link(site)
        damping = LinearPart.of(np.zeros((2, 2)), self.given.damping * np.eye(2))
        links = ((link, damping),) if self.given.damping else ()
        return Parts(links=links, ports=((self.signal, link, BallForce(self.rings)),))

    def plan_line(self, site: Site) -> Line:
        return self.line

    def faults(self) -> list[Fault]:
        """An axial load that takes the preload away."""
        constant, square = self.thrust
        left = self.rings.rows * (self.rings.preload or 0.0) + constant
        least = min(left, left + square * self.top**2)
        if self.given.locating is None or least > 0.0:
            return []
        other = "left" if self.given.locating == "right" else "right"
        parted = f"pulls the rings of the bearing {self.given.name} apart"
        problem = f"{parted}: {display(least, 'N')} of its preload is left."
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
            preload += f", and the axial load to the {given.locating}"
        friction = "" if BallForce(rings).brakes else "friction, "
        reason = f"Hertz contacts, centrifugal force of the balls, {angle}, {preload}"
        return "bearings", value, f"{reason}; {friction}{LEFT_OUT}"


def _thrust(case: Case, bearing: BallBearingKeys) -> tuple[float, float]:
    """See BallBearingElement: of a load towards the side to which the bearing holds the shaft."""
    if case.axial is None or bearing.locating is None:
        return 0.0, 0.0
    load, sign = case.axial.load, 1.0 if bearing.locating == "right" else -1.0
    if isinstance(load, LoadAtSpeed):
        return 0.0, sign * load.load / (2.0 * math.pi * load.at) ** 2
    return sign * largest(load), 0.0


def _material(given: AnyRollingMaterial) -> Elastic:
    return ROLLING[given] if isinstance(given, str) else given.solid
