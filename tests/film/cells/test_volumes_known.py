"""Films on volumes against answers that are known otherwise: fronts in one dimension, symmetry, scaling, limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from volume_films import AMBIENT, ROTATION, section_of

from frbcli.bearing_tests.history import march
from frbcli.film.cavitation.conditions import Elrod, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.loads import loads
from frbcli.film.cells.mesh.grid import fitted_grid, volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import AxialGroove, Hole, Section, gap_height
from frbcli.film.section_faults import runs_dry, section_faults

ECCENTRICITY, OMEGA, SUPPLY = 0.6, 200.0, 1.3e5
LEADING, TRAILING = math.radians(-60.0), math.radians(-40.0)  # of a slot over the whole width
TURN = 2.0 * math.pi


def long_bearing() -> Section:
    """No flow along: symmetry at both ends. A slot with 1.3 bar absolute."""
    slot = Hole(0.5 * (LEADING + TRAILING), 0.5e-2, 0.5 * (TRAILING - LEADING), 10.0, SUPPLY - AMBIENT, round=False)
    return replace(section_of("none"), near="symmetry", far="symmetry", holes=(slot,))


def exact_fronts(section: Section) -> tuple[float, float]:
    """Angles of rupture and reformation of the steady film of Jakobsson, Floberg and Olsson without flow along.

    Full from the slot's trailing edge: p' = (omega/2) (H - H_r) / H^3, p = p_cav and p' = 0 at the rupture. The same
    flow H_r reaches the reformation, from where the same p' leads from p_cav to the slot's leading edge.
    """
    supply = (SUPPLY - AMBIENT) / section.pressure_scale * 2.0 / OMEGA

    def gap(phi: float) -> float:
        return 1.0 - ECCENTRICITY * math.cos(phi)

    def rise(start: float, end: float, rupture: float) -> float:
        return quad(lambda phi: (gap(phi) - gap(rupture)) / gap(phi) ** 3, start, end, epsabs=1e-12)[0]

    rupture = brentq(lambda r: supply + rise(TRAILING, r, r), 1e-6, 2.5)  # behind the narrowest gap
    leading = LEADING + TURN
    reformation = brentq(lambda f: rise(f, leading, rupture) - supply, rupture + 1e-6, leading - 1e-9)
    return rupture, reformation


def measured_fronts(cells: int) -> tuple[float, float, float]:
    """Rupture and reformation as the film has them, the edges of its partly empty cells; and the size of a cell."""
    section = long_bearing()
    phi = LEADING + np.linspace(0.0, TURN, cells + 1)
    film = VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, 3)), Elrod(), OMEGA)
    motion = Motion((0.0, ECCENTRICITY), (0.0, 0.0), OMEGA)
    fraction = FilmSolver(film).steady(motion).state.fraction[:, 0]
    empty = np.flatnonzero(fraction < 1.0)
    return float(phi[empty[0]]), float(phi[empty[-1] + 1]), TURN / cells


def test_fronts_of_a_long_bearing_are_those_of_the_exact_integration() -> None:
    """Both within one cell, on meshes that divide the slot exactly, and so converging with the mesh."""
    section = long_bearing()
    rupture, reformation = exact_fronts(section)
    assert rupture < reformation < LEADING + TURN
    for cells in (144, 576):
        found_rupture, found_reformation, cell = measured_fronts(cells)
        assert abs(found_rupture - rupture) < 1.5 * cell
        assert abs(found_reformation - reformation) < 1.5 * cell


def test_oil_in_the_cavity_of_a_long_bearing_is_what_passed_the_rupture() -> None:
    section = long_bearing()
    rupture, _ = exact_fronts(section)
    phi = LEADING + np.linspace(0.0, TURN, 289)
    film = VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, 3)), Elrod(), OMEGA)
    motion = Motion((0.0, ECCENTRICITY), (0.0, 0.0), OMEGA)
    fraction = FilmSolver(film).steady(motion).state.fraction[:, 0]
    empty = fraction < 1.0
    flow = fraction * gap_height(section, motion.d, phi[1:])  # through the face after each cell
    inner = empty & np.roll(empty, 1) & np.roll(empty, -1)
    expected = float(gap_height(section, motion.d, np.array([rupture]))[0])
    assert flow[inner] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("rate", [0.0, -20.0])
def test_plates_fill_again_as_the_front_equation_has_it(rate: float) -> None:
    """Olsson's front between two parallel plates that stand still or close, fed at both edges.

    Full over the length l from each edge: q(l) = A H^3 p / l - H' l / 2 and (1 - theta) H dl/dt = q(l), with theta H
    of the cavity constant. In a very short bearing, where hardly anything flows around, a strip is such a pair of
    plates.
    """
    section = replace(section_of("none"), width=1e-4, cavitation_pressure=AMBIENT - 20.0)
    start_fraction, start_gap = 0.6, 0.9
    phi = np.linspace(-math.pi, math.pi, 9)
    film = VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, 121)), Elrod(), 1.0)
    d_y = start_gap - 1.0
    strip = 0
    shape = -math.cos(film.grid.centre[strip])  # dH/dd_y there
    feed = 20.0 / section.pressure_scale

    def motion(time: float) -> Motion:
        return Motion((0.0, (d_y + rate * time) / shape), (0.0, rate / shape), 0.0)

    def front(time: float, length: np.ndarray) -> np.ndarray:
        gap = start_gap + rate * time
        flow = section.aspect * gap**3 * feed / length - 0.5 * rate * length
        return np.array(flow / (gap - start_fraction * start_gap))

    duration = 0.15 * (1.0 - start_fraction) / (section.aspect * feed)
    first = 0.02
    start = np.full(film.grid.shape, start_fraction - 1.0)
    early = first**2 * (1.0 - start_fraction) / (2.0 * section.aspect * start_gap**2 * feed)  # H' = 0 until there
    times = np.linspace(0.0, duration, 61)
    exact = solve_ivp(front, (early, duration), [first], rtol=1e-9, atol=1e-12).y[0, -1]
    *_, last = march(film, motion, times, start)
    fraction = last.solution.state.fraction[strip]
    gap = start_gap + rate * duration
    cavity = start_fraction * start_gap / gap
    length = float(((fraction - cavity) / (1.0 - cavity)) @ np.diff(film.grid.z))
    assert 0.3 < exact < 0.95
    assert length == pytest.approx(exact, rel=1e-2)


@pytest.mark.parametrize("omega", [50.0, 314.0, 3000.0])
def test_centred_film_that_nothing_feeds_is_at_rest(omega: float) -> None:
    """Ends that let oil out and none in leave the level to the outflow (4.37) alone, an exponential of the pressure,
    which Newton's method follows by a factor of e an iteration. Any level between cavity and air carries nothing."""
    section = replace(section_of("none", ends="free-to-air"), cavitation_pressure=100.0)
    film = VolumeFilm(section, volume_grid(section, np.linspace(0.0, TURN, 49), np.linspace(0.0, 1.0, 7)),
                      Reynolds(), omega)  # fmt: skip
    solution = FilmSolver(film).steady(Motion((0.0, 0.0), (0.0, 0.0), omega))
    level = film.pressure(solution.state) * section.pressure_scale
    assert np.ptp(level) < 1e-9 * AMBIENT
    assert 100.0 - AMBIENT < level.min() < 0.0
    assert solution.flows.outflow < 1e-9 * omega


