"""A film in the published two-phase form under a moving journal, compiled: what is missing in its equations, its force,
its oil. The journal's motion is over the clearance: displacement d, velocity v in 1/s."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from frbcli.compiled import Array, compiled
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.published.data import BY_W, GIVEN, PRESSURE, RESIDUAL, RIGHTS, ElementFilm, Room
from frbcli.film.published.equations.assembly import (
    EDGE_VALUES,
    EDGE_WEIGHTS,
    LARGEST_EXPONENT,
    Elements,
    Gap,
    assemble,
)
from frbcli.film.published.equations.law import Step, oil_fraction
from frbcli.film.published.equations.ring import make_ring, solve_ring
from frbcli.film.published.equations.unknown import set_pressures_of

NARROWEST = 1e-3  # over the clearance: of the gap in which oil is sheared


@compiled(inline=True)
def _set_gap(film: ElementFilm, room: Room, d_x: float, d_y: float, v_x: float, v_y: float) -> None:
    """Height, slope and rate of the Gap in the room."""
    sine, cosine = film.elements.sine, film.elements.cosine
    height, slope, rate = room.gap[0], room.gap[1], room.gap[2]
    for e in range(sine.shape[0]):
        for q in range(9):
            height[e, q] = film.height[e, q] + d_x * sine[e, q] - d_y * cosine[e, q]
            slope[e, q] = film.slope[e, q] + d_x * cosine[e, q] + d_y * sine[e, q]
            rate[e, q] = v_x * sine[e, q] - v_y * cosine[e, q]


@compiled()
def set_openings(film: ElementFilm, room: Room, spin: float) -> None:
    """GIVEN of the room <- the pressures at openings that turn with spin rad/s."""
    for n in range(film.falls.shape[0]):
        room.nodes[GIVEN, n] = film.unknowns.given[n] - film.falls[n] * spin * spin


@compiled(internal=True)
def set_pressures(film: ElementFilm, room: Room, w: Array) -> None:
    """PRESSURE and BY_W of the room <- of the unknowns w (nodes,), with what is GIVEN there."""
    set_pressures_of(film.unknowns, film.step, w, room.nodes[GIVEN], room.nodes[PRESSURE], room.nodes[BY_W])


@compiled()
def residual(
    film: ElementFilm, room: Room, w: Array, past: Array, motion: GridMotion
) -> tuple[float, float]:  # fmt: skip
    """Assemble at the unknowns w (nodes,) with theta_t = theta / g - past, past (e, 9); the motion is seen from
    openings that turn with its spin. The derivatives are by the velocity at the end of a stage, seen from outside,
    which moves the journal by g times itself.

    Returns the size of the residual, and its share of the sum of its terms.
    """
    elements, pressure, by_w, total = film.elements, room.nodes[PRESSURE], room.nodes[BY_W], room.nodes[RESIDUAL]
    set_pressures(film, room, w)
    g, turned, terms = motion.g, motion.g * motion.spin, 1e-300
    _set_gap(film, room, motion.d_x, motion.d_y, motion.v_x, motion.v_y)
    gap = Gap(room.gap[0], room.gap[1], room.gap[2], 0.5 * motion.omega)
    assemble(elements, film.step, gap, pressure, by_w, motion.rate, past, room.matrix, room.derived)
    total[:] = 0.0
    for e in range(elements.nodes.shape[0]):
        for a in range(9):
            r = room.derived[e, a]
            room.right[e, a, 0] = r[0]
            room.right[e, a, 1] = g * r[1] + r[3] - turned * r[4]
            room.right[e, a, 2] = g * r[2] + r[4] + turned * r[3]
            total[elements.nodes[e, a]] += r[0]
            terms += abs(r[0])
    size, left = 0.0, 0.0
    for i in range(len(w)):
        size += total[i] ** 2
        left += abs(total[i])
    return math.sqrt(size), left / terms


@compiled(internal=True)
def force(film: ElementFilm, room: Room) -> tuple[float, float]:
    """Force on the journal by the PRESSURE of the room."""
    f_x, f_y, pressure = 0.0, 0.0, room.nodes[PRESSURE]
    for i in range(len(pressure)):
        f_x += film.weights[i, 0] * pressure[i]
        f_y += film.weights[i, 1] * pressure[i]
    return f_x, f_y


@compiled(internal=True, makes_arrays=True)
def solve(film: ElementFilm, room: Room) -> tuple[float, float, float, float, float, float]:
    """room.solution <- correction of the unknowns, and what the velocities do to them, from what residual has
    assembled. Returns the force after the correction and its derivatives by the velocity (xx, xy, yx, yy); the
    first is no number if a pivot has vanished."""
    ring = make_ring(room.solution.shape[0] // 2, room.solution.shape[1] // 2, RIGHTS)
    solve_ring(ring, room.matrix, room.right, room.solution)
    solution = room.solution.reshape(-1, RIGHTS)
    f_x, f_y = force(film, room)
    xx, xy, yx, yy, check = 0.0, 0.0, 0.0, 0.0, 0.0
    by_w = room.nodes[BY_W]
    for i in range(len(by_w)):
        x, y = film.weights[i, 0] * by_w[i], film.weights[i, 1] * by_w[i]
        f_x += x * solution[i, 0]
        f_y += y * solution[i, 0]
        xx += x * solution[i, 1]
        xy += x * solution[i, 2]
        yx += y * solution[i, 1]
        yy += y * solution[i, 2]
        check += abs(solution[i, 0]) + abs(solution[i, 1]) + abs(solution[i, 2])
    if not math.isfinite(check):
        f_x = math.nan
    return f_x, f_y, xx, xy, yx, yy


@compiled(internal=True)
def set_oil_fraction(film: ElementFilm, room: Room, w: Array, theta: Array) -> None:
    """theta (e, 9) <- at the points, by the unknowns w (nodes,)."""
    set_pressures(film, room, w)
    nodes, values = film.elements.nodes, film.elements.values
    for e in range(nodes.shape[0]):
        for q in range(9):
            here = 0.0
            for a in range(9):
                here += values[q, a] * room.nodes[PRESSURE, nodes[e, a]]
            theta[e, q] = oil_fraction(film.step, here)[0]


@compiled(internal=True)
def sheared(film: ElementFilm, theta: Array, d_x: float, d_y: float, local: bool) -> float:
    """Integral of 1 / H, or of theta / H, over the film outside of grooves and holes, theta (e, 9)."""
    sine, cosine, total = film.elements.sine, film.elements.cosine, 0.0
    for e in range(theta.shape[0]):
        for q in range(9):
            height = max(film.height[e, q] + d_x * sine[e, q] - d_y * cosine[e, q], NARROWEST)
            total += film.open_area[e, q] / height * (theta[e, q] if local else 1.0)
    return total


@compiled(internal=True)
def mean_oil_fraction(film: ElementFilm, theta: Array) -> float:
    """The factor (4.46) of oil fractions (e, 9)."""
    area, oil = 0.0, 0.0
    for e in range(theta.shape[0]):
        for q in range(9):
            area += film.open_area[e, q]
            oil += film.open_area[e, q] * theta[e, q]
    return oil / area


@compiled()
def oil_held(film: ElementFilm, d_x: float, d_y: float, theta: Array) -> float:
    """Oil in m^3 in the film, without grooves and holes, with oil fractions (e, 9)."""
    sine, cosine, total = film.elements.sine, film.elements.cosine, 0.0
    for e in range(theta.shape[0]):
        for q in range(9):
            height = film.height[e, q] + d_x * sine[e, q] - d_y * cosine[e, q]
            total += film.open_area[e, q] * height * theta[e, q]
    return film.volume * total


@compiled(makes_arrays=True)
def oil_passing(
    film: ElementFilm, room: Room, w: Array, past: Array, d_x: float, d_y: float, v_x: float, v_y: float,
    omega: float,
) -> tuple[float, float]:  # fmt: skip
    """Oil in m^3/s that comes in and that leaves, as oil_flows of loads.py has it; theta_t = -past (e, 9)."""
    elements, nodes, total = film.elements, film.elements.nodes, room.nodes[RESIDUAL]
    set_pressures(film, room, w)
    _set_gap(film, room, d_x, d_y, v_x, v_y)
    gap = Gap(room.gap[0], room.gap[1], room.gap[2], 0.5 * omega)
    # Without artificial diffusion and given pressures, the residual at a node is what enters there.
    undiffused = Elements(
        nodes, elements.values, elements.slopes, elements.area, elements.sine, elements.cosine, elements.length,
        np.zeros_like(elements.fixed), elements.solid, elements.near, elements.far, elements.aspect, -1.0,
        elements.prefactor, elements.exponent,
    )  # fmt: skip
    pressure, by_w = room.nodes[PRESSURE], room.nodes[BY_W]
    assemble(undiffused, film.step, gap, pressure, by_w, 0.0, past, room.matrix, room.derived)
    total[:] = 0.0
    through, out = 0.0, 0.0
    for e in range(nodes.shape[0]):
        for a in range(9):
            total[nodes[e, a]] -= room.derived[e, a, 0]
        if elements.solid[e]:
            through += _carried(elements, film.step, pressure, e, gap)
        if elements.near[e]:
            out += _through_end(elements, pressure, e, 0)
        if elements.far[e]:
            out += _through_end(elements, pressure, e, 2)
    came, left = max(through, 0.0), out - min(through, 0.0)
    for n in range(len(w)):
        if elements.fixed[n]:
            came += max(total[n], 0.0)
            left -= min(total[n], 0.0)
    return film.volume * came, film.volume * left


@compiled(internal=True)
def _carried(elements: Elements, step: Step, pressure: Any, e: int, gap: Gap) -> float:
    """Oil that the surfaces carry out of a groove or hole in element e, net."""
    total = 0.0
    for q in range(9):
        here, around = 0.0, 0.0
        for a in range(9):
            p = pressure[elements.nodes[e, a]]
            here += elements.values[q, a] * p
            around += elements.slopes[e, q, a, 0] * p
        theta, steep, _ = oil_fraction(step, here)
        total += elements.area[e, q] * gap.half * (gap.height[e, q] * steep * around + theta * gap.slope[e, q])
    return total


@compiled(internal=True)
def _through_end(elements: Elements, pressure: Any, e: int, place: int) -> float:
    """The outflow (4.36), (4.37) of element e through an end at its nodes 3 i + place."""
    total = 0.0
    for q in range(3):
        here = 0.0
        for a in range(3):
            here += EDGE_VALUES[q, a] * pressure[elements.nodes[e, 3 * a + place]]
        total += EDGE_WEIGHTS[q] * elements.prefactor * math.exp(min(elements.exponent * here, LARGEST_EXPONENT))
    return float(elements.length[e] * total)
