"""Two-phase models, whose oil fraction follows the pressure: Peeken's and the smoothed one.

Peeken's two-phase model (3.38), (3.39): dissolved air comes out of the oil below p_cav, isothermally.

The smoothed two-phase model (4.32) to (4.35): a cubic step of theta(p) between x_0 p_cav and p_cav.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, FilmOil, Key, Law, Numbers, Scales


@dataclass(frozen=True)
class Peeken(Law):
    """bunsen: alpha_B, the volume of dissolved air per volume of oil, in (0, 1]."""

    bunsen: float

    name = "peeken"
    label = "Peeken"
    equation = "(3.39)"
    meaning = "Peeken's model."
    cell_words = "dissolved air comes out of the oil"
    keys = (Key("bunsen", 0.1, "Bunsen's coefficient, share of dissolved gas", "0.1", least=0.0),)
    cost = 1.0
    compared = (("bunsen", (0.1, 0.5, 1.0)),)  # air in oil has about 0.1

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        return cls(given.bunsen)

    @classmethod
    def legend(cls, given: Any) -> str:
        return f"Peeken, $\\alpha_B$ = {given.bunsen:g}"

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """theta = 1 / (1 + r), r = alpha (p_cav - p) / p: (1 - u) / (1 - u + alpha u) of the fall u = 1 - p / p_cav.

        w = theta - 1 - u ratio is a quadratic in u. Newton's method may ask below p = 0, where it goes on linearly.
        """
        if w > 0.0:
            return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
        a = parameters[0]
        cavity = scales.cavitation + scales.ambient
        ratio = cavity / scales.reference
        partial = max(w, -1.0 - ratio)
        linear = a + ratio - partial * (1.0 - a)
        root = math.sqrt(max(linear * linear + 4.0 * ratio * (1.0 - a) * partial, 0.0))
        fall = -2.0 * partial / (linear + root)
        steep = a / (1.0 - fall * (1.0 - a)) ** 2
        fall -= (w - partial) / (steep + ratio)
        rise = 1.0 / (steep + ratio)
        return scales.cavitation - fall * cavity, 1.0 + w + fall * ratio, 0.0, cavity * rise, steep * rise, 0.0

    def curve(self, ratio: Array) -> Array:
        """theta (3.38), (3.39) of oil whose dissolved air comes out below p_cav; the ratio is above 0."""
        below = np.minimum(ratio, 1.0)
        return np.asarray(below / (below + self.bunsen * (1.0 - below)), dtype=np.float64)


# theta'_0, the slope outside of the step. As published it makes the full film as compressible as a bulk modulus of
# 1000 p_cav does; the unknown w needs none, so it may be chosen as small as one likes.
PUBLISHED_SLOPE = 1e-3
STAYS = 0.0
POLISHING = 2  # Newton steps after the sine, whose round-off is large near the ends of the step


def _sine_of_third(half: float) -> float:
    """sin(pi / 6 - 2 asin(half) / 3) for half from 0 to sqrt(1/2), by a polynomial: 1/2 less a part that is known to
    5e-7 of itself. With half = sqrt((1 - s) / 2) it is sin(asin(s) / 3)."""
    part = ((0.432688465 * half - 0.892321406) * half + 0.832232822) * half - 0.376920963
    part = ((part * half + 0.128765482) * half + 0.0174356635) * half + 0.0545670341
    return 0.5 - half * ((part * half + 0.11108111) * half + 0.577350401)


@dataclass(frozen=True)
class TwoPhase(Law):
    """steepness: x_1 of (4.35), the place of the steepest slope over p_cav; outer_slope: theta'_0, at least 0;
    whirl_steepness: what x_1 becomes in a half-frequency whirl, 0: it stays."""

    steepness: float
    outer_slope: float = PUBLISHED_SLOPE
    whirl_steepness: float = STAYS

    name = "two-phase"
    label = "two-phase"
    equation = "(4.32) to (4.35)"
    meaning = "The mass-conserving two-phase model."
    cell_words = "a cubic step of `theta(p)` below `p_cav`"
    keys = (
        Key("steepness", 0.99, "x_1", "0.99", above=0.0, below=1.0),
        Key(
            "whirl_steepness", None, "x_1 while the journal whirls at about half the speed, in run-ups", "0.99",
            above=0.0, below=1.0,
        ),
        Key("form", "conservative", "mass-conserving, or as published (4.31), creating oil",
            choices=("conservative", "published")),
        Key("diffusion", "consistent", "artificial (4.42), of the published form",
            choices=("consistent", "streamline", "none")),
    )  # fmt: skip
    starves = True
    published_form = True
    cost = 1.1
    heavy = 5e6

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        return cls(given.steepness, whirl_steepness=given.whirl_steepness or STAYS)

    @classmethod
    def legend(cls, given: Any) -> str:
        return f"two-phase, $x_1$ = {given.steepness:g}"

    @staticmethod
    def follow(parameters: Numbers, eccentricity: float, speed: float, whirl: float) -> Numbers:
        """See Law.follow: x_1 by the share of whirl."""
        steepness, outer_slope, whirling = parameters
        if whirling != STAYS:
            steepness += (whirling - steepness) * whirl
        return steepness, outer_slope, STAYS

    @staticmethod
    def empty(parameters: Numbers, scales: Scales) -> float:
        """w at which the step begins."""
        steepness, outer_slope, _ = parameters
        absolute = scales.cavitation + scales.ambient
        return outer_slope * (2.0 * steepness - 1.0) - 1.0 - 2.0 * (1.0 - steepness) * absolute / scales.reference

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """w = theta - 1 + (p - p_cav) / reference, solved for p: linear beyond the step, a cubic on it, from the nearer
        end of the step. With u = 1/2 - p~ of (4.34) it reads u^3 - p u + q = 0, whose middle root is a sine. Without a
        branch and without a function of libraries, so that cells are computed side by side. theta does not follow from
        the pressure: the step would multiply its round-off."""
        steepness, outer_slope, _ = parameters
        cavity = scales.cavitation
        absolute = cavity + scales.ambient
        ratio = absolute / scales.reference
        x_0 = 2.0 * steepness - 1.0
        bottom = outer_slope * x_0 - 1.0 + (x_0 - 1.0) * ratio
        height, m = 1.0 - outer_slope * x_0, outer_slope * (1.0 - x_0) / (1.0 - x_0 * outer_slope)
        cubic, linear = height * (1.0 - m), height * m + (1.0 - x_0) * ratio
        radius = math.sqrt((1.5 * cubic + linear) / (6.0 * cubic))
        inside = min(max(w, bottom), 0.0)
        left = min(-inside, inside - bottom)
        sine = (0.5 * (cubic + linear) - left) * (1.0 / (4.0 * cubic * radius * radius * radius))
        part = 0.5 - 2.0 * radius * _sine_of_third(math.sqrt(max(0.5 - 0.5 * sine, 0.0)))
        for _ in range(POLISHING):
            part = min(max(part, 0.0), 0.5)
            defect = cubic * part * part * (3.0 - 2.0 * part) + linear * part - left
            part -= defect / (6.0 * cubic * part * (1.0 - part) + linear)
        part = min(max(part, 0.0), 0.5)
        rise = (x_0 - 1.0) * (part if -inside < inside - bottom else 1.0 - part)
        rise += (w - inside) * (1.0 / (ratio + outer_slope))
        steep = height / (1.0 - x_0) * ((1.0 - m) * 6.0 * part * (1.0 - part) + m)
        slope = outer_slope if w > 0.0 or w < bottom else steep
        by_w = 1.0 / (slope + ratio)
        return cavity + rise * absolute, 1.0 + w - rise * ratio, 0.0, absolute * by_w, slope * by_w, 0.0

    def curve(self, ratio: Array) -> Array:
        """theta (4.32)."""
        return self.fraction(ratio)[0]

    def fraction(self, y: Array) -> tuple[Array, Array]:
        """theta and its slope at y = p / p_cav (n,), (4.32) and (4.33)."""
        x_0, s = self._start, self.outer_slope
        place = np.clip((y - x_0) / (1.0 - x_0), 0.0, 1.0)
        height, m = self._height_and_slope
        theta = height * ((1.0 - m) * place**2 * (3.0 - 2.0 * place) + m * place) + s * x_0
        theta = np.where(y > 1.0, 1.0 + s * (y - 1.0), np.where(y < x_0, s * y, theta))
        return theta, np.where((y > 1.0) | (y < x_0), s, self._slope(place))

    @property
    def _start(self) -> float:
        """x_0, where the step begins."""
        return 2.0 * self.steepness - 1.0

    @property
    def _height_and_slope(self) -> tuple[float, float]:
        """Height of the step and m of (4.34)."""
        x_0, s = self._start, self.outer_slope
        return 1.0 - s * x_0, s * (1.0 - x_0) / (1.0 - x_0 * s)

    def _slope(self, place: Array) -> Array:
        height, m = self._height_and_slope
        slope: Array = height / (1.0 - self._start) * ((1.0 - m) * 6.0 * place * (1.0 - place) + m)
        return slope
