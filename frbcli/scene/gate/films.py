"""Rules of films, whatever is asked of them: supplies, openings and ends."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import ends_at_ambient
from frbcli.film.section_faults import runs_dry, section_faults
from frbcli.scene.films import film_places
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
