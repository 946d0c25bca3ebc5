"""The same films plainly: scikit-fem assembly, sparse direct solves. Slow and easy to read; tests compare both."""

from __future__ import annotations

from typing import Any

import numpy as np

from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.law import Scales
from frbcli.film.cavitation.penalty import PREFACTOR, Penalty, steepness_exponent
from frbcli.film.gap import Section, gap_height
from frbcli.film.grid import Array
from frbcli.film.quadratic.film import Cavitation, PenaltyReading
from frbcli.film.quadratic.mesh import quadratic_mesh, unrolled_basis

ITERATIONS, TOLERANCE = 60, 1e-10


class PlainQuadraticFilm:
    """One section on quadratic elements; constant but for `unknown`, where the next Newton iteration begins."""

    def __init__(
        self, section: Section, cavitation: Cavitation, around: int, along: int, reading: PenaltyReading = "absolute"
    ) -> None:
        from scipy.sparse import csr_matrix

        self.section, self.cavitation, self.reading = section, cavitation, reading
        mesh = quadratic_mesh(section, around, along)
        self.fixed, self.given = mesh.fixed.ravel(), mesh.fixed_pressure.ravel()
        phi = np.vstack([mesh.phi, mesh.phi[:1] + 2.0 * np.pi])
        self.basis, order = unrolled_basis(phi, np.vstack([mesh.z, mesh.z[:1]]))
        size = len(self.given)
        columns = np.mod(order, size)  # the last line is the first one
        self.join = csr_matrix((np.ones(len(order)), (np.arange(len(order)), columns)), (len(order), size))
        self.angle = np.asarray(self.basis.global_coordinates())[0]
        self.level = (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale
        self.area = self.join.T @ _forms()[2].assemble(self.basis)
        self.unknown = np.zeros(size)

    def force(self, d: tuple[float, float], v: tuple[float, float], omega: float) -> Array:
        """(2,) force of the whole bearing on the journal in N; d, v: over the clearance."""
        section = self.section
        stiffness, motion, _ = _forms()
        w = (v[0] + 0.5 * omega * d[1], v[1] - 0.5 * omega * d[0])
        gap = gap_height(section, d, self.angle)
        depth = gap_height(section, (0.0, 0.0), self.angle)
        matrix = self.join.T @ stiffness.assemble(self.basis, cube=gap**3, aspect=section.aspect) @ self.join
        load = self.join.T @ motion.assemble(self.basis, w_x=w[0], w_y=w[1], wedge=0.5 * omega * depth)
        if self.cavitation == "penalty":
            pressure = self._with_source(matrix, load, float(np.hypot(*d)), omega)
        else:
            pressure = self.given + self._solved(matrix, load - matrix @ self.given)
        carried = np.asarray(self.basis.interpolate(self.join @ pressure))
        if self.cavitation == "half-sommerfeld":
            carried = np.maximum(carried - self.level, 0.0)  # the level itself carries nothing all around
        scale = section.copies * section.radius * section.width * section.pressure_scale
        carried = scale * carried * self.basis.dx
        return np.array([np.sum(carried * np.sin(self.angle)), -np.sum(carried * np.cos(self.angle))])

    def _solved(self, matrix: Any, right: Array) -> Array:
        from scipy.sparse.linalg import spsolve

        free = np.flatnonzero(~self.fixed)
        solution = np.zeros(len(right))
        solution[free] = spsolve(matrix[free][:, free].tocsc(), right[free])
        return solution

    def _with_source(self, matrix: Any, load: Array, eccentricity: float, omega: float) -> Array:
        """Pressure with the penalty at the nodes, by Newton's method from the last solution."""
        from scipy.sparse import diags

        section, exponent = self.section, steepness_exponent(eccentricity)
        law = Penalty(PREFACTOR, exponent * section.pressure_scale / section.ambient_pressure)
        if self.reading == "dimensionless":
            law = Penalty(0.5 * PREFACTOR * abs(omega), 2.0 * exponent / abs(omega))
        scales = Scales(1.0, self.level, section.ambient_pressure / section.pressure_scale)
        for _ in range(ITERATIONS):
            state = law.cells(self.unknown, scales)
            pressure = np.where(self.fixed, self.given, state.pressure)
            right = load - matrix @ pressure + self.area * state.source
            step = self._solved(matrix + diags(self.area * law.steepness * state.source), right)
            change = np.where(self.fixed, 0.0, step / state.pressure_slope)
            self.unknown = self.unknown + change
            if np.max(np.abs(change)) <= TOLERANCE * np.max(np.abs(self.unknown)):
                return np.asarray(pressure + step, dtype=np.float64)
        raise FilmUnsolved("Newton's method does not end for the penalty model")


def _forms() -> tuple[Any, Any, Any]:
    """Poiseuille's flow, what drives it, and area."""
    from skfem import BilinearForm, LinearForm

    @BilinearForm
    def stiffness(p, q, s):  # type: ignore[no-untyped-def]
        return s.cube * (p.grad[0] * q.grad[0] + s.aspect * p.grad[1] * q.grad[1])

    @LinearForm
    def motion(q, s):  # type: ignore[no-untyped-def]
        return s.wedge * q.grad[0] - (s.w_x * np.sin(s.x[0]) - s.w_y * np.cos(s.x[0])) * q  # (4.5)

    @LinearForm
    def area(q, _):  # type: ignore[no-untyped-def]
        return 1.0 * q

    return stiffness, motion, area
