"""Quadratic elements on a pad, in the plane of angle and radius: values and slopes at the points of integration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad2, MeshQuad

from frbcli.arrays import Array
from frbcli.film.pads.geometry import Pad

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
