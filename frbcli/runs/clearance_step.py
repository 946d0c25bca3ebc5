"""The state of a run when clearances change: displacements and velocities of the rotor and the oil stay the same.

The oil of a film stays in the new gap: a wider gap has a smaller oil fraction, and from a narrower gap the surplus
leaves through the ends.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.film.cells.balances import ENDS_NET, OUTFLOW
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.frame import turned
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.rotor.speed_profile import SpeedProfile
from frbcli.runs.cosimulation import in_turn
from frbcli.runs.oil import displacement, grid_angle
from frbcli.runs.start import FIRST_STEP, accelerations, settled_forces
from frbcli.scene.system import System
from frbcli.solve.state import ERROR_BEFORE, OIL, PASSED, STEP, STEP_BEFORE, STEP_DONE, TIME, W_BEFORE, Array, State, W

HALVINGS = 60  # of the interval in which the unknown of a cell with a given oil fraction lies


def largest_eccentricity(system: System, state: State) -> float:
    """Of all journals, over their clearances."""
    return max(math.hypot(*displacement(system, state, i)) for i in range(len(system.names)))


def with_clearances(before: System, after: System, profile: SpeedProfile, state: State, apart: bool) -> State:
    """The state of the machine `after` from that of the same machine with the clearances of `before`.

    Journals must lie within their new clearances. apart: rotor and films are solved in turn.
    """
    state = State(*(part.copy() for part in state))
    numbers, rotation = state.numbers, profile.rotation(float(state.numbers[TIME]))
    forces = settled_forces(after, rotation[1], state.q, state.v)
    for i, remembers in enumerate(after.remembering):
        if remembers:
            turn = grid_angle(after, state, i, rotation[2])
            d = turned(displacement(after, state, i), -turn)
            _refill(before.volumes[i], after.volumes[i], d, state, i)
            film = after.volumes[i]
            forces[i] = turned(force(film, film.mean_pressure(film.cells(state.wet[W, i]))), turn)
    state.a[:] = accelerations(after, rotation, state.q, state.v, forces)
    numbers[STEP] = numbers[STEP_DONE] = FIRST_STEP
    numbers[ERROR_BEFORE] = numbers[STEP_BEFORE] = 0.0
    return in_turn(after, state, rotation[1]) if apart else state


def _refill(old: VolumeFilm, new: VolumeFilm, d: tuple[float, float], state: State, i: int) -> None:
    """Oil, unknowns and flows of film i, all in units of its clearance, in those of the new one. d: over the latter."""
    share, free = old.section.clearance / new.section.clearance, ~new.grid.fixed
    pressure = old.scales.reference * old.section.pressure_scale / (new.scales.reference * new.section.pressure_scale)
    oil, w = share * state.wet[OIL, i], state.wet[W, i]
    full = np.maximum(new.full(), pressure * w)  # cells with enough oil keep their pressure
    gap = new.gap(d, new.grid.centre)[:, None]
    kept = np.where(free, _with_fraction(new, oil / gap, full), w)
    state.wet[W, i] = state.wet[W_BEFORE, i] = kept
    state.wet[OIL, i] = new.content(Motion(d, (0.0, 0.0), 0.0), kept)
    state.flows[:, i] *= share
    spilled = float((new.grid.area * (oil - state.wet[OIL, i]))[free].sum())
    for flow in (OUTFLOW, ENDS_NET):
        state.flows[PASSED, i, flow] += spilled


def _with_fraction(film: VolumeFilm, fraction: Array, full: Array) -> Array:
    """(m, k) unknowns of cells with given oil fractions, at most `full`: they grow with each other."""
    scales = film.scales
    least = -2.0 - (scales.cavitation + scales.ambient) / scales.reference  # neither oil nor pressure
    low, high = np.full_like(full, least), full.copy()
    enough = film.cells(full).fraction <= fraction
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = film.cells(middle).fraction > fraction
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.where(enough, full, 0.5 * (low + high))
