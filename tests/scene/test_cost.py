"""The plan knows its cost, and chooses the cheapest film that holds the target."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.film.grid import Mesh
from frbcli.runs.header import header
from frbcli.runs.run import runup
from frbcli.scene.cost import expected_cost, signal_count
from frbcli.scene.course import STAGES, whirl_speed
from frbcli.scene.forms import CHAINS, CLOSED_FORM, FIELDS, TABLE
from frbcli.scene.machine.system import make_segments
from frbcli.scene.planning.cell_choice import (
    ALONG,
    AROUND,
    GROOVE,
    WorstFilm,
    cells_time,
    expected_eccentricity,
    fewest_cells,
    run_down_profile,
    run_up_profile,
    short_error,
    worst_film,
)
from frbcli.scene.planning.film_choice import Plan, choose_films
from frbcli.scene.planning.plan import CELL_SHARE, TIGHT_SHARE, expected_error, make_plan
from frbcli.scene.tilted import CELLS, TiltedForm
from frbcli.solve.state import METHODS

WITHIN = 2.0  # of the real cost
LATE, SPAN_s = 0.7, 0.25  # where a part of a run-up begins, over its speeds, and the CPU time that it is to take
DRYING_s = 1.0  # the same where films that are full at first run dry
RUNS = (
    "axial-groove", "axial-groove-two-phase", "cold-start", "floating-ring", "floating-ring-heat",
    "floating-ring-table-7-1", "jeffcott", "jeffcott-supply-2bar", "jeffcott-table-4-1", "jeffcott-two-phase",
    "rigid", "rigid-axial-groove", "rigid-two-phase", "run-down", "soft-shaft", "squeeze-film-damper",
    "turbocharger-car", "turbocharger-car-cartridge", "turbocharger-car-heat", "turbocharger-car-thrust",
    "turbocharger-engine", "turbocharger-heavy", "turbocharger-heavy-heat", "turbocharger-low-supply",
)  # fmt: skip
NARROW = ("bearing.width=1 mm", "accuracy.target=1e-2")


def test_stages_are_those_of_the_methods() -> None:
    """The table of stages is kept beside the costs: scene does not import solve."""
    assert {name: len(method.tableau.times) - 1 for name, method in METHODS.items()} == STAGES


@pytest.mark.parametrize(
    ("name", "settings", "form"),
    [
        ("jeffcott", (), TABLE),
        ("jeffcott", ("film.theory=short",), CLOSED_FORM),
        ("jeffcott-supply-2bar", (), FIELDS),
        ("soft-shaft", (), CHAINS),
        ("jeffcott-two-phase", (), CELLS),
        ("floating-ring", (), CELLS),
    ],
)
def test_form_of_the_films(name: str, settings: tuple[str, ...], form: str) -> None:
    assert make_plan(load_case(name, settings)).form == form


def test_steps_are_those_of_the_revolutions() -> None:
    """Half of 10 s x 300 Hz revolutions, 40 steps each at least."""
    case = load_case("jeffcott")
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    assert cost.steps == pytest.approx(1500 * 40, rel=0.1)
    both = load_case("run-down")
    down = expected_cost(both, make_plan(both), run_down_profile(both))
    assert down.steps == pytest.approx((2 * 1500 + 150) * 40, rel=0.1)


def test_finer_films_cost_more() -> None:
    def us(name: str, *settings: str) -> float:
        case = load_case(name, settings)
        plan = make_plan(case)
        return plan.form.solve_us(case, plan)

    assert us("soft-shaft", "accuracy.mesh=[6, 96]") > 1.5 * us("soft-shaft")
    assert us("jeffcott-two-phase", "accuracy.mesh=[12, 96]") > 4.0 * us("jeffcott-two-phase")
    assert us("jeffcott", "accuracy.mesh=[12, 192]") == us("jeffcott")  # tabulated before the run


@pytest.mark.parametrize("name", ["jeffcott", "soft-shaft"])
def test_predicted_is_near_real_cost(name: str, tmp_path: Path) -> None:
    """Film solves, which do not depend on the machine, for a whole second in the middle of the run-up."""
    settings = ("speed.from=60 Hz", "speed.to=90 Hz", "speed.duration=0.5 s", "output.step=1 ms")
    case = load_case(name, settings)
    run = runup(case, tmp_path / "run.h5")
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    assert run.cost["predicted_cpu_s"] == pytest.approx(cost.cpu_s)
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN
    assert 1 / WITHIN < run.cost["steps"] / cost.steps < WITHIN


@pytest.mark.parametrize(
    ("law", "pressure"), [("two-phase", 1), ("elrod", 2), ("reynolds", 1)]
)
def test_predicted_is_near_real_cost_of_cells(law: str, pressure: int, tmp_path: Path) -> None:
    """Without inflow films run nearly dry, their fronts cross cells, and take four to eight times as many steps as fed
    ones; 19 a revolution were expected of all."""
    settings = [f"film.cavitation={law}", f"bearing.supply.pressure={pressure} bar", "accuracy.mesh=[6, 48]"]
    settings += ["speed.from=100 Hz", "speed.to=103 Hz", "speed.duration=0.3 s", "accuracy.tolerance=1e-4"]
    case = load_case("jeffcott", settings)
    run = runup(case, tmp_path / "run.h5")
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN
    assert 1 / WITHIN < run.cost["steps"] / cost.steps < WITHIN


def late_span(case: Case, span_s: float) -> Case:
    """The case from LATE of its speeds on for a time that is expected to take span_s; all of a speed through points."""
    speed, length = case.speed, 0.02
    if speed.times:
        return case
    for _ in range(6):
        begin, end = (speed.start + share * (speed.end - speed.start) for share in (LATE, LATE + length))
        duration = length * speed.duration
        part = case.with_settings(
            f"speed.from={begin!r} Hz", f"speed.to={end!r} Hz", f"speed.duration={duration!r} s",
            f"output.step={min(case.output.step, duration / 20.0)!r} s",
        )  # fmt: skip
        length = min(length * span_s / expected_cost(part, make_plan(part), run_up_profile(part)).cpu_s, 1.0 - LATE)
    return part


@pytest.mark.nightly
@pytest.mark.parametrize("name", RUNS)
def test_announced_film_solves_of_every_shipped_case(name: str, tmp_path: Path) -> None:
    """Where whirls have begun, on the machine with all that its case has."""
    case = late_span(load_case(name), DRYING_s if name == "jeffcott-two-phase" else SPAN_s)
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    run = runup(case, tmp_path / "run.h5", uncertainty=False)
    assert run.status == "finished"
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN


@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("jeffcott", 0.1),
        pytest.param("jeffcott-supply-2bar", 0.13, marks=pytest.mark.nightly),
        pytest.param("rigid-axial-groove", 0.09, marks=pytest.mark.nightly),
        pytest.param("squeeze-film-damper", 0.1, marks=pytest.mark.nightly),
    ],
)
def test_predicted_is_near_real_cost_of_a_short_run(name: str, duration: float, tmp_path: Path) -> None:
    """A whirl takes some revolutions to grow, and more until it presses the journal into its shell: 2.9 to 5.6 times
    the film solves were announced of runs that begin above the speed from which they are expected."""
    speed = ("speed.from=282 Hz", f"speed.to={282.0 + 30.0 * duration!r} Hz", f"speed.duration={duration!r} s")
    case = load_case(name, (*speed, "output.step=1 ms"))
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    run = runup(case, tmp_path / "run.h5", uncertainty=False)
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN
    assert 1 / WITHIN < run.cost["steps"] / cost.steps < WITHIN


def test_predicted_is_near_real_cost_of_rings_whose_films_keep_oil(tmp_path: Path) -> None:
    """Fronts of the oil cross the cells that turn with it, beside rings as well: 1.5 solves of a stage were expected of
    each film, and a third to a half of what the machine took."""
    settings = ["film.cavitation=elrod", "speed.from=60 Hz", "speed.to=66 Hz", "speed.duration=0.02 s",
                "output.step=1 ms"]  # fmt: skip
    case = load_case("turbocharger-low-supply", settings)
    run = runup(case, tmp_path / "run.h5", uncertainty=False)
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN


@pytest.mark.parametrize(
    ("settings", "lands"),
    [
        ((), (1, 2, 1, 2)),  # a groove beside films without one
        (('bearing.0.inner.supply={kind="circumferential-groove", pressure="3 bar"}',
          'bearing.1.inner.supply={kind="circumferential-groove", pressure="3 bar"}'), (2, 2, 2, 2)),
    ],
)  # fmt: skip
def test_a_film_that_follows_a_tilt_costs_as_much_as_its_lands(settings: tuple[str, ...], lands: tuple[int]) -> None:
    """A run of rings in such films took 12 s where 4.5 s were announced: for half of the cells, and one land a film."""
    case = load_case("turbocharger-car", ("film.tilt=follows", "accuracy.mesh=[4, 24]", *settings))
    plan = make_plan(case)
    films = make_segments(case, plan)[0].system.films.loop
    assert tuple(np.diff(films.first)) == lands
    _, _, around, along = films.cells.shape
    solved = len(films.cells) / len(lands) * cells_time(around, along)
    assert isinstance(plan.form, TiltedForm)
    assert plan.form.cells_solved(case, plan) == pytest.approx(solved)


def test_solve_time_is_that_of_the_laws_of_the_films() -> None:
    """Films with laws of their own: the mean of what each costs."""

    def us(*settings: str) -> float:
        case = load_case("floating-ring", ("accuracy.mesh=[6, 48]", *settings))
        plan = make_plan(case)
        return plan.form.solve_us(case, plan)

    both = [us(f"film.cavitation={law}") for law in ("bubbly", "elrod")]
    assert us("film.cavitation=elrod", "bearing.inner.cavitation=bubbly") == pytest.approx(sum(both) / 2.0)


def test_a_whirl_is_expected_where_nothing_keeps_the_journal_from_it() -> None:
    """A whirl of the jeffcott begins at 204 Hz in a run, of the rigid rotor at 260 Hz, on the soft shaft at 150 Hz."""
    found = {name: whirl_speed(load_case(name)) / (2.0 * np.pi) for name in ("jeffcott", "rigid", "soft-shaft")}
    assert found == pytest.approx({"jeffcott": 204.0, "rigid": 260.0, "soft-shaft": 150.0}, rel=0.2)
    assert whirl_speed(load_case("jeffcott", ["rotor.gravity=0 m/s^2"])) == 0.0
    assert whirl_speed(load_case("jeffcott", ["film.cavitation=sommerfeld"])) == 0.0
    assert whirl_speed(load_case("jeffcott-two-phase")) == 0.0
    assert whirl_speed(load_case("floating-ring")) == 0.0


def test_steps_are_as_exact_as_the_cells_deserve() -> None:
    """The local error is a share of the target, or of the error of the cells where that is larger."""

    def plan(name: str, *settings: str) -> Plan:
        return make_plan(load_case(name, settings))

    for name in ("jeffcott-two-phase", "axial-groove-two-phase", "turbocharger-car"):
        assert plan(name, "accuracy.target=3e-3").tolerance == pytest.approx(CELL_SHARE * 3e-3)
        few = plan(name, "accuracy.target=3e-3", "accuracy.mesh=[4, 24]")
        assert few.tolerance == pytest.approx(CELL_SHARE * few.film_error)
        assert few.tolerance > CELL_SHARE * 3e-3
    assert plan("jeffcott-two-phase", "accuracy.tolerance=3e-7").tolerance == 3e-7
    assert plan("jeffcott").tolerance == pytest.approx(TIGHT_SHARE * 1e-3)  # no cells
    few, many = (
        plan("jeffcott-two-phase", "accuracy.target=1e-3", f"accuracy.mesh={mesh}") for mesh in ("[6, 48]", "[12, 96]")
    )
    coarse, fine = few.tolerance, many.tolerance
    assert coarse == pytest.approx(CELL_SHARE * few.film_error)
    assert coarse > fine == pytest.approx(CELL_SHARE * 1e-3)


def test_the_short_bearing_is_taken_where_it_holds_the_target() -> None:
    assert make_plan(load_case("jeffcott")).theory == "finite"
    assert make_plan(load_case("jeffcott", NARROW)).theory == "short"
    assert make_plan(load_case("jeffcott", (*NARROW, "film.theory=finite"))).theory == "finite"
    assert make_plan(load_case("soft-shaft", NARROW)).theory == "finite"  # grooves along the axis


def test_short_error_is_that_of_a_long_known_series() -> None:
    """For narrow bearings the finite one deviates by a multiple of (b/D)^2; here against films solved at 0.5."""
    assert short_error(0.1, 0.5) == pytest.approx(1.4e-2, rel=0.25)
    assert short_error(0.2, 0.5) == pytest.approx(5.6e-2, rel=0.25)
    assert short_error(0.2, 0.9) == pytest.approx(0.38, rel=0.25)


def test_mesh_follows_the_target() -> None:
    meshes = [choose_films(load_case("jeffcott"), target) for target in (1e-2, 1e-3, 1e-4)]
    elements = [choice.mesh.axial * choice.mesh.circumferential for choice in meshes]
    assert elements == sorted(set(elements))
    assert meshes[0].mesh == Mesh(3, 48)
    assert [choice.error for choice in meshes] == sorted((choice.error for choice in meshes), reverse=True)


# --- memory ---


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("jeffcott", ()),
        ("jeffcott", ('output.signals=["force", "power"]', "film.cavitation=elrod")),
        ("rigid", ()),
        ("floating-ring", ()),
        ("turbocharger-car", ()),
        ("floating-ring-heat", ()),
    ],
)
def test_the_signals_of_a_run_are_counted(name: str, settings: tuple[str, ...]) -> None:
    case = load_case(name, (*settings, "accuracy.mesh=[4, 24]"))
    recorded = len(header("runup", case, make_segments(case, make_plan(case))).units)
    assert 0 <= signal_count(case) - recorded <= (0 if case.heat is None else 2)  # of walls, at most


MEASURED = """
import sys
from pathlib import Path
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.runs.run import run_cost, runup
settings = ["film.theory=short", "speed.duration=1 s", "speed.to=60 Hz", f"output.step={sys.argv[1]}"]
case = load_case("jeffcott", settings)
uncertainty = sys.argv[3] == "both"
runup(case, sys.argv[2], uncertainty=uncertainty)
line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
print(run_cost("runup", case, uncertainty).memory_B, 1024 * int(line.split()[1]))
"""


@pytest.mark.nightly
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs the figures of Linux")
@pytest.mark.parametrize(("step", "runs"), [("1 ms", "one"), ("1e-6 s", "one"), ("1e-6 s", "both")])
def test_a_process_takes_no_more_memory_than_announced(step: str, runs: str, tmp_path: Path) -> None:
    """All samples are in memory twice: a run of a million of seven signals took 370 MB where 298 were announced."""
    runup(load_case("jeffcott", ["film.theory=short", "speed.duration=2 ms"]), tmp_path / "compiled.h5")
    command = [sys.executable, "-c", MEASURED, step, str(tmp_path / "run.h5"), runs]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    announced, taken = map(float, said.split())
    assert 0.7 * announced < taken <= announced


# --- target and budget ---


def worst_of(case: Case) -> WorstFilm:
    return worst_film(case, expected_eccentricity(case))


def about_target(name: str, *settings: str) -> tuple[Plan, str]:
    plan = make_plan(load_case(name, settings))
    return plan, next(f"{d.value}: {d.reason}" for d in plan.decisions if d.choice == "target")


def test_cells_hold_the_target_with_the_least_cost() -> None:
    """The cheapest of the cells that do: no others with as small an error are cheaper, but those that are too few for
    an error beside grooves to be known."""
    for target in (1e-2, 3e-3, 1e-3):
        case = load_case("axial-groove-two-phase", [f"accuracy.target={target!r}"])
        plan = make_plan(case)
        assert plan.cells is not None
        assert plan.film_error <= target
        assert expected_error(plan).eccentricity <= 1.2 * target
        around = [m for m in AROUND if m >= GROOVE.least]
        cheaper = [(m, k) for m in around for k in ALONG if cells_time(m, k) < 0.99 * cells_time(*plan.cells)]
        assert all(worst_of(case).of(cells) > 0.8 * target for cells in cheaper)


def test_a_target_out_of_reach_takes_the_knee() -> None:
    """Elrod's film without inflow: no cells hold 1e-3. Those with 1.5 times the least error cost half of the finest."""
    case = load_case("jeffcott", ["film.cavitation=elrod"])
    plan, told = about_target("jeffcott", "film.cavitation=elrod")
    assert "out of reach" in told
    assert "within 1.5 times the least error" in told
    assert plan.cells is not None
    worst = worst_of(case)
    errors = {(m, k): worst.of((m, k)) for m in AROUND for k in ALONG}
    assert errors[plan.cells] <= 1.5 * min(errors.values())
    assert cells_time(*plan.cells) < 0.6 * cells_time(*min(errors, key=lambda cells: errors[cells]))
    cheaper = [cells for cells in errors if cells_time(*cells) < cells_time(*plan.cells)]
    assert all(errors[cells] > 1.5 * min(errors.values()) for cells in cheaper)


