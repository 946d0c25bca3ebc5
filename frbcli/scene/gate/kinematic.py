"""Rules of kinematic tests: one film, and a motion of its journal."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.films import bearing_films
from frbcli.scene.gate.rule import ROTATION
from frbcli.scene.section import film_section
from frbcli.scene.tilt import as_text, least_gaps, misaligned, places_of, slope_of, tilt_key, tilt_of, tilts

SPARE = 0.1  # share of the least gap without tilt that a remedy leaves

DAMPER_TEST = 'Write kind = "single-film", with the dimensions of its damper, and motion.speed = "0 Hz".'


def motion_faults(case: Case, test: str) -> Iterator[Fault]:
    """What the motion of a case lacks for a test."""
    motion = case.motion
    if motion is None:
        remedy = 'Add e.g. [motion] with eccentricity = 0.6, angle = "-60 deg", speed = "20 Hz".'
        yield Fault("motion", "", None, f"is missing; a {test} needs it.", remedy)
        return
    if test == ROTATION:
        moves = motion.whirl_speed or motion.eccentricity_rate or motion.velocity or motion.tilt_rate
        if motion.speed is None and not moves:
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


def turning_faults(case: Case, test: str) -> Iterator[Fault]:
    """Openings that turn away under the journal."""
    if len(bearing_films(case)) != 1:
        return
    turns = test == ROTATION and case.motion is not None and case.motion.speed
    if case.bearings[0].films[0].supply.surface == "journal" and turns:
        problem = "lets the openings turn with the journal; while it keeps its place, no film is steady."
        yield Fault("bearing.supply.on", "journal", None, problem, 'Write on = "shell", or speed = "0 Hz".')


def theory_faults(case: Case) -> Iterator[Fault]:
    """Tests with heat follow the oil of a film of finite length, and the short bearing has the same gap along it."""
    if case.film.theory != "short":
        return
    if case.heat is not None:
        problem = "neglects the flow around that the pressure drives, whose heat a test with [thermal] follows."
        yield Fault("film.theory", "short", None, problem, 'Write "finite" or "auto".')
    if case.motion is not None and len(case.bearings) == 1 and tilts(case):
        problem = "is of a gap that is the same along the bearing, and this one tilts."
        yield Fault("film.theory", "short", None, problem, 'Write "finite" or "auto".')


def tilt_faults(case: Case, test: str) -> Iterator[Fault]:
    """Motions in which a journal cannot tilt, and films that cannot follow it."""
    motion = case.motion
    if motion is None:
        return
    if test != ROTATION:
        for key in ("velocity", "tilt_rate"):
            if getattr(motion, key) is not None:
                problem = f"is of a rotation; a {test} moves the journal at its own velocity, and keeps its tilt."
                yield Fault(f"motion.{key}", as_text(getattr(motion, key)), None, problem, "Leave it out.")
        return
    if len(case.bearings) != 1 or not tilts(case):
        return
    key, value = tilt_key(case)
    if motion.load is not None:
        problem = "is given with a load: a journal at rest takes the tilt at which the moment of its film vanishes."
        yield Fault(key, value, None, problem, "Give an eccentricity instead of motion.load, or leave the tilt out.")


def end_faults(case: Case, test: str) -> Iterator[Fault]:
    """A tilt that closes the gap at an end of the bearing."""
    if not tilts(case):
        return
    section, places, tilt = film_section(case, case.bearings[0].films[0]), places_of(case, test), tilt_of(case)

    def least(share: float) -> float:
        return min(least_gaps(section, places, slope_of((share * tilt[0], share * tilt[1]), section)))

    gap = least(1.0)
    if gap > 0.0:
        return
    key, value = tilt_key(case)
    low, high = least_gaps(section, places, slope_of(tilt, section))
    end = "z < 0" if low <= high else "z > 0"
    problem = (
        f"closes the gap at the end {end} of the bearing: journal and shell would overlap by "
        f"{-1e6 * section.clearance * gap:.3g} um there."
    )
    share = next((n / 100 for n in range(99, 0, -1) if least(n / 100) > SPARE * least(0.0)), 0.0)
    tilted = f"at most {share:g} of this tilt against the shell" if share else "no tilt"
    yield Fault(key, value, None, problem, f"Write {tilted}, or a smaller eccentricity.")


def misalignment_faults(case: Case) -> Iterator[Fault]:
    """Shells that are not in line, where journal and shell are taken to be parallel."""
    for key, value in misaligned(case):
        problem = "tilts the shell, which kinematic tests, runs, machines at rest and cycles over the speed follow."
        yield Fault(key, value, None, problem, "Leave it out here.")
