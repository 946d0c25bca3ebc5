"""Materials by name, of shafts, rings, housings and rolling bearings, each with its origin, near room temperature."""

from __future__ import annotations

from dataclasses import dataclass


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
