"""One film of a bearing's sheet: what it does with its journal at rest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.oil import USUAL_TEMPERATURE
from frbcli.case.schema import Case
from frbcli.equilibrium.linearised import LEAST, RestingFilm, TiltingFilm, force_error, settled_force
from frbcli.equilibrium.static_films import FieldFilms, StaticFilms
from frbcli.errors import NotConverged
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.loads import CavitationFactor, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import friction_coefficient, gap_height, sommerfeld_number
from frbcli.film.kinds.contract import FieldFilm
from frbcli.film.rectangles.film import FilmForce
from frbcli.film.roughness.asperities import rub
from frbcli.scene.machine.system import System

HEAT_CAPACITY = 2000.0  # J/(kg K) of mineral oils within 10 % from 40 to 120 degC
TURNS, ALIGNED = 40, 1e-7  # iterations of the attitude angle, and the angle in rad that ends them
SLOW = 0.6  # share of the angle that an iteration leaves, above which the next one follows from the last two
NO_FLOW = 1e-9  # of the flow that the surfaces draw along
SAMPLES = 720  # angles at which the smallest gap is looked for


@dataclass(frozen=True)
class MixedFriction:
    """What the summits of rough surfaces do in a film. share: of the load that they carry; torque: on the journal, N m;
    power: W; film_parameter: smallest gap over the roughness; share_error, power_error: expected ones by the error of
    the place."""

    share: float
    torque: float
    power: float
    film_parameter: float
    share_error: float = math.nan
    power_error: float = math.nan

    @classmethod
    def of(cls, system: System, i: int, at_rest: RestingFilm, slip: float, shell: float) -> MixedFriction | None:
        """Mixed friction of film i at rest; slip and speed of the shell in rad/s; None between smooth surfaces."""
        if system.asperities is None:
            return None
        own, out = (cls._at(system, i, each, slip, shell) for each in (at_rest, _further_out(at_rest)))
        return replace(own, share_error=abs(out.share - own.share), power_error=abs(out.power - own.power))

    @classmethod
    def _at(cls, system: System, i: int, at_rest: RestingFilm, slip: float, shell: float) -> MixedFriction:
        rough, c = system.asperities, system.clearances[i]
        assert rough is not None
        (e_x, e_y), load = (c * at_rest.displacement).tolist(), np.array(at_rest.load)
        rubbed = rub(rough, i, c, e_x, e_y, 0.0, 0.0, slip, shell)
        size = float(load @ load)
        share = 0.0 - float(load @ rubbed[:2]) / size if size > 0.0 else math.nan
        return cls(share, rubbed.torque, rubbed.power, c * (1.0 - at_rest.eccentricity) / rough.roughness)


@dataclass(frozen=True)
class FilmState:
    """One film in its static equilibrium, SI units: the fields are described by SHEET in columns.py.

    error, place_error: of stiffness and damping, and of the displacement, see RestingFilm; film_thickness_error,
    p_max_error, power_error, side_flow_error: expected ones by the mesh; problem: why there is no state, then the
    numbers are NaN; mixed: between rough surfaces, whose friction is part of torque and power; tilting: of a film whose
    journal tilts.
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
    error: float = math.nan
    place_error: float = math.nan
    sommerfeld_number: float = math.nan
    torque: float = math.nan
    friction_coefficient: float = math.nan
    friction_variable: float = math.nan
    power: float = math.nan
    side_flow: float = math.nan
    p_max: float = math.nan
    temperature_rise: float = math.nan
    force_error: float = math.nan
    viscosity: float = math.nan
    clearance: float = math.nan
    temperature: float = math.nan
    film_thickness_error: float = math.nan
    p_max_error: float = math.nan
    power_error: float = math.nan
    side_flow_error: float = math.nan
    problem: str = ""
    mixed: MixedFriction | None = None
    tilting: TiltingFilm | None = None

    @property
    def eccentricity(self) -> float:
        """Relative eccentricity of the journal."""
        return math.hypot(*self.displacement)

    @property
    def largest_error(self) -> float:
        """The largest relative error of force, film thickness, pressure, power and flow."""
        numbers = self.film_thickness_min, self.p_max, self.power, self.side_flow
        errors = self.film_thickness_error, self.p_max_error, self.power_error, self.side_flow_error
        known = [error / abs(number) for error, number in zip(errors, numbers, strict=True) if abs(number) > 0.0]
        return max([self.force_error, *known])

    @property
    def status(self) -> str:
        """ "resting" | "not-converged"."""
        return "not-converged" if self.problem else "resting"


