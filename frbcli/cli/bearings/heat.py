"""The heat of a machine at a speed, as a table and as part of a JSON document."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from frbcli.cli.common import Terminal
    from frbcli.equilibrium.warm_machine import WarmMachine
    from frbcli.thermal.steady import SteadyHeat

ZERO_CELSIUS = 273.15
FILMS = ("film", "degC", "mPa*s", "gap, um", "loss, W", "flow, ml/s")
RINGS = ("ring", "inner, degC", "outer, degC", "speed over rotor's")


def heat_document(warm: WarmMachine) -> dict[str, object]:
    """Temperatures, viscosities, losses and flows, of one bearing each; what the balance of heat leaves over."""
    return {
        "films": [
            {
                "film": film.film,
                "temperature_K": film.temperature,
                "viscosity_Pa_s": film.viscosity,
                "clearance_m": film.clearance,
                "power_W": film.power,
                "flow_m3_s": film.flow,
            }
            for film in warm.films
        ],
        "rings": [
            {"ring": ring.ring, "inner_K": ring.inner, "outer_K": ring.outer, "speed_ratio": ring.speed_ratio}
            for ring in warm.rings
        ],
        "carried_by_oil_W": warm.steady.carried,
        "into_walls_W": warm.steady.given,
        "balance_relative": warm.balance,
    }


def tell_heat(terminal: Terminal, warm: WarmMachine, title: str) -> None:
    """The films and rings of a warm machine, and where its heat goes."""
    rows = [
        (
            film.film,
            f"{film.temperature - ZERO_CELSIUS:.1f}",
            f"{1e3 * film.viscosity:.4g}",
            f"{1e6 * film.clearance:.4g}",
            f"{film.power:.4g}",
            f"{1e6 * film.flow:.3g}",
        )
        for film in warm.films
    ]
    terminal.table(title, FILMS, rows)
    if warm.rings:
        rings = [
            (
                ring.ring,
                f"{ring.inner - ZERO_CELSIUS:.1f}",
                f"{ring.outer - ZERO_CELSIUS:.1f}",
                f"{ring.speed_ratio:.4f}",
            )
            for ring in warm.rings
        ]
        terminal.table("rings", RINGS, rings)
    _tell_balance(terminal, warm.steady)


def film_document(steady: SteadyHeat) -> dict[str, object]:
    """The same of a single film, of a bearing test."""
    return {
        "films": [
            {
                "film": "film",
                "temperature_K": float(steady.temperatures[0]),
                "viscosity_Pa_s": float(steady.viscosities[0]),
                "clearance_m": float(steady.clearances[0]),
                "power_W": float(steady.films.power[0]),
                "flow_m3_s": float(steady.films.flow[0]),
            }
        ],
        "carried_by_oil_W": steady.carried,
        "into_walls_W": steady.given,
        "balance_relative": steady.balance,
    }


def tell_film(terminal: Terminal, steady: SteadyHeat, title: str) -> None:
    """A single film when it is warm, and where its heat goes."""
    film = steady.films
    row = (
        "film",
        f"{steady.temperatures[0] - ZERO_CELSIUS:.1f}",
        f"{1e3 * steady.viscosities[0]:.4g}",
        f"{1e6 * steady.clearances[0]:.4g}",
        f"{film.power[0]:.4g}",
        f"{1e6 * film.flow[0]:.3g}",
    )
    terminal.table(title, FILMS, [row])
    _tell_balance(terminal, steady)


def _tell_balance(terminal: Terminal, steady: SteadyHeat) -> None:
    terminal.result(
        f"Heat: {steady.carried:.4g} W with the oil, {steady.given:.4g} W into shaft and housing, "
        f"unaccounted for {steady.balance:.0e}."
    )
