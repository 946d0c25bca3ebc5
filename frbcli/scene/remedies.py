"""Remedies where a film has no solution: settings that the case does not have yet.

In six runs of random rigid rotors that had no solution (centre of mass 0.3 to 3 clearances off the axis, five of them
in elastic shells) another law or a less steep one never helped, a shell ten times softer in one of five, and other
meshes, tolerances and steps in some by chance: these are not advised.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from frbcli.case.schema import Case
from frbcli.errors import FilmUnsolved, NotConverged
from frbcli.scene.forms.published import is_published
from frbcli.scene.supply import unfed_films

GENTLE = 0.9  # x_1 of a step that is not steep
NONE_KNOWN = "No setting is known to help: with another mesh or tolerance it is a matter of chance."


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
        if film.two_phase.steepness > GENTLE:
            found.append(f"film.two-phase.steepness = {GENTLE:g} in place of {film.two_phase.steepness:g}")
    return tuple(found)


def film_advice(case: Case) -> str:
    """Why the films of a case may have no solution, where that is known, and the remedy."""
    unfed = [film for film in unfed_films(case) if film.keeps]
    if unfed:
        return " ".join(f"The film has no pressurised supply: {film.cause}. {film.remedy}" for film in unfed)
    return remedies_sentence(film_remedies(case))


def remedies_sentence(remedies: Sequence[str]) -> str:
    """The sentence on the remedies of a case, or that none is known."""
    return f"Possible remedies: {'; '.join(remedies)}." if remedies else NONE_KNOWN
