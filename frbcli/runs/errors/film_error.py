"""The error of the film forces of a run: solved again at states that the run has passed, on a finer mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.runs.control import control_of
from frbcli.runs.inputs import films_change
from frbcli.scene.machine.system import System
from frbcli.scene.planning.planned import Plan
from frbcli.solve.stage.contact import felt_motion
from frbcli.solve.state import Array

SMALL_FORCE, NO_FORCE = 0.1, 1e-9  # of the median one; of the largest one of a run, which counts as none
QUANTILE = 0.9  # quantile of the errors, weighted with the force


@dataclass(frozen=True)
class FilmErrors:
    """Errors and sizes of the forces of all films at sampled states of a run. times: (m,) s; errors, sizes: (m,) N."""

    times: Array
    errors: Array
    sizes: Array

    def relative(self, until: float = math.inf) -> float | None:
        """Relative error that 90 % of the force does not exceed, in states until a time in s; None without any.

        States are weighted with their force."""
        kept = self.times <= until
        errors, sizes = self.errors[kept], self.sizes[kept]
        if not len(errors) or sizes.max() <= NO_FORCE * self.sizes.max():  # a film that runs dry has no force at first
            return None
        # At states with a very small force, as at the start, the error is relative to the usual force.
        scales = np.maximum(sizes, SMALL_FORCE * float(np.median(sizes)))
        relative = errors / np.maximum(scales, NO_FORCE * float(sizes.max()))
        order = np.argsort(relative)
        carried = np.cumsum(sizes[order])
        return float(relative[order][np.searchsorted(carried, QUANTILE * carried[-1])])


def film_force_errors(plan: Plan, system: System, case: Case, times: Array, samples: Array) -> FilmErrors:
    """Errors of the film forces at sampled states, against the finite-length film on a finer mesh.

    times: (m,) s; samples: (m, 2 n + 1 or more) displacements, velocities, rotor speed in rad/s; where heat or inputs
    change films the last columns are clearances in m and scales of the films, see FilmNumbers: s times the scale gives
    the force of s times the velocities. For the short-bearing theory this is the error of the theory itself. In contact
    it is that of the film in the contact gap. Mass-conserving films are compared in their steady state; where there is
    none, they are left out.
    """
    forces = system.films.compared()
    if forces is None:
        return FilmErrors(*np.zeros((3, 0)))
    control, count, found = control_of(case, plan), len(system.names), []
    changing = films_change(case)
    every = max(1, len(samples) // (system.films.compared_states or len(samples) or 1))
    for t, sample in zip(times[::every], samples[::every], strict=True):
        for i, (at, rate, total) in enumerate(system.motions(sample)):
            clearance, scale = system.clearances[i], 1.0
            if changing:
                now, scale = (float(sample[column * count + i]) for column in (-2, -1))
                at, rate = at * clearance / now, rate * clearance / now
            if control.contact_stiffness > 0.0:
                at, rate = clearance * felt_motion(control, at / clearance, rate / clearance)
            if np.hypot(*at[:2]) >= LARGEST_ECCENTRICITY * clearance:
                continue
            try:
                exact, force = forces(i, at, scale * rate, scale * total)
            except NotConverged:
                continue
            found.append((float(t), float(np.hypot.reduce(force - exact)), float(np.hypot.reduce(exact))))
    table = np.array(found).reshape(-1, 3)
    return FilmErrors(table[:, 0], table[:, 1], table[:, 2])
