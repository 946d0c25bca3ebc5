"""Oils by grade: viscosity, density, heat capacity and conductivity over temperature, each figure with its origin.

An oil of a grade varies: SAE J300 leaves 12.5 to 16.3 mm^2/s at 100 degC to a grade 40, ISO 3448 10 % either way at 40
degC. The figures here are typical ones; a data sheet of the oil in use is better, as Vogel's coefficients in the case.
docs/heat.md states which figures were compared with a source and which are a choice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from frbcli.materials.viscosity import ZERO_CELSIUS, VogelLaw, through_three, walther

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
