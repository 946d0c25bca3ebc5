"""Run-ups in the published two-phase form: known limits, quadratic elements, orders, and the oil that it creates."""

import math
from pathlib import Path

import numpy as np
import pytest
from marches import planned, run_up
from paths import rows_of

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.film.cells.balance.balances import CREATED
from frbcli.film.cells.data import NOW, OIL, PASSED
from frbcli.film.cells.film import Motion
from frbcli.film.cells.loads import loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.runs.march import control_of
from frbcli.runs.start import first_state
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.film_choice import Plan
from frbcli.solve.state import Control

SHORT = ["speed.from=30Hz", "speed.to=30Hz", "speed.duration=0.02s", "output.step=0.5ms", "accuracy.mesh=[6,40]"]
PUBLISHED = ["film.cavitation=two-phase", "film.two-phase.form=published"]
SOFT = "film.two-phase.steepness=0.9"
# Ambient pressure far above p_cav: the film stays full, and every form is Reynolds' equation; theta'_0 makes it denser
# by a hundredth.
FULL = [
    "oil.ambient_pressure=11bar", "oil.cavitation_pressure=1bar", "bearing.supply.pressure=11bar",
    "bearing.ends=oil-bath",
]  # fmt: skip


def case_of(*settings: str, name: str = "jeffcott") -> Case:
    return load_case(name, [*SHORT, *PUBLISHED, *settings])


def fixed_steps(case: Case, plan: Plan, steps: int) -> Control:
    """Equal steps, a number of them in the whole run."""
    return control_of(case, plan)._replace(tolerance=1e-2, longest_step=case.speed.duration / steps)


def test_a_full_film_is_that_of_the_other_forms() -> None:
    case, other = case_of(*FULL, "accuracy.mesh=[10,96]"), load_case("jeffcott", [*SHORT, *FULL])
    plan, system = planned(case)
    found, state = run_up(case, plan, system)
    linear = other.with_settings({"film.cavitation": "sommerfeld", "accuracy.mesh": None})
    expected, _ = run_up(linear, *planned(linear))
    assert np.max(np.abs(found)) > 0.5 * system.clearances[0]
    assert np.max(np.abs(found - expected)) < 5e-3 * system.clearances[0]
    assert np.all(state.wet[OIL] > 0.0)
    assert state.flows[PASSED, 0, CREATED] == 0.0


def test_order_of_the_time_steps() -> None:
    """Third order with a smooth theta(p): errors against eight times as many steps."""
    case = case_of("film.two-phase.steepness=0.5", "bearing.ends=oil-bath", "start.displacement=[0.1,-0.3]",
                   "speed.duration=0.004s", "bearing.supply.pressure=2bar", "accuracy.target=3e-3")  # fmt: skip
    plan, system = planned(case)
    ends = [run_up(case, plan, system, control=fixed_steps(case, plan, steps))[1].q for steps in (8, 16, 128)]
    errors = [float(np.max(np.abs(end - ends[-1]))) for end in ends[:2]]
    assert errors[0] < 1e-2 * system.clearances[0]
    assert math.log2(errors[0] / errors[1]) > 2.0


def test_the_oil_that_it_creates_is_told() -> None:
    """At rest the run creates oil at the rate that the film alone does."""
    case = case_of("start.position=resting", "rotor.unbalance=0 kg*m", SOFT, "speed.duration=0.02s")
    plan, system = planned(case)
    q, end = run_up(case, plan, system)
    (film,) = system.films.with_fields
    d = system.rotor.journals[0] @ q[-1] / system.clearances[0]
    motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), float(run_up_profile(case).speeds[0]))
    oil = loads(film, motion, FilmSolver(film).steady(motion)).oil
    rate = -oil.defect_relative * max(oil.in_m3_s, oil.out_m3_s)
    assert rate > 0.1 * oil.out_m3_s
    assert system.films.oil_passed(end.flows)["oil_created_m3"] == pytest.approx(rate * case.speed.duration, rel=2e-2)


