"""Forces, torques, pressures and oil flows of a finite-volume film."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import FRONTS
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution, gap_on
from frbcli.film.parabola import summit
from frbcli.film.roughness.asperities import shear_stress

CavitationFactor = Literal["none", "global", "local"]


@dataclass(frozen=True)
class OilBalance:
    """Oil through the whole bearing in m^3/s: in and out at ends, grooves and holes; supply, fed net by grooves and
    holes; ends, leaving net there; what does not balance over the larger of in and out."""

    in_m3_s: float
    out_m3_s: float
    supply_m3_s: float
    ends_m3_s: float
    defect_relative: float


@dataclass(frozen=True)
class GasBalance:
    """Free gas of the whole bearing. share: mean of its volume at the saturation pressure over the volume of the oil;
    in m^3/s at that pressure, in, out and what leaves the solution net; what does not balance over the gas that the oil
    carries, dissolved or not."""

    share: float
    in_m3_s: float
    out_m3_s: float
    released_m3_s: float
    defect_relative: float


@dataclass(frozen=True)
class Torque:
    """Torque of the film in N m by its two terms (3.17): added up on the journal, subtracted on the shell; summits: of
    the friction of rough surfaces on the journal and, in its sense of rotation, on the shell."""

    couette: float
    poiseuille: float
    summits: tuple[float, float] = (0.0, 0.0)

    @property
    def journal(self) -> float:
        """Torque on the journal."""
        return self.couette + self.poiseuille + self.summits[0]

    @property
    def shell(self) -> float:
        """Torque on the shell (section 3.2.4): the shear at its surface, in the journal's sense of rotation."""
        return self.couette - self.poiseuille + self.summits[1]


@dataclass(frozen=True)
class FilmLoads:
    """Loads of the whole bearing. force: on the journal in N; p_max, p_min: absolute, Pa; oil_fraction: mean (4.46);
    moment: of the force about the middle of the bearing in N m, NaN if not known; gas: None of oil without any."""

    force: tuple[float, float]
    torque: Torque
    p_max: float
    p_min: float
    oil_fraction: float
    oil: OilBalance
    moment: tuple[float, float] = (math.nan, math.nan)
    gas: GasBalance | None = None


def loads(
    film: VolumeFilm,
    motion: Motion,
    solution: VolumeSolution,
    slip: float | None = None,
    factor: CavitationFactor = "none",
) -> FilmLoads:
    """All loads of a solution.

    slip: omega_J - omega_S in rad/s, by default with a shell at rest; factor: how missing oil lowers the torque. """
    pressure, mean = film.pressure(solution.state), film.mean_pressure(solution.state)
    ambient = film.section.ambient_pressure
    scale = film.section.pressure_scale
    return FilmLoads(
        force=force(film, mean),
        torque=torque(film, motion, solution, motion.omega if slip is None else slip, factor),
        p_max=ambient + scale * peak(film, pressure),
        p_min=ambient + scale * float(np.min(pressure)),
        oil_fraction=oil_fraction(film, solution),
        oil=oil_balance(film, solution),
        moment=moment(film, mean),
        gas=gas_balance(film, solution),
    )


def force(film: VolumeFilm, pressure: Array) -> tuple[float, float]:
    """Force (3.13) in N of scaled gauge pressures (m, k) on the journal, that in grooves too, (4.8) to (4.10)."""
    return pushed(film, pressure)


def moment(film: VolumeFilm, pressure: Array) -> tuple[float, float]:
    """Moments in N m of the force about the x- and y-axes through the middle of the bearing, M_x = -z F_y and
    M_y = z F_x summed over the width; sections that are equal on both sides of it have none."""
    if film.section.copies != 1:
        return 0.0, 0.0
    x, y = pushed(film, film.section.width * (film.grid.height - 0.5) * pressure)
    return -y, x


def pushed(film: VolumeFilm, pressure: Array) -> tuple[float, float]:
    """(x, y) of the force in N of scaled gauge pressures (m, k), or of what else is given over the cells."""
    grid = film.grid
    along = film.section.force_scale * (film.weights * pressure).sum(axis=1)
    return float(-along @ np.diff(np.cos(grid.phi))), float(-along @ np.diff(np.sin(grid.phi)))


def pushing(film: VolumeFilm) -> Array:
    """(2, m, k) force in N on the journal per unit of the scaled pressure of each cell, as `pushed` sums it."""
    grid, weight = film.grid, film.section.force_scale * film.weights
    return np.stack([-np.diff(side(grid.phi))[:, None] * weight for side in (np.cos, np.sin)])


