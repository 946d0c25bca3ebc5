"""The keys of a case's bearings and films, as a case file or --set writes them."""

from __future__ import annotations

from frbcli.case.elements import Element
from frbcli.case.film import RingFilm
from frbcli.case.schema import Case
from frbcli.elements.supports import DamperElement


def bearing_key(case: Case, index: int) -> str:
    """The key of a bearing with a film: "bearing", or "bearing.0" where there are several, with or without one."""
    keyed = zip(case.bearing_keys, case.placed_bearings, strict=True)
    return [key for key, bearing in keyed if not isinstance(bearing, Element)][index]


def film_keys(case: Case) -> tuple[str, ...]:
    """The keys of all films in the order of film_places, e.g. "bearing" or "bearing.1.inner"."""
    keyed = zip(case.given_keys, case.given_bearings, strict=True)
    own = (f"{key}.{film}".rstrip(".") for key, bearing in keyed for film in bearing.film_keys)
    return (*own, *(each.key for each in DamperElement.of(case)))


def cavitation_keys(case: Case) -> tuple[tuple[str, str], ...]:
    """Where the cavitation model of each film is written, a key of its own or film.cavitation, and the model."""
    return tuple(
        (f"{key}.cavitation" if isinstance(film, RingFilm) and film.cavitation else "film.cavitation", name)
        for key, film, name in zip(film_keys(case), case.films, case.cavitations, strict=True)
    )
