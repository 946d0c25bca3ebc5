"""Geometry of the gap against known answers: lobes, edges of bores, turning frames, supply over time; and what a case
makes of it: numbers of tables A.1 and A.2, faults, the plan."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from commands import Frb
from differences import differences
from volume_films import ROTATION, polar_motion, section_of

from frbcli import load_case
from frbcli.bearing_tests.history import march
from frbcli.film.cavitation.conditions import Elrod, HalfSommerfeld, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.film import Motion, VolumeFilm, path_seen_from, seen_from, supplied, supply_share, turned
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.mesh.grid import fitted_grid, volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import (
    AxialGroove,
    Hole,
    LobedShell,
    Section,
    TabledShell,
    gap_height,
    graded_ring,
    reynolds_number,
    ring_rotation_strains,
    shaft_rotation_strain,
    smallest_gap,
)
from frbcli.materials import BRASS, STEEL
from frbcli.scene.machine.findings import operating_points
from frbcli.scene.planning.kinematic_plan import KinematicPlan, kinematic_plan

TURN = 2.0 * math.pi
PLAIN = section_of("none")
RING = np.linspace(-math.pi, math.pi, 97)


def film_on(section: Section, phi: np.ndarray, along: int = 8, law: Law | None = None) -> VolumeFilm:
    return VolumeFilm(section, volume_grid(section, phi, np.linspace(0.0, 1.0, along + 1)), law or Reynolds(), 50.0)


def steady_loads(film: VolumeFilm, motion: Motion) -> FilmLoads:
    return loads(film, motion, FilmSolver(film).steady(motion))


# --- lobes -----------------------------------------------------------------------------------------------------------


def test_a_table_of_the_gap_of_lobes_has_their_forces() -> None:
    """Linear between 720 points: within the square of half a degree."""
    lobes = LobedShell(3, 0.5, 0.7)
    angles = np.linspace(0.0, TURN, 720, endpoint=False)
    table = TabledShell(tuple(angles.tolist()), tuple(lobes.depth(angles).tolist()))
    own, tabled = (
        steady_loads(film_on(replace(PLAIN, profile=each), RING, 12), ROTATION).force
        for each in (lobes, table)
    )
    np.testing.assert_allclose(tabled, own, rtol=2e-4)


def test_a_profile_is_one_turn_that_closes() -> None:
    table = TabledShell((0.1, 1.0, 3.0, 6.0), (0.0, 0.5, 0.25, 0.4))
    phi = np.array([0.1, 2.0, 6.0 + 0.5 * (TURN - 5.9), 0.1 + TURN, 1.0 - TURN])
    np.testing.assert_allclose(table.depth(phi), [0.0, 0.375, 0.2, 0.0, 0.5], atol=1e-14)


@pytest.mark.parametrize("offset", [0.3, 0.5, 1.0])
def test_gap_of_lobes_is_between_assembled_and_machined_clearance(offset: float) -> None:
    """Smallest, 1, at the offset of each lobe; the centre of a lobe's bore is c_p - c_b away from the bearing's."""
    lobes = LobedShell(3, 0.5, 0.7, offset)
    section = replace(PLAIN, profile=lobes)
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
    lobed = replace(PLAIN, profile=LobedShell(1, preload, position))
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
    section = replace(PLAIN, profile=LobedShell(count, 0.5, 0.2))
    ring = section.profile.start + np.linspace(0.0, TURN, 24 * count + 1) if section.profile else RING
    film = film_on(section, ring)

    def force(d: tuple[float, float], omega: float = 600.0) -> np.ndarray:
        return np.array(steady_loads(film, Motion(d, (0.0, 0.0), omega)).force)

    size = np.linalg.norm(force((0.3, 0.0)))
    assert np.abs(force((0.0, 0.0), 0.0)).max() < 1e-300  # a full film begins at the smallest number above zero
    assert np.abs(force((0.0, 0.0))).max() < 1e-8 * size
    k = -differences(lambda d: force(tuple(d)), (0.0, 0.0), 1e-4)
    assert k[0, 0] == pytest.approx(k[1, 1], rel=1e-4)
    assert k[0, 1] == pytest.approx(-k[1, 0], rel=1e-4)
    assert k[0, 0] > 0.1 * abs(k[0, 1])  # a preload makes the centred film stiff; a plain one has no direct stiffness


def test_long_lobed_bearing_is_the_integral_of_the_reynolds_equation() -> None:
    """No flow along, full film: H^3 p' = omega / 2 (H - H_m) with the H_m that closes the turn."""
    section = replace(PLAIN, near="symmetry", far="symmetry", profile=LobedShell(2, 0.4, 0.3))
    bath = Hole(section.profile.start if section.profile else 0.0, 0.5e-2, 1e-2, 10.0, 0.0, round=False)
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
    section = replace(PLAIN, profile=lobes, grooves=(groove,))
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
    area = (math.pi if round_ else 4.0) * 1.25e-3**2
    for axial, share in ((PLAIN.width, 0.5), (0.63 * PLAIN.width, 1.0)):  # half of it beyond the plane of symmetry
        section = with_hole(position, axial, round_=round_)
        grid = volume_grid(section, RING + 0.2, np.linspace(0.0, 1.0, 13))
        covered = float((grid.cover * grid.size).sum()) * section.radius * section.width
        assert covered == pytest.approx(share * area, rel=1e-12)
        assert np.all((grid.cover >= -1e-14) & (grid.cover <= 1.0))


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


CAR, ENGINE = 2.0 * math.pi * 5000.0, 2.0 * math.pi * 1500.0  # rad/s, tables A.1 and A.2


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


def plan_of(*settings: str, test: str = "rotation", cavitation: str = "elrod") -> KinematicPlan:
    case = load_case("bearing", ["motion={eccentricity=0.3, speed='100 Hz'}", *settings])
    return kinematic_plan(case, cavitation, test)


def test_lobes_of_a_case_reach_the_section() -> None:
    plan = plan_of("bearing.lobes={count=3, preload=0.5, position='1.5 rad', offset=0.6}", cavitation="half-sommerfeld")
    assert plan.section.profile == LobedShell(3, 0.5, 1.5, 0.6)
    assert plan.section.clearance == pytest.approx(40e-6)  # that of the assembled bearing
    assert not plan.modal  # the modal film knows a plain gap only
    assert "lobes" in {decision.choice for decision in plan.decisions}


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


def test_check_shows_gap_and_reynolds_number(frb: Frb) -> None:
    """The bearing of table A.1, large engine, in a single film at its top speed; with (4.24) and Vogel's law (3.12)."""
    settings = ["bearing.clearance='35 um'", "oil.viscosity='10 mPa*s'", "oil.density='900 kg/m^3'",
                "motion={eccentricity=0.3, speed='1950 Hz'}"]  # fmt: skip
    options = [word for setting in settings for word in ("--set", setting)]
    spoken = frb("check", "bearing", "--json", *options)
    film = json.loads(spoken.out)["films"][0]
    assert film["reynolds_number"] == pytest.approx(482.0, abs=0.6)
    assert film["laminar"]
    assert film["turning_m"] == pytest.approx(-12.5e-3 * 0.095e-3 * 1.3**2, rel=0.01)
    assert "Warning" not in spoken.out + spoken.err
    said = frb("check", "bearing", *options, "--set", "oil.viscosity='2 mPa*s'")
    assert "Warning: Reynolds number 2412 in film" in said.out
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
