"""The films of a case in operation: warm gap, viscosity, Reynolds number, growth of the journal (section 4.1.5.4)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import attrgetter

from frbcli.case.bearing import FloatingRingBearing, SingleFilmBearing
from frbcli.case.film_geometry import ColdClearance, FilmGeometry
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, speed_shown
from frbcli.elements.damper import DamperElement
from frbcli.film.operating import (
    LAMINAR_BELOW,
    RING_SPEED,
    reynolds_number,
    ring_rotation_strains,
    shaft_rotation_strain,
)
from frbcli.materials.solids import SOLIDS, STEEL, Solid


@dataclass(frozen=True)
class FilmOperation:
    """One film at the top speed of a case, SI units.

    omega: omega_J + omega_S in rad/s; warming: what heat has added to the cold clearance in m; turning: what the growth
    of a shaft and a ring that turn would add to the clearance in m, which is left out.
    """

    name: str
    clearance: float
    viscosity: float
    omega: float
    reynolds: float
    warming: float
    turning: float

    @property
    def laminar(self) -> bool:
        """Whether (3.3) holds."""
        return self.reynolds < LAMINAR_BELOW


# Of a FilmOperation
FILM_OPERATION = (
    Column("film", "", "name of the film", attrgetter("name"), shown=(Shown("film"),)),
    Column("clearance", "m", "clearance", shown=(Shown("gap, um", ".4g", "um"),)),
    Column("warming", "m", "what heat has added to it", shown=(Shown("by heat, um", "+.3g", "um"),)),
    Column("turning", "m", "what centrifugal growth would add", shown=(Shown("by turning", "+.2g", "um"),)),
    Column("viscosity", "Pa s", "viscosity of the oil", shown=(Shown("mPa*s", ".4g", "mPa s"),)),
    Column("speed", "Hz", "speed of journal and shell together", lambda film: film.omega / (2.0 * math.pi),
           shown=(speed_shown(),)),
    Column("reynolds_number", "", "Reynolds number (3.3)", attrgetter("reynolds"), shown=(Shown("Re (3.3)", ".0f"),)),
    Column("laminar", "", "whether (3.3) holds"),
)  # fmt: skip


def operating_points(case: Case) -> tuple[FilmOperation, ...]:
    """Every film of a case at its top speed: of [speed], or of a kinematic test."""
    omega = 2.0 * math.pi * _top_speed(case)
    operations: list[FilmOperation] = []
    for bearing in case.bearings:
        if isinstance(bearing, SingleFilmBearing):
            strain = shaft_rotation_strain(_shaft(case), omega, 0.5 * bearing.diameter)
            operations.append(_operation(case, bearing, bearing.name or "film", omega, -strain))
        else:
            operations.extend(_floating(case, bearing, omega))
    operations += [_operation(case, each.given, each.film, 0.0, 0.0) for each in DamperElement.of(case)]
    return tuple(operations)


def _floating(case: Case, bearing: FloatingRingBearing, omega: float) -> tuple[FilmOperation, FilmOperation]:
    ring = RING_SPEED * omega if bearing.ring.spin == "free" else 0.0
    within, without = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter
    shaft = shaft_rotation_strain(_shaft(case), omega, within)
    inside, outside = ring_rotation_strains(bearing.ring.solid, ring, within, without)
    name = f"{bearing.name} ".lstrip()
    return (
        _operation(case, bearing.inner, f"{name}inner", omega + ring, inside - shaft),
        _operation(case, bearing.outer, f"{name}outer", ring, -outside),
    )


def _shaft(case: Case) -> Solid:
    return STEEL if case.thermal is None else SOLIDS[case.thermal.shaft_material]


def _operation(case: Case, film: FilmGeometry, name: str, omega: float, strain: float) -> FilmOperation:
    radius, viscosity = 0.5 * film.diameter, case.viscosity(film)
    given = film.given_clearance
    return FilmOperation(
        name=name,
        clearance=film.clearance,
        viscosity=viscosity,
        omega=omega,
        reynolds=reynolds_number(case.oil.density, omega, radius, film.clearance, viscosity),
        warming=film.clearance - given.cold if isinstance(given, ColdClearance) else 0.0,
        turning=radius * strain,
    )


def _top_speed(case: Case) -> float:
    speeds = [] if case.given_speed is None else [case.given_speed.start, case.given_speed.end]
    return max([*speeds, abs(case.motion.speed or 0.0) if case.motion is not None else 0.0])
