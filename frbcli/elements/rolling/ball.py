"""A ball bearing between shaft and shell: its rings, by the keys of the case."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import AnyRollingMaterial, AxialOffset, BallBearingKeys, LoadAtSpeed
from frbcli.case.schema import Case
from frbcli.case.surroundings.over_time import largest
from frbcli.elements.element import Line, MachineElement, Parts, Site
from frbcli.elements.rolling.bearing import BallBearing
from frbcli.elements.rolling.force import ball_bearing_force, ball_numbers
from frbcli.elements.rolling.rest import at_displacement, balls_of
from frbcli.errors import Fault
from frbcli.materials import ROLLING, Elastic
from frbcli.rotor.assembly import Link
from frbcli.rotor.loads import LinearPart
from frbcli.rotor.port import ANGLE, D_X, D_Y, F_X, F_Y, SPEED, XX, XY, YX, YY, ForceLaw
from frbcli.units import display

LEFT_OUT = "friction, the gyroscopic moment of the balls and moments of the rings are left out"


@dataclass(frozen=True)
class BallForce(ForceLaw):
    """The force of a ball bearing on the shaft. Its cage turns with the shaft, from where a ball is below."""

    rings: BallBearing

    quantity: ClassVar[str] = "ball_force"

    @property
    def turns(self) -> bool:  # type: ignore[override]
        """See ForceLaw: with a cage that turns."""
        return self.rings.turning

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
        return "bearings", value, f"Hertz contacts, centrifugal force of the balls, {angle}, {preload}; {LEFT_OUT}"


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
