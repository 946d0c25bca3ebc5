"""Bores of the size of a cell, whose flows, forces and areas are those of their true shape wherever they lie; and slots
along a part of the width, against pockets, symmetries and a closed form."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from differences import differences

from frbcli import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run
from frbcli.film.cavitation.conditions import Elrod, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.film import Motion, VolumeFilm, VolumeSolution
from frbcli.film.cells.loads import force, loads, oil_balance
from frbcli.film.cells.mesh.grid import VolumeGrid, force_weights, run_grid, volume_grid
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Hole, Section
from frbcli.film.section_faults import section_faults
from frbcli.report.sketch import film_sketches, rotor_sketch
from frbcli.runs.run import runup
from frbcli.scene.films import film_places, film_section, volume_film
from frbcli.scene.planning.cell_choice import BORES_OIL

RADIUS, WIDTH, CLEARANCE, VISCOSITY, GAUGE, COUNT = 12.5e-3, 20e-3, 40e-6, 12e-3, 1e5, 6
TURN = 2.0 * math.pi
STILL = Motion((0.0, 0.0), (0.0, 0.0), 0.0)


def bored(position: float, size: float = 1.25e-3, middle: float = 0.5) -> Section:
    """Six bores in a bath, half of it where they lie in the middle."""
    copies, far = (2, "symmetry") if middle == 0.5 else (1, "oil-bath")
    places = (position + i * TURN / COUNT for i in range(COUNT))
    holes = tuple(Hole(place, middle * WIDTH, size / RADIUS, size, GAUGE, True) for place in places)
    numbers = RADIUS, WIDTH / copies, WIDTH, CLEARANCE, VISCOSITY, 1e5, 0.9e5
    return Section(*numbers, copies, "oil-bath", far, holes=holes)


def cells_of(section: Section, around: int, along: int) -> VolumeGrid:
    return volume_grid(section, np.linspace(-math.pi, math.pi, around + 1), np.linspace(0.0, 1.0, along + 1))


def solved(section: Section, around: int, along: int, law: Law, motion: Motion) -> tuple[VolumeFilm, VolumeSolution]:
    film = VolumeFilm(section, cells_of(section, around, along), law, 100.0)
    return film, FilmSolver(film).steady(motion)


def force_of(section: Section, around: int, along: int, law: Law, motion: Motion) -> np.ndarray:
    film, solution = solved(section, around, along, law, motion)
    return np.array(force(film, film.mean_pressure(solution.state)))


def row_of_bores(size: float) -> float:
    """Flow in m^3/s through six bores in the middle of a film at rest with an even gap.

    Between two baths a distance B apart, the potential of a source is -ln |tanh(pi z / 2 B)| / 2 pi of the complex
    place z; those of a row add up. The pressure on the edge of a bore is even up to the fourth order of size / B.
    """
    distances = np.arange(1, 60) * TURN * RADIUS / COUNT
    others = -2.0 * np.log(np.tanh(math.pi * distances / (2.0 * WIDTH))).sum()
    resistance = math.log(2.0 * WIDTH / (math.pi * size)) + others
    return COUNT * TURN * GAUGE * CLEARANCE**3 / (12.0 * VISCOSITY) / resistance


@pytest.mark.parametrize("size", [0.4e-3, 0.8e-3, 1.25e-3, 2e-3])
def test_flow_through_a_row_of_bores_is_the_known_one(size: float) -> None:
    """Also of bores smaller than a cell, 1.6 mm, wherever they lie."""
    for shift in np.linspace(0.0, 1.0, 9):
        section = bored(shift * TURN / 48, size)
        film, solution = solved(section, 48, 6, Sommerfeld(), STILL)
        assert oil_balance(film, solution).supply_m3_s == pytest.approx(row_of_bores(size), rel=2.5e-3)


@pytest.mark.parametrize(("cells", "bound"), [(48, 2e-3), (96, 5e-4)])
def test_integral_of_the_pressure_is_that_of_the_oil_that_bores_feed(cells: int, bound: float) -> None:
    """By Green's identity with v = z (B - z) / 2, which curves by -1: it is Q 12 eta / C^3 (B^2 / 8 - a^2 / 4),
    openings included, if the oil enters evenly around them."""
    for shift in np.linspace(0.0, 1.0, 9):
        section = bored(shift * TURN / 48)
        film, solution = solved(section, cells, cells // 8, Sommerfeld(), STILL)
        weights = force_weights(section, film.grid) * np.diff(film.grid.phi)[:, None]
        scale = section.copies * section.radius * section.width * section.pressure_scale
        found = scale * float((weights * film.pressure(solution.state)).sum())
        flow = oil_balance(film, solution).supply_m3_s
        known = flow * 12.0 * VISCOSITY / CLEARANCE**3 * (WIDTH**2 / 8.0 - 1.25e-3**2 / 4.0)
        assert found == pytest.approx(known, rel=bound)


@pytest.mark.parametrize(
    ("law", "eccentricity", "bound"), [(Reynolds(), 0.3, 5e-3), (Reynolds(), 0.7, 4e-3), (Elrod(), 0.7, 4e-3)]
)
def test_force_is_of_second_order_and_the_same_wherever_bores_lie(law: Law, eccentricity: float, bound: float) -> None:
    """Of bores smaller than two cells on 48 x 6 cells; by the cells that they cover it was off by up to 4 %."""
    motion = Motion((0.0, -eccentricity), (0.0, 0.0), 900.0)
    coarse, fine = [], []
    for shift in (0.1, 0.4, 0.7):
        section = bored(shift * TURN / 48)
        finer, finest = (force_of(section, cells, cells // 8, law, motion) for cells in (144, 288))
        limit = finest + (finest - finer) / 3.0
        for errors, cells in ((coarse, 48), (fine, 96)):
            found = force_of(section, cells, cells // 8, law, motion)
            errors.append(float(np.linalg.norm(found - limit) / np.linalg.norm(limit)))
    assert max(coarse) < bound
    assert max(fine) < 0.25 * bound


@pytest.mark.parametrize("law", [Elrod(), TwoPhase(0.95)], ids=lambda law: law.name)
@pytest.mark.parametrize("eccentricity", [0.4, 0.8])
def test_a_journal_rests_where_the_plan_expects_it(law: Law, eccentricity: float) -> None:
    """What the force on 48 x 6 cells is off by moves a journal at rest by less than half of the error that the plan
    expects of them; its bores lie beside the narrowest gap."""
    beside = TURN / (2 * COUNT)

    def pushed(cells: int, x: float = 0.0, y: float = 0.0, shift: float = 0.0) -> np.ndarray:
        """Force on a journal at (x, -eccentricity + y), turned with its bores by `shift` and back."""
        c, s = math.cos(shift), math.sin(shift)
        d = c * x - s * (y - eccentricity), s * x + c * (y - eccentricity)
        f = force_of(bored(beside + shift), cells, cells // 8, law, Motion(d, (0.0, 0.0), 942.0))
        return np.array([c * f[0] + s * f[1], c * f[1] - s * f[0]])

    stiffness = differences(lambda at: pushed(96, *at), (0.0, 0.0), 2e-3)
    finer, finest = pushed(144), pushed(192)
    limit = finest + (finest - finer) / ((192 / 144) ** 2 - 1.0)
    moved = [
        np.linalg.norm(np.linalg.solve(stiffness, pushed(48, shift=share * TURN / 48) - limit))
        for share in (0.0, 0.25, 0.5, 0.75)
    ]
    assert max(moved) < 0.5 * BORES_OIL.of((48, 6))


def test_force_hardly_jumps_as_bores_move_over_a_coarse_mesh() -> None:
    """Over two cells in steps of a twentieth: what is left beside a smooth curve."""
    motion, steps = Motion((0.0, -0.6), (0.0, 0.0), 900.0), np.linspace(-1.0, 1.0, 41)
    forces = np.array([force_of(bored(step * TURN / 48), 48, 6, Reynolds(), motion) for step in steps])
    smooth = np.column_stack([np.polyval(np.polyfit(steps, part, 4), steps) for part in forces.T])
    left = np.linalg.norm(forces - smooth, axis=1) / np.linalg.norm(forces, axis=1)
    assert np.sqrt((left**2).mean()) < 8e-4


@pytest.mark.parametrize("middle", [0.5, 0.3])
def test_areas_remain_those_of_the_cells(middle: float) -> None:
    """Together they push as whole cells do, in total and about the axis, so that an even pressure has no force."""
    random = np.random.default_rng(3)
    for size in random.uniform(0.2e-3, 3e-3, 30):
        around, along = int(random.integers(24, 80)), int(random.integers(4, 16))
        section = bored(float(random.uniform(0.0, TURN)), float(size), middle)
        grid = cells_of(section, around, along)
        assert np.all(grid.area > 0.0)
        assert np.all(grid.load > 0.0)
        assert np.all(grid.around >= 0.0)
        assert np.all(grid.along >= 0.0)
        assert (grid.load * grid.size).sum() == pytest.approx(TURN, rel=1e-12)
        film = VolumeFilm(section, grid, Sommerfeld(), 100.0)
        one = np.full(grid.shape, 1.0)
        whole = section.copies * section.radius * section.width * section.pressure_scale
        assert np.hypot(*force(film, one)) < 2e-3 * whole


def test_a_warm_film_has_the_cells_of_the_cold_one() -> None:
    """Its pressures alone have another scale."""
    cold = bored(0.3)
    warm = replace(cold, viscosity=0.3 * cold.viscosity, clearance=1.1 * cold.clearance)
    own, other = run_grid(cold, (24, 6)), run_grid(warm, (24, 6))
    assert own.around is other.around
    for section, grid in ((cold, own), (warm, other)):
        expected = volume_grid(section, grid.phi, grid.z)
        for name in ("around", "along", "at", "area", "load", "cover", "fixed_pressure"):
            np.testing.assert_array_equal(getattr(grid, name), getattr(expected, name))


CELLS, FINE = (48, 6), (192, 24)


def case_of(*settings: str, count: int = 2, length: str = "10 mm", angle: str = "10 deg") -> Case:
    sizes = f'position = "0 deg", opening_angle = "{angle}", length = "{length}", pressure = "2 bar"'
    return load_case("rigid", [f'bearing.supply={{ kind = "axial-slots", count = {count}, {sizes} }}', *settings])


def pocket_of(length: str) -> Case:
    sizes = f'position = "0 deg", opening_angle = "10 deg", width = "{length}", pressure = "2 bar"'
    return load_case("rigid", [f'bearing.supply={{ kind = "pocket", {sizes} }}'])


def push(
    case: Case, d: tuple[float, float], v: tuple[float, float], omega: float, cells: tuple[int, int] = CELLS
) -> np.ndarray:
    film, motion = volume_film(case, film_places(case)[0], cells), Motion(d, v, omega)
    return np.array(loads(film, motion, FilmSolver(film).steady(motion)).force)


@pytest.mark.parametrize("length", ["10 mm", "20 mm"])
def test_one_slot_is_a_pocket_of_the_same_size(length: str) -> None:
    """20 mm is the whole width of the bearing."""
    slot, pocket = case_of(count=1, length=length), pocket_of(length)
    sections = [film_section(case, case.bearings[0]) for case in (slot, pocket)]  # type: ignore[arg-type]
    assert sections[0] == sections[1]
    assert section_faults(sections[0]) == []
    motion = ((0.4, -0.3), (2.0, 5.0), 300.0)
    assert push(slot, *motion) == pytest.approx(push(pocket, *motion), rel=1e-12)


def test_two_slots_have_the_symmetry_of_a_half_turn() -> None:
    """The push turns with a motion that is turned by half a turn. One slot pushes the journal away from it."""
    d, v, omega = (0.4, -0.3), (2.0, 5.0), 300.0
    turned = (-d[0], -d[1]), (-v[0], -v[1]), omega
    found = push(case_of(), d, v, omega)
    assert push(case_of(), *turned) == pytest.approx(-found, rel=1e-9, abs=1e-9 * float(np.linalg.norm(found)))
    still = (0.0, 0.0), (0.0, 0.0), 0.0
    one = push(case_of(count=1), *still)
    assert one[1] < -1.0
    assert abs(one[0]) < 1e-9 * abs(one[1])
    assert np.abs(push(case_of(), *still)).max() < 1e-9 * abs(one[1])


def test_force_of_a_slot_over_the_width_is_its_closed_form() -> None:
    """Laplace's equation on the gap of a journal at rest: beside the slot the modes sin(n pi z / B) with odd n decay
    with exp(-n pi R phi / B)."""
    radius, width, half, gauge = 12.5e-3, 20e-3, math.radians(5.0), 1e5
    n = np.arange(1.0, 4001.0, 2.0)
    a = n * math.pi * radius / width
    beside = 2.0 * (8.0 * width / (math.pi * n) ** 2) @ ((a * math.cos(half) - math.sin(half)) / (a**2 + 1.0))
    expected = gauge * radius * (2.0 * width * math.sin(half) + beside)
    still = (0.0, 0.0), (0.0, 0.0), 0.0
    errors = [-push(case_of(count=1, length="20 mm"), *still, cells)[1] / expected - 1.0 for cells in (CELLS, FINE)]
    assert abs(errors[0]) < 1e-2
    assert abs(errors[1]) < 1e-3
    shorter = [-push(case_of(count=1, length=f"{mm} mm"), *still)[1] for mm in (1, 5, 10, 15, 20)]
    assert np.diff(shorter).min() > 1.0


def test_check_and_sketch_tell_of_slots(capsys: pytest.CaptureFixture[str]) -> None:
    case = case_of()
    slots = 'bearing.supply={kind="axial-slots", count=2, opening_angle="10 deg", length="10 mm", pressure="2 bar"}'
    assert run(["check", "rigid", "--set", slots]) == 0
    assert "2 axial slots, 2 bar" in capsys.readouterr().out
    (_, around), = film_sketches(case)
    (_, around_one), = film_sketches(case_of(count=1))
    assert around.count('"oil"') == 2 * around_one.count('"oil"') == 2
    assert rotor_sketch(case)[0].count('"oil"') == 4  # above and below the axis, in both bearings


def test_a_rotor_runs_on_slots(tmp_path: Path) -> None:
    found = runup(case_of("speed.duration=0.02 s"), tmp_path / "run.h5")
    assert found.status == "finished"
