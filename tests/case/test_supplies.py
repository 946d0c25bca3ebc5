"""What every row of the table of supplies answers, each made of the examples of its keys."""

from typing import Any

import pytest

import frbcli
from frbcli import load_case
from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.schema import json_schema
from frbcli.case.supplies import SUPPLIES, OilSupply, Outline, kind_of
from frbcli.scene.films import film_places, film_section, is_plain

AMBIENT = 1e5
each_supply = pytest.mark.parametrize("row", SUPPLIES, ids=kind_of)


def film_of(row: type[OilSupply]) -> tuple[frbcli.Case, SingleFilmBearing]:
    """A bearing with this supply at 3.5 bar, and its case."""
    entry = json_schema()["$defs"][row.__name__]
    given = {key: _example(entry["properties"][key]) for key in entry.get("required", ()) if key != "kind"}
    given = {"kind": kind_of(row), **given, **({"pressure": "3.5 bar"} if row.feeds else {})}
    table = ", ".join(f"{key} = {value if isinstance(value, int) else repr(value)}" for key, value in given.items())
    case = load_case("jeffcott", ["bearing.diameter=60 mm", f"bearing.supply={{ {table} }}"])  # with room for all
    (film,) = (place.geometry for place in film_places(case))
    assert isinstance(film, SingleFilmBearing)
    return case, film


def _example(entry: dict[str, Any]) -> object:
    return entry["examples"][0] if "examples" in entry else entry["anyOf"][1]["examples"][0]


@each_supply
def test_all_openings_have_the_gauge_pressure_of_the_supply(row: type[OilSupply]) -> None:
    case, film = film_of(row)
    section = film_section(case, film)
    pressures = [*(groove.pressure for groove in section.grooves), *(hole.pressure for hole in section.holes)]
    if section.far == "groove":
        pressures.append(section.far_pressure)
    assert len(pressures) == (len(film.supply.outlines(section.radius, film.width)) if row.feeds else 0)
    assert set(pressures) <= {film.supply.gauge(AMBIENT)}
    assert film.supply.gauge(AMBIENT) == (2.5e5 if row.feeds else 0.0)
    assert film.supply.absolute(AMBIENT) == (3.5e5 if row.feeds else AMBIENT)


@each_supply
def test_what_a_supply_says_of_the_gap_is_what_its_section_has(row: type[OilSupply]) -> None:
    case, film = film_of(row)
    section = film_section(case, film)
    assert is_plain(film) is not bool(section.grooves or section.holes)
    assert film.supply.divides is bool(section.grooves)
    assert film.supply.rectangular is not bool(section.holes)
    assert film.supply.splits is (section.far == "groove" and section.copies == 2)


@pytest.mark.parametrize(("places", "copies"), [((10e-3,), 2), ((6e-3,), 1), ((6e-3, 14e-3), 1)])
def test_half_of_the_width_is_solved_where_all_openings_lie_in_its_middle(
    places: tuple[float, ...], copies: int
) -> None:
    class Rows(OilSupply):
        kind: str = "rows"

        def outlines(self, radius: float, width: float) -> tuple[Outline, ...]:
            return tuple(Outline(0.0, axial, 1e-3 / radius, 0.05 * width) for axial in places)

    found = Rows().openings(12.5e-3, 20e-3, "free-to-air", AMBIENT)
    assert (found.copies, found.far) == (copies, "symmetry" if copies == 2 else "free-to-air")
    assert tuple(hole.axial for hole in found.holes) == places
