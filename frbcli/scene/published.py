"""The two-phase model in its published form (4.31) in run-ups: which cases can have it, its elements."""

from __future__ import annotations

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.rotor import TurbochargerRotor
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.scene.cell_choice import given_cells
from frbcli.scene.coupling import MONOLITHIC, chosen_coupling

PUBLISHED = "quadratic elements, two-phase model as published"  # the form of such a film
PUBLISHED_ERROR = 2e-2  # of the force, on the published elements: its change on half of them, over 3
ELEMENTS = (20, 10)  # of a section, around and along, figure 6.2
FEWEST = (8, 2)
REMEDY = 'Write form = "conservative".'
DIFFUSIONS = {
    "consistent": "artificial, around and along as published (4.42): transports oil in from the edges",
    "streamline": "artificial (4.42), around only",
    "none": "no artificial diffusion: a steep step may prevent convergence",
}


def is_published(case: Case) -> bool:
    """Whether the films of a case are in the published form."""
    return TwoPhase.name in case.cavitations and case.film.two_phase.form == "published"


def published_faults(case: Case) -> list[Fault]:
    """The faults of a case in the published form; none for other forms."""
    if not is_published(case):
        return []
    found: list[tuple[str, str, str, str]] = []
    if isinstance(case.rotor, TurbochargerRotor):
        found.append(("rotor.kind", "turbocharger", "has two bearings; the published form is for one film", REMEDY))
    elif any(isinstance(bearing, FloatingRingBearing) for bearing in case.bearings):
        found.append(("bearing.kind", "floating-ring", "has two films; the published form is for one", REMEDY))
    if case.film.grid == "half-speed":
        found.append(("film.grid", case.film.grid, "is for cells; the published form has elements", 'Write "auto".'))
    if case.film.two_phase.whirl_steepness is not None:
        value = f"{case.film.two_phase.whirl_steepness:g}"
        found.append(("film.two-phase.whirl_steepness", value, "is for the conservative form", REMEDY))
    coupling = chosen_coupling(case.film.coupling, TwoPhase.name)
    if coupling != MONOLITHIC:
        problem = "is not modelled for the published form"
        found.append(("film.coupling", coupling, problem, f"Choose {MONOLITHIC} or auto."))
    return [Fault(key, value, None, f"{problem}.", remedy) for key, value, problem, remedy in found]


def published_elements(case: Case) -> tuple[tuple[int, int], str]:
    """Elements (around, along) of a section, and why."""
    if case.accuracy.mesh is None:
        return ELEMENTS, "as published"
    return given_cells(case.accuracy.mesh, FEWEST)


def published_decisions(case: Case, elements: tuple[int, int], why: str) -> tuple[tuple[str, str, str], ...]:
    """The decisions about the film: choice, value, reason."""
    kind = case.film.two_phase.diffusion
    reason = "two-phase in its published form (4.31): creates oil where it cavitates; the run states how much"
    return (
        ("film", f"{elements[0]} x {elements[1]} elements", f"quadratic, around x along of a section; {why}"),
        ("form", "published", reason),
        ("diffusion", kind, DIFFUSIONS[kind]),
    )