def test_elrod_is_reynolds_for_an_axial_groove() -> None:
    """Steady rotation: the cavity ends in the groove, so that where the oil goes in it does not matter."""
    section = section_of("axial-groove", AMBIENT)
    forces = []
    for law in (Elrod(), Reynolds()):
        film = VolumeFilm(section, fitted_grid(section, ROTATION.d, 96, 16), law, 50.0)
        forces.append(np.array(loads(film, ROTATION, FilmSolver(film).steady(ROTATION)).force))
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)


def test_two_phase_tends_to_elrod_as_it_gets_steeper() -> None:
    section = section_of("axial-groove", 2e5)

    def force(law: Law) -> np.ndarray:
        film = VolumeFilm(section, fitted_grid(section, ROTATION.d, 64, 12), law, 50.0)
        return np.array(loads(film, ROTATION, FilmSolver(film).steady(ROTATION)).force)

    exact = force(Elrod())
    gaps = [float(np.hypot(*(force(TwoPhase(x, 0.0)) - exact))) for x in (0.9, 0.99, 0.999)]
    assert gaps[0] > 4.0 * gaps[1] > 16.0 * gaps[2]


def with_bores(half_width: float) -> Section:
    section = section_of("none")
    angle = half_width / section.radius
    bores = tuple(Hole(phi, section.width, angle, half_width, 5e4, round=True) for phi in (0.0, 2.0, 4.0))
    return replace(section, holes=bores)


