"""The section of a film that has to be solved, made of a bearing of a case."""

from __future__ import annotations

import math

from frbcli.case.bearing import AxialGrooves, Bores, CircumferentialGroove, FilmGeometry, Pocket
from frbcli.case.schema import Case
from frbcli.film.gap import AxialGroove, Hole, Lobes, Section
from frbcli.film.rectangles.bearing import RectangularBearing

TWO_PI = 2.0 * math.pi


def film_section(case: Case, bearing: FilmGeometry, feed_holes: Bores | None = None) -> Section:
    """The part of the film that has to be solved: half of it where it is symmetric about the middle.

    feed_holes: of the channels of a ring, which the film has beside its own supply; they are the last of its holes.
    """
    supply, ends, width = bearing.supply, bearing.ends, bearing.width
    radius, ambient = 0.5 * bearing.diameter, case.oil.ambient_pressure
    copies, far, far_pressure = 2, "symmetry", 0.0
    grooves: tuple[AxialGroove, ...] = ()
    holes: tuple[Hole, ...] = ()
    if isinstance(supply, CircumferentialGroove):
        copies = 2 if supply.axial_position == 0.5 else 1
        far, far_pressure = "groove", supply.pressure - ambient
    elif isinstance(supply, AxialGrooves):
        places = (supply.position + i * TWO_PI / supply.count for i in range(supply.count))
        grooves = tuple(AxialGroove(place, supply.opening_angle, supply.pressure - ambient) for place in places)
    elif isinstance(supply, Pocket):
        half_angle, half_width = 0.5 * supply.opening_angle, 0.5 * supply.width
        holes = (Hole(supply.position, 0.5 * width, half_angle, half_width, supply.pressure - ambient, round=False),)
    elif isinstance(supply, Bores):
        if supply.axial_position != 0.5:
            copies, far = 1, ends
        holes = _bores(supply, bearing, ambient)
    if feed_holes is not None:
        if far == "symmetry" and feed_holes.axial_position != 0.5:
            copies, far = 1, ends
        mirrored = far == "groove" and getattr(supply, "axial_position", 1.0) < 0.5  # the groove lies at z = 1
        holes += _bores(feed_holes, bearing, ambient, mirrored)
    return Section(
        radius=radius,
        width=width / copies,
        bearing_width=width,
        clearance=bearing.clearance,
        viscosity=case.viscosity(bearing),
        ambient_pressure=ambient,
        cavitation_pressure=case.oil.cavitation_pressure,
        copies=copies,
        near=ends,
        far=far,
        far_pressure=far_pressure,
        grooves=grooves,
        holes=holes,
        lobes=_lobes(bearing),
    )


def _bores(supply: Bores, bearing: FilmGeometry, ambient: float, mirrored: bool = False) -> tuple[Hole, ...]:
    size, radius = 0.5 * supply.diameter, 0.5 * bearing.diameter
    axial = (1.0 - supply.axial_position if mirrored else supply.axial_position) * bearing.width
    places = (supply.position + i * TWO_PI / supply.count for i in range(supply.count))
    return tuple(Hole(p, axial, size / radius, size, supply.pressure - ambient, round=True) for p in places)


def _lobes(bearing: FilmGeometry) -> Lobes | None:
    given = bearing.lobes
    return None if given is None else Lobes(given.count, given.preload, given.position, given.offset)


def film_rectangle(bearing: FilmGeometry, section: Section) -> RectangularBearing | None:
    """The same as a rectangular gap for the modal film; None if it is none."""
    if section.grooves or section.holes or section.lobes:
        return None
    return RectangularBearing(
        width=bearing.width,
        diameter=bearing.diameter,
        clearance=bearing.clearance,
        viscosity=section.viscosity,
        sections=section.copies if section.far == "groove" else 1,
        ambient_pressure=section.ambient_pressure,
        cavitation_pressure=section.cavitation_pressure,
        supply_pressure=section.ambient_pressure + section.far_pressure if section.far == "groove" else None,
    )
