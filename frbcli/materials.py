"""Properties of oils and solids over temperature, by name, each figure with its source.

Viscosity over temperature follows Vogel's law (3.12), from coefficients, from three or from two measured values.

An oil of a grade varies: SAE J300 leaves 12.5 to 16.3 mm^2/s at 100 degC to a grade 40, ISO 3448 10 % either way at 40
degC. The figures here are typical ones; a data sheet of the oil in use is better, as Vogel's coefficients in the case.
docs/heat.md states which figures were compared with a source and which are a choice.

Solids of shafts, rings, housings and rolling bearings are near room temperature.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

ZERO_CELSIUS = 273.15
LARGEST_EXPONENT = 700.0  # of the exponential of a float


@dataclass(frozen=True)
class VogelLaw:
    """eta(T) = eta_0 exp(A / (T + C)) in Pa s (3.12), T in K; eta_0 in Pa s, A and C in K."""

    eta_0: float
    a: float
    c: float

    def at(self, temperature: float) -> float:
        """The dynamic viscosity in Pa s at a temperature in K; infinite below the pole of the law."""
        if temperature + self.c <= 0.0:
            return math.inf
        exponent = self.a / (temperature + self.c)
        return self.eta_0 * math.exp(exponent) if exponent < LARGEST_EXPONENT else math.inf

    def times(self, factor: float) -> VogelLaw:
        """The law of an oil that shear makes thinner by a factor."""
        return replace(self, eta_0=factor * self.eta_0)


def through_three(temperatures: Sequence[float], viscosities: Sequence[float]) -> VogelLaw:
    """The law through three viscosities in Pa s at ascending temperatures in K.

    Of y = ln eta the differences give C: (y1 - y2)/(y2 - y3) (T3 - T2)/(T2 - T1) = (T3 + C)/(T1 + C).
    """
    (t1, t2, t3), (y1, y2, y3) = temperatures, (math.log(value) for value in viscosities)
    ratio = (y1 - y2) / (y2 - y3) * (t3 - t2) / (t2 - t1)
    c = (t3 - ratio * t1) / (ratio - 1.0)
    a = (y1 - y2) * (t1 + c) * (t2 + c) / (t2 - t1)
    return VogelLaw(math.exp(y1 - a / (t1 + c)), a, c)


def walther(temperature: float, first: tuple[float, float], second: tuple[float, float]) -> float:
    """Kinematic viscosity in mm^2/s at a temperature in K by the line of ASTM D341 through two (K, mm^2/s):
    log log(nu + 0.7) is linear in log T."""
    (t1, w1), (t2, w2) = ((math.log(t), math.log(math.log10(nu + 0.7))) for t, nu in (first, second))
    w = w1 + (w2 - w1) * (math.log(temperature) - t1) / (t2 - t1)
    return float(10.0 ** math.exp(w) - 0.7)


TEMPERATURES = (40.0, 100.0, 150.0)  # degC of the viscosities of a grade
EXPANSION = 7.0e-4  # 1/K, of the volume: engine oil of Incropera and DeWitt, table A.5
DENSITY_AT = 15.0 + ZERO_CELSIUS  # K


def heat_capacity(density_15: float, temperature: float) -> float:
    """J/(kg K) of a petroleum oil of a density in kg/m^3 at 15 degC, at a temperature in K.

    c = (1.685 + 0.0034 t)/sqrt(s) kJ/(kg K), t in degC, s the specific gravity; (0.388 + 0.00045 t)/sqrt(s)
    Btu/(lb degF) with t in degF, as others quote it from Cragoe (1929) or Gambill (1957). 1 to 5 % below table A.5 of
    Incropera and DeWitt for engine oil from 280 to 430 K.
    """
    return (1685.0 + 3.4 * (temperature - ZERO_CELSIUS)) / math.sqrt(1e-3 * density_15)


def conductivity(density_15: float, temperature: float) -> float:
    """W/(m K) of a petroleum oil: k = 0.117 (1 - 0.00054 t)/s, t in degC, as others quote it from Cragoe (1929).

    9 to 11 % below table A.5 of Incropera and DeWitt for engine oil from 280 to 430 K.
    """
    return 0.117 * (1.0 - 0.00054 * (temperature - ZERO_CELSIUS)) / (1e-3 * density_15)


def density(density_15: float, temperature: float) -> float:
    """kg/m^3 at a temperature in K of an oil of a density in kg/m^3 at 15 degC."""
    return density_15 / (1.0 + EXPANSION * (temperature - DENSITY_AT))


@dataclass(frozen=True)
class OilGrade:
    """An oil of the library. viscosities: dynamic, Pa s, at TEMPERATURES; density_15: kg/m^3 at 15 degC; source: where
    viscosities and density are from."""

    name: str
    viscosities: tuple[float, float, float]
    density_15: float
    source: str

    @cached_property
    def law(self) -> VogelLaw:
        """Vogel's law through the three viscosities."""
        return through_three([t + ZERO_CELSIUS for t in TEMPERATURES], self.viscosities)


def _three(name: str, density_15: float, at_40: float, at_100: float, at_150: float, source: str) -> OilGrade:
    """A grade with three dynamic viscosities in mPa s."""
    return OilGrade(name, (1e-3 * at_40, 1e-3 * at_100, 1e-3 * at_150), density_15, source)


