"""The oil that has passed through the films of a run, and its balance."""

from __future__ import annotations

import numpy as np

from frbcli.film.cells.motion import turned
from frbcli.scene.machine.system import System
from frbcli.solve.state import GRID, State


def oil_defect(system: System, state: State, angle: float = 0.0) -> float | None:
    """Oil that is not accounted for over what has passed through, see Films.oil_defect; None for films that keep none.
    angle: of the rotor in rad, with which films with feed holes in the journal turn."""
    stations = system.films.stations
    seen = system.films.seen(system.journals_of(state.q)) / np.repeat(system.clearances, stations)[:, None]
    places = [
        turned((float(x), float(y)), -grid_angle(system, state, i // stations, angle)) for i, (x, y) in enumerate(seen)
    ]
    return system.films.oil_defect(places, state.wet, state.flows)


def displacement(system: System, state: State, film: int) -> tuple[float, float]:
    """The displacement of a film's journal in its middle, over the clearance."""
    x, y = (system.rotor.journals[film] @ state.q)[:2] / system.clearances[film]
    return float(x), float(y)


def grid_angle(system: System, state: State, film: int, angle: float) -> float:
    """Angle in rad by which a film's grid has turned; angle: of the rotor, rad."""
    return float(system.turning[film, GRID] @ np.concatenate([[angle], state.q[list(system.spins)]]))
