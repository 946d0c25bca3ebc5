"""Biquadratic elements over one section, periodic in phi, whose faces follow grooves, pockets and bores.

scikit-fem owns elements, mapping and quadrature; what it evaluates at the quadrature points is laid out here for the
compiled solvers.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cells.mesh.openings import hole_area, wrapped
from frbcli.film.gap import Hole, Section, groove_pressure
from frbcli.film.grid import Array
from frbcli.film.published.mesh.bores import Box, hole_box, rounded

TURN = 2.0 * np.pi
SAME = 1e-9  # faces closer than this are one, rad and shares of the width
NO_HOLE = 1e-3  # of an element: a hole smaller than this supplies nothing


@dataclass(frozen=True)
class QuadraticMesh:
    """a x k elements of one section, a around and k along; element e = i k + j, node n = I (2 k + 1) + J.

    The node lines I = 0 .. 2 a - 1 lie around (line 2 a is line 0 again), their nodes J = 0 .. 2 k along. phi: rad, z:
    share of the width, both (2 a, 2 k + 1), of the nodes; fixed: (2 a, 2 k + 1) nodes with a given pressure: ends,
    grooves, holes; fixed_pressure: (2 a, 2 k + 1) scaled gauge pressure there; covered: (e,) elements within grooves
    and holes; nodes: (e, 9) of each element, local node 3 p + q at line 2 i + p, place 2 j + q.
    At 3 x 3 Gauss points of each element: values (9, 9) of the shape functions (point, node), slopes (e, 9, 9, 2) by
    phi and z (element, point, node, direction), area (e, 9) shares of the developed section (sum 2 pi), angle (e, 9)
    and height (e, 9), phi and z of the points.
    """

    section: Section
    around: int
    along: int
    phi: Array
    z: Array
    fixed: NDArray[np.bool_]
    fixed_pressure: Array
    covered: NDArray[np.bool_]
    nodes: NDArray[np.int64]
    values: Array
    slopes: Array
    area: Array
    angle: Array
    height: Array


def quadratic_mesh(section: Section, around: int, along: int) -> QuadraticMesh:
    """The mesh of a section with around x along elements, more where grooves and holes need more faces.

    The area of a hole is exact, unless it lies so close beside another that rectangles of their areas overlap.
    """
    element = TURN * section.radius * section.width / (around * along)
    holes = [hole for hole in section.holes if hole_area(section, hole) > NO_HOLE * element]
    boxes = [hole_box(section, hole) for hole in holes]
    spans = [(groove.position, 0.5 * groove.opening) for groove in section.grooves]
    spans += [(box.middle, box.half_angle) for box in boxes]
    edges = [middle + side * half for middle, half in spans for side in (-1.0, 1.0)]
    if section.lobes is not None:
        edges += [section.lobes.start + n * section.lobes.arc for n in range(section.lobes.count)]
    ring = _turn(np.array(edges), around)
    width = _pieces(np.unique(np.array([0.0, 1.0, *(edge for box in boxes for edge in (box.low, box.high))])), along)
    phi, z = np.meshgrid(_with_middles(ring), _with_middles(width), indexing="ij")
    pressure, within = _openings(section, holes, boxes, phi, z)
    fixed = within | (z == 0.0) | ((z == 1.0) & (section.far != "symmetry"))
    round_phi, round_z = phi, z
    for hole, box in zip(holes, boxes, strict=True):
        if box.round:
            round_phi, round_z = rounded(section, hole, box, round_phi, round_z, fixed)
    mesh = _evaluated(section, round_phi, round_z, fixed, within, pressure)
    # Where bores and the faces of others crowd, moved nodes may fold an element over; then the bores stay rectangles.
    folded = mesh.area.sum() > TURN * (1.0 + SAME)
    return _evaluated(section, phi, z, fixed, within, pressure) if folded else mesh


def _turn(edges: Array, around: int) -> Array:
    """(a + 1,) faces over one turn, rising, the given edges among them."""
    start = float(edges[0]) if len(edges) else 0.0
    places = np.sort(np.mod(edges - start + SAME, TURN) - SAME)
    return start + _pieces(np.concatenate([[0.0], places, [TURN]]), around)


def _pieces(breaks: Array, total: int) -> Array:
    """Faces from the first break to the last, about evenly; total elements or, if more, one between any two breaks."""
    breaks = breaks[np.append(True, np.diff(breaks) > SAME)]
    lengths = np.diff(breaks)
    counts = np.ones(len(lengths), dtype=np.int64)
    while counts.sum() < total:
        counts[np.argmax(np.round(lengths / counts, 12))] += 1
    faces = [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(itertools.pairwise(breaks), counts, strict=True)]
    return np.concatenate([*faces, breaks[-1:]])


def _with_middles(faces: Array) -> Array:
    """(2 n + 1,) faces and the middles between them."""
    both = np.empty(2 * len(faces) - 1)
    both[::2] = faces
    both[1::2] = 0.5 * (faces[1:] + faces[:-1])
    return both


def _openings(
    section: Section, holes: list[Hole], boxes: list[Box], phi: Array, z: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Given pressure at the nodes, and which of them lie in grooves and holes, edges counted; ends are ambient."""
    pressure, within = np.zeros_like(phi), np.zeros(phi.shape, dtype=bool)
    if section.far == "groove":
        pressure[:, -1] = section.far_pressure
    for groove in section.grooves:
        inside = np.abs(wrapped(phi - groove.position)) < 0.5 * groove.opening + SAME
        distance = z * section.width
        if section.far != "symmetry":
            distance = np.minimum(distance, section.bearing_width - distance)
        pressure = np.where(inside, groove_pressure(section, groove, distance), pressure)
        within |= inside
    for hole, box in zip(holes, boxes, strict=True):
        inside = (np.abs(wrapped(phi - box.middle)) < box.half_angle + SAME) & (z > box.low - SAME)
        inside &= z < box.high + SAME
        pressure = np.where(inside, hole.pressure, pressure)
        within |= inside
    return pressure / section.pressure_scale, within


