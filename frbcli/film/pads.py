"""The film of a thrust bearing: pressure, load, torque, flows and all derivatives of the forces.

The x- and y-axes lie in the plane of the runner, the first pad's leading edge lies on the x-axis, and the runner turns
from there towards the y-axis. The runner's coordinates are its axial displacement away from the pads and its tilts
about x and y, by which the gap changes by

    g = (1, y, -x) = (1, r sin theta, -r cos theta).

Reynolds' equation in polar coordinates, with q = (omega r h / 2 - h^3 / (12 eta r) dp/dtheta, -h^3 / (12 eta) dp/dr),

    div q + dh/dt = 0,

is solved in its weak form with quadratic elements. The forces on the runner are (W, M_x, M_y) = integral of p g dA; all
pressures are over the ambient one, which is that at the four edges of a pad. Stiffness and damping are solutions with
the factorisation of the film itself. Flows through the edges are the residuals of the weak form at their nodes, which
balance to round-off.

The films of all pads of one side of a collar over the gap, as one table for all speeds and viscosities.

Pads that narrow in the direction of rotation do not cavitate while their gap stays: the pressure is nowhere below that
at the edges. The film is then linear in the speed and homogeneous in the viscosity,

    W = eta omega w(h),   T = eta omega t(h),   Q = omega q(h),   K = eta omega k(h),   C = eta c(h).

Each function is interpolated over ln h by Chebyshev polynomials, those that fall over many powers of ten as their
logarithms, and the others relative to them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix, diags_array
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, ElementQuad2, MeshQuad

from frbcli.arrays import Array
from frbcli.errors import NotConverged
from frbcli.film.pad_geometry import HALF_SOMMERFELD, MESH, REYNOLDS, SOMMERFELD, Pad

Numbers = NDArray[np.intp]

ORDER = 6  # of the polynomials that are integrated exactly


@dataclass(frozen=True)
class PadMesh:
    """Elements on a pad. Of P points of integration and N nodes:

    theta, r: coordinates of the points, from the leading edge and the axis; weights: of the integral over theta and r
    value, slope_theta, slope_r: P x N, from nodal values to those at the points
    nodes: 2 x N, angle and radius; triangles: of neighbouring nodes, for pictures
    free: numbers of the nodes whose pressure is not given
    leading, trailing, inner, outer: numbers of the nodes on the edges; corners belong to the leading or trailing edge
    """

    theta: Array
    r: Array
    weights: Array
    value: csr_matrix
    slope_theta: csr_matrix
    slope_r: csr_matrix
    nodes: Array
    triangles: Numbers
    free: Numbers
    leading: Numbers
    trailing: Numbers
    inner: Numbers
    outer: Numbers


def pad_mesh(pad: Pad, radial: int, angular: int) -> PadMesh:
    """A mesh of `radial` elements in the radius and about `angular` in the angle, with an edge at the taper's end."""
    angles = _angles(pad, angular)
    radii = np.linspace(pad.inner_radius, pad.outer_radius, radial + 1)
    basis = Basis(MeshQuad.init_tensor(angles, radii), ElementQuad2(), intorder=ORDER)
    theta, r = (np.ravel(x) for x in np.asarray(basis.global_coordinates()))
    fields = [field[0] for field in basis.basis]
    nodes = basis.doflocs
    left, right = nodes[0] <= angles[0], nodes[0] >= angles[-1]
    low, high = nodes[1] <= radii[0], nodes[1] >= radii[-1]
    edge = left | right
    return PadMesh(
        theta=theta,
        r=r,
        weights=np.ravel(basis.dx),
        value=_at_points(basis, [np.asarray(field) for field in fields]),
        slope_theta=_at_points(basis, [field.grad[0] for field in fields]),
        slope_r=_at_points(basis, [field.grad[1] for field in fields]),
        nodes=nodes,
        triangles=_triangles(nodes),
        free=np.flatnonzero(~(edge | low | high)),
        leading=np.flatnonzero(left),
        trailing=np.flatnonzero(right),
        inner=np.flatnonzero(low & ~edge),
        outer=np.flatnonzero(high & ~edge),
    )


