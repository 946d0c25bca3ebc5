"""The state of a run when clearances or the unbalance change: displacements and velocities of the rotor and the oil
stay the same.

The oil of a film stays in the new gap: a wider gap has a smaller oil fraction, and from a narrower gap the surplus
leaves through the ends. With another unbalance the accelerations jump, and the films go on as they are.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.film.cells.motion import turned
from frbcli.rotor.linear import unbalance_shares
from frbcli.rotor.loads import SpeedProfile
from frbcli.runs.drive import rotation_of
from frbcli.runs.oil import displacement, grid_angle
from frbcli.runs.start import FIRST_STEP, accelerations, in_turn, settled_forces
from frbcli.scene.machine.system import System
from frbcli.solve.state import ERROR_BEFORE, STEP, STEP_BEFORE, STEP_DONE, TIME, State


def largest_eccentricity(system: System, state: State) -> float:
    """The largest eccentricity of all journals."""
    return float(system.eccentricities(state.q).max())


def with_clearances(before: System, after: System, profile: SpeedProfile, state: State, apart: bool) -> State:
    """The state of the machine `after` from the state of the same machine with the clearances of `before`.

    Journals must lie within their new clearances. apart: rotor and films are solved in turn.
    """
    state = State(*(part.copy() for part in state))
    numbers, rotation = state.numbers, rotation_of(after, profile, state)
    forces = settled_forces(after, rotation[1], state.q, state.v)
    for i in range(len(forces)):
        turn = grid_angle(after, state, i, rotation[2])
        held = after.films.refill(i, before.films, turned(displacement(after, state, i), -turn), state.wet, state.flows)
        if held is not None:
            forces[i] = turned(held, turn)
    turned_by = () if after.rotation is None else (after.rotation,)  # its torques stay
    alpha = state.a[list(turned_by)]
    state.a[:] = accelerations(after, float(numbers[TIME]), rotation, state.q, state.v, forces)
    state.a[list(turned_by)] = alpha
    numbers[STEP] = numbers[STEP_DONE] = FIRST_STEP
    numbers[ERROR_BEFORE] = numbers[STEP_BEFORE] = 0.0
    return in_turn(after, state, rotation[1]) if apart else state


def with_unbalance(before: System, after: System, profile: SpeedProfile, state: State, apart: bool) -> State:
    """The state of the machine `after` from the state of the same machine with the unbalance of `before`; apart: see
    with_clearances."""
    state = State(*(part.copy() for part in state))
    alpha, omega, angle = profile.rotation(float(state.numbers[TIME]))
    along, across = unbalance_shares(alpha, omega, math.sin(angle), math.cos(angle))
    new, old = after.rotor, before.rotor
    forces = along * (new.unbalance_cos - old.unbalance_cos) + across * (new.unbalance_sin - old.unbalance_sin)
    state.a[:] += np.linalg.solve(new.at(omega).mass, forces)
    state.numbers[STEP] = FIRST_STEP
    state.numbers[ERROR_BEFORE] = state.numbers[STEP_BEFORE] = 0.0
    return in_turn(after, state, omega) if apart else state
