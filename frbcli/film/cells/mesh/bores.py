"""Cells about bores.

Cells around a bore that is no larger than a few of them, by the local solutions of Laplace's equation.

A bore is smaller than two cells of a usual mesh, so that straight falls of pressure from cell to cell miss what happens
around it. In the coordinates x = phi and y = z b / R it is a circle of radius a, and around it the pressure above its
own is a sum of

    ln(r / a),   (r^n - a^2n / r^n) cos(n t) and sin(n t),  n = 1, 2,   (a^2 - r^2) / 4,

the last one with a source of 1. Cells of the size h around and along that pass on what they differ by do not have ln(r
/ a) in a distance, but h^2 / 12 times cos(4 t) / r^2 less, and instead of cos(t) / r they have h^2 / 4 times cos(5 t) /
r^3 more: with these the solutions balance there up to the fourth order. The conductances between the cells around the
bore are changed as little as possible so that the flows which cells pass on dissipate what they do in these solutions:
of each two solutions P and Q,

    sum over the cells of P_i (flow of Q out of cell i) = 0.

The total flow for a given pressure in the distance is then correct for the bore, wherever it lies among the cells, as
with Peaceman's equivalent radius for wells in reservoirs. Likewise the areas by which cells count as a source are
chosen so that the solution with a source balances. With the areas of the force the integrals of the solutions over the
film are exact, less what parabolas over the width (boundaries.py) count at the ends for the oil that leaves. That count
is right for oil that comes out of the whole width; oil of a bore comes out where the solutions are exact.

Which cells lie around the bores of a section, and what the local solutions (bores.py) make of them.

Grooves, pockets and bores on the cells of a section: which cells they hold, where their edges are, their area.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.gap import NO_BATH, AxialGroove, Hole, Section

NO_HOLE = 1e-3  # of the cells at its middle: a hole smaller than this supplies nothing


class Opening(NamedTuple):
    """A groove or hole on cells. inside: (m, k) those whose middles it holds; around, along: (m, k) distances from the
    middle of a cell to its edge, in rad at the same z and over the width at the same phi, negative within; cover:
    (m, k) the share of each cell's area that it takes."""

    inside: NDArray[np.bool_]
    around: Array
    along: Array
    cover: Array


def groove_opening(groove: AxialGroove, phi: Array, z: Array) -> Opening:
    """A groove over the whole width on cells with the boundaries phi (m + 1,) in rad and z (k + 1,) over [0, 1]."""
    shape = len(phi) - 1, len(z) - 1
    half = 0.5 * groove.opening
    around = np.abs(wrapped(0.5 * (phi[1:] + phi[:-1]) - groove.position)) - half
    cover = _interval_cover(phi, groove.position, half)
    spread = np.broadcast_to(around[:, None], shape)
    return Opening(spread < 0.0, spread, np.full(shape, -np.inf), np.broadcast_to(cover[:, None], shape))


def hole_opening(section: Section, hole: Hole, phi: Array, z: Array, height: Array) -> Opening:
    """A bore or pocket on cells with the boundaries phi (m + 1,) in rad and z (k + 1,) over [0, 1].

    height: (k,) axial positions of their unknowns."""
    middle, half = hole.axial / section.width, hole.half_width / section.width
    across = np.abs(wrapped(0.5 * (phi[1:] + phi[:-1]) - hole.position))[:, None]
    along = np.abs(height - middle)[None, :]
    u, v = across / hole.half_angle, along / half
    if hole.round:
        inside = np.hypot(u, v) < 1.0
        reach_u, reach_v = np.sqrt(np.maximum(1.0 - v**2, 0.0)), np.sqrt(np.maximum(1.0 - u**2, 0.0))
        cover = _ellipse_cover(phi, z, hole, middle, half)
    else:
        inside = np.maximum(u, v) < 1.0
        reach_u, reach_v = np.ones_like(v), np.ones_like(u)
        cover = _interval_cover(phi, hole.position, hole.half_angle)[:, None] * _share(z, middle - half, middle + half)
    if not inside.any() and cover.max() > 0.0:
        inside = _at_middle(np.hypot(u, v), cover, np.diff(phi)[:, None] * np.diff(z))
    return Opening(inside, across - hole.half_angle * reach_u, along - half * reach_v, cover)


def bathed(section: Section, phi: Array) -> Array:
    """(m,) share of each cell with the boundaries phi (m + 1,) whose free ends lie in the bath at the bottom."""
    if section.bath <= NO_BATH:
        return np.zeros(len(phi) - 1)
    return _interval_cover(phi, math.pi, math.pi - math.acos(section.bath))


