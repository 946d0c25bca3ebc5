"""Geometry of the gap against known answers: lobes, edges of bores, turning frames, supply over time, strains."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from volume_films import ROTATION, polar_motion, section_of

from frbcli import load_case
from frbcli.bearing_tests.march import march
from frbcli.cli.main import run
from frbcli.errors import InputError
from frbcli.film.cavitation.elrod import Elrod
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.reynolds import Reynolds
from frbcli.film.cavitation.sommerfeld import HalfSommerfeld, Sommerfeld
from frbcli.film.cells.film import VolumeFilm, supplied, supply_share
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.mesh.grid import fitted_grid, volume_grid
from frbcli.film.cells.mesh.openings import hole_area
from frbcli.film.cells.motion import Motion, path_seen_from, seen_from, turned
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import AxialGroove, Hole, LobedShell, Section, gap_height, graded_ring, smallest_gap
from frbcli.film.operating import reynolds_number, ring_rotation_strains, shaft_rotation_strain
from frbcli.materials.solids import BRASS, STEEL
from frbcli.scene.machine.operating import operating_points
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan

TURN = 2.0 * math.pi
PLAIN = section_of("none")
RING = np.linspace(-math.pi, math.pi, 97)


def film_on(section: Section, phi: np.ndarray, along: int = 8, law: Law | None = None) -> VolumeFilm:
    return VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, along + 1)), law or Reynolds(), 50.0)


def steady_loads(film: VolumeFilm, motion: Motion) -> FilmLoads:
    return loads(film, motion, FilmSolver(film).steady(motion))


# --- lobes -----------------------------------------------------------------------------------------------------------


def test_lobes_without_preload_are_a_plain_bearing() -> None:
    phi = np.linspace(0.0, TURN, 40)
    assert np.array_equal(gap_height(replace(PLAIN, lobes=LobedShell(3, 0.0, 0.4)), (0.3, 0.2), phi),
                          gap_height(PLAIN, (0.3, 0.2), phi))  # fmt: skip


@pytest.mark.parametrize("offset", [0.3, 0.5, 1.0])
def test_gap_of_lobes_is_between_assembled_and_machined_clearance(offset: float) -> None:
    """Smallest, 1, at the offset of each lobe; the centre of a lobe's bore is c_p - c_b away from the bearing's."""
    lobes = LobedShell(3, 0.5, 0.7, offset)
    section = replace(PLAIN, lobes=lobes)
    narrowest = lobes.start + (np.arange(3) + offset) * lobes.arc - (1e-6 if offset == 1.0 else 0.0)
    assert gap_height(section, (0.0, 0.0), narrowest) == pytest.approx(1.0, abs=1e-11)
    assert smallest_gap(section, (0.0, 0.0)) == pytest.approx(1.0, abs=1e-6)
    middle = np.array([lobes.position])
    machined = 2.0  # c_p / c_b at a preload of 0.5
    away = machined - 1.0
    expected = machined - away * math.cos((0.5 - offset) * lobes.arc)
    assert gap_height(section, (0.0, 0.0), middle) == pytest.approx(expected)


def test_one_lobe_is_a_plain_bearing_of_the_machined_clearance() -> None:
    """Its bore is a whole circle, only placed elsewhere: the same film in two descriptions."""
    preload, position = 0.4, 0.7
    machined = replace(PLAIN, clearance=PLAIN.clearance / (1.0 - preload))
    lobed = replace(PLAIN, lobes=LobedShell(1, preload, position))
    motion = Motion((0.2, -0.3), (3.0, 4.0), 300.0)
    shift = (-preload * math.sin(position), preload * math.cos(position))
    share = 1.0 - preload
    d = (share * motion.d[0] + shift[0], share * motion.d[1] + shift[1])
    same = Motion(d, (share * motion.v[0], share * motion.v[1]), motion.omega)
    for law in (Reynolds(), Sommerfeld()):
        found = steady_loads(film_on(lobed, RING, law=law), motion)
        expected = steady_loads(film_on(machined, RING, law=law), same)
        assert found.force == pytest.approx(expected.force, rel=1e-8)
        assert found.torque.journal == pytest.approx(expected.torque.journal, rel=1e-8)
        assert found.oil.out_m3_s == pytest.approx(expected.oil.out_m3_s, rel=1e-8)


@pytest.mark.parametrize("count", [3, 4])
def test_symmetric_lobes_carry_nothing_at_the_centre_and_are_isotropic(count: int) -> None:
    """A matrix of a count-fold symmetry, count at least 3, is a multiple of a rotation: K = [[a, b], [-b, a]]."""
    section = replace(PLAIN, lobes=LobedShell(count, 0.5, 0.2))
    ring = section.lobes.start + np.linspace(0.0, TURN, 24 * count + 1) if section.lobes else RING
    film = film_on(section, ring)

    def force(d: tuple[float, float], omega: float = 600.0) -> np.ndarray:
        return np.array(steady_loads(film, Motion(d, (0.0, 0.0), omega)).force)

    step = 1e-4
    size = np.linalg.norm(force((0.3, 0.0)))
    assert np.abs(force((0.0, 0.0), 0.0)).max() < 1e-300  # a full film begins at the smallest number above zero
    assert np.abs(force((0.0, 0.0))).max() < 1e-8 * size
    k = np.column_stack([(force((-x, -y)) - force((x, y))) / (2 * step) for x, y in ((step, 0.0), (0.0, step))])
    assert k[0, 0] == pytest.approx(k[1, 1], rel=1e-4)
    assert k[0, 1] == pytest.approx(-k[1, 0], rel=1e-4)
    assert k[0, 0] > 0.1 * abs(k[0, 1])  # a preload makes the centred film stiff; a plain one has no direct stiffness


def test_preload_makes_direct_stiffness_which_a_plain_bearing_has_not() -> None:
    step = 1e-4
    ratios = []
    for preload in (0.0, 0.3, 0.6):
        film = film_on(replace(PLAIN, lobes=LobedShell(3, preload, 0.0)), RING)
        force = np.array(steady_loads(film, Motion((step, 0.0), (0.0, 0.0), 600.0)).force)
        force -= np.array(steady_loads(film, Motion((-step, 0.0), (0.0, 0.0), 600.0)).force)
        ratios.append(-force[0] / np.linalg.norm(force))
    assert abs(ratios[0]) < 1e-3
    assert ratios[0] < ratios[1] < ratios[2]


def test_long_lobed_bearing_is_the_integral_of_the_reynolds_equation() -> None:
    """No flow along, full film: H^3 p' = omega / 2 (H - H_m) with the H_m that closes the turn."""
    section = replace(PLAIN, near="symmetry", far="symmetry", lobes=LobedShell(2, 0.4, 0.3))
    bath = Hole(section.lobes.start if section.lobes else 0.0, 0.5e-2, 1e-2, 10.0, 0.0, round=False)
    motion = Motion((0.25, -0.1), (0.0, 0.0), 400.0)
    phi = bath.position + bath.half_angle + np.linspace(0.0, TURN, 20_001)
    phi = phi[phi <= bath.position - bath.half_angle + TURN]
    h = gap_height(section, motion.d, phi)

    def integral(values: np.ndarray) -> np.ndarray:
        return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(phi)))

    first, second = integral(h**-2.0), integral(h**-3.0)
    pressure = 0.5 * motion.omega * (first - first[-1] / second[-1] * second)
    scale = section.copies * section.radius * section.width * section.pressure_scale
    expected = [scale * integral(pressure * np.sin(phi))[-1], -scale * integral(pressure * np.cos(phi))[-1]]
    section = replace(section, holes=(bath,))
    faces = bath.position + bath.half_angle + np.linspace(0.0, TURN - 2.0 * bath.half_angle, 385)
    faces = np.append(faces, faces[0] + TURN)
    film = film_on(section, faces, 2, Sommerfeld())
    assert steady_loads(film, motion).force == pytest.approx(expected, rel=2e-4)


