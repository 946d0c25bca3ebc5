"""Rules of runs: theory, solution and grid of the films, speeds, and the number of bearings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from frbcli.case.over_time import OverTime
from frbcli.case.reading.time_tables import WALLS
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.scene.coupling import coupling_of
from frbcli.scene.films import (
    film_keys,
    film_places,
    is_plain,
)
from frbcli.scene.forms import TableForm, solution_fault
from frbcli.scene.gate.rule import run_omega
from frbcli.scene.planning.film_choice import all_clipped, form_of
from frbcli.scene.tilted import CELLS


def theory_faults(case: Case) -> Iterator[Fault]:
    """The short bearing is for half-Sommerfeld films on rectangles."""
    if case.film.theory != "short":
        return
    if not isinstance(form_of(case), TableForm):
        remedy = "finite or auto for this cavitation model and supply; short is for half-sommerfeld on rectangles"
        yield _missing("film.theory", "short", remedy)
    elif any(place.geometry.supply.divides for place in film_places(case)):
        yield _missing("film.theory", "short", "finite or auto for a bearing with axial grooves")


def form_faults(case: Case) -> Iterator[Fault]:
    """Solution and grid of films of the program."""
    form = form_of(case)
    if not form.solved:
        return
    cells = form.by_cells
    chained = any(place.geometry.supply.divides for place in film_places(case))
    if (fault := solution_fault(case, all_clipped(case), not (chained or cells))) is not None:
        yield fault
    may_turn = cells and all(is_plain(place.geometry) for place in film_places(case))
    if case.film.grid == "half-speed" and not may_turn:
        yield _missing("film.grid", "half-speed", "auto; it is for finite-volume films without openings and lobes")


def changing_supply_faults(case: Case) -> Iterator[Fault]:
    """The films of a run follow the pressure of their supply over time: all pressures of a table by one factor."""
    form, oil = form_of(case), case.oil
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        film, remedy = place.geometry, "Give one pressure."
        if film.supply.over_time is None:
            continue
        if not form.follows_supply:
            problem = f"changes over time, which a {form} does not follow."
        elif any(each.clearance_steps for each in case.films):
            problem = "changes over time, and bearing.clearance_steps make films of a pressure that stays."
        elif form.by_cells or oil.cavitation_pressure == oil.ambient_pressure:
            continue
        else:
            problem = "changes over time, and not in proportion to oil.cavitation_pressure, which a table has, too."
            remedy = 'Write film.solution = "cells", or oil.cavitation_pressure as oil.ambient_pressure.'
        yield Fault(f"{key}.supply.pressure", "over time", None, problem, remedy)


def kept_film_faults(case: Case) -> Iterator[Fault]:
    """The films that a run keeps are those whose cells have an oil fraction as their state."""
    form, kept = form_of(case), case.output.films
    if kept is None:
        return
    if form is not CELLS:
        problem = f"asks for the oil of cells, and the films are: {form}."
    elif coupling_of(case).in_turn:
        problem = "asks for the films of single steps, and a co-simulation does not have them."
    elif not all(law_named(name).keeps_oil for name in case.cavitations):
        problem = "asks for the oil of the films, and their model does not keep any."
    else:
        return
    remedy = 'Leave it out, or write film.cavitation = "two-phase", with film.coupling = "auto" and film.tilt = "none".'
    yield Fault("output.films", f"{kept.frames} frames", None, problem, remedy)


def axial_faults(case: Case) -> Iterator[Fault]:
    """A collar does not lie on its pads at the speeds of a case."""
    if not case.loads_a_collar:
        return
    from frbcli.elements.collar import uncarried_faults  # films on pads take a second to import

    yield from uncarried_faults(case)


def axial_heat_faults(case: Case) -> Iterator[Fault]:
    """The films of a collar are as warm as at rest at the speed of the moment, with temperatures that stay."""
    if not case.loads_a_collar or case.heat is None:
        return
    walls = {wall: getattr(case.heat, wall) for wall in WALLS}
    given = {"supply_temperature": case.heat.supply_temperature}
    given |= {wall: getattr(value, "temperature", value) for wall, value in walls.items()}
    for key, value in given.items():
        if isinstance(value, OverTime):
            problem = "changes over time, which the temperatures of the films on the pads do not follow."
            remedy = "Give one temperature, or leave [axial] out."
            yield Fault(f"thermal.{key}", value.origin, None, problem, remedy)


def drive_faults(case: Case) -> Iterator[Fault]:
    """A speed that is free is solved in the stages of the time loop; an axial load over time goes by given speeds."""
    if case.drive is None:
        return
    if coupling_of(case).in_turn:
        problem = "takes the rotor's speed as given, and [drive] leaves it free."
        yield Fault("film.coupling", case.film.coupling, None, problem, "Write auto, or [speed] instead of [drive].")
    if case.axial is not None and case.axial.changes:
        problem = "changes over time, and the collar of a rotor whose speed is free has one load for each speed."
        yield Fault("axial.load", "", None, problem, 'Give one load, or { at = "1000 Hz", load = "40 N" }.')
    if case.drive.reaction and case.bases:
        problem = "acts on a rotor whose ground is at rest, and [base] moves it."
        yield Fault("drive.reaction", "true", None, problem, "Leave one of the two out.")


def speed_faults(case: Case) -> Iterable[Fault]:
    """A run has speeds. Raises InputError for a case of kinematic tests, which has none."""
    run_omega(case)
    return ()


def number_faults(case: Case) -> Iterator[Fault]:
    """A symmetric rotor has one bearing with a film for both."""
    if len(case.bearings) > 1 and case.rotor.symmetric:
        both = "one bearing with a film, which represents both of a symmetric rotor, and any with given coefficients"
        yield _missing("bearing", f"{len(case.bearings)} bearings", both)


def _missing(key: str, value: str, known: str) -> Fault:
    return Fault(key, value, None, "is not modelled in this version.", f"Modelled are: {known}.")
