"""The oil balance of every cell (3.9), (4.31) on finite volumes: flows through faces, storage, and its derivatives.

Lengths are scaled by R and b, pressures by 12 eta / psi^2: a flow is an area times a rate, in 1/s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.boundaries import BEND, EndSlope, end_outflow, end_slopes
from frbcli.film.cells.balance.plain_diffusion import NO_DISTANCE, Spreads, spreads
from frbcli.film.cells.balance.states import UPWIND, limited
from frbcli.film.cells.film import Motion, Storage, gap_on
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.mesh.grid import VolumeGrid
from frbcli.film.gap import Section, gap_height
from frbcli.film.roughness.flow_factors import pressure_flow, shear_flow


class EndFlow(NamedTuple):
    """Outflow (m,) of the last cells through an end, its derivatives (m,) by their pressure and their neighbours'."""

    out: Array
    by_last: Array
    by_next: Array


class Conductances(NamedTuple):
    """Conductances of the gap: around (m, k) through the face after each cell, along (m, k - 1), near and far (m,) at
    the ends; by the surfaces carried (m, k) through the face after each cell and rise (m, k) out of the areas outside
    of the film."""

    around: Array
    along: Array
    near: Array
    far: Array
    carried: Array
    rise: Array


class Stencil(NamedTuple):
    """Derivatives (m, k) of each cell's balance by w of the cell, and of those before, behind, below and above it."""

    centre: Array
    before: Array
    behind: Array
    below: Array
    above: Array


class Fluxes(NamedTuple):
    """Oil flows: around (m, k) by pressure and carried (m, k) by the surfaces through the face after each cell, excess
    (m, k) carried by these out of the areas outside of the film, along (m, k - 1), near and far (m,) at the ends."""

    around: Array
    carried: Array
    excess: Array
    along: Array
    near: Array
    far: Array

    def net_outflow(self, share: Array) -> Array:
        """(m, k) outflow of each cell. share: (m, k) of a cell that is film, out of which the surfaces carry oil; what
        they carry over the rest belongs to a groove or hole."""
        net = self.around - np.roll(self.around, 1, axis=0) + self.excess
        net += share * (self.carried - np.roll(self.carried, 1, axis=0))
        net[:, :-1] += self.along
        net[:, 1:] -= self.along
        net[:, 0] += self.near
        net[:, -1] += self.far
        return net


def conductances(section: Section, grid: VolumeGrid, motion: Motion) -> Conductances:
    """The conductances of a section. Into a groove or hole the distance counts to its edge."""
    dphi, dz = np.diff(grid.phi), np.diff(grid.z)
    face, centre = (gap_on(section, motion, phi, grid.height) for phi in (grid.phi[1:], grid.centre))
    along_gap = gap_on(section, motion, grid.centre, grid.z)
    cube = rough_share(section, along_gap) * along_gap**3 * dphi[:, None] * section.aspect
    through = face * centre * np.roll(centre, -1, axis=0) if grid.has_bores else face**3
    edge = gap_height(section, motion.displacement_at(grid.height), grid.at)
    at_face = grid.at == grid.phi[1:, None]
    through = rough_share(section, np.where(at_face, face, edge)) * np.where(at_face, through, edge**3)
    around = np.where(grid.around > 0.0, through * dz / np.maximum(grid.around, NO_DISTANCE), 0.0)
    along = np.where(grid.along > 0.0, cube[:, 1:-1] / np.maximum(grid.along, NO_DISTANCE), 0.0)
    first, last = end_slopes(grid.height, section.seals)
    near, far = cube[:, 0] * first.rise, cube[:, -1] * last.rise
    carried = 0.5 * motion.omega * face
    rise = grid.excess * (carried - np.roll(carried, 1, axis=0))
    if section.flow_roughness > 0.0:  # with a shell at rest
        rough = section.flow_roughness / section.clearance
        carried = carried + 0.5 * motion.omega * section.shear * rough * shear_flow(face / rough)
    return Conductances(around, along, near, far, carried * dz[None, :], rise)


