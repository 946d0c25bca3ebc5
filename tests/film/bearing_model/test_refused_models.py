"""What a case and the program ask of a bearing model, and what they refuse."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from bearing_models import CHOSEN, HALF, chosen, damper_case, spring
from numba import njit

import frbcli
from frbcli.case.reading.listing import values
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
from frbcli.film.bearing_model import table
from frbcli.film.bearing_model.model import BearingModel
from frbcli.scene.planning.kinematic_plan import kinematic_plan


@pytest.fixture(autouse=True)
def added() -> None:
    frbcli.add_bearing(HALF)
    frbcli.add_bearing(CHOSEN)


def test_keys_and_plan_of_a_model_are_those_of_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    motion = "motion={ eccentricity = 0.5, whirl_speed = '60 Hz' }"
    case = damper_case("film.damper.spring=3000 N/mm", motion)
    assert case.film.damper.spring == 3e6
    keys = {value.key: value for value in values(case)}
    assert keys["film.damper.spring"].unit == "N/m"
    assert keys["film.theory"].value == "damper"
    assert frbcli.load_case_text(case.source_text, name="damper") == case
    decisions = {decision.choice: decision for decision in kinematic_plan(case).decisions}
    assert "added from Python" in decisions["theory"].reason
    path = tmp_path / "damper.toml"
    path.write_text(case.source_text, encoding="utf-8")
    assert frb(["check", str(path), "--all"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "squeeze film damper" in told
    assert "3e+06 N/m" in told
    assert frb(["rotation", str(path), "-o", str(tmp_path / "rotation.png")]) == 0
    assert frb(["rotation", str(path), "--cavitation", "elrod"]) == 2
    assert "has no effect on film.theory = damper" in capsys.readouterr().err
    whirl = "motion={ eccentricity = 0.5, frequency = '60 Hz' }"
    assert frb(["whirl", str(path), "--set", whirl, "-o", str(tmp_path / "whirl.png"), "--json"]) == 0
    assert (tmp_path / "whirl.png").exists()
    assert '"theory": "damper"' in capsys.readouterr().out


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (["film.theory=dampr"], 'Did you mean "damper"?'),
        (["film.theory=other"], "short-pi, damper. One of your own is added in this process .*frbcli.add_bearing"),
        (["film.damper.spring=-1 N/m"], "film.damper.spring"),
        (["film.damper.spring=1 N"], "film.damper.spring"),
        (["film.damper.sprung=1"], 'Did you mean "spring"'),
        (["film.damper.film=half"], "There are: pi, full"),
        (["film.short-pi.length=1"], "film.short-pi: is not known here"),
    ],
)
def test_a_wrong_key_of_a_model_is_told(settings: list[str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        damper_case("motion={ eccentricity = 0.5, whirl_speed = '60 Hz' }", *settings)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (["film.cavitation=elrod"], "film.cavitation = elrod: has no effect with film.theory = short-pi"),
        (["film.solution=cells"], "film.solution = cells: has no effect"),
        (["film.coupling=monolithic"], "Write dynamic-static or auto"),
        (["film.grid=half-speed"], "film.grid = half-speed: has no effect"),
        (["bearing.lobes={ count = 3, preload = 0.5 }"], "lobes = 3 lobes: is a shape"),
        (["bearing.supply={ kind = 'pocket', position = '0 deg', opening_angle = '20 deg', width = '5 mm', "
          "pressure = '2 bar' }"], "is a supply that a bearing model cannot represent"),
    ],
)  # fmt: skip
def test_what_a_model_is_not_told_of_is_refused(settings: list[str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        frbcli.make_plan(frbcli.load_case("rigid", ["film.theory=short-pi", *settings]))


def test_a_case_that_was_read_before_its_model_is_told_to_be_read_again() -> None:
    case = frbcli.load_case("rigid", ["film.theory=damper"])
    with_more = (*CHOSEN.keys, frbcli.BearingKey("gain", 1.0))
    frbcli.add_bearing(BearingModel("damper", "damper", chosen, keys=with_more))
    with pytest.raises(InputError, match="the case was read before the model was added"):
        frbcli.make_plan(case)


@njit
def nowhere(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    size = math.sqrt(d_x * d_x + d_y * d_y)
    return -1e6 * d_x / size, -1e6 * d_y / size


@njit
def throws(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    if d_x > 0.0:
        raise ValueError("not here")
    return -d_x, -d_y


def three(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    return d_x, d_y, 0.0


def few(d_x, d_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    return d_x, d_y


def text(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    return open(d_x), d_y


def no_field(d_x, d_y, v_x, v_y, omega, bearing):  # type: ignore[no-untyped-def]  # noqa: ARG001
    return bearing.length * d_x, d_y


def wrong_slopes(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, bearing: Any) -> Any:  # noqa: ARG001
    return -1e6, -2e5, -2e5, -1e6, -100.0, 0.0, 0.0, -100.0


@pytest.mark.parametrize(
    ("model", "told"),
    [
        (BearingModel("mine", "mine", three), "force: returns .*, not 2 numbers. Return"),
        (BearingModel("mine", "mine", spring, three), "derivatives: returns .*, not 8 numbers"),
        (BearingModel("mine", "mine", few), "force: cannot be compiled by numba: .*function takes 4 arguments"),
        (BearingModel("mine", "mine", text), "force: cannot be compiled by numba: .*open"),
        (BearingModel("mine", "mine", no_field), "force: cannot be compiled by numba: .*length"),
        (BearingModel("mine", "mine", 3.0), "force: is no function"),  # type: ignore[arg-type]
        (BearingModel("short", "mine", spring), "name: is already a key or model of the program"),
        (BearingModel("two-phase", "mine", spring), "name: is already a key or model of the program"),
        (BearingModel("My Bearing", "mine", spring), "name: has other characters than small letters"),
        (BearingModel("mine", "mine", spring, keys=(frbcli.BearingKey("width", 1.0),)),
         "keys.width: is already the name of another field"),
        ("mine", "is not a BearingModel"),
    ],
)
def test_what_is_no_model_is_refused(model: BearingModel, told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        frbcli.add_bearing(model)
    assert len(refused.value.faults) == 1
    assert "mine" not in {one.name for one in table.models()}


@pytest.mark.parametrize(
    ("model", "told"),
    [
        (BearingModel("mine", "mine", nowhere), r"has no finite force at d = \(0, 0\) m"),
        (BearingModel("mine", "mine", throws), r"has no finite force at d = \(.*\) m"),
        (BearingModel("mine", "mine", spring, wrong_slopes), r"tells dF_x / dd_y = -200000 at .* are 200000"),
    ],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_forces_that_are_none_are_told_before_anything_runs(model: BearingModel, told: str, tmp_path: Path) -> None:
    frbcli.add_bearing(model)
    with pytest.raises(InputError, match=told):
        frbcli.runup(frbcli.load_case("rigid", ["film.theory=mine"]), tmp_path / "run.h5")
    assert not (tmp_path / "run.h5").exists()
