"""The plan of a kinematic bearing test (section 4.2.2): which section of the film is solved, which law, which cells."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from frbcli.case.bearing import AxialGrooves, Bores, CircumferentialGroove, Pocket, SingleFilmBearing
from frbcli.case.schema import Case, Motion
from frbcli.errors import Fault, InputError
from frbcli.film.bearing import RectangularBearing
from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.peeken import Peeken
from frbcli.film.cavitation.penalty import PREFACTOR, Penalty, steepness_exponent
from frbcli.film.cavitation.reynolds import Reynolds
from frbcli.film.cavitation.sommerfeld import Sommerfeld
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.gap import AxialGroove, Hole, Section
from frbcli.scene.plan import Decision

TESTS = ("rotation", "squeeze", "whirl")
MODELS = ("half-sommerfeld", "sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase")
COMPARED = tuple(model for model in MODELS if model != "sommerfeld")  # where nothing else is said
REMEMBERING = ("peeken", "elrod", "two-phase")  # oil is kept from one moment to the next; the others have no state

# around, along; of a section that is half the film half as many along
STEADY_CELLS, FINE_CELLS = (160, 40), (240, 60)
MOVING_CELLS = (64, 16)
FINE_TARGET = 2e-4
STEPS_PER_PERIOD = 600  # the moment at which a film is full again, and so its force, hangs on the step
FEWEST_CELLS = (12, 3)
TWO_PI = 2.0 * math.pi


@dataclass(frozen=True)
class KinematicPlan:
    """What will be modelled. section: of the film, copied section.copies times; rectangle: the bearing of the accurate
    modal film, None where grooves or bores are cut out; cells: (around, along); steps: per period; rate: reference
    speed of the test in rad/s, for the penalty model on the dimensionless pressure."""

    test: str
    cavitation: str
    section: Section
    rectangle: RectangularBearing | None
    cells: tuple[int, int]
    steps: int
    rate: float
    decisions: tuple[Decision, ...]

    @property
    def remembers(self) -> bool:
        """Whether the film has a state of its own."""
        return self.cavitation in REMEMBERING

    @property
    def modal(self) -> bool:
        """Whether the pressure is that of the modal film."""
        return self.rectangle is not None and self.cavitation in ("sommerfeld", "half-sommerfeld")


def kinematic_plan(case: Case, cavitation: str | None = None, test: str = "rotation") -> KinematicPlan:
    """Plan a kinematic test of a case for one cavitation model (None: that of the case).

    Raises InputError naming everything that the case lacks for it or that this version does not model.
    """
    cavitation = cavitation or case.film.cavitation
    _refuse(case, cavitation, test)
    bearing = case.bearings[0]
    assert isinstance(bearing, SingleFilmBearing)
    assert case.motion is not None
    section = _section(case, bearing)
    rectangle = _rectangle(bearing, section)
    closed = cavitation in ("sommerfeld", "half-sommerfeld") and bearing.ends == "free-to-air"
    if closed:
        far = "oil-bath" if section.far == "free-to-air" else section.far
        section = replace(section, near="oil-bath", far=far)
    decisions = [_gap_decision(section, bearing), _film_decision(cavitation, rectangle is not None)]
    if closed:
        reason = f"{cavitation} clips a pressure that is ambient at the ends; it knows no oil that is missing there"
        decisions.append(Decision("ends", "ambient pressure", reason))
    cells, why = _cells(case, test)
    decisions.append(Decision("cells", f"{cells[0]} x {cells[1]}", f"around x along; {why}"))
    if test != "rotation":
        decisions.append(Decision("steps", f"{STEPS_PER_PERIOD} per period", "of equal length"))
    if cavitation == "two-phase":
        reason = "upwind flow through the faces of the cells: conserves oil, in place of an artificial diffusion"
        decisions.append(Decision("diffusion", "upwind", reason))
    rate = TWO_PI * abs(case.motion.speed or case.motion.frequency or case.motion.whirl_speed or 1.0)
    return KinematicPlan(test, cavitation, section, rectangle, cells, STEPS_PER_PERIOD, rate, tuple(decisions))


def make_law(case: Case, plan: KinematicPlan, eccentricity: float) -> Law:
    """The law of a film at an eccentricity, on which the penalty model's steepness (3.32) depends."""
    film, section = case.film, plan.section
    if plan.cavitation == "reynolds":
        return Reynolds()
    if plan.cavitation == "penalty":
        exponent = steepness_exponent(eccentricity)
        if film.penalty.pressure == "absolute":
            return Penalty(PREFACTOR, exponent * section.pressure_scale / section.ambient_pressure)
        return Penalty(0.5 * PREFACTOR * plan.rate, 2.0 * exponent / plan.rate)
    if plan.cavitation == "peeken":
        return Peeken(film.peeken.bunsen)
    if plan.cavitation == "elrod":
        modulus = film.elrod.bulk_modulus
        return Elrod() if modulus is None else Elrod(modulus / section.pressure_scale)
    if plan.cavitation == "two-phase":
        return TwoPhase(film.two_phase.steepness)
    return Sommerfeld(clips=plan.cavitation == "half-sommerfeld")


