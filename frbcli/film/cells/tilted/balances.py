"""The oil balances of a land whose gap changes along the axis, for the solver of one film: the same as in the time
loop.

A land is a bearing of its own here: its journal has displacements at both ends of its width.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.film import VolumeFilm, VolumeSolution
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.tilted.kernel import ALL_SIDES, BY_ENDS, BY_ITSELF, EndsMotion, land_balances


def tilted_balances(
    parts: tuple[Any, Array, Array, Array], places: Array, motion: Motion, states: Array, past: Array, stencil: Array,
    flows: Array, g: float = 0.0,
) -> Array:  # fmt: skip
    """(m, k, 5) what leaves the cells of a land, and its derivatives by the velocity v and the growth of v over the
    width, which move the journal by g of themselves; stencil and flows <- as `balances` fills them.

    parts: record, ring, width and cells of a land, see VolumeFilms; places: see land_places."""
    own, ring, _, cells = parts
    m, k = past.shape
    right = np.empty((m, k, k + ALL_SIDES))
    d, v = (
        np.concatenate([np.subtract(middle, half), np.add(middle, half)])
        for middle, half in ((motion.d, 0.5 * np.array(motion.slope)), (motion.v, 0.5 * np.array(motion.slope_rate)))
    )
    at = EndsMotion(d, v, float(motion.omega), g, 0.0)
    land_balances(own, ring, cells, places, states, at, np.ascontiguousarray(past), stencil, right, flows)
    near, far = right[:, :, k + BY_ENDS : k + BY_ENDS + 2], right[:, :, k + BY_ENDS + 2 :]
    return -np.concatenate([right[:, :, [k + BY_ITSELF]], near + far, 0.5 * (far - near)], axis=2)


def tilted_outflow(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> float:
    """Outflow of a solution through the open ends of a section in m^3/s."""
    section = film.section
    balance = CellBalances(section, film.grid, motion, solution.before)
    fluxes, _, _ = balance.fluxes(film.pressure(solution.state), solution.state.fraction)
    ends = fluxes.near if section.far == "groove" else np.concatenate([fluxes.near, fluxes.far])
    unit = section.radius * section.width * section.clearance
    return unit * float(np.maximum(ends, 0.0).sum())