def wrapped(angle: Array) -> Array:
    """Angles brought to [-pi, pi)."""
    return np.asarray(np.mod(angle + math.pi, 2.0 * math.pi) - math.pi, dtype=np.float64)


def _at_middle(distance: Array, cover: Array, area: Array) -> NDArray[np.bool_]:
    """The cells nearest to the middle of a hole that is smaller than a cell, so that a coarse mesh does not close it.

    Cells at the same distance go together, so that symmetry is kept.
    """
    nearest = np.round(distance - distance.min(), 9) == 0.0
    enough = (cover * area).sum() > NO_HOLE * (nearest * area).sum()
    return np.asarray(nearest & enough, dtype=np.bool_)


def _interval_cover(phi: Array, position: float, half: float) -> Array:
    """(m,) share of each of the intervals between the angles phi (m + 1,) that lies within half of a position."""
    first = phi[0] + math.fmod(position - phi[0], 2.0 * math.pi)
    turns = first + 2.0 * math.pi * np.arange(-1, 2)
    return np.asarray(sum(_share(phi, float(at) - half, float(at) + half) for at in turns), dtype=np.float64)


def _share(faces: Array, low: float, high: float) -> Array:
    """(n,) share of each of the intervals between the faces (n + 1,) that lies between low and high."""
    return np.asarray(np.diff(np.clip(faces, low, high)) / np.diff(faces), dtype=np.float64)


def _ellipse_cover(phi: Array, z: Array, hole: Hole, middle: float, half: float) -> Array:
    """(m, k) share of each cell within an ellipse, exact."""
    first = phi[0] + math.fmod(hole.position - phi[0], 2.0 * math.pi)
    v = np.clip((z - middle) / half, -1.0, 1.0)
    area = np.zeros((len(phi) - 1, len(z) - 1))
    for turn in (-1, 0, 1):
        u = np.clip((phi - first - 2.0 * math.pi * turn) / hole.half_angle, -1.0, 1.0)
        area += np.diff(np.diff(_disk_corner(u[:, None], v[None, :]), axis=0), axis=1)
    return area * hole.half_angle * half / (np.diff(phi)[:, None] * np.diff(z))


def _disk_corner(u: Array, v: Array) -> Array:
    """Area of the unit disk left of the abscissa u and below the ordinate v, each in [-1, 1]; the shapes broadcast."""
    half_chord = np.sqrt(1.0 - v**2)
    sides = _below_circle(np.minimum(u, -half_chord)) + np.abs(v) * (np.clip(u, -half_chord, half_chord) + half_chord)
    sides = sides + _below_circle(np.maximum(u, half_chord)) - _below_circle(half_chord)
    return np.asarray(_below_circle(u) + np.sign(v) * sides, dtype=np.float64)


def _below_circle(t: Array) -> Array:
    """Area between the abscissa and the upper unit half circle from -1 to t in [-1, 1]."""
    return np.asarray(0.5 * (t * np.sqrt(1.0 - t**2) + np.arcsin(t)) + 0.25 * math.pi, dtype=np.float64)


Mask = NDArray[np.bool_]

# Weights of the aims of the conductances: total flow of the solutions, flow of each cell, no change.
TOGETHER, EACH, STAY = 100.0, 0.1, 0.01
AREAS = 1e3  # the same of what the areas should do, against a change of a whole cell that touches the bore
LEAST = 0.1  # of a conductance that remains: no cell is cut off
NEAR = 0.5  # of the size of a cell squared: so near to the middle of a bore its solution in a distance is none
LARGEST = 0.8  # change of an area over the area of its cell, for bores that are small in cells of very unequal sides
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


class Patch(NamedTuple):
    """Cells around the middle of a bore of radius a, lengths over R. x (nx + 2,), y (ny + 2,): middles of the cells and
    of the next ones beyond; dx (nx,), dy (ny,): sizes; held: (nx, ny) cells that represent the bore; open_: (nx, ny)
    area of the film in each cell; mirrored: whether the bore lies on a plane of symmetry at the end of y."""

    a: float
    x: Array
    y: Array
    dx: Array
    dy: Array
    held: Mask
    open_: Array
    mirrored: bool


class BoreFit(NamedTuple):
    """around (nx - 1, ny), along (nx, ny - 1): conductances between the cells; source, load (nx, ny): areas by which
    cells count in the balance and in the force, where held those in the force are what the other cells leave."""

    around: Array
    along: Array
    source: Array
    load: Array


