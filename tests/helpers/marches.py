"""Marches of rotors without films, and in short ones, for the tests of the time loop."""

import math
from dataclasses import dataclass, replace

import numpy as np
from films import rectangular, system_of
from numpy.typing import NDArray
from scipy.linalg import expm

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.film.cells.data import volume_films
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.grid import Mesh
from frbcli.film.kinds.cells import CellFilms
from frbcli.film.kinds.tilted import TiltedFilms
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.rotor.assembly import Body, LinearRotor, Link, assembled, jeffcott_rotor, point_mass
from frbcli.rotor.loads import SpeedProfile, speed_profile
from frbcli.runs.march import control_of
from frbcli.runs.start import first_state, rotor_data, state_at
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.state import FINISHED, METHODS, OUTPUTS, RUNNING, Control, State, make_output
from frbcli.solve.time_loop import advance

MESH = Mesh(6, 96)
BEARING = rectangular(
    width=20e-3, diameter=25e-3, clearance=35e-6, viscosity=12e-3, ambient_pressure=1e5, cavitation_pressure=1e5,
    groove=2,
)  # fmt: skip
SHORT_FILM = make_film(BEARING, "short", "half-sommerfeld", MESH)
NO_FILM = SHORT_FILM._replace(force_scale=0.0)
WIDE = replace(BEARING, clearance=1.0)  # m: the shell of a rotor that runs without films is far away

GRAVITY = 9.81

# The shaft of rigid_shaft in m and kg/m^3; mass and inertias of its disk, and a speed in Hz.
D, WIDTH, SPAN, LENGTH, RHO = 0.01, 0.005, 0.006, 0.02, 7850.0
DISK, POLAR, DIAMETRAL, SPEED = 0.05, 4e-7, 3e-7, 300.0


@dataclass(frozen=True)
class Result:
    """times (k,), q and v (k, n) at the output times, and how the march ended."""

    times: Array
    q: Array
    v: Array
    status: int
    numbers: Array


def flat_films(case: Case, system: System) -> CellFilms:
    """The films of a system that follow tilts as ones that do not know of any, on the same cells."""
    films = system.films
    assert isinstance(films, TiltedFilms)
    lands = [film.lands[0].film for film in films.own]
    own = tuple(
        VolumeFilm(film.section, land.grid, land.law, land.scales.reference)
        for film, land in zip(films.own, lands, strict=True)
    )
    data = volume_films(own, films.centrifugal, films.settled)
    return CellFilms(films.clearances, own, data, films.cells, "none", 2, case.oil_viscosity)


def without_films(rotor: LinearRotor) -> System:
    count = len(rotor.journals)
    return system_of(rotor, (WIDE,) * count, (NO_FILM,) * count)


def with_short_films(rotor: LinearRotor) -> System:
    count = len(rotor.journals)
    return system_of(rotor, (BEARING,) * count, (SHORT_FILM,) * count)


def control(
    tolerance: float = 1e-6,
    longest: float = 1e-3,
    output: float = 1e-4,
    per_revolution: float = 1.0,
    stiffness: float = 0.0,
) -> Control:
    return Control(tolerance, per_revolution, longest, output, 0.9999, stiffness)


def start(system: System, profile: SpeedProfile, q: Array | None = None, v: Array | None = None) -> State:
    zero = np.zeros(system.rotor.size)
    return state_at(system, profile, zero if q is None else q, zero if v is None else v)


def forces(system: System, q: Array, v: Array, speed_up: float, omega: float, angle: float) -> Array:
    """All forces on the rotor, written down plainly."""
    rotor = system.rotor
    total = rotor.static_load - rotor.stiffness @ q - (rotor.damping + omega * rotor.gyroscopic) @ v
    total = total + rotor.unbalance_cos * (speed_up * math.cos(angle) - omega**2 * math.sin(angle))
    total = total + rotor.unbalance_sin * (speed_up * math.sin(angle) + omega**2 * math.cos(angle))
    bearings = zip(rotor.journals, rotor.multiplicity, system.films.loop, system.clearances, strict=True)
    for selection, count, film, c in bearings:
        if film.force_scale > 0.0:
            total = total + count * selection.T @ evaluate(film, c, selection @ q, selection @ v, omega).force
    return np.asarray(total)


