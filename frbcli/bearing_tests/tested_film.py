"""The contract of a film in kinematic tests, however it is computed: where it rests, one moment, a course; and the
films of the extended short bearing (appendix B): closed forms, no flow around that the pressure drives.

The torques of the short bearing follow from the motion and the force: Couette's term from the gap; the term of the
pressure is half the moment of the force about the middle of the shell, with any pressure in the film.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.history import PROBE, PROBE_WIDTH, Course, MovedFilm, film_course, history_of
from frbcli.bearing_tests.steady_film import (
    FilmField,
    FilmMoment,
    ForceOf,
    film_force,
    film_moment,
    modal_force,
    resting_displacement,
)
from frbcli.case.schema import Case
from frbcli.film.cells.film import Motion, Path, supply_share
from frbcli.film.cells.loads import FilmLoads, OilBalance, Torque
from frbcli.film.gap import Section, gap_height
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.end_flow import end_flow, make_end_flow
from frbcli.film.rectangles.film import FilmForce, evaluate, make_film
from frbcli.film.rectangles.short import ShortFilm, SuppliedShortFilm, sealed_shape
from frbcli.film.roughness.contact import Rubbing
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

UNKNOWN = math.nan
NO_MESH = Mesh(1, 1)
ANGLES = 720  # at which the largest pressure is sought
Report = Callable[[int], None]


def short_moment(plan: KinematicPlan, motion: Motion, share: float = 1.0) -> FilmMoment:
    """The film for a motion; what a short bearing does not know of its oil is NaN. share: of the supply pressure. The
    error is the theory's, against the film of finite length."""
    section = _rectangle(plan, share)
    film = _film(plan, section)
    vector = _force(section, film, motion).force
    force = float(vector[0]), float(vector[1])
    exact = modal_force(plan, motion) if share == 1.0 else (UNKNOWN, UNKNOWN)
    error = math.dist(force, exact) / math.hypot(*exact) if any(exact) else UNKNOWN
    return FilmMoment(_field(plan, section, film, motion), _loads(section, film, motion, force), error, 0, 0,
                      _side_flow(section, film, motion))  # fmt: skip


def short_force(_: Case, plan: KinematicPlan, __: tuple[int, int], motion: Motion, ___: FilmForce | None) -> FilmForce:
    """The force in a motion, as film_force of steady_film.py."""
    section = _rectangle(plan)
    return _force(section, _film(plan, section), motion)


def short_course(plan: KinematicPlan, rubbing: Rubbing, path: Path, times: Array) -> Course:
    """The film and its summits along a path at the times after the first; times: (n,) s."""
    moments = []
    for time in times[1:].tolist():
        motion, section = path(time), _rectangle(plan, _share(plan, time))
        film = _film(plan, section)
        x, y = _force(section, film, motion).force.tolist()
        along = PROBE_WIDTH * section.bearing_width / section.width
        probe = float(_pressures(section, film, motion, np.array([PROBE]), np.array([along]))[0, 0])
        gap = float(gap_height(section, motion.d, np.array([PROBE]))[0])
        loads = rubbing.loads(_loads(section, film, motion, (x, y)), motion)
        moments.append(MovedFilm(time, motion.d, loads, probe, gap, 0))
    worst = max(moments, key=lambda moment: moment.size)
    there = short_moment(plan, path(worst.time), _share(plan, worst.time))
    error = there.force_error * rubbing.share_of_error(there.loads, worst.loads)
    return Course(history_of(moments), there.field, worst.loads, error, 0, 0, "")


def _share(plan: KinematicPlan, time: float) -> float:
    """The share of the supply pressure at a time in s, as it rises (4.11)."""
    return supply_share(time, plan.ramp) if plan.ramp else 1.0


def _rectangle(plan: KinematicPlan, share: float = 1.0) -> Section:
    """The section with a share of its supply pressure."""
    assert plan.rectangle is not None
    return replace(plan.rectangle, far_pressure=share * plan.rectangle.far_pressure)


def _film(plan: KinematicPlan, section: Section) -> ShortFilm | SuppliedShortFilm:
    film = make_film(section, "short", plan.cavitation, NO_MESH)
    assert isinstance(film, ShortFilm | SuppliedShortFilm)
    return film


def _force(section: Section, film: ShortFilm | SuppliedShortFilm, motion: Motion) -> FilmForce:
    c = section.clearance
    return evaluate(film, c, c * np.array(motion.d), c * np.array(motion.v), motion.omega)


def _strength(film: ShortFilm | SuppliedShortFilm, section: Section, motion: Motion, phi: Array) -> Array:
    """A of P = A z (1 - z) + sigma z, see sealed_shape, with w = v - (omega/2) J d along n = (sin phi, -cos phi)."""
    (x, y), (v_x, v_y), half = motion.d, motion.v, 0.5 * motion.omega
    along = (v_x + half * y) * np.sin(phi) - (v_y - half * x) * np.cos(phi)
    return np.asarray(-0.5 * film.slenderness * along / gap_height(section, motion.d, phi) ** 3)


def _edges(section: Section, film: ShortFilm | SuppliedShortFilm) -> tuple[float, float]:
    """Scaled pressure of the supply, and that below which the film is clipped."""
    if isinstance(film, SuppliedShortFilm):
        return film.sigma, film.level
    return section.far_pressure / section.pressure_scale, 0.0 if film.clipped else -math.inf


