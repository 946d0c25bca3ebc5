"""The equations of a film in the published two-phase form within a stage of the time loop, compiled: what is missing in
them, with the derivatives by the unknowns of the nodes and by the velocity of the journal."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.compiled import compiled
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.grid import Array
from frbcli.film.published.assembly import DIRECTIONS, Elements, Gap, assemble
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.law import Step
from frbcli.film.published.newton import REFERENCES
from frbcli.film.published.ring import Ring, make_ring
from frbcli.film.published.unknown import Unknowns, make_unknowns, pressures_of
from frbcli.solve.contact import feel

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
    (nodes,): of the trial, total being its residual; best (nodes,): unknowns with the smallest one."""

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
    )


@compiled()
def residual(  # type: ignore[no-untyped-def]
    equations, room, w, past, d_x, d_y, v_x, v_y, omega, g, contact_at, contact_stiffness
):
    """Assemble at the unknowns w (nodes,). Returns the size of the residual, and its share of the sum of its terms."""
    elements = equations.elements
    d_x, d_y, v_x, v_y, xx, yy, xy, turn_xx, turn_yy, turn_xy = feel(
        d_x, d_y, v_x, v_y, contact_at, contact_stiffness
    )
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
    rate_xx, rate_yy, rate_xy = xx + g * turn_xx, yy + g * turn_yy, xy + g * turn_xy  # of what is felt by the velocity
    terms = 1e-300
    room.total[:] = 0.0
    for e in range(sine.shape[0]):
        for a in range(9):
            r = room.derived[e, a]
            room.right[e, a, 0] = r[0]
            room.right[e, a, 1] = g * (r[1] * xx + r[2] * xy) + r[3] * rate_xx + r[4] * rate_xy
            room.right[e, a, 2] = g * (r[1] * xy + r[2] * yy) + r[3] * rate_xy + r[4] * rate_yy
            room.total[elements.nodes[e, a]] += r[0]
            terms += abs(r[0])
    size, left = 0.0, 0.0
    for i in range(len(w)):
        size += room.total[i] ** 2
        left += abs(room.total[i])
    return math.sqrt(size), left / terms
