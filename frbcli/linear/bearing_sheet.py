"""The sheet of a bearing: resting position, coefficients, power loss, flow and largest pressure of every film.

Over the rotor speed each film rests under its static load, which comes from the rotor of the case or is given; over the
eccentricity (Sommerfeld's chart) the load is the one that the film carries there. Films are solved on finite volumes,
finer than those of a run, for every gap and every cavitation model. With heat every speed has the viscosities and
clearances at which the heat of the machine balances with the films of a run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.oil import USUAL_TEMPERATURE
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.loads import estimate, force, loads
from frbcli.film.cells.motion import Motion
from frbcli.film.cells.side_flow import outflow
from frbcli.film.cells.steady_force import film_at, steady_force, steady_solution
from frbcli.film.gap import gap_height
from frbcli.film.operating import sommerfeld_number
from frbcli.html import Tabular
from frbcli.linear.heat import Machine, machine_finder
from frbcli.linear.resting import resting_position, ring_speeds
from frbcli.rotor.held import held_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.film_choice import CELLS as ON_CELLS
from frbcli.scene.films import FilmPlace, film_places, turning, volume_film
from frbcli.scene.plan import make_plan
from frbcli.scene.published import is_published
from frbcli.scene.remedies import advised
from frbcli.scene.system import System, film_drag, make_system
from frbcli.scene.warm import warm_case

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Observer = Callable[[int, int], None]

CELLS = (144, 20)  # around and along a section, equal: 0.1 % of the force up to an eccentricity of 0.9
SPEEDS = 20
ECCENTRICITIES = tuple(0.05 * i for i in range(1, 20))
HEAT_CAPACITY = 2000.0  # J/(kg K) of mineral oils within 10 % from 40 to 120 degC
DIFFERENCE = 1e-4  # of the gap, and of the velocity that moves the journal by it in 1 / omega
TURNS, ALIGNED = 40, 1e-7  # iterations of the attitude angle, and the angle in rad that ends them
SAMPLES = 720  # angles at which the smallest gap is looked for
SPEED, ECCENTRICITY = "speed", "eccentricity"


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


@dataclass(frozen=True)
class BearingSheet(Tabular):
    """States of the films of a case over "speed" or "eccentricity", film by film within each of them; laws: the
    cavitation model of each film, in the order of the films."""

    case: Case
    over: str
    films: tuple[str, ...]
    laws: tuple[str, ...]
    points: tuple[FilmState, ...]

    def of(self, film: str) -> tuple[FilmState, ...]:
        """The states of one film that were found."""
        return tuple(point for point in self.points if point.film == film and not point.problem)

    def to_pandas(self) -> pd.DataFrame:
        """One row per film and state, units in the names of the columns."""
        import pandas as pd

        return pd.DataFrame([_row(point) for point in self.points])


def bearing_sheet(
    case: Case, speeds_Hz: Sequence[float] | None = None, load: float | None = None, observe: Observer | None = None
) -> BearingSheet:
    """The films over the rotor speed, each under its static load.

    speeds_Hz (> 0): default SPEEDS over the range of the case, or the speed of its kinematic test; load: N along -y on
    a single film, default that of the rotor or of [motion]; observe: called with each speed's number and their number.
    Floating rings turn as their torques balance (4.17). Raises InputError if the case has no film on cells, no load or
    no speed, or heat and a load that is not that of its rotor.
    """
    _check(case)
    if case.heat is not None and (load is not None or case.given_rotor is None):
        problem = "needs the load of a [rotor], and takes no other."
        remedy = 'Leave --load out and add [rotor] and [speed], or write thermal.model = "none".'
        raise InputError(case.name or "case", (Fault("thermal.model", "lumped", None, problem, remedy),))
    speeds = sorted(_speeds(case) if speeds_Hz is None else speeds_Hz)
    at = _machines(case, load, speeds[-1])
    start: _Point | None = None
    found: list[list[FilmState]] = []
    for number, speed in enumerate(reversed(speeds)):  # from near the centre, where a fast journal rests, outwards
        omega = 2.0 * math.pi * speed
        try:
            with advised(case):
                start = at(omega, start)
            fine, coarse = start.fine, start.coarse
            journals = fine.rotor.journals @ start.resting
            spins = ring_speeds(fine, held_rotor(fine.rotor), omega, journals)
            states = [_state(case, fine, coarse, i, omega, spins, place) for i, place in enumerate(journals)]
            found.append([replace(state, temperature=t) for state, t in zip(states, start.temperatures, strict=True)])
        except NotConverged as error:
            found.append([_nothing(place.name, speed, str(error)) for place in film_places(case)])
        if observe is not None:
            observe(number + 1, len(speeds))
    points = tuple(point for states in reversed(found) for point in states)
    return BearingSheet(case, SPEED, tuple(place.name for place in film_places(case)), case.cavitations, points)


def sommerfeld_chart(
    case: Case,
    eccentricities: Sequence[float] = ECCENTRICITIES,
    speed_Hz: float | None = None,
    observe: Observer | None = None,
) -> BearingSheet:
    """The films over the eccentricity of their journals, under the load along -y that they carry there.

    speed_Hz: of the rotor, default the highest of the case; floating rings turn as they do in concentric films. Raises
    as bearing_sheet.
    """
    _check(case)
    if case.heat is not None:
        remedy = 'Choose --over speed, or write thermal.model = "none": films then have oil.temperature.'
        problem = "is not modelled over eccentricity: the temperatures belong to the load of the rotor."
        raise InputError(case.name or "case", (Fault("thermal.model", "lumped", None, problem, remedy),))
    speed = max(_speeds(case)) if speed_Hz is None else speed_Hz
    fine, coarse = _systems(case, 0.0, speed)
    omega = 2.0 * math.pi * speed
    spins = ring_speeds(fine, held_rotor(fine.rotor), omega, np.zeros((len(fine.names), 2)))
    omegas = fine.omegas(omega, spins)
    points = []
    for number, eccentricity in enumerate(eccentricities):
        for i, name in enumerate(fine.names):
            try:
                place = _under_vertical_load(fine.volumes[i], eccentricity, float(omegas[i]))
                points.append(_state(case, fine, coarse, i, omega, spins, place * fine.clearances[i]))
            except NotConverged as error:
                points.append(_nothing(name, speed, str(error), eccentricity))
        if observe is not None:
            observe(number + 1, len(eccentricities))
    return BearingSheet(case, ECCENTRICITY, fine.names, fine.laws, tuple(points))


@dataclass(frozen=True)
class _Point:
    """The machine at one speed, on fine and coarse cells, at rest in the displacements `resting` (n,) in m.

    temperatures: (films,) K, NaN without heat; warm: the machine on the films of a run whose heat balances."""

    fine: System
    coarse: System
    resting: Array
    temperatures: tuple[float, ...]
    warm: Machine | None = None


def _machines(case: Case, load: float | None, top_Hz: float) -> Callable[[float, _Point | None], _Point]:
    """A function that finds the machine at omega rad/s from one near it; it raises NotConverged."""
    if case.heat is None:
        fine, coarse = _systems(case, load, top_Hz)
        unknown = (math.nan,) * len(fine.names)
        return lambda omega, near: _Point(
            fine, coarse, resting_position(fine, omega, None if near is None else near.resting), unknown
        )
    plan = make_plan(case)
    find = machine_finder(case, plan, make_system(case, plan))

    def warm(omega: float, near: _Point | None) -> _Point:
        machine = find(omega, None if near is None else near.warm)
        assert machine.warm is not None
        films = machine.warm.films
        viscosities, clearances = (np.array([getattr(film, n) for film in films]) for n in ("viscosity", "clearance"))
        fine, coarse = _systems(warm_case(case, viscosities, clearances), load, top_Hz)
        resting = resting_position(fine, omega, machine.resting)
        return _Point(fine, coarse, resting, tuple(film.temperature for film in films), machine)

    return warm


def _check(case: Case) -> None:
    faults = []
    if case.film.bearing_model:
        problem = "is a bearing model: it tells the force, and neither pressures nor oil."
        faults.append(Fault("film.theory", case.film.theory, None, problem, "Write finite or auto."))
    if is_published(case):
        problem = "is for run-ups and frb rotation."
        faults.append(Fault("film.two-phase.form", "published", None, problem, 'Write form = "conservative".'))
    if case.given_rotor is None and (len(case.bearings) != 1 or not isinstance(case.bearings[0], SingleFilmBearing)):
        problem = "has more than one film: their loads follow from a rotor, which is missing."
        faults.append(Fault("bearing", f"{len(film_places(case))} films", None, problem, "Add [rotor] and [speed]."))
    if faults:
        raise InputError(case.name or "case", tuple(faults))


def _speeds(case: Case) -> tuple[float, ...]:
    """Default speeds in Hz, all positive."""
    if case.given_speed is not None:
        low, high = sorted((abs(case.speed.start), abs(case.speed.end)))
        return tuple(np.linspace(max(low, high / SPEEDS), high, SPEEDS).tolist())
    if case.motion is not None and case.motion.speed:
        return (abs(case.motion.speed),)
    raise InputError(case.name or "case", (Fault("speed", "", None, "is missing.", "Give --speed, or add [speed]."),))


def _systems(case: Case, load: float | None, top_Hz: float) -> tuple[System, System]:
    """The machine on CELLS and on half of them, for the error. top_Hz: largest rotor speed."""
    return _system(case, CELLS, load, top_Hz), _system(case, (CELLS[0] // 2, CELLS[1] // 2), load, top_Hz)


def _system(case: Case, cells: tuple[int, int], load: float | None, top_Hz: float) -> System:
    """load: of a single film in N; None for the rotor's, or that of [motion]."""
    alone = len(film_places(case)) == 1
    if case.given_rotor is not None and (load is None or not alone):
        return make_system(case, replace(make_plan(case), cells=cells, form=ON_CELLS))
    if load is None and case.motion is not None:
        load = case.motion.load
    if load is None:
        remedy = "Give --load, or --over eccentricity, or add [rotor]."
        raise InputError(case.name or "case", (Fault("motion.load", "", None, "is missing.", remedy),))
    return _single(case, film_places(case)[0], cells, load, top_Hz)