def fit(patch: Patch, around: Array, along: Array) -> BoreFit:
    """Conductances near to around (nx - 1, ny) and along (nx, ny - 1) and areas that the local solutions ask for."""
    values = in_balances(patch, patch.x[1:-1], patch.y[1:-1])
    values[:, patch.held] = 0.0
    flows, beyond = _flows(values, around, along), _beyond(patch, values)
    flows[:, patch.held], beyond[:, patch.held] = 0.0, 0.0
    kept = np.clip(1.0 + _changes(patch, values[:-1], flows[:-1], beyond[:-1]), LEAST, None)
    split, chosen = around.size, _chosen(patch)
    out = beyond[-1] + flows[-1] @ kept  # of the solution with a source
    source = _areas(patch, values[chosen], _products(values[chosen], (out - patch.open_)[None])[:, 0])
    kept_around, kept_along = kept[:split].reshape(around.shape), kept[split:].reshape(along.shape)
    return BoreFit(around * kept_around, along * kept_along, source, _load(patch))


def solutions(x: Array, y: Array, a: float, mirrored: bool) -> Array:
    """(solutions, ...) of the pressure above the bore's at x, y of any shape, the one with a source of 1 last; odd
    functions of y only without a plane of symmetry there."""
    square = np.maximum(x**2 + y**2, 1e-300)
    q = a**2 / square
    odd = [] if mirrored else [y * (1.0 - q), 2.0 * x * y * (1.0 - q**2) / a]
    even = [0.5 * a * np.log(1.0 / q), x * (1.0 - q), (x**2 - y**2) * (1.0 - q**2) / a]
    return np.array([*even, *odd, 0.25 * (a**2 - square)])


def _chosen(patch: Patch) -> list[int]:
    """The solutions that areas hold to: ln r, the straight ones and that with a source."""
    return [0, 1, -1] if patch.mirrored else [0, 1, 3, -1]


def integrals(patch: Patch, values: Array) -> Array:
    """(n,) of the solutions that areas hold to over the film of the patch: exact in the cells that the bore cuts, by
    their middles in the others, as the cells' own rules have it."""
    size = np.outer(patch.dx, patch.dy)
    cut = patch.open_ < size * (1.0 - 1e-9)
    total = np.asarray((values * np.where(cut, 0.0, size)).sum(axis=(1, 2)))
    for i, j in np.argwhere(cut):
        x, y = patch.x[1 + i], patch.y[1 + j]
        total += _cut_cell(patch, x + 0.5 * patch.dx[i] * np.array([-1, 1]), y + 0.5 * patch.dy[j] * np.array([-1, 1]))
    return total


def in_balances(patch: Patch, x: Array, y: Array) -> Array:
    """(solutions, nx, ny) at all pairs of x (nx,) and y (ny,), in a distance as the balances of the cells have them:
    with what these add, which is 0 on the edge of the bore."""
    place, a = x[:, None] + 1j * y, patch.a
    values = solutions(place.real, place.imag, a, patch.mirrored)
    square = np.maximum(np.abs(place) ** 2, 1e-300)
    size = 0.5 * (patch.dx.mean() ** 2 + patch.dy.mean() ** 2)
    part = size * np.maximum(1.0 - a**2 / square, 0.0) / (1.0 + (NEAR * size / square) ** 4)
    values[0] -= a / 12.0 * part * (place**4).real / square**3
    dipole = 0.25 * a**2 * part * place**5 / square**4
    values[1] -= dipole.real
    if not patch.mirrored:
        values[3] -= dipole.imag
    return values


def _flows(values: Array, around: Array, along: Array) -> Array:
    """(solutions, nx, ny, faces) flow out of each cell through each face, those around first."""
    count, nx, ny = values.shape
    flows = np.zeros((count, nx, ny, around.size + along.size))
    i, j = (index.ravel() for index in np.indices(around.shape))
    face = np.arange(around.size)
    flow = around[i, j] * (values[:, i, j] - values[:, i + 1, j])
    flows[:, i, j, face], flows[:, i + 1, j, face] = flow, -flow
    i, j = (index.ravel() for index in np.indices(along.shape))
    face = around.size + np.arange(along.size)
    flow = along[i, j] * (values[:, i, j] - values[:, i, j + 1])
    flows[:, i, j, face], flows[:, i, j + 1, face] = flow, -flow
    return flows


