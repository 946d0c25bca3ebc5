"""The film that a kinematic test is of, as a case of its own: its journal is what is inside of it, and what is outside
is a shell at rest."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FilmBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.nearest import did_you_mean
from frbcli.scene.channels import coupled
from frbcli.scene.films import bearing_films
from frbcli.scene.keys import bearing_key, film_keys
from frbcli.scene.tilt import as_text

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
    if not isinstance(bearing, FloatingRingBearing):
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
    if isinstance(bearing, SingleFilmBearing):
        return altered(bearing, {"damper": None, "support": None})
    own = SingleFilmBearing.model_fields
    given = {field.alias or name: getattr(film, name) for name, field in type(film).model_fields.items() if name in own}
    given = {key: value for key, value in given.items() if value is not None}
    return SingleFilmBearing.model_validate({"kind": "single-film", "name": bearing.name, **given})
