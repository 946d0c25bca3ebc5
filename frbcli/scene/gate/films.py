"""Rules of films, whatever is asked of them: supplies, openings and ends, heat, own bearing models."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FilmGeometry
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import ends_at_ambient
from frbcli.film.section_faults import runs_dry, section_faults
from frbcli.scene.coupling import APART
from frbcli.scene.films import film_places, turning_rings
from frbcli.scene.forms.models import chosen_model
from frbcli.scene.forms.published import is_published
from frbcli.scene.keys import film_keys
from frbcli.scene.section import film_section


def supply_faults(case: Case) -> Iterator[Fault]:
    """Faults of each film without its neighbours: its supply, its openings, its ends."""
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        supply = place.geometry.supply
        if own := supply.faults(f"{key}.supply"):
            yield from own
            continue
        section = film_section(case, place.geometry, place.feed_holes)
        if not law_named(case.cavitation(place.geometry)).keeps_oil:  # it makes its oil, and cannot run dry
            section = ends_at_ambient(section)
        at, value = (f"{key}.supply.kind", supply.kind) if runs_dry(section) else (key, place.name)
        for found in section_faults(section):
            yield Fault(at, value, None, f"cannot be solved: {found.problem}.", found.remedy)


def heat_faults(case: Case) -> Iterator[Fault]:
    """What heat cannot be modelled together with."""
    if case.heat is None:
        return
    if case.film.bearing_model:
        problem = "has neither torque nor flow, which the balance of [thermal] needs."
        yield Fault("film.theory", case.film.theory, None, problem, "Write finite, short or auto.")
    if is_published(case):
        problem = "creates oil, which would carry away heat that nobody has put in: no balance of [thermal]."
        yield Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".')
    if case.film.coupling == APART:
        problem = "exchanges forces alone between rotor and films; [thermal] would follow a film that is not there yet."
        yield Fault("film.coupling", APART, None, problem, "Write auto.")


def model_faults(case: Case) -> Iterator[Fault]:
    """Keys and parts of a case that an own bearing model cannot represent."""
    if not case.film.bearing_model:
        return
    yield from _key_faults(case)
    if turning_rings(case):
        problem = "needs the torques of the films, which a bearing model does not give."
        yield Fault("bearing.ring.spin", "free", None, problem, 'Write spin = "blocked".')
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        yield from _geometry_faults(key, place.geometry)


def force_faults(case: Case, omega: float) -> Iterator[Fault]:
    """An own bearing model whose function gives forces that cannot be used; omega: highest rotor speed in rad/s. Raises
    InputError if this process does not have the model."""
    model = chosen_model(case)
    if model is None:
        return
    from frbcli.scene.machine.bearing_model_films import force_problems  # numba takes longer to import than a plan

    remedy = "Correct the function of the model, and add it again."
    for problem in force_problems(case, model, omega):
        yield Fault("film.theory", model.name, None, f"{problem}.", remedy)


def _key_faults(case: Case) -> Iterator[Fault]:
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
    for key, (value, remedy) in asked.items():
        if value:
            yield Fault(f"film.{key}", value, None, problem, remedy)


def _geometry_faults(key: str, film: FilmGeometry) -> Iterator[Fault]:
    """Parts of a bearing that a model cannot represent."""
    supply, remedy = film.supply, "Leave it out: the model stands for the whole bearing."
    if not supply.plain:
        problem = "is a supply that a bearing model cannot represent."
        yield Fault(f"{key}.supply.kind", supply.kind, None, problem, remedy)
    elif supply.rise_time > 0.0:
        problem = "is a ramp of the pressure, which a bearing model cannot represent."
        yield Fault(f"{key}.supply.ramp", f"{supply.rise_time:g} s", None, problem, "Write 0 s.")
    if film.lobes is not None:
        value = f"{film.lobes.count} lobes"
        yield Fault(f"{key}.lobes", value, None, "are a shape that a bearing model cannot represent.", remedy)
