"""Rules of bearing sheets, stability and response, and limit cycles."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FloatingRingBearing, SingleFilmBearing
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.scene.channels import coupled
from frbcli.scene.films import HOUSING, FilmPlace, film_places, is_plain, rings, turns_with_oil
from frbcli.scene.forms.published import is_published
from frbcli.scene.keys import bearing_key, cavitation_keys
from frbcli.scene.planning.film_choice import all_clipped, needs_cells


def sheet_faults(case: Case) -> Iterator[Fault]:
    """Films whose pressures, flows and loads are not known."""
    if case.film.bearing_model:
        problem = "is a bearing model: it tells the force, and neither pressures nor oil."
        yield Fault("film.theory", case.film.theory, None, problem, "Write finite or auto.")
    if is_published(case):
        problem = "creates oil: the flows and losses of a sheet would hang on how much."
        yield Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".')
    alone = len(case.bearings) == 1 and isinstance(case.bearings[0], SingleFilmBearing)
    if case.given_rotor is None and not alone:
        problem = "has more than one film: their loads follow from a rotor, which is missing."
        yield Fault("bearing", f"{len(film_places(case))} films", None, problem, "Add [rotor] and [speed].")


def coefficient_faults(case: Case) -> Iterator[Fault]:
    """Films that eight coefficients do not describe."""
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and coupled(bearing):
            problem = "couples the two films of a ring: neither has coefficients of its own."
            key = f"{bearing_key(case, index)}.channels"
            yield Fault(key, "coupled", None, problem, 'Write channels = "pressure" here.')
    if keeps_oil(case):
        yield from _memory_faults(case)


def _memory_faults(case: Case) -> Iterator[Fault]:
    """Films that keep oil and are not at rest in any frame, or whose oil cannot be linearised."""
    if is_published(case):
        problem = "creates oil: no oil settles in it, about which it could be linearised."
        yield Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".')
    for key, name in dict(cavitation_keys(case)).items():
        law = law_named(name)
        if law.keeps_oil and law.clips:
            problem = (
                "clips the pressures of its forces and keeps oil: forces do not follow from the pressures of cells."
            )
            yield Fault(key, name, None, problem, "Take a law that does not clip.")
        elif law.keeps_oil and any(_opens_in_turning(place) for place in film_places(case)):
            problem = "is mass-conserving, and has openings that turn: its oil is never at rest."
            remedy = "Supply it by a circumferential groove or by openings in the shell, or take half-sommerfeld."
            yield Fault(key, name, None, problem, remedy)


def _opens_in_turning(place: FilmPlace) -> bool:
    """Whether a film has openings in a body that turns."""
    return place.feed_holes is not None or (not is_plain(place.geometry) and place.grid_body != HOUSING)


def cycle_heat_faults(case: Case) -> Iterator[Fault]:
    """Heat has no steady state along a limit cycle that belongs to the rest that it grows from."""
    if case.heat is not None:
        problem = "is not modelled in limit cycles: each of them dissipates something else, and has other viscosities."
        remedy = 'Write thermal.model = "none", and as temperature of each film that of frb check or frb stability.'
        yield Fault("thermal.model", "lumped", None, problem, remedy)


def smooth_faults(case: Case) -> Iterator[Fault]:
    """Films whose force does not follow smoothly from the motion alone."""
    named = {} if case.film.bearing_model else dict(cavitation_keys(case))
    keeping = {key: name for key, name in named.items() if law_named(name).keeps_oil}
    if keeping:
        problem = "is mass-conserving: the force depends on the oil that the film keeps, not on the motion alone."
        remedy = "Take half-sommerfeld or penalty here, and a run-up for this model."
        yield from (Fault(key, name, None, problem, remedy) for key, name in keeping.items())
    elif needs_cells(case) and not turning_openings(case):
        problem = "is solved on cells, where the force has no continuous derivative."
        remedy = "Go over the speed alone, or take half-sommerfeld, with grooves or feed holes that turn only."
        yield from (Fault(key, name, None, problem, remedy) for key, name in named.items())


def speed_cycle_faults(case: Case) -> Iterator[Fault]:
    """Films whose map over a period is not the same at each start, since their openings turn; and the published form,
    whose oil is not on cells."""
    if not by_shooting(case):
        yield from smooth_faults(case)
    elif is_published(case):
        problem, remedy = "is not on cells, whose oil a limit cycle is made of.", 'Write form = "conservative".'
        yield Fault("film.two-phase.form", "published", None, problem, remedy)
    elif any(
        place.feed_holes is not None or (not is_plain(place.geometry) and _turns(case, place))
        for place in film_places(case)
    ):
        problem = "has openings that turn: the force follows their angle, and no motion comes back after one period."
        remedy = "Leave feed holes that turn out, or take a run-up."
        yield from (Fault(key, name, None, problem, remedy) for key, name in cavitation_keys(case))


def still_ring_faults(case: Case) -> Iterator[Fault]:
    """Rings that do not turn and are loaded: between them and the housing nothing turns that would carry."""
    problem = "leaves the outer film still, which then carries no weight: the ring rests on its shell."
    remedy = 'Write spin = "free".'
    for index, bearing in enumerate(case.bearings):
        if case.rotor.gravity > 0.0 and isinstance(bearing, FloatingRingBearing) and bearing.ring.spin == "blocked":
            yield Fault(f"{bearing_key(case, index)}.ring.spin", "blocked", None, problem, remedy)


def by_shooting(case: Case) -> bool:
    """Whether limit cycles are found by shooting on the time loop: films keep their oil, or are on cells, where their
    force has kinks."""
    return keeps_oil(case) or (needs_cells(case) and not turning_openings(case))


def keeps_oil(case: Case) -> bool:
    """Whether a film of the case is mass-conserving."""
    named = () if case.film.bearing_model else tuple(name for _, name in cavitation_keys(case))
    return any(law_named(name).keeps_oil for name in named)


def turning_openings(case: Case) -> bool:
    """Whether all films on cells solve a linear equation and have no openings but those that turn."""
    if not all_clipped(case) or any(coupled(bearing) for bearing in rings(case)):
        return False
    return all(
        is_plain(place.geometry) or (place.geometry.lobes is None and place.grid_body != HOUSING)
        for place in film_places(case)
    )


def _turns(case: Case, place: FilmPlace) -> bool:
    return place.grid_body != HOUSING or turns_with_oil(case, place)