def _two(name: str, density_15: float, at_40: float, at_100: float, source: str) -> OilGrade:
    """A grade with two dynamic viscosities in mPa s; that at 150 degC follows from the line of ASTM D341."""
    kelvin = [t + ZERO_CELSIUS for t in TEMPERATURES]
    densities = [density(density_15, t) for t in kelvin]
    first, second = (kelvin[0], 1e3 * at_40 / densities[0]), (kelvin[1], 1e3 * at_100 / densities[1])
    at_150 = 1e-3 * walther(kelvin[2], first, second) * densities[2]
    return _three(name, density_15, at_40, at_100, at_150, f"{source}; at 150 degC by ASTM D341")


REYN = 6894.757  # Pa s


def _seireg(name: str, micro_reyn: float, degrees: float) -> OilGrade:
    """By mu = mu_0 exp(b / (t + 95)), t in degF, mu_0 in micro-reyn, b in degF: a Vogel's law with C = 95 degF."""
    at = [1e-6 * micro_reyn * REYN * math.exp(degrees / (1.8 * t + 32.0 + 95.0)) for t in TEMPERATURES]
    source = "Seireg and Dandage, as quoted from Shigley; density: own choice"
    return OilGrade(name, (at[0], at[1], at[2]), 880.0, source)


_MULTIGRADE = "typical values; density: own choice"
_PQIA = "1 % below the thinnest of five oils that PQIA measured in 2016"
_ROSS = "package ROSS"
_GRADES = (
    _three("SAE 10W-40", 870.0, 81.5, 11.7, 4.65, f"{_MULTIGRADE}; {_PQIA}"),
    _three("SAE 5W-30", 860.0, 55.2, 9.2, 3.85, f"{_MULTIGRADE}; within SAE J300 at 100 degC"),
    _two("SAE 0W-20", 850.0, 37.0, 6.6, f"{_MULTIGRADE}; within SAE J300 at 100 degC"),
    _two("SAE 0W-30", 850.0, 52.0, 8.7, f"{_MULTIGRADE}; within SAE J300 at 100 degC"),
    _seireg("SAE 10", 0.0158, 1157.5),
    _seireg("SAE 20", 0.0136, 1271.6),
    _seireg("SAE 30", 0.0141, 1360.0),
    _seireg("SAE 40", 0.0121, 1474.4),
    _seireg("SAE 50", 0.0170, 1509.6),
    _seireg("SAE 60", 0.0187, 1564.0),
    _two("ISO VG 32", 874.0, 1e-3 * 4.05640 * REYN, 1e-4 * 6.76911 * REYN, _ROSS),
    _two("ISO VG 46", 862.9, 1e-3 * 5.75704 * REYN, 1e-4 * 8.81078 * REYN, _ROSS),
    _two("ISO VG 68", 867.0, 57.0722, 7.66498, _ROSS),
)
OILS: dict[str, OilGrade] = {grade.name: grade for grade in _GRADES}


@dataclass(frozen=True)
class Solid:
    """A linear elastic material: modulus in Pa, Poisson's ratio, density in kg/m^3, thermal expansion in 1/K,
    conductivity in W/(m K), heat_capacity in J/(kg K)."""

    modulus: float
    poisson: float
    density: float
    expansion: float
    conductivity: float
    heat_capacity: float
    source: str


@dataclass(frozen=True)
class Elastic:
    """An elastic body: modulus in Pa, Poisson's ratio, density in kg/m^3."""

    modulus: float
    poisson: float
    density: float
    source: str = ""

    @property
    def compliance(self) -> float:
        """(1 - nu^2) / E in 1/Pa."""
        return (1.0 - self.poisson**2) / self.modulus


_A2 = "modulus, Poisson's ratio, density, expansion: table A.2"
_HEAT = "conductivity, heat capacity: Incropera, A.1"
_TYPICAL = "typical value"

STEEL = Solid(210e9, 0.27, 7870.0, 1.18e-5, 60.5, 434.0, f"{_A2} (shaft); {_HEAT}, plain carbon steel")
BRASS = Solid(78e9, 0.37, 8860.0, 1.85e-5, 110.0, 380.0, f"{_A2} (floating ring); {_HEAT}, cartridge brass")
SOLIDS: dict[str, Solid] = {
    "steel": STEEL,
    "brass": BRASS,
    "bronze": Solid(
        110e9, 0.34, 8780.0, 1.8e-5, 54.0, 355.0,
        f"{_HEAT}, with density, phosphor gear bronze; modulus, Poisson's ratio: MakeItFrom, C51000; "
        "expansion: Callister, table B.6, C93200",
    ),
    "stainless steel": Solid(
        193e9, 0.30, 7900.0, 1.72e-5, 14.9, 477.0,
        f"{_HEAT}, with density, AISI 304; modulus, expansion: Callister, tables B.2 and B.6, 304; "
        f"Poisson's ratio: {_TYPICAL}",
    ),
    "Inconel X-750": Solid(
        214e9, 0.29, 8280.0, 1.26e-5, 11.7, 439.0,
        f"{_HEAT}; density: Special Metals, SMC-067; modulus, and Poisson's ratio by the shear modulus: Tokkin, X-750; "
        f"expansion: {_TYPICAL}",
    ),
    "aluminium": Solid(
        71e9, 0.33, 2790.0, 2.29e-5, 168.0, 883.0,
        f"{_HEAT}, with density, cast alloy 195; modulus, Poisson's ratio: MakeItFrom, 295.0; "
        "expansion: Callister, table B.6, 2024",
    ),
}  # fmt: skip

# Of balls and rings of rolling bearings
ROLLING: dict[str, Elastic] = {
    "steel": Elastic(207e9, 0.3, 7800.0, "Harris, Rolling Bearing Analysis, chapter 6; density: typical, AISI 52100"),
    "silicon nitride": Elastic(310e9, 0.27, 3200.0, "typical, hot isostatically pressed, as in hybrid bearings"),
}
