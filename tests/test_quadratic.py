"""Films on quadratic elements: their mesh, their solver, their forces and derivatives, against what is known."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from volume_films import motion_of, polar_motion, reference_rows, section_of

from frbcli.errors import InputError
from frbcli.film.cavitation.sommerfeld import Sommerfeld
from frbcli.film.cells.openings import hole_area
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.cells.plain.film import VolumeFilm, fitted_grid, reference_pressure
from frbcli.film.cells.plain.loads import force as volume_force
from frbcli.film.gap import AxialGroove, Hole, Lobes, Section
from frbcli.film.quadratic.film import Cavitation, PenaltyReading, QuadraticFilm, quadratic_film
from frbcli.film.quadratic.force import quadratic_force
from frbcli.film.quadratic.mesh import quadratic_mesh
from frbcli.film.quadratic.operator import element_matrices
from frbcli.film.quadratic.penalty import penalty_scales, solve_penalty
from frbcli.film.quadratic.plain import PlainQuadraticFilm
from frbcli.film.quadratic.ring import COLUMN, ROW, factorise, make_ring
from frbcli.film.quadratic.ring_solve import solve

Array = np.ndarray
RADIUS, WIDTH = 12.5e-3, 20e-3
PLAIN = Section(RADIUS, WIDTH, WIDTH, 40e-6, 10e-3, 1e5, 1e5, 1, "oil-bath", "oil-bath")


def bore(position: float, axial: float = 10e-3, radius: float = 1.25e-3, pressure: float = 1e5) -> Hole:
    return Hole(position, axial, radius / RADIUS, radius, pressure, True)


SIX = tuple(bore(0.1 + n * math.pi / 3) for n in range(6))
SECTIONS = {
    "plain": PLAIN,
    "six bores": replace(PLAIN, holes=SIX),
    "half of six bores": replace(PLAIN, width=WIDTH / 2, copies=2, far="symmetry", holes=SIX),
    "bore across the seam": replace(PLAIN, holes=(bore(0.0, 6e-3, 3e-3, 2e5), bore(0.7, 13e-3, 3e-3, 2e5))),
    "pocket": replace(PLAIN, holes=(Hole(1.0, 9e-3, 0.4, 6e-3, 1e5, False),)),
    "axial groove": replace(PLAIN, grooves=(AxialGroove(0.0, 0.26, 1e5),)),
    "groove and bore": replace(PLAIN, grooves=(AxialGroove(2.0, 0.2, 1e5),), holes=(bore(-1.0, 5e-3),)),
    "circumferential groove": replace(PLAIN, width=WIDTH / 2, copies=2, far="groove", far_pressure=1e5),
    "lobes": replace(PLAIN, lobes=Lobes(3, 0.4, 0.2)),
}
LAWS: dict[str, tuple[Cavitation, PenaltyReading]] = {
    "sommerfeld": ("sommerfeld", "absolute"),
    "half-sommerfeld": ("half-sommerfeld", "absolute"),
    "penalty": ("penalty", "absolute"),
    "penalty, dimensionless": ("penalty", "dimensionless"),
}
D, V, OMEGA = (0.3, -0.5), (20.0, -30.0), 600.0


@functools.cache
def film_of(section: Section, law: str, around: int, along: int) -> QuadraticFilm:
    """The film, made once per test process."""
    return quadratic_film(section, *(LAWS[law][:1]), around, along, LAWS[law][1])


def evaluate(film: QuadraticFilm, d: Array, v: Array, omega: float) -> Array:
    """The ten numbers, from a full film."""
    return np.array(quadratic_force(film, np.zeros(film.fixed.shape), *d, *v, omega))


def forces(section: Section, law: str, motion: Motion, around: int, along: int) -> Array:
    return evaluate(film_of(section, law, around, along), motion.d, motion.v, motion.omega)[:2]


def deviation(found: Array, known: Array) -> float:
    return float(np.linalg.norm(found - known) / np.linalg.norm(known))


# --- the mesh


@pytest.mark.parametrize("mesh", [(20, 10), (41, 17)], ids=str)
@pytest.mark.parametrize("name", SECTIONS)
def test_grooves_and_holes_have_their_area(name: str, mesh: tuple[int, int]) -> None:
    section = SECTIONS[name]
    made = quadratic_mesh(section, *mesh)
    openings = sum(hole_area(section, hole) for hole in section.holes) / (RADIUS * section.width)
    openings += sum(groove.opening for groove in section.grooves)
    assert made.area.sum() == pytest.approx(2 * math.pi, rel=1e-12)
    assert made.area.min() > 0.0
    assert made.area[made.covered].sum() == pytest.approx(openings, rel=1e-12, abs=1e-14)


def test_crowded_bores_do_not_fold_elements() -> None:
    """A bore beside the faces of three others, which leave it slivers; areas would add up to more than the turn."""
    holes = (
        Hole(-3.478, 6.32e-3, 0.111, 2.42e-3, 1e5, True),
        Hole(-2.962, 10e-3, 0.0685, 4.91e-4, 1e5, False),
        Hole(-1.398, 10e-3, 0.0852, 6.16e-4, 1e5, True),
        Hole(-1.998, 8.67e-3, 0.371, 2.91e-3, 1e5, True),
    )
    section = replace(SECTIONS["half of six bores"], holes=holes)
    mesh = quadratic_mesh(section, 15, 10)
    openings = sum(hole_area(section, hole) for hole in holes) / (RADIUS * section.width)
    assert mesh.area.sum() == pytest.approx(2 * math.pi, rel=1e-12)
    assert mesh.area[mesh.covered].sum() == pytest.approx(openings, rel=1e-12)


def test_round_holes_are_round() -> None:
    """The nodes on the edge of a bore lie on a circle, to the 3 % by which four parabolas miss it."""
    section = replace(PLAIN, holes=(bore(1.0),))
    mesh = quadratic_mesh(section, 20, 10)
    inside = np.zeros(mesh.phi.size, dtype=bool)
    inside[mesh.nodes[mesh.covered]] = True
    radius = np.hypot((mesh.phi - 1.0) * RADIUS, (mesh.z - 0.5) * WIDTH).ravel()[inside]
    assert len(radius) == 9
    assert np.sort(radius)[1:] == pytest.approx(1.25e-3, rel=0.03)


def test_the_number_of_elements_is_what_is_asked_for_unless_holes_need_more() -> None:
    few = quadratic_mesh(SECTIONS["six bores"], 20, 10)
    many = quadratic_mesh(SECTIONS["six bores"], 5, 2)
    assert (few.around, few.along) == (20, 10)
    assert (many.around, many.along) == (12, 3)


def test_shape_functions_differentiate_a_field() -> None:
    """On straight elements quadratic functions are exact; on those that a bore bends, linear ones."""
    for section, degree in ((PLAIN, 2), (SECTIONS["six bores"], 1)):
        mesh = quadratic_mesh(section, 20, 10)
        slopes = np.einsum("egnd,en->egd", mesh.slopes, (mesh.z.ravel() ** degree)[mesh.nodes])
        assert slopes[..., 1] == pytest.approx(degree * mesh.height ** (degree - 1), abs=1e-11)
        assert slopes[..., 0] == pytest.approx(0.0, abs=1e-11)


def test_too_coarse_a_mesh_is_refused() -> None:
    with pytest.raises(InputError, match="at least 3"):
        quadratic_film(PLAIN, "half-sommerfeld", 2, 10)


# --- the solver


@pytest.mark.parametrize(("around", "along", "free_end"), [(2, 2, False), (7, 3, True), (5, 4, False), (6, 5, True)])
def test_the_ring_is_solved_as_a_dense_matrix_is(around: int, along: int, free_end: bool) -> None:
    mesh = quadratic_mesh(PLAIN, around, along)
    random = np.random.default_rng(1)
    parts = random.random((around * along, 9, 9))
    elements = parts @ parts.transpose(0, 2, 1) + np.eye(9)
    size = mesh.phi.size
    matrix = np.zeros((size, size))
    for nodes, element in zip(mesh.nodes, elements, strict=True):
        matrix[np.ix_(nodes, nodes)] += element
    free = np.ones(mesh.phi.shape, dtype=bool)
    free[:, 0] = False
    free[:, -1] = free_end
    inner = np.flatnonzero(free)
    right = random.random((2, size))
    known = np.zeros((2, size))
    known[:, inner] = np.linalg.solve(matrix[np.ix_(inner, inner)], right[:, inner].T).T
    ring = make_ring(around, along, free_end)
    factorise(ring, np.ascontiguousarray(elements[:, ROW, COLUMN]))
    found = right.reshape(2, *mesh.phi.shape).copy()
    solve(ring, found)
    assert found.reshape(2, size) == pytest.approx(known, rel=1e-10, abs=1e-12)


# --- forces


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", SECTIONS)
def test_compiled_and_plain_films_agree(name: str, law: str) -> None:
    section = SECTIONS[name]
    plain = PlainQuadraticFilm(section, LAWS[law][0], 12, 4, LAWS[law][1]).force(D, V, OMEGA)
    found = evaluate(film_of(section, law, 12, 4), D, V, OMEGA)[:2]
    assert deviation(found, plain) < 1e-9


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", SECTIONS)
def test_derivatives_are_those_of_the_force(name: str, law: str) -> None:
    """By central differences of the compiled force."""
    film = film_of(SECTIONS[name], law, 12, 4)
    found = evaluate(film, D, V, OMEGA)
    motion = np.array([*D, *V])
    numeric = np.empty((4, 2))
    for n, step in enumerate((1e-6, 1e-6, 1e-2, 1e-2)):
        low, high = motion.copy(), motion.copy()
        low[n] -= step
        high[n] += step
        difference = evaluate(film, high[:2], high[2:], OMEGA) - evaluate(film, low[:2], low[2:], OMEGA)
        numeric[n] = difference[:2] / (2 * step)
    by_d, by_v = found[2:6].reshape(2, 2), found[6:].reshape(2, 2)
    assert by_d == pytest.approx(numeric[:2].T, abs=1e-5 * np.abs(by_d).max())
    assert by_v == pytest.approx(numeric[2:].T, abs=1e-5 * np.abs(by_v).max())


REFERENCE = [row for row in reference_rows() if row["cavitation"] in ("half-sommerfeld", "penalty")]


@pytest.mark.parametrize(("around", "along", "bound", "near_contact"), [(20, 10, 1e-2, 3e-2), (64, 16, 2e-3, 2e-3)])
def test_forces_of_the_independent_program(around: int, along: int, bound: float, near_contact: float) -> None:
    """All of its half-Sommerfeld and penalty films; along: elements over the whole width or a section with a groove."""
    worst = {bound: 0.0, near_contact: 0.0}
    for row in REFERENCE:
        section = section_of(row["supply"], 1e5 * float(row["supply_pressure_bar"]), row["ends"])
        motion = motion_of(row)
        law = row["cavitation"] + (", dimensionless" if row["parameter"].startswith("pressure=Pi") else "")
        found = forces(section, law, motion, around, along if section.far == "groove" else along // 2)
        limit = near_contact if float(row["eccentricity"]) >= 0.9 else bound
        worst[limit] = max(worst[limit], deviation(found, np.array([float(row["Fx_N"]), float(row["Fy_N"])])))
    assert len(REFERENCE) > 100
    assert all(error < limit for limit, error in worst.items())


VOLUMES = {  # section, displacement
    "six bores": (SECTIONS["six bores"], (0.3, -0.5)),
    "one at the pressure peak": (replace(PLAIN, holes=(bore(2.6),)), (0.0, -0.6)),
    "large, off the middle": (replace(PLAIN, holes=(bore(-0.4, 6e-3, 3e-3, 2e5),)), (0.2, -0.4)),
    "pocket": (SECTIONS["pocket"], (0.2, -0.4)),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_holes_as_on_finite_volumes(name: str) -> None:
    """Bores from the size of an element on, with 1 and 2 bar over the ambient pressure, also at its peak."""
    section, d = VOLUMES[name]
    motion = Motion(d, (0.0, 0.0), OMEGA)
    grid = fitted_grid(section, d, 192, 64)
    volumes = VolumeFilm(section, grid, Sommerfeld(True), reference_pressure(section, motion))
    known = np.array(volume_force(volumes, volumes.pressure(volumes.steady(motion).state)))
    assert deviation(forces(section, "half-sommerfeld", motion, 20, 10), known) < 2e-2
    assert deviation(forces(section, "half-sommerfeld", motion, 40, 20), known) < 4e-3


@pytest.mark.parametrize("law", LAWS)
def test_a_bore_that_shrinks_leaves_the_plain_film(law: str) -> None:
    """A drain where the pressure is high: as 1 / ln(radius), as a point in a plane fades, and at last altogether."""
    motion = Motion(D, V, OMEGA)
    plain = forces(PLAIN, law, motion, 20, 10)
    sizes = (1.25e-3, 5e-4, 2e-4, 5e-5)
    sections = [replace(PLAIN, holes=(bore(3.2, radius=size, pressure=0.0),)) for size in sizes]
    left = [deviation(forces(section, law, motion, 20, 10), plain) for section in sections]
    assert left[0] > left[1] > left[2] > left[3] == 0.0


@pytest.mark.parametrize("law", LAWS)
def test_turning_everything_turns_the_force(law: str) -> None:
    """Bores, displacement and velocity turned by 50 deg, so that other elements lie on the seam."""
    turn = math.radians(50.0)
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    turned = replace(PLAIN, holes=tuple(replace(hole, position=hole.position + turn) for hole in SIX))
    first = evaluate(film_of(SECTIONS["six bores"], law, 20, 6), D, V, OMEGA)
    second = evaluate(film_of(turned, law, 20, 6), rotation @ D, rotation @ V, OMEGA)
    assert second[:2] == pytest.approx(rotation @ first[:2], rel=1e-9)
    for part in (slice(2, 6), slice(6, 10)):
        expected = rotation @ first[part].reshape(2, 2) @ rotation.T
        assert second[part].reshape(2, 2) == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("law", LAWS)
def test_half_of_a_symmetric_film_is_enough(law: str) -> None:
    motion = Motion(D, V, OMEGA)
    whole = forces(SECTIONS["plain"], law, motion, 20, 8)
    half = forces(replace(PLAIN, width=WIDTH / 2, copies=2, far="symmetry"), law, motion, 20, 4)
    assert half == pytest.approx(whole, rel=1e-9)


def test_a_journal_at_rest_feels_only_the_supply() -> None:
    """One pressurised bore at the top pushes down; six alike in the middle of a centred film push nowhere."""
    still = Motion((0.0, 0.0), (0.0, 0.0), 0.0)
    one = forces(replace(PLAIN, holes=(bore(0.0),)), "half-sommerfeld", still, 20, 10)
    assert abs(one[0]) < 1e-9 * abs(one[1])
    assert one[1] < -1e5 * math.pi * 1.25e-3**2
    # The bores lie evenly to the elements: their mesh is as symmetric as they are.
    six = forces(SECTIONS["six bores"], "half-sommerfeld", still, 24, 10)
    assert np.abs(six).max() < 1e-9 * abs(one[1])


# --- the penalty's iteration


@pytest.mark.parametrize("law", ["penalty", "penalty, dimensionless"])
@pytest.mark.parametrize("eccentricity", [0.01, 0.3, 0.8, 0.95])
def test_newton_converges_from_a_full_film_and_at_once_from_its_end(law: str, eccentricity: float) -> None:
    film, motion = film_of(SECTIONS["six bores"], law, 20, 6), polar_motion(eccentricity, 0.7, 0.0, 0.0, OMEGA)
    unknown, slope = np.zeros(film.fixed.shape), np.zeros(film.fixed.shape)
    element_matrices(film, *motion.d)
    a, b = penalty_scales(film, eccentricity, OMEGA)
    half = 0.5 * OMEGA
    load = (half * motion.d[1], -half * motion.d[0], OMEGA, a, b)
    steps = [solve_penalty(film, unknown, np.zeros((1, *slope.shape)), slope, *load) for _ in range(2)]
    assert 1 < steps[0] <= 20
    assert steps[1] == 1


def test_a_penalty_that_has_no_solution_is_not_a_number() -> None:
    film = film_of(PLAIN, "penalty", 12, 4)
    assert np.isnan(evaluate(film, (math.nan, 0.0), V, OMEGA)).all()