def _section(case: Case, bearing: SingleFilmBearing) -> Section:
    """The part of the film that has to be solved: half of it where it is symmetric about the middle."""
    supply, ends, width = bearing.supply, bearing.ends, bearing.width
    radius, ambient = 0.5 * bearing.diameter, case.oil.ambient_pressure
    copies, far, far_pressure = 2, "symmetry", 0.0
    grooves: tuple[AxialGroove, ...] = ()
    holes: tuple[Hole, ...] = ()
    if isinstance(supply, CircumferentialGroove):
        copies = 2 if supply.axial_position == 0.5 else 1
        far, far_pressure = "groove", supply.pressure - ambient
    elif isinstance(supply, AxialGrooves):
        places = (supply.position + i * TWO_PI / supply.count for i in range(supply.count))
        grooves = tuple(AxialGroove(place, supply.opening_angle, supply.pressure - ambient) for place in places)
    elif isinstance(supply, Pocket):
        half_angle, half_width = 0.5 * supply.opening_angle, 0.5 * supply.width
        holes = (Hole(supply.position, 0.5 * width, half_angle, half_width, supply.pressure - ambient, round=False),)
    elif isinstance(supply, Bores):
        if supply.axial_position != 0.5:
            copies, far = 1, ends
        size, axial = 0.5 * supply.diameter, supply.axial_position * width
        places = (supply.position + i * TWO_PI / supply.count for i in range(supply.count))
        holes = tuple(Hole(p, axial, size / radius, size, supply.pressure - ambient, round=True) for p in places)
    return Section(
        radius=radius,
        width=width / copies,
        bearing_width=width,
        clearance=bearing.clearance,
        viscosity=case.viscosity(bearing),
        ambient_pressure=ambient,
        cavitation_pressure=case.oil.cavitation_pressure,
        copies=copies,
        near=ends,
        far=far,
        far_pressure=far_pressure,
        grooves=grooves,
        holes=holes,
    )


def _rectangle(bearing: SingleFilmBearing, section: Section) -> RectangularBearing | None:
    if section.grooves or section.holes:
        return None
    return RectangularBearing(
        width=bearing.width,
        diameter=bearing.diameter,
        clearance=bearing.clearance,
        viscosity=section.viscosity,
        sections=section.copies if section.far == "groove" else 1,
        ambient_pressure=section.ambient_pressure,
        cavitation_pressure=section.cavitation_pressure,
        supply_pressure=section.ambient_pressure + section.far_pressure if section.far == "groove" else None,
    )


def _cells(case: Case, test: str) -> tuple[tuple[int, int], str]:
    if case.accuracy.mesh is not None:
        along, around = case.accuracy.mesh
        return (max(around, FEWEST_CELLS[0]), max(along, FEWEST_CELLS[1])), "set in the case"
    if test != "rotation":
        return MOVING_CELLS, "equal ones around, for the narrowest gap moves"
    fine = case.accuracy.target <= FINE_TARGET
    return FINE_CELLS if fine else STEADY_CELLS, "finer at the narrowest gap and at the ends"


def _gap_decision(section: Section, bearing: SingleFilmBearing) -> Decision:
    if section.far == "groove" and section.copies == 2:
        return Decision("gap", "1 of 2 sections", "a central circumferential groove parts two equal films")
    if section.far == "symmetry":
        reason = f"supply {bearing.supply.kind}: the film is symmetric about its middle"
        return Decision("gap", "half the width", reason)
    return Decision("gap", "the whole width", f"supply {bearing.supply.kind}: the film is not symmetric")


