"""Rules of limit cycles, and of whirls with the unbalance."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.scene.channels import coupled_rings
from frbcli.scene.films import (
    HOUSING,
    FilmPlace,
    film_places,
    is_plain,
    turning_cartridges,
    turns_with_oil,
)
from frbcli.scene.keys import cavitation_keys
from frbcli.scene.machine.rotor import element_parts, harmonics_of, port_faults, speed_dependent, without_film
from frbcli.scene.planning.film_choice import all_clipped, form_of
from frbcli.scene.shafts.table import shaft_of
from frbcli.scene.speeds import default_speeds, keeps_oil

CONSTANT = "these limit cycles are computed for one rotor with constant coefficients"
HEAT_REMEDY = 'Write thermal.model = "none", and as temperature of each film the one of frb check or frb stability.'


def given_coefficient_faults(case: Case) -> Iterator[Fault]:
    """Coefficients of bearings that depend on the speed are followed where films have neither heat nor oil of their
    own."""
    if case.heat is not None or (case.films and by_shooting(case)):
        yield from speed_dependent(case, CONSTANT)


def linear_faults(case: Case) -> Iterator[Fault]:
    """A machine has a film, or another force that is not linear."""
    if not element_parts(case).ports:
        yield from without_film(case, "a linear machine has no limit cycles")


def cartridge_faults(case: Case) -> Iterator[Fault]:
    """The gyroscopic moments of a cartridge go by its tilt, which its films see where their shells are fixed."""
    if case.housing is None or by_shooting(case):
        return
    for key in turning_cartridges(case):
        problem = (
            "turns a cartridge in a housing that moves: its films see its tilt against the housing, and its gyroscopic "
            "moments go by its own."
        )
        yield Fault(f"{key}.ring.spin", "free", None, problem, "Leave the housing out, or take a run-up.")


def cycle_heat_faults(case: Case) -> Iterator[Fault]:
    """Cycles over the speed have temperatures that stay over a period, of films whose force follows from the motion."""
    if case.heat is None:
        return
    if by_shooting(case):
        problem = "settles over many periods, and cycles of this case are found from one period of a run."
        yield Fault("thermal.model", "lumped", None, problem, HEAT_REMEDY)
    for key in ("clearance", "centrifugal_growth"):
        if getattr(case.heat, key) == "follows":
            problem = "changes the clearances over which the motions of a branch are measured."
            yield Fault(f"thermal.{key}", "follows", None, problem, 'Write "fixed".')


def other_cycle_heat_faults(case: Case) -> Iterator[Fault]:
    """Cycles over other numbers than the speed are computed at given temperatures."""
    if case.heat is not None:
        problem = "balances the heat of limit cycles over the speed alone."
        yield Fault("thermal.model", "lumped", None, problem, HEAT_REMEDY)


def turning_port_faults(case: Case) -> Iterator[Fault]:
    """Forces that are not linear have no angle of their own: no whirl returns to it after one period."""
    problem = "turns with the rotor: the force depends on its angle, and no whirl returns after one period."
    yield from port_faults(case, problem, 'Write cage = "mean", or take a run.', lambda law: law.turns)


def smooth_faults(case: Case) -> Iterator[Fault]:
    """Films whose force does not follow smoothly from the motion alone, and other forces that are not linear."""
    yield from port_faults(case, "is not linear.", "Go over the speed alone.")
    named = dict(cavitation_keys(case)) if form_of(case).solved else {}
    keeping = {key: name for key, name in named.items() if law_named(name).keeps_oil}
    if keeping:
        problem = "is mass-conserving: the force depends on the oil that the film keeps, not on the motion alone."
        remedy = "Take half-sommerfeld or penalty here, and a run-up for this model."
        yield from (Fault(key, name, None, problem, remedy) for key, name in keeping.items())
    elif form_of(case).by_cells and not turning_openings(case):
        problem = "is solved on cells, where the force has no continuous derivative."
        remedy = "Go over the speed alone, or take half-sommerfeld, with grooves or feed holes that turn only."
        yield from (Fault(key, name, None, problem, remedy) for key, name in named.items())


def speed_cycle_faults(case: Case) -> Iterator[Fault]:
    """Films whose map over a period is not the same at each start, since their openings turn."""
    yield from turning_port_faults(case)
    if not by_shooting(case):
        yield from smooth_faults(case)
    elif form_of(case).by_cells and any(
        place.feed_holes is not None or (not is_plain(place.geometry) and _turns(case, place))
        for place in film_places(case)
    ):
        problem = "has openings that turn: the force depends on their angle, and no whirl returns after one period."
        remedy = "Leave feed holes that turn out, or take a run-up."
        yield from (Fault(key, name, None, problem, remedy) for key, name in cavitation_keys(case))


def speed_range_faults(case: Case) -> Iterator[Fault]:
    """Cycles are followed over speeds above zero."""
    speeds = default_speeds(case)
    if not speeds or not speeds[-1] > speeds[0]:
        problem, remedy = "leaves no range of speeds above zero.", 'Write e.g. speed.to = "300 Hz".'
        yield Fault("speed.to", f"{case.speed.end:g} Hz", None, problem, remedy)


def unbalance_faults(case: Case) -> Iterator[Fault]:
    """Whirls with unbalance need a rotor with unbalance."""
    if not drives(case):
        problem, remedy = "is zero: no whirl can lock in with it.", 'Write e.g. rotor.unbalance = "3 g*mm".'
        yield Fault("disk.unbalance" if case.disks else "rotor.unbalance", "0 g*mm", None, problem, remedy)


def drives(case: Case) -> list[str]:
    """What shakes the rotor of a case once or several times in a revolution, in words."""
    shaft = shaft_of(case)
    own = [name for name, size in (("unbalance", shaft.eccentricity), ("bow", shaft.bow)) if size != 0.0]
    return own + (["harmonic forces"] if harmonics_of(case) else [])


def by_shooting(case: Case) -> bool:
    """Whether limit cycles are found by shooting on the time loop: films are mass-conserving, or are on cells, where
    their force has kinks, or forces besides theirs are not linear."""
    kinked = form_of(case).by_cells and not turning_openings(case)
    return keeps_oil(case) or kinked or bool(element_parts(case).ports)


def turning_openings(case: Case) -> bool:
    """Whether finite-volume films are tabulated as the mean over the angle of their openings: their gaps are even along
    the axis, all solve a linear equation, and all openings turn."""
    if form_of(case).inclines or not all_clipped(case) or any(coupled_rings(case)):
        return False
    return all(
        is_plain(place.geometry) or (place.geometry.shell is None and place.grid_body != HOUSING)
        for place in film_places(case)
    )


def _turns(case: Case, place: FilmPlace) -> bool:
    return place.grid_body != HOUSING or turns_with_oil(case, place)