def test_bores_that_shrink_to_nothing_give_the_plain_film() -> None:
    plain = section_of("none")
    grid = fitted_grid(plain, ROTATION.d, 72, 12)

    def force(section: Section) -> np.ndarray:
        film = VolumeFilm(section, volume_grid(section, grid.phi, grid.z), Reynolds(), 50.0)
        return np.array(loads(film, ROTATION, FilmSolver(film).steady(ROTATION)).force)

    expected = force(plain)
    gaps = [float(np.hypot(*(force(with_bores(size)) - expected))) for size in (4e-3, 2e-3, 1e-3, 1e-6)]
    assert gaps[0] > gaps[1] > gaps[2] > gaps[3] == 0.0


def test_hydrostatic_force_of_a_pocket_is_that_of_its_pressure() -> None:
    """(4.9): a pocket over the whole width of an otherwise unloaded film, whose pressure falls to its ends at once."""
    section = replace(section_of("none"), width=1e-5, copies=1)
    opening, pressure = math.radians(40.0), 1e5
    pocket = Hole(0.0, 0.5e-5, 0.5 * opening, 1e-5, pressure, round=False)
    section = replace(section, holes=(pocket,))
    phi = 0.5 * opening + np.linspace(0.0, TURN, 181)
    film = VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, 5)), Sommerfeld(), 1.0)
    motion = Motion((0.0, 0.0), (0.0, 0.0), 1e-3)
    force = loads(film, motion, FilmSolver(film).steady(motion)).force
    assert force[0] == pytest.approx(0.0, abs=1e-9)
    assert force[1] == pytest.approx(-pressure * 1e-5 * 2.0 * section.radius * math.sin(0.5 * opening), rel=1e-3)


@pytest.mark.parametrize("law", [Elrod(), TwoPhase(0.99), Reynolds()], ids=["elrod", "two-phase", "reynolds"])
def test_mirrored_motion_gives_the_mirrored_force(law: Law) -> None:
    section = section_of("axial-groove", 2e5)
    motion = Motion((0.3, -0.4), (5.0, 8.0), 150.0)
    mirror = Motion((-0.3, -0.4), (-5.0, 8.0), -150.0)
    phi = np.radians(7.5) + np.linspace(0.0, TURN, 97)
    z = np.linspace(0.0, 1.0, 13)
    force, mirrored = (
        np.array(loads(film, moved, FilmSolver(film).steady(moved)).force)
        for film, moved in (
            (VolumeFilm(section, volume_grid(section, phi, z), law, 50.0), motion),
            (VolumeFilm(section, volume_grid(section, -phi[::-1], z), law, 50.0), mirror),
        )
    )
    assert mirrored == pytest.approx(force * [-1.0, 1.0], rel=1e-9)


