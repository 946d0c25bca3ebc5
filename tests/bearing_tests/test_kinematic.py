"""Kinematic tests against known physics and independent reference values (section 4.2.2)."""

import math

import numpy as np
import pytest
from paths import rows_of

from frbcli import load_case, rotation, squeeze, whirl
from frbcli.bearing_tests.history import whirl_path
from frbcli.bearing_tests.kinematic import KinematicResult
from frbcli.film.cavitation.conditions import Reynolds
from frbcli.film.cells.film import VolumeFilm, fitted_grid, reference_pressure, supplied
from frbcli.film.cells.loads import loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.grid import Mesh
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.scene.planning.kinematic_plan import kinematic_plan

SQUEEZE = rows_of("squeeze-forces.csv")
AT = "motion={eccentricity=0.6, angle='-60 deg', speed='20 Hz'}"


def test_half_sommerfeld_is_the_table_film() -> None:
    case = load_case("bearing", [AT, "bearing.supply.axial_position=0.5"])
    found = rotation(case, ["half-sommerfeld"]).results[0]
    plan = kinematic_plan(case, "half-sommerfeld")
    assert plan.rectangle is not None
    assert found.loads is not None
    film = make_film(plan.rectangle, "finite", "half-sommerfeld", Mesh(6, 96))
    place = 40e-6 * np.array(found.displacement)
    table = evaluate(film, 40e-6, place, np.zeros(2), 40.0 * math.pi).force
    assert found.loads.force == pytest.approx(table, rel=1e-3)


def test_load_finds_the_position_that_its_force_belongs_to() -> None:
    case = load_case("bearing-axial-groove", ["accuracy.mesh=[8, 48]"])
    resting = rotation(case, ["two-phase"]).results[0]
    assert resting.loads is not None
    assert resting.loads.force == pytest.approx((0.0, 29.9), abs=0.01)
    assert 0.2 < math.hypot(*resting.displacement) < 0.6


@pytest.mark.parametrize(
    "row",
    # the forces of films on cells are compared with the same rows in tests/film/cells/test_volumes_transient.py
    [pytest.param(row, marks=() if row["cavitation"] == "half-sommerfeld" else pytest.mark.nightly) for row in SQUEEZE],
    ids=lambda row: f"{row['cavitation']} {row['ends']}",
)
def test_squeeze_force_of_each_period(row: dict[str, str]) -> None:
    """Largest vertical force of each period, to 3 %; the reference is stated to 1 to 2 %."""
    model = row["cavitation"].split()[0]
    result = squeeze(load_case("squeeze", [f"bearing.ends={row['ends']}"]), [model]).results[0]
    history = result.history
    assert history is not None
    periods = history.force[:, 1].reshape(3, -1).max(axis=1)
    expected = [float(row[f"period_{number}_Fy_max_N"]) for number in (1, 2, 3)]
    assert periods == pytest.approx(expected, rel=0.03)
    # The stated error, over the largest force of all, is of the size of what is seen, of which 2 % are the reference's.
    seen = max(abs(found - told) for found, told in zip(periods, expected, strict=True)) / max(expected)
    assert 0.0 < result.force_error < 0.02
    assert seen < 3.0 * result.force_error + 0.02


@pytest.mark.parametrize("model", ["half-sommerfeld", "two-phase"])
def test_stated_error_of_a_squeeze_falls_with_the_cells(model: str) -> None:
    """And a film with half the cells is as far from a fine one as it says, within a factor of 3."""
    settings = ["motion.periods=0.25", "bearing.ends=oil-bath"]
    coarse, fine = (
        squeeze(load_case("squeeze", [*settings, f"accuracy.mesh={mesh}"]), [model]).results[0]
        for mesh in ("[8, 32]", "[16, 64]")
    )
    assert 0.0 < fine.force_error < 0.02
    assert coarse.loads is not None
    assert fine.loads is not None
    if model == "half-sommerfeld":  # its force is that of another mesh, which the cells do not change
        assert fine.force_error == pytest.approx(coarse.force_error)
        return
    assert fine.force_error < 0.8 * coarse.force_error
    ahead, behind = (math.hypot(*result.loads.force) for result in (fine, coarse) if result.loads is not None)
    assert abs(behind / ahead - 1.0) < 3.0 * coarse.force_error


