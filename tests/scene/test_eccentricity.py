"""The eccentricity that a plan expects: limits of the short bearing, and runs."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from frbcli.case.reading.load import load_case
from frbcli.runs.advice import accuracy_advice
from frbcli.runs.run import runup
from frbcli.scene.planning.cell_choice import LARGEST, PLAIN, expected_eccentricity, gap_ratio, mobility, resting_load
from frbcli.scene.planning.plan import make_plan

OIL = ("speed.to=24 Hz", "speed.duration=0.8 s", "output.step=1 ms", "accuracy.target=1e-2")


@pytest.mark.parametrize("eccentricity", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("slender", [0.2, 0.6])
def test_a_journal_stays_where_it_rests(eccentricity: float, slender: float) -> None:
    """Two theories of one film, Booker's of the moving and Ocvirk's of the resting journal: under the load that
    Ocvirk's has at an eccentricity, the mobility takes the journal against the oil as fast as the oil turns it."""
    load = resting_load(eccentricity, slender)

    def velocity(e: np.ndarray) -> np.ndarray:
        return load * mobility(e, slender) + np.array([-e[1], e[0]])

    e, _, found, _ = fsolve(velocity, 0.7 * eccentricity * np.array([1.0, -1.0]), full_output=True)
    assert found == 1
    assert np.hypot(*e) == pytest.approx(eccentricity, rel=1e-2)


def test_the_fall_is_that_of_an_integration_with_small_steps() -> None:
    """From the centre along the run-up, up to 100 times more exactly; a later rest is nearer to the centre."""
    case = load_case("rigid-two-phase", OIL)
    film = case.films[0]
    slender = film.width / film.diameter / (2 if film.supply.splits else 1)
    softness = (2.0 * film.clearance / film.diameter) ** 2 / (film.width * film.diameter * case.viscosity(film))
    load = softness * 0.5 * case.rotor.mass * case.rotor.gravity

    def velocity(time: float, e: np.ndarray) -> np.ndarray:
        turning = np.pi * 24.0 / 0.8 * time
        return load * mobility(e, slender) + turning * np.array([-e[1], e[0]])

    fall = solve_ivp(velocity, (0.0, 0.8), np.zeros(2), "LSODA", rtol=1e-6, atol=1e-6)
    assert expected_eccentricity(case) == pytest.approx(np.hypot(*fall.y).max(), abs=2e-3)


def test_what_it_follows() -> None:
    def expected(*settings: str) -> float:
        found = expected_eccentricity(load_case("rigid-two-phase", settings))
        assert found is not None
        return found

    usual = expected()
    assert 0.8 < usual < 0.9
    assert expected("rotor.mass=12 kg") > usual > expected("rotor.mass=3 kg")
    assert expected("oil.viscosity=24 mPa*s") < usual
    assert expected("rotor.unbalance=20 kg*mm") > expected("rotor.unbalance=10 kg*mm") > usual
    assert expected("rotor.mass=1000 t") == LARGEST
    assert expected("rotor.gravity=0 m/s^2", "rotor.unbalance=0 kg*m") == 0.0


def test_cases_without_it() -> None:
    """Rings, whose speeds are not known; and films without cells, whose error does not depend on it."""
    assert expected_eccentricity(load_case("floating-ring")) is None
    assert make_plan(load_case("jeffcott")).eccentricity is None


def test_a_run_reaches_it(tmp_path: Path) -> None:
    case = load_case("rigid-two-phase", OIL)
    run = runup(case, tmp_path / "run.h5")
    assert expected_eccentricity(case) == pytest.approx(run["eccentricity"].max(), abs=0.05)
    assert accuracy_advice(case, run) == ()


def test_a_closer_journal_needs_more_cells() -> None:
    """The error around grows as the smallest gap falls, but not below the eccentricities that it was measured at."""
    assert gap_ratio(0.8, 0.9) == pytest.approx(2.0)
    assert gap_ratio(0.9, 0.8) == 1.0
    assert PLAIN.at(0.925).around == pytest.approx(2.0 * PLAIN.around)
    assert PLAIN.at(0.3) == PLAIN
    settings = ("film.cavitation=reynolds", "film.solution=cells", "accuracy.target=3e-3")
    light, heavy = (make_plan(load_case("rigid", (*settings, f"rotor.mass={mass} kg"))) for mass in (6, 60))
    assert light.eccentricity is not None
    assert heavy.eccentricity is not None
    assert heavy.eccentricity > 0.95 > light.eccentricity
    assert light.cells is not None
    assert heavy.cells is not None
    assert heavy.cells[0] > light.cells[0]
    assert any(each.choice == "eccentricity" and each.value == f"{heavy.eccentricity:.2f}" for each in heavy.decisions)
