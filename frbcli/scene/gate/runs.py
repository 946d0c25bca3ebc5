"""Rules of runs: form, theory, coupling and signals of the films, and the number of bearings."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.coupling import APART, chosen_coupling, coupling_fault
from frbcli.scene.films import film_places, is_plain
from frbcli.scene.forms.solutions import solution_fault
from frbcli.scene.machine.elements import changes_with_speed
from frbcli.scene.planning.film_choice import all_clipped, needs_cells


def theory_faults(case: Case) -> Iterator[Fault]:
    """The short bearing is for half-Sommerfeld films on rectangles."""
    if case.film.theory != "short":
        return
    if needs_cells(case) or not all_clipped(case):
        remedy = "finite or auto for this cavitation model and supply; short is for half-sommerfeld on rectangles"
        yield _missing("film.theory", "short", remedy)
    elif any(place.geometry.supply.divides for place in film_places(case)):
        yield _missing("film.theory", "short", "finite or auto for a bearing with axial grooves")


def form_faults(case: Case) -> Iterator[Fault]:
    """Coupling, solution and grid of films of the program."""
    if case.film.bearing_model:
        return
    cells = needs_cells(case)
    chained = any(place.geometry.supply.divides for place in film_places(case))
    found = coupling_fault(case, cells), solution_fault(case, all_clipped(case), not (chained or cells))
    yield from filter(None, found)
    if _coupling(case) == APART and changes_with_speed(case):
        problem = "has a rotor of constant coefficients, and those of a bearing depend on the speed."
        yield Fault("film.coupling", APART, None, problem, "Write auto.")
    may_turn = cells and all(is_plain(place.geometry) for place in film_places(case))
    if case.film.grid == "half-speed" and not may_turn:
        yield _missing("film.grid", "half-speed", "auto; it is for films on cells without openings and lobes")


def signal_faults(case: Case) -> Iterator[Fault]:
    """Signals of the films that a run of the case cannot record."""
    signals = case.output.signals
    if _coupling(case) == APART and any(kind != "film-thickness" for kind in signals):
        problem = "are not known in a co-simulation, but for film-thickness."
        yield Fault("output.signals", ", ".join(signals), None, problem, "Choose another film.coupling.")
    if "oil-flow" not in signals:
        return
    if case.film.bearing_model:
        problem, remedy = "is not told by a bearing model.", "Write finite, short or auto for film.theory."
        yield Fault("output.signals", "oil-flow", None, problem, remedy)
    elif not (needs_cells(case) or all_clipped(case)):
        problem, remedy = "is not told by the tables of the penalty model.", 'Write film.solution = "cells".'
        yield Fault("output.signals", "oil-flow", None, problem, remedy)


def ladder_faults(case: Case) -> Iterator[Fault]:
    """An own bearing model is one film of one mesh."""
    if case.film.bearing_model:
        problem = "is a bearing model, which has no theories and meshes to compare."
        remedy = "`frb runup --verify` measures the error of a run."
        yield Fault("film.theory", case.film.theory, None, problem, remedy)


def number_faults(case: Case) -> Iterator[Fault]:
    """A symmetric rotor has one bearing with a film for both."""
    if len(case.bearings) > 1 and case.rotor.symmetric:
        both = "one bearing with a film, which stands for both of a symmetric rotor, and any with given coefficients"
        yield _missing("bearing", f"{len(case.bearings)} bearings", both)


def _coupling(case: Case) -> str:
    return chosen_coupling(case.film.coupling, case.film.cavitation)


def _missing(key: str, value: str, known: str) -> Fault:
    return Fault(key, value, None, "is not modelled in this version.", f"Modelled are: {known}.")
