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
from frbcli.scene.planning.film_choice import form_of
from frbcli.scene.supply import unfed_films

NONE_KNOWN = "No setting is known to help: with another mesh or tolerance it is a matter of chance."


@contextmanager
def advised(case: Case) -> Iterator[None]:
    """Raises NotConverged instead of FilmUnsolved, with the failure and the remedies for the case."""
    try:
        yield
    except FilmUnsolved as failure:
        raise NotConverged(f"{failure}. {film_advice(case)}") from failure


def film_remedies(case: Case) -> tuple[str, ...]:
    """Settings with which the films of a case are easier to solve, best first, that the case does not have yet."""
    return form_of(case).remedies(case)


def film_advice(case: Case) -> str:
    """Why the films of a case may have no solution, where that is known, and the remedy."""
    unfed = [film for film in unfed_films(case) if film.keeps]
    if unfed:
        return " ".join(f"The film has no pressurised supply: {film.cause}. {film.remedy}" for film in unfed)
    return remedies_sentence(film_remedies(case))


def remedies_sentence(remedies: Sequence[str]) -> str:
    """The sentence on the remedies of a case, or that none is known."""
    return f"Possible remedies: {'; '.join(remedies)}." if remedies else NONE_KNOWN
