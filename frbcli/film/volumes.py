"""The Reynolds equation (3.9) with an oil fraction on finite volumes: conservative to round-off, for every cavitation law.

The plain version: vectorised assembly, a sparse direct solve, Newton's method on the unknown w of the law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.gap import Section, groove_pressure
from frbcli.film.grid import Array

END_PREFACTOR, END_STEEPNESS = 0.01, 100.0  # a and b of (4.37)
NEWTON_LIMIT = 60
SETTLED = 1e-11  # residual over the flow through the film


@dataclass(frozen=True)
class Motion:
    """Motion of the journal relative to the shell: d over the clearance, its rate v in 1/s, omega = omega_J + omega_S in rad/s."""

    d: tuple[float, float]
    v: tuple[float, float]
    omega: float


@dataclass(frozen=True)
class VolumeGrid:
    """Cells of one section. phi: (m + 1,) boundaries of a turn; z: (k + 1,) boundaries over [0, 1].

    fixed: (m, k) cells where the pressure is given; fixed_pressure: (m, k) scaled gauge pressure there.
    """

    phi: Array
    z: Array
    fixed: Array
    fixed_pressure: Array

    @property
    def shape(self) -> tuple[int, int]:
        """Cells around and along."""
        return len(self.phi) - 1, len(self.z) - 1


def volume_grid(section: Section, phi: Array, z: Array) -> VolumeGrid:
    """Cells with the section's grooves and holes cut out by the centres of the cells."""
    m, k = len(phi) - 1, len(z) - 1
    centre, height = 0.5 * (phi[1:] + phi[:-1]), 0.5 * (z[1:] + z[:-1])
    fixed, pressure = np.zeros((m, k), dtype=bool), np.zeros((m, k))
    for groove in section.grooves:
        inside = np.abs(_wrapped(centre - groove.position)) < 0.5 * groove.opening
        fixed[inside] = True
        distance = height * section.width
        if section.far != "symmetry":
            distance = np.minimum(distance, section.bearing_width - distance)
        pressure[inside] = groove_pressure(groove, distance, section.bearing_width)
    for hole in section.holes:
        across = _wrapped(centre - hole.position)[:, None] / hole.half_angle
        along = (height * section.width - hole.axial)[None, :] / hole.half_width
        inside = across**2 + along**2 < 1.0 if hole.round else (np.abs(across) < 1.0) & (np.abs(along) < 1.0)
        fixed |= inside
        pressure = np.where(inside, hole.pressure, pressure)
    return VolumeGrid(phi, z, fixed, pressure / section.pressure_scale)


def _wrapped(angle: Array) -> Array:
    return np.mod(angle + math.pi, 2 * math.pi) - math.pi


@dataclass(frozen=True)
class VolumeSolution:
    """w: (m, k) unknown; state: of the law, flat (m k,); flows: oil through the section's boundaries and its defect."""

    w: Array
    state: CellState
    iterations: int
    flows: Flows


@dataclass(frozen=True)
class Flows:
    """Oil per time in scaled units (area of the developed section times C, 1/s): into and out of the section at its ends and its
    fixed cells, made by the law, stored; and what is left over."""

    inflow: float
    outflow: float
    source: float
    stored: float
    supply: float
    ends: float

    @property
    def defect(self) -> float:
        """What does not balance, over the larger of inflow and outflow."""
        size = max(self.inflow, self.outflow, 1e-300)
        return (self.inflow - self.outflow - self.stored) / size


