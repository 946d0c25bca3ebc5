"""Rules of kinematic tests: one film, and a motion of its journal."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.gate.analysis import ROTATION

DAMPER_TEST = 'Write kind = "single-film", with the dimensions of its damper, and motion.speed = "0 Hz".'


def motion_faults(case: Case, test: str) -> Iterator[Fault]:
    """What the motion of a case lacks for a test."""
    motion = case.motion
    if motion is None:
        remedy = 'Add e.g. [motion] with eccentricity = 0.6, angle = "-60 deg", speed = "20 Hz".'
        yield Fault("motion", "", None, f"is missing; a {test} needs it.", remedy)
        return
    if test == ROTATION:
        if motion.speed is None and motion.whirl_speed == 0.0 and motion.eccentricity_rate == 0.0:
            yield Fault("motion.speed", "", None, "is missing.", 'Add e.g. speed = "20 Hz" to [motion].')
        if motion.load is not None and not motion.speed:
            problem = "cannot be carried by a journal that does not turn."
            yield Fault("motion.load", f"{motion.load:g} N", None, problem, "Give a speed other than zero.")
        if motion.eccentricity is None and motion.load is None:
            problem = "is missing, and there is no load."
            yield Fault("motion.eccentricity", "", None, problem, 'Add it, or e.g. load = "29.9 N".')
        return
    if motion.eccentricity is None:
        problem = f"is missing; it is the largest one of a {test}."
        yield Fault("motion.eccentricity", "", None, problem, "Add e.g. eccentricity = 0.6 to [motion].")
    if not motion.frequency:
        problem = f"is missing; a {test} needs one above zero."
        yield Fault("motion.frequency", "", None, problem, 'Add e.g. frequency = "10 Hz" to [motion].')
    if case.heat is not None and motion.periods < 1.0:
        problem = "is less than one period, over which the heat of the film balances."
        yield Fault("motion.periods", f"{motion.periods:g}", None, problem, "Write 1 or more.")


def no_film_faults(case: Case) -> Iterator[Fault]:
    """A test is of the film between a journal and its shell."""
    if not case.bearings:
        key, bearing = case.bearing_keys[0], case.given_bearings[0]
        problem = "has no film between journal and shell, and a kinematic test is of one."
        remedy = "Add a bearing with a film." if bearing.damper is None else DAMPER_TEST
        yield Fault(f"{key}.kind", bearing.kind, None, problem, remedy)


def bearing_faults(case: Case, test: str) -> Iterator[Fault]:
    """What no test can be made of: several bearings, several films, openings that turn away under the journal."""
    if len(case.bearings) > 1:
        problem = "are too many: a kinematic test is of one bearing."
        yield Fault("bearing", f"{len(case.bearings)} bearings", None, problem, "Keep one [bearing].")
    if len(case.bearings) != 1:
        return
    bearing = case.bearings[0]
    if isinstance(bearing, FloatingRingBearing):
        problem = "has two films in series: a kinematic test moves the journal of one."
        remedy = 'Write kind = "single-film", with the dimensions of one of its films.'
        yield Fault("bearing.kind", bearing.kind, None, problem, remedy)
        return
    turns = test == ROTATION and case.motion is not None and case.motion.speed
    if bearing.supply.surface == "journal" and turns:
        problem = "turn with the journal: no film is steady in which the journal keeps its place."
        yield Fault("bearing.supply.on", "journal", None, problem, 'Write on = "shell", or speed = "0 Hz".')


def theory_faults(case: Case) -> Iterator[Fault]:
    """The short bearing neglects the flow around that the pressure drives."""
    if case.film.theory == "short":
        problem = "neglects the flow around that the pressure drives, with which a test computes torque and balance."
        yield Fault("film.theory", "short", None, problem, 'Write "finite" or "auto".')
