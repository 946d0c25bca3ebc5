"""The films of a planned case: here, and nowhere else, the form that a plan has chosen becomes a kind of films."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.penalty import Penalty
from frbcli.film.cells.channels.data import with_channels
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.tilted.force import tilted_film
from frbcli.film.gap import Section, whole_width
from frbcli.film.grid import Mesh
from frbcli.film.kinds.cells import CellFilms
from frbcli.film.kinds.contract import Films
from frbcli.film.kinds.inclined import InclinedFilms
from frbcli.film.kinds.none import NoFilms
from frbcli.film.kinds.tables import RectangleFilms, SolutionFilms
from frbcli.film.kinds.tilted import TiltedFilms
from frbcli.film.penalty_table.film import SourceFilm
from frbcli.film.rectangles.film import make_film
from frbcli.scene.channels import coupled_channels
from frbcli.scene.films import FilmPlace, centrifugal_pressures, film_places, make_law, volume_film
from frbcli.scene.forms.cells import CELLS, cells_of
from frbcli.scene.forms.inclined import INCLINED
from frbcli.scene.forms.none import NO_FILM
from frbcli.scene.forms.solutions import SOLUTIONS
from frbcli.scene.forms.tilted import TILTED
from frbcli.scene.planning.cell_choice import compared_states
from frbcli.scene.planning.planned import Plan
from frbcli.scene.section import film_section

# What the balances of a film may be off by over its pace: over the tolerance of a step, and its limits. A film that is
# off by 1e-4 of its pace in each stage leaves 1e-6 of the clearance in a run.
COARSEST = 8, 2  # cells of a film whose section and law alone are taken
SETTLED_OVER_TOLERANCE, SETTLED_RANGE = 4.0, (2e-5, 1e-3)


def make_films(case: Case, plan: Plan, top_Hz: float | None = None) -> Films:
    """The films of a case as its plan has them, tabulated where they have tables. top_Hz: largest speed of the rotor,
    default that of the run."""
    makers = {NO_FILM: lambda *_: NoFilms(), CELLS: _cells, SOLUTIONS: _solutions}
    makers |= {TILTED: _tilted, INCLINED: _inclined}
    return makers.get(plan.form, _rectangles)(case, plan, top_Hz)


def _clearances(case: Case) -> tuple[float, ...]:
    return tuple(place.geometry.clearance for place in film_places(case))


def _cells(case: Case, plan: Plan, top_Hz: float | None) -> Films:
    cells, places = cells_of(plan), film_places(case)
    volumes = tuple(volume_film(case, place, cells, top_Hz, plan.edged) for place in places)
    drops = centrifugal_pressures(case, [film.section for film in volumes])
    data = volume_films(volumes, drops, settled_share(plan.tolerance))
    data = with_channels(data, volumes, coupled_channels(case, volumes))
    return CellFilms(
        clearances=_clearances(case),
        own=volumes,
        data=data,
        cells=cells,
        factor=case.film.cavitation_factor,
        states=compared_states(cells),
        viscosity=case.oil_viscosity,
        exponents=np.array([_exponents(case, *each) for each in zip(places, volumes, strict=True) if case.heat]),
    )


def _exponents(case: Case, place: FilmPlace, film: VolumeFilm) -> Array:
    """(p,) powers of the scale of the pressures that the parameters of a film's law are proportional to; 0 of those
    that are 0 or infinite, as the bulk modulus of oil that does not give way, and remain so."""
    cavitation, section = case.cavitation(place.geometry), film.section
    doubled = replace(section, viscosity=2.0 * section.viscosity)
    first, last = (given_parameters(make_law(case, cavitation, each)) for each in (section, doubled))
    some = (first != 0.0) & np.isfinite(first)
    return np.where(some, np.log2(np.where(some, last, 1.0) / np.where(some, first, 1.0)), 0.0)


def settled_share(tolerance: float) -> float:
    """What the balances of the cells may be off by in a stage, over the pace of their film; tolerance: of a step."""
    tightest, loosest = SETTLED_RANGE
    return min(max(SETTLED_OVER_TOLERANCE * tolerance, tightest), loosest)


def _solutions(case: Case, plan: Plan, _: float | None) -> Films:
    places = [place.geometry for place in film_places(case)]
    solved = tuple(source_film(case, geometry, plan.mesh) for geometry in places)
    sections = tuple(whole_section(case, geometry) for geometry in places)
    data = tuple(film.film() for film in solved)
    return SolutionFilms(_clearances(case), data, sections, solved=solved, mesh=plan.mesh)


def source_film(case: Case, geometry: FilmGeometry, mesh: Mesh) -> SourceFilm:
    """A penalty film without openings, as it is tabulated for a run."""
    section = film_section(case, geometry)
    law = make_law(case, case.cavitation(geometry), section)
    assert isinstance(law, Penalty)
    return SourceFilm(section, law, mesh)


def _tilted(case: Case, plan: Plan, top_Hz: float | None) -> TiltedFilms:
    places, cells = film_places(case), cells_of(plan)
    misalignments = np.array([place.misalignment for place in places])
    flat = [volume_film(case, place, COARSEST, top_Hz) for place in places]
    sections = [whole_width(film.section) for film in flat]
    lands = min((section.copies for section in sections), default=1)  # lands of all films have equal numbers of cells
    own = tuple(
        tilted_film(section, film.law, (cells[0], cells[1] * section.copies // lands), film.scales.reference,
                    place.geometry.supply.mirrored)
        for place, film, section in zip(places, flat, sections, strict=True)
    )  # fmt: skip
    drops = centrifugal_pressures(case, sections)
    return TiltedFilms(
        _clearances(case), own, misalignments, cells, settled_share(plan.tolerance), compared_states(cells), drops
    )


def _inclined(case: Case, plan: Plan, top_Hz: float | None) -> Films:
    return InclinedFilms(_clearances(case), _tilted(case, plan, top_Hz))


def _rectangles(case: Case, plan: Plan, _: float | None) -> Films:
    sections = tuple(whole_section(case, place.geometry) for place in film_places(case))
    laws, meshes = case.cavitations, tuple(mesh for _, mesh in plan.films)
    films = zip(sections, laws, meshes, strict=True)
    data = tuple(make_film(section, plan.theory, law, mesh) for section, law, mesh in films)
    return RectangleFilms(_clearances(case), data, sections, laws=laws, theory=plan.theory, mesh=plan.mesh)


def whole_section(case: Case, film: FilmGeometry) -> Section:
    """The section of a film over the whole width, see whole_width of film/gap.py."""
    return whole_width(film_section(case, film))
