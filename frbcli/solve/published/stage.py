"""One implicit stage of rotor and film in the published two-phase form, solved together. Compiled.

The rotor is what a journal feels of it, u = u_0 + S F and x = x_0 + g u (stage.py); the film is its elements' equations
with theta_t = rate theta - past, rate = 1 / g (film/published/assembly.py). Newton's method runs on the unknowns of the
nodes and the two velocities at once: the film is solved with three right-hand sides, what is missing and its
derivatives by the velocities, then the two velocities from what is left. A correction is shortened where the residual
of the film grows: a steep step theta(p) has kinks.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.compiled import compiled
from frbcli.film.published.ring import solve_ring
from frbcli.film.published.unknown import pressures_of
from frbcli.solve.contact import push_back, shell_ahead
from frbcli.solve.journal_newton import reach
from frbcli.solve.published.equations import RIGHTS, residual
from frbcli.solve.stage import CORRECTION, FORCE, OMEGA, U_0, X_0, U, norm

ITERATIONS = 20
MEMORY = 4  # a residual has to be smaller than the largest of so many before it
SMALLEST_SHARE = 0.06  # of a correction
LARGEST_CORRECTION = 1.0  # of an unknown: the whole of a step theta(p)
PATIENCE = 5  # corrections without a smaller residual
NEWTON_SHARE = 0.1  # of the tolerance: what a correction squared leaves is far less
FILM_SETTLED = 1e-3  # correction of a node's unknown, of the order of 1, whose square is put up with
# Residual over the sum of its terms that is put up with where no correction makes it smaller, see film.TOLERATED.
TOLERATED = 1e-2
ENOUGH = 2e-3  # the same where the journal does not move any more


@compiled()
def _contact(f, d_x, d_y, clearance, g, contact_at, contact_stiffness):  # type: ignore[no-untyped-def]
    """Add the elastic contact to forces f (2, RIGHTS): its own, and by the velocity over the clearance."""
    f_x, f_y, k_xx, k_yy, k_xy = push_back(d_x, d_y, clearance, contact_at, contact_stiffness)
    f[0, 0] += f_x
    f[1, 0] += f_y
    f[0, 1] -= g * k_xx
    f[0, 2] -= g * k_xy
    f[1, 1] -= g * k_xy
    f[1, 2] -= g * k_yy


@compiled()
def _correction(equations, room, compliance, clearance, g, contact_at, contact_stiffness, film):  # type: ignore[no-untyped-def]
    """CORRECTION of the velocities, FORCE then; solution (nodes, 0) <- correction of the unknowns. Returns its largest
    entry, infinite if a pivot has vanished."""
    solve_ring(room.ring, room.matrix, room.right, room.solution)
    solution = room.solution.reshape(-1, RIGHTS)
    weights, by_w = equations.weights, room.by_w
    f = np.zeros((2, RIGHTS))
    for i in range(len(by_w)):
        for x in range(2):
            f[x, 0] += weights[i, x] * (room.pressure[i] + by_w[i] * solution[i, 0])
            f[x, 1] += weights[i, x] * by_w[i] * solution[i, 1]
            f[x, 2] += weights[i, x] * by_w[i] * solution[i, 2]
    d_x, d_y = (film[X_0, 0] + g * film[U, 0]) / clearance, (film[X_0, 1] + g * film[U, 1]) / clearance
    _contact(f, d_x, d_y, clearance, g, contact_at, contact_stiffness)
    s = compliance
    a = 1.0 - (s[0, 0] * f[0, 1] + s[0, 1] * f[1, 1]) / clearance
    b = -(s[0, 0] * f[0, 2] + s[0, 1] * f[1, 2]) / clearance
    c = -(s[1, 0] * f[0, 1] + s[1, 1] * f[1, 1]) / clearance
    d = 1.0 - (s[1, 0] * f[0, 2] + s[1, 1] * f[1, 2]) / clearance
    x = film[U_0, 0] - film[U, 0] + s[0, 0] * f[0, 0] + s[0, 1] * f[1, 0]
    y = film[U_0, 1] - film[U, 1] + s[1, 0] * f[0, 0] + s[1, 1] * f[1, 0]
    det = a * d - b * c
    u_x, u_y = (d * x - b * y) / det, (a * y - c * x) / det
    film[CORRECTION, 0], film[CORRECTION, 1] = u_x, u_y
    u_x, u_y = u_x / clearance, u_y / clearance
    for k in range(2):
        film[FORCE, k] = f[k, 0] + f[k, 1] * u_x + f[k, 2] * u_y
    largest = 0.0
    for i in range(len(by_w)):
        solution[i, 0] += solution[i, 1] * u_x + solution[i, 2] * u_y
        if not equations.unknowns.fixed[i]:
            largest = max(largest, abs(solution[i, 0]))
    return largest if math.isfinite(largest) and math.isfinite(u_x + u_y) else math.inf


@compiled()
def _put_up_with(  # type: ignore[no-untyped-def]
    equations, room, compliance, clearance, g, contact_at, contact_stiffness, tolerance, film
):
    """Take the film as it is at room.best: FORCE, and U that follows from it. Returns whether the journal then moves as
    the film was told, to the tolerance."""
    pressure = pressures_of(equations.unknowns, equations.step, room.best)[0]
    f = np.zeros((2, RIGHTS))
    for i in range(len(pressure)):
        for x in range(2):
            f[x, 0] += equations.weights[i, x] * pressure[i]
    d_x, d_y = (film[X_0, 0] + g * film[U, 0]) / clearance, (film[X_0, 1] + g * film[U, 1]) / clearance
    _contact(f, d_x, d_y, clearance, g, contact_at, contact_stiffness)
    x = film[U_0, 0] + compliance[0, 0] * f[0, 0] + compliance[0, 1] * f[1, 0]
    y = film[U_0, 1] + compliance[1, 0] * f[0, 0] + compliance[1, 1] * f[1, 0]
    off = norm(x - film[U, 0], y - film[U, 1]) * g / clearance
    film[FORCE, 0], film[FORCE, 1] = f[0, 0], f[1, 0]
    film[U, 0], film[U, 1] = x, y
    return off < tolerance


@compiled()
def solve_stage(  # type: ignore[no-untyped-def]
    equations, room, compliance, clearance, g, contact_at, contact_stiffness, tolerance, past, w, film
):
    """w (nodes,), U and FORCE of a stage, beginning from those given. tolerance: of a displacement over the
    clearance; past (e, 9): of theta_t.

    Returns (whether it is solved, residual over the sum of its terms before the last correction, assemblies).
    """
    omega, cost, since = film[OMEGA, 0], 1, 0
    d_x, d_y = (film[X_0, 0] + g * film[U, 0]) / clearance, (film[X_0, 1] + g * film[U, 1]) / clearance
    size, left = residual(equations, room, w, past, d_x, d_y, film[U, 0] / clearance, film[U, 1] / clearance, omega, g,
                          contact_at, contact_stiffness)  # fmt: skip
    sizes, least, change = np.full(MEMORY, size), math.inf, np.empty_like(w)
    best_size, best_x, best_y = math.inf, film[U, 0], film[U, 1]
    for iteration in range(ITERATIONS):
        if size < best_size:
            best_size, least, best_x, best_y, since = size, left, film[U, 0], film[U, 1], 0
            room.best[:] = w
        largest = _correction(equations, room, compliance, clearance, g, contact_at, contact_stiffness, film)
        since += 1
        if largest == math.inf or since > PATIENCE:
            break
        change[:] = room.solution.reshape(-1, RIGHTS)[:, 0]
        u_x, u_y = film[CORRECTION, 0], film[CORRECTION, 1]
        c_x, c_y = g * u_x / clearance, g * u_y / clearance
        end = shell_ahead(norm(d_x, d_y), contact_at, contact_stiffness)
        share = reach(d_x, d_y, c_x, c_y, end) * min(1.0, LARGEST_CORRECTION / largest)
        if share == 1.0 and norm(c_x, c_y) < NEWTON_SHARE * tolerance and largest < FILM_SETTLED:
            for i in range(len(w)):
                w[i] += change[i]
            film[U, 0] += u_x
            film[U, 1] += u_y
            return True, left, cost
        if iteration > 0 and left < ENOUGH and norm(c_x, c_y) < NEWTON_SHARE * tolerance:
            break  # the kinks of the film do not reach the journal
        target = sizes.max()
        while True:
            for i in range(len(w)):
                room.w[i] = w[i] + share * change[i]
            t_x, t_y = film[U, 0] + share * u_x, film[U, 1] + share * u_y
            d_x, d_y = (film[X_0, 0] + g * t_x) / clearance, (film[X_0, 1] + g * t_y) / clearance
            size, left = residual(equations, room, room.w, past, d_x, d_y, t_x / clearance, t_y / clearance, omega, g,
                                  contact_at, contact_stiffness)  # fmt: skip
            cost += 1
            if size < target or share < SMALLEST_SHARE:
                break
            share *= 0.5
        w[:] = room.w
        film[U, 0], film[U, 1] = t_x, t_y
        sizes[iteration % MEMORY] = size
    if not least < TOLERATED:
        return False, least, cost
    w[:] = room.best
    film[U, 0], film[U, 1] = best_x, best_y
    held = _put_up_with(equations, room, compliance, clearance, g, contact_at, contact_stiffness, tolerance, film)
    return held, least, cost
