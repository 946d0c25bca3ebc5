"""The unknowns of the nodes, in which both the step theta(p) and the outflow of a free end are gentle.

w = theta - 1 + (p - p_cav) / reference, and above p_cav at a free end + (g(p) - g(p_cav)) / (A reference).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.compiled import compiled
from frbcli.film.cells.balance.ends import PREFACTOR, STEEPNESS
from frbcli.film.grid import Array
from frbcli.film.published.equations.law import Step, oil_fraction, step_pressure
from frbcli.film.published.mesh.quadratic import QuadraticMesh

SETTLED = 1e-14
MOST = 60


class Unknowns(NamedTuple):
    """fixed, free (nodes,): with a given pressure, and at ends free to air; given (nodes,): scaled gauge pressures;
    exponent: of g per scaled pressure; amount: g(p_cav) / A, 1/s; reference: scaled pressure in 1/s."""

    fixed: NDArray[np.bool_]
    free: NDArray[np.bool_]
    given: Array
    exponent: float
    amount: float
    reference: float


def make_unknowns(mesh: QuadraticMesh, fixed: NDArray[np.bool_], step: Step, reference: float) -> Unknowns:
    """The unknowns of a mesh with given pressures at its fixed nodes (nodes,)."""
    section = mesh.section
    free = np.zeros(mesh.phi.shape, dtype=bool)
    free[:, 0] = section.near == "free-to-air"
    free[:, -1] |= section.far == "free-to-air"
    exponent = STEEPNESS * section.pressure_scale / section.ambient_pressure
    amount = PREFACTOR * math.exp(exponent * step.cavitation) / section.aspect
    given = np.where(fixed, mesh.fixed_pressure.ravel(), 0.0)
    return Unknowns(fixed, free.ravel() & ~fixed, given, exponent, amount, reference)


@compiled(makes_arrays=True)
def unknowns_of(unknowns: Unknowns, step: Step, pressure: Array) -> Array:
    """(nodes,) unknowns of the pressures (nodes,) of the nodes."""
    w = np.empty_like(pressure)
    for n in range(len(w)):
        rise = pressure[n] - step.cavitation
        w[n] = oil_fraction(step, pressure[n])[0] - 1.0 + rise / unknowns.reference
        if unknowns.free[n] and rise > 0.0:
            w[n] += unknowns.amount / unknowns.reference * math.expm1(unknowns.exponent * rise)
    return w


def pressures_of(unknowns: Unknowns, step: Step, w: Array) -> tuple[Array, Array]:
    """(nodes,) scaled gauge pressures of the nodes and their derivatives by the unknowns, none where they are given."""
    pressure, slope = np.empty_like(w), np.empty_like(w)
    set_pressures_of(unknowns, step, w, unknowns.given, pressure, slope)
    return pressure, slope


@compiled()
def set_pressures_of(
    unknowns: Unknowns, step: Step, w: Array, given: Array, pressure: Array, slope: Array
) -> None:  # fmt: skip
    """pressure, slope (nodes,) <- pressures_of with other given pressures (nodes,)."""
    ratio = step.cavity / unknowns.reference
    amount = unknowns.amount / unknowns.reference
    for n in range(len(w)):
        if unknowns.fixed[n]:
            pressure[n], slope[n] = given[n], 0.0
            continue
        pressure[n], slope[n] = step_pressure(step, ratio, w[n])
        if unknowns.free[n] and w[n] > 0.0:
            # w = u / slope + amount (exp(c u) - 1): Wright's omega function of `reach`, by Newton's method
            c, full = unknowns.exponent, slope[n]
            reach = math.log(c * amount * full) + c * (w[n] + amount) * full
            omega = _wright(reach)
            pressure[n] = step.cavitation + (w[n] + amount) * full - omega / c
            slope[n] = full / (1.0 + omega)


@compiled()
def _wright(z: float) -> float:
    """omega with omega + log(omega) = z."""
    y = z if z < 1.0 else math.log(z)
    for _ in range(MOST):
        power = math.exp(y)
        change = (power + y - z) / (power + 1.0)
        y -= change
        if abs(change) < SETTLED * (1.0 + abs(y)):
            break
    return math.exp(y)