def _beyond(patch: Patch, values: Array) -> Array:
    """(solutions, nx, ny) flow of the cells of the patch to those beyond it."""
    x, y, flow = patch.x, patch.y, np.zeros_like(values)
    for cell, other in ((0, 0), (-1, -1)):
        outside = in_balances(patch, x[[other]], y[1:-1])[:, 0]
        flow[:, cell] += patch.dy / abs(x[other] - x[1:-1][cell]) * (values[:, cell] - outside)
    for cell, other in ((0, 0),) if patch.mirrored else ((0, 0), (-1, -1)):
        outside = in_balances(patch, x[1:-1], y[[other]])[:, :, 0]
        flow[:, :, cell] += patch.dx / abs(y[other] - y[1:-1][cell]) * (values[:, :, cell] - outside)
    return flow


def _products(values: Array, fields: Array) -> Array:
    """(solutions, fields): sums over the cells of each solution times each of the fields (n, nx, ny)."""
    return np.asarray(np.tensordot(values, fields, axes=([1, 2], [1, 2])))


def _changes(patch: Patch, values: Array, flows: Array, beyond: Array) -> Array:
    """(faces,) relative changes of the conductances by which the solutions without a source balance."""
    count, faces = len(values), flows.shape[-1]
    pairs = np.einsum("aij,bijf->abf", values, flows)
    size = np.sqrt(np.abs(np.einsum("aaf->af", pairs)).sum(axis=1))
    left = _products(values, beyond) + pairs.sum(axis=2)
    rows, wanted = [STAY * np.eye(faces)], [np.zeros(faces)]
    for p, q in itertools.combinations_with_replacement(range(count), 2):
        weight = 0.5 * TOGETHER / (size[p] * size[q])
        rows.append(weight * (pairs[p, q] + pairs[q, p])[None])
        wanted.append(np.array([-weight * (left[p, q] + left[q, p])]))
    each = EACH * beyond[0].size / np.abs(flows).sum(axis=(1, 2, 3))[:, None, None]
    smallest = float(min(patch.dx.min(), patch.dy.min()))
    each = each * np.minimum(values[0] / smallest, 1.0)  # what does not balance near the edge flows into the bore
    rows.append((each[..., None] * flows).reshape(-1, faces))
    wanted.append((-each * (beyond + flows.sum(axis=3))).ravel())
    return _nearest(np.vstack(rows), np.concatenate(wanted))


def _nearest(matrix: Array, wanted: Array) -> Array:
    """(n,) of least squares. matrix (m, n) has rows that hold each of the n numbers: it is regular, and needs no
    singular values, which would take ten times as long."""
    base, upper = np.linalg.qr(matrix)
    return np.asarray(np.linalg.solve(upper, base.T @ wanted))


def _load(patch: Patch) -> Array:
    """(nx, ny) areas of the force. A pressure that is the same everywhere has the force that it has on all cells, also
    on the journal's side: the first moment of the areas stays."""
    size = np.outer(patch.dx, patch.dy)
    x, y = patch.x[1:-1, None] + 0.0 * patch.y[1:-1], patch.y[1:-1] + 0.0 * patch.x[1:-1, None]
    chosen = np.where(patch.held, 0.0, solutions(x, y, patch.a, patch.mirrored)[_chosen(patch)])
    lever = np.where(patch.held, 0.0, x - x[patch.held].mean())
    fields = np.concatenate([chosen, lever[None]])
    have = _products(fields, patch.open_[None])[:, 0]
    want = np.append(integrals(patch, chosen) - _by_parabolas(patch), (lever * size).sum())
    change = np.where(patch.held, 0.0, _areas(patch, fields, want - have) - size)
    return size + _limited(np.where(patch.held, -change.sum() / patch.held.sum(), change), size)


def _by_parabolas(patch: Patch) -> Array:
    """(n,) what parabolas over the width add to the integrals of the solutions that areas hold to by the flow into the
    bore, which leaves at the ends: h^2 / 24 of it for rows of the size h. Fewer than three have none."""
    rows = patch.held.any(axis=0)
    flow = (math.pi if patch.mirrored else 2.0 * math.pi) * patch.a
    flows = np.zeros(len(_chosen(patch)))
    flows[0], flows[-1] = flow, -0.5 * patch.a * flow
    return flows * float(np.mean(patch.dy[rows] ** 2)) / 24.0 * (len(patch.dy) >= 3)