def march(
    system: System,
    profile: SpeedProfile,
    limits: Control,
    state: State | None = None,
    method: str = "esdirk4",
    budget: int = 10**9,
) -> Result:
    """Advance to the end, handing out `budget` steps at a time."""
    state = start(system, profile) if state is None else state
    data, tableau = rotor_data(system, profile), METHODS[method].tableau
    rows = int(profile.end / limits.output_step) + 10
    output = make_output(rows, system.rotor.size, len(system.names))
    written, status = 0, RUNNING
    while status == RUNNING:
        status, fresh = advance(
            data, system.films.loop, tableau, limits, state, budget, output.after(written)
        )
        written += fresh
    assert written == int(state.numbers[OUTPUTS])
    times = np.arange(written) * limits.output_step
    return Result(times, output.q[:written], output.v[:written], status, state.numbers)


def seen_between(
    system: System, omega: float, middle: tuple[Array, Array], apart: tuple[Array, Array], time: float, steps: int,
    lag: int, count: int, settled: int,
) -> NDArray[np.complex128]:  # fmt: skip
    """Eigenvalues in 1/s of what lies between two runs at a steady speed, by its `count` largest singular vectors and
    how they go on over `lag` steps of output. middle: displacements and velocities that the runs begin beside; apart:
    by how much of each; settled: steps after which they are watched."""
    profile = speed_profile((0.0, time), (omega, omega))
    limits, spins, runs = Control(1e-7, 24.0, *(time / steps,) * 2, 0.9999, 0.0), list(system.spins), []
    for side in (1.0, -1.0):
        q, v = (each + side * off for each, off in zip(middle, apart, strict=True))
        after = march(system, profile, limits, start(system, profile, q, v))
        moved = [
            np.einsum("fcn,tn->tfc", system.rotor.journals, each).reshape(steps + 1, -1) for each in (after.q, after.v)
        ]
        runs.append(np.hstack([*moved, after.v[:, spins]]))
    between = (runs[0] - runs[1])[settled:]
    between /= np.abs(between).max(axis=0)
    motions = between @ np.linalg.svd(between, full_matrices=False)[2][:count].T
    step = np.linalg.lstsq(motions[:-lag], motions[lag:], rcond=None)[0]
    return np.asarray(np.log(np.linalg.eigvals(step).astype(complex)) / (lag * time / steps))


def even_steps(h: float, output: float) -> Control:
    """Every step of the same length h: the error never matters, and what is longer than h is refused."""
    return control(tolerance=1e9, longest=h, output=output)


def linear_reference(rotor: LinearRotor, omega: float, times: Array, q: Array, v: Array) -> tuple[Array, Array]:
    """Exact q and v (k, n) at even times of a rotor without films at constant speed."""
    n = rotor.size
    # The state grows by cos, sin of the angle and by one, so that the whole problem is linear and homogeneous.
    a = np.zeros((2 * n + 3, 2 * n + 3))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n] = -np.linalg.solve(rotor.mass, rotor.stiffness)
    a[n : 2 * n, n : 2 * n] = -np.linalg.solve(rotor.mass, rotor.damping + omega * rotor.gyroscopic)
    a[n : 2 * n, 2 * n] = omega**2 * np.linalg.solve(rotor.mass, rotor.unbalance_sin)
    a[n : 2 * n, 2 * n + 1] = -(omega**2) * np.linalg.solve(rotor.mass, rotor.unbalance_cos)
    a[n : 2 * n, 2 * n + 2] = np.linalg.solve(rotor.mass, rotor.static_load)
    a[2 * n, 2 * n + 1], a[2 * n + 1, 2 * n] = -omega, omega
    step = expm(a * (times[1] - times[0]))
    rows = [np.concatenate([q, v, [1.0, 0.0, 1.0]])]
    for _ in times[1:]:
        rows.append(step @ rows[-1])
    exact = np.array(rows)
    return exact[:, :n], exact[:, n : 2 * n]


def in_two_bearings(shaft: Body) -> LinearRotor:
    """A symmetric rotor in two equal bearings, as one film counts twice."""
    return assembled([shaft], [Link("journal", count=2.0)])


