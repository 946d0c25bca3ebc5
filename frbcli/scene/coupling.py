"""How rotor and films are advanced together: what a case may ask for, and what is chosen for it (chapter 5)."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named

COUPLINGS = ("monolithic", "dynamic-static", "dynamic-static-semi-implicit", "co-simulation")
MONOLITHIC, FULL, SEMI, APART = COUPLINGS
REASONS = {
    MONOLITHIC: "rotor and film are one equation in every stage",
    FULL: "the film follows the journal at once, solved with the rotor in every stage",
    SEMI: "the film is solved once in every stage, where the rotor is predicted to be, and linearised there",
    APART: "rotor and film are solved in turn and told of each other once per macro step",
}


def chosen_coupling(coupling: str, cavitation: str) -> str:
    """One of COUPLINGS for what a case says: "auto" or one of them."""
    if coupling != "auto":
        return coupling
    return MONOLITHIC if law_named(cavitation).keeps_oil else FULL


def plan_coupling(case: Case) -> tuple[str, str]:
    """(one of COUPLINGS, why)."""
    coupling = chosen_coupling(case.film.coupling, _deciding(case))
    return coupling, REASONS[coupling] if case.film.coupling == "auto" else f"set in the case; {REASONS[coupling]}"


def coupling_fault(case: Case, with_cells: bool) -> Fault | None:
    """What is wrong with the coupling that a case asks for."""
    coupling, cavitation = case.film.coupling, _deciding(case)
    if coupling in (FULL, SEMI) and law_named(cavitation).keeps_oil:
        problem = f"needs a film without a state of its own; {cavitation} keeps its oil from step to step."
        return Fault("film.coupling", coupling, None, problem, f"Choose {MONOLITHIC}, {APART} or auto.")
    if coupling == SEMI and with_cells:
        problem = "needs a film that is solved in one go; this one has cells, which take iterations."
        return Fault("film.coupling", coupling, None, problem, f"Choose {FULL}, {APART} or auto.")
    return None


def _deciding(case: Case) -> str:
    """The cavitation model that decides how a case is advanced: one that keeps its oil, if any film has such a one."""
    return next((model for model in case.cavitations if law_named(model).keeps_oil), case.film.cavitation)