def _film_decision(cavitation: str, rectangular: bool) -> Decision:
    if cavitation in REMEMBERING:
        return Decision("film", "finite volumes", f"{cavitation}: conserves oil and keeps it from moment to moment")
    if rectangular and cavitation in ("sommerfeld", "half-sommerfeld"):
        return Decision("film", "modal, quadratic elements", f"{cavitation} in a rectangular gap; it has no state")
    return Decision("film", "finite volumes", f"{cavitation}: has no state, each moment is a steady film of its own")


def _refuse(case: Case, cavitation: str, test: str) -> None:
    faults = [*_motion_faults(case.motion, test), *_model_faults(case, cavitation), *_bearing_faults(case)]
    if faults:
        raise InputError(case.name or "case", tuple(faults))


def _motion_faults(motion: Motion | None, test: str) -> list[Fault]:
    if motion is None:
        remedy = 'Add e.g. [motion] with eccentricity = 0.6, angle = "-60 deg", speed = "20 Hz".'
        return [Fault("motion", "", None, f"is missing; a {test} needs it.", remedy)]
    faults = []
    if test == "rotation":
        if motion.speed is None and motion.whirl_speed == 0.0 and motion.eccentricity_rate == 0.0:
            faults.append(Fault("motion.speed", "", None, "is missing.", 'Add e.g. speed = "20 Hz" to [motion].'))
        if motion.load is not None and not motion.speed:
            problem = "cannot be carried by a journal that does not turn."
            faults.append(Fault("motion.load", f"{motion.load:g} N", None, problem, "Give a speed other than zero."))
        if motion.eccentricity is None and motion.load is None:
            problem = "is missing, and there is no load."
            faults.append(Fault("motion.eccentricity", "", None, problem, 'Add it, or e.g. load = "29.9 N".'))
        return faults
    if motion.eccentricity is None:
        problem = f"is missing; it is the largest one of a {test}."
        faults.append(Fault("motion.eccentricity", "", None, problem, "Add e.g. eccentricity = 0.6 to [motion]."))
    if not motion.frequency:
        problem = f"is missing; a {test} needs one above zero."
        faults.append(Fault("motion.frequency", "", None, problem, 'Add e.g. frequency = "10 Hz" to [motion].'))
    return faults


def _model_faults(case: Case, cavitation: str) -> list[Fault]:
    faults = []
    if cavitation not in MODELS:
        faults.append(Fault("--cavitation", cavitation, None, "is no model.", f"There are: {', '.join(MODELS)}."))
    if case.film.theory == "short":
        problem = "is not for kinematic tests, which solve the whole film."
        faults.append(Fault("film.theory", "short", None, problem, 'Write "finite" or "auto".'))
    if cavitation == "two-phase" and case.film.two_phase.form == "published":
        problem = "is not modelled in this version: it creates oil where the film cavitates."
        faults.append(Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".'))
    return faults


def _bearing_faults(case: Case) -> list[Fault]:
    if len(case.bearings) != 1:
        problem = "are too many: a kinematic test is of one bearing."
        return [Fault("bearing", f"{len(case.bearings)} bearings", None, problem, "Keep one [bearing].")]
    bearing = case.bearings[0]
    if not isinstance(bearing, SingleFilmBearing):
        problem = "is not modelled in this version of kinematic tests."
        return [Fault("bearing.kind", bearing.kind, None, problem, 'Modelled is: "single-film".')]
    supply, faults = bearing.supply, []
    if supply.kind == "none" and bearing.ends == "free-to-air":
        problem = "with ends free to air gets no oil: the bearing runs dry."
        remedy = 'Add a supply to [bearing], or write ends = "oil-bath".'
        faults.append(Fault("bearing.supply.kind", supply.kind, None, problem, remedy))
    if isinstance(supply, CircumferentialGroove) and supply.axial_position not in (0.0, 0.5, 1.0):
        problem = "is neither in the middle nor at an end: the two films would differ."
        value = f"{supply.axial_position:g}"
        faults.append(Fault("bearing.supply.axial_position", value, None, problem, "Write 0.5, 0 or 1."))
    if isinstance(supply, Bores) and supply.on == "journal" and case.motion is not None and case.motion.speed:
        problem = "turn with the journal, which this version does not model."
        faults.append(Fault("bearing.supply.on", "journal", None, problem, 'Write on = "shell", or speed = "0 Hz".'))
    return faults
