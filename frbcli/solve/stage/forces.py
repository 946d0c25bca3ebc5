"""What acts in a stage of the time loop besides its films: contact of journal and shell, gyroscopic moments of rings
that turn and tilt, loads, and forces at ports. Compiled.

A machine without one of them has an empty tuple in its place, for which nothing is computed: that is decided by the
types of the data when the loop is compiled.

- Contact, elastic, rough, or at the ends of a tilted journal: what films feel of it, and what it pushes with, in
  parallel to them. Whether surfaces are rough is the type of `Control.rough`.
- Cones: a ring of polar inertia I that turns with w and has the slopes s pulls with -w I (s_y', -s_x') on them, which
  joins the acceleration FREE of each stage, see equations.py, by the velocities of the iteration before.
- VaryingLoads: loads that change with the angle of the rotor or with time join the acceleration FREE, too.
- Ports, see rotor/port.py: the displacements and velocities that they see are unknowns of Newton's method in addition
  to the journals', which they follow in all arrays of a stage.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import Indices, address_of, compiled, compiled_for
from frbcli.dense import solve_dense
from frbcli.film.roughness.asperities import APART, Asperities, Rub, rub
from frbcli.film.roughness.contact import ELASTIC_LIMIT, closes_freely_until, contact_gap
from frbcli.rotor.loads import Harmonic, Load, Tabulated
from frbcli.rotor.port import (
    ANSWER,
    F_X,
    F_Y,
    MOTION,
    V_XX,
    V_XY,
    V_YX,
    V_YY,
    XX,
    XY,
    YX,
    YY,
    Port,
)
from frbcli.rotor.port_function import call_force, compiled_force
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, FREE, LATE, U_0, X_0, U, V, add_table
from frbcli.solve.state import SLIP, SUM, Control, RotorData

ORDER, FREQUENCY = range(2)  # of a harmonic


class VaryingLoads(NamedTuple):
    """The h harmonic and then the k tabulated loads of rotor/loads.py.

    columns: (2 (h + k), n) N; turns: (h, 2) ORDER and FREQUENCY in rad/s; first: (k + 1,) row of each table, and their
    number; times: (rows,) s of all tables; cubics: (rows, 2, 4); response: as columns, m/s^2, of the inverse E of
    equations.py with them; elimination: (2, n, 2 n + columns) to work in.
    """

    columns: Array
    turns: Array
    first: NDArray[np.int64]
    times: Array
    cubics: Array
    response: Array
    elimination: Array


def varying_loads(loads: Sequence[Load]) -> VaryingLoads | tuple[()]:
    """The loads of a machine as the time loop takes them."""
    if not loads:
        return ()
    harmonics = [load for load in loads if isinstance(load, Harmonic)]
    tables = [load for load in loads if isinstance(load, Tabulated)]
    columns = np.concatenate([load.columns for load in (*harmonics, *tables)])
    count, n = columns.shape
    nothing = np.zeros((1, 2, 4))  # behind the end of each table
    return VaryingLoads(
        columns,
        np.array([[load.order, load.frequency] for load in harmonics]).reshape(-1, 2),
        np.cumsum([0, *(len(table.times) for table in tables)]),
        np.concatenate([np.zeros(0), *(table.times for table in tables)]),
        np.concatenate([nothing[:0], *(part for table in tables for part in (table.cubics, nothing))]),
        np.zeros((count, n)),
        np.zeros((2, n, 2 * n + count)),
    )


@compiled_for(VaryingLoads)
def prepare_loads(loads: VaryingLoads, rotor: RotorData, g: float, speed: float) -> None:
    """The inverse of `prepare` for this g and speed with the loads."""
    solve_columns(loads.columns, loads.response, loads.elimination, rotor, g, speed)


@compiled()
def solve_columns(
    columns: Array, response: Array, elimination: Array, rotor: RotorData, g: float, speed: float
) -> None:
    """response <- the inverse E of equations.py for this g and speed with columns (c, n) of forces."""
    n, count = rotor.mass.shape[0], columns.shape[0]
    dynamic, right = elimination[0], elimination[1]  # the forces lie behind the columns of add_table
    for i in range(n):
        for j in range(n):
            dynamic[i, j] = rotor.mass[i, j] + g * (
                rotor.damping[i, j] + speed * rotor.gyroscopic[i, j] + g * rotor.stiffness[i, j]
            )
        for k in range(count):
            right[i, 2 * n + k] = columns[k, i]
    if rotor.table_speeds.shape[0] > 0:
        add_table(rotor, g, speed, dynamic, right)
    solve_dense(dynamic, right)
    for i in range(n):
        for k in range(count):
            response[k, i] = right[i, 2 * n + k]


@compiled()
def row_at(times: Array, first: int, end: int, t: float) -> int:
    """The row of a table, of rows from first up to end, whose piece holds the time t."""
    low, high = first, end - 1
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@compiled()
def _cubic(coefficients: Array, s: float) -> float:
    return float(coefficients[0] + s * (coefficients[1] + s * (coefficients[2] + s * coefficients[3])))


@compiled_for(VaryingLoads)
def add_loads(
    loads: VaryingLoads, t: float, angle: float, g: float, selection: Array, at: Array, journal: Array
) -> None:
    """Add the loads at the time t in s and the angle of the rotor then to FREE of `at` and U_0 of `journal`."""
    harmonics = loads.turns.shape[0]
    for k in range(harmonics + loads.first.shape[0] - 1):
        if k < harmonics:
            theta = loads.turns[k, ORDER] * angle + loads.turns[k, FREQUENCY] * t
            one, other = math.cos(theta), math.sin(theta)
        else:
            row = row_at(loads.times, loads.first[k - harmonics], loads.first[k - harmonics + 1], t)
            since = t - loads.times[row]
            one, other = _cubic(loads.cubics[row, 0], since), _cubic(loads.cubics[row, 1], since)
        for i in range(at.shape[1]):
            more = one * loads.response[2 * k, i] + other * loads.response[2 * k + 1, i]
            at[FREE, i] += more
            for j in range(selection.shape[0]):
                journal[U_0, j] += g * selection[j, i] * more


@compiled(inline=True)
def touches(eccentricity: float, contact_at: float, contact_stiffness: float) -> float:
    """Whether a film feels less than the displacement. Where contact ends the run, stiffness 0, it never does."""
    return contact_stiffness > 0.0 and eccentricity > closes_freely_until(contact_at)


@compiled(inline=True)
def shell_ahead(eccentricity: float, contact_at: float, contact_stiffness: float) -> float:
    """Eccentricity at which the gap ends for Newton's method: at the shell, and in contact as far ahead as the gap was
    wide there, but no further than a shell gives way."""
    if contact_stiffness > 0.0:
        return min(max(1.0, eccentricity + 1.0 - closes_freely_until(contact_at)), ELASTIC_LIMIT)
    return 1.0


@compiled()
def feel(
    d_x: float, d_y: float, v_x: float, v_y: float, contact_at: float, contact_stiffness: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The ten numbers of contact_gap, in contact or not."""
    if touches(math.sqrt(d_x * d_x + d_y * d_y), contact_at, contact_stiffness):
        return contact_gap(closes_freely_until(contact_at), d_x, d_y, v_x, v_y)
    return d_x, d_y, v_x, v_y, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0


