"""Half-Sommerfeld films (3.29), and Sommerfeld ones: a linear problem, clipped when the loads are taken."""

from __future__ import annotations

import numpy as np
from numba import njit

from frbcli.film.quadratic.operator import subtract_flow, working_matrices
from frbcli.film.quadratic.ring import factorise
from frbcli.film.quadratic.ring_solve import solve


@njit(cache=True, error_model="numpy")
def solve_linear(film, pressure, w_x, w_y, omega):  # type: ignore[no-untyped-def]
    """Fill pressure (1, 2 a, 2 k + 1), zeros before, with Sommerfeld's; needs film.stiff, leaves the factors."""
    right = pressure[0]
    working_matrices(film, right)
    factorise(film.ring, film.working)
    for line in range(right.shape[0]):
        for place in range(right.shape[1]):
            right[line, place] = (
                omega * film.push[line, place]
                - w_x * film.moment[0, line, place]
                - w_y * film.moment[1, line, place]
            )
    subtract_flow(film, film.given, right)
    solve(film.ring, pressure)
    for line in range(right.shape[0]):
        for place in range(right.shape[1]):
            right[line, place] += film.given[line, place]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def clipped_loads(film, pressure, adjoint):  # type: ignore[no-untyped-def]
    """Integrals of (P - level) n over the points where P > level, x and y, from the nodal pressure (2 a, 2 k + 1).

    adjoint (2, 2 a, 2 k + 1) <- their derivatives by the nodal pressures.
    """
    p, first, second = pressure.ravel(), adjoint[0].ravel(), adjoint[1].ravel()
    local = np.empty((3, 9))
    for node in range(len(p)):
        first[node] = second[node] = 0.0
    f_x = f_y = 0.0
    for e in range(film.nodes.shape[0]):
        above = False
        for a in range(9):
            local[0, a] = p[film.nodes[e, a]] - film.level
            local[1, a] = local[2, a] = 0.0
            above = above or local[0, a] > 0.0
        if above:
            for g in range(9):
                height = 0.0
                for a in range(9):
                    height += film.values[g, a] * local[0, a]
                if height > 0.0:
                    n_x, n_y = film.area[e, g] * film.normal[e, g, 0], film.area[e, g] * film.normal[e, g, 1]
                    f_x += n_x * height
                    f_y += n_y * height
                    for a in range(9):
                        local[1, a] += n_x * film.values[g, a]
                        local[2, a] += n_y * film.values[g, a]
            for a in range(9):
                first[film.nodes[e, a]] += local[1, a]
                second[film.nodes[e, a]] += local[2, a]
    return f_x, f_y
