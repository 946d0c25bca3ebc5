"""The films of static results: static equilibria, coefficients, stability and response all have the same ones.

Gaps made of rectangles have the film of a run, clipped along more lines: it has no cells, and is
cheap. All others are solved on CELLS, more than in a run, which has to solve them many times, and with the edge of the
cavity within cells. The same films on other meshes give the error of the coefficients. """

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.law import FRONTS
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.grid import Mesh
from frbcli.film.kinds.contract import EvenFilm, FieldFilm
from frbcli.rotor.assembly import LinearRotor, Link, assembled, point_mass
from frbcli.scene.films import film_places, volume_film
from frbcli.scene.forms import FilmForm
from frbcli.scene.gate.rule import STILL
from frbcli.scene.machine.heat import warm_case, warm_system
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.film_choice import DEFAULT_MESH, Plan, choose_films, form_of
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.tilted import CELLS as ON_CELLS

CELLS = (144, 20)  # around and along a section, equal: 0.1 % of the force up to an eccentricity of 0.9
# How far coefficients are off is not even from mesh to mesh as edges of cavities cross cells, so that one coarser mesh
# may agree by chance.
COARSER = ((72, 10), (96, 14))
# Films without cells: lines along which films at rest are clipped, whose number costs little there; times the elements
# each way of the finer mesh, and its share: differences scatter as the edge of the cavity crosses the lines.
RESTING_LINES = 3
FINER, FINER_SHARE = 3, 1.5


@dataclass(frozen=True)
class MeshFilms:
    """The machine on one mesh. share: of the difference between the coefficients on this mesh and on the one of static
    results that is the error of the latter, 0 for itself."""

    plan: Plan
    system: System
    share: float = 0.0


@dataclass(frozen=True)
class FieldFilms:
    """A film on finite volumes, for the fields of pressure and flow, and on fewer cells for their error; share: of the
    difference between both that is the error of the former."""

    own: FieldFilm
    coarser: FieldFilm
    share: float


@dataclass(frozen=True)
class StaticFilms:
    """The machine on the films of static results, and on others for the error, which are made when they are asked for;
    case: whose films they are; top_Hz: largest rotor speed."""

    case: Case
    own: MeshFilms
    make_others: Callable[[], tuple[MeshFilms, ...]]
    top_Hz: float | None

    @cached_property
    def others(self) -> tuple[MeshFilms, ...]:
        """The machine on other meshes."""
        return self.make_others()

    @property
    def system(self) -> System:
        """The machine."""
        return self.own.system

    @property
    def on_cells(self) -> bool:
        """Whether the films are on cells, the other meshes then being coarser ones."""
        return self.own.plan.form.by_cells

    @property
    def coarse(self) -> StaticFilms:
        """The films on the coarsest mesh of the errors, where they are on cells, for what does not depend on more."""
        return replace(self, own=self.others[0], make_others=tuple) if self.on_cells else self

    def warm(self, viscosities: Array, clearances: Array) -> StaticFilms:
        """These films with viscosities in Pa s and clearances in m, (films,) each."""

        def warmed(films: MeshFilms) -> MeshFilms:
            return replace(films, system=warm_system(self.case, films.plan, films.system, viscosities, clearances))

        case = warm_case(self.case, viscosities, clearances)
        return StaticFilms(case, warmed(self.own), lambda: tuple(map(warmed, self.others)), self.top_Hz)

    @cached_property
    def fields(self) -> tuple[FieldFilms, ...]:
        """The films on CELLS and on fewer cells, for the fields of pressure and flow."""
        if uneven := self.system.films.fields:
            other = self.others[0]
            both = zip(uneven, other.system.films.fields, strict=True)
            return tuple(FieldFilms(*films, other.share) for films in both)
        own, fewer = self.system.films.with_fields or self._on(CELLS), COARSER[0]
        pairs = zip(map(EvenFilm, own), map(EvenFilm, self._on(fewer)), strict=True)
        return tuple(FieldFilms(*films, share_of_cells(fewer, CELLS)) for films in pairs)

    def _on(self, cells: tuple[int, int]) -> tuple[VolumeFilm, ...]:
        return tuple(volume_film(self.case, each, cells, self.top_Hz, edged=True) for each in film_places(self.case))


