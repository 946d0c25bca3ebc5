"""Rough surfaces in the time loop, compiled: the summits of journals and shells beside their films.

Whether a machine has any is decided by the type of `Control.rough` when the loop is compiled: between smooth surfaces
it is empty, and nothing is computed.
"""

from __future__ import annotations

from typing import NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import compiled_for
from frbcli.film.roughness.asperities import APART, Asperities, Rub, rub
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, X_0, U
from frbcli.solve.state import SLIP, SUM

SLIDES, SHELL = range(2)  # omega_J - omega_S, and omega_S


class RoughContact(NamedTuple):
    """surfaces: of all films; speeds: (films, 2) rad/s, which the loop writes, see SLIDES."""

    surfaces: Asperities
    speeds: Array


@compiled_for(RoughContact)
def set_sliding(rough: RoughContact, turning: Array, bodies: Array) -> None:
    """Speeds of the surfaces of all films by those of the rotor and the rings (1 + rings,)."""
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
    x, y, found = 2 * f, 2 * f + 1, rubbing(rough, f, clearance, g, journal)
    journal[FORCE, x] += found.f_x
    journal[FORCE, y] += found.f_y
    journal[BY_X, x] += found.d_xx + g * found.k_xx
    journal[BY_Y, x] += found.d_xy + g * found.k_xy
    journal[BY_X, y] += found.d_yx + g * found.k_yx
    journal[BY_Y, y] += found.d_yy + g * found.k_yy


@compiled_for(RoughContact, 0.0)
def sharpness(rough: RoughContact, clearance: float) -> float:
    """How sharply the force of summits bends, over the clearance: 1 / roughness; 0 between smooth surfaces."""
    return clearance / rough.surfaces.roughness
