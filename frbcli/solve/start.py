"""What a run starts with: the arrays of its rotor; displacement, velocity and consistent acceleration."""

from __future__ import annotations

import numpy as np

from frbcli.case.schema import Start
from frbcli.film.bearing import evaluate
from frbcli.rotor.excitation import SpeedProfile
from frbcli.scene.system import System
from frbcli.solve.resting import held_rotor, resting_position
from frbcli.solve.state import HISTORY, NUMBERS, STEP, Array, RotorData, State

FIRST_STEP = 1e-7  # s; the error control enlarges it within a few steps


def rotor_data(system: System, profile: SpeedProfile) -> RotorData:
    """The system and its speed as the time loop takes them."""
    rotor = system.rotor
    # Displacements count over the clearance: that of the journal's own film, for other points that of the first.
    observed = np.concatenate([points / system.clearances[0] for _, points in rotor.points])
    return RotorData(
        mass=rotor.mass,
        damping=rotor.damping,
        gyroscopic=rotor.gyroscopic,
        stiffness=rotor.stiffness,
        static_load=rotor.static_load,
        unbalance_cos=rotor.unbalance_cos,
        unbalance_sin=rotor.unbalance_sin,
        journals=rotor.journals,
        multiplicity=rotor.multiplicity,
        clearances=np.array(system.clearances),
        observed=observed,
        has_gyroscopic=bool(np.any(rotor.gyroscopic)),
        profile_times=profile.times,
        profile_speeds=profile.speeds,
        profile_angles=profile.angles,
    )


def first_state(start: Start, system: System, profile: SpeedProfile) -> State:
    """The state at the beginning of a run: at rest, in the centre, held at a displacement, or in the resting position.

    Raises NotConverged if a resting position is asked for and there is none at the first speed.
    """
    rotor = system.rotor
    q = np.zeros(rotor.size)
    if start.displacement is not None:
        held = held_rotor(rotor)
        q = held.shape + held.following @ np.outer(system.clearances, start.displacement).ravel()
    elif start.position == "resting":
        q = resting_position(system, float(profile.speeds[0]))
    return state_at(system, profile, q, np.zeros(rotor.size))


def state_at(system: System, profile: SpeedProfile, q: Array, v: Array) -> State:
    """The state at the start of a profile with displacements q (n,) in m and velocities v (n,) in m/s."""
    a = np.asarray(np.linalg.solve(system.rotor.mass, _forces(system, profile, q, v)), dtype=np.float64)
    numbers = np.zeros(NUMBERS)
    numbers[STEP] = FIRST_STEP
    past = np.zeros((HISTORY, 1 + 2 * len(system.films)))
    past[:, 0] = FIRST_STEP * np.arange(1 - HISTORY, 1)
    past[:, 1:] = (system.rotor.journals @ v).ravel()
    return State(numbers, q.copy(), v.copy(), a, past)


def _forces(system: System, profile: SpeedProfile, q: Array, v: Array) -> Array:
    """(n,) all forces on the rotor with displacements q and velocities v at the start of the profile, at angle zero."""
    rotor, omega = system.rotor, float(profile.speeds[0])
    acceleration = (profile.speeds[1] - omega) / (profile.times[1] - profile.times[0])
    forces = rotor.static_load - rotor.stiffness @ q - (rotor.damping + omega * rotor.gyroscopic) @ v
    forces = forces + acceleration * rotor.unbalance_cos + omega**2 * rotor.unbalance_sin
    for pick, count, film, clearance in zip(
        rotor.journals, rotor.multiplicity, system.films, system.clearances, strict=True
    ):
        forces = forces + count * pick.T @ evaluate(film, clearance, pick @ q, pick @ v, omega).force
    total: Array = forces
    return total
