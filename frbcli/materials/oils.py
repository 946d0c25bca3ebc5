"""Oils by grade: viscosity, density, heat capacity and conductivity over temperature, each figure with its source.

An oil of a grade varies: SAE J300 leaves 12.5 to 16.3 mm^2/s at 100 degC to a grade 40, ISO 3448 10 % either way at 40
degC. The figures here are typical ones; a data sheet of the oil in use is better, as Vogel's coefficients in the case.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from frbcli.materials.viscosity import ZERO_CELSIUS, VogelLaw, through_three, walther

TEMPERATURES = (40.0, 100.0, 150.0)  # degC of the viscosities of a grade
EXPANSION = 7.0e-4  # 1/K, of the volume: Incropera and DeWitt, table A.5, engine oil
DENSITY_AT = 15.0 + ZERO_CELSIUS  # K


def heat_capacity(density_15: float, temperature: float) -> float:
    """J/(kg K) of a petroleum oil of a density in kg/m^3 at 15 degC, at a temperature in K.

    Cragoe, NBS Miscellaneous Publication 97 (1929): c = (1.685 + 0.0034 t)/sqrt(s) kJ/(kg K), t in degC, s the specific
    gravity; within 4 %.
    """
    return (1685.0 + 3.4 * (temperature - ZERO_CELSIUS)) / math.sqrt(1e-3 * density_15)


def conductivity(density_15: float, temperature: float) -> float:
    """W/(m K) of a petroleum oil; Cragoe 1929: k = 0.117 (1 - 0.00054 t)/s, t in degC; within 10 %."""
    return 0.117 * (1.0 - 0.00054 * (temperature - ZERO_CELSIUS)) / (1e-3 * density_15)


def density(density_15: float, temperature: float) -> float:
    """kg/m^3 at a temperature in K of an oil of a density in kg/m^3 at 15 degC."""
    return density_15 / (1.0 + EXPANSION * (temperature - DENSITY_AT))


@dataclass(frozen=True)
class OilGrade:
    """An oil of the library. viscosities: dynamic, Pa s, at TEMPERATURES; density_15: kg/m^3 at 15 degC; source: of
    viscosities and density."""

    name: str
    viscosities: tuple[float, float, float]
    density_15: float
    source: str

    @cached_property
    def law(self) -> VogelLaw:
        """Vogel's law through the three viscosities."""
        return through_three([t + ZERO_CELSIUS for t in TEMPERATURES], self.viscosities)


def _three(name: str, density_15: float, at_40: float, at_100: float, at_150: float, source: str) -> OilGrade:
    """Of dynamic viscosities in mPa s."""
    return OilGrade(name, (1e-3 * at_40, 1e-3 * at_100, 1e-3 * at_150), density_15, source)


def _two(name: str, density_15: float, at_40: float, at_100: float, source: str) -> OilGrade:
    """Of dynamic viscosities in mPa s; that at 150 degC by the line of ASTM D341."""
    kelvin = [t + ZERO_CELSIUS for t in TEMPERATURES]
    densities = [density(density_15, t) for t in kelvin]
    first, second = (kelvin[0], 1e3 * at_40 / densities[0]), (kelvin[1], 1e3 * at_100 / densities[1])
    at_150 = 1e-3 * walther(kelvin[2], first, second) * densities[2]
    return _three(name, density_15, at_40, at_100, at_150, f"{source}; at 150 degC by ASTM D341")


REYN = 6894.757  # Pa s


def _seireg(name: str, micro_reyn: float, degrees: float) -> OilGrade:
    """By mu = mu_0 exp(b / (t + 95)), t in degF, mu_0 in micro-reyn, b in degF: a Vogel's law with C = 95 degF."""
    at = [1e-6 * micro_reyn * REYN * math.exp(degrees / (1.8 * t + 32.0 + 95.0)) for t in TEMPERATURES]
    source = "Seireg and Dandage, J. Lubr. Technol. 104 (1982), mu_0 exp(b / (t + 95)); density assumed"
    return OilGrade(name, (at[0], at[1], at[2]), 880.0, source)


_PQIA = "within what PQIA measured of five oils (2016), 96 to 113 and 14.4 to 15.9 mm^2/s at 40 and 100 degC"
_ROSS = "lubricants of the package ROSS"
_GRADES = (
    _three("SAE 10W-40", 870.0, 81.5, 11.7, 4.65, f"typical of the grade, {_PQIA}; density assumed"),
    _three("SAE 5W-30", 860.0, 55.2, 9.2, 3.85, "typical of the grade, within SAE J300; density assumed"),
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