def test_grid_has_faces_at_the_edges_of_lobes_and_meets_edges_that_fall_together() -> None:
    lobes = LobedShell(2, 0.5, 0.0)
    groove = AxialGroove(lobes.start + 0.15, 0.3, 1e5)  # begins where the lobe does
    section = replace(PLAIN, lobes=lobes, grooves=(groove,))
    grid = fitted_grid(section, (0.0, 0.3), 64, 8)
    assert np.diff(grid.phi).min() > 1e-3
    assert grid.phi[-1] - grid.phi[0] == pytest.approx(TURN, rel=1e-12)
    for edge in (lobes.start, lobes.start + lobes.arc, groove.position + 0.15):
        assert np.abs(np.remainder(grid.phi - edge + 1.0, TURN) - 1.0).min() < 1e-9
    once, twice = (graded_ring(32, 0.0, 0.5, np.array(edges)) for edges in ([0.3], [0.3, 0.3 + TURN]))
    assert len(twice) == len(once)


# --- bores and pockets -----------------------------------------------------------------------------------------------


def with_hole(position: float, axial: float, half_width: float = 1.25e-3, *, round_: bool = True) -> Section:
    return replace(PLAIN, holes=(Hole(position, axial, half_width / PLAIN.radius, half_width, 1e5, round_),))