def rigid(mass: float, unbalance: float, external_damping: float, gravity: float = GRAVITY) -> LinearRotor:
    return in_two_bearings(point_mass("journal", mass, gravity, unbalance, external_damping))


def jeffcott(journal_mass: float = 0.1, unbalance: float = 3e-6) -> LinearRotor:
    return in_two_bearings(jeffcott_rotor(6.0, journal_mass, 5e6, unbalance, 1.0, 0.1, GRAVITY))


def slender_jeffcott() -> LinearRotor:
    """Without films, and with natural frequencies that are not worlds apart."""
    return in_two_bearings(jeffcott_rotor(1.0, 0.5, 4e4, 1e-3, 3.0, 2.0, GRAVITY))


def slope(sizes: list[float], errors: list[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def modal_rotor(films: int, seed: int = 4) -> LinearRotor:
    """60 states coupled gyroscopically, natural frequencies from 30 to 900 Hz, journals and unbalance all over them."""
    chance, n = np.random.default_rng(seed), 60
    turn = np.linalg.qr(chance.normal(size=(n, n)))[0]
    stiffness = turn @ np.diag((2 * math.pi * np.linspace(30.0, 900.0, n)) ** 2) @ turn.T
    spin = chance.normal(size=(n, n)) * 0.05
    forward = chance.normal(size=(2, n))
    return LinearRotor(
        mass=np.eye(n),
        damping=20.0 * np.eye(n),
        gyroscopic=spin - spin.T,
        stiffness=0.5 * (stiffness + stiffness.T),
        static_load=chance.normal(size=n),
        unbalance_cos=1e-5 * forward[0],
        unbalance_sin=1e-5 * forward[1],
        journals=chance.normal(size=(films, 2, n)) / math.sqrt(n),
        multiplicity=np.arange(1.0, films + 1.0),
        points=(("journal", chance.normal(size=(2, n)) / math.sqrt(n)),),
    )


def rigid_shaft(*more: str) -> Case:
    """A rigid shaft, symmetric about its middle, in two bearings that are nearly as wide as they are apart."""
    film = f'{{kind = "single-film", width = "{WIDTH} m", diameter = "{D} m", clearance = "30 um", ends = "oil-bath"'
    settings = (
        'rotor={kind = "turbocharger", modes = 2}',
        f'shaft=[{{length = "{LENGTH} m", diameter = "{D} m", density = "{RHO} kg/m^3", '
        'youngs_modulus = "2.1e11 Pa"}]',
        f'bearing=[{film}, name = "left", position = "{0.5 * (LENGTH - SPAN)} m"}}, '
        f'{film}, name = "right", position = "{0.5 * (LENGTH + SPAN)} m"}}]',
        f'disk=[{{position = "{0.5 * LENGTH} m", mass = "{DISK} kg", polar_inertia = "{POLAR} kg*m^2", '
        f'diametral_inertia = "{DIAMETRAL} kg*m^2", unbalance = "1 g*mm"}}]',
        "film.theory=finite",
        f"speed.to={SPEED} Hz",
    )
    return load_case("jeffcott", [*settings, *more])


def planned_system(case: Case) -> System:
    """The machine of a case as its plan has it."""
    return make_system(case, make_plan(case))


def planned(case: Case, **changes: object) -> tuple[Plan, System]:
    """The plan of a case, with changes, and the system that follows from it."""
    plan = replace(make_plan(case), **changes)  # type: ignore[arg-type]
    return plan, make_system(case, plan)


def run_up(
    case: Case, plan: Plan, system: System, state: State | None = None, budget: int = 10**6,
    control: Control | None = None,
) -> tuple[Array, State]:  # fmt: skip
    """Displacements (rows, n) at the output times of a run-up that comes to its end, and the last state."""
    profile = run_up_profile(case)
    state = first_state(case.start, system, profile) if state is None else state
    output = make_output(4000, system.rotor.size, len(system.names))
    limits, rotor = control or control_of(case, plan), rotor_data(system, profile)
    parts = rotor, system.films.loop, METHODS[plan.method].tableau, limits, state, budget
    status, written = RUNNING, 0
    while status == RUNNING:
        status, fresh = advance(*parts, output.after(written))
        written += fresh
    assert status == FINISHED
    return output.q[:written], state