def rough_share(section: Section, gap: Array) -> Array | float:
    """phi_x at the gaps H, 1 between smooth surfaces."""
    return pressure_flow(gap * section.clearance / section.flow_roughness) if section.flow_roughness > 0.0 else 1.0


class CellBalances:
    """Balances of the cells of one section for one motion; constant."""

    def __init__(self, section: Section, grid: VolumeGrid, motion: Motion, before: Array | None = None) -> None:
        """before: (m, k), see before_upstream; None: oil is carried upwind."""
        self.section, self.grid, self.motion = section, grid, motion
        self.before = np.full(grid.shape, UPWIND) if before is None else before
        self.conductances = conductances(section, grid, motion)

    def fluxes(self, pressure: Array, theta: Array) -> tuple[Fluxes, EndFlow, EndFlow]:
        """Flows for pressures and oil fractions (m, k), and those at the ends with their derivatives.

        The surfaces carry the oil of a part-filled film with the limited oil fraction of states.py, what a full film
        is compressed by as it is at the face (second order).
        """
        c = self.conductances
        packed = np.maximum(theta - 1.0, 0.0)
        loose, _, _ = self._at_faces(theta - packed)
        carried = c.carried * (loose + 0.5 * (packed + np.roll(packed, -1, axis=0)))
        around = c.around * (pressure - np.roll(pressure, -1, axis=0))
        along = c.along * (pressure[:, :-1] - pressure[:, 1:])
        first, last = end_slopes(self.grid.height, self.section.seals)
        groove = self.section.far_pressure / self.section.pressure_scale if self.section.far == "groove" else 0.0
        inwards = slice(None, None, -1)
        near = self._end(self.section.near, pressure, self.grid.fixed, c.near, 0.0, first)
        far = self._end(
            self.section.far, pressure[:, inwards], self.grid.fixed[:, inwards], c.far, groove, last
        )
        return Fluxes(around, carried, c.rise * theta, along, near.out, far.out), near, far

    def _at_faces(self, loose: Array) -> tuple[Array, Array, Array]:
        """(m, k) oil fraction at the face after each cell and its derivatives by the fractions of this cell and the
        next.

        loose: (m, k) oil fractions, full at most. With artificial diffusion it is the mean of both."""
        if self.section.diffusion is not None:
            half = np.full_like(loose, 0.5)
            return half * (loose + np.roll(loose, -1, axis=0)), half, half
        forward, after = self.motion.omega >= 0.0, np.roll(loose, -1, axis=0)
        upstream, downstream = (loose, after) if forward else (after, loose)
        across = downstream - upstream
        more, by_before, by_across = limited(upstream - self.before, across)
        by_upstream = 1.0 + by_before - by_across
        return upstream + more, *((by_upstream, by_across) if forward else (by_across, by_upstream))

    def _end(
        self, kind: str, pressure: Array, fixed: NDArray[np.bool_], conductance: Array, groove: float, slope: EndSlope
    ) -> EndFlow:
        """pressure, fixed: (m, k) from this end on. A parabola through the last two cells bends the pressure there."""
        ambient = self.section.ambient_pressure / self.section.pressure_scale
        last, beyond = pressure[:, 0], pressure[:, min(1, pressure.shape[1] - 1)]
        rise = last - groove
        bend = slope.bend * (last - beyond)
        smooth = np.abs(bend) <= BEND * np.abs(rise)
        side = BEND * np.sign(bend) * np.sign(rise)
        felt = last + np.where(smooth, bend, side * rise)
        out, by_felt = end_outflow(
            kind, felt, conductance, np.diff(self.grid.phi), groove, ambient, bathed(self.section, self.grid.phi)
        )
        by_felt = np.where(fixed[:, 0], 0.0, by_felt)  # a groove or hole that reaches the end feeds the film only
        by_last = by_felt * np.where(smooth, 1.0 + slope.bend, 1.0 + side)
        by_next = by_felt * np.where(smooth, -slope.bend, 0.0)
        return EndFlow(np.where(fixed[:, 0], 0.0, out), by_last, by_next)

    def residual(self, state: CellState, storage: Storage) -> tuple[Array, Stencil]:
        """Residual of each cell (m, k), and the stencil of derivatives by w.

        state: of the law with arrays (m, k), whose slopes are zero and whose values are given in fixed cells.
        """
        area, fixed = self.grid.area, self.grid.fixed
        fluxes, near, far = self.fluxes(state.pressure, state.fraction)
        kept = storage.factor * state.fraction
        residual = fluxes.net_outflow(self.grid.share) + area * (kept - storage.past - state.source)
        stencil = self._stencil(state, storage, near, far)
        if self.section.diffusion is not None:
            spread = spreads(self.section, self.grid, self.motion, state)
            residual, stencil = residual + spread.net_outflow(), with_spread(stencil, spread, ~fixed)
        return np.where(fixed, 0.0, residual), stencil

    def _stencil(self, state: CellState, storage: Storage, near: EndFlow, far: EndFlow) -> Stencil:
        c, p_w, t_w = self.conductances, state.pressure_slope, state.fraction_slope
        packed, share = state.fraction > 1.0, self.grid.share
        _, own, next_ = self._at_faces(np.minimum(state.fraction, 1.0))
        by_own, by_next = c.around * p_w, c.around * np.roll(p_w, -1, axis=0)  # through the face after each cell
        own = c.carried * np.where(packed, 0.5, own) * t_w
        other = c.carried * np.where(np.roll(packed, -1, axis=0), 0.5, next_) * np.roll(t_w, -1, axis=0)
        low, high = c.along * p_w[:, :-1], c.along * p_w[:, 1:]
        centre = by_own + share * own + np.roll(by_next, 1, axis=0) - share * np.roll(other, 1, axis=0)
        centre += c.rise * t_w + self.grid.area * (storage.factor * t_w - state.source_slope)
        centre[:, :-1] += low
        centre[:, 1:] += high
        centre[:, 0] += near.by_last * p_w[:, 0]
        centre[:, -1] += far.by_last * p_w[:, -1]
        below, above = np.zeros_like(p_w), np.zeros_like(p_w)
        below[:, 1:], above[:, :-1] = -low, -high
        if p_w.shape[1] > 1:
            above[:, 0] += near.by_next * p_w[:, 1]
            below[:, -1] += far.by_next * p_w[:, -2]
        free = ~self.grid.fixed
        return Stencil(
            centre=np.where(free, centre, 1.0),
            before=free * (-np.roll(by_own, 1, axis=0) - share * np.roll(own, 1, axis=0)),
            behind=free * (share * other - by_next),
            below=free * below,
            above=free * above,
        )


def with_spread(stencil: Stencil, spread: Spreads, free: NDArray[np.bool_]) -> Stencil:
    """The stencil with the derivatives of the artificial diffusion; free: (m, k) cells that have a balance."""
    around, along = spread.around, spread.along
    centre = around.by_own - np.roll(around.by_next, 1, axis=0)
    centre[:, :-1] += along.by_own
    centre[:, 1:] -= along.by_next
    centre[:, 0] += spread.near.by_own
    centre[:, -1] += spread.far.by_own
    below, above = np.zeros_like(centre), np.zeros_like(centre)
    below[:, 1:], above[:, :-1] = -along.by_own, along.by_next
    return Stencil(
        centre=stencil.centre + free * centre,
        before=stencil.before - free * np.roll(around.by_own, 1, axis=0),
        behind=stencil.behind + free * around.by_next,
        below=stencil.below + free * below,
        above=stencil.above + free * above,
    )
