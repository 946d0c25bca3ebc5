"""One film of a bearing's sheet: what it does with its journal in a given place, solved on finite volumes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.case.oil import USUAL_TEMPERATURE
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.loads import estimate, force, loads
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.side_flow import outflow
from frbcli.film.cells.steady_force import film_at, steady_force, steady_solution
from frbcli.film.gap import gap_height
from frbcli.film.operating import sommerfeld_number
from frbcli.scene.system import System

Array = NDArray[np.float64]

HEAT_CAPACITY = 2000.0  # J/(kg K) of mineral oils within 10 % from 40 to 120 degC
DIFFERENCE = 1e-4  # of the gap, and of the velocity that moves the journal by it in 1 / omega
TURNS, ALIGNED = 40, 1e-7  # iterations of the attitude angle, and the angle in rad that ends them
SAMPLES = 720  # angles at which the smallest gap is looked for


@dataclass(frozen=True)
class FilmState:
    """One film in its resting position, SI units.

    speed_Hz: of the rotor; journal_speed_Hz, shell_speed_Hz: of the two bodies of the film; load: (2,) N on the journal
    by one bearing; displacement: (2,) of the journal over the clearance; attitude_deg: from the load line to the
    displacement, positive counter-clockwise; film_thickness_min in m; stiffness, damping: (2, 2) N/m and N s/m, -dF/dD
    and -dF/dD', of films that keep oil when this has settled; sommerfeld_number: (3.14), with omega_J + omega_S;
    torque: on the journal, N m; power: that journal and shell put into the film, W; side_flow: what leaves at the open
    ends, m^3/s, without what flows back into a groove; p_max: absolute, Pa; temperature_rise: of the oil that
    leaves, K, if it took all of the power; force_error: estimated, relative; viscosity: Pa s; clearance: m;
    temperature: of the film, K, NaN without heat; problem: why there is no state, then the numbers are NaN.
    """

    film: str
    speed_Hz: float
    journal_speed_Hz: float
    shell_speed_Hz: float
    load: Array
    displacement: Array
    attitude_deg: float = math.nan
    film_thickness_min: float = math.nan
    stiffness: Array | None = None
    damping: Array | None = None
    sommerfeld_number: float = math.nan
    torque: float = math.nan
    power: float = math.nan
    side_flow: float = math.nan
    p_max: float = math.nan
    temperature_rise: float = math.nan
    force_error: float = math.nan
    viscosity: float = math.nan
    clearance: float = math.nan
    temperature: float = math.nan
    problem: str = ""

    @property
    def eccentricity(self) -> float:
        """Relative eccentricity of the journal."""
        return math.hypot(*self.displacement)


def heat_capacity(case: Case) -> float:
    """The specific heat capacity in J/(kg K) of the temperature rise: given, or with heat that of the oil at 80 degC,
    else HEAT_CAPACITY."""
    if case.heat is not None:
        return case.oil.heat_capacity_at(USUAL_TEMPERATURE)
    return case.oil.heat_capacity or HEAT_CAPACITY


def under_vertical_load(film: VolumeFilm, eccentricity: float, omega: float) -> Array:
    """(2,) displacement over the clearance of this eccentricity at which the film's force points along y."""
    angle = -0.25 * math.pi if omega >= 0.0 else -0.75 * math.pi
    for _ in range(TURNS):
        d = (eccentricity * math.cos(angle), eccentricity * math.sin(angle))
        motion = Motion(d, (0.0, 0.0), omega)
        at = film_at(film, eccentricity, omega)
        solution = steady_solution(film, motion)
        f_x, f_y = force(at, film.mean_pressure(solution.state))
        if f_x == 0.0 and f_y == 0.0:
            raise NotConverged(f"The film carries nothing at an eccentricity of {eccentricity:g}.")
        off = math.remainder(0.5 * math.pi - math.atan2(f_y, f_x), 2.0 * math.pi)
        if abs(off) < ALIGNED:
            return np.array(d)
        angle += off
    raise NotConverged(f"No attitude angle was found at an eccentricity of {eccentricity:g}: off by {off:.2g} rad.")


