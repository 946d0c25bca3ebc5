"""The error of a run by its cells, from the same run on fewer cells.

Force errors at single states underestimate the error of a mass-conserving film, where errors accumulate; the difference
to a run on fewer cells contains all of them. What share of it is the error of the run follows from the errors that both
have in the shipped cases (scene/planning/cell_choice.py). It costs a third to a half of the time loop of the run.

Where fronts of oil cross cells, errors of the steps may be amplified far beyond the sum of the local ones, too. With
few cells and large steps the difference contains them: the tolerance is larger by as much as makes an error of second
order in the step larger by the ratio of the errors of the cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.runs.errors.cell_errors import FewerCells
from frbcli.runs.march import March, Progress
from frbcli.scene.films import film_places
from frbcli.scene.forms.cells import FRONT_ORDER, cells_of
from frbcli.scene.machine.system import System
from frbcli.scene.planning.cell_choice import worst_film
from frbcli.scene.shafts.table import shaft_of
from frbcli.solve.state import RUNNING

Observer = Callable[[Progress], None]

# Errors differ from those of the shipped cases, beside openings (grooves, slots, pockets, feed holes) by their order,
# too; most of all those of rings at rest beside a journal that turns.
SAFETY, SAFETY_OF_OPENINGS, SAFETY_OF_RINGS, SAFETY_OF_RINGS_AT_REST = 1.5, 2.0, 2.5, 4.0
LEAST = 0.5  # of the error that these cells were expected to make, which is 1.3 to 7 times the true one


def on_fewer_cells(march: March, until: float, observe: Observer | None = None) -> FewerCells | None:
    """The run of `march` from its beginning to a time in s on fewer cells; None for films that have none, too few, or
    that do not begin on fewer. observe: called some times a second."""
    cells = march.plan.form.fewer_cells(march.case, march.plan)
    if cells is None:
        return None
    worst = worst_film(march.case, march.plan.eccentricity)
    share = march.plan.form.as_exact
    own, others = (worst.of((around, share * along)) for around, along in (cells_of(march.plan), cells))
    tolerance = march.plan.tolerance * _looser(march.case, others / own)
    try:
        other = march.again(replace(march.plan, cells=cells, tolerance=tolerance))
    except NotConverged:
        return None
    status = RUNNING
    while status == RUNNING and other.time <= until:
        status, _ = other.chunk()
        if observe is not None:
            observe(other.progress(until))
    safety = _safety(march.case, march.system)
    return FewerCells(safety * own / (others - own), other.samples, LEAST * own, march.plan.eccentricity)


def _looser(case: Case, coarser: float) -> float:
    """Tolerance of the run on fewer cells over that of the run, for an error of the cells that is larger by `coarser`:
    the same for elastic rotors, whose disks vibrate long enough for a phase to shift with the steps."""
    return 1.0 if shaft_of(case).elastic else coarser**FRONT_ORDER


def _safety(case: Case, system: System) -> float:
    if not system.ring_count:
        plain = all(place.geometry.supply.plain for place in film_places(case))
        return SAFETY if plain else SAFETY_OF_OPENINGS
    at_rest = case.speed.start != 0.0 and case.start.position != "resting"
    return SAFETY_OF_RINGS_AT_REST if at_rest else SAFETY_OF_RINGS