def _areas(patch: Patch, fields: Array, lacking: Array) -> Array:
    """(nx, ny) areas close to the areas of the film, changed near the bore so that their sums with the fields (n, nx,
    ny) grow by what is lacking (n,); 0 where held."""
    size = np.outer(patch.dx, patch.dy)
    distance = np.hypot(patch.x[1:-1, None], patch.y[1:-1]) - patch.a
    close = np.where(patch.held, 0.0, size * np.exp(-(distance**2) / size))
    rows = (fields * close).reshape(len(fields), -1)
    scale = AREAS / np.abs(rows).sum(axis=1)
    matrix = np.vstack([rows * scale[:, None], np.eye(size.size)])
    changes = _nearest(matrix, np.concatenate([lacking * scale, np.zeros(size.size)]))
    change = np.where(patch.held, 0.0, patch.open_ + close * changes.reshape(size.shape) - size)
    return np.where(patch.held, 0.0, size + _limited(change, size))


def _limited(change: Array, size: Array) -> Array:
    """The changes (nx, ny) of areas, all by the same factor smaller where one is larger than LARGEST."""
    return np.asarray(change * LARGEST / max(LARGEST, float(np.abs(change / size).max())))


def _cut_cell(patch: Patch, x: Array, y: Array) -> Array:
    """(solutions,) integrals over the part of a cell x (2,), y (2,) outside of the bore, by lines along y."""
    a, total = patch.a, np.zeros(0)
    corners = np.sqrt(np.maximum(a**2 - y**2, 0.0))
    cuts = np.unique(np.clip(np.concatenate([x, [-a, a], corners, -corners]), *x))
    for low, high in itertools.pairwise(cuts):
        place, weight = 0.5 * (low + high + (high - low) * NODES), 0.5 * (high - low) * WEIGHTS
        chord = np.sqrt(np.maximum(a**2 - place**2, 0.0))
        for start, end in (
            (np.full_like(place, y[0]), np.clip(np.where(chord > 0.0, -chord, y[1]), *y)),
            (np.clip(np.where(chord > 0.0, chord, y[1]), *y), np.full_like(place, y[1])),
        ):
            line = 0.5 * ((start + end)[:, None] + (end - start)[:, None] * NODES)
            integrands = solutions(place[:, None] + 0.0 * line, line, a, patch.mirrored)[_chosen(patch)]
            part = np.asarray(integrands @ WEIGHTS) @ (0.5 * (end - start) * weight)
            total = part if not total.size else total + part
    return total


REACH = 2.5  # cells around a bore whose flows follow the local solutions; no more than half-way to the next opening
MOST = 1000  # cells of a patch: a bore that is so much larger than a cell needs none
WHOLE = 1e-9  # by which the middle of a bore may miss a plane of symmetry, or its shape a circle


class Cells(NamedTuple):
    """The parts of a grid that bores change, see VolumeGrid: around, at, area, load (m, k), along (m, k - 1)."""

    around: Array
    along: Array
    at: Array
    area: Array
    load: Array


class CellsAtBore(NamedTuple):
    """Columns and rows of the cells around a bore, and these."""

    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    patch: Patch


def around_bores(
    section: Section, phi: Array, z: Array, height: Array, inside: Sequence[Mask], cover: Array, plain: Cells
) -> Cells:
    """The cells with the flows and areas around the bores by the local solutions.

    phi (m + 1,), z (k + 1,): boundaries; height: (k,) of the unknowns; inside: (m, k) the cells that represent each
    hole of the section; cover: (m, k) share of a cell that openings take; plain: the cells without. """
    around, along, at, area, load = (values.copy() for values in plain)
    fits: dict[bytes, BoreFit] = {}
    width = section.width / section.radius
    for number in range(len(section.holes)):
        place = _place(section, phi, z, height, number, inside[number], cover)
        if place is None:
            continue
        columns, rows, patch = place
        cells, faces, between = np.ix_(columns, rows), np.ix_(columns[:-1], rows), np.ix_(columns, rows[:-1])
        dx, dy = patch.dx[:, None], patch.dy[None, :]
        at[faces] = _gap_places(at[faces], 0.5 * patch.dx, around[faces], patch.held)
        key = np.round(np.concatenate([patch.x, patch.y, patch.open_.ravel(), patch.held.ravel()]), 9).tobytes()
        if key not in fits:  # the bores of a ring often lie alike
            fits[key] = fit(patch, _over(dy, around[faces]), _over(dx, width * along[between]))
        near = fits[key]
        around[faces], along[between] = _over(dy, near.around), _over(dx, width * near.along)
        area[cells] = np.where(patch.held, area[cells], near.source / width)
        load[cells] = near.load / (dx * dy)
    return Cells(around, along, at, area, load)


