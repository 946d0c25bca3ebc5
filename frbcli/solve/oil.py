"""The oil that has passed through the films of a run, and whether all of it is accounted for."""

from __future__ import annotations

import numpy as np

from frbcli.film.balance import Motion
from frbcli.film.cell_balances import ENDS_NET, INFLOW, OUTFLOW, SUPPLY_NET
from frbcli.film.section_faults import starves
from frbcli.scene.system import System
from frbcli.solve.passengers import OIL, PASSED, W
from frbcli.solve.state import State


def oil_defect(system: System, state: State) -> float | None:
    """Oil in the cells that their unknowns do not account for, over what has passed through; the largest of all films.

    The oil that a run carries on changes by the flows alone, to round-off; what can be lost is its agreement with the
    pressures and oil fractions. None for films that do not keep their oil.
    """
    if not system.remembers:
        return None
    worst = 0.0
    for i, (film, pick) in enumerate(zip(system.volumes, system.rotor.journals, strict=True)):
        d = pick @ state.q / system.clearances[i]
        now = film.content(Motion((float(d[0]), float(d[1])), (0.0, 0.0), 0.0), state.wet[W, i])
        free = ~film.grid.fixed
        passed = max(state.flows[PASSED, i, INFLOW], state.flows[PASSED, i, OUTFLOW])
        area = film.grid.area[free]
        # per turnover of the film's own oil, if less than that has passed so far
        passed = max(float(passed), float((area * now[free]).sum()))
        worst = max(worst, abs(float((area * (now - state.wet[OIL, i])[free]).sum())) / passed)
    return worst


def net_flow(state: State, film: int) -> float:
    """Oil that came in through openings and ends less what left, in units of R b C."""
    return float(state.flows[PASSED, film, SUPPLY_NET] - state.flows[PASSED, film, ENDS_NET])


def oil_passed(system: System, state: State) -> dict[str, float]:
    """Oil in m^3 that came into all films and that left them so far; empty for films that keep none."""
    if not system.remembers:
        return {}
    size = [
        film.section.copies * film.section.radius * film.section.width * film.section.clearance
        for film in system.volumes
    ]
    came, left = (np.asarray(size) @ state.flows[PASSED, :, flow] for flow in (INFLOW, OUTFLOW))
    return {"oil_in_m3": float(came), "oil_out_m3": float(left)}


def no_oil_comes_in(system: System) -> bool:
    """Whether a film that keeps its oil has no inflow, so that what it carries falls to nothing."""
    return system.remembers and any(starves(film.section) for film in system.volumes)
