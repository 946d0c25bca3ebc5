"""The plan of a kinematic bearing test (section 4.2.2): which section of the film is solved, which law, which cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

from frbcli.bearing_tests.faults import bearing_faults, motion_faults
from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model.model import BearingModel
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.table import law_named, names
from frbcli.film.gap import Section, ends_at_ambient
from frbcli.nearest import did_you_mean
from frbcli.scene.film_faults import film_faults
from frbcli.scene.films import make_law
from frbcli.scene.forms.models import chosen_model, model_decisions
from frbcli.scene.forms.published import DIFFUSIONS, ELEMENTS
from frbcli.scene.planning.cell_choice import FEWEST, given_cells
from frbcli.scene.planning.planned import Decision
from frbcli.scene.section import film_rectangle, film_section
from frbcli.scene.supply import unfed_films

TESTS = ("rotation", "squeeze", "whirl")

# around, along; of a section that is half the film half as many along
STEADY_CELLS, FINE_CELLS = (128, 32), (240, 60)
MOVING_CELLS = (64, 16)
FINE_TARGET = 2e-4
STEPS_PER_PERIOD = 600  # the moment at which a film is full again, and so its force, hangs on the step
TWO_PI = 2.0 * math.pi

PUBLISHED_FILM = Decision(
    "film", "quadratic elements", "two-phase in its published form (4.31): creates oil where it cavitates"
)


@dataclass(frozen=True)
class KinematicPlan:
    """What will be modelled. section: of the film, copied section.copies times; rectangle: that of the accurate
    modal film, None where grooves or bores are cut out; cells: (around, along); steps: per period; rate: reference
    speed of the test in rad/s, for the penalty model on the dimensionless pressure; turning: rad/s of the surface that
    the supply is in, whose frame the film is solved in; ramp: s, t_1 of (4.11)."""

    test: str
    cavitation: str
    section: Section
    rectangle: Section | None
    cells: tuple[int, int]
    steps: int
    rate: float
    decisions: tuple[Decision, ...]
    turning: float = 0.0
    ramp: float = 0.0
    model: BearingModel | None = None  # the bearing model that tells the forces; cavitation is empty then
    published: bool = False  # whether the two-phase model is in its published form, on quadratic elements

    @property
    def law(self) -> type[Law]:
        """The cavitation law."""
        return law_named(self.cavitation)

    @property
    def remembers(self) -> bool:
        """Whether the film has a state of its own."""
        return self.model is None and self.law.keeps_oil

    @property
    def modal(self) -> bool:
        """Whether the pressure is that of the modal film."""
        return self.model is None and self.rectangle is not None and self.law.closed


def kinematic_plan(case: Case, cavitation: str | None = None, test: str = "rotation") -> KinematicPlan:
    """Plan a kinematic test of a case for one cavitation model (None: that of the case).

    Raises InputError naming everything that the case lacks for it or that this version does not model.
    """
    if case.film.bearing_model:
        return _model_plan(case, cavitation or "", test)
    cavitation = cavitation or case.film.cavitation
    _refuse(case, cavitation, test)
    bearing = case.bearings[0]
    assert isinstance(bearing, SingleFilmBearing)
    assert case.motion is not None
    section = film_section(case, bearing)
    rectangle = film_rectangle(section)
    law = law_named(cavitation)
    closed = law.closed and bearing.ends == "free-to-air"
    if closed:
        section = ends_at_ambient(section)
    decisions = [_gap_decision(section, bearing), *_lobe_decision(section)]
    published = _is_published(case, law)
    decisions.append(PUBLISHED_FILM if published else _film_decision(law, rectangle is not None))
    if closed:
        reason = f"{cavitation} clips a pressure that is ambient at the ends; it knows no oil that is missing there"
        decisions.append(Decision("ends", "ambient pressure", reason))
    for film in unfed_films(with_model(case, cavitation)):
        decisions.append(Decision("supply", "starves" if film.keeps else "missing", film.reason))
    cells, why = _elements(case) if published else _cells(case, test)
    choice = "elements" if published else "cells"
    decisions.append(Decision(choice, f"{cells[0]} x {cells[1]}", f"around x along; {why}"))
    if test != "rotation":
        decisions.append(Decision("steps", f"{STEPS_PER_PERIOD} per period", "of equal length"))
    if published:
        kind = case.film.given(cavitation).diffusion
        decisions.append(Decision("diffusion", kind, DIFFUSIONS[kind]))
    elif law.published_form:
        reason = "upwind flow through the faces of the cells: conserves oil, in place of an artificial diffusion"
        decisions.append(Decision("diffusion", "upwind", reason))
    rate = TWO_PI * abs(case.motion.speed or case.motion.frequency or case.motion.whirl_speed or 1.0)
    turning = 0.0
    if bearing.supply.surface == "journal":
        turning = TWO_PI * (case.motion.speed or 0.0)
        decisions.append(Decision("frame", "of the journal", "the feed holes turn with it and are at rest there"))
    return KinematicPlan(
        test, cavitation, section, rectangle, cells, STEPS_PER_PERIOD, rate, tuple(decisions), turning,
        bearing.supply.rise_time, published=published,
    )  # fmt: skip


def _model_plan(case: Case, cavitation: str, test: str) -> KinematicPlan:
    """Of a bearing model. Raises as kinematic_plan."""
    faults = [*motion_faults(case.motion, test), *bearing_faults(case, test), *film_faults(case)]
    if cavitation:
        problem = f"has no effect on film.theory = {case.film.theory}, a bearing model."
        faults.append(Fault("--cavitation", cavitation, None, problem, "Leave it out."))
    motion = case.motion
    rate = TWO_PI * abs((motion and (motion.speed or motion.frequency or motion.whirl_speed)) or 1.0)
    from frbcli.scene.machine.bearing_model_films import (
        model_faults,  # numba takes longer to import than a plan to make
    )

    faults += model_faults(case, rate)
    if faults:
        raise InputError(case.name or "case", tuple(faults))
    bearing, model = case.bearings[0], chosen_model(case)
    assert isinstance(bearing, SingleFilmBearing)
    assert model is not None
    section = film_section(case, bearing)
    decisions = [Decision(*decided) for decided in model_decisions(model)]
    if test != "rotation":
        decisions.append(Decision("steps", f"{STEPS_PER_PERIOD} per period", "of equal length"))
    rectangle = film_rectangle(section)
    return KinematicPlan(
        test, "", section, rectangle, (0, 0), STEPS_PER_PERIOD, rate, tuple(decisions), model=model
    )


def with_model(case: Case, cavitation: str) -> Case:
    """The case with a cavitation model for its film."""
    return altered(case, {"film": altered(case.film, {"cavitation": cavitation})})


def law_at(case: Case, plan: KinematicPlan, eccentricity: float) -> Law:
    """The law of a film at an eccentricity, at the reference speed of the test."""
    return make_law(case, plan.cavitation, plan.section).followed(eccentricity, plan.rate)


def _cells(case: Case, test: str) -> tuple[tuple[int, int], str]:
    if case.accuracy.mesh is not None:
        return given_cells(case.accuracy.mesh, FEWEST)
    if test != "rotation":
        return MOVING_CELLS, "equal ones around, for the narrowest gap moves"
    fine = case.accuracy.target <= FINE_TARGET
    return FINE_CELLS if fine else STEADY_CELLS, "finer at the narrowest gap"


def _elements(case: Case) -> tuple[tuple[int, int], str]:
    if case.accuracy.mesh is not None:
        elements, why = given_cells(case.accuracy.mesh, FEWEST)
        return elements, f"of a section; {why}"
    return ELEMENTS, "of a section, as published"


def _gap_decision(section: Section, bearing: SingleFilmBearing) -> Decision:
    if section.far == "groove" and section.copies == 2:
        return Decision("gap", "1 of 2 sections", "a central circumferential groove parts two equal films")
    if section.far == "symmetry":
        reason = f"supply {bearing.supply.kind}: the film is symmetric about its middle"
        return Decision("gap", "half the width", reason)
    return Decision("gap", "the whole width", f"supply {bearing.supply.kind}: the film is not symmetric")


def _lobe_decision(section: Section) -> list[Decision]:
    lobes = section.lobes
    if lobes is None:
        return []
    machined = 1e6 * section.clearance / (1.0 - lobes.preload)
    reason = f"clearance {1e6 * section.clearance:.4g} um where they are narrowest, {machined:.4g} um of their bores"
    return [Decision("lobes", f"{lobes.count}, preload {lobes.preload:g}", reason)]


def _is_published(case: Case, law: type[Law]) -> bool:
    return law.published_form and case.film.given(law.name).form == "published"


def _film_decision(law: type[Law], rectangular: bool) -> Decision:
    cavitation = law.name
    if law.keeps_oil:
        return Decision("film", "finite volumes", f"{cavitation}: conserves oil and keeps it from moment to moment")
    if rectangular and law.closed:
        return Decision("film", "modal, quadratic elements", f"{cavitation} in a rectangular gap; it has no state")
    return Decision("film", "finite volumes", f"{cavitation}: has no state, each moment is a steady film of its own")


def _refuse(case: Case, cavitation: str, test: str) -> None:
    faults = [*motion_faults(case.motion, test), *_model_faults(case, cavitation)]
    faults += bearing_faults(case, test)
    faults += film_faults(with_model(case, cavitation) if cavitation in names() else case)
    if faults:
        raise InputError(case.name or "case", tuple(faults))


def _model_faults(case: Case, cavitation: str) -> list[Fault]:
    faults = []
    known = cavitation in names()
    if not known:
        faults.append(Fault("--cavitation", cavitation, None, "is no model.", did_you_mean(cavitation, names())))
    if case.film.theory == "short":
        problem = "is not for kinematic tests, which solve the whole film."
        faults.append(Fault("film.theory", "short", None, problem, 'Write "finite" or "auto".'))
    bearing = case.bearings[0]
    ramp = bearing.supply.rise_time if isinstance(bearing, SingleFilmBearing) else 0.0
    if ramp > 0.0 and known and _is_published(case, law_named(cavitation)):
        problem = "is a ramp of the pressure, which the elements of the published form do not follow."
        faults.append(Fault("bearing.supply.ramp", f"{ramp:g} s", None, problem, "Write 0 s."))
    return faults