def _gap_places(faces: Array, half: Array, around: Array, held: Mask) -> Array:
    """(nx - 1, ny) angles at which flows around take their gap: the faces (nx - 1, ny) between the cells, or half way
    from the middle of a cell to the edge of the bore. half: (nx,) of the cells' lengths; around: their distances."""
    before, behind = ~held[:-1] & held[1:], held[:-1] & ~held[1:]
    places = np.where(before, faces - half[:-1, None] + 0.5 * around, faces)
    return np.where(behind, faces + half[1:, None] - 0.5 * around, places)


def _over(length: Array, distance: Array) -> Array:
    """Conductances of faces of a length by distances, or the reverse; both 0 within an opening."""
    return np.where(distance > 0.0, length / np.where(distance > 0.0, distance, 1.0), 0.0)


def _place(
    section: Section, phi: Array, z: Array, height: Array, number: int, inside: Mask, cover: Array
) -> CellsAtBore | None:
    """The cells around a hole; None where it is no bore, or has no room for them."""
    hole, width = section.holes[number], section.width / section.radius
    a, middle, room = hole.half_angle, hole.axial / section.width, 0.5 * _distance_to_next(section, number)
    dx, dy = np.diff(phi), np.diff(z) * width
    x, y = wrapped(0.5 * (phi[1:] + phi[:-1]) - hole.position), (height - middle) * width
    around_it = np.abs(x) < a + dx  # the longer sides of the cells count
    reach = a + min(REACH * max(dx[around_it].max(), dy.max()), room)
    near_x, near_y = np.abs(x) < reach, np.abs(y) < reach
    columns, rows = np.flatnonzero(near_x), np.flatnonzero(near_y)
    columns = columns[np.argsort(x[columns])]
    held = inside[np.ix_(columns, rows)]
    has_room = len(columns) <= len(x) - 3 and held.size <= MOST and held.sum() == inside.sum() > 0
    if not (_is_bore(section, hole) and has_room and room >= max(dx[columns].max(), dy[rows].max())):
        return None
    beyond = np.array([columns[0] - 1, *columns, columns[-1] + 1]) % len(x)
    steps = 0.5 * (dx[beyond[1:]] + dx[beyond[:-1]])
    xs = x[columns[0]] - steps[0] + np.concatenate([[0.0], np.cumsum(steps)])
    low = y[rows[0] - 1] if rows[0] > 0 else y[0] - dy[0]
    high = y[rows[-1] + 1] if rows[-1] + 1 < len(y) else y[-1] + dy[-1]
    open_ = (1.0 - cover[np.ix_(columns, rows)]) * np.outer(dx[columns], dy[rows])
    ys = np.array([low, *y[rows], high])
    return CellsAtBore(columns, rows, Patch(a, xs, ys, dx[columns], dy[rows], held, open_, _mirrored(section, hole)))


def _mirrored(section: Section, hole: Hole) -> bool:
    return section.far == "symmetry" and abs(hole.axial - section.width) < WHOLE * section.width


def _is_bore(section: Section, hole: Hole) -> bool:
    """Whether a hole is round and no end cuts it."""
    circle = hole.round and abs(hole.half_width / section.radius - hole.half_angle) < WHOLE * hole.half_angle
    within = hole.half_width <= hole.axial and hole.axial + hole.half_width <= section.width
    return circle and (within or _mirrored(section, hole))


def _distance_to_next(section: Section, number: int) -> float:
    """Distance from the edge of a hole to the edge of the nearest other groove or hole, over R."""
    hole = section.holes[number]
    distances = [math.pi - hole.half_angle]
    for groove in section.grooves:
        distances.append(_between(groove.position, hole.position) - 0.5 * groove.opening - hole.half_angle)
    for other in section.holes[:number] + section.holes[number + 1 :]:
        across = max(_between(other.position, hole.position) - other.half_angle, 0.0)
        above = max(abs(other.axial - hole.axial) - other.half_width, 0.0) / section.radius
        distances.append(math.hypot(across, above) - hole.half_angle)
    return max(min(distances), 0.0)


def _between(one: float, other: float) -> float:
    """Angle between two, at most half a turn."""
    return abs(math.remainder(one - other, 2.0 * math.pi))
