"""The oil balance of every cell (3.9), (4.31) on finite volumes in array notation, to which tests hold the kernels:
flows through faces and storage; flows of oil by where they begin.

Lengths are scaled by R and b, pressures by 12 eta / psi^2: a flow is an area times a rate, in 1/s.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import wrightomega

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.boundaries import BEND, PREFACTOR, STEEPNESS, EndSlope, end_slopes
from frbcli.film.cells.balance.diffusion import GAMMA, PECLET
from frbcli.film.cells.balance.ends import CHANNELS_NET, ENDS_NET, SUPPLY_NET
from frbcli.film.cells.balance.states import UPWIND
from frbcli.film.cells.data import NO_DISTANCE, PASSED, diffusing, end_reaches
from frbcli.film.cells.film import Motion, Storage, gap_on
from frbcli.film.cells.gas.balance import OilPaths, _apart
from frbcli.film.cells.gas.carry import BACKWARD, DOWNWARD, GIVEN, ONWARD, OUT, UPWARD
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.mesh.grid import VolumeGrid
from frbcli.film.gap import Edge, Section, gap_height
from frbcli.film.roughness.asperities import DEPTH, FADES, FAR, RATE, A, B, C, D
from frbcli.solve.state import State

STEP = 1e-6  # of w


def net_flow(state: State, film: int) -> float:
    """Oil that came in through openings, ends and coupled channels less what left, in units of R b C."""
    passed = state.flows[PASSED, film]
    return float(passed[SUPPLY_NET] - passed[ENDS_NET] + passed[CHANNELS_NET])


def limited(a: Array, b: Array) -> Array:
    """L in array notation."""
    return np.where(a * b > 0.0, 0.5 * a * b * (a + b) / np.maximum(a * a + b * b, np.finfo(float).tiny), 0.0)


def end_outflow(
    kind: Edge, pressure: Array, conductance: Array, length: Array, groove: float, ambient: float, bathed: Array
) -> Array:
    """Outflow of the last cells (n,) through an end.

    pressure: of the cells; conductance: from their middle to the end; length: of their share of the end, each (n,);
    groove: pressure in a groove at this end; ambient: absolute ambient pressure; bathed: (n,) share of a free end that
    lies in a bath. Pressures are scaled (1/s), and all but the last are over the ambient pressure. """
    if kind == "symmetry":
        return np.zeros_like(pressure)
    if kind in ("oil-bath", "groove"):
        return conductance * (pressure - (groove if kind == "groove" else 0.0))
    # conductance (p - p_edge) = a exp(b p_edge) length, (4.36) and (4.37)
    steepness = STEEPNESS / ambient
    omega = wrightomega(np.log(PREFACTOR * steepness * length / conductance) + steepness * pressure)
    return conductance * ((1.0 - bathed) * omega / steepness + bathed * pressure)


class Spreads(NamedTuple):
    """Spread around (m, k) through the face after each cell, along (m, k - 1), and out at the ends, near and far (m,)
    each, where the next cell is the oil there."""

    around: Array
    along: Array
    near: Array
    far: Array

    def net_outflow(self) -> Array:
        """(m, k) outflow of each cell."""
        nothing = np.zeros_like(self.around)
        return Fluxes(self.around, nothing, nothing, self.along, self.near, self.far).net_outflow(nothing)

    def created(self, fixed: NDArray[np.bool_]) -> float:
        """What comes into the film from where the oil fraction is given: the ends, and the `fixed` cells (m, k)."""
        return float(self.net_outflow()[fixed].sum() - self.near.sum() - self.far.sum())


def spreads(section: Section, grid: VolumeGrid, motion: Motion, state: CellState) -> Spreads:
    """The diffusion of a film with such a term."""
    length, along = diffusing(section, grid)
    reach = 0.5 * GAMMA * length * abs(motion.omega)
    face, centre = (gap_on(section, motion, phi, grid.height) for phi in (grid.phi[1:], grid.centre))
    edges = gap_on(section, motion, grid.centre, grid.z)
    dphi, dz = np.diff(grid.phi)[:, None], np.diff(grid.z)
    open_around, open_along = (
        np.where(distance > 0.0, size / np.maximum(distance, NO_DISTANCE), 0.0)
        for size, distance in ((dz, grid.around), (along * dphi, grid.along))
    )
    layers = np.stack([state.fraction, state.pressure, state.fraction_slope, state.pressure_slope])
    beyond = np.zeros((4, grid.shape[0]))
    beyond[0] = 1.0
    groove = beyond.copy()
    groove[1] = section.far_pressure / section.pressure_scale
    near, far = end_reaches(grid.height, section.seals)
    free = ~grid.fixed
    ends = (
        along * dphi[:, 0] * _full(section, grid, edge) * reach_out * free[:, last]
        for edge, reach_out, last in ((section.near, near, 0), (section.far, far, -1))
    )
    at_near, at_far = ends
    return Spreads(
        _spread(layers, np.roll(layers, -1, axis=1), face, open_around, reach),
        _spread(layers[:, :, :-1], layers[:, :, 1:], edges[:, 1:-1], open_along, reach),
        _spread(layers[:, :, 0], beyond, centre[:, 0], at_near, reach),
        _spread(layers[:, :, -1], groove if section.far == "groove" else beyond, centre[:, -1], at_far, reach),
    )


def _full(section: Section, grid: VolumeGrid, edge: str) -> Array:
    """(m,) share of an end beyond which there is oil."""
    if edge == "free-to-air":
        return bathed(section, grid.phi)
    return np.full(grid.shape[0], 0.0 if edge == "symmetry" else 1.0)


def _spread(own: Array, other: Array, gap: Array, opened: Array, reach: float) -> Array:
    """own, other: (4, ...) oil fractions, pressures, their slopes; opened: conductances; reach: gamma L omega/2."""
    (t, p, by_t, by_p), (t_n, p_n, _, _) = own, other
    fall, drop = np.minimum(t, 1.0) - np.minimum(t_n, 1.0), p - p_n
    tangent = np.divide(by_t, by_p, out=np.zeros_like(by_t), where=(by_p > 0.0) & (t < 1.0))
    chord = np.divide(fall, drop, out=np.zeros_like(fall), where=drop != 0.0)
    steep = np.where(drop != 0.0, np.maximum(chord, 0.0), tangent)
    peclet = reach / (GAMMA * gap**2) * steep
    return opened * reach * gap * peclet / np.hypot(PECLET, peclet) * fall


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


def pressure_flow(x: Array) -> Array:
    """phi_x: flow that a pressure drives, over that between smooth surfaces."""
    return np.asarray(1.0 - DEPTH * np.exp(-RATE * x))


def shear_flow(x: Array) -> Array:
    """Phi_s: (2 / U sigma) times the flow that a rough surface with the speed U carries in addition to U h / 2."""
    near = np.minimum(x, FAR)
    factor = A * near**B * np.exp(-C * near + D * near**2)
    return np.asarray(factor * np.exp(-FADES * (x - near)))


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

    def fluxes(self, pressure: Array, theta: Array) -> Fluxes:
        """Flows for pressures and oil fractions (m, k).

        The surfaces carry the oil of a part-filled film with the limited oil fraction of states.py, what a full film
        is compressed by as it is at the face (second order).
        """
        c, section = self.conductances, self.section
        packed = np.maximum(theta - 1.0, 0.0)
        carried = c.carried * (self._at_faces(theta - packed) + 0.5 * (packed + np.roll(packed, -1, axis=0)))
        around = c.around * (pressure - np.roll(pressure, -1, axis=0))
        along = c.along * (pressure[:, :-1] - pressure[:, 1:])
        first, last = end_slopes(self.grid.height, section.seals)
        groove = section.far_pressure / section.pressure_scale if section.far == "groove" else 0.0
        near = self._end(section.near, pressure, self.grid.fixed[:, 0], c.near, 0.0, first)
        far = self._end(section.far, pressure[:, ::-1], self.grid.fixed[:, -1], c.far, groove, last)
        return Fluxes(around, carried, c.rise * theta, along, near, far)

    def _at_faces(self, loose: Array) -> Array:
        """(m, k) oil fraction at the face after each cell.

        loose: (m, k) oil fractions, full at most. With artificial diffusion it is the mean of both."""
        after = np.roll(loose, -1, axis=0)
        if self.section.diffusion is not None:
            return 0.5 * (loose + after)
        upstream, downstream = (loose, after) if self.motion.omega >= 0.0 else (after, loose)
        return upstream + limited(upstream - self.before, downstream - upstream)

    def _end(
        self, kind: Edge, pressure: Array, fixed: Array, conductance: Array, groove: float, slope: EndSlope
    ) -> Array:
        """pressure (m, k): from this end on; fixed: (m,). A parabola through the last two cells bends the pressure
        there."""
        ambient = self.section.ambient_pressure / self.section.pressure_scale
        last, beyond = pressure[:, 0], pressure[:, min(1, pressure.shape[1] - 1)]
        rise, bend = last - groove, slope.bend * (last - beyond)
        smooth = np.abs(bend) <= BEND * np.abs(rise)
        felt = last + np.where(smooth, bend, BEND * np.sign(bend) * np.abs(rise))
        out = end_outflow(
            kind, felt, conductance, np.diff(self.grid.phi), groove, ambient, bathed(self.section, self.grid.phi)
        )
        return np.where(fixed, 0.0, out)  # a groove or hole that reaches the end feeds the film only

    def residual(self, state: CellState, storage: Storage) -> Array:
        """Residual of each cell (m, k).

        state: of the law with arrays (m, k), whose slopes are zero and whose values are given in fixed cells.
        """
        net = self.fluxes(state.pressure, state.fraction).net_outflow(self.grid.share)
        if self.section.diffusion is not None:
            net += spreads(self.section, self.grid, self.motion, state).net_outflow()
        kept = storage.factor * state.fraction - storage.past - state.source
        return np.where(self.grid.fixed, 0.0, net + self.grid.area * kept)

    def stencil(self, state: CellState, storage: Storage) -> Array:
        """(5, m, k) derivatives of each cell's residual by w of the cell, and of those before, behind, below and above
        it, as differences, in which the states follow w by their slopes."""
        found = np.zeros((5, *self.grid.shape))
        for cells in _apart(self.grid.shape):

            def moved(step: float, cells: NDArray[np.bool_] = cells) -> Array:
                move = step * cells
                at = replace(
                    state,
                    pressure=state.pressure + move * state.pressure_slope,
                    fraction=state.fraction + move * state.fraction_slope,
                    source=state.source + move * state.source_slope,
                )
                return self.residual(at, storage)

            slope, inside = (moved(STEP) - moved(-STEP)) / (2.0 * STEP), np.pad(cells, ((0, 0), (1, 1)))
            around = cells, np.roll(cells, 1, axis=0), np.roll(cells, -1, axis=0), inside[:, :-2], inside[:, 2:]
            for entry, here in enumerate(around):
                found[entry][here] = slope[here]
        found[0][self.grid.fixed] = 1.0
        return found


def oil_paths(balances: CellBalances, pressure: Array, fraction: Array) -> OilPaths:
    """The flows of oil by where they begin, of cells with pressures and oil fractions (m, k).

    Where surfaces carry more out of a cell than into the next one, which is an opening in part, the opening takes the
    difference, or gives it.
    """
    fluxes = balances.fluxes(pressure, fraction)
    share = balances.grid.share
    leaves = fluxes.around + share * fluxes.carried
    enters = fluxes.around + np.roll(share, -1, axis=0) * fluxes.carried
    shared = np.sign(leaves) * np.where(leaves * enters > 0.0, np.minimum(np.abs(leaves), np.abs(enters)), 0.0)
    onward, backward = np.maximum(shared, 0.0), np.maximum(-shared, 0.0)
    upward, downward = np.maximum(fluxes.along, 0.0), np.maximum(-fluxes.along, 0.0)
    out = onward + np.roll(backward, 1, axis=0)
    out[:, :-1] += upward
    out[:, 1:] += downward
    given = np.zeros_like(out)
    outside = [leaves - shared, -np.roll(enters - shared, 1, axis=0), fluxes.excess]
    for at, flow in ((0, fluxes.near), (-1, fluxes.far)):
        outside.append(np.zeros_like(out))
        outside[-1][:, at] = flow
    for flow in outside:
        out += np.maximum(flow, 0.0)
        given += np.maximum(-flow, 0.0)
    return OilPaths(onward, backward, upward, downward, out, given)


def path_layers(paths: OilPaths, layers: Array) -> None:
    """The layers of the paths of carry.py (PATHS, m, k) <- paths in array notation."""
    layers[UPWARD:OUT, :, -1] = 0.0
    layers[UPWARD, :, :-1], layers[DOWNWARD, :, :-1] = paths.upward, paths.downward
    layers[ONWARD], layers[BACKWARD], layers[OUT], layers[GIVEN] = paths.onward, paths.backward, paths.out, paths.given
