"""What a case lacks for a kinematic test, and what no such test can be made of."""

from __future__ import annotations

from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.schema import Case, KinematicMotion
from frbcli.errors import Fault
from frbcli.scene.machine.elements import without_film


def motion_faults(motion: KinematicMotion | None, test: str) -> list[Fault]:
    """Of the motion, for the test called "rotation", "squeeze" or "whirl"."""
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


def bearing_faults(case: Case, test: str) -> list[Fault]:
    """Of the bearing, for the test called "rotation", "squeeze" or "whirl"."""
    if faults := without_film(case, "a kinematic test is of one"):
        return faults
    if len(case.bearings) != 1:
        problem = "are too many: a kinematic test is of one bearing."
        return [Fault("bearing", f"{len(case.bearings)} bearings", None, problem, "Keep one [bearing].")]
    if case.heat is not None and test != "rotation":
        problem = f"is not modelled for a {test}: a film has no steady temperature there."
        remedy = 'Write thermal.model = "none": the film then has oil.temperature, or that of the supply.'
        return [Fault("thermal.model", "lumped", None, problem, remedy)]
    bearing = case.bearings[0]
    if not isinstance(bearing, SingleFilmBearing):
        problem = "has two films in series: a kinematic test moves the journal of one."
        remedy = 'Write kind = "single-film", with the dimensions of one of its films.'
        return [Fault("bearing.kind", bearing.kind, None, problem, remedy)]
    turns = test == "rotation" and case.motion is not None and case.motion.speed
    if bearing.supply.surface == "journal" and turns:
        problem = "turn with the journal: no film is steady in which the journal keeps its place."
        return [Fault("bearing.supply.on", "journal", None, problem, 'Write on = "shell", or speed = "0 Hz".')]
    return []