def heat_capacity(case: Case) -> float:
    """The specific heat capacity in J/(kg K) of the temperature rise: given, or with heat the oil's at 80 degC, else
    HEAT_CAPACITY."""
    if case.heat is not None:
        return case.oil.heat_capacity_at(USUAL_TEMPERATURE)
    return case.oil.heat_capacity or HEAT_CAPACITY


def under_vertical_load(system: System, i: int, eccentricity: float, omega: float) -> tuple[Array, FilmForce]:
    """(2,) place in m of film i at this eccentricity at which its force points along y, and the film there. omega: of
    the journal, rad/s. Raises NotConverged where there is no such place."""
    angle = -0.25 * math.pi if omega >= 0.0 else -0.75 * math.pi
    near: FilmForce | None = None
    before = turned = math.nan
    for _ in range(TURNS):
        place = eccentricity * system.clearances[i] * np.array([math.cos(angle), math.sin(angle)])
        near = system.force(i, place, np.zeros(2), omega, near)
        f_x, f_y = near.force.tolist()
        if f_x == 0.0 and f_y == 0.0:
            raise NotConverged(f"The film carries nothing at an eccentricity of {eccentricity:g}.")
        off = math.remainder(0.5 * math.pi - math.atan2(f_y, f_x), 2.0 * math.pi)
        if abs(off) < ALIGNED:
            return place, settled_force(system, i, place, omega, near)
        turned = off * turned / (before - off) if SLOW * abs(before) < abs(off) < abs(before) else off
        angle, before = angle + turned, off
    raise NotConverged(f"No attitude angle was found at an eccentricity of {eccentricity:g}: off by {off:.2g} rad.")


@dataclass(frozen=True)
class Fields:
    """Results integrated from the film's fields: largest pressure in Pa, torque on the journal in N m, power in W, flow
    out of the open ends in m^3/s."""

    p_max: float
    torque: float
    power: float
    side_flow: float

    @classmethod
    def of(
        cls, volume: FieldFilm, places: Sequence[Array], speeds: tuple[float, float], factor: CavitationFactor
    ) -> tuple[Fields, ...]:
        """Fields of a steady film at each of several places d, see FieldFilm. speeds: of journal and shell in rad/s;
        factor: see loads. Raises NotConverged."""
        journal, shell = speeds
        solvers: dict[VolumeFilm, FilmSolver] = {}
        near: dict[int, Array] = {}  # fields in the place before
        fields = []
        for d in places:
            p_max, torques, flow = -math.inf, np.zeros(2), 0.0
            for number, (film, motion) in enumerate(volume.parts(d, journal + shell)):
                if film not in solvers:
                    solvers[film] = FilmSolver(film)
                solver = solvers[film]
                solution = solver.steady(motion, near.get(number))
                near[number] = solution.field
                its = loads(film, motion, solution, journal - shell, factor)
                p_max = max(p_max, its.p_max)
                torques += (its.torque.journal, its.torque.shell)
                flow += volume.outflow(solver, motion, solution)
            on_journal, on_shell = torques.tolist()
            fields.append(cls(p_max, on_journal, -on_journal * journal + on_shell * shell, flow))
        return tuple(fields)


def _further_out(at_rest: RestingFilm) -> RestingFilm:
    """The film as if its journal were further out by the error of its place, or not if that is unknown."""
    d, e = at_rest.displacement, at_rest.eccentricity
    off = 0.0 if math.isnan(at_rest.place_error) else min(at_rest.place_error, 0.5 * (1.0 - e))
    return replace(at_rest, displacement=d + off * (d / e if e > 0.0 else np.array([0.0, -1.0])))


def _field_errors(
    film: FieldFilms, central: Fields, at_rest: RestingFilm, speeds: tuple[float, float], factor: CavitationFactor
) -> Fields:
    """Expected errors by the mesh: of the fields in this place, and by the error of the place, as if it were further
    out; NaN if the film is not solved on fewer cells."""
    d, out = at_rest.displacement, _further_out(at_rest).displacement
    try:
        both = Fields.of(film.coarser, [at_rest.seen(place) for place in (d, out)], speeds, factor)
    except NotConverged:
        return Fields(*(math.nan,) * len(astuple(central)))
    return Fields(
        *(
            max(film.share * abs(coarse - own) + abs(moved - coarse), LEAST * abs(own))
            for own, coarse, moved in zip(*map(astuple, (central, *both)), strict=True)
        )
    )


