"""The steady state of one film for a motion, with the error of its force from a mesh twice as coarse."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.film.cavitation.law import Law
from frbcli.film.cells.grid import fitted_grid
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.cells.plain.film import VolumeFilm, VolumeSolution, reference_pressure
from frbcli.film.cells.plain.loads import CavitationFactor, Loads, estimate, loads
from frbcli.film.gap import Section

AROUND, ALONG = 128, 32  # cells of a whole film, which hold the force to about 3e-3


@dataclass(frozen=True)
class SteadyFilm:
    """A steady film: its solution and loads, and the relative error of its force."""

    film: VolumeFilm
    solution: VolumeSolution
    loads: Loads
    force_error: float
    iterations: int


def steady_film(
    section: Section,
    law: Law,
    motion: Motion,
    around: int = AROUND,
    along: int = ALONG,
    slip: float | None = None,
    factor: CavitationFactor = "none",
) -> SteadyFilm:
    """Solve on half the cells each way, and from there on all.

    around, along: cells of a whole film; one cut at its plane of symmetry gets half of those along; slip:
    omega_J - omega_S in rad/s, else that of a shell at rest; factor: of the torque. Raises NotConverged.
    """
    along = along // 2 if section.far == "symmetry" else along
    reference = reference_pressure(section, motion)
    coarse = VolumeFilm(section, fitted_grid(section, motion.d, around // 2, along // 2), law, reference)
    first = coarse.steady(motion)
    film = VolumeFilm(section, fitted_grid(section, motion.d, around, along), law, reference)
    solution = film.steady(motion, film.from_coarser(coarse, first.w))
    fine = loads(film, motion, solution, slip, factor)
    error = estimate(fine.force, loads(coarse, motion, first).force, law.order)
    return SteadyFilm(film, solution, fine, error, first.iterations + solution.iterations)