def static_films(case: Case, load: float | None = None, top_Hz: float | None = None) -> StaticFilms:
    """The films of a case. load: along -y on a single film in N, by default from the rotor or [motion]; top_Hz: largest
    rotor speed, by default of the run. Raises InputError."""
    plan = _plan(case)
    own = make_system(case, plan, _rotor(case, load), top_Hz)

    def others() -> tuple[MeshFilms, ...]:  # with the same rotor: a turbocharger's takes as long as its films
        plans = other_plans(plan)
        return tuple(MeshFilms(each, make_system(case, each, own.rotor, top_Hz), share) for each, share in plans)

    return StaticFilms(case, MeshFilms(plan, own), others, top_Hz)


def other_plans(plan: Plan) -> tuple[tuple[Plan, float], ...]:
    """Plans of other meshes, with the share of the difference to each that is the error; none without
    films."""
    if not plan.form.solved:
        return ()
    if plan.form.by_cells:
        own, *coarser = plan.form.static_cells or (CELLS, *COARSER)
        return tuple((replace(plan, cells=cells), share_of_cells(cells, own)) for cells in coarser)
    finer = [Mesh(FINER * mesh.axial, FINER * mesh.circumferential, 2 * mesh.lines + 1) for _, mesh in plan.films]
    meshes = [DEFAULT_MESH] * len(finer) if plan.theory == "short" else finer
    films = tuple((form, mesh) for (form, _), mesh in zip(plan.films, meshes, strict=True))
    return ((replace(plan, theory="finite", films=films), FINER_SHARE),)


def share_of_cells(cells: tuple[int, int], own: tuple[int, int], order: float = FRONTS) -> float:
    """Share of a difference between results on their own cells and on fewer that is the error of the former, which
    falls with the order."""
    return float(1.0 / ((own[0] / cells[0]) ** order - 1.0))


def _plan(case: Case) -> Plan:
    """The plan of a run, or of the films alone where there is no rotor, with the cells of static results."""
    form = form_of(case)
    if form.static_cells:
        return replace(_films_alone(case, "finite", form, DEFAULT_MESH, ()), cells=form.static_cells[0])
    if case.given_rotor is not None and case.given_speed is not None:
        plan = make_plan(case, STILL)
    elif form.fine_when_static:
        plan = _films_alone(case, "finite", ON_CELLS, DEFAULT_MESH, ())
    else:
        films = choose_films(case, case.accuracy.target)
        plan = _films_alone(case, films.theory, films.form, films.mesh, films.films)
    if plan.form.fine_when_static:
        return replace(plan, form=ON_CELLS, cells=CELLS, edged=True)
    return replace(plan, films=tuple((own, replace(mesh, lines=RESTING_LINES)) for own, mesh in plan.films))


def _films_alone(
    case: Case, theory: str, form: FilmForm, mesh: Mesh, films: tuple[tuple[FilmForm, Mesh], ...]
) -> Plan:
    """A plan without a run."""
    return Plan(theory, case.film.cavitation, form, mesh, films, None, math.nan, "", 0.0, math.nan, "", None, ())


def _rotor(case: Case, load: float | None) -> LinearRotor | None:
    """A rotor that is nothing but a load along -y in N; None for the rotor of the case."""
    alone = len(film_places(case)) == 1
    if case.given_rotor is not None and (load is None or not alone):
        return None
    if load is None and case.motion is not None:
        load = case.motion.load
    if load is None:
        remedy = "Give --load, or --over eccentricity, or add [rotor]."
        raise InputError(case.name or "case", (Fault("motion.load", "", None, "is missing.", remedy),))
    return assembled([point_mass("journal", mass=1.0, gravity=load)], [Link("journal")])
