"""The faults of a case that cannot be modelled, found before anything is computed."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.clearance_steps import clearance_faults
from frbcli.scene.coupling import APART, chosen_coupling, coupling_fault
from frbcli.scene.film_faults import film_faults
from frbcli.scene.films import film_places, is_plain
from frbcli.scene.forms.published import published_faults
from frbcli.scene.forms.solutions import solution_fault
from frbcli.scene.machine.elements import changes_with_speed
from frbcli.scene.planning.film_choice import all_clipped, needs_cells


def plan_faults(case: Case) -> list[Fault]:
    """Every part of a case that cannot be modelled in a run."""
    faults = film_faults(case)
    if not case.bearings:
        return faults
    if case.film.bearing_model:
        from frbcli.scene.machine.bearing_model_films import (
            model_faults,  # numba takes longer to import than a plan to make
        )

        faults += model_faults(case, 2.0 * math.pi * max(abs(case.speed.start), abs(case.speed.end)))

    def missing(key: str, value: str, known: tuple[str, ...]) -> None:
        faults.append(_missing(key, value, known))

    if case.film.theory == "short" and (needs_cells(case) or not all_clipped(case)):
        remedy = "finite or auto for this cavitation model and supply; short is for half-sommerfeld on rectangles"
        missing("film.theory", "short", (remedy,))
    elif case.film.theory == "short" and any(p.geometry.supply.divides for p in film_places(case)):
        missing("film.theory", "short", ("finite or auto for a bearing with axial grooves",))
    faults += clearance_faults(case)
    if case.film.bearing_model:
        return faults + signal_faults(case, False) or _bearing_faults(case)
    chained = any(p.geometry.supply.divides for p in film_places(case))
    told = solution_fault(case, all_clipped(case), not (chained or needs_cells(case)))
    faults += filter(None, (coupling_fault(case, needs_cells(case)), told))
    faults += published_faults(case)
    if chosen_coupling(case.film.coupling, case.film.cavitation) == APART and changes_with_speed(case):
        problem = "has a rotor of constant coefficients, and those of a bearing depend on the speed."
        faults.append(Fault("film.coupling", APART, None, problem, "Write auto."))
    faults += signal_faults(case, needs_cells(case) or all_clipped(case))
    may_turn = needs_cells(case) and all(is_plain(p.geometry) for p in film_places(case))
    if case.film.grid == "half-speed" and not may_turn:
        missing("film.grid", "half-speed", ("auto; it is for films on cells without openings and lobes",))
    return faults or _bearing_faults(case)


def signal_faults(case: Case, flow_known: bool) -> list[Fault]:
    """Signals of the films that a run of the case cannot record. flow_known: whether the films tell their oil flow."""
    told, apart = case.output.signals, chosen_coupling(case.film.coupling, case.film.cavitation) == APART
    faults = []
    if apart and any(kind != "film-thickness" for kind in told):
        problem = "are not known in a co-simulation, but for film-thickness."
        faults.append(Fault("output.signals", ", ".join(told), None, problem, "Choose another film.coupling."))
    if "oil-flow" in told and not flow_known:
        if case.film.bearing_model:
            problem, remedy = "is not told by a bearing model.", "Write finite, short or auto for film.theory."
        else:
            problem, remedy = "is not told by the tables of the penalty model.", 'Write film.solution = "cells".'
        faults.append(Fault("output.signals", "oil-flow", None, problem, remedy))
    return faults


def _bearing_faults(case: Case) -> list[Fault]:
    """Faults of the number of bearings."""
    if len(case.bearings) <= 1 or not case.rotor.symmetric:
        return []
    both = "one bearing with a film, which stands for both of a symmetric rotor, and any with given coefficients"
    return [_missing("bearing", f"{len(case.bearings)} bearings", (both,))]


def _missing(key: str, value: str, known: tuple[str, ...]) -> Fault:
    return Fault(key, value, None, "is not modelled in this version.", f"Modelled are: {', '.join(known)}.")
