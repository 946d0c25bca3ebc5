"""The oil balance of every cell (3.9), (4.31) on finite volumes: flows through faces, storage, and its derivatives.

Lengths are scaled by R and b, pressures by 12 eta / psi^2: a flow is an area times a rate, in 1/s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frbcli.film.cavitation.law import CellState
from frbcli.film.ends import end_outflow
from frbcli.film.gap import Section
from frbcli.film.grid import Array
from frbcli.film.volume_grid import VolumeGrid

NO_DISTANCE = 1e-30  # between two cells of a groove: nothing flows there


@dataclass(frozen=True)
class Motion:
    """Motion of the journal relative to the shell.

    d: displacement over the clearance; v: its rate in 1/s; omega: omega_J + omega_S in rad/s.
    """

    d: tuple[float, float]
    v: tuple[float, float]
    omega: float

    @property
    def rate(self) -> float:
        """How fast the gap changes, in 1/s: what drives pressure and flow."""
        return max(0.5 * abs(self.omega), math.hypot(*self.v), 1e-3)


class Conductances(NamedTuple):
    """What the gap makes of pressures and motion: around (m, k) through the face after each cell, along (m, k - 1),
    near and far (m,) at the ends; carried (m, k) by the surfaces through the face after each cell."""

    around: Array
    along: Array
    near: Array
    far: Array
    carried: Array


class Storage(NamedTuple):
    """Oil kept in the cells per area and time, factor theta - past: factor and past are (m, 1) or (m, k), in 1/s."""

    factor: Array
    past: Array


class Stencil(NamedTuple):
    """Derivatives (m, k) of each cell's balance by w of the cell, and of those before, behind, below and above it."""

    centre: Array
    before: Array
    behind: Array
    below: Array
    above: Array


class Fluxes(NamedTuple):
    """Oil flows: around (m, k) through the face after each cell, along (m, k - 1), near and far (m,) at the ends."""

    around: Array
    along: Array
    near: Array
    far: Array

    def net_outflow(self) -> Array:
        """(m, k) outflow of each cell."""
        net = self.around - np.roll(self.around, 1, axis=0)
        net[:, :-1] += self.along
        net[:, 1:] -= self.along
        net[:, 0] += self.near
        net[:, -1] += self.far
        return net

    def turnover(self) -> Array:
        """(m, k) half of what passes through the faces of each cell, whatever its direction."""
        size = np.abs(self.around) + np.abs(np.roll(self.around, 1, axis=0))
        size[:, :-1] += np.abs(self.along)
        size[:, 1:] += np.abs(self.along)
        size[:, 0] += np.abs(self.near)
        size[:, -1] += np.abs(self.far)
        return 0.5 * size


def gap_height(d: tuple[float, float], phi: Array) -> Array:
    """H (4.4) at the angles phi (n,) for the displacement d over the clearance."""
    return 1.0 + d[0] * np.sin(phi) - d[1] * np.cos(phi)


def gap_rate(v: tuple[float, float], phi: Array) -> Array:
    """dH/dt in 1/s at the angles phi (n,) for the velocity v over the clearance."""
    return v[0] * np.sin(phi) - v[1] * np.cos(phi)


def conductances(section: Section, grid: VolumeGrid, motion: Motion) -> Conductances:
    """The conductances of a section. To a groove or hole the distance counts to its edge, which is a face."""
    dphi, dz, fixed = np.diff(grid.phi), np.diff(grid.z), grid.fixed
    face = gap_height(motion.d, grid.phi[1:])
    cube = gap_height(motion.d, grid.centre)[:, None] ** 3 * dphi[:, None] * section.aspect
    half_around = np.where(fixed, 0.0, 0.5 * dphi[:, None])
    half_along = np.where(fixed, 0.0, 0.5 * dz[None, :])
    distance = half_around + np.roll(half_around, -1, axis=0)
    around = np.where(distance > 0.0, face[:, None] ** 3 * dz / np.maximum(distance, NO_DISTANCE), 0.0)
    distance = half_along[:, :-1] + half_along[:, 1:]
    along = np.where(distance > 0.0, cube / np.maximum(distance, NO_DISTANCE), 0.0)
    near, far = cube[:, 0] / (0.5 * dz[0]), cube[:, 0] / (0.5 * dz[-1])
    return Conductances(around, along, near, far, 0.5 * motion.omega * face[:, None] * dz[None, :])