def _single(case: Case, place: FilmPlace, cells: tuple[int, int], load: float, top_Hz: float) -> System:
    """One film under a load along -y in N, without a rotor."""
    film = volume_film(case, place, cells, top_Hz)
    rotor = LinearRotor(
        mass=np.eye(2),
        damping=np.zeros((2, 2)),
        gyroscopic=np.zeros((2, 2)),
        stiffness=np.zeros((2, 2)),
        static_load=np.array([0.0, -load]),
        unbalance_cos=np.zeros(2),
        unbalance_sin=np.zeros(2),
        journals=np.eye(2)[None],
        multiplicity=np.ones(1),
        points=(),
    )
    return System(
        rotor=rotor,
        films=volume_films([film]),
        names=(place.name,),
        clearances=(place.geometry.clearance,),
        bodies=np.array([[place.inside, place.outside]], dtype=np.int64),
        turning=turning((place,), 0, [False]),
        drags=(film_drag(case, place.geometry),),
        volumes=(film,),
        laws=case.cavitations,
        torque=case.film.torque,
    )


def heat_capacity(case: Case) -> float:
    """The specific heat capacity in J/(kg K) of the temperature rise: given, or with heat that of the oil at 80 degC,
    else HEAT_CAPACITY."""
    if case.heat is not None:
        return case.oil.heat_capacity_at(USUAL_TEMPERATURE)
    return case.oil.heat_capacity or HEAT_CAPACITY


