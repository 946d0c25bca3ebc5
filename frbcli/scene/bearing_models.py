"""Bearing models in a case: the chosen model, the faults of such a case, and the record of the model in a run."""

from __future__ import annotations

import math

from frbcli.case.bearing import CircumferentialGroove, FilmGeometry
from frbcli.case.schema import Case
from frbcli.case.theories import values_of
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model.checks import fingerprint, model_film, problem_of
from frbcli.film.bearing_model.film import BearingModelFilm
from frbcli.film.bearing_model.model import BearingDimensions, BearingModel
from frbcli.film.bearing_model.table import model_named
from frbcli.film.cavitation.table import law_named
from frbcli.film.rectangles.bearing import RectangularBearing
from frbcli.scene.films import film_places, turning_rings
from frbcli.scene.keys import film_keys
from frbcli.scene.section import film_rectangle, film_section

GIVEN = "force of a bearing model"  # the form of such a film
RECORD = "bearing_model"  # among the versions of a run
WHY = "set in the case; added from Python"
TOLD = "the whole bearing by one function of displacement, velocity and speed; derivatives by {}"


def chosen_model(case: Case) -> BearingModel | None:
    """The bearing model of a case, None for films of the program. Raises InputError if the process does not have it."""
    name = case.film.bearing_model
    if not name:
        return None
    try:
        return model_named(name)
    except KeyError:
        problem = "is a bearing model that this process does not have: another process added it from Python."
        fault = Fault("film.theory", name, None, problem, "Call frbcli.add_bearing with it first.")
        raise InputError(case.name or "case", (fault,)) from None


def bearing_film(case: Case, bearing: RectangularBearing) -> BearingModelFilm:
    """The film of a bearing, by the chosen model."""
    model = chosen_model(case)
    assert model is not None
    supply = bearing.ambient_pressure if bearing.supply_pressure is None else bearing.supply_pressure
    dimensions = BearingDimensions(
        width=bearing.width,
        diameter=bearing.diameter,
        clearance=bearing.clearance,
        viscosity=bearing.viscosity,
        sections=bearing.sections,
        section_width=bearing.section_width,
        ambient_pressure=bearing.ambient_pressure,
        cavitation_pressure=bearing.cavitation_pressure,
        supply_pressure=supply,
    )
    return model_film(model, dimensions, values_of(model, case.film))


def model_decisions(model: BearingModel) -> tuple[tuple[str, str, str], ...]:
    """The decisions of the plan for a bearing model: choice, value, reason."""
    by = "differences" if model.derivatives is None else "the model"
    return (
        ("theory", model.name, f"{model.label}: {WHY}"),
        ("cavitation", "in the model", "film.cavitation and bearing.ends have no effect"),
        ("film", GIVEN, TOLD.format(by)),
    )


def model_faults(case: Case, omega: float) -> list[Fault]:
    """The faults of a case with a bearing model. omega: highest speed of the rotor, rad/s. Raises
    InputError if this process does not have the model."""
    model = chosen_model(case)
    if model is None:
        return []
    faults = [*_key_faults(case), *_ring_faults(case)]
    keys, places = film_keys(case), film_places(case)
    for key, place in zip(keys, places, strict=True):
        faults += _geometry_faults(key, place.geometry)
    if faults:
        return faults
    for place in places:
        rectangle = film_rectangle(place.geometry, film_section(case, place.geometry))
        assert rectangle is not None
        if problem := problem_of(model, bearing_film(case, rectangle), omega):
            remedy = "Correct the function of the model, and add it again."
            faults.append(Fault("film.theory", model.name, None, f"{problem}.", remedy))
    return faults


def model_record(case: Case) -> dict[str, str]:
    """The record of the bearing model of a run, empty for films of the program."""
    model = chosen_model(case)
    if model is None:
        return {}
    rectangles = (film_rectangle(place.geometry, film_section(case, place.geometry)) for place in film_places(case))
    omega = 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end))
    forces = ", ".join(fingerprint(bearing_film(case, found), omega) for found in rectangles if found is not None)
    return {RECORD: f"{model.name}, added from Python; forces {forces}"[:200]}


def _key_faults(case: Case) -> list[Fault]:
    """Keys that are set and have no effect on a bearing model."""
    film = case.film
    cavitation = next((law for law in case.cavitations if not law_named(law).closed), "")
    asked = {
        "solution": ("" if film.solution == "auto" else film.solution, "Write auto."),
        "grid": ("" if film.grid == "fixed" else film.grid, "Write fixed."),
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
    if supply.kind not in ("none", "circumferential-groove"):
        problem = "is a supply that a bearing model cannot represent."
        faults.append(Fault(f"{key}.supply.kind", supply.kind, None, problem, remedy))
    elif isinstance(supply, CircumferentialGroove) and supply.ramp > 0.0:
        problem = "is a ramp of the pressure, which a bearing model cannot represent."
        faults.append(Fault(f"{key}.supply.ramp", f"{supply.ramp:g} s", None, problem, "Write 0 s."))
    elif isinstance(supply, CircumferentialGroove) and supply.axial_position not in (0.0, 0.5, 1.0):
        problem, value = "makes two different films.", f"{supply.axial_position:g}"
        faults.append(Fault(f"{key}.supply.axial_position", value, None, problem, "Write 0.5, 0 or 1."))
    if film.lobes is not None:
        value = f"{film.lobes.count} lobes"
        faults.append(Fault(f"{key}.lobes", value, None, "are a shape that a bearing model cannot represent.", remedy))
    return faults
