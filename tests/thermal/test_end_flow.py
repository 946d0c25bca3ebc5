"""The oil that leaves a film through its ends: closed forms, fine cells, what a groove feeds."""

from __future__ import annotations

import numpy as np
import pytest
from films import rectangular
from marches import planned_system

from frbcli.case.reading.load import load_case
from frbcli.film.cells.balance.side_flow import outflow
from frbcli.film.cells.film import Motion
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.film.rectangles.end_flow import TableEndFlow, end_flow, make_end_flow
from frbcli.film.rectangles.film import make_film
from frbcli.scene.planning.plan import make_plan


def rectangle(**changes: object) -> Section:
    values = {"width": 20e-3, "diameter": 25e-3, "clearance": 35e-6, "viscosity": 12e-3,
              "ambient_pressure": 1e5, "cavitation_pressure": 1e5}  # fmt: skip
    return rectangular(**(values | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize("eccentricity", [0.0, 0.5, 0.95])
@pytest.mark.parametrize("pressure", [1e5, 3e5])
def test_end_flow_is_that_of_fine_cells(eccentricity: float, pressure: float) -> None:
    """The same linear film on finite volumes, its outflow where the pressure falls towards the end."""
    cells = ["film.solution=cells", "accuracy.mesh=[40, 240]", "film.cavitation=sommerfeld", "bearing.ends=oil-bath"]
    case = load_case("jeffcott", [f"bearing.supply.pressure={pressure}", *cells])
    (film,) = planned_system(case).films.with_fields
    omega, d = 900.0, np.array([0.6, -0.8]) * eccentricity
    motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega)
    solution = FilmSolver(film).steady(motion)
    bearing = rectangle(groove=2, far_pressure=pressure - 1e5)
    flow = make_end_flow(bearing, make_film(bearing, "finite", "half-sommerfeld", make_plan(case).mesh))
    assert isinstance(flow, TableEndFlow)
    w = 0.5 * omega * np.array([d[1], -d[0]])
    found = bearing.clearance * end_flow(flow, *d, *w, 1.0)
    assert found == pytest.approx(outflow(film, motion, solution.state.pressure), rel=5e-3, abs=1e-12)


def test_end_flow_of_a_short_film_is_its_closed_form() -> None:
    """Half-Sommerfeld, without a supply: eps omega R C B, the oil that the wedge draws in."""
    bearing = rectangle()
    flow = make_end_flow(bearing, make_film(bearing, "short", "half-sommerfeld", None))  # type: ignore[arg-type]
    assert isinstance(flow, TableEndFlow)
    found = bearing.clearance * end_flow(flow, 0.4, 0.0, 0.0, -0.5 * 0.4 * 900.0, 1.0)
    assert found == pytest.approx(0.4 * 900.0 * 12.5e-3 * 35e-6 * 20e-3, rel=1e-3)


def test_end_flow_between_axial_grooves_is_that_of_fine_cells() -> None:
    settings = ["film.cavitation=sommerfeld", "bearing.ends=oil-bath", "film.solution=cells", "accuracy.mesh=[40, 240]"]
    case = load_case("axial-groove", settings)
    (film,) = planned_system(case).films.with_fields
    plain = load_case("axial-groove")
    system = planned_system(plain)
    flow = make_end_flow(system.films.sections[0], system.films.loop[0])
    d, omega = np.array([0.3, -0.4]), 900.0
    motion = Motion((0.3, -0.4), (0.0, 0.0), omega)
    w = 0.5 * omega * np.array([d[1], -d[0]])
    found = system.clearances[0] * end_flow(flow, *d, *w, 1.0)
    assert found == pytest.approx(outflow(film, motion, FilmSolver(film).steady(motion).state.pressure), rel=0.02)