def test_half_a_film_is_the_whole_one_cut_in_the_middle() -> None:
    half = section_of("axial-groove", 2e5)
    whole = replace(half, width=half.bearing_width, copies=1, far="oil-bath")
    motion = ROTATION
    faces = np.linspace(0.0, 1.0, 17)
    both = np.concatenate([0.5 * faces, 1.0 - 0.5 * faces[-2::-1]])
    phi = fitted_grid(half, motion.d, 64, 4).phi
    found = [
        loads(film, motion, FilmSolver(film).steady(motion))
        for film in (
            VolumeFilm(half, volume_grid(half, phi, faces), Elrod(), 50.0),
            VolumeFilm(whole, volume_grid(whole, phi, both), Elrod(), 50.0),
        )
    ]
    assert found[0].force == pytest.approx(found[1].force, rel=1e-9)
    assert found[0].torque.journal == pytest.approx(found[1].torque.journal, rel=1e-9)
    assert found[0].p_max == pytest.approx(found[1].p_max, rel=1e-9)
    assert found[0].oil.in_m3_s == pytest.approx(found[1].oil.in_m3_s, rel=1e-9)


def test_viscosity_and_speed_scale_the_pressure() -> None:
    """Twice the viscosity and all pressures: twice the force at the same flow; twice the speed and all pressures: twice
    both."""
    section = section_of("axial-groove", 2e5)
    thick = replace(
        section,
        viscosity=2.0 * section.viscosity,
        ambient_pressure=2.0 * AMBIENT,
        cavitation_pressure=2.0 * AMBIENT,
        grooves=(replace(section.grooves[0], pressure=2.0 * section.grooves[0].pressure),),
    )
    grid = fitted_grid(section, ROTATION.d, 48, 8)

    def of(scaled: Section, motion: Motion) -> tuple[np.ndarray, float]:
        film = VolumeFilm(scaled, volume_grid(scaled, grid.phi, grid.z), TwoPhase(0.99), 50.0)
        found = loads(film, motion, FilmSolver(film).steady(motion))
        return np.array(found.force), found.oil.in_m3_s

    force, flow = of(section, ROTATION)
    thick_force, thick_flow = of(thick, ROTATION)
    assert thick_force == pytest.approx(2.0 * force, rel=1e-9)
    assert thick_flow == pytest.approx(flow, rel=1e-9)
    fast = replace(thick, viscosity=section.viscosity)
    fast_force, fast_flow = of(fast, replace(ROTATION, omega=2.0 * ROTATION.omega))
    assert fast_force == pytest.approx(2.0 * force, rel=1e-9)
    assert fast_flow == pytest.approx(2.0 * flow, rel=1e-9)


def test_faults_of_a_section() -> None:
    assert section_faults(section_of("axial-groove", 2e5)) == []
    assert section_faults(with_bores(1e-3)) == []
    dry = section_of("none", ends="free-to-air")
    assert runs_dry(dry)
    assert not runs_dry(section_of("circumferential-groove", ends="free-to-air"))
    assert not runs_dry(section_of("axial-groove", ends="free-to-air"))
    plain = section_of("none")
    hole = Hole(0.0, 2e-3, 0.1, 1e-3, 1e5, round=True)
    cases = {
        "runs dry": dry,
        "clearance is": replace(plain, clearance=-1e-6),
        "grooves at": replace(plain, grooves=(AxialGroove(0.0, 0.3, 0.0), AxialGroove(6.2, 0.3, 0.0))),
        "holes at": replace(plain, holes=(hole, replace(hole, position=0.15))),
        "a groove and a hole": replace(plain, grooves=(AxialGroove(0.1, 0.2, 0.0),), holes=(hole,)),
        "out of the film": replace(plain, holes=(replace(hole, axial=0.5e-3),)),
        "has no size": replace(plain, holes=(replace(hole, half_width=0.0),)),
        "360 deg": replace(plain, grooves=(AxialGroove(0.0, 7.0, 0.0),)),
    }
    for expected, section in cases.items():
        faults = section_faults(section)
        assert len(faults) == 1, (expected, faults)
        assert expected in " ".join(faults[0])
