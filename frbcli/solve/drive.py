"""A rotor whose speed is free, in a stage of the time loop. Compiled. Two kinds:

- an empty tuple: the rotor turns as its speed profile says, and nothing is computed;
- DrivenRotor: its rotation is one more degree of freedom, which a stage solves with the rings,

      J alpha = torque(omega, t) - load(omega) + friction + internal damping + reaction of the whirl,

  with the friction of films, stops and ball bearings.

Which of them a function means is decided by the type of the drive when the loop is compiled, as in heat.py.

The force of the unbalance is d^2/dt^2 (C sin phi - S cos phi) on the displacements q, with C and S of LinearRotor. Both
follow from one kinetic energy, whose coupling of q' with phi' gives the reaction q'' (C cos phi + S sin phi) on phi; of
a disk with the unbalance U it is U (x'' cos phi + y'' sin phi), and its weight adds g U sin phi.

Internal damping has the force -C (q' - omega R q) on the displacements, where R q is q a quarter turn ahead: it damps
what a shaft sees that turns with the rotor. The torque of these forces on the rotation is (R q)^T C (q' - omega R q).

Source: Dimentberg et al.: Dynamics of an unbalanced shaft interacting with a limited power supply. Nonlinear Dynamics
13 (1997), 171-187.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import by_types, compiled, compiled_for, type_of
from frbcli.rotor import port
from frbcli.solve.scratch import Scratch, rotation
from frbcli.solve.stage.equations import CORRECTION, E_COS, E_GYROSCOPIC, E_SIN, FREE, LATE, U_0, Q, V
from frbcli.solve.stage.forces import Ports
from frbcli.solve.state import RUNNING, SLIP, STANDSTILL, STEP, TIME, RotorData

CONSTANT, LINEAR, SQUARE = range(3)  # parts of the load
# Of a stage: its acceleration, speed and angle, torque of all friction and by how much it falls with the speed
ALPHA, OMEGA, ANGLE, FRICTION, GRIP, NOW = range(6)


class DrivenRotor(NamedTuple):
    """place: the degree of freedom of the rotation; inertia: kg m^2; points (2, k): speeds in rad/s, or times in s
    where over_time, with torques in N m, constant beyond them; end: s, from which on there is no torque; governed:
    speeds in rad/s at which a governor begins to take a torque above 0 away, and has done so; load (3,): N m, N m s, N
    m s^2; thrust (2, k): speeds in rad/s with the torques in N m that brake the collar; internal (2, m, m): C and C R
    in N s/m on the first m degrees of freedom, m = 0 without internal damping; reaction: whether the whirl acts on the
    rotation; weight: N m, its torque is that times sin phi; slow: rad/s that count as standstill; now (NOW,): of a
    stage."""

    place: int
    inertia: float
    points: Array
    over_time: bool
    end: float
    governed: tuple[float, float]
    load: Array
    thrust: Array
    internal: Array
    reaction: bool
    weight: tuple[float, float]
    slow: float
    now: Array


def is_driven(drive: Any) -> bool:
    """Whether a drive, or its type, is a DrivenRotor."""
    return type_of(drive) is DrivenRotor


@compiled_for(DrivenRotor, False)
def turns_freely(drive: DrivenRotor) -> bool:
    """Whether the speed of the rotor is free."""
    return True


@compiled()
def torque(drive: DrivenRotor, since: float, t: float, omega: float) -> tuple[float, float]:
    """The torque in N m at the time t in s of a step that begins at `since`, at a speed in rad/s, and its slope over
    the speed."""
    if since >= drive.end:
        return 0.0, 0.0
    value, slope = _interpolated(drive.points, t if drive.over_time else omega)
    slope = 0.0 if drive.over_time else slope
    begins, ends = drive.governed
    if omega <= begins or value <= 0.0:
        return value, slope
    if omega >= ends:
        return 0.0, 0.0
    share = (ends - omega) / (ends - begins)
    return share * value, share * slope - value / (ends - begins)


@compiled()
def _interpolated(points: Array, place: float) -> tuple[float, float]:
    """Value and slope at a place, of points (2, k) that are linear between and constant beyond."""
    last = points.shape[1] - 1
    if place <= points[0, 0]:
        return float(points[1, 0]), 0.0
    if place >= points[0, last]:
        return float(points[1, last]), 0.0
    row = 0
    while points[0, row + 1] < place:
        row += 1
    slope = (points[1, row + 1] - points[1, row]) / (points[0, row + 1] - points[0, row])
    return float(points[1, row] + slope * (place - points[0, row])), float(slope)


@compiled()
def load_of(drive: DrivenRotor, omega: float) -> tuple[float, float]:
    """The load and the torque of a thrust bearing in N m at a speed in rad/s, and their slope."""
    constant, linear, square = drive.load[CONSTANT], drive.load[LINEAR], drive.load[SQUARE]
    thrust, rise = _interpolated(drive.thrust, omega)
    return constant + (linear + square * omega) * omega + thrust, linear + 2.0 * square * omega + rise


@compiled()
def internal_torque(
    drive: DrivenRotor, at: Array, stage_v: Array, s: int, g: float, omega: float
) -> tuple[float, float]:
    """The torque in N m of the internal damping on the rotation in stage s, and by how much it falls with the speed."""
    still, falls = 0.0, 0.0
    for i in range(drive.internal.shape[1]):
        across, along = 0.0, 0.0
        for j in range(drive.internal.shape[2]):
            q = at[Q, j] + g * stage_v[j, s]
            across += drive.internal[1, i, j] * q
            along += drive.internal[0, i, j] * q
        still += stage_v[i, s] * across
        falls += (at[Q, i] + g * stage_v[i, s]) * along
    return still - omega * falls, falls


def _own_speed(drive, v, times, speeds, angles, piece, t):  # type: ignore[no-untyped-def]
    return v[drive.place]


@by_types(lambda drive, *_: _own_speed if is_driven(drive) else None)
def speed_now(drive: Any, v: Array, times: Array, speeds: Array, angles: Array, piece: int, t: float) -> float:
    """The speed of the rotor in rad/s at the start of a step at the time t in s, in a piece of its profile."""
    return rotation(times, speeds, angles, piece, t)[1]


@compiled()
def _go_on(drive: DrivenRotor, s: int, g: float, at: Array, stage_a: Array) -> tuple[float, float, float]:
    i, now = drive.place, drive.now
    alpha = stage_a[i, s - 1]
    now[ALPHA], now[OMEGA] = alpha, at[V, i] + g * alpha
    now[ANGLE] = at[Q, i] + g * now[OMEGA]
    return alpha, float(now[OMEGA]), float(now[ANGLE])


def _own_rotation(drive, times, speeds, angles, piece, t, s, g, at, stage_a):  # type: ignore[no-untyped-def]
    return _go_on(drive, s, g, at, stage_a)


@by_types(lambda drive, *_: _own_rotation if is_driven(drive) else None)
def stage_rotation(
    drive: Any, times: Array, speeds: Array, angles: Array, piece: int, t: float, s: int, g: float, at: Array,
    stage_a: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """Acceleration, speed and angle of the rotor in stage s at the time t in s: from its profile, or as it would go on
    by the acceleration of the stage before. at: as `predict` fills it."""
    return rotation(times, speeds, angles, piece, t)


@compiled_for(DrivenRotor)
def begin_pull(drive: DrivenRotor) -> None:
    """No film has been asked for its torque yet."""
    drive.now[FRICTION] = drive.now[GRIP] = 0.0


@compiled_for(DrivenRotor)
def brake(drive: DrivenRotor, on_rotor: float, grip: float) -> None:
    """Add a torque in N m on the rotor, and by how much it falls with the speed."""
    drive.now[FRICTION] += on_rotor
    drive.now[GRIP] += grip


@compiled_for(DrivenRotor)
def pull(drive: DrivenRotor, rotor: RotorData, f: int, on_journal: float, grip: float) -> None:
    """Add the torque in N m that film f puts on its journal, and by how much that falls with the speed of the journal,
    where the journal is of the rotor."""
    if rotor.ring_of[f, 0] < 0 and rotor.turning[f, SLIP, 0] > 0.0:
        brake(drive, rotor.multiplicity[f] * on_journal, rotor.multiplicity[f] * grip)


@compiled_for(Ports)
def brake_at_ports(ports: Ports, drive: Any) -> None:
    """Let the friction at the ports brake a rotor whose speed is free, see drive.py."""
    for k in range(ports.lengths.shape[0]):
        brake(drive, ports.counts[k] * ports.answers[k, port.TORQUE], ports.counts[k] * ports.answers[k, port.GRIP])


@compiled_for(DrivenRotor, 0.0)
def turn_on(
    drive: DrivenRotor, rotor: RotorData, since: float, t: float, s: int, g: float, bodies: Array, angles: Array,
    scratch: Scratch, least: float,
) -> float:  # fmt: skip
    """Let the torques turn the rotor in stage s at the time t of a step that begins at `since`: its speed and angle,
    first of `bodies` and `angles`, and what changes with them in the rotor. Returns by how much the stage was off: the
    angle in rad, or a journal or port over `least`, the smallest length of all in m.

    How the torques change with the speed, and the reaction with the acceleration, is taken in by Newton's method.
    """
    i, now, at, stage_v, stage_a = drive.place, drive.now, scratch.at, scratch.stage_v, scratch.stage_a
    loads, journal, alpha, omega = scratch.loads, scratch.journal, now[ALPHA], now[OMEGA]
    driving, slope = torque(drive, since, t, omega)
    braking, rise = load_of(drive, omega)
    inside, softens = internal_torque(drive, at, stage_v, s, g, omega)
    net, falls = driving - braking + now[FRICTION] + inside, g * (rise - slope + now[GRIP] + softens)
    sine, cosine = math.sin(now[ANGLE]), math.cos(now[ANGLE])
    if drive.reaction:
        for k in range(at.shape[1]):
            arm = cosine * rotor.unbalance_cos[k] + sine * rotor.unbalance_sin[k]
            net += arm * stage_a[k, s]
            falls -= arm * (cosine * loads[E_COS, k] + sine * loads[E_SIN, k])
        net += drive.weight[0] * cosine + drive.weight[1] * sine
    turned = (net + falls * alpha) / (drive.inertia + falls)
    speed = at[V, i] + g * turned
    angle = at[Q, i] + g * speed
    along, across = alpha * cosine - omega * omega * sine, alpha * sine + omega * omega * cosine
    sine, cosine = math.sin(angle), math.cos(angle)
    along = turned * cosine - speed * speed * sine - along
    across = turned * sine + speed * speed * cosine - across
    for j in range(journal.shape[1]):
        journal[CORRECTION, j] = journal[U_0, j]
    for k in range(at.shape[1]):
        change = along * loads[E_COS, k] + across * loads[E_SIN, k]
        if rotor.has_gyroscopic:
            for j in range(at.shape[1]):
                change -= (speed - omega) * scratch.products[E_GYROSCOPIC, k, j] * at[V, j]
        at[FREE, k] += change
        at[LATE, k] += change
        stage_a[k, s] += change
        stage_v[k, s] += g * change
        for j in range(journal.shape[1]):
            journal[U_0, j] += g * scratch.selection[j, k] * change
    off = abs(speed - omega)
    for j in range(journal.shape[1]):
        off = max(off, abs(journal[U_0, j] - journal[CORRECTION, j]) / least)
    stage_a[i, s], stage_v[i, s] = turned, speed
    now[ALPHA], now[OMEGA], now[ANGLE] = turned, speed, angle
    bodies[0], angles[0] = speed, angle
    return float(g * off)


@compiled_for(DrivenRotor, False)
def overshoots(drive: DrivenRotor, numbers: Array, v: Array, stage_v: Array, step: float) -> bool:
    """Whether the rotor would turn backwards at the end of a step; then the next one is as long as it takes to stand,
    were it to slow down evenly."""
    i = drive.place
    before, after = v[i], stage_v[i, stage_v.shape[1] - 1]
    if after >= -drive.slow or before <= drive.slow:
        return False
    numbers[STEP] = step * before / (before - after)
    return True


@compiled_for(DrivenRotor, RUNNING)
def end_of_turning(drive: DrivenRotor, numbers: Array, stage_v: Array, v: Array, a: Array) -> int:
    """After a step: without the torque of the drive from its end on, whose jump no step sees. Returns RUNNING, or
    STANDSTILL where the rotor has slowed down to a stop."""
    i, before = drive.place, stage_v[drive.place, 0]
    if numbers[TIME] == drive.end:
        a[i] -= torque(drive, 0.0, numbers[TIME], v[i])[0] / drive.inertia
    stands = v[i] <= drive.slow and (v[i] < before or v[i] < -drive.slow)
    return STANDSTILL if stands else RUNNING


@compiled()
def driving_along(drive: DrivenRotor, times: Array, speeds: Array, torques: Array) -> None:
    """torques (k,) <- the torque of the drive at times (k,) in s and speeds (k,) in rad/s."""
    for k in range(times.shape[0]):
        torques[k] = torque(drive, times[k], times[k], speeds[k])[0]
