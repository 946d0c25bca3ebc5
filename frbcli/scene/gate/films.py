"""Rules of films, whatever is asked of them: supplies, openings and ends."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import ends_at_ambient
from frbcli.film.section_faults import runs_dry, section_faults
from frbcli.scene.films import film_places
from frbcli.scene.forms.published import PUBLISHED
from frbcli.scene.forms.tables import CLIPPED
from frbcli.scene.keys import film_keys
from frbcli.scene.planning.film_choice import film_form, form_of
from frbcli.scene.section import film_section

ENCLOSED = 0.01  # share of the flow of an open end below which the oil of a film that nothing feeds is enclosed in it


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


def sealed_faults(case: Case) -> Iterator[Fault]:
    """Films with sealed ends that are not solved so."""
    form = form_of(case)
    for key, film in _sealed_films(case):
        at = f"{key}.ends"
        if form is PUBLISHED:
            problem = "seals the ends, and the published form is that of (4.31) with its own ends, open ones."
            yield Fault(at, _told(film), None, problem, 'Write film.two-phase.form = "conservative".')
        elif case.film.theory == "short" and film_form(case, film, "short") is CLIPPED:
            problem = "lets a cavity reach the ends, where a short bearing clips between the pressures of open ends."
            yield Fault(at, _told(film), None, problem, 'Write film.theory = "finite".')
        elif form.by_cells:
            yield from _enclosed(case, key, film)


def enclosed_faults(case: Case) -> Iterator[Fault]:
    """Films whose oil is enclosed, in tests, which show their pressure on cells."""
    return (fault for key, film in _sealed_films(case) for fault in _enclosed(case, key, film))


def _sealed_films(case: Case) -> Iterator[tuple[str, FilmGeometry]]:
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        if place.geometry.sealed < 1.0:
            yield key, place.geometry


def _enclosed(case: Case, key: str, film: FilmGeometry) -> Iterator[Fault]:
    """Oil that does not come in or leave has the pressure that it was enclosed with."""
    if film.sealed < ENCLOSED and not film.supply.feeds and not case.film.bearing_model:
        problem = "encloses the oil, for nothing feeds the film: the level of its pressure is that of its filling."
        remedy = f"Give it a supply, or a share of at least {ENCLOSED:g}; runs with half-sommerfeld take any."
        yield Fault(f"{key}.ends", _told(film), None, problem, remedy)


def _told(film: FilmGeometry) -> str:
    return f"sealed = {film.sealed:g}"
