"""The plan of a case of thrust bearings alone."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.film.pads.geometry import COARSE, MESH
from frbcli.scene.planning.planned import Decision
from frbcli.units import display


def thrust_plan(case: Case) -> tuple[Decision, ...]:
    """What `frb thrust` models of a case, and why."""
    radial, angular = MESH
    choices = []
    for bearing in case.thrust_bearings:
        land = "no land" if bearing.taper_angle >= bearing.pad_angle else "a land behind it"
        depth = f"{bearing.profile} of {display(bearing.taper, 'm')}, {land}; grooves at ambient pressure"
        choices.append(Decision("thrust bearing", f"{bearing.name} {bearing.pads} pads, {bearing.side}".strip(), depth))
    return (
        *choices,
        Decision("cavitation", case.film.cavitation, "only where the pressure falls below the cavitation pressure"),
        _viscosity(case),
        Decision("mesh", f"{radial} x {angular}", "quadratic elements of a pad, radius by angle"),
        Decision("error", f"from {COARSE[0]} x {COARSE[1]}", "stated with each state by `frb thrust`"),
    )


def _viscosity(case: Case) -> Decision:
    if case.heat is not None:
        return Decision("heat", "lumped", "each side has the viscosity of the temperature at which its heat balances")
    return Decision("viscosity", f"{1e3 * case.oil_viscosity:.4g} mPa*s", "of [oil], in the whole film")