@compiled()
def push_back(
    d_x: float, d_y: float, clearance: float, contact_at: float, contact_stiffness: float,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """The radial spring of the surfaces beyond the eccentricity of contact: force (x, y) in N, and what it falls by per
    displacement over the clearance (xx, yy, xy)."""
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if contact_stiffness <= 0.0 or eccentricity <= contact_at:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    k, n_x, n_y = contact_stiffness * clearance, d_x / eccentricity, d_y / eccentricity
    along = k * (1.0 - contact_at / eccentricity)
    return (
        -along * d_x,
        -along * d_y,
        along + (k - along) * n_x * n_x,
        along + (k - along) * n_y * n_y,
        (k - along) * n_x * n_y,
    )


def felt_motion(control: Control, d: Array, v: Array) -> Array:
    """(2, 2) displacement and velocity felt by a film, from its journal's d and v (2,), over the clearance."""
    felt = feel(d[0], d[1], v[0], v[1], control.contact_eccentricity, control.contact_stiffness)
    return np.array(felt[:4]).reshape(2, 2)


SLIDES, SHELL = range(2)  # omega_J - omega_S, and omega_S


class RoughContact(NamedTuple):
    """surfaces: of all films; speeds: (films, 2) rad/s, which the loop writes, see SLIDES."""

    surfaces: Asperities
    speeds: Array


@compiled_for(RoughContact)
def set_sliding(rough: RoughContact, turning: Array, bodies: Array) -> None:
    """Speeds of the surfaces of all films from the speeds of rotor and rings (1 + rings,)."""
    for f in range(turning.shape[0]):
        total, slip = 0.0, 0.0
        for b in range(bodies.shape[0]):
            total += turning[f, SUM, b] * bodies[b]
            slip += turning[f, SLIP, b] * bodies[b]
        rough.speeds[f, SLIDES], rough.speeds[f, SHELL] = slip, 0.5 * (total - slip)


@compiled_for(RoughContact, APART)
def rubbing(rough: RoughContact, f: int, clearance: float, g: float, journal: Array) -> Rub:
    """What the summits of film f do at the velocities U."""
    x, y = 2 * f, 2 * f + 1
    return rub(
        rough.surfaces, f, clearance, journal[X_0, x] + g * journal[U, x], journal[X_0, y] + g * journal[U, y],
        journal[U, x], journal[U, y], rough.speeds[f, SLIDES], rough.speeds[f, SHELL],
    )  # fmt: skip


@compiled_for(RoughContact)
def press(rough: RoughContact, f: int, clearance: float, g: float, journal: Array) -> None:
    """Add the summits of film f to FORCE, BY_X, BY_Y of its journal."""
    x, y, rubbed = 2 * f, 2 * f + 1, rubbing(rough, f, clearance, g, journal)
    journal[FORCE, x] += rubbed.f_x
    journal[FORCE, y] += rubbed.f_y
    journal[BY_X, x] += rubbed.d_xx + g * rubbed.k_xx
    journal[BY_Y, x] += rubbed.d_xy + g * rubbed.k_xy
    journal[BY_X, y] += rubbed.d_yx + g * rubbed.k_yx
    journal[BY_Y, y] += rubbed.d_yy + g * rubbed.k_yy


@compiled_for(RoughContact, 0.0)
def sharpness(rough: RoughContact, clearance: float) -> float:
    """How sharply the force of summits bends, over the clearance: 1 / roughness; 0 between smooth surfaces."""
    return clearance / rough.surfaces.roughness


class Cones(NamedTuple):
    """rings: (c,) numbers of the rings; columns: (2 c, n) their slopes in x and y times the root of the inertia;
    response: as columns, of the inverse E of equations.py with them; pulls: (2 c,) of the iteration before;
    elimination: (2, n, 2 n + columns) to work in."""

    rings: NDArray[np.int64]
    columns: Array
    response: Array
    pulls: Array
    elimination: Array


def make_cones(cones: Sequence[tuple[int, Array]], first: int) -> Cones | tuple[()]:
    """The cones of a LinearRotor as the time loop takes them. first: degree of freedom of the first ring's angle."""
    if not cones:
        return ()
    columns = np.concatenate([cone for _, cone in cones])
    count, n = columns.shape
    rings = np.array([spin - first for spin, _ in cones], dtype=np.int64)
    return Cones(rings, columns, np.zeros((count, n)), np.zeros(count), np.zeros((2, n, 2 * n + count)))


@compiled_for(Cones)
def prepare_cones(cones: Cones, rotor: RotorData, g: float, speed: float) -> None:
    """The inverse of `prepare` for this g and speed with the cones."""
    solve_columns(cones.columns, cones.response, cones.elimination, rotor, g, speed)


@compiled_for(Cones, 0.0)
def turn_cones(
    cones: Cones, bodies: Array, s: int, known: int, g: float, selection: Array, at: Array, stage_a: Array,
    journal: Array,
) -> float:  # fmt: skip
    """Renew the pulls in stage s: in FREE and LATE of `at` and U_0 of `journal`. Returns the largest change of U_0 in
    m/s.

    bodies: speeds of the rotor and the rings; known: the stage whose accelerations the velocities follow from, at first
    the one before.
    """
    change = 0.0
    for c in range(cones.rings.shape[0]):
        x, y, speed = 2 * c, 2 * c + 1, bodies[1 + cones.rings[c]]
        slope_x, slope_y = 0.0, 0.0
        for i in range(at.shape[1]):
            rate = at[V, i] + g * stage_a[i, known]
            slope_x += cones.columns[x, i] * rate
            slope_y += cones.columns[y, i] * rate
        before_x, before_y = (cones.pulls[x], cones.pulls[y]) if known == s else (0.0, 0.0)
        cones.pulls[x], cones.pulls[y] = -speed * slope_y, speed * slope_x
        more_x, more_y = cones.pulls[x] - before_x, cones.pulls[y] - before_y
        for i in range(at.shape[1]):
            more = more_x * cones.response[x, i] + more_y * cones.response[y, i]
            at[FREE, i] += more
            at[LATE, i] += more
        for k in range(selection.shape[0]):
            rate = 0.0
            for i in range(at.shape[1]):
                rate += selection[k, i] * (more_x * cones.response[x, i] + more_y * cones.response[y, i])
            journal[U_0, k] += g * rate
            change = max(change, abs(g * rate))
    return change


class Ports(NamedTuple):
    """The k ports of a machine. addresses: (k,) of their laws; places: (k, 2, n) and counts (k,), see Port; lengths:
    (k,) m; first: (k + 1, 2) of the parameters and memories of each in numbers and memory; motions (k, MOTION), answers
    (k, ANSWER): of the last call of each law, NaN before it; turned: speed and angle of the rotor; missed: (2 k,) by
    how much the forces differ from those that Newton's method has used, N."""

    addresses: Indices
    places: Array
    counts: Array
    lengths: Array
    first: Indices
    numbers: Array
    memory: Array
    motions: Array
    answers: Array
    turned: Array
    missed: Array


def make_ports(ports: Sequence[Port]) -> Ports | tuple[()]:
    """The ports of a machine as the time loop takes them."""
    if not ports:
        return ()
    laws = [port.law for port in ports]
    sizes = [(len(law.parameters), len(law.memory)) for law in laws]
    return Ports(
        np.array([address_of(compiled_force(type(law))) for law in laws], dtype=np.int64),
        np.array([port.place for port in ports]),
        np.array([port.count for port in ports]),
        np.array([law.length for law in laws]),
        np.concatenate([np.zeros((1, 2), dtype=np.int64), np.cumsum(sizes, axis=0)]),
        np.concatenate([law.parameters for law in laws]),
        np.concatenate([law.memory for law in laws]),
        np.full((len(ports), MOTION), math.nan),
        np.zeros((len(ports), ANSWER)),
        np.zeros(2),
        np.zeros(2 * len(ports)),
    )


@compiled_for(Ports, math.inf)
def shortest(ports: Ports) -> float:
    """The least of the lengths, m."""
    least = math.inf
    for k in range(ports.lengths.shape[0]):
        least = min(least, ports.lengths[k])
    return least


@compiled_for(Ports)
def turn_ports(ports: Ports, speed: float, angle: float) -> None:
    """Speed in rad/s and angle of the rotor in a stage."""
    ports.turned[0], ports.turned[1] = speed, angle


@compiled()
def _ask(ports: Ports, k: int, x: int, g: float, journal: Array) -> None:
    """The answer of port k, whose motion is columns x and x + 1 of the journal, at the velocities U. What left_at_ports
    has asked for last is what an iteration begins with, so that a law is called for what is new alone."""
    v_x, v_y, motion, known = journal[U, x], journal[U, x + 1], ports.motions[k], True
    d_x, d_y = journal[X_0, x] + g * v_x, journal[X_0, x + 1] + g * v_y
    now = d_x, d_y, v_x, v_y, ports.turned[0], ports.turned[1]  # in the order of a motion
    for i in range(MOTION):
        known = known and now[i] == motion[i]
        motion[i] = now[i]
    if known:
        return
    (a, c), (b, d) = (ports.first[k, 0], ports.first[k, 1]), (ports.first[k + 1, 0], ports.first[k + 1, 1])
    call_force(ports.addresses[k], b - a, d - c, ports.numbers[a:b], ports.memory[c:d], motion, ports.answers[k])


@compiled_for(Ports)
def push_ports(ports: Ports, films: int, g: float, journal: Array) -> None:
    """Fill FORCE, BY_X, BY_Y of the ports, which follow so many films."""
    for k in range(ports.lengths.shape[0]):
        x = 2 * (films + k)
        y, out = x + 1, ports.answers[k]
        _ask(ports, k, x, g, journal)
        journal[FORCE, x], journal[FORCE, y] = out[F_X], out[F_Y]
        journal[BY_X, x], journal[BY_Y, x] = out[V_XX] + g * out[XX], out[V_XY] + g * out[XY]
        journal[BY_X, y], journal[BY_Y, y] = out[V_YX] + g * out[YX], out[V_YY] + g * out[YY]


@compiled_for(Ports, 0.0)
def left_at_ports(ports: Ports, clearances: Array, compliance: Array, g: float, journal: Array) -> float:
    """What the forces at the corrected velocities U would move on, over clearances and lengths: they are known there,
    and FORCE has them to first order."""
    films, left = clearances.shape[0], 0.0
    for k in range(ports.lengths.shape[0]):
        _ask(ports, k, 2 * (films + k), g, journal)
        for i in range(2):
            ports.missed[2 * k + i] = ports.answers[k, F_X + i] - journal[FORCE, 2 * (films + k) + i]
    for i in range(compliance.shape[0]):
        moved, length = 0.0, clearances[i // 2] if i < 2 * films else ports.lengths[i // 2 - films]
        for j in range(ports.missed.shape[0]):
            moved += compliance[i, 2 * films + j] * ports.missed[j]
        left = max(left, g * abs(moved) / length)
    return left
