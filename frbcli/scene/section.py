"""The section of a film that has to be solved, made of a bearing of a case."""

from __future__ import annotations

import math

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.supplies.bores import Bores
from frbcli.case.supplies.supply import MIDDLE
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.gap import Diffusion, Section, whole_width

ELEMENT = 2.0 * math.pi / 20.0  # L of (4.42) in rad: of the elements of figure 6.2


def film_section(case: Case, bearing: FilmGeometry, feed_holes: Bores | None = None) -> Section:
    """The part of the film that has to be solved: half of it where it is symmetric about the middle.

    feed_holes: of the channels of a ring, which the film has in addition to its own supply; they are the last of its
    holes. """
    radius, width, ambient = 0.5 * bearing.diameter, bearing.width, case.oil.ambient_pressure
    opened = bearing.supply.openings(radius, width, bearing.ends, ambient)
    copies, far, holes = opened.copies, opened.far, opened.holes
    if feed_holes is not None:
        if far == "symmetry" and feed_holes.axial_position != MIDDLE:
            copies, far = 1, bearing.ends
        if bearing.supply.mirrored:
            feed_holes = altered(feed_holes, {"axial_position": 1.0 - feed_holes.axial_position})
        holes += feed_holes.holes(radius, width, ambient)
    return Section(
        radius=radius,
        width=width / copies,
        bearing_width=width,
        clearance=bearing.clearance,
        viscosity=case.viscosity(bearing),
        ambient_pressure=ambient,
        cavitation_pressure=case.oil.cavitation_pressure,
        copies=copies,
        near=bearing.ends,
        far=far,
        far_pressure=opened.far_pressure,
        grooves=opened.grooves,
        holes=holes,
        profile=bearing.shell,
        sealed=bearing.sealed,
        bath=bearing.bath,
        largest_flow=bearing.supply.largest_flow / copies,
        flow_roughness=case.contact.flow_roughness,
        shear=case.contact.shear,
        diffusion=diffusion_of(case, bearing),
    )


def diffusion_of(case: Case, film: FilmGeometry) -> Diffusion | None:
    """The artificial diffusion of a film of the two-phase model in its published form, None of others."""
    given = case.film.two_phase
    if case.cavitation(film) != TwoPhase.name or given.form != "published":
        return None
    return Diffusion(ELEMENT if given.diffusion != "none" else 0.0, along=given.diffusion == "consistent")


def is_published(case: Case) -> bool:
    """Whether films of a case have the published form."""
    return any(diffusion_of(case, film) is not None for film in case.films)


def film_rectangle(section: Section) -> Section | None:
    """The section over the whole width, as the modal film is solved on it; None if it has openings or a profile."""
    return None if section.grooves or section.holes or section.profile else whole_width(section)
