"""What a run records of its films at the samples of its file: their signals on request (`output.signals`), the films
that it keeps on its way (`output.films`: oil fractions and free gas of their cells at some moments), the balance of the
oil that has passed through them, and the wear of rough surfaces.

The force of a film is what the equation of the rotor leaves for it: with the accelerations at the ends of the steps it
is the force of the time loop, whatever the film, and in contact the force of the surfaces is part of it.

Wear is an estimate by Archard; the gap of the run does not follow it. A place of the shell loses the depth k p |u| dt,
with the pressure p of the summits, their sliding speed u and the specific wear rate k, volume over force and path. A
shell that turns, a ring, and every journal lose it all around.

Source: Archard: Contact and rubbing of flat surfaces. J. Appl. Phys. 24 (1953), 981-988.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.run import FilmFrames
from frbcli.compiled import Indices
from frbcli.film.cells.data import GAS, OIL
from frbcli.film.cells.film import Motion, turned
from frbcli.film.rectangles.end_flow import EndFlow, end_flows
from frbcli.film.roughness.asperities import rub_along, wear_along
from frbcli.results import store
from frbcli.results.columns import FRICTION_SIGNAL
from frbcli.rotor.assembly import PLANE, LinearRotor, unbalance_shares
from frbcli.rotor.loads import loads_at
from frbcli.runs.header import FLOW, FORCE, FRICTION, POWER, SHARE, THICKNESS, TORQUE, signal_names, tilt_names
from frbcli.runs.inputs import FilmNumbers, Rotation, brakes, friction_of_films, unchanged
from frbcli.runs.interruption import WrongCheckpoint, array
from frbcli.scene.machine.system import System
from frbcli.solve.stage.forces import felt_motion, touches
from frbcli.solve.state import GRID, SLIP, SUM, TIME, Control, State
from frbcli.solve.time_loop import DRAG, FILLED, LEAVES

OF_THE_STEPS = (FORCE, POWER, TORQUE, FLOW, SHARE)  # they ask for what is known at the ends of the steps alone
ANGLES = 72  # places around a shell, evenly from the top on, counter-clockwise
WEAR, DEEPEST = "wear", 1.0  # in a checkpoint; m, deeper than any shell


def oil_defect(system: System, state: State, angle: float = 0.0) -> float | None:
    """Oil that is not accounted for over what has passed through, see Films.oil_defect; None for films that keep none.
    angle: of the rotor in rad, with which films with feed holes in the journal turn."""
    stations = system.films.stations
    seen = system.films.seen(system.journals_of(state.q)) / np.repeat(system.clearances, stations)[:, None]
    places = [
        turned((float(x), float(y)), -grid_angle(system, state, i // stations, angle)) for i, (x, y) in enumerate(seen)
    ]
    return system.films.oil_defect(places, state.wet, state.flows)


def displacement(system: System, state: State, film: int) -> tuple[float, float]:
    """The displacement of a film's journal in its middle, over the clearance."""
    x, y = (system.rotor.journals[film] @ state.q)[:2] / system.clearances[film]
    return float(x), float(y)


def grid_angle(system: System, state: State, film: int, angle: float) -> float:
    """Angle in rad by which a film's grid has turned; angle: of the rotor, rad."""
    return float(system.turning[film, GRID] @ np.concatenate([[angle], state.q[list(system.spins)]]))


