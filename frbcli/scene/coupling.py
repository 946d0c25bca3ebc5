"""Couplings of rotor and films in the time integration (chapter 5): a row for each, with what it is not made for, and
the choice of one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.scene.gate.rule import RUN, Rule, refusal
from frbcli.scene.planning.film_choice import form_of

KEY = "film.coupling"


@dataclass(frozen=True)
class Coupling:
    """A coupling. reason: in words; iterates: whether rotor and films are solved until both hold, so that its error is
    Newton's method's; once: whether films are solved once in every stage and linearised there; in_turn: whether rotor
    and films take steps of their own and exchange motion and force once per macro step; film_steps: of the films in a
    step of the rotor; rules: what it is not made for."""

    name: str
    reason: str
    iterates: bool = True
    once: bool = False
    in_turn: bool = False
    film_steps: float = 1.0
    rules: tuple[Rule, ...] = ()


def _oil_faults(case: Case) -> Iterator[Fault]:
    coupling, cavitation = case.film.coupling, _deciding(case)
    if form_of(case).solved and law_named(cavitation).keeps_oil:
        problem = f"needs films without a state; {cavitation} is mass-conserving, and the oil in the film is its state."
        yield Fault(KEY, coupling, None, problem, "Choose monolithic, co-simulation or auto.")


def _where(holds: Callable[[Case], object]) -> Callable[[Case], str | None]:
    """The coupling of a case of which something holds, see refusal."""
    return lambda case: case.film.coupling if holds(case) else None


def _limited(case: Case) -> bool:
    return any(math.isfinite(film.supply.largest_flow) for film in case.films)


def _signals(case: Case) -> str | None:
    signals = case.output.signals
    return ", ".join(signals) if any(kind != "film-thickness" for kind in signals) else None


WITHOUT_STATE = Rule(_oil_faults, (RUN,))


MONOLITHIC = Coupling("monolithic", "rotor and film are one equation in every stage")


FULL = Coupling(
    "dynamic-static",
    "the film depends on the motion alone and is solved with the rotor in every stage",
    rules=(WITHOUT_STATE,),
)


SEMI = Coupling(
    "dynamic-static-semi-implicit",
    "the film is solved once in every stage, at the predicted position of the rotor, and linearised there",
    iterates=False,
    once=True,
    rules=(
        WITHOUT_STATE,
        refusal(
            (RUN,), KEY, _where(lambda case: form_of(case).by_cells),
            "needs a film that is solved without iterations; this one is a finite-volume film",
            "Choose dynamic-static, co-simulation or auto.",
        ),
    ),
)  # fmt: skip


APART = Coupling(
    "co-simulation",
    "rotor and film are solved in turn and exchange motion and force once per macro step",
    iterates=False,
    in_turn=True,
    film_steps=2.0,
    rules=(
        refusal(
            (RUN,), KEY, _where(_limited),
            "exchanges motion and force alone, and the pressure of a flow-limited supply is known only after "
            "each step of the films", "Write auto.",
        ),
        refusal(
            (RUN,), "output.signals", _signals,
            "are not known in a co-simulation, but for film-thickness", "Choose another film.coupling.",
        ),
    ),
)  # fmt: skip


ROWS = (MONOLITHIC, FULL, SEMI, APART)


COUPLINGS = tuple(row.name for row in ROWS)


def coupling_named(name: str) -> Coupling:
    """The row of a name, one of COUPLINGS."""
    return ROWS[COUPLINGS.index(name)]


def chosen_coupling(coupling: str, cavitation: str) -> str:
    """One of COUPLINGS for the setting of a case, which is one of them or "auto"."""
    if coupling != "auto":
        return coupling
    return (MONOLITHIC if law_named(cavitation).keeps_oil else FULL).name


def coupling_of(case: Case) -> Coupling:
    """The coupling of a case, set in it or chosen."""
    return coupling_named(chosen_coupling(case.film.coupling, _deciding(case)))


def plan_coupling(case: Case) -> tuple[str, str]:
    """The coupling of a case, one of COUPLINGS, and why it is chosen."""
    known = coupling_of(case)
    return known.name, known.reason if case.film.coupling == "auto" else f"set in the case; {known.reason}"


def _deciding(case: Case) -> str:
    """The cavitation model that decides on the coupling: a mass-conserving one, if any film has one."""
    return next((model for model in case.cavitations if law_named(model).keeps_oil), case.film.cavitation)