def _angles(pad: Pad, angular: int) -> Array:
    share = pad.taper_angle / pad.angle
    tapered = max(1, round(angular * share))
    angles = np.linspace(0.0, pad.taper_angle, tapered + 1)
    if share >= 1.0:
        return angles
    land = np.linspace(pad.taper_angle, pad.angle, max(1, angular - tapered) + 1)
    return np.concatenate([angles, land[1:]])


def _at_points(basis: Basis, fields: list[Array]) -> csr_matrix:
    """The matrix from nodal values to those at the points; fields: of each node of an element, elements x points."""
    elements, points = basis.dx.shape
    rows = np.arange(elements * points).reshape(elements, points)
    entries = [np.broadcast_to(field, rows.shape).ravel() for field in fields]
    columns = [np.repeat(numbers, points) for numbers in basis.element_dofs]
    places = (np.tile(rows.ravel(), len(fields)), np.concatenate(columns))
    return csr_matrix((np.concatenate(entries), places), shape=(rows.size, basis.N))


def _triangles(nodes: Array) -> Numbers:
    """Two triangles in each rectangle of neighbouring nodes."""
    angles = np.round(nodes[0], 12)  # equal ones differ by round-off
    order = np.lexsort((nodes[1], angles))
    columns = len(np.unique(angles))
    grid = order.reshape(columns, -1)
    a, b, c, d = (part.ravel() for part in (grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:], grid[1:, 1:]))
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])


MOST_CHANGES = 100  # of the set of nodes in the cavity


@dataclass(frozen=True)
class RunnerMotion:
    """displacement: axial in m and two tilts in rad from the given gap; rate: of these; phase: of the pad's leading
    edge from the x-axis in rad."""

    displacement: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    phase: float = 0.0


AT_REST = RunnerMotion()


@dataclass(frozen=True)
class PadFilm:
    """The film of a pad, or of all pads of a ring, with the pressure of the first.

    forces: on the runner: load in N, moments about x and y in N m; torque: that resists the rotation, in N m
    inner_flow, outer_flow, trailing_flow: out of the film, leading_flow: into it, in m^3/s; swept: rate at which the
    film's volume grows, in m^3/s
    pressure: over ambient, at the nodes of the mesh, in Pa
    stiffness, damping: 3 x 3, -dF/dq and -dF/dq' of forces over axial displacement and tilts about x and y
    """

    forces: Array
    torque: float
    inner_flow: float
    outer_flow: float
    leading_flow: float
    trailing_flow: float
    swept: float
    pressure: Array
    stiffness: Array
    damping: Array

    @property
    def largest_pressure(self) -> float:
        """Largest pressure over ambient in Pa."""
        return float(self.pressure.max())


@dataclass(frozen=True)
class PadOil:
    """viscosity: in Pa s; law: of LAWS; cavitation_pressure: over the ambient one in Pa, at most 0."""

    viscosity: float
    law: str = HALF_SOMMERFELD
    cavitation_pressure: float = 0.0


