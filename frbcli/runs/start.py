"""The initial state of a run: arrays of the rotor; displacement, velocity and consistent acceleration."""

from __future__ import annotations

import contextlib
import math

import numpy as np

from frbcli.case.schema import Start
from frbcli.errors import NotConverged
from frbcli.film.cells.balances import FLOWS
from frbcli.film.cells.data import VolumeFilms
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.steady_force import steady_solution
from frbcli.film.published.data import ElementFilm
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.moving import oil_held
from frbcli.film.published.unknown import unknowns_of
from frbcli.linear.resting import resting_position, ring_speeds
from frbcli.rotor.held import held_rotor
from frbcli.rotor.linear import unbalance_shares
from frbcli.rotor.over_speed import no_part
from frbcli.rotor.speed_profile import SpeedProfile
from frbcli.scene.system import System
from frbcli.solve.cell_films import GLOBAL_FACTOR, LOCAL_FACTOR, NO_FACTOR, SIMPLE_FACTOR
from frbcli.solve.element_films import BOOKS, HELD
from frbcli.solve.state import (
    ERROR_SPANS,
    HISTORY,
    NOW,
    NUMBERS,
    OIL,
    PASSED,
    RUN_END,
    STEP,
    STEP_DONE,
    W_BEFORE,
    WET,
    Array,
    RotorData,
    State,
    W,
)

FIRST_STEP = 1e-7  # s; the error control enlarges it within a few steps


def rotor_data(system: System, profile: SpeedProfile) -> RotorData:
    """The system and its speed as the time loop takes them."""
    rotor = system.rotor
    # Displacements count over the clearance: that of the journal's own film, for other points that of the first.
    observed = np.concatenate([points / system.length for _, points in rotor.points])
    table = rotor.over_speed or no_part(rotor.size)
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
        turning=system.turning,
        spins=np.array(system.spins, dtype=np.int64),
        ring_of=system.bodies,
        drag=np.array(system.drags),
        torque_terms=np.array([int(system.torque == "all"), _factor(system)], dtype=np.int64),
        table_speeds=table.speeds,
        table_mass=table.mass,
        table_damping=table.damping,
        table_stiffness=table.stiffness,
        follows_speed=rotor.over_speed is not None or (not system.names and bool(np.any(rotor.gyroscopic))),
    )


def _factor(system: System) -> int:
    """Reduction of the torque by missing oil."""
    if system.torque == "simple":
        return SIMPLE_FACTOR
    return {"none": NO_FACTOR, "global": GLOBAL_FACTOR, "local": LOCAL_FACTOR}[system.cavitation_factor]


def first_state(start: Start, system: System, profile: SpeedProfile) -> State:
    """The state at the beginning of a run: at rest, in the centre, held at a displacement, or in the resting position,
    where rings turn already.

    Raises NotConverged if a resting position is asked for and there is none at the first speed.
    """
    rotor = system.rotor
    q, v = np.zeros(rotor.size), np.zeros(rotor.size)
    if start.displacement is not None:
        held = held_rotor(rotor, float(profile.speeds[0]))
        q = held.shape + held.following @ np.outer(system.clearances, start.displacement).ravel()
    elif start.position == "resting":
        omega = float(profile.speeds[0])
        q = resting_position(system, omega)
        v[list(system.spins)] = ring_speeds(system, held_rotor(rotor, omega), omega, rotor.journals @ q)
    return state_at(system, profile, q, v)


def state_at(system: System, profile: SpeedProfile, q: Array, v: Array) -> State:
    """The state at the start of a profile with displacements q (n,) in m and velocities v (n,) in m/s."""
    wet, flows = _films_at(system, profile, q, v)
    rotation = profile.rotation(float(profile.times[0]))
    a = accelerations(system, rotation, q, v, settled_forces(system, rotation[1], q, v))
    numbers = np.zeros(NUMBERS)
    numbers[STEP] = numbers[STEP_DONE] = FIRST_STEP
    numbers[RUN_END] = profile.end
    count = len(system.clearances)
    past = np.zeros((HISTORY, 1 + 2 * count))
    past[:, 0] = FIRST_STEP * np.arange(1 - HISTORY, 1)
    past[:, 1:] = (system.rotor.journals @ v).ravel()
    return State(numbers, q.copy(), v.copy(), a, past, wet, flows, np.zeros((2, ERROR_SPANS)))


