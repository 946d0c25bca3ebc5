"""Loads and oil balance of a solution of the published form: it creates oil, and here is how much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cells.loads import CavitationFactor, FilmLoads, OilBalance, Torque
from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.plain import AROUND_DIRECTION, terms
from frbcli.film.published.solution import PublishedSolution


@dataclass(frozen=True)
class OilFlows:
    """Oil flows of the whole bearing in m^3/s: in and out at ends, grooves and holes, summed node by node; supply, fed
    net by grooves and holes; ends, leaving net there; stored, by which the oil in the film grows."""

    inflow: float
    outflow: float
    supply: float
    ends: float
    stored: float


def published_loads(
    film: PublishedFilm, solution: PublishedSolution, slip: float | None = None, factor: CavitationFactor = "none"
) -> FilmLoads:
    """All loads of a solution.

    slip: omega_J - omega_S in rad/s, else that of a shell at rest; factor: how missing oil lowers the torque, see
    frbcli/film/cells/loads.py.
    """
    section, pressure = film.section, solution.state.pressure
    absolute = section.ambient_pressure + section.pressure_scale * pressure
    return FilmLoads(
        force=(float(solution.response.force[0]), float(solution.response.force[1])),
        torque=torque(film, solution, solution.motion.omega if slip is None else slip, factor),
        p_max=float(absolute.max()),
        p_min=float(absolute.min()),
        oil_fraction=oil_fraction(film, solution),
        oil=oil_balance(film, solution),
    )


def oil_fraction(film: PublishedFilm, solution: PublishedSolution) -> float:
    """The factor (4.46): mean of theta over the film without grooves and holes."""
    area = open_area(film)
    return float((area * solution.state.fraction).sum() / area.sum())


def torque(
    film: PublishedFilm, solution: PublishedSolution, slip: float, factor: CavitationFactor = "none"
) -> Torque:
    """Torque (3.17) of the film; grooves and holes have none."""
    section, gap, area = film.section, film.gap(solution.motion), open_area(film)
    theta = solution.state.fraction if factor == "local" else 1.0
    rise = film.mesh.slopes[..., AROUND_DIRECTION]
    around = np.einsum("eqa,ea->eq", rise, solution.state.pressure.ravel()[film.mesh.nodes])
    size = section.copies * section.radius * section.width
    size *= oil_fraction(film, solution) if factor == "global" else 1.0
    shear = -(section.radius**2) * section.viscosity / section.clearance * slip
    couette = shear * float((area * theta / gap.height).sum())
    poiseuille = -0.5 * section.clearance * section.pressure_scale * float((area * gap.height * theta * around).sum())
    return Torque(size * couette, size * poiseuille)


def oil_balance(film: PublishedFilm, solution: PublishedSolution) -> OilBalance:
    """The flows of a solution in m^3/s, by the whole bearing; the defect is less than zero where oil is created."""
    flows = oil_flows(film, solution.motion, solution.state.pressure, solution.rate, solution.past)
    size = max(flows.inflow, flows.outflow, abs(flows.stored))
    missing = flows.inflow - flows.outflow - flows.stored
    return OilBalance(
        flows.inflow, flows.outflow, flows.supply, flows.ends, defect_relative=missing / size if size > 0.0 else 0.0
    )


def oil_flows(film: PublishedFilm, motion: Motion, pressure: Array, rate: float, past: Array) -> OilFlows:
    """The flows at scaled gauge pressures (2 a, 2 k + 1) of the nodes with theta_t = rate theta - past, past (e, 9).

    What enters at given pressures is what the weak form leaves over at their nodes. Artificial diffusion is no flow:
    the oil that it brings from there into the film counts as created.
    """
    elements, mesh = film.elements, film.mesh
    scale = film.section.copies * film.section.radius * film.section.width * film.section.clearance
    theta, slope = film.law.fraction(film.over_cavitation(film.at_points(pressure)))
    parts = terms(elements, film.gap(motion), pressure.ravel(), theta, slope / film.cavity, rate * theta - past)
    through = float(parts.carried[elements.solid].sum())  # from grooves and holes by the surfaces, net
    residual = parts.residual - parts.spread
    residual[elements.solid] = 0.0
    entering = np.bincount(mesh.nodes.ravel(), weights=residual.ravel(), minlength=pressure.size)
    entering = np.where(elements.fixed, entering, 0.0)
    fed = np.append(entering[~_at_ends(film)], through)
    free = float(parts.near.sum() + parts.far.sum())
    flows = np.append(entering, [through, -free])
    return OilFlows(
        inflow=scale * float(flows[flows > 0.0].sum()),
        outflow=-scale * float(flows[flows < 0.0].sum()),
        supply=scale * float(fed.sum()),
        ends=scale * (free - float(entering[_at_ends(film)].sum())),
        stored=scale * float(parts.stored.sum()),
    )


def _at_ends(film: PublishedFilm) -> NDArray[np.bool_]:
    """(nodes,) whether a node lies at an end in an oil bath, and in no groove."""
    section, mesh = film.section, film.mesh
    ends = np.zeros(mesh.phi.shape, dtype=bool)
    ends[:, 0] = section.near == "oil-bath"
    ends[:, -1] |= section.far == "oil-bath"
    ends.ravel()[mesh.nodes[mesh.covered].ravel()] = False
    return ends.ravel()


def open_area(film: PublishedFilm) -> Array:
    """(e, 9) area of the points outside of grooves and holes."""
    return np.where(film.mesh.covered[:, None], 0.0, film.mesh.area)
