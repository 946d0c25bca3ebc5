"""A film on quadratic elements with the published two-phase form (4.31), steady or over one step in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from frbcli.errors import FilmUnsolved, NotConverged
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.motion import Motion
from frbcli.film.gap import Section, gap_height, gap_rate
from frbcli.film.grid import Array
from frbcli.film.published.equations.assembly import Gap
from frbcli.film.published.equations.law import Step, make_step
from frbcli.film.published.mesh.elements import Diffusion, force_weights, lobe_slope, make_elements
from frbcli.film.published.mesh.quadratic import quadratic_mesh
from frbcli.film.published.newton import NONE, Equations, Newton, Point
from frbcli.film.published.solution import ForceResponse, NodeState, PublishedSolution
from frbcli.film.rectangles.film import FilmForce

AROUND, ALONG = 20, 10  # elements of a section, figure 6.2

MOST_HALVINGS = 5  # of a step in time
# Residual over the sum of its terms that is put up with where no correction makes it smaller: a steep step leaves each
# point of an element either full or cavitated, and then an exact solution need not exist. The force hardly feels it.
TOLERATED = 1e-2


class PublishedFilm:
    """A section on quadratic elements. Constant but for the room that its equations are solved in."""

    def __init__(
        self,
        section: Section,
        law: TwoPhase,
        diffusion: Diffusion = "consistent",
        around: int = AROUND,
        along: int = ALONG,
    ) -> None:
        """around (>= 3), along: elements."""
        self.section, self.law, self._diffusion = section, law, diffusion
        self.mesh = quadratic_mesh(section, around, along)
        self.ambient = section.ambient_pressure / section.pressure_scale
        self.cavitation = (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale
        self.cavity = self.cavitation + self.ambient  # the same, absolute
        self.elements = make_elements(self.mesh, diffusion)
        # (2 a, 2 k + 1, 2) force on the journal by the whole bearing per scaled pressure of a node, N s
        scale = section.copies * section.radius * section.width * section.pressure_scale
        self.weights = scale * force_weights(self.mesh)
        self.step_law = self._step(law.steepness)
        self._newton = Newton(self.mesh, self.elements, self.step_law)

    def coarser(self) -> PublishedFilm:
        """The film on half as many elements each way, as far as there are so many."""
        elements = max(3, self.mesh.around // 2), max(1, self.mesh.along // 2)
        return PublishedFilm(self.section, self.law, self._diffusion, *elements)

    def full(self) -> NodeState:
        """A full film at the ambient pressure, or p_cav if that is higher."""
        level = np.full(self.mesh.phi.shape, max(0.0, self.cavitation))
        pressure = np.where(self.elements.fixed.reshape(level.shape), self.mesh.fixed_pressure, level)
        return NodeState(pressure, self.fraction(pressure))

    def fraction(self, pressure: Array) -> Array:
        """(e, 9) oil fraction at the points, from the scaled gauge pressures (2 a, 2 k + 1) of the nodes."""
        return self.law.fraction(self.over_cavitation(self.at_points(pressure)))[0]

    def at_points(self, pressure: Array) -> Array:
        """(e, 9) at the points what has the values (2 a, 2 k + 1) at the nodes."""
        return np.asarray(pressure.ravel()[self.mesh.nodes] @ self.mesh.values.T, dtype=np.float64)

    def over_cavitation(self, pressure: Array) -> Array:
        """Absolute pressure over p_cav, from the scaled gauge pressure."""
        return 1.0 + (pressure - self.cavitation) / self.cavity

    def gap(self, motion: Motion) -> Gap:
        """The gap at the points."""
        angle = self.mesh.angle
        slope = motion.d[0] * self.elements.cosine + motion.d[1] * self.elements.sine
        if self.section.lobes is not None:
            slope = slope + lobe_slope(self.section.lobes, angle)
        height, rate = gap_height(self.section, motion.d, angle), gap_rate(motion.v, angle)
        return Gap(height, slope, rate, 0.5 * motion.omega)

    def steady(self, motion: Motion, start: NodeState | None = None) -> PublishedSolution:
        """Oil fractions that do not change while the journal moves as it does, by way of less steep laws if need be.

        start: of a motion near to this one. Raises NotConverged.
        """
        gap, still, cost = self.gap(motion), np.zeros(self.mesh.angle.shape), 0

        def equations(distance: float) -> Equations:
            return Equations(gap, self._step(1.0 - distance), 0.0, still)

        distance = 1.0 - self.law.steepness
        if start is not None:
            point = self._newton.solve(equations(distance), start.pressure.ravel())
            if point.share < NONE:
                return self._solution(motion, equations(distance), point, point.cost)
            cost = point.cost
        point = self._newton.approach(equations, distance, self.full().pressure.ravel())
        return self._solution(motion, equations(distance), point, cost + point.cost)

    def step(self, motion: Callable[[float], Motion], state: NodeState, time: float, dt: float) -> PublishedSolution:
        """An implicit Euler step from a time over dt, in s, along a motion (time -> motion).

        In halves where it does not converge. Raises NotConverged.
        """
        return self._halves(motion, state, time, dt, MOST_HALVINGS)

    def _halves(
        self, motion: Callable[[float], Motion], state: NodeState, time: float, dt: float, left: int
    ) -> PublishedSolution:
        try:
            return self.keep(motion(time + dt), state.pressure, 1.0 / dt, state.fraction / dt)
        except NotConverged:
            if left == 0:
                raise
        half = 0.5 * dt
        middle = self._halves(motion, state, time, half, left - 1)
        return self._halves(motion, middle.state, time + half, half, left - 1)

    def keep(self, motion: Motion, pressure: Array, rate: float, past: Array) -> PublishedSolution:
        """One step or stage of any implicit formula: dtheta/dt = rate theta - past with past (e, 9) from before.

        pressure: (2 a, 2 k + 1) scaled gauge pressures to begin from. Raises NotConverged.
        """
        equations = Equations(self.gap(motion), self.step_law, rate, past)
        point = self._newton.solve(equations, pressure.ravel())
        return self._solution(motion, equations, point, point.cost)

    def _step(self, steepness: float) -> Step:
        return make_step(replace(self.law, steepness=steepness), self.cavitation, self.ambient)

    def _solution(self, motion: Motion, equations: Equations, point: Point, iterations: int) -> PublishedSolution:
        if not point.share < TOLERATED:
            raise FilmUnsolved(
                f"the film did not converge: after {iterations} assemblies {point.share:.0e} of its flows are left"
            )
        pressure = point.pressure.reshape(self.mesh.phi.shape)
        change = self._newton.changes(equations, point).reshape(*pressure.shape, -1)
        force = np.einsum("ijx,ij->x", self.weights, pressure)
        by = np.einsum("ijx,ijs->xs", self.weights, change)
        unsettled = float(np.hypot(*by[:, 0]) / max(np.hypot(*force), np.finfo(float).tiny))
        return PublishedSolution(
            NodeState(pressure, self.fraction(pressure)),
            ForceResponse(force, by[:, 1:3], by[:, 3:]),
            motion,
            equations.rate,
            equations.past,
            point.share,
            unsettled,
            iterations,
        )


def published_force(film: PublishedFilm, displacement: Array, velocity: Array, omega: float) -> FilmForce:
    """Force and derivatives of a film that has settled, in SI units. Raises NotConverged."""
    c = film.section.clearance
    d, v = np.asarray(displacement) / c, np.asarray(velocity) / c
    found = film.steady(Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)).response
    return FilmForce(found.force, found.by_d / c, found.by_v / c)
