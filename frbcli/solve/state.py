"""Data and state of the time loop: all of it arrays, so that the loop is compiled once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

RUNNING, FINISHED, CONTACT, STUCK, OVERHEATED, STANDSTILL = range(6)  # what advance returns
# omega_J + omega_S, omega_J - omega_S, and speed of the grid of a film by the speeds of rotor and rings.
SUM, SLIP, GRID, TURNING = range(4)


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
    turning: Array  # (films, 3, 1 + rings) shares of the speeds of rotor and rings, see TURNING
    spins: NDArray[np.int64]  # (rings,) degrees of freedom that the rings turn in
    ring_of: NDArray[np.int64]  # (films, 2) ring inside and outside of each film, -1: the rotor or the housing
    pins: Array  # (rings or 0, PIN) of the rings, see pin.py
    drag: Array  # (films,) N m s: eta R^3 B / C of the whole bearing, see drag_integral
    torque_terms: NDArray[np.int64]  # (2,) whether Poiseuille's term counts; cavitation factor of Couette's
    table_speeds: Array  # (s,) rad/s of what joins the next three, see LinearPart; none without
    table_mass: Array  # (s, n, n), as the next two
    table_damping: Array
    table_stiffness: Array
    follows_speed: bool  # whether the inverse is renewed at every change of the speed
    loads: Any = ()  # that change with the angle of the rotor or with time, see stage/loads.py
    inputs: Any = ()  # that change with time, see inputs.py
    standing: Any = ()  # (journals, 2) m, where these are in their shells when the rotor has not moved; empty: centred
    cones: Any = ()  # of rings that turn and tilt, see stage/contact.py
    ports: Any = ()  # forces that are not linear, see stage/ports.py
    drive: Any = ()  # of a rotor whose speed is free, see drive.py


class Control(NamedTuple):
    """Limits of the time loop. tolerance: local error of a displacement over the clearance; longest_step in s;
    steps_per_revolution: at least; output_step in s; contact_eccentricity; contact_stiffness in N/m, 0: stop there;
    linearised: a film is solved once in a stage, at its guess, and its force then followed by its derivatives (5.1);
    rough: () or a RoughContact, see stage/rough_contact.py."""

    tolerance: float
    steps_per_revolution: float
    longest_step: float
    output_step: float
    contact_eccentricity: float
    contact_stiffness: float
    linearised: bool = False
    rough: Any = ()


# Positions in the state's array of numbers; what a run must keep to go on as if it had not stopped.
(TIME, STEP, ERROR_BEFORE, PIECE, OUTPUTS, STEPS, REJECTED, SOLVES, TURNS, ERROR_NOW, ERROR_LARGEST, LARGEST_EPS,
 INVERSE_G, INVERSE_SPEED, STEP_BEFORE, STEP_DONE, RUN_END, NUMBERS) = range(18)
ERRORS_LARGEST, ERRORS_SUM = range(2)
ERROR_SPANS = 256  # equal ones of the time of a run
HISTORY = 3  # points of the step before that help to predict the stages of the next


class State(NamedTuple):
    """Everything that changes. numbers: (NUMBERS,); q, v, a: (n,) displacement, velocity, acceleration;
    past: (HISTORY, 1 + m) time and velocities of journals and ports at the start, the first stage and the end of the
    last step; wet: (WET, films, m, k) of films with cells, flows: (2, films, FLOWS) of their oil, see films/; errors:
    (2, ERROR_SPANS) largest fading sum and plain sum of the local errors of the steps that end in each span."""

    numbers: Array
    q: Array
    v: Array
    a: Array
    past: Array
    wet: Array
    flows: Array
    errors: Array


class LoopOutput(NamedTuple):
    """Output of the time loop, one row for each output time: displacements q and velocities v (rows, n), the mean oil
    fraction (4.46) of mass-conserving films (rows, films), and of a machine with heat the columns of heat.py."""

    q: Array
    v: Array
    oil: Array
    heat: Array

    def after(self, row: int) -> LoopOutput:
        """The rows from `row` on."""
        return LoopOutput(self.q[row:], self.v[row:], self.oil[row:], self.heat[row:])


def make_output(rows: int, n: int, films: int = 0) -> LoopOutput:
    """Output of a rotor with n degrees of freedom and of mass-conserving films, without heat."""
    return LoopOutput(np.zeros((rows, n)), np.zeros((rows, n)), np.zeros((rows, films)), np.zeros((rows, 0)))
