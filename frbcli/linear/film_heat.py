"""What films at rest dissipate, and what oil leaves them: for the steady balance of heat.

Journal and shell put P = -M_J omega_J - M_S omega_S - F . (v_J - v_S) into a film. With Couette's resistance k to the
slip and the force F at the displacement e this is k (omega_J - omega_S)^2 + (e x F)(omega_J + omega_S)/2 - F . e'.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.case.schema import Case
from frbcli.film.cells.data import VolumeFilms
from frbcli.film.cells.loads import loads
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.side_flow import outflow
from frbcli.film.cells.steady_force import film_at, steady_solution
from frbcli.film.grid import Array
from frbcli.film.published.data import ElementFilm
from frbcli.film.rectangles.end_flow import EndFlow, end_flow, make_end_flow
from frbcli.scene.system import System

SLIP = 1  # row of System.turning


def end_flows(system: System) -> tuple[EndFlow, ...]:
    """The flows through the ends of tabulated films; none for films on cells, whose solution tells it."""
    if system.volumes:
        return ()
    assert not isinstance(system.films, VolumeFilms | ElementFilm)
    return tuple(make_end_flow(bearing, film) for bearing, film in zip(system.bearings, system.films, strict=True))


def film_heat(
    case: Case, system: System, flows: tuple[EndFlow, ...], journals: Array, omega: float, spins: Array
) -> tuple[Array, Array]:
    """Power in W and flow through the ends in m^3/s, (films,) each, of a machine at rest. journals (films, 2) in m;
    omega: of the rotor, spins: of the rings, rad/s. Raises NotConverged."""
    bodies = np.concatenate([[omega], spins])
    power, flow = np.empty(len(journals)), np.empty(len(journals))
    for i, place in enumerate(journals):
        total, slip = (float(system.turning[i, row] @ bodies) for row in (0, SLIP))
        if system.volumes:
            power[i], flow[i] = _on_cells(case, system, i, place, total, slip)
        else:
            power[i], flow[i] = _tabulated(system, flows[i], i, place, total, slip)
    return power, flow


def _tabulated(system: System, ends: EndFlow, i: int, place: Array, total: float, slip: float) -> tuple[float, float]:
    force, d = system.film_force(i, place, np.zeros(2), total).force, place / system.clearances[i]
    resistance = system.drags[i] * 2.0 * math.pi / math.sqrt(1.0 - float(d @ d))
    power = resistance * slip**2 + 0.5 * float(place[0] * force[1] - place[1] * force[0]) * total
    scale = 1.0 if system.scales is None else system.scales[i]
    w = 0.5 * total * np.array([d[1], -d[0]])
    leaving = end_flow(ends, float(d[0]), float(d[1]), float(w[0]), float(w[1]), scale)
    return power, system.clearances[i] * leaving


def _on_cells(case: Case, system: System, i: int, place: Array, total: float, slip: float) -> tuple[float, float]:
    film, d = system.volumes[i], place / system.clearances[i]
    motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total)
    solution, at = steady_solution(film, motion), film_at(film, math.hypot(*d), total)
    found = loads(at, motion, solution, slip, case.film.cavitation_factor)
    moment = float(place[0] * found.force[1] - place[1] * found.force[0])
    power = -found.torque.couette * slip + 0.5 * moment * total
    return power, outflow(at, motion.d, at.pressure(solution.state))
