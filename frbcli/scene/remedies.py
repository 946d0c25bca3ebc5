"""Remedies where a film has no solution: settings that the case does not have yet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from frbcli.case.schema import Case
from frbcli.errors import FilmUnsolved, NotConverged
from frbcli.scene.forms.published import is_published
from frbcli.scene.supply import unfed_films

GENTLE = 0.9  # x_1 of a step that is not steep


@contextmanager
def advised(case: Case) -> Iterator[None]:
    """Turns FilmUnsolved into NotConverged, with the failure and the remedies for the case."""
    try:
        yield
    except FilmUnsolved as failure:
        raise NotConverged(f"{failure}. {film_advice(case)}") from failure


def film_remedies(case: Case) -> tuple[str, ...]:
    """Settings with which the films of a case are easier to solve, best first, that the case does not have yet."""
    models, film = set(case.cavitations), case.film
    if film.bearing_model:
        return (f"a force of film.theory = {film.bearing_model} without jumps, or with derivatives of its own",)
    found = []
    if "two-phase" in models and is_published(case):
        found.append('film.two-phase.form = "conservative"')
        if film.two_phase.diffusion != "consistent":
            found.append('film.two-phase.diffusion = "consistent"')
    if "two-phase" in models and film.two_phase.steepness > GENTLE:
        found.append(f"film.two-phase.steepness = {GENTLE:g} in place of {film.two_phase.steepness:g}")
    if "penalty" in models and film.penalty.pressure == "absolute":
        found.append('film.penalty.pressure = "dimensionless", which is less steep')
    if "reynolds" in models:
        found.append("the penalty model, which has no kink at the edge of the cavity")
    if case.accuracy.mesh is None:
        found.append("another mesh, accuracy.mesh")
    else:
        along, around = case.accuracy.mesh
        found.append(f"another accuracy.mesh than [{along}, {around}], or none: the plan then chooses one")
    return tuple(found)


def film_advice(case: Case) -> str:
    """Why the films of a case may have no solution, where that is known, and the remedy."""
    unfed = [film for film in unfed_films(case) if film.keeps]
    if unfed:
        return " ".join(f"The film has no pressurised supply: {film.cause}. {film.remedy}" for film in unfed)
    return f"Possible remedies: {'; '.join(film_remedies(case))}."