def _films_at(system: System, profile: SpeedProfile, q: Array, v: Array) -> tuple[Array, Array]:
    """The films' own state: settled where that is possible, else full at the ambient pressure. Its oil does not change
    at first: the journals stand still."""
    if isinstance(system.films, ElementFilm):
        assert system.published is not None
        omega = system.omegas(float(profile.speeds[0]), v[list(system.spins)])
        return _elements_at(system.published, system.films, system.rotor.journals[0] @ q, float(omega[0]))
    if not isinstance(system.films, VolumeFilms):
        return np.zeros((WET, 0, 0, 0)), np.zeros((2, 0, FLOWS))
    m, k = system.volumes[0].grid.shape
    wet = np.zeros((WET, len(system.volumes), m, k))
    omegas = system.omegas(float(profile.speeds[0]), v[list(system.spins)])
    for i, (film, selection) in enumerate(zip(system.volumes, system.rotor.journals, strict=True)):
        at = selection @ q / system.clearances[i]
        motion = Motion((float(at[0]), float(at[1])), (0.0, 0.0), float(omegas[i]))
        w = film.full()
        if np.any(at != 0.0) and omegas[i] != 0.0:
            with contextlib.suppress(NotConverged):
                w = steady_solution(film, motion).w
        wet[W, i] = wet[W_BEFORE, i] = w
        wet[OIL, i] = film.content(motion, w)
    return wet, np.zeros((2, len(system.volumes), FLOWS))


def _elements_at(film: PublishedFilm, data: ElementFilm, displacement: Array, omega: float) -> tuple[Array, Array]:
    """The same of a film in the published form, its journal at rest at a displacement (2,) in m."""
    d, state = displacement / film.section.clearance, film.full()
    moves = bool(np.any(d != 0.0)) and omega != 0.0
    # Next to an opening of higher pressure a full film at the ambient one is none: its elements would dip below p_cav.
    fixed = film.elements.fixed.reshape(film.mesh.phi.shape)
    fed = bool(np.any(film.mesh.fixed_pressure[fixed] > state.pressure.min()))
    if moves or fed:
        with contextlib.suppress(NotConverged):
            motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega if moves else 0.0)
            state = film.steady(motion).state
    wet, flows = np.zeros((WET, 1, *film.mesh.nodes.shape)), np.zeros((2, 1, BOOKS))
    wet[W, 0] = wet[W_BEFORE, 0] = unknowns_of(data.unknowns, data.step, state.pressure.ravel())[film.mesh.nodes]
    wet[OIL, 0] = state.fraction
    flows[[PASSED, NOW], 0, HELD] = oil_held(data, float(d[0]), float(d[1]), state.fraction)
    return wet, flows


def settled_forces(system: System, omega: float, q: Array, v: Array) -> Array:
    """(films, 2) N: forces of the films that have settled where the rotor is, none of those that starve."""
    forces, omegas = np.zeros((len(system.names), 2)), system.omegas(omega, v[list(system.spins)])
    for i, selection in enumerate(system.rotor.journals):
        with contextlib.suppress(NotConverged):
            forces[i] = system.film_force(i, selection @ q, selection @ v, float(omegas[i])).force
    return forces


def accelerations(
    system: System, rotation: tuple[float, float, float], q: Array, v: Array, film_forces: Array
) -> Array:
    """(n,) m/s^2 of a rotor with displacements q, velocities v and forces (films, 2) of its films in N.

    rotation: angular acceleration, speed and angle of the rotor, see SpeedProfile.
    """
    alpha, omega, angle = rotation
    rotor, (along, across) = system.rotor.at(omega), unbalance_shares(alpha, omega, math.sin(angle), math.cos(angle))
    forces = rotor.static_load - rotor.stiffness @ q - (rotor.damping + omega * rotor.gyroscopic) @ v
    forces = forces + along * rotor.unbalance_cos
    forces = forces + across * rotor.unbalance_sin
    for selection, count, force in zip(rotor.journals, rotor.multiplicity, film_forces, strict=True):
        forces = forces + count * selection.T @ force
    return np.asarray(np.linalg.solve(rotor.mass, forces), dtype=np.float64)
