"""A film on quadratic elements as the compiled solvers see it: everything that does not depend on the motion."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.penalty import PREFACTOR
from frbcli.film.gap import Section, gap_height
from frbcli.film.grid import Array
from frbcli.film.quadratic.mesh import QuadraticMesh, quadratic_mesh
from frbcli.film.quadratic.ring import COLUMN, ROW, Ring, make_ring

Cavitation = Literal["sommerfeld", "half-sommerfeld", "penalty"]
PenaltyReading = Literal["absolute", "dimensionless"]
SOMMERFELD, HALF_SOMMERFELD, ABSOLUTE_PENALTY, DIMENSIONLESS_PENALTY = range(4)
FEWEST = (3, 2)  # elements around and along


class QuadraticFilm(NamedTuple):
    """One film on a mesh of e elements with 9 points and 9 nodes each; pressures are scaled and gauge, 1/s.

    law: SOMMERFELD | HALF_SOMMERFELD | ABSOLUTE_PENALTY | DIMENSIONLESS_PENALTY; force_scale: N s, from the integral of
    P n over one section to the force of the bearing; level: P_cav; prefactor: a of (3.31), 1/s or of the dimensionless
    pressure; steepness: of the pressure in (3.31) over 10^(4 - 2 eps), in s or of the dimensionless pressure.
    nodes (e, 9); normal (e, 9, 2): n at the points; depth (e, 9): H of the centred journal there; products (e, 9, 45):
    upper triangles of grad N_a . grad N_b over the area of a point; values (9, 9); area (e, 9); mass (e, 9): integrals
    of the shape functions, 0 where the pressure is given. At the nodes, (2 a, 2 k + 1): weight, sums of mass; moment
    (twice), integrals of n over the shape functions; push, load by 1 rad/s of the lobes' own wedge; fixed, 1 where the
    pressure is given, else 0; given, that pressure. held (e,): elements with a fixed node off the open ends; loaded
    (e,): elements with a pressure before the solution, with a penalty all, else those with a given one.
    Room, written at every call: stiff (e, 3, 45) element matrices of H^3 and of its derivatives by d_x and d_y; working
    (e, 45); ring.
    """

    law: int
    force_scale: float
    level: float
    prefactor: float
    steepness: float
    nodes: NDArray[np.int64]
    normal: Array
    depth: Array
    products: Array
    values: Array
    area: Array
    mass: Array
    weight: Array
    moment: Array
    push: Array
    fixed: Array
    given: Array
    held: NDArray[np.bool_]
    loaded: NDArray[np.bool_]
    stiff: Array
    working: Array
    ring: Ring


def quadratic_film(
    section: Section, cavitation: Cavitation, around: int, along: int, reading: PenaltyReading = "absolute"
) -> QuadraticFilm:
    """The film of a section on around x along elements, more where grooves and holes need them.

    reading: of the pressure in the penalty (3.31). Raises InputError for fewer elements than 3 x 2.
    """
    if around < FEWEST[0] or along < FEWEST[1]:
        problem, remedy = "the film needs at least 3 elements around and 2 along.", "Write a finer mesh: [10, 20]"
        raise InputError("film mesh", (Fault("accuracy.mesh", f"[{along}, {around}]", None, problem, remedy),))
    mesh = quadratic_mesh(section, around, along)
    scale = section.pressure_scale
    law, prefactor, steepness = {
        "sommerfeld": (SOMMERFELD, 0.0, 0.0),
        "half-sommerfeld": (HALF_SOMMERFELD, 0.0, 0.0),
        "absolute": (ABSOLUTE_PENALTY, PREFACTOR, scale / section.ambient_pressure),
        "dimensionless": (DIMENSIONLESS_PENALTY, 0.5 * PREFACTOR, 2.0),
    }[reading if cavitation == "penalty" else cavitation]
    normal = np.stack([np.sin(mesh.angle), -np.cos(mesh.angle)], axis=-1)
    depth = gap_height(section, (0.0, 0.0), mesh.angle)
    free = ~mesh.fixed
    moments = np.einsum("egc,eg,gn->cen", normal, mesh.area, mesh.values)
    wedge = 0.5 * np.einsum("eg,eg,egn->en", depth, mesh.area, mesh.slopes[..., 0])
    inner = mesh.fixed.copy()
    inner[:, 0] = False
    if section.far != "symmetry":
        inner[:, -1] = False
    elements = len(mesh.nodes)
    mass = (mesh.area @ mesh.values) * free.ravel()[mesh.nodes]
    return QuadraticFilm(
        law,
        section.copies * section.radius * section.width * scale,
        (section.cavitation_pressure - section.ambient_pressure) / scale,
        prefactor,
        steepness,
        mesh.nodes,
        np.ascontiguousarray(normal),
        depth,
        element_products(mesh),
        mesh.values,
        mesh.area,
        mass,
        _assembled(mesh, mass),
        np.stack([_assembled(mesh, moment) for moment in moments]),
        _assembled(mesh, wedge) * free,
        mesh.fixed.astype(np.float64),
        mesh.fixed_pressure,
        np.asarray(inner.ravel()[mesh.nodes].any(axis=1)),
        np.asarray((mesh.fixed_pressure.ravel()[mesh.nodes] != 0.0).any(axis=1) | (cavitation == "penalty")),
        np.zeros((elements, 3, 45)),
        np.zeros((elements, 45)),
        make_ring(mesh.around, mesh.along, section.far == "symmetry"),
    )


def element_products(mesh: QuadraticMesh) -> Array:
    """(e, 9, 45) upper triangles of what each point adds to an element matrix where H is 1, axial ones by (R/b)^2."""
    weights = np.array([1.0, mesh.section.aspect])
    whole = np.einsum("eg,egad,egbd,d->egab", mesh.area, mesh.slopes, mesh.slopes, weights, optimize=True)
    return np.ascontiguousarray(whole[:, :, ROW, COLUMN])


def _assembled(mesh: QuadraticMesh, parts: Array) -> Array:
    """(2 a, 2 k + 1) sums at the nodes of parts (e, 9)."""
    total = np.bincount(mesh.nodes.ravel(), parts.ravel(), minlength=mesh.phi.size)
    return np.asarray(total.reshape(mesh.phi.shape), dtype=np.float64)
