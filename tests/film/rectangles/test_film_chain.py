"""Films between axial grooves and their modes: against the plain solve, a library of finite elements, the independent
program, and what symmetry says."""

import math

import numpy as np
import pytest
from differences import differences
from films import rectangular
from paths import rows_of
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine, asm
from volume_films import motion_of

from frbcli.film.gap import AxialGroove, Section
from frbcli.film.grid import Mesh, axial_modes, axial_vertices
from frbcli.film.rectangles.chain import chain_grid, element_matrices, mode_fields
from frbcli.film.rectangles.film import FilmForce, evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData

CLEARANCE = 40e-6
MESH = Mesh(6, 48)


def grooved(pressure: float, count: int = 1, position: float = 0.0) -> Section:
    """The bearing of table 4.1 with grooves of 15 degrees; pressure in the grooves, absolute."""
    turn = 2 * math.pi / count
    grooves = tuple(AxialGroove(position + turn * i, math.radians(15), pressure - 1e5) for i in range(count))
    return rectangular(0.02, 0.025, CLEARANCE, 0.01, 1e5, 1e5, grooves=grooves)


FILMS = {pressure: make_film(grooved(pressure), "finite", "half-sommerfeld", MESH) for pressure in (1e5, 2e5)}


ROWS = [
    row
    for row in rows_of("film-forces-all.csv")
    if row["supply"] == "axial-groove" and row["cavitation"] == "half-sommerfeld"
]


def at(film: FilmData, row: dict[str, str], turned: float = 0.0) -> FilmForce:
    """The film's force at the position and motion of a row, all turned by an angle."""
    motion = motion_of(row | {"attitude_deg": str(float(row["attitude_deg"]) + math.degrees(turned))})
    return evaluate(film, CLEARANCE, CLEARANCE * np.array(motion.d), CLEARANCE * np.array(motion.v), motion.omega)


def row_id(row: dict[str, str]) -> str:
    names = ("supply_pressure_bar", "speed_Hz", "eccentricity_rate_1_s", "whirl_speed_rad_s", "eccentricity")
    return "-".join(row[name] for name in names)


@pytest.mark.parametrize("row", ROWS, ids=row_id)
def test_force_of_the_independent_program(row: dict[str, str]) -> None:
    expected = np.array([float(row["Fx_N"]), float(row["Fy_N"])])
    force = at(FILMS[1e5 * float(row["supply_pressure_bar"])], row).force
    assert np.hypot(*(force - expected)) < 1e-3 * np.hypot(*expected) + float(row["force_error_N"])


def test_fast_and_plain_solve_of_the_same_elements_agree() -> None:
    """Two pieces between two grooves under pressure, against scikit-fem's assembly and a sparse solve of each."""
    from scipy.sparse.linalg import spsolve
    from skfem import Basis, BilinearForm, ElementQuad2, LinearForm, MeshQuad, asm

    d, w, aspect = (0.5, -0.4), (0.7, -0.3), 1.3
    modes = axial_modes(axial_vertices(4))
    edges = np.array([[0.2, 3.0], [3.3, 6.2]])
    grid = chain_grid(edges, 14)
    profile = np.sin(math.pi * modes.nodes)
    along, across = np.empty((grid.shape[1], 3, 6)), np.empty((grid.shape[1], 3, 6))
    element_matrices(grid, *d, along, across)
    scratch = (np.empty((grid.shape[1], 6)), np.empty(grid.shape[1] + 1), np.empty(grid.shape[1] + 1))
    total = np.zeros((2 * grid.shape[1] + 1, len(modes.nodes)))
    for k, (value, load, groove) in enumerate(
        zip(modes.eigenvalues, modes.loads, modes.project(profile), strict=True)
    ):
        fields = np.empty((5, 2 * grid.shape[1] + 1))
        mode_fields(grid, along, across, *w, aspect * value, load, groove, scratch, fields)
        total += fields[0][:, None] * modes.shapes[k]

    @BilinearForm
    def diffusion(p, q, s):  # type: ignore[no-untyped-def]
        gap = 1 + d[0] * np.sin(s.x[0]) - d[1] * np.cos(s.x[0])
        return gap**3 * (p.grad[0] * q.grad[0] + aspect * p.grad[1] * q.grad[1])

    @LinearForm
    def motion(q, s):  # type: ignore[no-untyped-def]
        return -(w[0] * np.sin(s.x[0]) - w[1] * np.cos(s.x[0])) * q

    first = 0
    for start, end in edges:
        inside = (grid[0] >= start - 1e-9) & (grid[0] < end - 1e-9)
        ring = np.append(grid[0][inside], end)
        basis = Basis(MeshQuad.init_tensor(ring, axial_vertices(4)), ElementQuad2(), intorder=5)
        matrix, load = asm(diffusion, basis).tocsr(), asm(motion, basis)
        phi, z = basis.doflocs
        pressure = np.where((np.abs(phi - start) < 1e-9) | (np.abs(phi - end) < 1e-9), np.sin(math.pi * z), 0.0)
        free = (phi > start + 1e-9) & (phi < end - 1e-9) & (z > 1e-9) & (z < 1 - 1e-9)
        pressure[free] = spsolve(matrix[free][:, free].tocsc(), (load - matrix @ (pressure * ~free))[free])
        count = int(inside.sum())
        angles = np.interp(np.arange(2 * count + 1) / 2, np.arange(count + 1), ring)
        for angle, height, value in zip(phi, z, pressure, strict=True):
            i = 2 * first + int(np.argmin(np.abs(angles - angle)))
            j = int(np.argmin(np.abs(modes.nodes - height)))
            assert total[i, j] == pytest.approx(value, abs=1e-12 * np.abs(pressure).max())
        first += count