def test_history_as_a_table() -> None:
    frame = squeeze(load_case("squeeze", ["motion.periods=0.25"]), ["half-sommerfeld", "elrod"]).to_pandas()
    assert set(frame["cavitation"]) == {"half-sommerfeld", "elrod"}
    assert {"time_s", "force_y_N", "gap_ratio"} <= set(frame.columns)


def test_half_sommerfeld_does_not_see_what_the_ends_are_open_to() -> None:
    """Its pressure is ambient at the ends, whatever is outside: fields and loads agree with the force."""
    settings = [AT, "accuracy.mesh=[16, 48]"]
    cases = [load_case("bearing", [*settings, f"bearing.ends={ends}"]) for ends in ("free-to-air", "oil-bath")]
    first, second = (rotation(case, ["half-sommerfeld"]).results[0] for case in cases)
    assert first.field is not None
    assert second.field is not None
    assert np.array_equal(first.field.pressure, second.field.pressure)


# --- supplies that turn with the journal, and supplies that rise ------------------------------------------------------

DURATION_s, CELLS = 5e-3, (48, 6)
OMEGA = 2.0 * math.pi * 25.0  # the journal turns by 45 deg, which are six cells
MOVED = ["bearing.ends=oil-bath", "motion.speed=25 Hz", "motion.periods=0.05", "accuracy.mesh=[6, 48]"]


def bore(on: str, position: str) -> str:
    supply = f"kind='bores', count=1, diameter='4 mm', on='{on}', position='{position}', pressure='2 bar'"
    return f"bearing.supply={{{supply}}}"


def moved(supply: str, model: str) -> KinematicResult:
    return whirl(load_case("whirl", [supply, *MOVED]), [model]).results[0]


def last_force(result: KinematicResult) -> np.ndarray:
    assert result.history is not None
    force: np.ndarray = result.history.force[-1]
    return force


def steady_force(supply: str, share: float = 1.0) -> np.ndarray:
    """(2,) of Reynolds' film at the end of the whirl, by itself: in the lab, the supply at a share of its pressure."""
    section = kinematic_plan(load_case("whirl", [supply, *MOVED]), "reynolds", "whirl").section
    motion = whirl_path(0.6, 10.0, OMEGA)(DURATION_s)
    around, along = CELLS[0], CELLS[1] // (2 if section.far == "symmetry" else 1)
    grid = fitted_grid(section, (0.0, 0.0), around, along)
    film = supplied(VolumeFilm(section, grid, Reynolds(), reference_pressure(section, motion)), share)
    return np.array(loads(film, motion, FilmSolver(film).steady(motion)).force)


def test_whirl_with_a_bore_in_the_journal_ends_as_with_one_where_it_has_come_to() -> None:
    turned = moved(bore("journal", "30 deg"), "reynolds")
    expected = steady_force(bore("shell", "75 deg"))
    size = np.linalg.norm(expected)
    assert np.linalg.norm(last_force(turned) - expected) < 5e-3 * size
    assert np.linalg.norm(steady_force(bore("shell", "30 deg")) - expected) > 0.05 * size
    assert turned.history is not None
    assert turned.history.gap_ratio == pytest.approx(1.0 + turned.history.displacement[:, 1])  # both of the lab
    assert turned.history.displacement[-1] == pytest.approx(whirl_path(0.6, 10.0, OMEGA)(DURATION_s).d)
    assert {"frame"} <= {decision.choice for decision in turned.plan.decisions}


def test_bore_in_a_journal_that_does_not_turn_is_one_in_the_shell() -> None:
    settings = ["motion.speed=0 Hz"]
    results = [
        whirl(load_case("whirl", [bore(on, "30 deg"), *MOVED, *settings]), ["elrod"]).results[0]
        for on in ("journal", "shell")
    ]
    assert np.array_equal(last_force(results[0]), last_force(results[1]))


def groove(ramp: str) -> str:
    return f"bearing.supply={{kind='circumferential-groove', axial_position=1, pressure='3 bar', ramp='{ramp}'}}"


def test_force_follows_the_supply_that_rises() -> None:
    """(4.11) with t_1 the whole time: 1 - 1/e of the gauge pressure at its end."""
    risen = last_force(moved(groove("5 ms"), "reynolds"))
    assert risen == pytest.approx(steady_force(groove("0 s"), -math.expm1(-1.0)), rel=1e-6)
    assert np.linalg.norm(risen - steady_force(groove("0 s"))) > 0.02 * np.linalg.norm(risen)
