"""The dimensions of a bearing whose gap is made of rectangles."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.film.gap import AxialGroove, Section


@dataclass(frozen=True)
class RectangularBearing:
    """A bearing whose developed gap consists of `sections` equal rectangles side by side, SI units.

    sections: 1 for a plain bearing, 2 for one with a central circumferential groove (figure 4.1); grooved: whether a
    circumferential groove is there, groove_pressure: the gauge pressure in it. Ambient and cavitation pressure are
    absolute. grooves: axial grooves of a plain bearing, which part its rectangle.
    """

    width: float
    diameter: float
    clearance: float
    viscosity: float
    sections: int
    ambient_pressure: float
    cavitation_pressure: float
    grooved: bool = False
    groove_pressure: float = 0.0
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


def rectangular(section: Section) -> RectangularBearing:
    """The bearing of a section without holes and lobes."""
    grooved = section.far == "groove"
    return RectangularBearing(
        width=section.bearing_width,
        diameter=2.0 * section.radius,
        clearance=section.clearance,
        viscosity=section.viscosity,
        sections=section.copies if grooved else 1,  # without a groove the modes span the whole width
        ambient_pressure=section.ambient_pressure,
        cavitation_pressure=section.cavitation_pressure,
        grooved=grooved,
        groove_pressure=section.far_pressure,
        grooves=section.grooves,
    )