@pytest.mark.parametrize("round_", [True, False])
@pytest.mark.parametrize("position", [0.0, 1.234, math.pi, -3.1])
def test_cells_cover_the_area_of_a_hole_exactly(position: float, round_: bool) -> None:
    for axial in (PLAIN.width, 0.63 * PLAIN.width):  # on the plane of symmetry only half of it is within the section
        section = with_hole(position, axial, round_=round_)
        grid = volume_grid(section, RING + 0.2, np.linspace(0.0, 1.0, 13))
        covered = float((grid.cover * grid.size).sum()) * section.radius * section.width
        assert covered == pytest.approx(hole_area(section, section.holes[0]), rel=1e-12)
        assert np.all((grid.cover >= -1e-14) & (grid.cover <= 1.0))


@pytest.mark.parametrize(("law", "bound"), [(Reynolds(), 1e-4), (Elrod(), 1.5e-3)], ids=["reynolds", "elrod"])
def test_force_changes_smoothly_as_a_bore_moves_across_the_cells(law: Law, bound: float) -> None:
    """A bore with 2 bar in the loaded part of the film, over two cells in steps of a tenth: what is left beside a
    smooth curve. By whole cells it would be 0.8 % (Reynolds) and 2.9 % (Elrod) on these cells."""
    cells = 160
    ring = np.linspace(-math.pi, math.pi, cells + 1)
    steps = np.linspace(-1.0, 1.0, 21)
    places = 2.64 + steps * TURN / cells
    forces = np.array([steady_loads(film_on(with_hole(p, PLAIN.width), ring, 20, law), ROTATION).force for p in places])
    smooth = np.column_stack([np.polyval(np.polyfit(steps, part, 4), steps) for part in forces.T])
    assert np.abs(forces - smooth).max() < bound * np.linalg.norm(forces, axis=1).min()


def test_bore_that_shrinks_gives_the_plain_film() -> None:
    plain = np.array(steady_loads(film_on(PLAIN, RING), ROTATION).force)
    gaps = []
    for half_width in (2e-3, 1e-3, 5e-4, 1e-5):
        film = film_on(with_hole(2.5, PLAIN.width, half_width), RING)
        gaps.append(float(np.linalg.norm(np.array(steady_loads(film, ROTATION).force) - plain)))
    assert gaps[0] > gaps[1] > gaps[2] > gaps[3] == 0.0


