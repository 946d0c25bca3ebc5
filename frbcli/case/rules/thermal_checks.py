"""Rules that tie [thermal] to the rest of a case. See checks.py for how they read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach, number, ring_films, table, tables
from frbcli.case.rules.film_checks import law_breaches
from frbcli.case.surroundings.over_time import is_over_time, values_of
from frbcli.case.thermal import HOTTEST_FILM
from frbcli.units import display

WALLS = ("shaft", "housing")


def thermal_breaches(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Every broken rule of heat in the tables of a case."""
    thermal, oil = table(data, "thermal"), table(data, "oil")
    if not thermal or thermal.get("model") == "none":
        yield from _without_heat(data)
        return
    if "viscosity" in oil and not isinstance(oil["viscosity"], dict) and "vogel" not in oil:
        problem = "is constant, but [thermal] has films that warm up."
        remedy = 'Give a grade, { grade = "SAE 10W-40" }, or oil.vogel in its place.'
        yield Breach(("oil", "viscosity"), problem, remedy)
    hottest = number(thermal, "hottest_film", "K", HOTTEST_FILM)
    for path, value in _temperatures(data, thermal):
        yield from law_breaches(oil, value, path)
        if value is not None and hottest is not None and value >= hottest:
            problem = f"is {display(value, 'K')}, not below thermal.hottest_film, {display(hottest, 'K')}."
            yield Breach(path, problem, "Lower it. Temperatures in degrees Celsius have the unit degC.")
    for path, bearing in tables(data, "bearing"):
        films = [((*path, *at), film) for end in ring_films(bearing) for at, film in end]
        for film_path, film in films or [(path, bearing)]:
            yield from _film(film_path, film)


def _film(path: Path, film: Mapping[str, Any]) -> Iterator[Breach]:
    """Keys of a film that heat makes superfluous."""
    if "viscosity" in film:
        problem = "is constant, but [thermal] has films that warm up."
        remedy = "Remove it: the viscosity follows from [oil] at the film's temperature."
        yield Breach((*path, "viscosity"), problem, remedy)
    if "temperature" in film:
        problem = "has no effect: [thermal] finds the film's temperature."
        yield Breach((*path, "temperature"), problem, 'Remove it, or write thermal.model = "none".')
    if "clearance_steps" in film and isinstance(film.get("clearance"), dict):
        problem = "gives clearances of no temperature, and the clearance before them is a cold one."
        remedy = "Give that at thermal.reference_temperature as a length, as the steps do."
        yield Breach((*path, "clearance_steps"), problem, remedy)


def _temperatures(data: Mapping[str, Any], thermal: Mapping[str, Any]) -> Iterator[tuple[Path, float | None]]:
    """The temperatures that the oil meets, by their keys."""
    if "start_temperature" in thermal:
        yield ("thermal", "start_temperature"), number(thermal, "start_temperature", "K")
    places: list[tuple[Path, Mapping[str, Any]]] = [(("thermal",), thermal), *tables(data, "bearing")]
    for path, holder in places:
        for key in ("supply_temperature", *WALLS):
            if key in holder and holder[key] != "adiabatic":
                values = values_of(holder[key], "K")
                yield from (((*path, key), limit(values)) for limit in (min, max) if values)


def _without_heat(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Keys of bearings that have an effect with heat only."""
    if "thermal" in data:
        yield from _inputs_without_heat(data)
        return
    for path, bearing in tables(data, "bearing"):
        for key in (*WALLS, "supply_temperature"):
            if key in bearing:
                yield Breach((*path, key), "has no effect without heat.", "Remove it, or add the table [thermal].")


def _inputs_without_heat(data: Mapping[str, Any]) -> Iterator[Breach]:
    """Temperatures over time where [thermal] has no model."""
    for path, holder in ((("thermal",), table(data, "thermal")), *tables(data, "bearing")):
        for key in (*WALLS, "supply_temperature"):
            if is_over_time(holder.get(key)):
                problem = "changes over time, and without heat all films keep their temperature."
                yield Breach((*path, key), problem, 'Write thermal.model = "lumped", or one temperature.')
