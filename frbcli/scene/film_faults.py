"""The gate that every case passes before a film is made of it, whatever is asked of the film.

Faults that concern a run, a kinematic test or a bearing sheet alone stand in their own modules, beside these.
"""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import ends_at_ambient
from frbcli.film.section_faults import runs_dry, section_faults
from frbcli.scene.channels import channel_faults
from frbcli.scene.films import FilmPlace, film_places
from frbcli.scene.heat_faults import heat_faults
from frbcli.scene.keys import film_keys
from frbcli.scene.machine.elements import element_faults
from frbcli.scene.section import film_section


def require_films(case: Case) -> None:
    """Raises InputError with every reason why the films of a case cannot be modelled."""
    if faults := film_faults(case):
        raise InputError(case.name or "case", tuple(faults))


def film_faults(case: Case) -> list[Fault]:
    """Every reason why the films of a case cannot be modelled: its heat, its channels, its supplies and ends; and
    of its elements."""
    faults = [*element_faults(case), *heat_faults(case), *channel_faults(case)]
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        faults += _supply_faults(case, key, place)
    return faults


def _supply_faults(case: Case, key: str, place: FilmPlace) -> list[Fault]:
    """Faults of a film without its neighbours: its supply, its openings, its ends."""
    supply = place.geometry.supply
    if own := supply.faults(f"{key}.supply"):
        return own
    section = film_section(case, place.geometry, place.feed_holes)
    if not law_named(case.cavitation(place.geometry)).keeps_oil:  # such a film makes its oil, and cannot run dry
        section = ends_at_ambient(section)
    at, value = (f"{key}.supply.kind", supply.kind) if runs_dry(section) else (key, place.name)
    return [
        Fault(at, value, None, f"cannot be solved: {found.problem}.", found.remedy) for found in section_faults(section)
    ]