def test_a_target_just_within_reach_takes_the_cells_that_reach_it() -> None:
    reached, told = about_target("jeffcott", "film.cavitation=elrod", "accuracy.target=1.7e-3")
    assert reached.cells == (192, 10)
    assert "out of reach" not in told
    coarser, told = about_target("jeffcott", "film.cavitation=elrod", "accuracy.target=1.5e-3")
    assert coarser.cells == make_plan(load_case("jeffcott", ["film.cavitation=elrod"])).cells
    assert "out of reach" in told


def test_a_budget_takes_the_most_exact_that_it_pays() -> None:
    """And says what the target would have needed."""
    free, told = about_target("floating-ring", "accuracy.target=1e-3")
    assert "needs" not in told
    case = load_case("floating-ring", ["accuracy.target=1e-3"])
    asked = expected_cost(case, free, run_up_profile(case)).total_s
    plan, told = about_target("floating-ring", "accuracy.target=1e-3", f"accuracy.budget={asked / 3.0:.3g} s")
    cost = expected_cost(case, plan, run_up_profile(case)).total_s
    assert asked / 8.0 < cost <= asked / 3.0
    assert free.cells is not None
    assert f"{free.cells[0]} x {free.cells[1]} cells" in told
    assert "budget" in told
    assert make_plan(load_case("floating-ring", ["accuracy.target=1e-3", "accuracy.budget=1 h"])).cells == free.cells


