"""What limit cycles cannot be computed of, told before anything is."""

from __future__ import annotations

import math

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.table import law_named
from frbcli.linear.stability import default_speeds
from frbcli.scene.channels import coupled
from frbcli.scene.film_faults import require_films
from frbcli.scene.films import HOUSING, FilmPlace, film_places, is_plain, rings, turns_with_oil
from frbcli.scene.forms.published import is_published
from frbcli.scene.keys import cavitation_keys
from frbcli.scene.machine.elements import require_a_film, speed_dependent
from frbcli.scene.planning.film_choice import all_clipped, needs_cells


def check(case: Case, with_oil: bool = False) -> tuple[float, float]:
    """The range of speeds of a case in rad/s, the slowest above zero. with_oil: whether films may be mass-conserving.
    Raises InputError."""
    require_films(case)
    require_a_film(case, "limit cycles are those of films")
    if changing := speed_dependent(case, "limit cycles follow it with a rotor of constant coefficients"):
        raise InputError(case.name or "case", tuple(changing))
    faults = list(_oil_films(case) if with_oil and keeps_oil(case) else _films(case))
    if case.heat is not None:
        problem = "is not modelled in limit cycles: each of them dissipates something else, and has other viscosities."
        remedy = 'Write thermal.model = "none", and as temperature of each film that of frb check or frb stability.'
        faults.append(Fault("thermal.model", "lumped", None, problem, remedy))
    speeds = default_speeds(case)
    if not speeds or not speeds[-1] > speeds[0]:
        problem, remedy = "leaves no range of speeds above zero.", 'Write e.g. speed.to = "300 Hz".'
        faults.append(Fault("speed.to", f"{case.speed.end:g} Hz", None, problem, remedy))
    if faults:
        raise InputError(case.name or "case", tuple(faults))
    return 2.0 * math.pi * speeds[0], 2.0 * math.pi * speeds[-1]


def check_unbalance(case: Case) -> None:
    """Raises InputError if the whirl of a case with unbalance cannot be told."""
    faults = []
    if not has_unbalance(case):
        problem, remedy = "is zero: no whirl has two frequencies.", 'Write e.g. rotor.unbalance = "3 g*mm".'
        faults.append(Fault("disk.unbalance" if case.disks else "rotor.unbalance", "0 g*mm", None, problem, remedy))
    if keeps_oil(case):
        problem = "keeps its oil: its whirl with unbalance is not computed."
        remedy = "Take half-sommerfeld or penalty here, and a run-up for this model."
        faults += [Fault(key, name, None, problem, remedy) for key, name in cavitation_keys(case)]
    if faults:
        raise InputError(case.name or "case", tuple(faults))


def has_unbalance(case: Case) -> bool:
    """Whether the rotor of a case has one."""
    return bool(getattr(case.rotor, "unbalance", 0.0)) or any(disk.unbalance for disk in case.disks)


def keeps_oil(case: Case) -> bool:
    """Whether a film of the case is mass-conserving."""
    named = () if case.film.bearing_model else tuple(name for _, name in cavitation_keys(case))
    return any(law_named(name).keeps_oil for name in named)


def turning_openings(case: Case) -> bool:
    """Whether all films on cells solve a linear equation and have no openings but those that turn."""
    if not all_clipped(case) or any(coupled(bearing) for bearing in rings(case)):
        return False
    return all(is_plain(place.geometry) or _turn(place) for place in film_places(case))


def _turn(place: FilmPlace) -> bool:
    return place.geometry.lobes is None and place.grid_body != HOUSING


def _oil_films(case: Case) -> tuple[Fault, ...]:
    """Mass-conserving films whose map over a period is not the same at each start: their openings turn. And those of
    the published form, whose oil is not on cells."""
    named = cavitation_keys(case)
    kept = all(law_named(name).keeps_oil for _, name in named)
    turn = any(
        place.feed_holes is not None or (not is_plain(place.geometry) and _turns(case, place))
        for place in film_places(case)
    )
    if kept and not turn and not is_published(case):
        return ()
    problem = "has limit cycles only without openings that turn, with the oil of all films on cells."
    remedy = "Leave feed holes that turn and the published form out, or take a run-up."
    return tuple(Fault(key, name, None, problem, remedy) for key, name in named)


def _turns(case: Case, place: FilmPlace) -> bool:
    return place.grid_body != HOUSING or turns_with_oil(case, place)


def _films(case: Case) -> tuple[Fault, ...]:
    """Films whose force does not follow smoothly from the motion alone."""
    named = {} if case.film.bearing_model else dict(cavitation_keys(case))
    keeping = {key: name for key, name in named.items() if law_named(name).keeps_oil}
    if keeping:
        problem = "is mass-conserving: the force depends on the oil that the film keeps, not on the motion alone."
        remedy = "Take half-sommerfeld or penalty here, and a run-up for this model."
        return tuple(Fault(key, name, None, problem, remedy) for key, name in keeping.items())
    if not needs_cells(case) or turning_openings(case):
        return ()
    problem = "is solved on cells, where the force has no continuous derivative."
    remedy = "Take half-sommerfeld, and no openings but circumferential grooves and feed holes that turn."
    return tuple(Fault(key, name, None, problem, remedy) for key, name in named.items())