class Balance:
    """Balances of the cells of one section for one motion; constant."""

    def __init__(self, section: Section, grid: VolumeGrid, motion: Motion) -> None:
        self.section, self.grid, self.motion = section, grid, motion
        self.conductances = conductances(section, grid, motion)

    def fluxes(self, pressure: Array, theta: Array) -> tuple[Fluxes, Array, Array]:
        """Flows for pressures and oil fractions (m, k), and the derivatives (m,) of those at the ends by the pressure.

        The surfaces carry the oil of a part-filled film as it is in the cell that they come from (upwind), what a full
        film is compressed by as it is at the face (second order).
        """
        c = self.conductances
        packed = np.maximum(theta - 1.0, 0.0)
        loose = theta - packed if self.motion.omega >= 0.0 else np.roll(theta - packed, -1, axis=0)
        carried = c.carried * (loose + 0.5 * (packed + np.roll(packed, -1, axis=0)))
        around = c.around * (pressure - np.roll(pressure, -1, axis=0)) + carried
        along = c.along * (pressure[:, :-1] - pressure[:, 1:])
        near, near_slope = self._end(self.section.near, 0, pressure, c.near, 0.0)
        groove = self.section.far_pressure / self.section.pressure_scale
        far, far_slope = self._end(self.section.far, -1, pressure, c.far, groove)
        return Fluxes(around, along, near, far), near_slope, far_slope

    def _end(self, kind: str, column: int, pressure: Array, conductance: Array, groove: float) -> tuple[Array, Array]:
        ambient = self.section.ambient_pressure / self.section.pressure_scale
        out, slope = end_outflow(kind, pressure[:, column], conductance, np.diff(self.grid.phi), groove, ambient)
        closed = self.grid.fixed[:, column]  # a groove or hole that reaches the end feeds the film only
        return np.where(closed, 0.0, out), np.where(closed, 0.0, slope)

    def residual(self, state: CellState, storage: Storage) -> tuple[Array, Array, Stencil]:
        """What does not balance in each cell (m, k), the size of its terms (m, k), and the stencil of derivatives by w.

        state: of the law with arrays (m, k), whose slopes are zero and whose values are given in fixed cells.
        """
        area, fixed = self.grid.area, self.grid.fixed
        fluxes, near_slope, far_slope = self.fluxes(state.pressure, state.fraction)
        kept = storage.factor * state.fraction
        residual = fluxes.net_outflow() + area * (kept - storage.past - state.source)
        pull = self._pull(state, near_slope, far_slope)
        size = pull + fluxes.turnover() + area * (np.abs(kept) + np.abs(storage.past) + state.source)
        stencil = self._stencil(state, storage, near_slope, far_slope)
        return np.where(fixed, 0.0, residual), size, stencil

    def _pull(self, state: CellState, near_slope: Array, far_slope: Array) -> Array:
        """Size of the terms whose differences are the pressure-driven flows: their round-off is the residual's."""
        c = self.conductances
        total = c.around + np.roll(c.around, 1, axis=0)
        total[:, :-1] += c.along
        total[:, 1:] += c.along
        total[:, 0] += near_slope
        total[:, -1] += far_slope
        return total * np.abs(state.pressure)

    def _stencil(self, state: CellState, storage: Storage, near_slope: Array, far_slope: Array) -> Stencil:
        c, p_w, t_w = self.conductances, state.pressure_slope, state.fraction_slope
        half = np.where(state.fraction > 1.0, 0.5 * t_w, 0.0)
        whole = np.where(state.fraction > 1.0, 0.0, t_w)
        own, other = (half + whole, half) if self.motion.omega >= 0.0 else (half, half + whole)
        from_cell = c.around * p_w + c.carried * own  # through the face after it, by its own w
        from_next = c.carried * np.roll(other, -1, axis=0) - c.around * np.roll(p_w, -1, axis=0)  # by w of the next
        low, high = c.along * p_w[:, :-1], c.along * p_w[:, 1:]
        centre = from_cell - np.roll(from_next, 1, axis=0)
        centre += self.grid.area * (storage.factor * t_w - state.source_slope)
        centre[:, :-1] += low
        centre[:, 1:] += high
        centre[:, 0] += near_slope * p_w[:, 0]
        centre[:, -1] += far_slope * p_w[:, -1]
        below, above = np.zeros_like(p_w), np.zeros_like(p_w)
        below[:, 1:], above[:, :-1] = -low, -high
        free = ~self.grid.fixed
        return Stencil(
            centre=np.where(free, centre, 1.0),
            before=free * -np.roll(from_cell, 1, axis=0),
            behind=free * from_next,
            below=free * below,
            above=free * above,
        )