def test_what_is_out_of_reach_or_set_by_hand_is_told() -> None:
    assert "out of reach" in about_target("floating-ring", "accuracy.target=1e-5")[1]
    told = about_target("jeffcott-two-phase", "accuracy.mesh=[4, 24]")[1]
    assert "needs" in told
    assert "set in the case" in told


def test_a_film_that_empties_needs_more_cells() -> None:
    """Elrod's film in an oil bath without supply: 48 x 5 cells hold 1e-2, no cells hold 1e-3, and the plan says so."""
    case = load_case("jeffcott", ["film.cavitation=elrod", "bearing.ends=oil-bath", "bearing.supply={kind='none'}"])
    fed = load_case("jeffcott", ["film.cavitation=elrod", "bearing.supply.pressure=2 bar"])
    assert fewest_cells(worst_of(case), 0.8e-2, 0.95e-2) == (48, 5)
    assert worst_of(case).of((192, 10)) > 1e-3
    assert worst_of(fed).of((48, 5)) < 0.5 * worst_of(case).of((48, 5))


@pytest.mark.nightly
def test_the_cells_of_a_film_that_empties_hold_the_target(tmp_path: Path) -> None:
    """The same case, 30 Hz/s, until two thirds of the oil are gone: measured against 96 x 8 cells, whose own
    error is 3e-3. Those that the plan takes hold 1e-2; fewer around, which would hold
    it in a film that is fed, do not."""
    emptying = ["film.cavitation=elrod", "bearing.ends=oil-bath", "bearing.supply={kind='none'}"]
    emptying += ["speed.to=57 Hz", "speed.duration=1.9 s", "accuracy.target=1e-2"]

    def eccentricity(name: str, *settings: str) -> np.ndarray:
        run = runup(load_case("jeffcott", [*emptying, *settings]), tmp_path / name)
        assert run.status == "finished"
        return np.asarray(run.signals["eccentricity"])

    fine = eccentricity("fine.h5", "accuracy.mesh=[8,96]")
    assert np.abs(eccentricity("planned.h5") - fine).max() < 1e-2
    assert np.abs(eccentricity("few.h5", "accuracy.mesh=[5,32]") - fine).max() > 2e-2
