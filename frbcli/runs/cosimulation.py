"""The initial state of a co-simulation of rotor and films, and its cost."""

from __future__ import annotations

import numpy as np

from frbcli.runs.start import FIRST_STEP, settled_forces
from frbcli.scene.machine.system import System
from frbcli.solve.cosimulation.micro_step import CO_NUMBERS, FILMS_REMEMBER, MICRO_REJECTED, MICRO_STEP, MICRO_STEPS
from frbcli.solve.state import HISTORY, STEPS, TIME, State


def in_turn(system: System, state: State, omega: float) -> State:
    """The state of advance_in_turn from that of advance, at the beginning or after a clearance has changed.

    omega: speed of the rotor in rad/s.

    The coupling variables (section 5.2.1) are constant before the start, except those of the journals, which
    move with their initial velocity.
    """
    rotor, rings = system.rotor, list(system.spins)
    numbers = np.zeros(CO_NUMBERS)
    numbers[: len(state.numbers)] = state.numbers
    numbers[MICRO_STEP] = FIRST_STEP
    numbers[FILMS_REMEMBER] = float(system.remembers)
    place, rate = rotor.journals @ state.q, rotor.journals @ state.v
    times = FIRST_STEP * np.arange(1 - HISTORY, 1)
    exchanged = [settled_forces(system, omega, state.q, state.v).ravel(), np.zeros(len(rings))]
    past = np.array([
        np.concatenate([
            [numbers[TIME] + t], (place + t * rate).ravel(), rate.ravel(), state.q[rings], state.v[rings], *exchanged
        ])
        for t in times
    ])  # fmt: skip
    return state._replace(numbers=numbers, past=past)


def micro_cost(state: State, cpu_s: float) -> dict[str, float]:
    """Cost of the films' own steps; cpu_s: of the whole run."""
    numbers = state.numbers
    micro, macro = max(float(numbers[MICRO_STEPS]), 1.0), max(float(numbers[STEPS]), 1.0)
    return {
        "micro_steps": int(numbers[MICRO_STEPS]),
        "rejected_micro_steps": int(numbers[MICRO_REJECTED]),
        "micro_steps_per_macro_step": micro / macro,
        "ms_per_micro_step": 1e3 * cpu_s / micro,
    }