def test_pocket_between_faces_supplies_what_one_on_faces_does() -> None:
    """Flow through a pocket of a film at rest: on cells that end at its edges, and on cells that do not."""
    section = replace(PLAIN, holes=(Hole(0.0, PLAIN.width, 0.3, 4e-3, 1e5, round=False),))
    still = Motion((0.0, 0.0), (0.0, 0.0), 0.0)

    def flow(phi: np.ndarray, z: np.ndarray) -> float:
        film = VolumeFilm(section, volume_grid(section, phi, z), Sommerfeld(), 50.0)
        return steady_loads(film, still).oil.supply_m3_s

    fitted = flow(np.concatenate([np.linspace(-0.3, 0.3, 41), np.linspace(0.3, TURN - 0.3, 201)[1:]]),
                  np.linspace(0.0, 1.0, 51))  # fmt: skip
    for shift in (0.0, 0.01, 0.02):
        crossed = flow(np.linspace(-math.pi, math.pi, 191) + shift, np.linspace(0.0, 1.0, 47))
        assert crossed == pytest.approx(fitted, rel=0.01)


# --- turning frames --------------------------------------------------------------------------------------------------


def test_motion_in_a_frame_has_the_same_gap_and_the_same_change_of_it() -> None:
    motion, angle, speed, dt = Motion((0.3, -0.2), (5.0, 7.0), 300.0), 0.8, 120.0, 1e-7
    seen = seen_from(motion, angle, speed)
    later = Motion((0.3 + 5.0 * dt, -0.2 + 7.0 * dt), motion.v, motion.omega)
    phi = np.linspace(0.0, TURN, 13)
    h = gap_height(PLAIN, seen.d, phi)
    assert h == pytest.approx(gap_height(PLAIN, motion.d, phi + angle), rel=1e-12)
    change = (gap_height(PLAIN, later.d, phi + angle + speed * dt) - gap_height(PLAIN, motion.d, phi + angle)) / dt
    assert seen.v[0] * np.sin(phi) - seen.v[1] * np.cos(phi) == pytest.approx(change, abs=1e-3)
    assert turned(turned((1.0, 2.0), 0.4), -0.4) == pytest.approx((1.0, 2.0))


def test_tilting_motion_in_a_frame_has_the_same_gap_and_the_same_change_of_it_at_both_ends() -> None:
    motion, angle, speed = Motion((0.3, -0.2), (5.0, 7.0), 300.0, (0.2, 0.1), (-4.0, 9.0)), 0.8, 120.0
    seen, ends = seen_from(motion, angle, speed), np.array([0.0, 1.0])
    for z in ends:
        place = np.array([z])
        at, seen_at = (Motion(_number(each.displacement_at(place)), _number(each.velocity_at(place)), each.omega)
                       for each in (motion, seen))  # fmt: skip
        alone = seen_from(at, angle, speed)
        assert seen_at.d == pytest.approx(alone.d, rel=1e-12)
        assert seen_at.v == pytest.approx(alone.v, rel=1e-12)


def _number(pair: tuple[np.ndarray, np.ndarray]) -> tuple[float, float]:
    return float(pair[0][0]), float(pair[1][0])


@pytest.mark.parametrize("speed", [0.0, 150.0, 300.0, -80.0])
def test_plain_film_is_the_same_in_any_frame(speed: float) -> None:
    """Even ring, turned by a whole number of its cells: the same film to round-off, whatever the frame's speed."""
    film = film_on(PLAIN, RING, law=Reynolds())
    motion = polar_motion(0.5, -0.7, 20.0, 40.0, 300.0)
    angle = 7 * TURN / (len(RING) - 1)
    expected = steady_loads(film, motion)
    seen = seen_from(motion, angle, speed)
    found = loads(film, seen, FilmSolver(film).steady(seen), slip=motion.omega)
    # the surfaces carry a full film's oil by the gap in the middle of a face, its squeeze counts in that of a cell
    assert turned(found.force, angle) == pytest.approx(expected.force, rel=1e-3)
    assert found.torque.couette == pytest.approx(expected.torque.couette, rel=1e-12)
    if speed == 0.0:
        assert turned(found.force, angle) == pytest.approx(expected.force, rel=1e-9)


