"""Spins of rings, and their pins.

Rotation of floating rings in one stage of the time loop: speeds of their films, torques on them. Compiled.

Pins that keep rings from turning, in a stage of the time loop. Compiled.

A ring that has turned by more than the play to one side pushes against its pin, a spring and a damper, which do not
pull at it. Machines without pins have an array without rows. Its torque over the angle alone is in elements/pin.py."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices, compiled
from frbcli.film.cells.data import Records
from frbcli.solve.drive import begin_pull, pull, turns_freely
from frbcli.solve.films.forces import drag_integral
from frbcli.solve.scratch import Scratch
from frbcli.solve.stage.equations import FORCE, OMEGA, X_0, Q, U, V
from frbcli.solve.stage.forces import feel, rubbing
from frbcli.solve.state import GRID, SLIP, SUM, Control, RotorData


class Rings(NamedTuple):
    """bodies, angles (1 + rings,): speeds and angles of the rotor and the rings in a stage; torque (rings,) on them;
    held (rings,): what Couette's terms fall by per speed of the ring."""

    bodies: Array
    angles: Array
    torque: Array
    held: Array


def make_rings(count: int) -> Rings:
    """The given number of rings, all at rest."""
    return Rings(np.zeros(1 + count), np.zeros(1 + count), np.zeros(count), np.zeros(count))


@compiled(inline=True)
def set_speeds(turning: Array, bodies: Array, angles: Array, journal: Array, grids: Records) -> None:
    """OMEGA of each film, and how its grid stands, by speeds and angles of the rotor and the rings."""
    for f in range(turning.shape[0]):
        total, speed, angle = 0.0, 0.0, 0.0
        for b in range(bodies.shape[0]):
            total += turning[f, SUM, b] * bodies[b]
            speed += turning[f, GRID, b] * bodies[b]
            angle += turning[f, GRID, b] * angles[b]
        journal[OMEGA, 2 * f] = journal[OMEGA, 2 * f + 1] = total
        if grids.shape[0] > f:
            grids[f].turn, grids[f].speed = angle, speed


@compiled(inline=True)
def guess_speeds(
    spins: Indices, s: int, g: float, speed: float, angle: float, at: Array, stage_a: Array, bodies: Array,
    angles: Array,
) -> None:  # fmt: skip
    """bodies, angles (1 + rings,) <- speed and angle of the rotor, and of each ring, which goes on as it did in the
    stage before."""
    bodies[0], angles[0] = speed, angle
    for r in range(spins.shape[0]):
        i = spins[r]
        bodies[1 + r] = at[V, i] + g * stage_a[i, s - 1]
        angles[1 + r] = at[Q, i] + g * bodies[1 + r]


@compiled()
def spin_up(
    films: Any, work: Any, rotor: RotorData, s: int, g: float, control: Control, scratch: Scratch, rings: Rings
) -> float:
    """Let the films' torques (4.17) turn the rings: speeds and angles of the stage; a rotor whose speed is free gets
    its own torque for turn_on of drive.py. Returns how far, in rad, the angle of a ring was off.

    Couette's term pulls at the surfaces against each other, Poiseuille's, half the moment of the film's force about the
    middle between them, at both in the same sense. How Couette's term of a ring falls with its own speed is taken in by
    Newton's method: a ring of little inertia follows it at once, and plain iterations would go to and fro.
    """
    count, clearances, journal, at = rotor.spins.shape[0], rotor.clearances, scratch.journal, scratch.at
    bodies, angles, torque, held = rings
    if count == 0 and not turns_freely(rotor.drive):
        return 0.0
    begin_pull(rotor.drive)
    for r in range(count):
        torque[r] = held[r] = 0.0
    for f in range(clearances.shape[0]):
        x, y, c = 2 * f, 2 * f + 1, clearances[f]
        e_x, e_y = journal[X_0, x] + g * journal[U, x], journal[X_0, y] + g * journal[U, y]
        slip = 0.0
        for b in range(bodies.shape[0]):
            slip += rotor.turning[f, SLIP, b] * bodies[b]
        d_x, d_y, _, _, _, _, _, _, _, _ = feel(
            e_x / c, e_y / c, 0.0, 0.0, control.contact_eccentricity, control.contact_stiffness
        )
        resistance = rotor.drag[f] * drag_integral(films, work, f, d_x, d_y, rotor.torque_terms[1])
        couette, summits = -resistance * slip, rubbing(control.rough, f, c, g, journal)
        f_x, f_y = journal[FORCE, x] - summits.f_x, journal[FORCE, y] - summits.f_y
        poiseuille = -0.5 * (e_x * f_y - e_y * f_x) if rotor.torque_terms[0] == 1 else 0.0
        inside, outside = rotor.ring_of[f, 0], rotor.ring_of[f, 1]
        pull(rotor.drive, rotor, f, couette + poiseuille + summits.torque, resistance + summits.grip)
        if inside >= 0:
            torque[inside] += couette + poiseuille + summits.torque
            held[inside] += resistance + summits.grip
        if outside >= 0:
            torque[outside] += poiseuille - couette + summits.shell_torque
            held[outside] += resistance + summits.grip
    off = 0.0
    for r in range(count):
        i = rotor.spins[r]
        pulled = torque[r] + held[r] * (bodies[1 + r] - at[V, i])
        inertia = rotor.mass[i, i] + g * held[r]
        scratch.stage_a[i, s] = pulled / inertia
        if rotor.pins.shape[0] > 0:
            scratch.stage_a[i, s] = pinned(rotor.pins[r], at[Q, i], at[V, i], g, inertia, pulled)
        speed = at[V, i] + g * scratch.stage_a[i, s]
        off = max(off, abs(g * (speed - bodies[1 + r])))
        scratch.stage_v[i, s] = bodies[1 + r] = speed
        angles[1 + r] = at[Q, i] + g * speed
    return off


# Of a ring: play in rad, N m/rad, N m s/rad, and m from the axis; a ring without a pin has no stiffness
PLAY, STIFFNESS, DAMPING, RADIUS, PIN = range(5)


@compiled()
def pinned(pin: Array, q: float, v: float, g: float, inertia: float, pulled: float) -> float:
    """Angular acceleration a of a ring with v' = v + g a and angle q + g v' in a stage, inertia a = pulled + its pin.

    The torque never rises with the speed of the ring, so that there is one solution, in the play, against the pin, or
    at the edge: a ring that meets its damper there has any torque between none and the damper's. """
    free = pulled / inertia
    angle = q + g * (v + g * free)
    if pin[STIFFNESS] == 0.0 or abs(angle) <= pin[PLAY]:
        return free
    side = 1.0 if angle > 0.0 else -1.0
    edge, k, c = side * pin[PLAY], pin[STIFFNESS], pin[DAMPING]
    pressed = (pulled - k * (q + g * v - edge) - c * v) / (inertia + g * (c + g * k))
    if side * (inertia * pressed - pulled) >= 0.0:  # it would pull
        return free
    if side * (q + g * (v + g * pressed) - edge) < 0.0:
        return float(((edge - q) / g - v) / g)
    return float(pressed)