def test_a_run_reports_it(tmp_path: Path) -> None:
    found = frbcli.runup(case_of("speed.duration=0.01s"), tmp_path / "run.h5")
    assert found.status == "finished"
    cost, share = found.cost, found.error["oil_balance_relative"]
    assert share is not None
    assert 0.0 < share < 1.0
    assert cost["oil_out_m3"] > 0.0
    assert "oil_created_m3" in cost


# Run-ups of 1 s on 20 x 10 quadratic elements, see the head of the file.
ELEMENTS = {row["what"]: row for row in rows_of("published-runs-on-elements.csv")}


ALIKE = ("circumferential groove, 1 bar, x_1 = 0.99", "axial groove, 2 bar, x_1 = 0.99")  # the rigid rotor; at 1 bar


@pytest.mark.nightly  # two time loops
@pytest.mark.parametrize("what", [what for what in ELEMENTS if what not in ALIKE])
def test_run_ups_are_those_of_quadratic_elements(what: str, tmp_path: Path) -> None:
    """Eccentricity after 1 s on 40 x 10 cells, whose diffusion has the same length. Beside an axial groove elements
    create oil without it, too."""
    row = ELEMENTS[what]
    given = filter(None, row["settings"].split("; "))
    case = load_case(row["case"], [*PUBLISHED, "accuracy.target=1e-2", "accuracy.mesh=[10, 40]", *given])
    slope = (case.speed.end - case.speed.start) / case.speed.duration
    case = case.with_settings({"speed.to": f"{slope} Hz", "speed.duration": "1 s"})
    found = frbcli.runup(case, tmp_path / "run.h5")
    assert found.status == "finished"
    assert found["eccentricity"][-1] == pytest.approx(float(row["eps_1s"]), rel=0.035 if "axial" in what else 0.01)


RINGED = ["film.two-phase.steepness=0.9", "accuracy.mesh=[4, 24]", "speed.from=100 Hz", "speed.to=101 Hz",
          "speed.duration=3 ms", "output.step=0.1 ms"]  # fmt: skip


@pytest.mark.nightly  # compiles two time loops of two films
def test_a_floating_ring_moves_alike_however_rotor_and_films_are_solved(tmp_path: Path) -> None:
    """Its inner film is fed by holes in the ring, whose cells turn with it."""
    case = load_case("floating-ring", [*PUBLISHED, *RINGED])
    whole = frbcli.runup(case, tmp_path / "whole.h5")
    settings = {"film.coupling": "co-simulation", "accuracy.macro_step": "2 us"}
    apart = frbcli.runup(case.with_settings(settings), tmp_path / "apart.h5")
    for name in ("eccentricity_inner", "eccentricity_outer", "ring_speed_Hz"):
        moved = np.ptp(whole[name])
        assert moved > 1e-2
        np.testing.assert_allclose(apart[name], whole[name], rtol=0.0, atol=5e-3 * moved)
    assert "oil_created_m3" in apart.cost


def test_a_wider_gap_keeps_its_oil_which_no_longer_fills_it() -> None:
    """What the film creates is not what a step of the clearance moves; and there is no pressure left."""
    case = case_of(SOFT, "start.position=resting")
    _, system = planned(case)
    _, after = planned(case.with_settings({"bearing.clearance": "36 um"}))
    state = first_state(case.start, system, run_up_profile(case))
    d = system.rotor.journals[0] @ state.q / after.films.clearances[0]
    state.flows[PASSED, 0, CREATED] = 0.1
    before = system.films.oil_passed(state.flows)["oil_created_m3"]
    force = after.films.refill(0, system.films, (float(d[0]), float(d[1])), state.wet, state.flows)
    assert force is not None
    assert np.hypot(*force) < 0.1 * 29.9  # N, the load
    assert after.films.oil_passed(state.flows)["oil_created_m3"] == pytest.approx(before, rel=1e-12)
    assert np.all(state.flows[NOW, 0, CREATED] >= 0.0)
