"""The films of a case with a bearing model: compiled, tried, and recorded in a run; the faults of such a case."""

from __future__ import annotations

import math

from frbcli.case.bearing import FilmGeometry
from frbcli.case.schema import Case
from frbcli.case.theories import values_of
from frbcli.errors import Fault
from frbcli.film.bearing_model.checks import fingerprint, model_film, problem_of
from frbcli.film.bearing_model.film import BearingModelFilm
from frbcli.film.bearing_model.model import BearingDimensions, BearingModel
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import Section
from frbcli.scene.films import film_places, turning_rings
from frbcli.scene.forms.models import chosen_model
from frbcli.scene.keys import film_keys
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


def model_faults(case: Case, omega: float) -> list[Fault]:
    """The faults of a case with a bearing model; none for films of the program. omega: highest speed of the rotor,
    rad/s. Raises InputError if this process does not have the model."""
    model = chosen_model(case)
    if model is None:
        return []
    faults = [*_key_faults(case), *_ring_faults(case)]
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        faults += _geometry_faults(key, place.geometry)
    return faults or _force_faults(case, model, omega)


def model_record(case: Case) -> dict[str, str]:
    """The record of the bearing model of a run, empty for films of the program."""
    model = chosen_model(case)
    if model is None:
        return {}
    rectangles = (film_rectangle(film_section(case, place.geometry)) for place in film_places(case))
    omega = 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end))
    forces = ", ".join(fingerprint(bearing_film(case, found), omega) for found in rectangles if found is not None)
    return {RECORD: f"{model.name}, added from Python; forces {forces}"[:200]}


def _key_faults(case: Case) -> list[Fault]:
    """Keys that are set and have no effect on a bearing model."""
    film = case.film
    cavitation = next((law for law in case.cavitations if not law_named(law).closed), "")
    asked = {
        "solution": ("" if film.solution == "auto" else film.solution, "Write auto."),
        "grid": (film.grid if film.grid == "half-speed" else "", "Write auto."),
        "cavitation": (cavitation, "Leave it out, or write half-sommerfeld."),
        "coupling": (film.coupling if film.coupling == "monolithic" else "", "Write dynamic-static or auto."),
    }
    problem = f"has no effect with film.theory = {film.theory}, a bearing model, which gives the whole force."
    return [Fault(f"film.{key}", value, None, problem, remedy) for key, (value, remedy) in asked.items() if value]


def _ring_faults(case: Case) -> list[Fault]:
    if not turning_rings(case):
        return []
    problem = "needs the torques of the films, which a bearing model does not give."
    return [Fault("bearing.ring.spin", "free", None, problem, 'Write spin = "blocked".')]


def _geometry_faults(key: str, film: FilmGeometry) -> list[Fault]:
    """Parts of a bearing that a model cannot represent."""
    faults = []
    supply, remedy = film.supply, "Leave it out: the model stands for the whole bearing."
    if not supply.plain:
        problem = "is a supply that a bearing model cannot represent."
        faults.append(Fault(f"{key}.supply.kind", supply.kind, None, problem, remedy))
    elif supply.rise_time > 0.0:
        problem = "is a ramp of the pressure, which a bearing model cannot represent."
        faults.append(Fault(f"{key}.supply.ramp", f"{supply.rise_time:g} s", None, problem, "Write 0 s."))
    if film.lobes is not None:
        value = f"{film.lobes.count} lobes"
        faults.append(Fault(f"{key}.lobes", value, None, "are a shape that a bearing model cannot represent.", remedy))
    return faults


def _force_faults(case: Case, model: BearingModel, omega: float) -> list[Fault]:
    faults = []
    for place in film_places(case):
        rectangle = film_rectangle(film_section(case, place.geometry))
        assert rectangle is not None
        if problem := problem_of(model, bearing_film(case, rectangle), omega):
            remedy = "Correct the function of the model, and add it again."
            faults.append(Fault("film.theory", model.name, None, f"{problem}.", remedy))
    return faults