def _under_vertical_load(film: VolumeFilm, eccentricity: float, omega: float) -> Array:
    """(2,) displacement over the clearance of this eccentricity at which the film's force points along y."""
    angle = -0.25 * math.pi if omega >= 0.0 else -0.75 * math.pi
    for _ in range(TURNS):
        d = (eccentricity * math.cos(angle), eccentricity * math.sin(angle))
        motion = Motion(d, (0.0, 0.0), omega)
        at = film_at(film, eccentricity, omega)
        solution = steady_solution(film, motion)
        f_x, f_y = force(at, film.pressure(solution.state))
        if f_x == 0.0 and f_y == 0.0:
            raise NotConverged(f"The film carries nothing at an eccentricity of {eccentricity:g}.")
        off = math.remainder(0.5 * math.pi - math.atan2(f_y, f_x), 2.0 * math.pi)
        if abs(off) < ALIGNED:
            return np.array(d)
        angle += off
    raise NotConverged(f"No attitude angle was found at an eccentricity of {eccentricity:g}: off by {off:.2g} rad.")


def _state(
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


def _nothing(name: str, speed: float, problem: str, eccentricity: float = math.nan) -> FilmState:
    unknown = np.full(2, math.nan)
    return FilmState(name, speed, math.nan, math.nan, unknown, np.array([eccentricity, 0.0]), problem=problem)


def _row(point: FilmState) -> dict[str, object]:
    row: dict[str, object] = {
        "film": point.film,
        "status": "not-converged" if point.problem else "resting",
        "speed_Hz": point.speed_Hz,
        "journal_speed_Hz": point.journal_speed_Hz,
        "shell_speed_Hz": point.shell_speed_Hz,
        "load_x_N": point.load[0],
        "load_y_N": point.load[1],
        "sommerfeld_number": point.sommerfeld_number,
        "eccentricity": point.eccentricity,
        "attitude_deg": point.attitude_deg,
        "film_thickness_min_m": point.film_thickness_min,
        "torque_Nm": point.torque,
        "power_W": point.power,
        "side_flow_m3_s": point.side_flow,
        "p_max_Pa": point.p_max,
        "temperature_rise_K": point.temperature_rise,
        "force_error_relative": point.force_error,
        "viscosity_Pa_s": point.viscosity,
        "clearance_m": point.clearance,
        "temperature_K": point.temperature,
    }
    for name, unit, matrix in (("k", "N_m", point.stiffness), ("c", "Ns_m", point.damping)):
        for r, x in enumerate("xy"):
            for s, y in enumerate("xy"):
                row[f"{name}_{x}{y}_{unit}"] = math.nan if matrix is None else matrix[r, s]
    return row