def torque(
    film: VolumeFilm, motion: Motion, solution: VolumeSolution, slip: float, factor: CavitationFactor = "none"
) -> Torque:
    """Torque (3.17) of the film; grooves and holes have none.

    slip: omega_J - omega_S in rad/s. factor: "none"; "global" multiplies by the mean oil fraction (4.46); "local"
    weighs each place with its own.
    """
    grid, section = film.grid, film.section
    theta = solution.state.fraction if factor == "local" else np.ones(grid.shape)
    pressure = film.mean_pressure(solution.state)
    area = section.area
    gap = gap_on(section, motion, grid.centre, grid.height)
    shear = (1.0 - grid.cover) * grid.size * theta / gap
    if section.flow_roughness > 0.0:
        shear *= shear_stress(gap * section.clearance / section.flow_roughness)
    pushing = film.weights * pressure
    rise = np.roll(pushing, -1, axis=0) - pushing
    at_faces = gap_on(section, motion, grid.phi[1:], grid.height)
    face = at_faces * 0.5 * (theta + np.roll(theta, -1, axis=0))
    whole = oil_fraction(film, solution) if factor == "global" else 1.0
    couette = -(section.radius**2) * section.viscosity / section.clearance * slip * area * float(shear.sum())
    poiseuille = -0.5 * section.clearance * area * section.pressure_scale * float((face * rise).sum())
    return Torque(whole * couette, whole * poiseuille)


def shear_weights(film: VolumeFilm, motion: Motion, factor: CavitationFactor) -> Array:
    """(m, k) of the oil fractions of the cells in the share of Couette's torque that missing oil leaves, see torque;
    their sum is 1, or 0 where it leaves all."""
    grid, section = film.grid, film.section
    area = (1.0 - grid.cover) * grid.size
    if factor == "local":
        gap = gap_on(section, motion, grid.centre, grid.height)
        area = area / gap
        if section.flow_roughness > 0.0:
            area *= shear_stress(gap * section.clearance / section.flow_roughness)
    return np.asarray(area / area.sum() if factor != "none" else 0.0 * area)


def oil_fraction(film: VolumeFilm, solution: VolumeSolution) -> float:
    """The factor (4.46): mean of theta over the film without grooves and holes."""
    area = (1.0 - film.grid.cover) * film.grid.size
    return float((area * solution.state.fraction).sum() / area.sum())


def oil_balance(film: VolumeFilm, solution: VolumeSolution) -> OilBalance:
    """The flows of a solution in m^3/s, by the whole bearing."""
    scale, flows = film.section.flow_scale, solution.flows
    return OilBalance(
        scale * flows.inflow, scale * flows.outflow, scale * flows.supply, scale * flows.ends, flows.defect
    )


def gas_balance(film: VolumeFilm, solution: VolumeSolution) -> GasBalance | None:
    """The free gas of a solution, by the whole bearing; None if its oil carries none."""
    scale, gas = film.section.flow_scale, solution.gas
    if gas is None:
        return None
    return GasBalance(gas.mean, scale * gas.inflow, scale * gas.outflow, scale * gas.released, gas.defect)


def peak(film: VolumeFilm, pressure: Array) -> float:
    """The largest scaled gauge pressure, between the cells' middles by a parabola in either direction."""
    grid = film.grid
    i, j = np.unravel_index(int(np.argmax(pressure)), pressure.shape)
    highest = float(pressure[i, j])
    if grid.fixed[i, j]:
        return highest
    m, k = grid.shape
    step = np.diff(grid.phi)
    before, behind = 0.5 * (step[i - 1] + step[i]), 0.5 * (step[i] + step[(i + 1) % m])
    _, around = summit(float(pressure[i - 1, j]), highest, float(pressure[(i + 1) % m, j]), before, behind)
    if j == 0 or k == 1:
        return around
    z = grid.height
    mirrored = j == k - 1
    above = highest if mirrored else float(pressure[i, j + 1])
    gap = 2.0 * (1.0 - z[j]) if mirrored else z[j + 1] - z[j]
    if mirrored and film.section.far != "symmetry":
        return around
    _, along = summit(float(pressure[i, j - 1]), highest, above, z[j] - z[j - 1], gap)
    return around + along - highest


def estimate(fine: tuple[float, float], coarse: tuple[float, float], order: float = FRONTS) -> float:
    """Relative error of a force from the same one on a mesh twice as coarse, by Richardson's extrapolation."""
    size = float(np.hypot(*fine))
    difference = float(np.hypot(fine[0] - coarse[0], fine[1] - coarse[1]))
    return difference / (2.0**order - 1.0) / size if size > 0.0 else 0.0