def test_cavity_of_a_plain_film_is_carried_alike_in_the_journals_frame() -> None:
    """Elrod's film in an oil bath, circling: marched in the lab and in the frame of the journal, omega_S' = -omega."""
    omega, rate = 200.0, 60.0

    def path(time: float) -> Motion:
        c, s = 0.6 * math.cos(rate * time), 0.6 * math.sin(rate * time)
        return Motion((c, s), (-rate * s, rate * c), omega)

    seen = path_seen_from(path, omega)
    assert seen(0.3).omega == -omega
    deviations = []
    for cells in (96, 192):
        film = film_on(PLAIN, np.linspace(-math.pi, math.pi, cells + 1), 6, Elrod())
        times = np.linspace(0.0, 0.02, 5 * cells // 3 + 1)
        *_, lab = march(film, path, times)
        *_, frame = march(film, seen, times)
        expected = np.array(loads(film, lab.motion, lab.solution).force)
        force = np.array(turned(loads(film, frame.motion, frame.solution).force, omega * frame.time))
        deviations.append(float(np.linalg.norm(force - expected) / np.linalg.norm(expected)))
    assert deviations[1] < 5e-3
    assert deviations[1] < 0.5 * deviations[0]  # it is of the cells, not of the frame


@pytest.mark.parametrize("law", [Reynolds(), HalfSommerfeld()], ids=["reynolds", "half-sommerfeld"])
def test_turning_bore_is_in_its_frame_what_a_bore_at_that_place_is_in_the_lab(law: Law) -> None:
    """Of a film without a state, at a moment: the journal has turned by 9 cells, and the bore with it."""
    angle, speed = 9 * TURN / (len(RING) - 1), 300.0
    motion = polar_motion(0.5, -0.7, 20.0, 40.0, speed)
    lab = film_on(with_hole(2.2 + angle, PLAIN.width), RING, law=law)
    expected = steady_loads(lab, motion)
    journal = film_on(with_hole(2.2, PLAIN.width), RING, law=law)
    seen = seen_from(motion, angle, speed)
    found = loads(journal, seen, FilmSolver(journal).steady(seen), slip=motion.omega)
    deviation = np.array(turned(found.force, angle)) - expected.force
    assert np.linalg.norm(deviation) < 2e-3 * np.linalg.norm(expected.force)
    elsewhere = np.array(steady_loads(film_on(with_hole(2.2, PLAIN.width), RING, law=law), motion).force)
    assert np.linalg.norm(elsewhere - expected.force) > 0.02 * np.linalg.norm(expected.force)


# --- supply over time ------------------------------------------------------------------------------------------------


def test_supply_rises_as_printed() -> None:
    """(4.11): 0 at first, more than 0.99 from 4.7 t_1 on."""
    assert supply_share(0.0, 0.01) == 0.0
    assert supply_share(0.046, 0.01) < 0.99 < supply_share(0.047, 0.01)
    assert supply_share(0.0, 0.0) == 1.0


@pytest.mark.parametrize("supply", ["circumferential-groove", "axial-groove", "bore"])
def test_film_with_a_share_of_its_supply_is_one_with_that_pressure(supply: str) -> None:
    def section(pressure: float) -> Section:
        if supply == "bore":
            holes = with_hole(1.0, PLAIN.width).holes
            return replace(PLAIN, holes=tuple(replace(hole, pressure=pressure - 1e5) for hole in holes))
        return section_of(supply, pressure)

    full, part = film_on(section(3e5), RING), film_on(section(1.5e5), RING)
    expected = steady_loads(part, ROTATION)
    assert steady_loads(supplied(full, 0.25), ROTATION).force == pytest.approx(expected.force, rel=1e-9)
    assert supplied(full, 1.0).section == full.section


# --- strains and Reynolds numbers ------------------------------------------------------------------------------------

CAR, ENGINE = TURN * 5000.0, TURN * 1500.0  # rad/s, tables A.1 and A.2


@pytest.mark.parametrize(
    ("omega", "diameter", "clearance", "viscosity", "printed"),
    [
        # table A.1 lists 12 mPa s for the inner films, too, but its Reynolds numbers there are those of 10 mPa s
        (1.3 * CAR, 7e-3, 15e-6, 10e-3, 193.0),
        (1.3 * ENGINE, 25e-3, 35e-6, 10e-3, 482.0),
        (0.3 * CAR, 11e-3, 35e-6, 12e-3, 136.0),
        (0.3 * ENGINE, 40e-3, 50e-6, 12e-3, 212.0),
    ],
)
def test_reynolds_numbers_of_table_a1(
    omega: float, diameter: float, clearance: float, viscosity: float, printed: float
) -> None:
    assert reynolds_number(900.0, omega, 0.5 * diameter, clearance, viscosity) == pytest.approx(printed, abs=0.6)


def test_strains_of_table_a2() -> None:
    printed = 0.6e-6  # half of the last digit
    assert shaft_rotation_strain(STEEL, CAR, 3.5e-3) == pytest.approx(0.083e-3, abs=printed)
    assert shaft_rotation_strain(STEEL, ENGINE, 12.5e-3) == pytest.approx(0.095e-3, abs=printed)
    car = ring_rotation_strains(BRASS, 0.4 * CAR, 3.5e-3, 5.5e-3)
    engine = ring_rotation_strains(BRASS, 0.4 * ENGINE, 12.5e-3, 20e-3)
    assert car == pytest.approx((0.492e-3, 0.271e-3), abs=printed)
    assert engine == pytest.approx((0.584e-3, 0.314e-3), abs=printed)


def test_solid_ring_is_a_shaft() -> None:
    assert ring_rotation_strains(STEEL, 1e3, 0.0, 0.02)[1] == pytest.approx(shaft_rotation_strain(STEEL, 1e3, 0.02))


# --- what the case says ----------------------------------------------------------------------------------------------


def plan_of(*settings: str, test: str = "rotation", cavitation: str = "elrod") -> KinematicPlan:
    case = load_case("bearing", ["motion={eccentricity=0.3, speed='100 Hz'}", *settings])
    return kinematic_plan(case, cavitation, test)


def test_lobes_of_a_case_reach_the_section() -> None:
    plan = plan_of("bearing.lobes={count=3, preload=0.5, position='1.5 rad', offset=0.6}", cavitation="half-sommerfeld")
    assert plan.section.lobes == LobedShell(3, 0.5, 1.5, 0.6)
    assert plan.section.clearance == pytest.approx(40e-6)  # that of the assembled bearing
    assert not plan.modal  # the modal film knows a plain gap only
    assert "lobes" in {decision.choice for decision in plan.decisions}


@pytest.mark.parametrize(
    ("setting", "key"),
    [
        ("bearing.lobes={count=3, preload=1}", "bearing.lobes.preload"),
        ("bearing.lobes={count=1, preload=0.5}", "bearing.lobes.count"),
        ("bearing.lobes={count=3, preload=0.96}", "bearing.lobes.preload"),  # bored 1 mm wider
        ("bearing.supply={kind='bores', count=6, diameter='2 mm', pressure='2 bar', ramp='-1 s'}",
         "bearing.supply.ramp"),
        ("bearing.supply={kind='axial-grooves', count=3, opening_angle='120 deg', pressure='2 bar'}",
         "bearing.supply.opening_angle"),
        ("bearing.supply={kind='axial-grooves', count=2, opening_angle='180 deg', pressure='2 bar'}",
         "bearing.supply.opening_angle"),
        ("bearing={kind='single-film', width='20 mm', diameter='25 mm', clearance='40 um', "
         "lobes={count=3, preload=0.5}, "
         "supply={kind='bores', count=6, diameter='2 mm', pressure='2 bar', on='journal'}}", "bearing.lobes"),
        ("bearing.supply={kind='bores', count=6, diameter='2 mm', pressure='2 bar', on='journal'}",
         "bearing.supply.on"),
        ("motion.eccentricity=1", "motion.eccentricity"),
        ("bearing.supply={kind='none'}", "bearing.supply.kind"),
    ],
)  # fmt: skip
def test_geometry_that_cannot_be_is_named_by_its_key(setting: str, key: str) -> None:
    with pytest.raises(InputError) as raised:
        plan_of(setting)
    assert key in {fault.key for fault in raised.value.faults}


@pytest.mark.parametrize(
    ("settings", "cavitation", "expected"),
    [
        ((), "elrod", True),
        ((), "two-phase", True),
        ((), "reynolds", False),
        (("bearing.supply.pressure='1.2 bar'",), "elrod", False),
        (("bearing.ends='oil-bath'",), "elrod", True),  # at the pressure of the cavities a bath pushes nothing in
        (("bearing.ends='oil-bath'",), "two-phase", False),  # whose pressure falls below that of the bath
        (("bearing.ends='oil-bath'", "oil.cavitation_pressure='0.8 bar'"), "elrod", False),
        (("oil.cavitation_pressure='0.8 bar'",), "elrod", False),
        (("bearing.supply={kind='axial-grooves', opening_angle='15 deg', pressure='1 bar'}",), "elrod", False),
    ],
)
def test_plan_says_beforehand_that_a_film_will_starve(
    settings: tuple[str, ...], cavitation: str, expected: bool
) -> None:
    told = {(decision.choice, decision.value) for decision in plan_of(*settings, cavitation=cavitation).decisions}
    assert (("supply", "starves") in told) is expected


def test_check_shows_gap_and_reynolds_number(capsys: pytest.CaptureFixture[str]) -> None:
    """The bearing of table A.1, large engine, in a single film at its top speed; with (4.24) and Vogel's law (3.12)."""
    settings = ["bearing.clearance='35 um'", "oil.viscosity='10 mPa*s'", "oil.density='900 kg/m^3'",
                "motion={eccentricity=0.3, speed='1950 Hz'}"]  # fmt: skip
    options = [word for setting in settings for word in ("--set", setting)]
    assert run(["check", "bearing", "--json", *options]) == 0
    spoken = capsys.readouterr()
    film = json.loads(spoken.out)["films"][0]
    assert film["reynolds_number"] == pytest.approx(482.0, abs=0.6)
    assert film["laminar"]
    assert film["turning_m"] == pytest.approx(-12.5e-3 * 0.095e-3 * 1.3**2, rel=0.01)
    assert "Warning" not in spoken.out + spoken.err
    assert run(["check", "bearing", *options, "--set", "oil.viscosity='2 mPa*s'"]) == 0
    assert "Warning: Reynolds number 2412 in film" in capsys.readouterr().out
    engine = ["speed.to='1500 Hz'", "bearing.0.inner.diameter='25 mm'", "bearing.0.outer.diameter='40 mm'"]
    inner, outer = operating_points(load_case("turbocharger-heavy", engine))[:2]
    assert (inner.omega, outer.omega) == pytest.approx((1.3 * ENGINE, 0.3 * ENGINE))
    assert inner.turning == pytest.approx(12.5e-3 * (0.584e-3 * (0.3 / 0.4) ** 2 - 0.095e-3), rel=0.01)
    assert outer.turning == pytest.approx(-20e-3 * 0.314e-3 * (0.3 / 0.4) ** 2, rel=0.01)
    steel = operating_points(load_case("turbocharger-heavy", [*engine, "bearing.0.ring.material=steel"]))[1]
    share = (7850.0 / 2.1e11) / (8860.0 / 78e9)  # of density over modulus, and little of Poisson's ratio
    assert steel.turning == pytest.approx(share * outer.turning, rel=0.1)
    inner, outer = operating_points(load_case("turbocharger-heavy", [*engine, "bearing.0.ring.spin=blocked"]))[:2]
    assert (inner.omega, outer.omega, outer.turning) == pytest.approx((ENGINE, 0.0, 0.0))
    warm = ("{cold='35 um', reference_temperature='20 degC', shell_temperature='70 degC', "
            "journal_temperature='100 degC', shell_expansion='1.17e-5 1/K', "
            "journal_expansion='1.18e-5 1/K'}")  # fmt: skip
    point = operating_points(load_case("bearing", [f"bearing.clearance={warm}"]))[0]
    psi = 35e-6 / 12.5e-3 + 1.17e-5 * 50.0 - 1.18e-5 * 80.0  # (4.21), (4.22)
    assert point.clearance == pytest.approx(12.5e-3 * psi, rel=1e-9)
    assert point.warming == pytest.approx(point.clearance - 35e-6, rel=1e-9)
