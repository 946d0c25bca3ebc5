"""The error of the film forces of a run: solved again at states that the run has passed, on a finer mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.loads import force
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.steady_force import steady_solution
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.grid import Mesh
from frbcli.film.published.film import PublishedFilm, published_force
from frbcli.film.rectangles.film import evaluate
from frbcli.film.rectangles.untabulated import direct_force
from frbcli.runs.control import control_of
from frbcli.scene.bearing_models import GIVEN
from frbcli.scene.cell_choice import compared_states
from frbcli.scene.film_choice import NO_FILM
from frbcli.scene.films import film_places, volume_film
from frbcli.scene.planned import Plan
from frbcli.scene.system import System, planned_film, published_film
from frbcli.solve.contact import felt_motion
from frbcli.solve.state import Array

SAMPLES = 48  # states of a run
PUBLISHED_SAMPLES = 6  # in the published form, where a steady film takes hundreds of assemblies
RICHARDSON = 3.0  # an error of second order on twice the elements, from the difference to it
COMPARED = 192  # states at which a run is compared with one on fewer cells
FINER = 2  # elements more in each direction
SMALL_FORCE = 0.1  # of the median one
QUANTILE = 0.9  # quantile of the errors, weighted with the force


@dataclass(frozen=True)
class FilmErrors:
    """Of the forces of all films at sampled states of a run. times: (m,) s; errors, sizes: (m,) N."""

    times: Array
    errors: Array
    sizes: Array

    def relative(self, until: float = math.inf) -> float | None:
        """Relative error that 90 % of the force does not exceed, in states until a time in s; None without any.

        States are weighted with their force."""
        kept = self.times <= until
        errors, sizes = self.errors[kept], self.sizes[kept]
        if not len(errors) or sizes.max() == 0.0:
            return None
        # At states with a very small force, as at the start, the error is relative to the usual force.
        scales = np.maximum(sizes, SMALL_FORCE * float(np.median(sizes)))
        relative = errors / np.maximum(scales, np.finfo(float).tiny)
        order = np.argsort(relative)
        carried = np.cumsum(sizes[order])
        return float(relative[order][np.searchsorted(carried, QUANTILE * carried[-1])])


def sample_count(plan: Plan) -> int:
    """How many states of a run are kept."""
    return SAMPLES if plan.cells is None else COMPARED


def film_force_errors(plan: Plan, system: System, case: Case, times: Array, samples: Array) -> FilmErrors:
    """Errors of the film forces at sampled states, against the finite-length film on a finer mesh.

    times: (m,) s; samples: (m, 2 n + 1 or more) displacements, velocities, rotor speed in rad/s; with heat the last
    columns are clearances in m and scales of the films, see FilmNumbers: s times the scale gives the force of s times
    the velocities. For the short-bearing theory this is the error of the theory itself. In contact it is that of the
    film in the contact gap. Mass-conserving films are compared in their steady state; where there is none, they are
    left out.
    """
    if plan.form in (GIVEN, NO_FILM):  # a bearing model has no mesh
        return FilmErrors(*np.zeros((3, 0)))
    if system.published is not None:
        forces = _published_forces(system.published, case)
    elif plan.cells is not None:
        forces = _cell_forces(plan, system, case)
    else:
        forces = _source_forces(plan, system) if system.solved else _closed_forces(plan, system)
    control, n, count, found = control_of(case, plan), system.rotor.size, len(system.names), []
    every = 1
    if plan.cells is not None:  # each has to settle
        most = compared_states(plan.cells) if system.published is None else PUBLISHED_SAMPLES
        every = max(1, len(samples) // most)
    for t, sample in zip(times[::every], samples[::every], strict=True):
        q, v, omega = sample[:n], sample[n : 2 * n], float(sample[2 * n])
        omegas = system.omegas(omega, v[list(system.spins)])
        for i, selection in enumerate(system.rotor.journals):
            at, rate, clearance, scale = selection @ q, selection @ v, system.clearances[i], 1.0
            if case.heat is not None:
                now, scale = (float(sample[column * count + i]) for column in (-2, -1))
                at, rate = at * clearance / now, rate * clearance / now
            if control.contact_stiffness > 0.0:
                at, rate = clearance * felt_motion(control, at / clearance, rate / clearance)
            if np.hypot(*at) >= LARGEST_ECCENTRICITY * clearance:
                continue
            try:
                exact, force = forces(i, at, scale * rate, scale * float(omegas[i]))
            except NotConverged:
                continue
            found.append((float(t), float(np.hypot(*(force - exact))), float(np.hypot(*exact))))
    table = np.array(found).reshape(-1, 3)
    return FilmErrors(table[:, 0], table[:, 1], table[:, 2])


Forces = Callable[[int, Array, Array, float], tuple[Array, Array]]


def _closed_forces(plan: Plan, system: System) -> Forces:
    """Exact and own force of a film without cells."""
    finer = Mesh(FINER * plan.mesh.axial, FINER * plan.mesh.circumferential)
    # Films between axial grooves have no table: the same film on the finer mesh is the reference.
    fine = [
        planned_film(plan, bearing, law, finer) if bearing.grooves else None
        for bearing, law in zip(system.bearings, system.laws, strict=True)
    ]

    def forces(i: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        bearing, better = system.bearings[i], fine[i]
        if better is None:
            exact = direct_force(bearing, system.laws[i], finer, at, rate, omega)
        else:
            exact = evaluate(better, bearing.clearance, at, rate, omega).force
        return exact, system.film_force(i, at, rate, omega).force

    return forces


def _source_forces(plan: Plan, system: System) -> Forces:
    """Force on a finer mesh and tabulated force of a film that is not mass-conserving."""
    finer = Mesh(FINER * plan.mesh.axial, FINER * plan.mesh.circumferential)
    fine = [replace(film, mesh=finer) for film in system.solved]

    def forces(i: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        return fine[i].force(at, rate, omega), system.film_force(i, at, rate, omega).force

    return forces


def _published_forces(own: PublishedFilm, case: Case) -> Forces:
    """Own force of a film in the published form, and as far from it as half as many elements each way tell."""
    coarse = published_film(case, own.section, (max(3, own.mesh.around // 2), max(1, own.mesh.along // 2)))

    def forces(_: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        fine = published_force(own, at, rate, omega).force
        difference = published_force(coarse, at, rate, omega).force - fine
        return fine, fine + difference / RICHARDSON

    return forces


def _cell_forces(plan: Plan, system: System, case: Case) -> Forces:
    """Force on a finer mesh and own force of a finite-volume film in its steady state."""
    assert plan.cells is not None
    cells = FINER * plan.cells[0], FINER * plan.cells[1]
    fine = [volume_film(case, place, cells) for place in film_places(case)]

    def settled(film: VolumeFilm, at: Array, rate: Array, omega: float) -> Array:
        d, v = at / film.section.clearance, rate / film.section.clearance
        motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
        return np.array(force(film, film.mean_pressure(steady_solution(film, motion).state)))

    def forces(i: int, at: Array, rate: Array, omega: float) -> tuple[Array, Array]:
        return settled(fine[i], at, rate, omega), settled(system.volumes[i], at, rate, omega)

    return forces
