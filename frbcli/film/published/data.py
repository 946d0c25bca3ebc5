"""A film in the published two-phase form as arrays for the compiled kernels, and the room that it is solved in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array
from frbcli.film.published.equations.assembly import DIRECTIONS, Elements
from frbcli.film.published.equations.law import Step
from frbcli.film.published.equations.unknown import Unknowns, make_unknowns
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.newton import REFERENCES

PRESSURE, BY_W, RESIDUAL, GIVEN = range(4)
CAME, LEFT, HELD, BOOKS = range(4)  # oil through the film in m^3, or now in m^3/s; in it at the start of a run, or now
RIGHTS = 3  # what is missing, and its derivatives by both velocities


class ElementFilm(NamedTuple):
    """A film as it stays in a run, seen from its openings. unknowns: of the nodes; weights (nodes, 2): force on the
    journal in N per scaled pressure; height, slope (e, 9): H and dH/dphi of the centred journal at the points;
    open_area (e, 9): of the points outside of grooves and holes; falls (nodes,): by which given pressures fall per
    square of the speed of the openings, see centrifugal_pressures; volume: R b C of the whole bearing in m^3; along:
    elements."""

    elements: Elements
    step: Step
    unknowns: Unknowns
    weights: Array
    height: Array
    slope: Array
    open_area: Array
    falls: Array
    volume: float
    along: int


class Room(NamedTuple):
    """Scratch of the equations. matrix (e, 9, 9) and derived (e, 9, 5), as assembled; right (e, 9, RIGHTS), solution
    (2 a, 2 k + 1, RIGHTS); gap (3, e, 9): H, its slope, its rate; nodes (4, nodes): PRESSURE, its derivative BY_W by
    the unknown, the RESIDUAL there, and what is GIVEN at the speed of the openings. In few arrays: each of them costs
    compilation wherever it is handed on."""

    matrix: Array
    derived: Array
    right: Array
    solution: Array
    gap: Array
    nodes: Array


def element_film(film: PublishedFilm, centrifugal: float = 0.0) -> ElementFilm:
    """A film as the time loop takes it. centrifugal: see centrifugal_pressures."""
    section, elements, step = film.section, film.elements, film.step_law
    centred = film.gap(Motion((0.0, 0.0), (0.0, 0.0), 0.0))
    return ElementFilm(
        elements,
        step,
        make_unknowns(film.mesh, elements.fixed, step, REFERENCES[0] * step.cavity),
        np.ascontiguousarray(film.weights.reshape(-1, 2)),
        centred.height,
        centred.slope,
        np.where(elements.solid[:, None], 0.0, elements.area),
        np.where(np.isin(np.arange(elements.fixed.size), elements.nodes[elements.solid]), centrifugal, 0.0),
        section.copies * section.radius * section.width * section.clearance,
        film.mesh.along,
    )


def make_room(film: ElementFilm) -> Room:
    """Room for a film."""
    size, nodes, along = film.height.shape[0], film.weights.shape[0], film.along
    around, at_nodes = size // along, np.zeros((4, nodes))
    at_nodes[GIVEN] = film.unknowns.given
    return Room(
        np.zeros((size, 9, 9)),
        np.zeros((size, 9, 1 + DIRECTIONS)),
        np.zeros((size, 9, RIGHTS)),
        np.zeros((2 * around, 2 * along + 1, RIGHTS)),
        np.zeros((3, size, 9)),
        at_nodes,
    )
