"""Element matrices of the Reynolds equation (3.9), their action on pressures, and how they change with the motion."""

from __future__ import annotations

from numba import njit

from frbcli.film.quadratic.ring import COLUMN, PLACE, ROW


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def element_matrices(film, d_x, d_y):  # type: ignore[no-untyped-def]
    """Fill film.stiff: upper triangles of the matrices with H^3, and of their derivatives by d_x and d_y."""
    stiff = film.stiff
    for e in range(stiff.shape[0]):
        for entry in range(45):
            stiff[e, 0, entry] = stiff[e, 1, entry] = stiff[e, 2, entry] = 0.0
        for g in range(9):
            n_x, n_y = film.normal[e, g, 0], film.normal[e, g, 1]
            gap = film.depth[e, g] + d_x * n_x + d_y * n_y
            square = gap * gap
            cube, by_x, by_y = square * gap, 3.0 * square * n_x, 3.0 * square * n_y
            for entry in range(45):
                product = film.products[e, g, entry]
                stiff[e, 0, entry] += cube * product
                stiff[e, 1, entry] += by_x * product
                stiff[e, 2, entry] += by_y * product


@njit(cache=True, error_model="numpy")
def working_matrices(film, diagonal):  # type: ignore[no-untyped-def]
    """Fill film.working: the matrices with H^3 and diagonal (2 a, 2 k + 1) times the nodes' areas.

    Rows and columns of nodes with a given pressure keep their diagonal entry only.
    """
    flat, fixed = diagonal.ravel(), film.fixed.ravel()
    for e in range(film.working.shape[0]):
        s = film.working[e]
        for entry in range(45):
            s[entry] = film.stiff[e, 0, entry]
        for a in range(9):
            s[PLACE[a, a]] += film.mass[e, a] * flat[film.nodes[e, a]]
        if film.held[e]:
            for a in range(9):
                if fixed[film.nodes[e, a]] > 0.0:
                    for b in range(9):
                        if b != a:
                            s[PLACE[a, b]] = 0.0


@njit(cache=True, error_model="numpy")
def subtract_flow(film, pressure, right):  # type: ignore[no-untyped-def]
    """right (2 a, 2 k + 1) -= K P with H^3, of the elements in film.loaded; 0 where the pressure is given."""
    flat, p, fixed = right.ravel(), pressure.ravel(), film.fixed.ravel()
    for e in range(film.stiff.shape[0]):
        if film.loaded[e]:
            for entry in range(45):
                a, b = film.nodes[e, ROW[entry]], film.nodes[e, COLUMN[entry]]
                flat[a] -= film.stiff[e, 0, entry] * p[b]
                if a != b:
                    flat[b] -= film.stiff[e, 0, entry] * p[a]
    for node in range(len(flat)):
        if fixed[node] > 0.0:
            flat[node] = 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def change_of_force(film, pressure, adjoint, change):  # type: ignore[no-untyped-def]
    """change (2, 2), force by d: minus adjoint . dK/dd P, with the nodal pressure and the adjoint (2, 2 a, 2 k + 1)."""
    p, first, second = pressure.ravel(), adjoint[0].ravel(), adjoint[1].ravel()
    xx = xy = yx = yy = 0.0
    for e in range(film.stiff.shape[0]):
        for entry in range(45):
            a, b = film.nodes[e, ROW[entry]], film.nodes[e, COLUMN[entry]]
            by_first, by_second = first[a] * p[b], second[a] * p[b]
            if a != b:
                by_first += first[b] * p[a]
                by_second += second[b] * p[a]
            xx += film.stiff[e, 1, entry] * by_first
            xy += film.stiff[e, 2, entry] * by_first
            yx += film.stiff[e, 1, entry] * by_second
            yy += film.stiff[e, 2, entry] * by_second
    change[0, 0], change[0, 1], change[1, 0], change[1, 1] = -xx, -xy, -yx, -yy
