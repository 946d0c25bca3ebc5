"""Flow through the open ends of a film made of rectangles, for the balance of its heat.

Before it is clipped the pressure is a sum of the fields of a unit w and of a hydrostatic part, and so is its slope at
an end. Where this is positive oil leaves; where it is negative, the film is clipped there, or draws in oil that is as
fresh as the supply's. With the slope of P(phi, z), scaled as in (3.9), at an end of a section of the width b

    Q = ends R^3 C / b * integral of max(H^3 dP/dz, 0) dphi.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from frbcli.arrays import Array
from frbcli.compiled import AS_KERNELS, compiled
from frbcli.film.gap import LARGEST_ECCENTRICITY, Section, groove_pressure
from frbcli.film.grid import AxialModes, Mesh, axial_modes, axial_vertices, ring_vertices
from frbcli.film.rectangles.chain import (
    DECAY,
    GROOVE,
    LOAD,
    NORMALS,
    PLACE,
    SHAPES,
    START,
    ChainFilm,
    element_matrices,
    mode_fields,
)
from frbcli.film.rectangles.chain import LENGTH as ELEMENT_LENGTH
from frbcli.film.rectangles.fields import CONTRACTION
from frbcli.film.rectangles.film_force import NEAR_CENTRE, FilmData
from frbcli.film.rectangles.modal import GAUSS_WEIGHTS, SHAPE, unit_fields
from frbcli.film.rectangles.short import ShortFilm, SuppliedShortFilm, sealed_shape
from frbcli.film.rectangles.table import DEPTH_STEP, eccentricity_axis

MESH = Mesh(axial=16, circumferential=96)  # of the fields: 0.1 % of the flow
COSINE, WEIGHT = range(2)  # rows of the ring
PARABOLA = 0.5  # slope at the ends of the solution of -P'' = 1


class TableEndFlow(NamedTuple):
    """unit: ends R^3/b in m^2; sigma: slope of the scaled pressure by the supply, 1/s; table (n, 2, p) of H^3 dP/dz by
    a unit w_r and w_t over half a turn; ring (2, p): cosines, weights of the integral."""

    unit: float
    sigma: float
    table: Array
    ring: Array


class ChainEndFlow(NamedTuple):
    """The flow through the ends between axial grooves. film: whose pressure it is; slopes (modes,) of the axial modes
    at an end; rest: what modes beyond these would add, over (w . n); corner: what they add next to an edge of a groove,
    whose pressure falls fast near the end, over H^3 there, 1/s."""

    unit: float
    film: ChainFilm
    slopes: Array
    rest: float
    corner: float


EndFlow = TableEndFlow | ChainEndFlow


def end_slopes(modes: AxialModes) -> Array:
    """(k,) slopes of the modes at z = 0: by the seal, or by the first quadratic element."""
    if modes.seals[0] > 0.0:
        return np.asarray(modes.shapes[:, 0] / modes.seals[0])
    slopes: Array = (4.0 * modes.shapes[:, 1] - modes.shapes[:, 2]) / modes.nodes[2]
    return slopes


def make_end_flow(section: Section, film: FilmData) -> EndFlow:
    """The flow through the ends of a bearing with this film, half-Sommerfeld or Sommerfeld."""
    radius, width = section.radius, section.width
    if isinstance(film, ChainFilm):
        modes = axial_modes(axial_vertices(MESH.axial), section.seals)
        kept = film.table.shape[2] - SHAPES
        slopes, loads = end_slopes(modes), modes.loads
        rest = PARABOLA - float(np.sum((slopes * loads / modes.eigenvalues)[:kept]))
        signs = np.sign(film.table[0, 0, LOAD, :kept]) * np.sign(loads[:kept])  # each mode may have either sign
        corner = _corner(section, modes, slopes, kept)
        return ChainEndFlow(
            2.0 * radius**3 / width, film, signs * slopes[:kept], -rest * (width / radius) ** 2, corner
        )
    ends = section.copies if section.far == "groove" else 2  # a groove at one end leaves one
    short = isinstance(film, ShortFilm | SuppliedShortFilm)
    table, ring = _slope_table(radius / width, short, section.seals)
    sigma = sealed_shape(section.seals)[1] * section.far_pressure / section.pressure_scale
    return TableEndFlow(ends * radius**3 / width, sigma, table, ring)


def _corner(section: Section, modes: AxialModes, slopes: Array, kept: int) -> float:
    """Integral of dP/dz at an end next to one edge of a groove, of the modes that are not kept: the pressure that they
    have in the groove decays with sqrt(lambda) R/b, before the gap changes."""
    groove = section.grooves[0]
    width = section.bearing_width
    pressure = groove_pressure(section, groove, np.minimum(modes.nodes, 1.0 - modes.nodes) * width)
    decay = np.sqrt(modes.eigenvalues) * section.radius / width
    return float(np.sum((slopes * modes.project(pressure) / decay)[kept:])) / section.pressure_scale


@lru_cache(maxsize=64)
def _slope_table(radius_to_width: float, short: bool, seals: tuple[float, float]) -> tuple[Array, Array]:
    """Table and ring of a TableEndFlow, which nobody writes to; kept, since neither viscosity nor clearance changes
    them and a balance of heat makes films of many."""
    vertices = ring_vertices(MESH.circumferential, CONTRACTION)
    ends = np.append(vertices, 2.0 * np.pi)
    theta = np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))[: MESH.circumferential + 1]
    steps = np.diff(theta)
    weights = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
    ring = np.array([np.cos(theta), weights])
    eccentricities = eccentricity_axis()
    rest, parabola = PARABOLA * sealed_shape(seals)[1], -(radius_to_width**-2) * np.array([ring[0], np.sin(theta)])
    table = np.zeros((len(eccentricities), 2, len(theta)))
    if not short:
        modes = axial_modes(axial_vertices(MESH.axial), seals)
        slopes = end_slopes(modes)
        rest -= float(np.sum(slopes * modes.loads / modes.eigenvalues))
        for i, eccentricity in enumerate(eccentricities):
            fields = unit_fields(vertices, eccentricity, radius_to_width**2 * modes.eigenvalues, modes.loads)
            cube = (1.0 + eccentricity * np.cos(theta)) ** 3
            table[i] = np.einsum("k,fkn->fn", slopes, fields[:2, :, : len(theta)]) * cube
    return table + rest * parabola, ring


@compiled(fastmath={"reassoc", "contract"})
def _leaving(
    table: Array, ring: Array, cell: int, a: float, eccentricity: float, w_r: float, w_t: float, sigma: float
) -> float:
    """Integral of max(H^3 dP/dz, 0) over the turn, at a share `a` of the way from a cell of the table to the next."""
    total = 0.0
    for i in range(ring.shape[1]):
        h = 1.0 + eccentricity * ring[COSINE, i]
        even = w_r * ((1.0 - a) * table[cell, 0, i] + a * table[cell + 1, 0, i]) + sigma * h * h * h
        odd = w_t * ((1.0 - a) * table[cell, 1, i] + a * table[cell + 1, 1, i])
        total += ring[WEIGHT, i] * (max(even + odd, 0.0) + max(even - odd, 0.0))
    return total


@compiled()
def table_end_flow(flow: TableEndFlow, d_x: float, d_y: float, w_x: float, w_y: float, scale: float) -> float:
    """Q over the clearance, m^2/s, of a film that turns with the line of centres.

    d: displacement over the clearance; w = d' - (omega/2) J d in 1/s; scale: by which pressures are larger for the same
    w than those that the film was made for.
    """
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    c, s = (d_x / eccentricity, d_y / eccentricity) if eccentricity > NEAR_CENTRE else (1.0, 0.0)
    eccentricity = min(eccentricity, LARGEST_ECCENTRICITY)
    w_r, w_t, sigma = c * w_x + s * w_y, c * w_y - s * w_x, flow.sigma / scale
    x = -math.log(1.0 - eccentricity) / DEPTH_STEP
    cell = min(int(x), flow.table.shape[0] - 2)
    return flow.unit * _leaving(flow.table, flow.ring, cell, x - cell, eccentricity, w_r, w_t, sigma)


@compiled(makes_arrays=True)
def chain_end_flow(flow: ChainEndFlow, d_x: float, d_y: float, w_x: float, w_y: float, scale: float) -> float:
    """The outflow of a film between axial grooves, which stand still; the ends of the grooves themselves are left
    out."""
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if eccentricity > LARGEST_ECCENTRICITY:
        d_x, d_y = d_x * LARGEST_ECCENTRICITY / eccentricity, d_y * LARGEST_ECCENTRICITY / eccentricity
    grid, axial = flow.film.grid, flow.film.table[0, 0]
    m = grid.shape[1]
    fields, slope = np.empty((5, 2 * m + 1)), np.zeros(2 * m + 1)
    along, across = np.empty((m, 3, 6)), np.empty((m, 3, 6))
    scratch = (np.empty((m, 6)), np.empty(m + 1), np.empty(m + 1))
    element_matrices(grid, d_x, d_y, along, across)
    for k in range(flow.slopes.shape[0]):
        mode_fields(
            grid, along, across, w_x, w_y, axial[DECAY, k], axial[LOAD, k], axial[GROOVE, k] / scale, scratch, fields
        )
        for i in range(2 * m + 1):
            slope[i] += flow.slopes[k] * fields[0, i]
    total = 0.0
    for e in range(m):
        for g in range(3):
            n_x, n_y = grid[NORMALS + g, e], grid[NORMALS + 3 + g, e]
            h = 1.0 + d_x * n_x + d_y * n_y
            at = SHAPE[0, g] * slope[2 * e] + SHAPE[1, g] * slope[2 * e + 1] + SHAPE[2, g] * slope[2 * e + 2]
            out = h * h * h * at + flow.rest * (w_x * n_x + w_y * n_y)
            total += GAUSS_WEIGHTS[g] * grid[ELEMENT_LENGTH, e] * max(out, 0.0)
        for edge in range(2):
            if int(grid[PLACE, e]) & (1 + edge):
                at = grid[START, e] + edge * grid[ELEMENT_LENGTH, e]
                total += flow.corner / scale * (1.0 + d_x * math.sin(at) - d_y * math.cos(at)) ** 3
    return flow.unit * total


_KINDS: dict[type, Callable[..., float]] = {TableEndFlow: table_end_flow, ChainEndFlow: chain_end_flow}


def end_flow(flow: EndFlow, d_x: float, d_y: float, w_x: float, w_y: float, scale: float) -> float:
    """Q over the clearance, m^2/s, of a film of either kind, see table_end_flow."""
    return _KINDS[type(flow)](flow, d_x, d_y, w_x, w_y, scale)


@overload(end_flow, jit_options=AS_KERNELS, inline="always")
def _end_flow(flow, d_x, d_y, w_x, w_y, scale):  # type: ignore[no-untyped-def]
    one = _KINDS[flow.instance_class]
    return lambda flow, d_x, d_y, w_x, w_y, scale: one(flow, d_x, d_y, w_x, w_y, scale)


@compiled(makes_arrays=True)
def end_flows(flow: EndFlow, motions: Array, scale: float) -> Array:
    """(k,) of end_flow in motions (k, 4) of d and w."""
    flows = np.empty(motions.shape[0])
    for i in range(motions.shape[0]):
        flows[i] = end_flow(flow, motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3], scale)
    return flows
