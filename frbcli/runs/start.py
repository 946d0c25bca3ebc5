"""The start of a run: arrays of the rotor and limits of the time loop; displacement, velocity and consistent
acceleration; and what a co-simulation of rotor and films begins with and costs. The state of a run when clearances or
the unbalance change: displacements and velocities of the rotor and the oil stay the same.

The oil of a film stays in the new gap: a wider gap has a smaller oil fraction, and from a narrower gap the surplus
leaves through the ends. With another unbalance the accelerations jump, and the films go on as they are.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.run import Start
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import NotConverged
from frbcli.film.cells.film import turned
from frbcli.film.roughness.asperities import Asperities
from frbcli.rotor.assembly import PLANE, LinearRotor, held_rotor, unbalance_shares
from frbcli.rotor.loads import SpeedProfile, loads_at, no_part
from frbcli.rotor.port import port_forces
from frbcli.runs.films import displacement, grid_angle
from frbcli.runs.inputs import rotation_of
from frbcli.scene.coupling import coupling_named
from frbcli.scene.course import longest_step, steps_of_a_turn
from frbcli.scene.machine.system import System
from frbcli.scene.planning.film_choice import Plan
from frbcli.solve.cosimulation import CO_NUMBERS, FILMS_REMEMBER, MICRO_REJECTED, MICRO_STEP, MICRO_STEPS
from frbcli.solve.drive import DrivenRotor
from frbcli.solve.films.cells import GLOBAL_FACTOR, LOCAL_FACTOR, NO_FACTOR, SIMPLE_FACTOR
from frbcli.solve.inputs import Inputs
from frbcli.solve.ring_spin import RADIUS, STIFFNESS
from frbcli.solve.stage.forces import RoughContact, make_cones, make_ports, varying_loads
from frbcli.solve.state import (
    ERROR_BEFORE,
    ERROR_SPANS,
    HISTORY,
    NUMBERS,
    RUN_END,
    STEP,
    STEP_BEFORE,
    STEP_DONE,
    STEPS,
    TIME,
    Control,
    RotorData,
    State,
)

FIRST_STEP = 1e-7  # s; the error control enlarges it within a few steps

HELD_BY_SUMMITS = 1e-9  # N/m: films keep a contact gap and a run goes on as with an elastic shell, which pushes nothing


def rotor_data(
    system: System, profile: SpeedProfile, inputs: Inputs | tuple[()] = (), drive: DrivenRotor | tuple[()] = ()
) -> RotorData:
    """The system, its speed or its drive, and its inputs over time as the time loop takes them."""
    rotor = system.rotor
    # Displacements are over a clearance: the journal's own film, for other points the first film.
    table, stations = rotor.over_speed or no_part(rotor.size), system.films.stations
    observed = [points / system.length for _, points in rotor.points]
    if stations > 1:
        observed += _half_tilts(system)
    observed += list(_turns_at_pins(system))
    observed += [port.place / port.law.length for port in rotor.ports]
    if system.rotation is not None:  # an angle of 1 rad counts as a clearance: it turns the force of the unbalance
        observed.append(np.eye(1, rotor.size, system.rotation))
    standing = system.films.seen(system.films.standing)
    return RotorData(
        mass=rotor.mass,
        damping=rotor.damping,
        gyroscopic=rotor.gyroscopic,
        stiffness=rotor.stiffness,
        static_load=rotor.static_load,
        unbalance_cos=rotor.unbalance_cos,
        unbalance_sin=rotor.unbalance_sin,
        journals=system.films.seen(rotor.journals),
        multiplicity=np.concatenate([np.repeat(rotor.multiplicity, stations), [port.count for port in rotor.ports]]),
        clearances=np.repeat(system.clearances, stations),
        observed=np.concatenate(observed),
        has_gyroscopic=bool(np.any(rotor.gyroscopic)),
        profile_times=profile.times,
        profile_speeds=profile.speeds,
        profile_angles=profile.angles,
        turning=np.repeat(system.turning, stations, axis=0),
        spins=np.array(system.spins, dtype=np.int64),
        ring_of=np.repeat(system.bodies, stations, axis=0),
        pins=system.pins,
        drag=np.repeat(system.drags, stations),
        torque_terms=np.array([int(system.torque == "all"), _factor(system)], dtype=np.int64),
        table_speeds=table.speeds,
        table_mass=table.mass,
        table_damping=table.damping,
        table_stiffness=table.stiffness,
        follows_speed=rotor.over_speed is not None or (not system.names and bool(np.any(rotor.gyroscopic))),
        loads=varying_loads(rotor.loads),
        inputs=inputs,
        standing=standing if stations > 1 else (),
        cones=make_cones(rotor.cones, rotor.size - system.ring_count),
        ports=make_ports(rotor.ports),
        drive=drive,
    )


def _half_tilts(system: System) -> list[Array]:
    """(2, n) of each film: by how much its ends move against each other, over twice the clearance."""
    ends = system.films.seen(system.rotor.journals).reshape(len(system.names), -1, len(PLANE), system.rotor.size)
    return [0.5 * (far - near) / c for (near, far), c in zip(ends, system.clearances, strict=True)]


def _turns_at_pins(system: System) -> Iterator[Array]:
    """(1, n) of each ring with a pin: how far it turns at the radius of the pin."""
    for spin, pin in zip(system.spins, system.pins, strict=False):
        if pin[STIFFNESS] > 0.0:
            yield pin[RADIUS] / system.length * np.eye(1, system.rotor.size, spin)


def _factor(system: System) -> int:
    """Reduction of the torque by missing oil."""
    if system.torque == "simple":
        return SIMPLE_FACTOR
    return {"none": NO_FACTOR, "global": GLOBAL_FACTOR, "local": LOCAL_FACTOR}[system.films.cavitation_factor]


def first_state(start: Start, system: System, profile: SpeedProfile) -> State:
    """The state at the beginning of a run: at rest, in the centre, held at a displacement, or in static equilibrium,
    where rings turn already. A shaft with a bow is bent, and turns so.

    Raises NotConverged if static equilibrium is asked for and there is none at the first speed.
    """
    rotor = system.rotor
    q, v = np.zeros(rotor.size), np.zeros(rotor.size)
    if start.displacement is not None:
        in_plane = replace(rotor, journals=rotor.journals[:, : len(PLANE)])
        held = held_rotor(in_plane, float(profile.speeds[0]))
        q = held.shape + held.following @ np.outer(system.clearances, start.displacement).ravel()
    elif start.position == "resting":
        resting = resting_position(system, float(profile.speeds[0]))
        q, v = resting.displacements, resting.velocities(system)
    bent, turning = _bent(rotor, float(profile.speeds[0]))
    return state_at(system, profile, q + bent, v + turning)


def _bent(rotor: LinearRotor, omega: float) -> tuple[Array, Array]:
    """(n,) m and m/s: the shape by the bow of a rotor at angle 0 with its journals held, and its rate at omega rad/s,
    at which the damping that turns with the shaft pulls at it as little as at rest. Raises NotConverged as
    held_rotor."""
    if not rotor.bent.any():
        return np.zeros(rotor.size), np.zeros(rotor.size)
    in_plane = replace(rotor, journals=rotor.journals[:, : len(PLANE)])
    now, rate = (held_rotor(replace(in_plane, static_load=load)) for load in (rotor.bent.real, -rotor.bent.imag))
    return now.shape, omega * rate.shape


def state_at(system: System, profile: SpeedProfile, q: Array, v: Array) -> State:
    """The state at the start of a profile with displacements q (n,) in m and velocities v (n,) in m/s."""
    omegas = system.omegas(float(profile.speeds[0]), v[list(system.spins)])
    wet, flows = system.films.first_state(system.rotor.journals @ q + system.films.standing, omegas)
    start = float(profile.times[0])
    rotation = profile.rotation(start)
    a = accelerations(system, start, rotation, q, v, settled_forces(system, rotation[1], q, v))
    numbers = np.zeros(NUMBERS)
    numbers[STEP] = numbers[STEP_DONE] = FIRST_STEP
    numbers[RUN_END] = profile.end
    rotor = system.rotor
    places = [system.films.seen(rotor.journals).reshape(-1, rotor.size), *(port.place for port in rotor.ports)]
    velocities = np.concatenate(places) @ v
    past = np.zeros((HISTORY, 1 + len(velocities)))
    past[:, 0] = FIRST_STEP * np.arange(1 - HISTORY, 1)
    past[:, 1:] = velocities
    return State(numbers, q.copy(), v.copy(), a, past, wet, flows, np.zeros((2, ERROR_SPANS)))


def settled_forces(system: System, omega: float, q: Array, v: Array) -> Array:
    """(films, coordinates) forces, and moments, of the films that have settled where the rotor is, none of those that
    starve."""
    films, spins = system.films, v[list(system.spins)]
    forces = np.zeros((len(system.names), films.coordinates))
    omegas, slips = system.omegas(omega, spins).tolist(), system.slips(omega, spins).tolist()
    for i, (selection, standing) in enumerate(zip(system.rotor.journals, films.standing, strict=True)):
        with contextlib.suppress(NotConverged):
            forces[i] = system.force(i, selection @ q + standing, selection @ v, omegas[i], None, slips[i]).force
    return forces


def accelerations(
    system: System, t: float, rotation: tuple[float, float, float], q: Array, v: Array, film_forces: Array
) -> Array:
    """(n,) m/s^2 of a rotor with displacements q, velocities v and forces (films, coordinates) of its films, at t in s.

    rotation: angular acceleration, speed and angle of the rotor, see SpeedProfile.
    """
    alpha, omega, angle = rotation
    rotor, (along, across) = system.rotor.at(omega), unbalance_shares(alpha, omega, math.sin(angle), math.cos(angle))
    forces = rotor.static_load - rotor.stiffness @ q - (rotor.damping + omega * rotor.gyroscopic) @ v
    if rotor.cones:
        forces = forces - rotor.precession(v) @ v
    forces = forces + along * rotor.unbalance_cos
    forces = forces + across * rotor.unbalance_sin
    if rotor.loads:
        forces = forces + loads_at(rotor.loads, rotor.size, np.array([t]), np.array([angle]))[0]
    for selection, count, force in zip(rotor.journals, rotor.multiplicity, film_forces, strict=True):
        forces = forces + count * selection.T @ force
    forces = forces + port_forces(rotor, q, v, omega, angle)
    return np.asarray(np.linalg.solve(rotor.mass, forces), dtype=np.float64)


def control_of(case: Case, plan: Plan, asperities: Asperities | None = None) -> Control:
    """The limits of the time loop, from the case and its plan. asperities: of its machine, see System."""
    contact = case.contact
    stiffness = contact.stiffness if contact.policy == "elastic" and contact.stiffness is not None else 0.0
    rough: RoughContact | tuple[()] = ()
    if asperities is not None:
        stiffness, rough = HELD_BY_SUMMITS, RoughContact(asperities, np.zeros((len(asperities.radii), 2)))
    return Control(
        tolerance=plan.tolerance,
        steps_per_revolution=steps_of_a_turn(case, plan),
        longest_step=longest_step(case, plan),
        output_step=case.output.step,
        contact_eccentricity=contact.eccentricity,
        contact_stiffness=stiffness,
        linearised=coupling_named(plan.coupling).once,
        rough=rough,
    )


def in_turn(system: System, state: State, omega: float) -> State:
    """The state of advance_in_turn from the state of advance, at the beginning or after a clearance has changed.

    omega: speed of the rotor in rad/s.

    The coupling variables (section 5.2.1) are constant before the start, except for the journals, which move with their
    initial velocity.
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
