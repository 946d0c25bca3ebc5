"""Forces at ports, see rotor/port.py, in a stage of the time loop. Compiled. Two kinds:

- an empty tuple: a machine without them, for which nothing is computed;
- Ports: the displacements and velocities that they see are unknowns of Newton's method in addition to the journals',
  which they follow in all arrays of a stage.

Which of them a function means is decided by the type of the ports when the loop is compiled, as in loads.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices, address_of, compiled, compiled_for
from frbcli.rotor.port import (
    ANGLE,
    ANSWER,
    D_X,
    F_X,
    F_Y,
    MOTION,
    SPEED,
    V_X,
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
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, X_0, U


class Ports(NamedTuple):
    """The k ports of a machine. addresses: (k,) of their laws; places: (k, 2, n) and counts (k,), see Port; lengths:
    (k,) m; first: (k + 1, 2) of the parameters and memories of each in numbers and memory; motion, answer: of the call
    of a law; missed: (2 k,) by how much the forces differ from those that Newton's method has used, N."""

    addresses: Indices
    places: Array
    counts: Array
    lengths: Array
    first: Indices
    numbers: Array
    memory: Array
    motion: Array
    answer: Array
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
        np.zeros(MOTION),
        np.zeros(ANSWER),
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
    ports.motion[SPEED], ports.motion[ANGLE] = speed, angle


@compiled()
def _ask(ports: Ports, k: int, x: int, g: float, journal: Array) -> None:
    """The answer of port k, whose motion is columns x and x + 1 of the journal, at the velocities U."""
    for i in range(2):
        ports.motion[D_X + i] = journal[X_0, x + i] + g * journal[U, x + i]
        ports.motion[V_X + i] = journal[U, x + i]
    (a, c), (b, d) = (ports.first[k, 0], ports.first[k, 1]), (ports.first[k + 1, 0], ports.first[k + 1, 1])
    call_force(ports.addresses[k], b - a, d - c, ports.numbers[a:b], ports.memory[c:d], ports.motion, ports.answer)


@compiled_for(Ports)
def push_ports(ports: Ports, films: int, g: float, journal: Array) -> None:
    """Fill FORCE, BY_X, BY_Y of the ports, which follow so many films."""
    for k in range(ports.lengths.shape[0]):
        x = 2 * (films + k)
        y, out = x + 1, ports.answer
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
            ports.missed[2 * k + i] = ports.answer[F_X + i] - journal[FORCE, 2 * (films + k) + i]
    for i in range(compliance.shape[0]):
        moved, length = 0.0, clearances[i // 2] if i < 2 * films else ports.lengths[i // 2 - films]
        for j in range(ports.missed.shape[0]):
            moved += compliance[i, 2 * films + j] * ports.missed[j]
        left = max(left, g * abs(moved) / length)
    return left