@pytest.mark.parametrize("cavitation", ["sommerfeld", "half-sommerfeld"])
@pytest.mark.parametrize("pressure", [1e5, 3e5])
def test_derivatives_are_those_of_the_force(cavitation: str, pressure: float) -> None:
    film = make_film(grooved(pressure, count=2, position=0.4), "finite", cavitation, MESH)
    place, velocity, omega = CLEARANCE * np.array([0.4, -0.5]), CLEARANCE * np.array([30.0, -80.0]), 400.0
    exact = evaluate(film, CLEARANCE, place, velocity, omega)
    step = 1e-5 * CLEARANCE
    by_place = differences(lambda d: evaluate(film, CLEARANCE, d, velocity, omega).force, place, step)
    by_rate = differences(lambda v: evaluate(film, CLEARANCE, place, v, omega).force, velocity, 400 * step)
    for measured, stated in ((by_place, exact.by_displacement), (by_rate, exact.by_velocity)):
        assert measured == pytest.approx(stated, abs=1e-6 * float(np.abs(stated).max()))


def test_turning_bearing_and_motion_turns_the_force() -> None:
    turn = 1.1
    row = ROWS[10]
    here = at(FILMS[1e5 * float(row["supply_pressure_bar"])], row).force
    pressure = 1e5 * float(row["supply_pressure_bar"])
    turned = make_film(grooved(pressure, position=turn), "finite", "half-sommerfeld", MESH)
    there = at(turned, row, turn).force
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    assert there == pytest.approx(rotation @ here, rel=1e-10)


@BilinearForm
def slopes(u, v, _):  # type: ignore[no-untyped-def]
    return u.grad[0] * v.grad[0]


@BilinearForm
def values(u, v, _):  # type: ignore[no-untyped-def]
    return u * v


@pytest.mark.parametrize("elements", [1, 4, 9])
def test_modes_are_those_of_the_forms_that_a_library_assembles(elements: int) -> None:
    vertices = axial_vertices(elements)
    modes = axial_modes(vertices)
    basis = Basis(MeshLine(vertices), ElementLineP2(), intorder=4)
    order = np.argsort(basis.doflocs[0])
    stiffness, mass = (asm(form, basis).toarray()[np.ix_(order, order)] for form in (slopes, values))
    np.testing.assert_allclose(modes.nodes, basis.doflocs[0][order], rtol=0, atol=1e-15)
    np.testing.assert_allclose(modes.mass, mass, rtol=0, atol=1e-15)
    np.testing.assert_allclose(modes.shapes @ mass @ modes.shapes.T, np.eye(len(modes.shapes)), rtol=0, atol=1e-12)
    by_form = modes.shapes @ stiffness @ modes.shapes.T
    np.testing.assert_allclose(by_form, np.diag(modes.eigenvalues), rtol=0, atol=1e-9 * modes.eigenvalues.max())
