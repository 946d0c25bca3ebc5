"""The plan knows its cost, and chooses the cheapest film that holds the target."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from frbcli.case.load import load_case
from frbcli.film.grid import Mesh
from frbcli.runs.run import runup
from frbcli.scene.cost import STAGES, expected_cost, solve_us
from frbcli.scene.expected_error import expected_error
from frbcli.scene.film_choice import CELLS, CHAINS, CLOSED_FORM, FIELDS, TABLE, choose_films, short_error
from frbcli.scene.plan import make_plan
from frbcli.scene.profiles import run_down_profile, run_up_profile
from frbcli.solve.tableau import METHODS

WITHIN = 3.0  # of the real cost, as issue 6 asks
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
    plan = make_plan(case)
    cost = expected_cost(case, plan, run_up_profile(case))
    assert cost.steps == pytest.approx(1500 * 40, rel=0.1)
    both = load_case("run-down")
    down = expected_cost(both, make_plan(both), run_down_profile(both))
    assert down.steps == pytest.approx((2 * 1500 + 150) * 40, rel=0.1)
    assert cost.cpu_s == pytest.approx(1e-6 * cost.film_solves * solve_us(plan))


def test_finer_films_cost_more() -> None:
    def us(name: str, *settings: str) -> float:
        return solve_us(make_plan(load_case(name, settings)))

    assert us("soft-shaft", "accuracy.mesh=[6, 96]") > 1.5 * us("soft-shaft")
    assert us("jeffcott-two-phase", "accuracy.mesh=[12, 96]") > 4.0 * us("jeffcott-two-phase")
    assert us("jeffcott", "accuracy.mesh=[12, 192]") == us("jeffcott")  # tabulated before the run


@pytest.mark.parametrize("name", ["jeffcott", "rigid", "soft-shaft"])
def test_predicted_is_near_real_cost(name: str, tmp_path: Path) -> None:
    """Film solves, which do not depend on the machine, for a whole second in the middle of the run-up."""
    settings = ("speed.from=60 Hz", "speed.to=90 Hz", "speed.duration=0.5 s", "output.step=1 ms")
    case = load_case(name, settings)
    run = runup(case, tmp_path / "run.h5")
    cost = expected_cost(case, make_plan(case), run_up_profile(case))
    assert run.cost["predicted_cpu_s"] == pytest.approx(cost.cpu_s)
    assert 1 / WITHIN < run.cost["film_solves"] / cost.film_solves < WITHIN
    assert 1 / WITHIN < run.cost["steps"] / cost.steps < WITHIN


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
    meshes = [choose_films(load_case("jeffcott", [f"accuracy.target={target}"])) for target in ("1e-2", "1e-3", "1e-4")]
    elements = [choice.mesh.axial * choice.mesh.circumferential for choice in meshes]
    assert elements == sorted(set(elements))
    assert meshes[0].mesh == Mesh(3, 48)
    assert [choice.error for choice in meshes] == sorted((choice.error for choice in meshes), reverse=True)


def test_expected_error_follows_tolerance_and_films() -> None:
    plan = make_plan(load_case("jeffcott"))
    tight = make_plan(load_case("jeffcott", ["accuracy.target=1e-4"]))
    assert expected_error(tight).eccentricity < 0.3 * expected_error(plan).eccentricity
    assert expected_error(plan).film_force == plan.film_error
    assert np.isfinite(expected_error(make_plan(load_case("floating-ring"))).eccentricity)
