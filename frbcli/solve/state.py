"""Data and state of the time loop: all of it arrays, so that the loop is compiled once.

Implicit Runge-Kutta methods of the time loop: one diagonal coefficient, first stage explicit, last stage the result.

Every implicit stage then has the same linear rotor behind it, so that one small inverse serves a whole step.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
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
    loads: Any = ()  # that change with the angle of the rotor or with time, see stage/forces.py
    inputs: Any = ()  # that change with time, see inputs.py
    standing: Any = ()  # (journals, 2) m, where these are in their shells when the rotor has not moved; empty: centred
    cones: Any = ()  # of rings that turn and tilt, see stage/forces.py
    ports: Any = ()  # forces that are not linear, see stage/forces.py
    drive: Any = ()  # of a rotor whose speed is free, see drive.py


class Control(NamedTuple):
    """Limits of the time loop. tolerance: local error of a displacement over the clearance; longest_step in s;
    steps_per_revolution: at least; output_step in s; contact_eccentricity; contact_stiffness in N/m, 0: stop there;
    linearised: a film is solved once in a stage, at its guess, and its force then followed by its derivatives (5.1);
    rough: () or a RoughContact, see stage/forces.py."""

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


Indices = NDArray[np.int64]

NOISE = 0.1  # how much the amplification of errors counts against the reach of an extrapolation


class Tableau(NamedTuple):
    """Coefficients of an s-stage method of an order: stage (s, s), times (s,), defect (s,) = b - b_embedded."""

    stage: Array
    times: Array
    defect: Array
    order: int
    error_order: int
    guess: Indices


@dataclass(frozen=True)
class Method:
    """A method with its source. embedded_order: order of the solution that the error estimate compares with."""

    name: str
    source: str
    embedded_order: int
    tableau: Tableau


def _method(
    name: str, source: str, rows: list[list[float]], embedded: list[float], order: int, embedded_order: int
) -> Method:
    s = len(rows)
    stage = np.zeros((s, s))
    for i, row in enumerate(rows):
        stage[i, : len(row)] = row
    defect = stage[-1] - np.array(embedded)
    times = stage.sum(axis=1)
    tableau = Tableau(stage, times, defect, order, min(order, embedded_order) + 1, _guess_points(times))
    return Method(name, source, embedded_order, tableau)


def _guess_points(times: Array) -> Indices:
    """(s, 3) the points of the parabola that guesses each stage: near to it, and not so near to each other that the
    errors of the stages are blown up. Steps are taken as equal."""
    points = np.concatenate([[-1.0, times[1] - 1.0], times])
    chosen = np.zeros((len(times), 3), dtype=np.int64)
    for s in range(1, len(times)):

        def badness(three: tuple[int, ...], at: float = times[s]) -> float:
            x = points[list(three)]
            weights = [np.prod([(at - b) / (a - b) for b in x if b != a]) for a in x]
            return float(np.abs(np.prod(at - x)) + NOISE * np.sum(np.abs(weights)))

        chosen[s] = min(combinations(range(2 + s), 3), key=badness)
    return chosen


def _trbdf2() -> Method:
    gamma = 1.0 - np.sqrt(0.5)
    w = np.sqrt(2.0) / 4.0
    rows = [[0.0], [gamma, gamma], [w, w, gamma]]
    embedded = [(1.0 - w) / 3.0, (3.0 * w + 1.0) / 3.0, gamma / 3.0]
    return _method("trbdf2", "Bank et al. 1985; Hosea and Shampine 1996", rows, embedded, 2, 3)


def _esdirk3() -> Method:
    gamma = 1767732205903 / 4055673282236
    rows = [
        [0.0],
        [gamma, gamma],
        [2746238789719 / 10658868560708, -640167445237 / 6845629431997, gamma],
        [1471266399579 / 7840856788654, -4482444167858 / 7529755066697, 11266239266428 / 11593286722821, gamma],
    ]
    embedded = [2756255671327 / 12835298489170, -10771552573575 / 22201958757719, 9247589265047 / 10645013368117,
                2193209047091 / 5459859503100]
    return _method("esdirk3", "Kennedy and Carpenter 2003, ARK3(2)4L[2]SA", rows, embedded, 3, 2)


def _esdirk4() -> Method:
    gamma = 0.25
    rows = [
        [0.0],
        [gamma, gamma],
        [8611 / 62500, -1743 / 31250, gamma],
        [5012029 / 34652500, -654441 / 2922500, 174375 / 388108, gamma],
        [15267082809 / 155376265600, -71443401 / 120774400, 730878875 / 902184768, 2285395 / 8070912, gamma],
        [82889 / 524892, 0.0, 15625 / 83664, 69875 / 102672, -2260 / 8211, gamma],
    ]
    embedded = [4586570599 / 29645900160, 0.0, 178811875 / 945068544, 814220225 / 1159782912, -3700637 / 11593932,
                61727 / 225920]
    return _method("esdirk4", "Kennedy and Carpenter 2003, ARK4(3)6L[2]SA", rows, embedded, 4, 3)


METHODS: dict[str, Method] = {method.name: method for method in (_trbdf2(), _esdirk3(), _esdirk4())}
