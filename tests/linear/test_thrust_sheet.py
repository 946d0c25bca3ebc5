"""Sheets of thrust bearings: cases, faults, loads, both sides, and what other analyses say."""

import json
from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.cli.main import run
from frbcli.errors import InputError

SPEED = [2000.0]


def test_a_load_is_that_of_the_gap_found_for_it() -> None:
    case = frbcli.load_case("thrust")
    (state,) = frbcli.thrust_sheet(case, speeds_Hz=SPEED, loads=[40.0]).points
    (again,) = frbcli.thrust_sheet(case, [state.gap], SPEED).points
    assert state.load == again.load == pytest.approx(40.0, rel=1e-9)
    assert state.power == pytest.approx(state.torque * 2.0 * np.pi * 2000.0)


@pytest.mark.parametrize(
    ("load", "said"), [(1e9, "the most is .* at a gap of 1 um"), (1e-9, "below the .* at a gap of 2 mm")]
)
def test_a_load_no_film_can_carry_is_refused(load: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        frbcli.thrust_sheet(frbcli.load_case("thrust"), speeds_Hz=SPEED, loads=[load])


def test_pads_on_both_sides_are_the_difference_of_loads_and_the_sum_of_all_else() -> None:
    one = frbcli.load_case("thrust")
    both = one.with_settings("thrust_bearing.0.side=both", "thrust_bearing.0.end_play=50 um")
    (near,), (far,) = (frbcli.thrust_sheet(one, [gap], SPEED).points for gap in (15e-6, 35e-6))
    (state,) = frbcli.thrust_sheet(both, [15e-6], SPEED).points
    assert state.load == pytest.approx(near.load - far.load, rel=1e-12)
    for name in ("torque", "power", "flow_inner", "flow_outer", "stiffness", "damping"):
        assert getattr(state, name) == pytest.approx(getattr(near, name) + getattr(far, name), rel=1e-12)
    np.testing.assert_allclose(state.tilt_stiffness, near.tilt_stiffness + far.tilt_stiffness, rtol=1e-12)
    (middle,) = frbcli.thrust_sheet(both, [25e-6], SPEED).points
    assert abs(middle.load) < 1e-9 * near.load
    with pytest.raises(InputError, match="leaves no gap on the other side"):
        frbcli.thrust_sheet(both, [50e-6], SPEED)


def test_models_that_pads_do_not_have_are_refused() -> None:
    with pytest.raises(InputError, match="without oil fractions and history"):
        frbcli.thrust_sheet(frbcli.load_case("thrust", ["film.cavitation=elrod"]), [15e-6], SPEED)


KEYS = ("speed_Hz", "gap_m", "load_N", "torque_N_m", "power_W", "flow_inner_m3_s", "flow_outer_m3_s", "p_max_Pa",
        "stiffness_N_m", "damping_N_s_m", "tilt_stiffness_N_m", "tilt_damping_N_m_s", "temperature_K")  # fmt: skip


def test_the_document_has_the_keys_of_the_sheet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["thrust", "thrust", "--gap", "12 um", "--gap", "9 um", "--speed", "900 Hz", "--load", "40 N"]
    assert run([*words, "--json", "--csv", "sheet.csv"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["command"] == "thrust"
    points = document["points"]
    assert [round(1e6 * point["gap_m"]) for point in points[:2]] == [9, 12]
    assert all(set(KEYS) <= point.keys() for point in points)
    assert points[2]["load_N"] == pytest.approx(40.0)
    assert np.shape(points[0]["tilt_stiffness_N_m"]) == (2, 2)
    assert points[0]["temperature_K"] is None
    assert (tmp_path / "thrust-thrust.png").stat().st_size > 10_000
    assert len((tmp_path / "sheet.csv").read_text().splitlines()) == 4


def test_several_bearings_have_their_names_and_a_sum(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = frbcli.load_case("thrust")
    (bearing,) = case.thrust_bearings
    table = {"side": "left", **{name: getattr(bearing, name) for name in
             ("inner_radius", "outer_radius", "pads", "pad_angle", "taper_angle", "taper")}}  # fmt: skip
    two = frbcli.case_from_dict({"oil": {"viscosity": 8e-3}, "thrust_bearing": [table, {**table, "name": "rear"}]})
    assert [state.bearing for state in frbcli.thrust_sheet(two, [15e-6], SPEED).points] == ["1", "rear"]
    assert frbcli.load_case_text(two.source_text).thrust_bearings == two.thrust_bearings
    (file := tmp_path / "two.toml").write_text(two.source_text)
    assert run(["thrust", str(file), "--gap", "15 um", "--speed", "2 kHz", "--no-picture"]) == 0
    (one, _) = frbcli.thrust_sheet(two, [15e-6], SPEED).points
    flow = 2.0 * 6e4 * (one.flow_inner + one.flow_outer)
    said = f"All thrust bearings at 2000 Hz: {2.0 * one.power:.4g} W loss, {flow:.3g} l/min oil."
    assert said in capsys.readouterr().out
