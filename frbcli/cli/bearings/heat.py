"""The heat of a machine at a speed, as tables and as part of a JSON document."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from frbcli.cli.common import Terminal
    from frbcli.equilibrium.warm_machine import FilmTemperature, WarmMachine
    from frbcli.thermal.steady import SteadyHeat


def heat_document(warm: WarmMachine) -> dict[str, object]:
    """Temperatures, viscosities, losses and flows, of one bearing each, and the balance of heat."""
    from frbcli.columns import document, documents
    from frbcli.equilibrium.columns import HEAT_BALANCE, WARM_FILMS, WARM_RINGS

    films, rings = documents(WARM_FILMS, warm.films), documents(WARM_RINGS, warm.rings)
    return {"films": films, "rings": rings, **document(HEAT_BALANCE, warm.steady)}


def show_heat(terminal: Terminal, warm: WarmMachine, title: str) -> None:
    """The films and rings of a warm machine, and where its heat goes."""
    from frbcli.columns import table_of
    from frbcli.equilibrium.columns import WARM_RINGS

    _show_films(terminal, warm.films, title)
    if warm.rings:
        terminal.show("rings", table_of(WARM_RINGS, warm.rings))
    _show_balance(terminal, warm.steady)


def film_document(steady: SteadyHeat) -> dict[str, object]:
    """The heat of a single film, of a bearing test."""
    from frbcli.columns import document, documents
    from frbcli.equilibrium.columns import HEAT_BALANCE, WARM_FILMS
    from frbcli.equilibrium.warm_machine import film_temperatures

    return {"films": documents(WARM_FILMS, film_temperatures(steady, [""])), **document(HEAT_BALANCE, steady)}


def show_film(terminal: Terminal, steady: SteadyHeat, title: str) -> None:
    """A single film when it is warm, and where its heat goes."""
    from frbcli.equilibrium.warm_machine import film_temperatures

    _show_films(terminal, film_temperatures(steady, [""]), title)
    _show_balance(terminal, steady)


def _show_films(terminal: Terminal, films: Sequence[FilmTemperature], title: str) -> None:
    from frbcli.columns import table_of
    from frbcli.equilibrium.columns import WARM_FILMS

    terminal.show(title, table_of(WARM_FILMS, films))


def _show_balance(terminal: Terminal, steady: SteadyHeat) -> None:
    terminal.result(
        f"Heat: {steady.carried:.4g} W with the oil, {steady.given:.4g} W into shaft and housing, "
        f"unaccounted for {steady.balance:.0e}."
    )
