"""The weak form of (4.31) in array notation: what assembly.py must equal, and where the oil of a solution goes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.film.grid import Array
from frbcli.film.published.equations.assembly import EDGE_VALUES, EDGE_WEIGHTS, GAMMA, PECLET, Elements, Gap

AROUND_DIRECTION, ALONG_DIRECTION = 0, 1


@dataclass(frozen=True)
class Terms:
    """Terms of each element by its nodes' shape functions: pressed, spread (e, 9): pressure flow, artificial diffusion;
    stored, carried (e, 9): d(H theta)/dt, omega/2 d(H theta)/dphi; near, far (e, 3): outflow through ends free to air
    by the nodes 3 i and 3 i + 2."""

    pressed: Array
    spread: Array
    stored: Array
    carried: Array
    near: Array
    far: Array

    @property
    def residual(self) -> Array:
        """(e, 9) the weak form, fixed nodes included."""
        total = self.pressed + self.spread + self.stored + self.carried
        total[:, 0::3] += self.near
        total[:, 2::3] += self.far
        return total


def terms(elements: Elements, gap: Gap, pressure: Array, theta: Array, slope: Array, change: Array) -> Terms:
    """The terms at scaled gauge pressures (nodes,) of the nodes.

    theta, slope: oil fraction and its derivative by the scaled pressure at the points; change: dtheta/dt there, (e, 9)
    each. Grooves and holes have only what the surfaces carry through them.
    """
    nodes = pressure[elements.nodes]
    rise = np.einsum("eqad,ea->eqd", elements.slopes, nodes)
    around, along = rise[..., AROUND_DIRECTION], rise[..., ALONG_DIRECTION]
    cube, film = gap.height**3, np.where(elements.solid, 0.0, 1.0)[:, None]
    extra = np.zeros_like(cube)
    if elements.spread >= 0.0:
        speed = abs(gap.half) * gap.height * slope
        peclet = 0.5 * elements.length[:, None] * speed / cube
        extra = GAMMA * elements.length[:, None] * speed * peclet / np.sqrt(PECLET**2 + peclet**2)
    flow = np.stack([cube * around, elements.aspect * cube * along], axis=-1)
    diffusion = np.stack([extra * around, elements.spread * extra * along], axis=-1)
    area = elements.area * film
    carried = gap.half * (gap.height * slope * around + theta * gap.slope)
    stored = gap.height * change + theta * gap.rate
    return Terms(
        np.einsum("eq,eqad,eqd->ea", area, elements.slopes, flow),
        np.einsum("eq,eqad,eqd->ea", area, elements.slopes, diffusion),
        np.einsum("eq,qa,eq->ea", area, elements.values, stored),
        np.einsum("eq,qa,eq->ea", elements.area, elements.values, carried),
        _outflow(elements, nodes[:, 0::3], elements.near),
        _outflow(elements, nodes[:, 2::3], elements.far),
    )


def _outflow(elements: Elements, pressure: Array, open_end: NDArray[np.bool_]) -> Array:
    """(e, 3) of (4.36), (4.37) by the nodes with the pressures (e, 3)."""
    outflow = np.zeros((len(pressure), len(EDGE_WEIGHTS)))
    outflow[open_end] = elements.prefactor * np.exp(elements.exponent * (pressure[open_end] @ EDGE_VALUES.T))
    return np.asarray(elements.length[:, None] * (outflow * EDGE_WEIGHTS) @ EDGE_VALUES, dtype=np.float64)