def _pressures(
    section: Section, film: ShortFilm | SuppliedShortFilm, motion: Motion, phi: Array, z: Array
) -> Array:
    """(m, k) Pa absolute at angles phi (m,) and places z (k,) over the width of the rectangle."""
    sigma, level = _edges(section, film)
    a, b = sealed_shape(section.seals)
    scaled = _strength(film, section, motion, phi)[:, None] * (z * (1.0 - z) + a + (b - 1.0) * z) + sigma * (a + b * z)
    return np.asarray(section.ambient_pressure + section.pressure_scale * np.maximum(scaled, level))


def _field(
    plan: KinematicPlan, section: Section, film: ShortFilm | SuppliedShortFilm, motion: Motion
) -> FilmField:
    around, along = plan.cells
    phi = 2.0 * math.pi * (np.arange(around) + 0.5) / around
    z = (np.arange(along) + 0.5) / along
    pressure = _pressures(section, film, motion, phi, z * plan.section.width / section.width)
    return FilmField(phi, z, gap_height(section, motion.d, phi), pressure, np.ones_like(pressure))


def _loads(
    section: Section, film: ShortFilm | SuppliedShortFilm, motion: Motion, force: tuple[float, float]
) -> FilmLoads:
    d, (sigma, _) = np.array(motion.d), _edges(section, film)
    angles = 2.0 * math.pi * np.arange(ANGLES) / ANGLES
    strength = float(_strength(film, section, motion, angles).max())
    rise = sealed_shape(section.seals)[1] * (strength + sigma)  # at z = 0
    summit = min(0.5 * rise / strength, 1.0) if strength > 0.0 else 1.0  # along z, where A is largest
    pressures = _pressures(section, film, motion, angles, np.append(np.linspace(0.0, 1.0, 33), summit))
    resistance = section.viscosity * section.radius**3 * section.bearing_width / section.clearance
    couette = -resistance * 2.0 * math.pi / math.sqrt(1.0 - float(d @ d)) * motion.omega
    moment = section.clearance * float(d[0] * force[1] - d[1] * force[0])
    leaves = _side_flow(section, film, motion)
    return FilmLoads(
        force=force,
        torque=Torque(couette, -0.5 * moment),
        p_max=float(pressures.max()),
        p_min=float(pressures.min()),
        oil_fraction=UNKNOWN,
        oil=OilBalance(UNKNOWN, leaves, UNKNOWN, UNKNOWN, UNKNOWN),
    )


def _side_flow(section: Section, film: ShortFilm | SuppliedShortFilm, motion: Motion) -> float:
    """Oil that leaves through the open ends, m^3/s."""
    (x, y), (v_x, v_y), half = motion.d, motion.v, 0.5 * motion.omega
    return section.clearance * end_flow(make_end_flow(section, film), x, y, v_x + half * y, v_y - half * x, 1.0)


@dataclass(frozen=True)
class TestedFilm:
    """The film of a planned test of a case, as functions that raise NotConverged.

    rest(case, plan, load, omega): (2,) displacement over the clearance in which it carries a load in N along -y at
    omega rad/s. moment(case, plan, motion): the film for a motion that lasts. course(case, plan, path, times, report):
    the film along a path at the times (n,) in s, see film_course; report: called with the number of each moment.
    """

    __test__ = False  # no test case, whatever its name begins with

    rest: Callable[[Case, KinematicPlan, float, float], Array]
    moment: Callable[[Case, KinematicPlan, Motion], FilmMoment]
    course: Callable[[Case, KinematicPlan, Path, Array, Report | None], Course]


def _rest(force: ForceOf, case: Case, plan: KinematicPlan, load: float, omega: float) -> Array:
    return resting_displacement(case, plan, load, omega, force)


def _rubbing(force: ForceOf) -> ForceOf:
    """The force of a film including its summits."""

    def whole(
        case: Case, plan: KinematicPlan, cells: tuple[int, int], motion: Motion, near: FilmForce | None
    ) -> FilmForce:
        film, c = force(case, plan, cells, motion, near), plan.section.clearance
        return rubbing_of(case).with_summits(film, c * np.array(motion.d), c * np.array(motion.v), motion.omega)

    return whole


def _on_summits(case: Case, motion: Motion, film: FilmMoment) -> FilmMoment:
    """A film including its summits."""
    rubbing = rubbing_of(case)
    whole = rubbing.loads(film.loads, motion)
    return replace(film, loads=whole, force_error=film.force_error * rubbing.share_of_error(film.loads, whole))


SOLVED = TestedFilm(  # on finite volumes, or the modal film of a rectangular gap
    partial(_rest, _rubbing(film_force)),
    lambda case, plan, motion: _on_summits(case, motion, film_moment(case, plan, motion, plan.cells)),
    film_course,
)
SHORT = TestedFilm(
    partial(_rest, _rubbing(short_force)),
    lambda case, plan, motion: _on_summits(case, motion, short_moment(plan, motion)),
    lambda case, plan, path, times, _: short_course(plan, rubbing_of(case), path, times),
)


def tested_film(plan: KinematicPlan) -> TestedFilm:
    """The film of a planned test: of finite length or short."""
    return SHORT if plan.theory == "short" else SOLVED
