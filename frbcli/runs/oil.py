"""The oil that has passed through the films of a run, and its balance."""

from __future__ import annotations

import numpy as np

from frbcli.film.cells.balances import INFLOW, OUTFLOW
from frbcli.film.cells.frame import turned
from frbcli.film.cells.motion import Motion
from frbcli.film.published.data import ElementFilm
from frbcli.scene.supply import is_unfed
from frbcli.scene.system import System
from frbcli.solve.element_films import CAME, HELD, LEFT
from frbcli.solve.state import GRID, NOW, OIL, PASSED, State, W


def oil_defect(system: System, state: State, angle: float = 0.0) -> float | None:
    """Oil in the cells that their unknowns do not account for, over what has passed through; the largest of all
    mass-conserving films. angle: of the rotor in rad, with which films with feed holes in the journal turn.

    The oil that a run carries on changes by the flows alone, to round-off; what can be lost is its agreement with the
    pressures and oil fractions. None if none does.
    """
    if isinstance(system.films, ElementFilm):  # what it creates, per what the full film holds if less has passed
        full = system.films.volume * float((system.films.open_area * system.films.height).sum())
        return abs(oil_created(state)) / max(float(state.flows[PASSED, 0, [CAME, LEFT]].max()), full)
    if not system.remembers:
        return None
    worst = 0.0
    for i, film in enumerate(system.volumes):
        if not system.remembering[i]:
            continue
        d = turned(displacement(system, state, i), -grid_angle(system, state, i, angle))
        now = film.content(Motion(d, (0.0, 0.0), 0.0), state.wet[W, i])
        free = ~film.grid.fixed
        passed = max(state.flows[PASSED, i, INFLOW], state.flows[PASSED, i, OUTFLOW])
        area = film.grid.area[free]
        # per turnover of the film's own oil, if less than that has passed so far
        passed = max(float(passed), float((area * now[free]).sum()))
        worst = max(worst, abs(float((area * (now - state.wet[OIL, i])[free]).sum())) / passed)
    return worst


def displacement(system: System, state: State, film: int) -> tuple[float, float]:
    """Of a film's journal, over the clearance."""
    x, y = system.rotor.journals[film] @ state.q / system.clearances[film]
    return float(x), float(y)


def grid_angle(system: System, state: State, film: int, angle: float) -> float:
    """By which a film's grid has turned, rad; angle: of the rotor, rad."""
    return float(system.turning[film, GRID] @ np.concatenate([[angle], state.q[list(system.spins)]]))


def oil_passed(system: System, state: State) -> dict[str, float]:
    """Oil in m^3 that came into all films that keep theirs and that left them so far; empty if there are none."""
    if isinstance(system.films, ElementFilm):
        passed = state.flows[PASSED, 0]
        created = oil_created(state)
        return {"oil_in_m3": float(passed[CAME]), "oil_out_m3": float(passed[LEFT]), "oil_created_m3": created}
    if not system.remembers:
        return {}
    size = [
        keeps * film.section.copies * film.section.radius * film.section.width * film.section.clearance
        for film, keeps in zip(system.volumes, system.remembering, strict=True)
    ]
    came, left = (np.asarray(size) @ state.flows[PASSED, :, flow] for flow in (INFLOW, OUTFLOW))
    return {"oil_in_m3": float(came), "oil_out_m3": float(left)}


def oil_created(state: State) -> float:
    """Oil in m^3 that the published form has created so far: what left more than came in and what the film holds
    more."""
    passed, now = state.flows[PASSED, 0], state.flows[NOW, 0]
    return float(passed[LEFT] - passed[CAME] + now[HELD] - passed[HELD])


def no_oil_comes_in(system: System) -> bool:
    """Whether a mass-conserving film has no pressurised supply, so that its force decays."""
    films = zip(system.volumes, system.remembering, system.laws, strict=True) if system.volumes else ()
    return any(keeps and is_unfed(film.section, law) for film, keeps, law in films)
