"""One film at one moment: pressure, oil fraction, loads and oil balance of a planned kinematic test."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.bearing_tests.plan import KinematicPlan, law_at
from frbcli.case.schema import Case
from frbcli.film.cells.plain.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.plain.loads import Loads, estimate
from frbcli.film.cells.plain.steady import steady_film
from frbcli.film.rectangles.table import Mesh
from frbcli.film.rectangles.untabulated import direct_force, largest_pressure

Array = NDArray[np.float64]

MODAL_MESH, COARSE_MODAL_MESH = Mesh(10, 192), Mesh(5, 96)


@dataclass(frozen=True)
class FilmField:
    """A section on its cells. phi: (m,) rad, z: (k,) over the section's width, their middles; gap: (m,) H; pressure:
    (m, k) Pa absolute; fraction: (m, k) of oil."""

    phi: Array
    z: Array
    gap: Array
    pressure: Array
    fraction: Array


@dataclass(frozen=True)
class FilmMoment:
    """A film at one moment: its field, None of a bearing model, the loads on the whole bearing, the estimated relative
    error of the force, and what it took."""

    field: FilmField | None
    loads: Loads
    force_error: float
    unknowns: int
    iterations: int


def film_moment(case: Case, plan: KinematicPlan, motion: Motion, cells: tuple[int, int]) -> FilmMoment:
    """The film for a motion that lasts. Raises NotConverged."""
    law = law_at(case, plan, math.hypot(*motion.d))
    found = steady_film(plan.section, law, motion, *cells, factor=case.film.cavitation_factor)
    loads, error = found.loads, found.force_error
    if plan.rectangle is not None and plan.modal:
        place, velocity = _si(plan, motion)
        force = modal_force(plan, motion)
        coarse = modal_force(plan, motion, COARSE_MODAL_MESH)
        top = largest_pressure(plan.rectangle, MODAL_MESH, place, velocity, motion.omega)
        loads, error = replace(loads, force=force, p_max=top), estimate(force, coarse)
    unknowns = int(np.count_nonzero(~found.film.grid.fixed))
    return FilmMoment(film_field(found.film, motion, found.solution), loads, error, unknowns, found.iterations)


def film_force(case: Case, plan: KinematicPlan, motion: Motion, cells: tuple[int, int]) -> Array:
    """(2,) force in N on the journal by the whole bearing. Raises NotConverged."""
    if plan.modal:
        return np.array(modal_force(plan, motion))
    law = law_at(case, plan, math.hypot(*motion.d))
    return np.array(steady_film(plan.section, law, motion, *cells).loads.force)


def modal_force(plan: KinematicPlan, motion: Motion, mesh: Mesh = MODAL_MESH) -> tuple[float, float]:
    """The same of a rectangular gap without a state, by the accurate modal film."""
    assert plan.rectangle is not None
    place, velocity = _si(plan, motion)
    force = direct_force(plan.rectangle, plan.cavitation, mesh, place, velocity, motion.omega)
    return float(force[0]), float(force[1])


def film_field(film: VolumeFilm, motion: Motion, solution: VolumeSolution) -> FilmField:
    """Absolute pressures, as the loads are taken from them, and oil fractions of a solution."""
    grid, section = film.grid, film.section
    pressure = section.ambient_pressure + section.pressure_scale * film.pressure(solution.state)
    return FilmField(grid.centre, grid.height, film.gap(motion.d, grid.centre), pressure, solution.state.fraction)


def pressure_at(field: FilmField, phi: float, z: float) -> float:
    """Pressure in Pa at an angle and an axial position over the section's width, linear between the cells' middles."""
    angles = np.append(field.phi, field.phi[0] + 2.0 * math.pi)
    turned = field.phi[0] + (phi - field.phi[0]) % (2.0 * math.pi)
    i = min(int(np.searchsorted(angles, turned, side="right")) - 1, len(field.phi) - 1)
    share = (turned - angles[i]) / (angles[i + 1] - angles[i])
    line = (1.0 - share) * field.pressure[i] + share * field.pressure[(i + 1) % len(field.phi)]
    return float(np.interp(z, field.z, line))


def _si(plan: KinematicPlan, motion: Motion) -> tuple[Array, Array]:
    clearance = plan.section.clearance
    return clearance * np.array(motion.d), clearance * np.array(motion.v)
