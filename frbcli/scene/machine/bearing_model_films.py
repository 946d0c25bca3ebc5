"""The films of a case with a bearing model: compiled, tried, and recorded in a run."""

from __future__ import annotations

import math
from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.case.theories import values_of
from frbcli.film.bearing_model.checks import fingerprint, model_film, problem_of
from frbcli.film.bearing_model.film import BearingModelFilm
from frbcli.film.bearing_model.model import BearingDimensions, BearingModel
from frbcli.film.gap import Section
from frbcli.scene.films import film_places
from frbcli.scene.forms.models import chosen_model
from frbcli.scene.section import film_rectangle, film_section

RECORD = "bearing_model"  # among the versions of a run


def bearing_film(case: Case, section: Section) -> BearingModelFilm:
    """The film of a section over the whole width, by the chosen model."""
    model = chosen_model(case)
    assert model is not None
    dimensions = BearingDimensions(
        width=section.bearing_width,
        diameter=2.0 * section.radius,
        clearance=section.clearance,
        viscosity=section.viscosity,
        sections=section.copies,
        section_width=section.width,
        ambient_pressure=section.ambient_pressure,
        cavitation_pressure=section.cavitation_pressure,
        supply_pressure=section.ambient_pressure + section.far_pressure,
    )
    return model_film(model, dimensions, values_of(model, case.film))


def force_problems(case: Case, model: BearingModel, omega: float) -> Iterator[str]:
    """What is wrong with the forces that a model gives for each film; omega: highest speed of the rotor, rad/s."""
    for place in film_places(case):
        rectangle = film_rectangle(film_section(case, place.geometry))
        assert rectangle is not None
        if problem := problem_of(model, bearing_film(case, rectangle), omega):
            yield problem


def model_record(case: Case) -> dict[str, str]:
    """The record of the bearing model of a run, empty for films of the program."""
    model = chosen_model(case)
    if model is None:
        return {}
    rectangles = (film_rectangle(film_section(case, place.geometry)) for place in film_places(case))
    omega = 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end))
    forces = ", ".join(fingerprint(bearing_film(case, found), omega) for found in rectangles if found is not None)
    return {RECORD: f"{model.name}, added from Python; forces {forces}"[:200]}
