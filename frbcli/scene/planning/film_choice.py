"""How the films of a case are computed: theory, form, mesh, and the error of their forces that this is known to have.

The errors are relative to the force and measured (docs/accuracy.md): half-Sommerfeld films against a solution on
14 x 256 elements, at states as in a whirl, for b/D = 0.1 to 0.8.

A plan, and the choices that it is made of.
"""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.case.film import FilmGeometry
from frbcli.case.schema import Case
from frbcli.columns import html_table
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named
from frbcli.film.grid import Mesh
from frbcli.scene.films import film_places, is_published, misaligned, turning_rings
from frbcli.scene.forms import (
    CHAINS,
    CLIPPED,
    CLOSED_FORM,
    FIELDS,
    MOST_EXPENSIVE_FIRST,
    NO_FILM,
    SOLUTION_ERROR,
    SOLUTION_MESH,
    SOLUTIONS,
    TABLE,
    FilmForm,
    table_obstacle,
)
from frbcli.scene.planning.cell_choice import (
    WorstFilm,
    expected_eccentricity,
    fewest_cells,
    given_cells,
    short_error,
    slenderness_of,
    worst_film,
)
from frbcli.scene.tilted import CELLS, INCLINED, TILTED, CellForm

# Eccentricity up to which films hold the target. A finer table costs little more; a film that is solved at every film
# call would cost much more for eccentricities close to 1.
TABLE_HOLDS_TO, SOLVED_HOLDS_TO = 0.95, 0.9
FILM_SHARE = 0.5  # of the target
DEFAULT_MESH = Mesh(axial=6, circumferential=96)  # where no plan is made
# Errors at TABLE_HOLDS_TO: MESH_ERROR (b/D)^2, and the error of the interpolation, which does not depend on the mesh.
MESH_ERROR = {Mesh(3, 48): 4.2e-3, Mesh(4, 64): 3e-3, Mesh(6, 96): 3e-4, Mesh(10, 192): 5e-5}
TABLE_FLOOR, FIELDS_FLOOR = 1e-4, 6e-4
# Errors at SOLVED_HOLDS_TO between axial grooves, for widths up to the diameter; larger for wider bearings.
CHAIN_ERROR = {Mesh(3, 48): 8.5e-4, Mesh(6, 48): 5e-4, Mesh(9, 72): 4e-4, Mesh(10, 192): 2e-4}
CHAIN_FLOOR = 8.5e-4
CELL_SHARE, RING_SHARE = 0.8, 0.85  # of the target, by cells: with rings their largest error is known
REACHED = 0.95  # error of the cells over the target up to which it counts as met: with the steps that is 1.2 of it
LOOSE_TARGET, FINE_TARGET = 2e-3, 2e-4  # of methods of third and of fourth order


@dataclass(frozen=True)
class FilmChoice:
    """theory: "short" | "finite"; form: how the most expensive film is computed; mesh: the finest mesh of elements;
    cells: (around, along) or None; error: expected relative error of the forces at the eccentricity up to which the
    film holds the target; theory_why, mesh_why: reasons; films: (form, mesh) of each film on quadratic elements;
    eccentricity: that the cells are chosen for, None where it is not known or has no influence."""

    theory: str
    form: FilmForm
    mesh: Mesh
    cells: tuple[int, int] | None
    error: float
    theory_why: str
    mesh_why: str
    films: tuple[tuple[FilmForm, Mesh], ...] = ()
    eccentricity: float | None = None


def form_of(case: Case) -> FilmForm:
    """The form of the films of a case; TABLE for all gaps made of rectangles, whose forms follow from the target."""
    if not case.films:
        return NO_FILM
    if case.film.tilt == "follows":
        return TILTED
    if any(misaligned(case)):
        return INCLINED
    if _on_volumes(case):
        return CELLS
    return TABLE if all_clipped(case) else SOLUTIONS


def choose_films(case: Case, target: float) -> FilmChoice:
    """The cheapest film that holds a target, or what the case sets."""
    choices = {NO_FILM: _no_film, SOLUTIONS: _solutions}
    choices |= {CELLS: _volumes, TILTED: _volumes, INCLINED: _volumes}
    return choices.get(form_of(case), _rectangles)(case, target)


def _no_film(_: Case, __: float) -> FilmChoice:
    return FilmChoice(str(NO_FILM), NO_FILM, DEFAULT_MESH, None, 0.0, "", "")


