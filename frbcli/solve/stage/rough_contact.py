"""Rough surfaces in the time loop, compiled: the summits of journals and shells beside their films.

Whether a machine has any is decided by the type of `Control.rough` when the loop is compiled: between smooth surfaces
it is empty, and nothing is computed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.extending import overload

from frbcli.compiled import AS_KERNELS, Array, compiled
from frbcli.film.roughness.asperities import APART, Asperities, Rub, rub
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, X_0, U
from frbcli.solve.state import SLIP, SUM

SLIDES, SHELL = range(2)  # omega_J - omega_S, and omega_S


class RoughContact(NamedTuple):
    """surfaces: of all films; speeds: (films, 2) rad/s, which the loop writes, see SLIDES."""

    surfaces: Asperities
    speeds: Array


def _rough(rough: Any) -> bool:
    """Whether a type that the compiler knows is that of rough surfaces."""
    return getattr(rough, "instance_class", None) is RoughContact


def set_sliding(rough: Any, turning: Array, bodies: Array) -> None:
    """Speeds of the surfaces of all films by those of the rotor and the rings (1 + rings,)."""
    raise NotImplementedError


def press(rough: Any, f: int, clearance: float, g: float, journal: Array) -> None:
    """Add the summits of film f to FORCE, BY_X, BY_Y of its journal."""
    raise NotImplementedError


def rubbing(rough: Any, f: int, clearance: float, g: float, journal: Array) -> Rub:
    """What the summits of film f do at the velocities U."""
    raise NotImplementedError


def sharpness(rough: Any, clearance: float) -> float:
    """How sharply the force of summits bends, over the clearance: 1 / roughness; 0 between smooth surfaces."""
    raise NotImplementedError


@compiled()
def _set_sliding(rough: RoughContact, turning: Array, bodies: Array) -> None:
    for f in range(turning.shape[0]):
        total, slip = 0.0, 0.0
        for b in range(bodies.shape[0]):
            total += turning[f, SUM, b] * bodies[b]
            slip += turning[f, SLIP, b] * bodies[b]
        rough.speeds[f, SLIDES], rough.speeds[f, SHELL] = slip, 0.5 * (total - slip)


@compiled()
def _rubbing(rough: RoughContact, f: int, clearance: float, g: float, journal: Array) -> Rub:
    x, y = 2 * f, 2 * f + 1
    return rub(
        rough.surfaces, f, clearance, journal[X_0, x] + g * journal[U, x], journal[X_0, y] + g * journal[U, y],
        journal[U, x], journal[U, y], rough.speeds[f, SLIDES], rough.speeds[f, SHELL],
    )  # fmt: skip


@compiled()
def _press(rough: RoughContact, f: int, clearance: float, g: float, journal: Array) -> None:
    x, y, found = 2 * f, 2 * f + 1, _rubbing(rough, f, clearance, g, journal)
    journal[FORCE, x] += found.f_x
    journal[FORCE, y] += found.f_y
    journal[BY_X, x] += found.d_xx + g * found.k_xx
    journal[BY_Y, x] += found.d_xy + g * found.k_xy
    journal[BY_X, y] += found.d_yx + g * found.k_yx
    journal[BY_Y, y] += found.d_yy + g * found.k_yy


@overload(set_sliding, jit_options=AS_KERNELS, inline="always")
def _set(rough, turning, bodies):  # type: ignore[no-untyped-def]
    if _rough(rough):
        return lambda rough, turning, bodies: _set_sliding(rough, turning, bodies)
    return lambda rough, turning, bodies: None


@overload(press, jit_options=AS_KERNELS, inline="always")
def _presses(rough, f, clearance, g, journal):  # type: ignore[no-untyped-def]
    if _rough(rough):
        return lambda rough, f, clearance, g, journal: _press(rough, f, clearance, g, journal)
    return lambda rough, f, clearance, g, journal: None


@overload(rubbing, jit_options=AS_KERNELS, inline="always")
def _rubs(rough, f, clearance, g, journal):  # type: ignore[no-untyped-def]
    if _rough(rough):
        return lambda rough, f, clearance, g, journal: _rubbing(rough, f, clearance, g, journal)
    return lambda rough, f, clearance, g, journal: APART


@overload(sharpness, jit_options=AS_KERNELS, inline="always")
def _bends(rough, clearance):  # type: ignore[no-untyped-def]
    if _rough(rough):
        return lambda rough, clearance: clearance / rough.surfaces.roughness
    return lambda rough, clearance: 0.0