def pad_film(mesh: PadMesh, land_gap: Array, oil: PadOil, omega: float, motion: RunnerMotion = AT_REST) -> PadFilm:
    """The film of one pad.

    land_gap: the gap in m at the points of the mesh without the runner's motion; omega: speed of the runner in rad/s.
    Raises NotConverged if the boundary of a cavity by Reynolds' condition is not found.
    """
    r, weights = mesh.r, mesh.weights
    angle = mesh.theta + motion.phase
    modes = np.stack([np.ones_like(r), r * np.sin(angle), -r * np.cos(angle)])
    gap = land_gap + np.array(motion.displacement) @ modes
    rate = np.array(motion.rate) @ modes
    mobility = weights * gap**3 / (12.0 * oil.viscosity)
    matrix = csc_matrix(
        mesh.slope_theta.T @ diags_array(mobility / r) @ mesh.slope_theta
        + mesh.slope_r.T @ diags_array(mobility * r) @ mesh.slope_r
    )
    dragged = mesh.slope_theta.T @ (weights * 0.5 * omega * r * gap)
    source = dragged - mesh.value.T @ (weights * r * rate)
    pressure, factor, solved = _pressure(mesh, matrix, source, oil)

    # derivatives of the pressure: the residual's by the gap at given pressure, through the same factorisation
    slope_theta, slope_r = mesh.slope_theta @ pressure, mesh.slope_r @ pressure
    change = 3.0 * mobility / gap * modes
    by_gap = mesh.slope_theta.T @ (weights * 0.5 * omega * r * modes - change * slope_theta / r).T
    by_gap -= mesh.slope_r.T @ (change * r * slope_r).T
    by_rate = -(mesh.value.T @ (weights * r * modes).T)

    at_points = mesh.value @ pressure
    full = np.ones(len(r), dtype=bool)
    if oil.law == HALF_SOMMERFELD:
        full = at_points > oil.cavitation_pressure
        at_points = np.maximum(at_points, oil.cavitation_pressure)
    area = weights * r * modes
    by_pressure = (mesh.value.T @ (area * full).T)[solved]
    residual = matrix @ pressure - source  # at an edge: what flows in
    shear = oil.viscosity * omega * r**3 / gap + 0.5 * gap * r * slope_theta * full
    clipped = np.maximum(pressure, oil.cavitation_pressure) if oil.law == HALF_SOMMERFELD else pressure
    damping = -by_pressure.T @ factor.solve(by_rate[solved])
    return PadFilm(
        forces=area @ at_points,
        torque=float(weights @ shear),
        inner_flow=-float(residual[mesh.inner].sum()),
        outer_flow=-float(residual[mesh.outer].sum()),
        leading_flow=float(residual[mesh.leading].sum()),
        trailing_flow=-float(residual[mesh.trailing].sum()),
        swept=float(weights @ (r * rate)),
        pressure=clipped,
        stiffness=-by_pressure.T @ factor.solve(by_gap[solved]),
        damping=0.5 * (damping + damping.T) if full.all() else damping,  # symmetric but for round-off
    )


def _pressure(mesh: PadMesh, matrix: csc_matrix, source: Array, oil: PadOil) -> tuple[Array, SuperLU, Numbers]:
    """The pressure at the nodes, the factorisation of the equations, and the nodes that are solved for: all that are
    free, or by Reynolds' condition those outside of the cavity, p >= p_c, with the complementarity condition."""
    cavity = np.zeros(len(source), dtype=bool)
    is_free = np.zeros(len(source), dtype=bool)
    is_free[mesh.free] = True
    scale = matrix.diagonal()
    for _ in range(MOST_CHANGES):
        solved = np.flatnonzero(is_free & ~cavity)
        pressure = np.where(cavity, oil.cavitation_pressure, 0.0)
        factor = splu(csc_matrix(matrix[solved][:, solved]))
        pressure[solved] = factor.solve((source - matrix @ pressure)[solved])
        if oil.law != REYNOLDS:
            return pressure, factor, solved
        holds = matrix @ pressure - source  # positive in a cavity: it keeps the pressure from falling
        free = is_free & (holds - scale * (pressure - oil.cavitation_pressure) > 0.0)
        if np.array_equal(free, cavity):
            return pressure, factor, solved
        cavity = free
    raise NotConverged("The boundary of the cavity in a film of a thrust bearing was not found.")


def ring_of_pads(film: PadFilm, pads: int) -> PadFilm:
    """All of `pads` equal pads around the axis from the film of the first, for a runner without tilt."""
    turns = _turns(pads)
    forces = np.sum([turn @ film.forces for turn in turns], axis=0)
    if pads > 2:
        forces[1:] = 0.0
    return PadFilm(
        forces=forces,
        torque=pads * film.torque,
        inner_flow=pads * film.inner_flow,
        outer_flow=pads * film.outer_flow,
        leading_flow=pads * film.leading_flow,
        trailing_flow=pads * film.trailing_flow,
        swept=pads * film.swept,
        pressure=film.pressure,
        stiffness=_around(film.stiffness, turns),
        damping=_around(film.damping, turns),
    )


def _turns(pads: int) -> list[Array]:
    """Rotations of (W, M_x, M_y) from the first pad to each of them."""
    turns = []
    for angle in 2.0 * math.pi * np.arange(pads) / pads:
        cosine, sine = math.cos(angle), math.sin(angle)
        turns.append(np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]]))
    return turns