def _volumes(case: Case, target: float) -> FilmChoice:
    eccentricity = expected_eccentricity(case)
    worst = worst_film(case, eccentricity)
    form = TILTED if form_of(case).inclines else CELLS  # a run has no films of their own for a tilt that is given
    cells, cells_why = _cells(case, form, worst, target)
    error = worst.of((cells[0], form.as_exact * cells[1]))
    theory_why = "set in the case" if case.film.theory != "auto" else "finite-volume film"
    mesh_why = f"{cells_why}error of the eccentricities {error:.1g}"
    if form == TILTED:
        mesh_why += "; over the whole width, since its gap is not even along the axis"
    elif case.film.solution == "cells":
        mesh_why += "; film.solution is set in the case"
    elif case.contact.flow_factors or all(law_named(model).tabulated for model in case.cavitations):
        mesh_why += f"; no table: {table_obstacle(case)}"
    return FilmChoice("finite", form, DEFAULT_MESH, cells, error, theory_why, mesh_why, (), eccentricity)


def _solutions(case: Case, _: float) -> FilmChoice:
    given = case.accuracy.mesh
    mesh = SOLUTION_MESH if given is None else Mesh(*given)
    mesh_why = "set in the case" if given is not None else f"error {SOLUTION_ERROR:.1g}, as of the splines"
    return FilmChoice("finite", SOLUTIONS, mesh, None, SOLUTION_ERROR, "tabulated before the run", mesh_why)


def _rectangles(case: Case, target: float) -> FilmChoice:
    given, films = case.accuracy.mesh, [place.geometry for place in film_places(case)]
    slenderness = max(slenderness_of(film) for film in films)
    short = short_error(slenderness, SOLVED_HOLDS_TO)
    theory, theory_why = case.film.theory, "set in the case"
    if theory == "auto":
        fits = short <= FILM_SHARE * target and not any(film.supply.divides or film.sealed < 1.0 for film in films)
        theory = "short" if fits else "finite"
        theory_why = (
            f"short-bearing theory is {100.0 * short:.3g} % off at eps = {SOLVED_HOLDS_TO:g}, b/D = {slenderness:.2g}"
        )
        if any(film.supply.divides for film in films):
            theory_why = "axial grooves, which the short bearing does not have"
        elif any(film.sealed < 1.0 for film in films):
            theory_why = "sealed ends, behind which oil flows around as in a longer bearing"
    forms = [film_form(case, film, theory) for film in films]
    form = min(forms, key=MOST_EXPENSIVE_FIRST.index)
    meshes = [_mesh(form, slenderness_of(film), FILM_SHARE * target) for form, film in zip(forms, films, strict=True)]
    mesh = max((mesh for mesh, _ in meshes), key=lambda mesh: mesh.axial * mesh.circumferential)
    error = max(error for _, error in meshes)
    holds_to = SOLVED_HOLDS_TO if form == CHAINS else TABLE_HOLDS_TO
    mesh_why = f"relative error {error:.1g} at an eccentricity of {holds_to:g}"
    if given is not None:
        mesh, mesh_why = Mesh(*given), "set in the case"
        error = _mesh_error(form, mesh, slenderness)
        meshes = [(mesh, error)] * len(films)
    each = tuple((form, mesh) for form, (mesh, _) in zip(forms, meshes, strict=True))
    error = short if theory == "short" else error
    return FilmChoice(theory, form, mesh, None, error, theory_why, mesh_why, each)


def all_clipped(case: Case) -> bool:
    """Whether every film is the clipped solution of a linear equation."""
    return all(law_named(model).closed for model in case.cavitations)


def _on_volumes(case: Case) -> bool:
    """Whether the films of a case are solved on volumes in a run."""
    if case.film.solution == "cells" or case.contact.flow_factors:
        return True
    if not all_clipped(case):
        return table_obstacle(case) != ""
    films = [place.geometry for place in film_places(case)]
    chained = len(films) > 1 and any(film.supply.divides for film in films)
    return chained or any(film.shell is not None or not film.supply.rectangular for film in films)


