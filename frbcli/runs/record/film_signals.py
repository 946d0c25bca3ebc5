"""Film signals that a run records on request (`output.signals`), at the samples of its file.

The force of a film is what the equation of the rotor leaves for it: with the accelerations at the ends of the steps it
is the force of the time loop, whatever the film, and in contact the force of the surfaces is part of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.rectangles.end_flow import EndFlow, end_flows
from frbcli.film.roughness.asperities import rub_along
from frbcli.rotor.body import PLANE
from frbcli.rotor.linear import LinearRotor, unbalance_shares
from frbcli.rotor.loads import loads_at
from frbcli.runs.drive import Rotation, friction_signal
from frbcli.runs.record.film_numbers import FilmNumbers, unchanged
from frbcli.runs.record.header import (
    FLOW,
    FORCE,
    FRICTION,
    POWER,
    SHARE,
    THICKNESS,
    TORQUE,
    signal_names,
    tilt_names,
)
from frbcli.scene.machine.system import System
from frbcli.solve.stage.contact import felt_motion, touches
from frbcli.solve.state import SLIP, SUM, Control
from frbcli.solve.watched import DRAG, FILLED, LEAVES

OF_THE_STEPS = (FORCE, POWER, TORQUE, FLOW, SHARE)  # they ask for what is known at the ends of the steps alone


@dataclass(frozen=True)
class Samples:
    """States of a run at k output times, SI: times (k,); displacements q, velocities v (k, n); rotation of the rotor.

    noted (k, n + NOTES films): see advance_watched of solve/watched.py, without columns if nothing is asked for that
    needs it.
    """

    times: Array
    q: Array
    v: Array
    noted: Array
    rotation: Rotation


def film_signals(
    system: System,
    control: Control,
    samples: Samples,
    kinds: Sequence[str],
    ends: Sequence[EndFlow] = (),
    warm: FilmNumbers | None = None,
) -> dict[str, Array]:
    """The signals (k,) of all films by their names, and the friction torque on a rotor whose speed is free.

    force: on the journal by one bearing, N; film-thickness: the smallest gap, m; torque: of the film on its journal,
    by (4.17), N m; power: what journal and shell put into the film, by turning and by moving, W; oil-flow: that leaves
    the film through its open ends, m^3/s. Between rough surfaces force, torque and power include film and summits;
    asperity-share: of the summits in both forces; contact-power: of their friction, W. ends: the flows of tabulated
    films (Films.end_flows), if these are asked for their oil; warm: what heat has changed.
    """
    signals, films = dict[str, Array](), warm or unchanged(system)
    if samples.noted.shape[1] and (system.rotation is not None or any(kind in OF_THE_STEPS for kind in kinds)):
        forces = film_forces(system.rotor, samples)
        summits = _summits(system, films, samples)
        torques, powers = _torques(system, films, samples, forces - summits[..., :2])
        torques, powers = torques + summits[..., 2], powers + summits[..., 3]
        shares = _shares(forces, summits[..., :2])
        flows = _flows(system, films, samples)
        if ends:
            flows = _flows_of_motions(system, films, control, samples, ends)
        signals |= friction_signal(system, torques)
    for i, name in enumerate(system.names):
        for kind in kinds:
            if kind == FORCE:
                signals |= dict(zip(signal_names(kind, name), forces[:, i].T, strict=True))
            elif kind == THICKNESS:
                signals[signal_names(kind, name)[0]] = _thickness(system, films, control, i, samples.q)
            else:
                known = {POWER: powers, TORQUE: torques, FLOW: flows, SHARE: shares, FRICTION: summits[..., 3]}
                signals[signal_names(kind, name)[0]] = known[kind][:, i]
    return signals


def port_signals(system: System, samples: Samples) -> dict[str, Array]:
    """The signals (k,) of forces that are not linear."""
    by_name: dict[str, Array] = {}
    for port in system.rotor.ports:
        speed = samples.rotation.speeds
        angle = samples.rotation.states[2] if port.law.turns else np.zeros(len(speed))
        signals = port.signals(samples.q, samples.v, speed, angle)
        by_name |= {name: values for name, (_, values) in signals.items()}
    return by_name


def _summits(system: System, films: FilmNumbers, samples: Samples) -> Array:
    """(k, films, 4) of rub_along; 0 between smooth surfaces."""
    summits = np.zeros((len(samples.times), len(system.names), 4))
    if system.asperities is None:
        return summits
    for i in range(len(system.names)):
        clearances, motions = film_motions(system, films, samples, i)
        own = np.zeros((len(motions), 4))
        rub_along(system.asperities, i, clearances, motions, own)
        summits[:, i] = own
    return summits


def film_motions(system: System, films: FilmNumbers, samples: Samples, i: int) -> tuple[Array, Array]:
    """(k,) clearances in m of film i, and (k, 6) the motions of its surfaces: the arguments of `rub` from e_x on."""
    total, slip = (_speeds(system, samples, row)[:, i] for row in (SUM, SLIP))
    selection = system.rotor.journals[i]
    motions = np.column_stack([samples.q @ selection.T, samples.v @ selection.T, slip, 0.5 * (total - slip)])
    return np.ascontiguousarray(np.broadcast_to(films.clearances[:, i], len(motions))), motions


def _shares(forces: Array, summits: Array) -> Array:
    """(k, films) size of the summits' force over the sum of its own and the film's; forces: of both together."""
    own, film = (np.linalg.norm(each, axis=2) for each in (summits, forces - summits))
    return np.asarray(np.divide(own, own + film, out=np.zeros_like(own), where=own > 0.0), dtype=np.float64)


def tilt_signals(system: System, q: Array) -> dict[str, Array]:
    """The signals (k,) of films whose journals tilt, of displacements q (k, n): tilts against the shells in rad, and
    the larger of the eccentricities at both ends."""
    if system.films.coordinates == len(PLANE):
        return {}
    signals, ends = dict[str, Array](), system.eccentricities(q.T)
    for name, journal, at_ends in zip(system.names, system.journals_of(q.T), ends, strict=True):
        signals |= dict(zip(tilt_names(name), (*journal[len(PLANE) :], at_ends), strict=True))
    return signals


def film_forces(rotor: LinearRotor, samples: Samples) -> Array:
    """(k, films, 2) N, on the journal by one bearing: what the equation of the rotor leaves for the films."""
    alpha, omega, angle = samples.rotation.states
    along, across = unbalance_shares(alpha, omega, np.sin(angle), np.cos(angle))
    a = samples.noted[:, : rotor.size]
    left = a @ rotor.mass.T + samples.v @ rotor.damping.T + samples.q @ rotor.stiffness.T - rotor.static_load
    if rotor.over_speed is not None:
        for i, (stiffness, damping, mass) in enumerate(map(rotor.over_speed.at, omega.tolist())):
            left[i] += mass @ a[i] + damping @ samples.v[i] + stiffness @ samples.q[i]
    left = left + omega[:, None] * (samples.v @ rotor.gyroscopic.T)
    if rotor.cones:
        left = left + np.array([rotor.precession(v) @ v for v in samples.v])
    left = left - along[:, None] * rotor.unbalance_cos
    left = left - across[:, None] * rotor.unbalance_sin
    if rotor.loads:
        left = left - loads_at(rotor.loads, rotor.size, np.asarray(samples.times), angle)
    for port in rotor.ports:
        left = left - port.count * port.along(samples.q, samples.v, omega, angle)[0] @ port.place
    rows = rotor.journals.reshape(-1, rotor.size) * np.repeat(rotor.multiplicity, 2)[:, None]
    return np.asarray((left @ np.linalg.pinv(rows)).reshape(len(a), len(rotor.journals), 2), dtype=np.float64)


def _torques(system: System, films: FilmNumbers, samples: Samples, forces: Array) -> tuple[Array, Array]:
    """(k, films) torque on the journals in N m, as in spin_up of solve/ring_spin.py, and power in W."""
    n, count = system.rotor.size, len(system.names)
    total, slip = (_speeds(system, samples, row) for row in (SUM, SLIP))
    drag = samples.noted[:, n + DRAG * count : n + (DRAG + 1) * count]
    place, rate = (np.einsum("fij,kj->kfi", system.rotor.journals, each) for each in (samples.q, samples.v))
    couette = -films.drags * drag * slip
    poiseuille = np.zeros_like(couette)
    if system.torque == "all":
        poiseuille = -0.5 * (place[..., 0] * forces[..., 1] - place[..., 1] * forces[..., 0])
    power = -couette * slip - poiseuille * total - (forces * rate).sum(axis=2)
    return couette + poiseuille, power


def _speeds(system: System, samples: Samples, row: int) -> Array:
    """(k, films) rad/s: SUM or SLIP of the bodies of each film, see RotorData."""
    bodies = np.column_stack([samples.rotation.speeds, samples.v[:, list(system.spins)]])
    return np.asarray(bodies @ system.turning[:, row].T)


def _flows_of_motions(
    system: System, films: FilmNumbers, control: Control, samples: Samples, ends: Sequence[EndFlow]
) -> Array:
    """(k, films) m^3/s of oil that leaves tabulated films: it follows from how their journals move. It is homogeneous
    in their motion and the given pressures, which are divided by the scale."""
    flows = np.empty((len(samples.times), len(ends)))
    total = _speeds(system, samples, SUM)
    for i, end in enumerate(ends):
        clearance, scale = films.clearances[:, i : i + 1], films.scales[:, i : i + 1]
        d, v = (each @ system.rotor.journals[i].T / clearance for each in (samples.q, samples.v))
        for k in _touching(control, d):
            d[k], v[k] = felt_motion(control, d[k], v[k])
        w = v + 0.5 * total[:, i : i + 1] * np.column_stack([d[:, 1], -d[:, 0]])
        motions = np.column_stack([d, scale * w])
        flows[:, i] = clearance[:, 0] / scale[:, 0] * end_flows(end, motions)
    return flows


def _flows(system: System, films: FilmNumbers, samples: Samples) -> Array:
    """(k, films) m^3/s of oil that leaves, as it is noted."""
    n, count = system.rotor.size, len(system.names)
    leaves: Array = samples.noted[:, n + LEAVES * count : n + (LEAVES + 1) * count]
    return np.asarray(leaves * system.films.flow_units(films.clearances), dtype=np.float64)


def fillings(system: System, samples: Samples) -> Array:
    """(k, films) fillings of the openings as they are noted, see feed.py."""
    n, count = system.rotor.size, len(system.names)
    return samples.noted[:, n + FILLED * count : n + (FILLED + 1) * count]


def _thickness(system: System, films: FilmNumbers, control: Control, i: int, q: Array) -> Array:
    """(k,) m: the smallest gap of film i; in contact that which surfaces keep."""
    clearance, least = films.clearances[:, i], np.full(len(q), np.inf)
    stations = slice(i * system.films.stations, (i + 1) * system.films.stations)
    seen = (system.films.seen(each)[stations] for each in (system.rotor.journals, system.films.standing))
    for selection, standing in zip(*seen, strict=True):
        d = (q @ selection.T + standing) / clearance[:, None]
        for sample in _touching(control, d):
            d[sample] = felt_motion(control, d[sample], np.zeros(2))[0]
        least = np.minimum(least, system.films.smallest_gap(i, d))
    return np.asarray(clearance * least)


def _touching(control: Control, d: Array) -> NDArray[np.int64]:
    """The samples at which the film feels less than its displacement d (k, 2) over the clearance."""
    limits = control.contact_eccentricity, control.contact_stiffness
    return np.flatnonzero([touches(float(each), *limits) for each in np.hypot(d[:, 0], d[:, 1])])