def film_state(
    case: Case, fine: System, coarse: System, i: int, omega: float, spins: Array, place: Array
) -> FilmState:
    """The state of film i with its journal at `place` (2,) in m. Raises NotConverged."""
    film, c = fine.volumes[i], fine.clearances[i]
    section, d = film.section, place / c
    bodies = np.concatenate([[omega], spins])
    total, slip = (float(fine.turning[i, row] @ bodies) for row in (0, 1))
    journal, shell = 0.5 * (total + slip), 0.5 * (total - slip)
    motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), total)
    solution = steady_solution(film, motion)
    at = film_at(film, math.hypot(*d), total)
    found = loads(at, motion, solution, slip, case.film.cavitation_factor)
    slopes = steady_force(film, place, np.zeros(2), total, solution.w)
    k, damping = -slopes.by_displacement, -slopes.by_velocity
    if film.law.keeps_oil:
        k, damping = _differences(film, place, total)
    carried, load = np.array(found.force), -np.array(found.force)
    attitude = math.nan
    if carried.any() and d.any():
        attitude = math.degrees(math.atan2(load[0] * d[1] - load[1] * d[0], load @ d))
    power = -found.torque.journal * journal + found.torque.shell * shell
    flow = outflow(at, motion.d, at.pressure(solution.state))
    size, width = float(np.hypot(*carried)), section.bearing_width
    other = coarse.film_force(i, place, np.zeros(2), total).force
    phi = np.linspace(0.0, 2.0 * math.pi, SAMPLES, endpoint=False)
    return FilmState(
        film=fine.names[i],
        speed_Hz=omega / (2.0 * math.pi),
        journal_speed_Hz=journal / (2.0 * math.pi),
        shell_speed_Hz=shell / (2.0 * math.pi),
        load=load,
        displacement=d,
        attitude_deg=attitude,
        film_thickness_min=c * float(gap_height(section, motion.d, phi).min()),
        stiffness=k,
        damping=damping,
        sommerfeld_number=sommerfeld_number(size, width, section.radius, c, section.viscosity, total),
        torque=found.torque.journal,
        power=power,
        side_flow=flow,
        p_max=found.p_max,
        temperature_rise=power / (case.oil.density * heat_capacity(case) * flow) if flow > 0.0 else math.nan,
        force_error=estimate(found.force, (float(other[0]), float(other[1])), film.law.order),
        viscosity=section.viscosity,
        clearance=c,
    )


def _differences(film: VolumeFilm, place: Array, omega: float) -> tuple[Array, Array]:
    """Stiffness and damping (2, 2) of a film whose oil has settled in each of two neighbouring motions."""
    c = film.section.clearance
    step = DIFFERENCE * (c - float(np.hypot(*place)))
    pace = step * max(abs(omega), 1.0)
    stiffness, damping = np.empty((2, 2)), np.empty((2, 2))
    for column, unit in enumerate(np.eye(2)):
        ahead, behind = (_force(film, place + side * step * unit, np.zeros(2), omega) for side in (1.0, -1.0))
        stiffness[:, column] = -(ahead - behind) / (2.0 * step)
        ahead, behind = (_force(film, place, side * pace * unit, omega) for side in (1.0, -1.0))
        damping[:, column] = -(ahead - behind) / (2.0 * pace)
    return stiffness, damping


def _force(film: VolumeFilm, place: Array, velocity: Array, omega: float) -> Array:
    c = film.section.clearance
    d, v = place / c, velocity / c
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), omega)
    return np.array(force(film_at(film, math.hypot(*d), omega), film.pressure(steady_solution(film, motion).state)))


def no_state(name: str, speed: float, problem: str, eccentricity: float = math.nan) -> FilmState:
    """Of a film at a rotor speed in Hz for which there is none."""
    unknown = np.full(2, math.nan)
    return FilmState(name, speed, math.nan, math.nan, unknown, np.array([eccentricity, 0.0]), problem=problem)
