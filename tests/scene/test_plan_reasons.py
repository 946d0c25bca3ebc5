"""The reasons of a plan say what is so: what is set is said to be set, and what is not is not."""

from __future__ import annotations

import pytest

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.scene.planning.film_choice import Decision
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import expected_error, make_plan

OWN = 'cavitation = "half-sommerfeld"'


def decided(name: str, *settings: str) -> dict[str, Decision]:
    return {decision.choice: decision for decision in make_plan(load_case(name, settings)).decisions}


def test_a_cavitation_model_that_no_line_sets_is_the_default() -> None:
    text = load_case("jeffcott").source_text
    assert OWN in text
    for source, said in ((text, "set in the case; "), (text.replace(OWN, ""), "the default; ")):
        (decision,) = (one for one in make_plan(load_case_text(source)).decisions if one.choice == "cavitation")
        assert decision.reason.startswith(said)


def test_each_film_says_whether_its_model_is_set() -> None:
    text = load_case("floating-ring").source_text
    case = load_case_text(text, ["bearing.inner.cavitation=reynolds", "film.cavitation=penalty"])
    told = [one.reason for one in make_plan(case).decisions if one.choice == "cavitation"]
    assert all(reason.startswith("set in the case; ") for reason in told)
    assert len(told) == 2


def test_a_law_says_what_it_makes_of_the_oil() -> None:
    assert "mass-conserving" in decided("jeffcott", "film.cavitation=elrod")["cavitation"].reason
    assert "does not cavitate" in decided("jeffcott", "film.cavitation=sommerfeld")["cavitation"].reason
    assert "not conserved" in decided("jeffcott", "film.cavitation=reynolds")["cavitation"].reason


def test_a_mesh_below_the_fewest_cells_is_not_said_to_be_set() -> None:
    film = decided("jeffcott-two-phase", "accuracy.mesh=[2, 8]")["film"]
    assert film.value == "12 x 3 cells"
    assert "[2, 8] is set in the case, fewer than a film needs" in film.reason
    assert "; set in the case; " in decided("jeffcott-two-phase", "accuracy.mesh=[4, 24]")["film"].reason
    bearing = kinematic_plan(load_case("bearing", ["accuracy.mesh=[2, 8]"]))
    (cells,) = (one for one in bearing.decisions if one.choice == "cells")
    assert (cells.value, "fewer than a film needs" in cells.reason) == ("12 x 3", True)


def test_a_tolerance_of_a_budget_is_not_said_to_be_of_the_target() -> None:
    found = decided("floating-ring", "accuracy.target=1e-3", "accuracy.budget=1 s")
    assert "the target that the budget pays for" in found["tolerance"].reason
    assert "of the target" in decided("floating-ring", "accuracy.target=1e-2")["tolerance"].reason


def test_a_mesh_of_the_case_is_not_said_to_be_of_the_budget() -> None:
    settings = ("accuracy.mesh=[4, 24]", "accuracy.budget=1 h")
    assert decided("jeffcott-two-phase", *settings)["target"].reason.endswith("; set in the case")


@pytest.mark.parametrize("law", ["elrod", "two-phase", "reynolds"])
def test_no_error_of_forces_is_expected_of_cells(law: str) -> None:
    """What is known of cells is the error of the eccentricities; that of nearly vanishing forces is 1e-2 to 1."""
    assert expected_error(make_plan(load_case("jeffcott", [f"film.cavitation={law}"]))).film_force is None
