"""The dimensions of a bearing whose gap is made of rectangles."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.film.gap import AxialGroove


@dataclass(frozen=True)
class RectangularBearing:
    """A bearing whose developed gap consists of `sections` equal rectangles side by side, SI units.

    sections: 1 for a plain bearing, 2 for one with a central circumferential groove (figure 4.1); supply_pressure: in
    the groove, None without one. Pressures are absolute. grooves: axial grooves of a plain bearing, which part its
    rectangle.
    """

    width: float
    diameter: float
    clearance: float
    viscosity: float
    sections: int
    ambient_pressure: float
    cavitation_pressure: float
    supply_pressure: float | None
    grooves: tuple[AxialGroove, ...] = ()

    @property
    def section_width(self) -> float:
        """Width b of one section, m."""
        return self.width / self.sections

    @property
    def pressure_scale(self) -> float:
        """12 eta / psi^2: turns a scaled pressure (1/s) into Pa, see (3.9)."""
        psi = self.clearance / (0.5 * self.diameter)
        return 12.0 * self.viscosity / psi**2

    @property
    def force_scale(self) -> float:
        """R b times pressure_scale times the number of sections, N s, see (3.13)."""
        return 0.5 * self.diameter * self.width * self.pressure_scale