def film_form(case: Case, film: FilmGeometry, theory: str) -> FilmForm:
    """How a film without cells will be computed."""
    if film.supply.divides:
        return CHAINS
    ambient = case.oil.ambient_pressure
    equal = film.supply.gauge(ambient) == 0.0 and ambient == case.oil.cavitation_pressure
    equal = equal or not law_named(case.cavitation(film)).cavitates
    if theory == "short":
        return CLOSED_FORM if equal else CLIPPED
    return TABLE if equal else FIELDS


def _mesh(form: FilmForm, slenderness: float, allowed: float) -> tuple[Mesh, float]:
    """The coarsest mesh whose error is small enough, or below which the error does not fall, and its error."""
    meshes = list(CHAIN_ERROR if form == CHAINS else MESH_ERROR)
    errors = [_mesh_error(form, mesh, slenderness) for mesh in meshes]
    allowed = max(allowed, {CHAINS: CHAIN_FLOOR, FIELDS: FIELDS_FLOOR}.get(form, 0.0))
    index = next((i for i, error in enumerate(errors) if error <= allowed), len(errors) - 1)
    return meshes[index], errors[index]


def _mesh_error(form: FilmForm, mesh: Mesh, slenderness: float) -> float:
    """Error of any mesh, taken from the next coarser one in the tables."""
    table = CHAIN_ERROR if form == CHAINS else MESH_ERROR
    coarser = [known for known in table if known.axial <= mesh.axial and known.circumferential <= mesh.circumferential]
    coarsest = next(iter(table))
    factor = table[coarser[-1]] if coarser else table[coarsest] * (coarsest.circumferential / mesh.circumferential) ** 3
    if form == CHAINS:
        return float(factor * max(1.0, slenderness))
    return float(max(factor * slenderness**2, FIELDS_FLOOR if form == FIELDS else TABLE_FLOOR))


def _cells(case: Case, form: CellForm, worst: WorstFilm, target: float) -> tuple[tuple[int, int], str]:
    """Cells (around, along) of a form, and what comes before their error in their reason."""
    if case.accuracy.mesh is not None:
        cells, why = given_cells(case.accuracy.mesh, worst.fewest)
        return form.of_whole(cells), f"{why}; "
    allowed = (RING_SHARE if turning_rings(case) else CELL_SHARE) * target
    return fewest_cells(worst, allowed, REACHED * target, form.lengths, form.as_exact), ""


@dataclass(frozen=True)
class Decision:
    """One choice of the plan: what was chosen, and why."""

    choice: str
    value: str
    reason: str


@dataclass(frozen=True, repr=False)
class Plan:
    """What will be modelled. theory: "short" | "finite"; cavitation: of films that name
    none of their own; form: how the most expensive film is computed; mesh: the finest mesh of elements; films: form and
    mesh of each film on quadratic elements; cells: (around, along) of finite-volume films, None for other films;
    film_error: expected relative error of the forces; method: name of a time integration method; tolerance: local error
    of a displacement over the clearance; steps_per_revolution: at least; coupling: one of COUPLINGS; macro_step:
    longest one in s of a co-simulation, else None; length: m, instead of the clearance for machines without films, see
    reference_length; eccentricity: that the cells are chosen for, see FilmChoice; edged: whether finite-volume films
    have the edge of their cavity within cells, see VolumeFilm: at rest alone."""

    theory: str
    cavitation: str
    form: FilmForm
    mesh: Mesh
    films: tuple[tuple[FilmForm, Mesh], ...]
    cells: tuple[int, int] | None
    film_error: float
    method: str
    tolerance: float
    steps_per_revolution: float
    coupling: str
    macro_step: float | None
    decisions: tuple[Decision, ...]
    length: float = 0.0
    eccentricity: float | None = None
    edged: bool = False

    def __repr__(self) -> str:
        """Its choices, one on a line."""
        return "\n".join(["Plan", *(f"{each.choice}: {each.value}" for each in self.decisions)])

    def _repr_html_(self) -> str:
        """In a notebook: its decisions."""
        rows = [(each.choice, each.value, each.reason) for each in self.decisions]
        return html_table("plan", ("choice", "value", "reason"), rows, len(rows))


def about_oil(case: Case, law: type[Law]) -> str:
    """What a law makes of the oil."""
    if law.keeps_oil:
        if law.published_form and is_published(case):
            return "the oil is part of the state, and some is created"
        return f"{'mass-conserving: ' if law.conserves else ''}the oil is part of the state"
    if not law.cavitates:
        return "the film does not cavitate"
    return "oil is not conserved"
