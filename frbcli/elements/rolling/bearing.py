"""A ball bearing: its geometry, contacts and frequencies.

The contact angle without load is given by the grooves, or follows from the radial clearance G, by which one ring moves
from one side to the other: cos(alpha_0) = 1 - G / (2 A), A = (f_i + f_o - 1) d (Harris, Rolling Bearing Analysis,
chapter 2).

Hertz's contact of two elastic bodies with four principal curvatures: approach, ellipse and largest pressure.

Harris, Rolling Bearing Analysis, chapter 6: with the ellipticity kappa = a / b, complete elliptic integrals K and E of
the parameter m = 1 - 1 / kappa^2, the sum S of the curvatures and 1 / E* = sum of (1 - nu^2) / E,

    F = ((kappa^2 + 1) E - 2 K) / ((kappa^2 - 1) E)          the difference of the curvatures over S
    a = (2 kappa^2 E / pi)^(1/3) L,  b = a / kappa,  L = (3 Q / (2 S E*))^(1/3)
    delta = (2 K / pi) (pi / (2 kappa^2 E))^(1/3) S L^2 / 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frbcli.arrays import Array
from frbcli.elements.rolling.force import KNOWN, RINGS, BallNumbers
from frbcli.materials import Elastic

NEARLY_ROUND = 1e-4  # difference of the curvatures below which F is 3/4 ln kappa but for its third power


@dataclass(frozen=True)
class HertzContact:
    """A contact without its load. curvature: sum S of the principal curvatures, 1/m; modulus: E* in Pa; ellipticity:
    long over short axis; first, second: the complete elliptic integrals K and E."""

    curvature: float
    modulus: float
    ellipticity: float
    first: float
    second: float

    @property
    def stiffness(self) -> float:
        """K in N/m^1.5 of the load Q = K delta^1.5."""
        kappa, s = self.ellipticity, self.curvature
        approach = 2.0 * self.first / math.pi * (math.pi / (2.0 * kappa**2 * self.second)) ** (1.0 / 3.0)
        return float(2.0 * self.modulus * s / 3.0 * (2.0 / (s * approach)) ** 1.5)

    def axes(self, load: float) -> tuple[float, float]:
        """Long and short half axis in m of the ellipse under a load in N."""
        size = (1.5 * load / (self.curvature * self.modulus)) ** (1.0 / 3.0)
        long = (2.0 * self.ellipticity**2 * self.second / math.pi) ** (1.0 / 3.0) * size
        return long, long / self.ellipticity

    def pressure(self, load: float) -> float:
        """Largest pressure in Pa under a load in N."""
        if load <= 0.0:
            return 0.0
        long, short = self.axes(load)
        return 1.5 * load / (math.pi * long * short)


def contact(one: Elastic, other: Elastic, rolling: float, across: float) -> HertzContact:
    """The contact of two bodies; rolling, across: sums of both bodies' curvatures in 1/m along two directions at right
    angles, concave ones negative. Raises ValueError if a body does not touch the other in a point."""
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    low, high = sorted((rolling, across))
    if low <= 0.0:
        raise ValueError(f"curvatures of {low:.4g} 1/m along a contact: the bodies are not apart next to it")
    total, difference = rolling + across, (high - low) / (rolling + across)

    def integrals(kappa: float) -> tuple[float, float]:
        return float(ellipkm1(1.0 / kappa**2)), float(ellipe(1.0 - 1.0 / kappa**2))

    def missed(log_kappa: float) -> float:
        kappa = math.exp(log_kappa)
        first, second = integrals(kappa)
        return float(((kappa**2 + 1.0) * second - 2.0 * first) / ((kappa**2 - 1.0) * second) - difference)

    log_kappa = 4.0 / 3.0 * difference
    if difference > NEARLY_ROUND:  # kappa is below the ratio of the curvatures
        log_kappa = float(brentq(missed, 0.5 * difference, math.log(high / low), xtol=1e-15))
    kappa = math.exp(log_kappa)
    modulus = 1.0 / (one.compliance + other.compliance)
    return HertzContact(total, modulus, kappa, *integrals(kappa))


SMALL_APPROACH = 1e-6  # m
MEAN_POINTS = 24  # at which balls that are spread evenly are summed, at least; twice as many balls are as good


@dataclass(frozen=True)
class BallBearing:
    """One or two equal rows of balls between two rings, SI units.

    balls: of one row; pitch_diameter: of the circle of their centres; contact_angle: without load, rad; inner, outer:
    radii of the grooves over the diameter of a ball; ball, ring: their materials; rows: 1 or 2; preload: along the axis
    on each row, N, or None where the rings are held at `offset`, the axial displacement in m from their first contact;
    turning: whether the balls pass, or act as if they were spread evenly; thrust: on all rows in addition to the
    preload, in N, and over the square of the speed of the shaft, in N s^2.
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
        )

    @property
    def memory(self) -> Array:
        """(m,) for the kernels: nothing is known yet."""
        return np.zeros(RINGS + KNOWN * self.points)
