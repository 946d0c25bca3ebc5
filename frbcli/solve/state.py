"""What the time loop is given and what it carries along: all of it arrays, so that the loop is compiled once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RUNNING, FINISHED, CONTACT, STUCK = range(4)  # what advance returns


class RotorData(NamedTuple):
    """The arrays of a LinearRotor, its speed profile and clearances; see LinearRotor for shapes and units."""

    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    static_load: Array
    unbalance_cos: Array
    unbalance_sin: Array
    journals: Array
    multiplicity: Array
    clearances: Array
    observed: Array  # (p, n) displacements under error control, over their clearance
    has_gyroscopic: bool
    profile_times: Array
    profile_speeds: Array
    profile_angles: Array


class Control(NamedTuple):
    """What the time loop may do. tolerance: local error of a displacement over the clearance; longest_step in s;
    steps_per_revolution: at least; output_step in s; contact_eccentricity; contact_stiffness in N/m, 0: stop there."""

    tolerance: float
    steps_per_revolution: float
    longest_step: float
    output_step: float
    contact_eccentricity: float
    contact_stiffness: float


# Positions in the state's array of numbers; what a run must keep to go on as if it had not stopped.
(TIME, STEP, ERROR_BEFORE, PIECE, OUTPUTS, STEPS, REJECTED, SOLVES, TURNS, ERROR_NOW, ERROR_LARGEST, LARGEST_EPS,
 INVERSE_G, INVERSE_SPEED, STEP_BEFORE, NUMBERS) = range(16)
HISTORY = 3  # points of the step before that help to predict the stages of the next


class State(NamedTuple):
    """Everything that changes. numbers: (NUMBERS,); q, v, a: (n,) displacement, velocity, acceleration;
    past: (HISTORY, 1 + 2 films) time and journals' velocities at the start, the first stage and the end of the last
    step."""

    numbers: Array
    q: Array
    v: Array
    a: Array
    past: Array
