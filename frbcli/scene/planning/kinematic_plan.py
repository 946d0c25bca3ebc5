"""The plan of a kinematic bearing test (section 4.2.2): which section of the film is solved, which law, which cells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from frbcli.case.film import FilmGeometry, RingFilm
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.errors import Fault, did_you_mean
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import label_of, law_named, names
from frbcli.film.gap import Section, ends_at_ambient, whole_width
from frbcli.scene.films import (
    film_rectangle,
    film_section,
    is_published,
    least_gaps,
    make_law,
    places_of,
    slope_of,
    tilt_of,
    tilts,
)
from frbcli.scene.forms import PUBLISHED, transport_of
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.kinematic import tested_case
from frbcli.scene.gate.rule import KINEMATIC, ROTATION, motion_omega
from frbcli.scene.planning.cell_choice import given_cells
from frbcli.scene.planning.film_choice import Decision
from frbcli.scene.supply import unfed_films

TESTS = KINEMATIC

# around, along; of a section that is half the film half as many along
STEADY_CELLS, FINE_CELLS = (128, 32), (240, 60)
TILTED_CELLS, FINE_TILTED_CELLS = (192, 56), (240, 80)
MOVING_CELLS = (64, 16)
SHORT_POINTS = (96, 32)
FINE_TARGET = 2e-4
STEPS_PER_PERIOD = 600  # the moment at which a film is full again, and so its force, hangs on the step
TWO_PI = 2.0 * math.pi


@dataclass(frozen=True)
class KinematicPlan:
    """What will be modelled. theory: "finite" or "short"; modal: whether the pressure is from the modal film; section:
    of the film, copied section.copies times; rectangle: of the accurate modal film, None where grooves or bores are cut
    out; cells: (around, along); steps: per period; rate: reference speed of the test in rad/s, for the penalty model on
    the dimensionless pressure; turning: rad/s of the surface that the supply is in, whose frame the film is solved in;
    ramp: s, t_1 of (4.11)."""

    test: str
    cavitation: str
    theory: str
    modal: bool
    section: Section
    rectangle: Section | None
    cells: tuple[int, int]
    rate: float
    decisions: tuple[Decision, ...]
    steps: int = STEPS_PER_PERIOD
    turning: float = 0.0
    ramp: float = 0.0

    @property
    def law(self) -> type[Law]:
        """The cavitation law."""
        return law_named(self.cavitation)

    @property
    def remembers(self) -> bool:
        """Whether the film has a state of its own."""
        return self.law.keeps_oil

    @property
    def label(self) -> str:
        """The label of the cavitation law."""
        return label_of(self.cavitation)

    @property
    def on_cells(self) -> bool:
        """Whether the force is from a finite-volume film."""
        return self.theory == "finite" and not self.modal


def kinematic_plan(case: Case, cavitation: str | None = None, test: str = ROTATION) -> KinematicPlan:
    """Plan a kinematic test of a case for one cavitation model (None: the one of the case).

    Raises InputError naming everything that the case lacks for it or that this version does not model.
    """
    asked = cavitation or tested_case(case).film.cavitation
    case = with_model(case, asked) if asked in names() else case
    require(case, test, _name_faults(asked))
    case = tested_case(case)
    bearing, motion = case.bearings[0], case.motion
    assert motion is not None
    film = bearing.films[0]
    section = film_section(case, film)
    section = whole_width(section) if tilts(case) else section
    rectangle = film_rectangle(section)
    short, on_cells = case.film.theory == "short", rectangle is None or tilts(case) or case.contact.flow_factors
    law = law_named(case.film.cavitation)
    turning = TWO_PI * (motion.speed or 0.0) if film.supply.surface == "journal" else 0.0
    modal = law.closed and not (short or on_cells)
    if short:
        cells, why = SHORT_POINTS, "at which the pressure is given; the force is exact"
    else:
        cells, why = _cells(case, test)
        section = ends_at_ambient(section) if law.closed and film.ends == "free-to-air" else section
    steps = () if test == ROTATION else (Decision("steps", f"{STEPS_PER_PERIOD} per period", "of equal length"),)
    decisions = (*_decisions(case, test, section, modal, cells, why), *steps, *_transport(case, film))
    if (summits := case.contact.about_summits) is not None:
        decisions += (Decision("contact", *summits),)
    return KinematicPlan(
        test, asked, "short" if short else "finite", modal, section, rectangle, cells, motion_omega(case),
        decisions, turning=turning, ramp=film.supply.rise_time,
    )  # fmt: skip


def with_model(case: Case, cavitation: str) -> Case:
    """The case with a cavitation model for its film, which then has none of its own."""
    films = [altered(each, {"cavitation": None}) if isinstance(each, RingFilm) else each for each in case.films]
    return altered(case.with_films(films), {"film": altered(case.film, {"cavitation": cavitation})})


def law_at(case: Case, plan: KinematicPlan, eccentricity: float) -> Law:
    """The law of a film at an eccentricity, at the reference speed of the test."""
    return make_law(case, plan.cavitation, plan.section).followed(eccentricity, plan.rate)


def _name_faults(cavitation: str) -> Iterator[Fault]:
    """Faults of the cavitation model that is asked for."""
    if cavitation not in names():
        yield Fault("--cavitation", cavitation, None, "is no model.", did_you_mean(cavitation, names()))


def _cells(case: Case, test: str) -> tuple[tuple[int, int], str]:
    if case.accuracy.mesh is not None:
        return given_cells(case.accuracy.mesh)
    if test != ROTATION:
        return MOVING_CELLS, "equal ones around, for the narrowest gap moves"
    fine = case.accuracy.target <= FINE_TARGET
    if tilts(case):
        return FINE_TILTED_CELLS if fine else TILTED_CELLS, "finer at the narrowest gap and at the ends"
    return FINE_CELLS if fine else STEADY_CELLS, "finer at the narrowest gap"


def _decisions(
    case: Case, test: str, section: Section, modal: bool, cells: tuple[int, int], why: str
) -> Iterator[Decision]:
    """Gap, film and cells."""
    law, bearing = law_named(case.film.cavitation), case.bearings[0].films[0]
    yield _gap_decision(section, bearing, tilts(case))
    yield from _tilt_decision(case, test, section)
    if (shell := section.profile) is not None:
        yield Decision(shell.key, *shell.plan_entry(section.clearance))
    yield Decision("film", *_film(case, law, modal))
    if bearing.sealing:
        yield Decision("ends", *bearing.sealing)
    elif law.closed and bearing.ends == "free-to-air":
        reason = f"{law.name} clips a pressure that is ambient at the ends; it knows no oil that is missing there"
        yield Decision("ends", "ambient pressure", reason)
    for film in unfed_films(case):
        yield Decision("supply", "starves" if film.keeps else "missing", film.reason)
    parts = "points" if case.film.theory == "short" else "cells"
    yield Decision(parts, f"{cells[0]} x {cells[1]}", f"around x along; {why}")


def _film(case: Case, law: type[Law], modal: bool) -> tuple[str, str]:
    if case.film.theory == "short":
        return "closed form of the short bearing", f"{law.name} of the short bearing, set in the case"
    if modal:
        return "modal, quadratic elements", f"{law.name} in a rectangular gap"
    if is_published(case):
        return "finite volumes", PUBLISHED
    if law.keeps_oil:
        return "finite volumes", f"{law.name}: conserves oil and keeps it from moment to moment"
    return "finite volumes", f"{law.name}: each moment is a steady film of its own"


def _transport(case: Case, bearing: FilmGeometry) -> Iterator[Decision]:
    """How oil is transported, and in which frame."""
    if (transport := transport_of(case)) is not None:
        yield Decision(*transport)
    if bearing.supply.surface == "journal":
        yield Decision("frame", "of the journal", "the feed holes turn with it and are at rest there")


def _gap_decision(section: Section, bearing: FilmGeometry, tilted: bool) -> Decision:
    if section.far == "groove" and section.copies == 2:
        if tilted:
            return Decision("gap", "2 sections", "a central circumferential groove parts two films, which differ")
        return Decision("gap", "1 of 2 sections", "a central circumferential groove parts two equal films")
    if section.far == "symmetry":
        reason = f"supply {bearing.supply.kind}: the film is symmetric about its middle"
        return Decision("gap", "half the width", reason)
    if tilted:
        return Decision("gap", "the whole width", "a film whose journal tilts is not symmetric about its middle")
    return Decision("gap", "the whole width", f"supply {bearing.supply.kind}: the film is not symmetric")


def _tilt_decision(case: Case, test: str, section: Section) -> list[Decision]:
    if not tilts(case):
        return []
    (x, y), size = tilt_of(case), 1e6 * section.clearance
    low, high = least_gaps(section, places_of(case, test), slope_of(tilt_of(case), section))
    reason = f"the least gap is {size * low:.3g} um at the end z < 0 and {size * high:.3g} um at the other"
    return [Decision("tilt", f"{1e3 * x:.4g}, {1e3 * y:.4g} mrad", reason)]
