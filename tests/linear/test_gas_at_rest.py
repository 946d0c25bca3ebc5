"""Machines at rest whose oil carries free gas: sheets against rotation, thresholds against Peeken's model."""

import math

import numpy as np
import pytest

import frbcli
from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.film.cells.loads import FilmLoads
from frbcli.linear.sheets.bearing import sommerfeld_chart
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.stability import stability_points
from frbcli.linear.stability_point import find_threshold

CELLS, COARSER = (48, 6), ((24, 4), (32, 4))  # of the sheets here: rotation has the first of them
ECCENTRICITY = 0.5


@pytest.fixture
def _few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(static_films, "CELLS", CELLS)
    monkeypatch.setattr(static_films, "COARSER", COARSER)


def case_of(law: str, *settings: str) -> Case:
    fed = "bearing.supply.pressure=2 bar", "motion={speed='20 Hz'}"
    return frbcli.load_case("bearing-axial-groove", [f"film.cavitation={law}", *fed, *settings])


def bubbly(release: str, absorption: str) -> Case:
    times = f"film.bubbly.release_time={release}", f"film.bubbly.absorption_time={absorption}"
    return case_of("bubbly", *times)


def sheet(case: Case) -> FilmState:
    state = sommerfeld_chart(case, [ECCENTRICITY]).points[0]
    assert not state.problem
    return state


def turning(case: Case, place: Array, velocity: tuple[float, float] = (0.0, 0.0)) -> FilmLoads:
    """The loads of rotation on the cells of the sheet. place: (2,) over the clearance; velocity: m/s."""
    x, y = velocity
    result = frbcli.rotation(
        case.with_settings(
            f"motion.eccentricity={math.hypot(*place)!r}",
            f"motion.angle={math.degrees(math.atan2(place[1], place[0]))!r} deg",
            f"motion.velocity=['{x!r} m/s', '{y!r} m/s']",
            "accuracy.mesh=[12, 48]",
        )
    ).results[0]
    assert result.loads is not None
    return result.loads


@pytest.mark.usefixtures("_few_cells")
def test_the_sheet_of_a_film_with_gas_is_its_rotation_in_the_same_place() -> None:
    """Load, pressure, torque and flow, and stiffness and damping by differences of it."""
    case = bubbly("1 ms", "1 s")
    state = sheet(case)
    found, size = turning(case, state.displacement), float(np.hypot(*state.load))
    assert np.array(found.force) == pytest.approx(-state.load, abs=5e-3 * size)
    assert found.p_max == pytest.approx(state.p_max, rel=5e-3)
    assert found.torque.journal == pytest.approx(state.torque, rel=5e-3)
    clearance, omega, step = state.clearance, 2.0 * math.pi * 20.0, 0.01
    stiffness, damping = np.empty((2, 2)), np.empty((2, 2))
    for axis, unit in enumerate(step * np.eye(2)):
        ahead, behind = (np.array(turning(case, state.displacement + side * unit).force) for side in (1.0, -1.0))
        stiffness[:, axis] = -(ahead - behind) / (2.0 * step * clearance)
        x, y = (clearance * omega * unit).tolist()
        ahead, behind = (
            np.array(turning(case, state.displacement, (side * x, side * y)).force) for side in (1.0, -1.0)
        )
        damping[:, axis] = -(ahead - behind) / (2.0 * step * clearance * omega)
    assert state.stiffness == pytest.approx(stiffness, abs=0.02 * np.abs(stiffness).max())
    assert state.damping == pytest.approx(damping, abs=0.02 * np.abs(damping).max())


@pytest.mark.usefixtures("_few_cells")
def test_at_once_it_is_the_sheet_of_peekens_model_and_bubbles_that_last_change_it() -> None:
    peeken, instant, lasting = sheet(case_of("peeken")), sheet(bubbly("0 s", "0 s")), sheet(bubbly("1 ms", "1 s"))
    for name in ("displacement", "load", "stiffness", "damping", "torque", "side_flow", "p_max"):
        expected, size = getattr(peeken, name), float(np.abs(getattr(peeken, name)).max())
        assert getattr(instant, name) == pytest.approx(expected, abs=1e-6 * size), name
    assert np.abs(lasting.stiffness - peeken.stiffness).max() > 1e-2 * np.abs(peeken.stiffness).max()
    assert lasting.error < 0.5


ROTOR = ("rotor.mass=30 kg",)  # as in docs/theory.md
PEEKEN = 161.5, 0.7  # Hz, threshold and its error


def heavy(*settings: str) -> Case:
    return frbcli.load_case("rigid-two-phase", [*ROTOR, *settings])


def with_rates(release: str, absorption: str) -> Case:
    times = f"film.bubbly.release_time={release}", f"film.bubbly.absorption_time={absorption}"
    return heavy("film.cavitation=bubbly", *times)


@pytest.mark.usefixtures("_few_cells")
def test_a_rest_that_is_sought_from_the_film_beside_it_is_the_same() -> None:
    """At 150 Hz from 155 Hz."""
    system = static_films.static_films(with_rates("1 ms", "1 s")).system
    before = resting_position(system, 2.0 * math.pi * 160.0)
    near = resting_position(system, 2.0 * math.pi * 155.0, before.displacements, neighbour=before)
    foreseen = 2.0 * near.displacements - before.displacements
    alone, beside = (resting_position(system, 2.0 * math.pi * 150.0, foreseen, neighbour=one) for one in (None, near))
    assert beside.journals == pytest.approx(alone.journals, abs=1e-9 * system.clearances[0])


@pytest.mark.nightly
def test_gas_that_is_released_fast_and_absorbed_slowly_raises_the_threshold() -> None:
    """By more than both errors; docs/theory.md has the values."""
    case = with_rates("0.1 ms", "1 s")
    _, points = stability_points(case, [130.0, 200.0])
    found, note = find_threshold(case, StaticMachines(case, memory=True), points)
    assert found is not None, note
    speed, error = PEEKEN
    assert found.speed_Hz - found.speed_uncertainty_Hz > speed + error
    assert found.speed_Hz == pytest.approx(163.05, abs=found.speed_uncertainty_Hz)
    assert found.whirl_ratio == pytest.approx(0.503, abs=2e-3)
