"""The reasons of a plan say what is so: what is set is said to be set, and what is not is not."""

import tomllib
from typing import Any

import pytest
from paths import DATA

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.report.sketch import rotor_sketch
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import expected_error, make_plan

OWN = 'cavitation = "half-sommerfeld"'
PLANS = tomllib.loads((DATA / "plans.toml").read_text(encoding="utf-8"))["plan"]


@pytest.mark.parametrize("row", PLANS, ids=lambda row: " ".join([row["case"], *row.get("settings", ())])[:90])
def test_a_plan_says_what_is_modelled_and_why(row: dict[str, Any]) -> None:
    """And the case has a text that gives it again, and a drawing."""
    case = load_case(row["case"], row.get("settings", ()))
    decisions = make_plan(case).decisions
    for choice, value, reason in row["lines"]:
        told = [(one.value, one.reason) for one in decisions if one.choice == choice]
        assert any(value in str(said) and reason in why for said, why in told), (choice, told)
    assert not {one.choice for one in decisions} & set(row.get("without", ()))
    assert load_case_text(case.source_text, name=case.name) == case
    assert "nan" not in rotor_sketch(case)[0]


def test_a_cavitation_model_that_no_line_sets_is_the_default() -> None:
    text = load_case("jeffcott").source_text
    assert OWN in text
    decisions = make_plan(load_case_text(text.replace(OWN, ""))).decisions
    (decision,) = (one for one in decisions if one.choice == "cavitation")
    assert decision.reason.startswith("the default; ")


def test_each_film_says_whether_its_model_is_set() -> None:
    text = load_case("floating-ring").source_text
    case = load_case_text(text, ["bearing.inner.cavitation=reynolds", "film.cavitation=penalty"])
    told = [one.reason for one in make_plan(case).decisions if one.choice == "cavitation"]
    assert all(reason.startswith("set in the case; ") for reason in told)
    assert len(told) == 2


def test_a_mesh_of_a_test_below_the_fewest_cells_is_not_said_to_be_set() -> None:
    bearing = kinematic_plan(load_case("bearing", ["accuracy.mesh=[2, 8]"]))
    (cells,) = (one for one in bearing.decisions if one.choice == "cells")
    assert (cells.value, "fewer than a film needs" in cells.reason) == ("12 x 3", True)


@pytest.mark.parametrize("law", ["elrod", "two-phase", "reynolds"])
def test_no_error_of_forces_is_expected_of_cells(law: str) -> None:
    """What is known of cells is the error of the eccentricities; that of nearly vanishing forces is 1e-2 to 1."""
    assert expected_error(make_plan(load_case("jeffcott", [f"film.cavitation={law}"]))).film_force is None
