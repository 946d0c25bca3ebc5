"""The error of a run by its cells, from the same run on fewer cells.

Force errors at single states underestimate the error of a mass-conserving film, where errors accumulate; the difference
to a run on fewer cells contains all of them. It costs 0.3 to 0.7 of the time loop of the run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from frbcli.errors import NotConverged
from frbcli.runs.cell_errors import FewerCells
from frbcli.runs.march import March, Progress
from frbcli.scene.film_choice import FEWEST_CELLS
from frbcli.scene.plan import Plan
from frbcli.scene.system import System
from frbcli.solve.state import RUNNING

Observer = Callable[[Progress], None]

# Of the cells in each direction; on fewer cells the feed holes would have another size.
SHARE, SHARE_WITH_HOLES = 1 / 2, 2 / 3
COARSER_BY = 1.2  # least ratio of the cells around


def on_fewer_cells(march: March, until: float, observe: Observer | None = None) -> FewerCells | None:
    """The run of `march` from its beginning to a time in s on fewer cells; None for films that have none, too few, or
    that do not begin on fewer. observe: called some times a second."""
    cells = fewer_cells(march.plan, march.system)
    if cells is None or march.plan.cells is None:
        return None
    try:
        other = march.again(replace(march.plan, cells=cells))
    except NotConverged:
        return None
    status = RUNNING
    while status == RUNNING and other.time <= until:
        status, _ = other.chunk()
        if observe is not None:
            observe(other.progress(until))
    return FewerCells(math.sqrt(math.prod(march.plan.cells) / math.prod(cells)), other.samples)


def fewer_cells(plan: Plan, system: System) -> tuple[int, int] | None:
    """Cells (around, along) that a run is compared on, None if there are no fewer."""
    if plan.cells is None or not system.volumes:
        return None
    share = SHARE_WITH_HOLES if any(film.section.holes for film in system.volumes) else SHARE
    around = max(4 * math.ceil(0.25 * share * plan.cells[0]), FEWEST_CELLS[0])
    along = min(max(round(share * plan.cells[1]), FEWEST_CELLS[1]), plan.cells[1])
    return (around, along) if plan.cells[0] >= COARSER_BY * around else None
