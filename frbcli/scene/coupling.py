"""Coupling of rotor and films in the time integration: settings and choice (chapter 5)."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named

COUPLINGS = ("monolithic", "dynamic-static", "dynamic-static-semi-implicit", "co-simulation")
MONOLITHIC, FULL, SEMI, APART = COUPLINGS
REASONS = {
    MONOLITHIC: "rotor and film are one equation in every stage",
    FULL: "the film has no state and is solved with the rotor in every stage",
    SEMI: "the film is solved once in every stage, at the predicted position of the rotor, and linearised there",
    APART: "rotor and film are solved in turn and exchange motion and force once per macro step",
}


def chosen_coupling(coupling: str, cavitation: str) -> str:
    """One of COUPLINGS for the setting of a case, which is one of them or "auto"."""
    if coupling != "auto":
        return coupling
    return MONOLITHIC if law_named(cavitation).keeps_oil else FULL


def plan_coupling(case: Case) -> tuple[str, str]:
    """(one of COUPLINGS, why)."""
    coupling = chosen_coupling(case.film.coupling, _deciding(case))
    return coupling, REASONS[coupling] if case.film.coupling == "auto" else f"set in the case; {REASONS[coupling]}"


def coupling_fault(case: Case, with_cells: bool) -> Fault | None:
    """The fault of the coupling that is set in a case."""
    coupling, cavitation = case.film.coupling, _deciding(case)
    if coupling in (FULL, SEMI) and law_named(cavitation).keeps_oil:
        problem = f"needs a film without a state; {cavitation} is mass-conserving, and its oil is a state."
        return Fault("film.coupling", coupling, None, problem, f"Choose {MONOLITHIC}, {APART} or auto.")
    if coupling == SEMI and with_cells:
        problem = "needs a film that is solved without iterations; this one is a finite-volume film."
        return Fault("film.coupling", coupling, None, problem, f"Choose {FULL}, {APART} or auto.")
    return None


def _deciding(case: Case) -> str:
    """The cavitation model that decides on the coupling: a mass-conserving one, if any film has one."""
    return next((model for model in case.cavitations if law_named(model).keeps_oil), case.film.cavitation)