def _evaluated(
    section: Section, phi: Array, z: Array, fixed: NDArray[np.bool_], within: NDArray[np.bool_], pressure: Array
) -> QuadraticMesh:
    """The mesh from its nodes (2 a + 1, 2 k + 1), the last line being the first one again."""
    lines, places = phi.shape
    around, along = lines // 2, places // 2
    basis, order = unrolled_basis(phi, z)
    # Local nodes and elements in the order of the lines: element (i, j), node (p, q)
    line, place = np.divmod(order[basis.element_dofs], places)  # (9, e) each
    first = np.argsort((line.min(axis=0) // 2) * along + place.min(axis=0) // 2)
    local = np.argsort(3 * (line - line.min(axis=0)) + place - place.min(axis=0), axis=0)[:, 0]
    nodes = (np.mod(line, lines - 1) * places + place)[local][:, first].T
    shapes = [basis.basis[n][0] for n in local]
    points = np.asarray(basis.global_coordinates())[:, first]
    return QuadraticMesh(
        section,
        around,
        along,
        phi[:-1],
        z[:-1],
        fixed[:-1],
        np.where(fixed, pressure, 0.0)[:-1],
        within.ravel()[nodes[:, 4]],
        np.ascontiguousarray(nodes, dtype=np.int64),
        np.ascontiguousarray(np.stack([np.asarray(shape)[0] for shape in shapes], axis=1)),
        np.ascontiguousarray(np.stack([shape.grad[:, first] for shape in shapes]).transpose(2, 3, 0, 1)),
        np.ascontiguousarray(basis.dx[first]),
        np.ascontiguousarray(points[0]),
        np.ascontiguousarray(points[1]),
    )


def unrolled_basis(phi: Array, z: Array) -> tuple[Any, NDArray[np.int64]]:
    """scikit-fem's basis on the nodes (2 a + 1, 2 k + 1), not yet joined at the seam.

    Returns it with the number I (2 k + 1) + J of the node at each of its degrees of freedom (n,).
    """
    from skfem import Basis, ElementQuad2, MeshQuad, MeshQuad2

    lines, places = phi.shape
    plain = MeshQuad2.from_mesh(MeshQuad.init_tensor(np.arange(lines // 2 + 1.0), np.arange(places // 2 + 1.0)))
    numbers = np.rint(2.0 * plain.doflocs).astype(np.int64)
    order = numbers[0] * places + numbers[1]
    mesh = MeshQuad2(np.array([phi.ravel()[order], z.ravel()[order]]), plain.t)
    return Basis(mesh, ElementQuad2(), intorder=5), order
