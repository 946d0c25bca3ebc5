"""Clearances that change in steps during a run, by heat or wear: times, values, and the case after each step.

The rotor keeps its displacement and velocity, a mass-conserving film its oil (runs/clearance_step.py). The motion of
the gap while it changes is left out.
"""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.scene.films import film_places


def step_times(case: Case) -> tuple[float, ...]:
    """Times in s at which a clearance changes, ascending."""
    return tuple(sorted({step.time for film in case.films for step in film.clearance_steps}))


def case_at(case: Case, time: float) -> Case:
    """The case with the clearances that it has at a time in s."""
    return case.with_films([_film_at(film, time) for film in case.films])


def clearance_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """The decisions about clearances that change: choice, value, reason."""
    for place in film_places(case):
        steps = place.geometry.clearance_steps
        if steps:
            told = [f"{1e6 * step.clearance:.4g} um from {step.time:g} s" for step in steps]
            value = ", ".join([f"{1e6 * place.geometry.clearance:.4g} um", *told])
            yield f"clearance {place.name}".rstrip(), value, "set in the case; rotor and oil keep their state"


def _film_at(film: FilmGeometry, time: float) -> FilmGeometry:
    passed = [step.clearance for step in film.clearance_steps if step.time <= time]
    return altered(film, {"given_clearance": passed[-1], "clearance_steps": ()}) if passed else film