def film_state(
    static: StaticFilms,
    volume: FieldFilms,
    i: int,
    bodies: Array,
    at_rest: RestingFilm,
    temperature: float = math.nan,
) -> FilmState:
    """The state of film i at rest. volume: the film on finite volumes, which has torque, flow and pressure in this
    place; bodies: (1 + rings,) speeds of rotor and rings in rad/s; temperature: K. Raises
    NotConverged."""
    case, system = static.case, static.system
    section = volume.own.section
    total, slip = (float(system.turning[i, row] @ bodies) for row in (0, 1))
    journal, shell = speeds = 0.5 * (total + slip), 0.5 * (total - slip)
    c, d = system.clearances[i], at_rest.displacement
    felt = replace(at_rest, displacement=system.felt(i, c * d) / c)
    ends = volume.own.ends(felt.seen(felt.displacement))
    phi = np.linspace(0.0, 2.0 * math.pi, SAMPLES, endpoint=False)
    size, width = math.hypot(*at_rest.load), section.bearing_width
    state = FilmState(
        film=system.names[i],
        speed_Hz=float(bodies[0]) / (2.0 * math.pi),
        journal_speed_Hz=journal / (2.0 * math.pi),
        shell_speed_Hz=shell / (2.0 * math.pi),
        load=np.array(at_rest.load),
        displacement=d,
        attitude_deg=at_rest.attitude_deg,
        film_thickness_min=c * min(float(gap_height(section, (x, y), phi).min()) for x, y in ends.tolist()),
        stiffness=at_rest.stiffness,
        damping=at_rest.damping,
        error=at_rest.error,
        place_error=at_rest.place_error,
        sommerfeld_number=sommerfeld_number(size, width, section.radius, c, section.viscosity, total),
        force_error=force_error(static, i, at_rest.seen(d * c), total, at_rest.load),
        viscosity=section.viscosity,
        clearance=c,
        temperature=temperature,
        film_thickness_error=c * at_rest.place_error,
        mixed=MixedFriction.of(system, i, at_rest, slip, shell),
        tilting=at_rest.tilting,
    )
    return _with_fields(case, volume, state, felt, speeds)


def _with_fields(
    case: Case, volume: FieldFilms, state: FilmState, at_rest: RestingFilm, speeds: tuple[float, float]
) -> FilmState:
    """A state with torque, loss, flow and pressure. at_rest: as the film feels it, in a gap that surfaces which touch
    keep; speeds: of journal and shell, rad/s. Raises NotConverged."""
    radius, factor = volume.own.section.radius, case.film.cavitation_factor
    (central,) = Fields.of(volume.own, [at_rest.seen(at_rest.displacement)], speeds, factor)
    errors = _field_errors(volume, central, at_rest, speeds, factor)
    torque, power, flow, power_error = central.torque, central.power, central.side_flow, errors.power
    if state.mixed is not None:
        torque, power = torque + state.mixed.torque, power + state.mixed.power
        power_error += state.mixed.power_error
    friction = friction_coefficient(torque, math.hypot(*state.load), radius)
    drawn = 0.5 * radius * sum(map(abs, speeds)) * state.clearance * volume.own.section.width
    if abs(flow) < NO_FLOW * drawn:  # of a journal in the middle of its shell: what is left is round-off
        flow = 0.0
    return replace(
        state,
        torque=torque,
        friction_coefficient=friction,
        friction_variable=friction * radius / state.clearance,
        power=power,
        side_flow=flow,
        p_max=central.p_max,
        temperature_rise=power / (case.oil.density * heat_capacity(case) * flow) if flow > 0.0 else math.nan,
        p_max_error=errors.p_max,
        power_error=power_error,
        side_flow_error=errors.side_flow,
    )


def no_state(name: str, speed: float, problem: str, eccentricity: float = math.nan) -> FilmState:
    """The state of a film at a rotor speed in Hz at which none was found."""
    unknown = np.full(2, math.nan)
    return FilmState(name, speed, math.nan, math.nan, unknown, np.array([eccentricity, 0.0]), problem=problem)