@dataclass(frozen=True)
class Samples:
    """States of a run at k output times, SI: times (k,); displacements q, velocities v (k, n); rotation of the rotor.

    noted (k, n + NOTES films): see advance_watched of solve/time_loop.py, without columns if nothing is asked for that
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
    if brakes(system):
        of_films = friction_of_films(system, torques) if system.names else 0.0
        signals[FRICTION_SIGNAL.name] = of_films + _friction_at_ports(system, samples)
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


def _friction_at_ports(system: System, samples: Samples) -> Array:
    """(k,) the torque with which forces that are not linear brake the rotor."""
    torque, angle = np.zeros(len(samples.times)), samples.rotation.states[2]
    for port in system.rotor.ports:
        if port.law.brakes:
            torque -= port.count * port.along(samples.q, samples.v, samples.rotation.speeds, angle)[0][:, len(PLANE)]
    return torque


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
        left = left - port.count * port.along(samples.q, samples.v, omega, angle)[0][:, : len(PLANE)] @ port.place
    rows = rotor.journals.reshape(-1, rotor.size) * np.repeat(rotor.multiplicity, 2)[:, None]
    return np.asarray((left @ np.linalg.pinv(rows)).reshape(len(a), len(rotor.journals), 2), dtype=np.float64)


def _torques(system: System, films: FilmNumbers, samples: Samples, forces: Array) -> tuple[Array, Array]:
    """(k, films) torque on the journals in N m, as in spin_up of solve/inputs.py, and power in W."""
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
        flows[:, i] = clearance[:, 0] / scale[:, 0] * end_flows(end, motions, 1.0)
    return flows


def _flows(system: System, films: FilmNumbers, samples: Samples) -> Array:
    """(k, films) m^3/s of oil that leaves, as it is noted."""
    n, count = system.rotor.size, len(system.names)
    leaves: Array = samples.noted[:, n + LEAVES * count : n + (LEAVES + 1) * count]
    return np.asarray(leaves * system.films.flow_units(films.clearances), dtype=np.float64)


def fillings(system: System, samples: Samples) -> Array:
    """(k, films) fillings of the openings as they are noted, see boundaries.py."""
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


class KeptFilms:
    """The films kept so far: each at the end of the first step that reaches a moment. Without any asked for, empty."""

    def __init__(self, wanted: FilmFrames | None, system: System) -> None:
        self._times = np.zeros(0) if wanted is None else np.linspace(wanted.begin, wanted.end, wanted.frames)
        films = system.films.with_fields if wanted is not None else ()
        self._gassy = len(films) if any(film.law.carries_gas for film in films) else 0
        shape = films[0].grid.shape if films else (0, 0)
        self._moments = np.empty((0, 1 + store.OF_A_FILM * len(films)))
        self._oil, self._gas = np.empty((0, len(films), *shape)), np.empty((0, self._gassy, *shape))
        self._edges = np.array([film.grid.phi for film in films])

    def steps(self, t: float, longest: float, budget: int) -> int:
        """At most `budget` steps from a time t in s on, each at most `longest` s, that end before the next moment; one
        where that is near."""
        if len(self._moments) == len(self._times):
            return budget
        return max(1, min(budget, int((self._times[len(self._moments)] - t) / longest)))

    def take(self, system: System, state: State, angle: float) -> None:
        """Keep the films of a state if a moment has come; angle: of the rotor in rad."""
        t, kept = float(state.numbers[TIME]), len(self._moments)
        due = int(np.searchsorted(self._times, t, side="right")) - kept
        if due <= 0:
            return
        moment, oils, gases = [t], [], []
        for i, film in enumerate(system.films.with_fields):
            place, turn = displacement(system, state, i), grid_angle(system, state, i, angle)
            oil, fixed = state.wet[OIL, i], film.grid.fixed
            gaps = film.gaps(Motion(turned(place, -turn), (0.0, 0.0), 0.0))
            oils.append(np.where(fixed, 1.0, oil / gaps))
            if self._gassy:
                carried = state.wet[GAS, i] / np.where(fixed, 1.0, oil)
                gases.append(np.where(fixed, film.law.supplied_gas, carried))
            moment += [turn, *place]
        # Several moments in one step have the same films.
        self._moments = np.concatenate([self._moments, np.tile(moment, (due, 1))])
        self._oil = np.concatenate([self._oil, np.repeat(np.array(oils)[None], due, axis=0)])
        if self._gassy:
            self._gas = np.concatenate([self._gas, np.repeat(np.array(gases)[None], due, axis=0)])
        else:
            self._gas = np.empty((len(self._moments), *self._gas.shape[1:]))

    def snapshot(self) -> dict[str, Array]:
        """The arrays of a checkpoint."""
        if not len(self._times):
            return {}
        parts = (self._moments, self._oil, self._gas, self._edges)
        return dict(zip((store.MOMENTS, store.OIL, store.GAS, store.EDGES), parts, strict=True))

    def restore(self, checkpoint: Mapping[str, Array], t: float) -> None:
        """Take up what a checkpoint at the time t in s holds. Raises WrongCheckpoint if it is not one of this run."""
        if not len(self._times):
            return
        n = int(np.searchsorted(self._times, t, side="right"))
        self._moments = array(checkpoint, store.MOMENTS, (n, *self._moments.shape[1:]))
        self._oil = array(checkpoint, store.OIL, (n, *self._oil.shape[1:]))
        self._gas = array(checkpoint, store.GAS, (n, *self._gas.shape[1:]))


class RunWear:
    """Depths that the shells of a run have lost so far, as if none of them turned. rate: m^2/N, None for none; step: of
    the output in s; bodies: see System."""

    def __init__(self, rate: float | None, step: float, bodies: Indices) -> None:
        self._scale = 0.0 if rate is None else rate * step
        self._depths = np.zeros((0 if rate is None else len(bodies), ANGLES))
        self._turns = bodies[:, 1] >= 0

    def add(self, system: System, warm: FilmNumbers | None, samples: Samples) -> None:
        """Let the surfaces wear as they slide at these samples."""
        if system.asperities is None or not len(self._depths):
            return
        for i, depths in enumerate(self._depths):
            clearances, motions = film_motions(system, warm or unchanged(system), samples, i)
            wear_along(system.asperities, i, clearances, motions, self._scale, depths)

    def snapshot(self) -> dict[str, Array]:
        """What a checkpoint holds: (films, ANGLES) m."""
        return {WEAR: self._depths.copy()} if len(self._depths) else {}

    def restore(self, checkpoint: Mapping[str, Array]) -> None:
        """Take up the depths of a checkpoint. Raises WrongCheckpoint."""
        if len(self._depths):
            depths = array(checkpoint, WEAR, self._depths.shape)
            if not np.all((depths >= 0.0) & (depths <= DEEPEST)):
                raise WrongCheckpoint("wear holds depths that no shell has")
            self._depths = depths

    def deepest(self) -> dict[str, float]:
        """The largest depth in m and phi of its place in degrees, 0 all around a shell that turns."""
        if not len(self._depths):
            return {}
        depths = np.where(self._turns[:, None], self._depths.mean(axis=1, keepdims=True), self._depths)
        film, place = np.unravel_index(int(np.argmax(depths)), depths.shape)
        return {"wear_depth_m": float(depths[film, place]), "wear_angle_deg": 360.0 * float(place) / ANGLES}
