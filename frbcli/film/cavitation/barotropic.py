"""The barotropic law of Bayada and Chupin (J. Tribology 135, 041702, 2013): the density of liquid, mixture and vapour
follows from the pressure alone, by the speed of sound, dp/drho = c^2.

In the liquid c = c_l, in the vapour c = c_v. In the mixture between their densities rho_l and rho_v Wood's formula,
1 / (rho c^2) = alpha / (rho_v c_v^2) + (1 - alpha) / (rho_l c_l^2), is linear in rho, for the void fraction alpha is
(rho_l - rho) / (rho_l - rho_v). So

    p = p_cav + N ln(theta / (1 + r (1 - theta))),   theta = rho / rho_l,
    N = rho_v c_v^2 rho_l c_l^2 (rho_l - rho_v) / (rho_l^2 c_l^2 - rho_v^2 c_v^2),
    r = (rho_l c_l^2 / (rho_v c_v^2) - 1) / (1 - theta_v),   theta_v = rho_v / rho_l,

p and c being continuous at both ends. p_cav is where the mixture begins. The paper takes rho_v as given, from which
p_cav follows; here p_cav is given by the case, and rho_v is the one with which the pressure of the vapour is rho c_v^2.

The films have one viscosity eta, and their flow under pressure has no theta: this corresponds to a mixture of the
viscosity theta eta, the mean of liquid and vapour by their volumes if eta_v / eta = rho_v / rho_l. """

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, FilmOil, Key, Law, Numbers, Scales

ITERATIONS, SETTLED = 60, 1e-14  # of Newton's method, which takes five on the average


@dataclass(frozen=True)
class Barotropic(Law):
    """tension: N; ratio: r; liquid: rho_l c_l^2; vapour: rho_l c_v^2, pressures in 1/s; emptied: theta_v; lowest: the
    pressure of the vapour there below p_cav, over N."""

    tension: float
    ratio: float
    liquid: float
    vapour: float
    emptied: float
    lowest: float

    name = "barotropic"
    label = "Bayada-Chupin"
    equation = "(Bayada, Chupin)"
    meaning = "Bayada and Chupin's model: density by the speed of sound in liquid, mixture and vapour."
    cell_words = "density of liquid, mixture and vapour from the speed of sound"
    keys = (
        Key("liquid_sound_speed", 1400.0, "c_l, in the oil", "1400 m/s", unit="m/s", least=10.0, most=1e5),
        Key("vapour_sound_speed", 350.0, "c_v, in its vapour or gas", "350 m/s", unit="m/s", least=1.0, most=1e4),
    )
    cost = 2.0

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        vapour, liquid = oil.density * given.vapour_sound_speed**2, oil.density * given.liquid_sound_speed**2
        emptied = vapour_fraction(vapour, liquid, oil.cavitation)
        tension, ratio, lowest = mixture(emptied, vapour, liquid)
        return cls(tension / oil.scale, ratio, liquid / oil.scale, vapour / oil.scale, emptied, lowest)

    @classmethod
    def legend(cls, given: Any) -> str:
        return f"Bayada-Chupin, $c_v$ = {given.vapour_sound_speed:g} m/s"

    @staticmethod
    def empty(parameters: Numbers, scales: Scales) -> float:
        """w at which the mixture ends and the vapour begins."""
        return parameters[4] - 1.0 + parameters[0] * parameters[5] / scales.reference

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """w = theta - 1 + (p - p_cav) / reference, by Newton's method for u = (p - p_cav) / N in the mixture.

        theta = (1 + r) / (exp(-u) + r) is a logistic function of u, with its inflection at u = -ln r. From there, or
        from the asymptote w = u N / reference - (0 or 1) if that is nearer to the root, the steps only go one way.
        """
        tension, r, liquid, vapour, emptied, lowest = parameters
        share = tension / scales.reference
        bottom = emptied - 1.0 + share * lowest
        if w > 0.0 or w < bottom:
            start, rise, steep = (0.0, 0.0, 1.0 / liquid) if w > 0.0 else (bottom, tension * lowest, 1.0 / vapour)
            by_w = 1.0 / (steep + 1.0 / scales.reference)
            rise += (w - start) * by_w
        else:
            middle = -math.log(r)
            if w < 0.5 * (1.0 + r) / r - 1.0 + share * middle:
                u = min(middle, (w + 1.0) / share)
            else:
                u = max(middle, w / share)
            slope = 0.0
            for _ in range(ITERATIONS):
                theta = (1.0 + r) / (math.exp(-u) + r)
                slope = theta * (1.0 - r * theta / (1.0 + r))
                step = (w - (theta - 1.0 + share * u)) / (slope + share)
                u += step
                if abs(step) <= SETTLED * (1.0 - u):
                    break
            steep = slope / tension
            by_w = 1.0 / (steep + 1.0 / scales.reference)
            rise = tension * u
        return scales.cavitation + rise, 1.0 + w - rise / scales.reference, 0.0, by_w, steep * by_w, 0.0

    def curve(self, ratio: Array) -> Array:
        """theta at p / p_cav."""
        u = (ratio - 1.0) / self.tension
        mixed = _fraction(np.clip(u, self.lowest, 0.0), self.ratio)
        beyond = np.where(u > 0.0, (ratio - 1.0) / self.liquid, 0.0)
        beyond += np.where(u < self.lowest, self.tension * (u - self.lowest) / self.vapour, 0.0)
        return np.asarray(mixed + beyond, dtype=np.float64)


def mixture(emptied: float, vapour: float, liquid: float) -> tuple[float, float, float]:
    """(N, r, (p_v - p_cav) / N) of a mixture that becomes vapour at theta = emptied; vapour, liquid: rho_l c_v^2 and
    rho_l c_l^2, N in their unit."""
    light = emptied * vapour  # rho_v c_v^2
    tension = light * liquid * (1.0 - emptied) / (liquid - emptied * light)
    return tension, (liquid / light - 1.0) / (1.0 - emptied), math.log(emptied * light / liquid)


def vapour_fraction(vapour: float, liquid: float, cavity: float) -> float:
    """theta_v with which the mixture becomes vapour at the pressure rho_v c_v^2; cavity: p_cav, absolute. Raises
    ValueError for a vapour that is not lighter and slower than the liquid there."""
    from scipy.optimize import brentq

    if vapour >= liquid:
        raise ValueError("the vapour is as stiff as the liquid")

    def missing(pressure: float) -> float:
        tension, _, lowest = mixture(pressure / vapour, vapour, liquid)
        return pressure - tension * lowest - cavity

    thin, dense = 1e-9 * cavity, min(cavity, 0.5 * vapour)
    if missing(thin) * missing(dense) > 0.0:
        raise ValueError("the vapour is nowhere much lighter than the liquid")
    return float(brentq(missing, thin, dense, xtol=1e-12 * cavity, rtol=1e-14)) / vapour


def _fraction(u: Any, ratio: float) -> Any:
    """theta of the mixture at u = (p - p_cav) / N."""
    return (1.0 + ratio) / (np.exp(-u) + ratio)
