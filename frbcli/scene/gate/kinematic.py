"""Kinematic tests: the film that one is of, as a case of its own, and the rules of its film and motion.

The journal of that case is what is inside of the film, and what is outside is a shell at rest.
"""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FilmBearing, SingleFilmBearing
from frbcli.case.film import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.errors import Fault, did_you_mean
from frbcli.scene.films import (
    as_text,
    bearing_films,
    bearing_key,
    coupled,
    film_keys,
    film_section,
    least_gaps,
    misaligned,
    places_of,
    slope_of,
    tilt_key,
    tilt_of,
    tilts,
)
from frbcli.scene.gate.rule import ROTATION

OF_THE_FILM = {
    "name", "title", "confirm", "given_bearings", "given_oil", "film", "thermal", "motion", "start", "contact",
    "accuracy", "output",
}  # fmt: skip
LEFT_OUT = {name: field.default for name, field in Case.model_fields.items() if name not in OF_THE_FILM}


def tested_case(case: Case) -> Case:
    """The case of the film that motion.film names, without a rotor; the case itself where it names none. The tilt of
    the journal is given by the motion."""
    if case.film.tilt != "none":
        case = altered(case, {"film": altered(case.film, {"tilt": "none"})})
    index = _index(case)
    if index is None or case.motion is None:
        return case
    film = bearing_films(case)[index].geometry
    bearing = _alone(_bearing(case, index), film)
    values = {
        "title": f"{case.heading}, film {case.motion.film}",
        "given_bearings": (bearing,),
        "motion": altered(case.motion, {"film": ""}),
        "film": altered(case.film, {"cavitation": case.cavitation(film)}),
    }
    return altered(case, LEFT_OUT | values)


def choice_faults(case: Case, test: str) -> Iterator[Fault]:
    """A film that is not named among several, or is none of the case, or is not the film of one gap alone."""
    names = [place.name for place in bearing_films(case)]
    asked = "" if case.motion is None else case.motion.film
    hint = f"Films of the case: {', '.join(names)}."
    if not asked:
        if len(names) > 1:
            problem = f"is missing: the case has {len(names)} films, and a {test} moves the journal of one."
            yield Fault("motion.film", "", None, problem, f'Write e.g. motion.film = "{names[0]}". {hint}')
        return
    index = _index(case)
    if index is None:
        remedy = did_you_mean(asked, names) if any(names) else "Leave it out: the case has one film."
        yield Fault("motion.film", asked, None, "is no film of the case.", remedy)
        return
    bearing = _bearing(case, index)
    if bearing.kind != "floating-ring":
        return
    if coupled(bearing):
        key = f"{bearing_key(case, case.bearings.index(bearing))}.channels"
        problem = "lets the oil of one film of the ring into the other, and a test is of one film."
        yield Fault(key, "coupled", None, problem, 'Write channels = "pressure".')
    if bearing.misalignment is not None:
        key = f"{bearing_key(case, case.bearings.index(bearing))}.misalignment"
        problem = "tilts the shell around a ring, and a test is of one film of it, in line but for the motion."
        yield Fault(key, as_text(bearing.misalignment), None, problem, "Leave it out; motion.tilt tilts the film.")
    if case.heat is not None:
        problem = "has a ring as its wall, whose temperature follows from both of its films, and a test is of one."
        yield Fault("thermal.model", "lumped", None, problem, 'Write thermal.model = "none".')


def key_in(case: Case, key: str) -> str:
    """The key in a case of what has a key in its tested case."""
    index = _index(case)
    if index is None or not (key == "bearing" or key.startswith("bearing.")):
        return key
    return film_keys(case)[index] + key.removeprefix("bearing")


def _index(case: Case) -> int | None:
    """The number of the film that motion.film names."""
    names = [place.name for place in bearing_films(case)]
    asked = "" if case.motion is None else case.motion.film
    return names.index(asked) if asked and asked in names else None


def _bearing(case: Case, index: int) -> FilmBearing:
    """The bearing of a film."""
    return [bearing for bearing in case.bearings for _ in bearing.films][index]


def _alone(bearing: FilmBearing, film: FilmGeometry) -> SingleFilmBearing:
    """A bearing of one film on a fixed shell."""
    if bearing.kind == "single-film":
        return altered(bearing, {"damper": None, "support": None})
    own = SingleFilmBearing.model_fields
    given = {field.alias or name: getattr(film, name) for name, field in type(film).model_fields.items() if name in own}
    given = {key: value for key, value in given.items() if value is not None}
    return SingleFilmBearing.model_validate({"kind": "single-film", "name": bearing.name, **given})


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
