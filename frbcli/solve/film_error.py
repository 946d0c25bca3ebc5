"""The error of the film forces of a run: solved again at states that the run has passed, on a finer mesh."""

from __future__ import annotations

import numpy as np

from frbcli.film.bearing import evaluate
from frbcli.film.direct import direct_force
from frbcli.film.table import LARGEST_ECCENTRICITY, Mesh
from frbcli.scene.plan import Plan
from frbcli.scene.system import System, planned_film
from frbcli.solve.state import Array

SAMPLES = 48  # states of a run
FINER = 2  # elements more in each direction
QUANTILE = 0.9  # of the errors: what nearly all states stay below


def film_force_error(plan: Plan, system: System, samples: Array) -> float | None:
    """Relative error of the film forces at the sampled states, against the finite-length film on a finer mesh.

    samples: (m, 2 n + 1) displacements, velocities and rotor speed in rad/s. The largest of the lower QUANTILE is
    returned; None without samples. For the short-bearing theory this is the error of the theory itself.
    """
    finer = Mesh(FINER * plan.mesh.axial, FINER * plan.mesh.circumferential)
    n = system.rotor.size
    errors = []
    # Between axial grooves nothing is tabulated: the same film on the finer mesh is the direct solution.
    fine = [planned_film(plan, bearing, finer) if bearing.grooves else None for bearing in system.bearings]
    for sample in samples:
        q, v, omega = sample[:n], sample[n : 2 * n], float(sample[2 * n])
        for pick, film, bearing, better in zip(
            system.rotor.journals, system.films, system.bearings, fine, strict=True
        ):
            at, rate = pick @ q, pick @ v
            if np.hypot(*at) >= LARGEST_ECCENTRICITY * bearing.clearance:
                continue
            if better is None:
                exact = direct_force(bearing, plan.cavitation, finer, at, rate, omega)
            else:
                exact = evaluate(better, bearing.clearance, at, rate, omega).force
            force = evaluate(film, bearing.clearance, at, rate, omega).force
            if (size := float(np.hypot(*exact))) > 0.0:
                errors.append(float(np.hypot(*(force - exact))) / size)
    return float(np.quantile(errors, QUANTILE)) if errors else None
