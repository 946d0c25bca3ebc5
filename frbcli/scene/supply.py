"""Films without a pressurised supply: which they are, why, and what follows for each cavitation model.

Oil flows into a film where its supply, or the bath around its ends, has a pressure above the cavitation pressure. A
mass-conserving film without such a supply loses oil: Elrod's film, whose pressure is never below the cavitation
pressure, loses all of it; the films of Peeken's and the two-phase model draw some oil from a groove. The other models
create the missing oil, and their films carry the full load.

Remedies where a film has no solution: settings that the case does not have yet.

In six runs of random rigid rotors that had no solution (centre of mass 0.3 to 3 clearances off the axis, five of them
in elastic shells) another law or a less steep one never helped, a shell ten times softer in one of five, and other
meshes, tolerances and steps in some by chance: these are not advised.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from frbcli.case.film import FilmGeometry
from frbcli.case.oil import Oil
from frbcli.case.schema import Case
from frbcli.errors import FilmUnsolved, NotConverged
from frbcli.film.cavitation.table import law_named
from frbcli.film.section_faults import is_unfed
from frbcli.scene.films import film_keys, film_places, film_section
from frbcli.scene.planning.film_choice import form_of
from frbcli.units import display


@dataclass(frozen=True)
class UnfedFilm:
    """A film without a pressurised supply. name: as in results; key: of the film in the case; keeps: whether its model
    is mass-conserving, so that the film loses its load; cause, remedy: in words."""

    name: str
    key: str
    cavitation: str
    keeps: bool
    cause: str
    remedy: str

    @property
    def reason(self) -> str:
        """The consequence for the film, for the plan."""
        if self.keeps:
            return f"{self.cause}: more oil leaves than flows in, and the film loses its load"
        return f"{self.cause}: a mass-conserving film would starve; {self.cavitation} creates the missing oil"

    @property
    def remark(self) -> str:
        """The line next to a result, with the remedy."""
        film = f"film {self.name}" if self.name else "the film"
        return f"Note: {film} has no pressurised supply. {self.reason[0].upper()}{self.reason[1:]}. {self.remedy}"


def unfed_films(case: Case) -> tuple[UnfedFilm, ...]:
    """The films of a case without a pressurised supply."""
    unfed: list[UnfedFilm] = []
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        film, cavitation = place.geometry, case.cavitation(place.geometry)
        section = film_section(case, film, place.feed_holes)
        if is_unfed(section, law_named(cavitation)):
            keeps = law_named(cavitation).keeps_oil and section.diffusion is None
            cause, remedy = _cause(film, case.oil), _remedy(film, case.oil, key, cavitation)
            unfed.append(UnfedFilm(place.name, key, cavitation, keeps, cause, remedy))
    return tuple(unfed)


def _cause(film: FilmGeometry, oil: Oil) -> str:
    cavities = f"not above the cavitation pressure of {display(oil.cavitation_pressure, 'Pa')}"
    pressure, feeds = film.supply.absolute(oil.ambient_pressure), film.supply.feeds
    supply = f"its supply of {display(pressure, 'Pa')} is {cavities}" if feeds else "it has no supply"
    if film.ends == "free-to-air":
        return f"its ends are free to air, and {supply}"
    bath = f"the bath around its ends of {display(oil.ambient_pressure, 'Pa')}"
    return f"{supply}, nor is {bath}" if feeds else f"{supply}, and {bath} is {cavities}"


def _remedy(film: FilmGeometry, oil: Oil, key: str, cavitation: str) -> str:
    """Changes of the case that let oil flow in."""
    cavities = display(oil.cavitation_pressure, "Pa")
    first = f"Raise {key}.supply.pressure above {cavities}"
    if not film.supply.feeds:
        example = '{ kind = "circumferential-groove", pressure = "2 bar" }'
        first = f"Give it a supply above {cavities}, e.g. {key}.supply = {example}"
    pushes = not law_named(cavitation).empties or oil.ambient_pressure > oil.cavitation_pressure
    bath = f', or write {key}.ends = "oil-bath"' if film.ends == "free-to-air" and pushes else ""
    return f"{first}{bath}."


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
