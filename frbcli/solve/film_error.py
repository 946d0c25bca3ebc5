"""The error of the film forces of a run: solved again at states that the run has passed, on a finer mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.balance import Motion
from frbcli.film.bearing import evaluate
from frbcli.film.direct import direct_force
from frbcli.film.loads import force
from frbcli.film.steady_force import steady_solution
from frbcli.film.table import LARGEST_ECCENTRICITY, Mesh
from frbcli.film.volumes import VolumeFilm
from frbcli.scene.films import film_places, volume_film
from frbcli.scene.plan import Plan
from frbcli.scene.system import System, planned_film
from frbcli.solve.state import Array

SAMPLES = 48  # states of a run
CELL_SAMPLES = 16  # of them for films with cells, which have to settle at each
FINER = 2  # elements more in each direction
SMALL_FORCE = 0.1  # of the median one
QUANTILE = 0.9  # of the errors: what nearly all states stay below


def film_force_error(plan: Plan, system: System, case: Case, samples: Array) -> float | None:
    """Relative error of the film forces at the sampled states, against the finite-length film on a finer mesh.

    samples: (m, 2 n + 1) displacements, velocities and rotor speed in rad/s. The largest of the lower QUANTILE is
    returned; None without samples. For the short-bearing theory this is the error of the theory itself. Films with oil
    of their own are compared in states in which it has settled.
    """
    forces = _cell_forces(plan, system, case) if plan.cells is not None else _closed_forces(plan, system)
    n, errors, sizes = system.rotor.size, [], []
    for sample in samples if plan.cells is None else samples[:: max(1, len(samples) // CELL_SAMPLES)]:
        q, v, omega = sample[:n], sample[n : 2 * n], float(sample[2 * n])
        omegas = system.omegas(omega, v[list(system.spins)])
        for i, pick in enumerate(system.rotor.journals):
            at, rate = pick @ q, pick @ v
            if np.hypot(*at) >= LARGEST_ECCENTRICITY * system.clearances[i]:
                continue
            try:
                exact, force = forces(i, at, rate, float(omegas[i]))
            except NotConverged:
                continue
            errors.append(float(np.hypot(*(force - exact))))
            sizes.append(float(np.hypot(*exact)))
    if not errors or max(sizes) == 0.0:
        return None
    # A film that carries next to nothing for a moment, as at the start, is held to what it carries otherwise.
    least = SMALL_FORCE * float(np.median(sizes))
    relative = [error / max(size, least) for error, size in zip(errors, sizes, strict=True) if max(size, least) > 0.0]
    return float(np.quantile(relative, QUANTILE))


Forces = Callable[[int, Array, Array, float], tuple[Array, Array]]


def _closed_forces(plan: Plan, system: System) -> Forces:
    """Exact and own force of a film without cells."""
    finer = Mesh(FINER * plan.mesh.axial, FINER * plan.mesh.circumferential)
    # Between axial grooves nothing is tabulated: the same film on the finer mesh is the direct solution.
    fine = [planned_film(plan, bearing, finer) if bearing.grooves else None for bearing in system.bearings]

    def forces(i: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        bearing, better = system.bearings[i], fine[i]
        if better is None:
            exact = direct_force(bearing, plan.cavitation, finer, at, rate, omega)
        else:
            exact = evaluate(better, bearing.clearance, at, rate, omega).force
        return exact, system.film_force(i, at, rate, omega).force

    return forces


def _cell_forces(plan: Plan, system: System, case: Case) -> Forces:
    """Fine and own force of a film with cells that has settled."""
    assert plan.cells is not None
    cells = FINER * plan.cells[0], FINER * plan.cells[1]
    fine = [volume_film(case, place.geometry, cells)[0] for place in film_places(case)]

    def settled(film: VolumeFilm, at: Array, rate: Array, omega: float) -> Array:
        d, v = at / film.section.clearance, rate / film.section.clearance
        motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
        return np.array(force(film, film.pressure(steady_solution(film, system.follows, motion).state)))

    def forces(i: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        return settled(fine[i], at, rate, omega), settled(system.volumes[i], at, rate, omega)

    return forces