class VolumeFilm:
    """A section on a grid with a law. Constant; solve() takes and returns states."""

    def __init__(self, section: Section, grid: VolumeGrid, law: Law, reference: float) -> None:
        """reference: scaled pressure in 1/s that one unit of w stands for."""
        self.section, self.grid, self.law = section, grid, law
        self.scales = Scales(
            reference,
            (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale,
            section.ambient_pressure / section.pressure_scale,
        )
        m, k = grid.shape
        self._dphi, self._dz = np.diff(grid.phi), np.diff(grid.z)
        self._area = self._dphi[:, None] * self._dz[None, :]
        self._centre = 0.5 * (grid.phi[1:] + grid.phi[:-1])
        self._cells = np.arange(m * k).reshape(m, k)

    def gap(self, d: tuple[float, float], phi: Array) -> Array:
        """H (4.4)."""
        return 1.0 + d[0] * np.sin(phi) - d[1] * np.cos(phi)

    def steady(self, motion: Motion, start: Array | None = None) -> VolumeSolution:
        """Steady state of the cells for a motion whose rates of change stay as they are.

        Tries Newton's method from `start` or from a full film at p_cav; if that fails, marches in growing time steps.
        Raises NotConverged.
        """
        w = np.zeros(self.grid.shape) if start is None else start
        try:
            return self._newton(motion, w, None, 0.0)
        except NotConverged:
            pass
        rate = max(abs(motion.omega), math.hypot(*motion.v), 1.0)
        step, solution = 0.1 / rate, None
        content = self._content(motion, w)
        for _ in range(400):
            try:
                solution = self._newton(motion, w, content, step, limit=25)
            except NotConverged:
                step *= 0.25
                if step * rate < 1e-6:
                    raise
                continue
            w, content = solution.w, self._content(motion, solution.w)
            step *= 2.0
            if step * rate > 1e9:
                return self._newton(motion, w, None, 0.0)
        raise NotConverged("the film found no steady state in 400 pseudo-time steps: try a coarser mesh or more supply")

    def step(self, motion: Motion, w: Array, content: Array, dt: float) -> tuple[VolumeSolution, Array]:
        """One implicit Euler step to the motion at its end. content: (m, k) H theta at its start. Returns (solution, content)."""
        solution = self._newton(motion, w, content, dt)
        return solution, self._content(motion, solution.w)

    def _content(self, motion: Motion, w: Array) -> Array:
        theta = self.law.cells(w.ravel(), self.scales).fraction.reshape(w.shape)
        return self.gap(motion.d, self._centre)[:, None] * theta

    def _newton(
        self, motion: Motion, w: Array, content: Array | None, dt: float, limit: int = NEWTON_LIMIT
    ) -> VolumeSolution:
        from scipy.sparse.linalg import splu

        w = w.copy()
        free = ~self.grid.fixed.ravel()
        norm_before, damping = math.inf, 1.0
        scale = self._flow_scale(motion, dt)
        for iteration in range(1, limit + 1):
            residual, jacobian, state, flows = self._assemble(motion, w, content, dt)
            norm = float(np.max(np.abs(residual[free]))) / scale if free.any() else 0.0
            if norm < SETTLED:
                return VolumeSolution(w, state, iteration, flows)
            # Full steps, but for steps that made things much worse.
            damping = 0.5 if norm > 10.0 * norm_before else 1.0
            norm_before = norm
            matrix = jacobian[free][:, free].tocsc()
            try:
                correction = splu(matrix).solve(-residual[free])
            except RuntimeError as error:
                raise NotConverged(f"the film's equations are singular: {error}") from error
            if not np.all(np.isfinite(correction)):
                raise NotConverged("the film's equations have no finite solution")
            flat = w.ravel()
            flat[free] += damping * correction
        worst = np.unravel_index(int(np.argmax(np.abs(residual) * free)), self.grid.shape)
        raise NotConverged(
            f"the film did not converge in {limit} Newton iterations: residual {norm:.1e} at phi = "
            f"{math.degrees(self._centre[worst[0]]):.0f} deg; try a finer mesh, or a smaller time step"
        )

    def _flow_scale(self, motion: Motion, dt: float) -> float:
        """Size of the flow through one cell, for the residual to be compared with."""
        m, k = self.grid.shape
        rate = max(abs(motion.omega), math.hypot(*motion.v), self.scales.reference * self.section.aspect, 1e-9)
        return rate / (m * k)

    def _assemble(self, motion: Motion, w: Array, content: Array | None, dt: float):  # type: ignore[no-untyped-def]
        """Residual (net outflow + storage - source) of each cell and its Jacobian by w."""
        from scipy.sparse import coo_matrix

        grid, section, cells = self.grid, self.section, self._cells
        m, k = grid.shape
        state = self.law.cells(w.ravel(), self.scales)
        fixed = grid.fixed
        pressure = np.where(fixed, grid.fixed_pressure, state.pressure.reshape(m, k))
        theta = np.where(fixed, 1.0, state.fraction.reshape(m, k))
        p_w = np.where(fixed, 0.0, state.pressure_slope.reshape(m, k))
        t_w = np.where(fixed, 0.0, state.fraction_slope.reshape(m, k))
        residual = np.zeros((m, k))
        rows: list[Array] = []
        columns: list[Array] = []
        values: list[Array] = []

        def add(row: Array, column: Array, value: Array) -> None:
            rows.append(row.ravel())
            columns.append(column.ravel())
            values.append(np.broadcast_to(value, row.shape).ravel())

        # Around: face i lies between cell i and cell i + 1 (the last one closes the turn).
        following = np.roll(cells, -1, axis=0)
        h_face = self.gap(motion.d, grid.phi[1:])
        d_left, d_right = 0.5 * self._dphi, 0.5 * np.roll(self._dphi, -1)
        fixed_right = np.roll(fixed, -1, axis=0)
        # To a groove the distance counts to its edge, which is the face.
        distance = np.where(fixed, 0.0, d_left[:, None]) + np.where(fixed_right, 0.0, d_right[:, None])
        conductance = np.where(fixed & fixed_right, 0.0, h_face[:, None] ** 3 * self._dz / np.maximum(distance, 1e-30))
        couette = 0.5 * motion.omega * h_face[:, None] * self._dz[None, :]
        p_right, t_right = np.roll(pressure, -1, axis=0), np.roll(theta, -1, axis=0)
        pw_right, tw_right = np.roll(p_w, -1, axis=0), np.roll(t_w, -1, axis=0)
        forward = motion.omega >= 0.0
        flux = conductance * (pressure - p_right) + couette * (theta if forward else t_right)
        by_left = conductance * p_w + (couette * t_w if forward else 0.0)
        by_right = -conductance * pw_right + (0.0 if forward else couette * tw_right)
        residual += flux - np.roll(flux, 1, axis=0)
        add(cells, cells, by_left)
        add(cells, following, by_right)
        add(following, cells, -by_left)
        add(following, following, -by_right)
        flux_around = flux

        # Along.
        cube = (self.gap(motion.d, self._centre) ** 3)[:, None]
        half = 0.5 * self._dz
        distance_z = np.where(fixed[:, :-1], 0.0, half[None, :-1]) + np.where(fixed[:, 1:], 0.0, half[None, 1:])
        along = np.where(
            fixed[:, :-1] & fixed[:, 1:],
            0.0,
            section.aspect * cube * self._dphi[:, None] / np.maximum(distance_z, 1e-30),
        )
        flux_z = along * (pressure[:, :-1] - pressure[:, 1:])
        residual[:, :-1] += flux_z
        residual[:, 1:] -= flux_z
        low, high = cells[:, :-1], cells[:, 1:]
        add(low, low, along * p_w[:, :-1])
        add(low, high, -along * p_w[:, 1:])
        add(high, low, -along * p_w[:, :-1])
        add(high, high, along * p_w[:, 1:])

        # Ends.
        end_flux = {}
        for column, kind in ((0, section.near), (k - 1, section.far)):
            out, slope = self._end(kind, pressure[:, column], cube[:, 0], half[column])
            out, slope = out * self._dphi, slope * self._dphi
            out = np.where(fixed[:, column], 0.0, out)
            residual[:, column] += out
            add(cells[:, column], cells[:, column], np.where(fixed[:, column], 0.0, slope) * p_w[:, column])
            end_flux[column] = end_flux.get(column, 0.0) + out

        # Storage and squeeze, source.
        h = self.gap(motion.d, self._centre)[:, None]
        if content is None:
            h_dot = (motion.v[0] * np.sin(self._centre) - motion.v[1] * np.cos(self._centre))[:, None]
            stored = h_dot * theta
            by_w = h_dot * t_w
        else:
            stored = (h * theta - content) / dt
            by_w = h * t_w / dt
        source = np.where(fixed, 0.0, state.source.reshape(m, k))
        source_w = np.where(fixed, 0.0, state.source_slope.reshape(m, k))
        residual += self._area * (stored - source)
        add(cells, cells, self._area * (by_w - source_w))

        jacobian = coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(m * k, m * k)
        ).tocsr()
        flows = self._flows(residual, stored, source, end_flux, fixed)
        del flux_around
        return residual.ravel(), jacobian, state, flows

    def _end(self, kind: str, pressure: Array, cube: Array, half: float) -> tuple[Array, Array]:
        """Outflow per angle at an end and its derivative by the pressure of the cells there."""
        section = self.section
        conductance = section.aspect * cube / half
        if kind == "symmetry":
            return np.zeros_like(pressure), np.zeros_like(pressure)
        if kind == "oil-bath":
            return conductance * pressure, conductance
        if kind == "groove":
            return conductance * (pressure - section.far_pressure / section.pressure_scale), conductance
        # Free to air (4.36), (4.37): the pressure at the edge follows from the flow through it.
        b = END_STEEPNESS / self.scales.ambient
        edge = np.minimum(pressure, 0.0)
        for _ in range(80):
            out = END_PREFACTOR * np.exp(b * edge)
            change = (conductance * (pressure - edge) - out) / (conductance + b * out)
            edge = edge + np.clip(change, -2.0 / b, 2.0 / b)
            if np.max(np.abs(change)) < 1e-14 * self.scales.ambient:
                break
        out = END_PREFACTOR * np.exp(b * edge)
        return out, conductance * b * out / (conductance + b * out)

    def _flows(self, residual, stored, source, end_flux, fixed) -> Flows:  # type: ignore[no-untyped-def]
        inflow = outflow = ends = 0.0
        for flux in end_flux.values():
            inflow += float(-np.sum(flux[flux < 0.0]))
            outflow += float(np.sum(flux[flux > 0.0]))
            ends += float(np.sum(flux))
        # What leaves a fixed cell net is what it feeds into the film.
        fed = residual[fixed]
        inflow += float(np.sum(fed[fed > 0.0]))
        outflow -= float(np.sum(fed[fed < 0.0]))
        made = float(np.sum((self._area * source)[~fixed]))
        kept = float(np.sum((self._area * stored)[~fixed]))
        return Flows(inflow, outflow, made, kept, float(np.sum(fed)), ends)
