"""The equations of a film in the published two-phase form within a stage of the time loop, compiled: what is missing in
them, with the derivatives by the unknowns of the nodes and by the velocity of the journal."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from frbcli.film.cells.plain.balance import Motion
from frbcli.film.grid import Array
from frbcli.film.published.assembly import DIRECTIONS, Elements, Gap, assemble
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.law import Step
from frbcli.film.published.newton import REFERENCES
from frbcli.film.published.ring import Ring, make_ring
from frbcli.film.published.unknown import Unknowns, make_unknowns, pressures_of
from frbcli.film.rectangles.table import LARGEST_ECCENTRICITY
from frbcli.solve.stage import norm

RIGHTS = 3  # what is missing, and its derivatives by both velocities


class FilmEquations(NamedTuple):
    """What does not change in a run. unknowns: of the nodes; weights (nodes, 2): force on the journal in N per scaled
    pressure; height, slope (e, 9): H and dH/dphi of the centred journal at the points."""

    elements: Elements
    step: Step
    unknowns: Unknowns
    weights: Array
    height: Array
    slope: Array


class Room(NamedTuple):
    """Scratch. gap (3, e, 9): H, its slope, its rate; matrix (e, 9, 9) and its right sides; w, pressure, by_w, total
    (nodes,): of the trial, total being its residual; best (nodes,): unknowns with the smallest one; follow (2, 2, 2):
    see keep_a_gap."""

    ring: Ring
    matrix: Array
    derived: Array
    right: Array
    solution: Array
    gap: Array
    w: Array
    pressure: Array
    by_w: Array
    total: Array
    best: Array
    follow: Array


def film_equations(film: PublishedFilm) -> FilmEquations:
    """The equations of a film as solve_stage takes them."""
    centred = film.gap(Motion((0.0, 0.0), (0.0, 0.0), 0.0))
    step, reference = film.step_law, REFERENCES[0] * film.step_law.cavity
    unknowns = make_unknowns(film.mesh, film.elements.fixed, step, reference)
    weights = np.ascontiguousarray(film.weights.reshape(-1, 2))
    return FilmEquations(film.elements, step, unknowns, weights, centred.height, centred.slope)


def make_room(film: PublishedFilm) -> Room:
    """Scratch for the stages of a film."""
    mesh = film.mesh
    size, nodes = len(mesh.nodes), mesh.phi.size
    return Room(
        make_ring(mesh.around, mesh.along, RIGHTS),
        np.zeros((size, 9, 9)),
        np.zeros((size, 9, 1 + DIRECTIONS)),
        np.zeros((size, 9, RIGHTS)),
        np.zeros((*mesh.phi.shape, RIGHTS)),
        np.zeros((3, size, 9)),
        np.zeros(nodes),
        np.zeros(nodes),
        np.zeros(nodes),
        np.zeros(nodes),
        np.zeros(nodes),
        np.zeros((2, 2, 2)),
    )


@njit(cache=True, error_model="numpy")
def keep_a_gap(follow, d_x, d_y, v_x, v_y):  # type: ignore[no-untyped-def]
    """Displacement and velocity as the film feels them: a journal that has sunk into the shell, as far as an elastic
    contact lets it, leaves the gap that it had just before; it only moves along it. follow (2, 2, 2) <- derivatives of
    displacement and velocity by the displacement; the first is also that of the velocity by the velocity."""
    eccentricity = norm(d_x, d_y)
    follow[:] = 0.0
    follow[0, 0, 0] = follow[0, 1, 1] = 1.0
    if eccentricity <= LARGEST_ECCENTRICITY:
        return d_x, d_y, v_x, v_y
    share, n = LARGEST_ECCENTRICITY / eccentricity, (d_x / eccentricity, d_y / eccentricity)
    towards, along = n[0] * v_x + n[1] * v_y, n[0] * v_y - n[1] * v_x
    t = (-along * n[1], along * n[0])
    for i in range(2):
        for j in range(2):
            across = (1.0 if i == j else 0.0) - n[i] * n[j]
            follow[0, i, j] = share * across
            follow[1, i, j] = -share / eccentricity * (t[i] * n[j] + towards * across + n[i] * t[j])
    return share * d_x, share * d_y, share * t[0], share * t[1]


@njit(cache=True, error_model="numpy")
def residual(equations, room, w, past, d_x, d_y, v_x, v_y, omega, g):  # type: ignore[no-untyped-def]
    """Assemble at the unknowns w (nodes,). Returns the size of the residual, and its share of the sum of its terms."""
    elements = equations.elements
    d_x, d_y, v_x, v_y = keep_a_gap(room.follow, d_x, d_y, v_x, v_y)
    sine, cosine = elements.sine, elements.cosine
    height, slope, rate = room.gap[0], room.gap[1], room.gap[2]
    for e in range(sine.shape[0]):
        for q in range(9):
            height[e, q] = equations.height[e, q] + d_x * sine[e, q] - d_y * cosine[e, q]
            slope[e, q] = equations.slope[e, q] + d_x * cosine[e, q] + d_y * sine[e, q]
            rate[e, q] = v_x * sine[e, q] - v_y * cosine[e, q]
    pressure, by_w = pressures_of(equations.unknowns, equations.step, w)
    for i in range(len(w)):
        room.pressure[i], room.by_w[i] = pressure[i], by_w[i]
    gap = Gap(height, slope, rate, 0.5 * omega)
    assemble(elements, equations.step, gap, room.pressure, room.by_w, 1.0 / g, past, room.matrix, room.derived)
    follow, terms = room.follow, 1e-300
    room.total[:] = 0.0
    for e in range(sine.shape[0]):
        for a in range(9):
            r = room.derived[e, a]
            room.right[e, a, 0] = r[0]
            for k in range(2):
                by_x = (g * r[1] + r[3]) * follow[0, 0, k] + g * r[3] * follow[1, 0, k]
                by_y = (g * r[2] + r[4]) * follow[0, 1, k] + g * r[4] * follow[1, 1, k]
                room.right[e, a, 1 + k] = by_x + by_y
            room.total[elements.nodes[e, a]] += r[0]
            terms += abs(r[0])
    size, left = 0.0, 0.0
    for i in range(len(w)):
        size += room.total[i] ** 2
        left += abs(room.total[i])
    return math.sqrt(size), left / terms