def _around(one: Array, turns: list[Array]) -> Array:
    """The sum of coefficients over all pads. Three pads and more have no coupling of axial motion and tilt, and in
    tilt only the part of the matrix that rotations leave alone: exactly, not up to round-off."""
    if len(turns) <= 2:
        return np.asarray(np.sum([turn @ one @ turn.T for turn in turns], axis=0))
    direct, cross = 0.5 * (one[1, 1] + one[2, 2]), 0.5 * (one[2, 1] - one[1, 2])
    return len(turns) * np.array([[one[0, 0], 0.0, 0.0], [0.0, direct, -cross], [0.0, cross, direct]])


NODES = 48  # of the interpolation, whose error is below 1e-7
MOST_HELD = 8


@dataclass(frozen=True)
class ScaledPads:
    """All pads of a side at one gap, with viscosity and speed divided out. load: W / (eta omega) in m^2; torque: T /
    (eta omega) in m^3; side_flow: what leaves at both radii over omega in m^3; stiffness: K / (eta omega) in m,
    damping: C / eta in m, axial; tilt_stiffness, tilt_damping: (2, 2) likewise, in m^3; inverse_gap: integral of 1/h
    over the pads in m."""

    load: float
    torque: float
    side_flow: float
    stiffness: float
    damping: float
    tilt_stiffness: Array
    tilt_damping: Array
    inverse_gap: float


@dataclass(frozen=True)
class GapTable:
    """Films over the gap from `thin` to `wide` in m, of pads up to `radius` in m. coefficients: (NODES, 9)."""

    thin: float
    wide: float
    radius: float
    coefficients: Array

    def at(self, gap: float) -> ScaledPads:
        """The films at a gap in m between thin and wide."""
        series = chebyshev.chebval(self._scaled(gap), self.coefficients)
        load, torque, side_flow, stiffness, damping, inverse_gap = np.exp(series[:6]).tolist()
        direct, cross, turning = (series[6:] * self.radius**2).tolist()
        return ScaledPads(
            load,
            torque,
            side_flow,
            stiffness,
            damping,
            stiffness * np.array([[direct, -cross], [cross, direct]]),
            damping * turning * np.eye(2),
            inverse_gap,
        )

    def torques(self, gaps: Array) -> Array:
        """(k,) T / (eta omega) in m^3 at gaps in m."""
        return np.asarray(np.exp(chebyshev.chebval(self._scaled(gaps), self.coefficients[:, 1])))

    def _scaled(self, gaps: Array | float) -> Array:
        """Gaps in m as the polynomials take them, from -1 to 1."""
        middle, half = 0.5 * np.log(self.thin * self.wide), 0.5 * np.log(self.wide / self.thin)
        return np.asarray((np.log(gaps) - middle) / half)


@lru_cache(maxsize=MOST_HELD)
def gap_table(pad: Pad, pads: int, thin: float, wide: float, mesh: tuple[int, int] = MESH) -> GapTable:
    """The table of three or more equal pads; mesh: elements in the radius and in the angle."""
    cells, half = pad_mesh(pad, *mesh), 0.5 * np.log(wide / thin)
    at = chebyshev.chebpts1(NODES)
    values = [_functions(cells, pad, pads, float(gap)) for gap in np.sqrt(thin * wide) * np.exp(half * at)]
    return GapTable(thin, wide, pad.outer_radius, chebyshev.chebfit(at, np.array(values), NODES - 1))


def _functions(mesh: PadMesh, pad: Pad, pads: int, gap: float) -> list[float]:
    """The tabulated numbers at a gap in m, from the film of unit viscosity and speed."""
    heights = gap + pad.depth(mesh.theta)
    film: PadFilm = ring_of_pads(pad_film(mesh, heights, PadOil(1.0, SOMMERFELD), 1.0), pads)
    size = pad.outer_radius**2
    logarithms = np.log([
        film.forces[0],
        film.torque,
        film.inner_flow + film.outer_flow,
        film.stiffness[0, 0],
        film.damping[0, 0],
        pads * float(mesh.weights @ (mesh.r / heights)),
    ])
    tilts = film.stiffness[1, 1], film.stiffness[2, 1]
    relative = [each / (film.stiffness[0, 0] * size) for each in tilts]
    return [*logarithms.tolist(), *relative, film.damping[1, 1] / (film.damping[0, 0] * size)]
