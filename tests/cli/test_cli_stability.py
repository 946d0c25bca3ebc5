"""`frb stability` and `frb limit-cycles`: JSON, tables, pictures, exit codes; what
`frb runup --explain` tells of cycles."""

import json
import math
from pathlib import Path

import pytest
from commands import Frb
from cycle_machines import UNIT_Hz, diagram, rigid

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.cli.main import run
from frbcli.cycles.limit_cycles import explanations, limit_cycles_over, threshold_kind
from frbcli.linear.stability import stability
from frbcli.plot.curves import run_tracks


def test_command_emits_the_points_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    speeds = ["--speed", "25 Hz", "--speed", "6000 rpm", "--speed", "1e-4 Hz"]
    assert frb("stability", "jeffcott", *speeds, "--json", "--quiet").document["threshold"] is None
    said = frb("stability", "jeffcott", *speeds, "--threshold", "--json", "--quiet")
    assert said.err == ""
    document = json.loads(said.out)
    assert document["command"] == "stability"
    uncertainty = {"speed_uncertainty_Hz", "frequency_uncertainty_Hz"}
    assert set(document["threshold"]) == {"speed_Hz", "frequency_Hz", "whirl_ratio"} | uncertainty
    assert all(0.0 < document["threshold"][key] < 0.1 for key in uncertainty)
    slow, fast, none = document["points"]
    assert (slow["speed_Hz"], fast["speed_Hz"]) == (25.0, 100.0)
    point = stability(load_case("jeffcott"), [25.0]).points[0]
    assert slow["displacement"] == pytest.approx(point.films[0].displacement.tolist())
    assert slow["stiffness_N_m"][0][1] == pytest.approx(point.films[0].stiffness[0, 1])
    assert slow["damping_N_s_m"][1][1] == pytest.approx(point.films[0].damping[1, 1])
    assert math.hypot(*slow["displacement"]) == pytest.approx(slow["eccentricity"])
    assert [tuple(pair) for pair in slow["eigenvalues"]] == [
        pytest.approx((value.real, value.imag)) for value in point.eigenvalues
    ]
    assert none["status"] == "not-converged"
    assert none["displacement"] is None
    assert (tmp_path / "jeffcott-campbell.png").read_bytes().startswith(b"\x89PNG")


def test_command_speaks_in_eighty_columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    said = frb("stability", "jeffcott", "--no-picture", "--set", "film.theory=short")
    assert [line for line in said.err.splitlines() if not line.startswith("Compiling the kernels, once: ")] == []
    rows = [line for line in said.out.splitlines() if line.startswith("  ") and "°" in line]
    assert len(rows) == 20
    assert max(len(row) for row in rows) <= 80
    assert "Threshold of stability: above 179.8 Hz" in said.out
    assert list(tmp_path.iterdir()) == []


def one_speed(case: str, speed_Hz: float) -> list[str]:
    """Words that ask for the stability of a case at one speed and no other one."""
    settings = ("film.cavitation=half-sommerfeld", f"speed.from={speed_Hz} Hz", f"speed.to={speed_Hz} Hz")
    return ["stability", case, *(word for setting in settings for word in ("--set", setting))]


def test_turbocharger_shows_its_growing_modes_and_names_its_films(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    picture = tmp_path / "campbell.svg"
    (point,) = frb(*one_speed("turbocharger-heavy", 600), "-o", str(picture), "--json").document["points"]
    said = frb(*one_speed("turbocharger-heavy", 600), "--no-picture").out.splitlines()
    names = ["compressor_inner", "compressor_outer", "turbine_inner", "turbine_outer"]
    assert [film["film"] for film in point["films"]] == names
    growing = [mode for mode in point["modes"] if mode["growth_1_s"] > 0.0]
    assert len(growing) == 3
    assert point["modes"][:3] == growing
    assert all(mode["damping"] < 0.0 for mode in growing)
    rows = [line.split() for line in said if "°" in line]
    assert ["_".join(row[-7:-5]) for row in rows] == names
    for row, mode in zip(rows, growing, strict=False):
        assert row[-3:] == [f"{mode['frequency_Hz']:.1f}", f"{mode['damping']:.4f}", f"{mode['growth_1_s']:.1f}"]
    assert max(len(line) for line in said if "°" in line or "film" in line) <= 80
    assert picture.read_text().lower().count("#d55e00") >= 2 * len(growing)  # in both panels


def test_springs_of_films_without_direct_stiffness_are_left_out_and_told(frb: Frb) -> None:
    """The compressor's inner film is full all around there: its half-Sommerfeld pressure holds nothing."""
    words = [*one_speed("turbocharger-heavy", 1200), "--no-picture"]
    assert len(frb(*words, "--json").document["natural_frequencies"]) == 1
    assert "no direct stiffness" in frb(*words).out


ROLLING = """
[rotor]
kind = "turbocharger"
[[shaft]]
length = "200 mm"
diameter = "20 mm"
[speed]
from = "100 Hz"
to = "900 Hz"
duration = "1 s"
""" + "".join(f"""
[[bearing]]
kind = "ball"
name = "{name}"
position = "{position}"
balls = 9
ball_diameter = "4 mm"
pitch_diameter = "18 mm"
contact_angle = "25 deg"
preload = "50 N"
""" for name, position in (("front", "20 mm"), ("rear", "180 mm")))


def test_natural_frequencies_on_balls_are_left_to_the_damped_modes(tmp_path: Path, frb: Frb) -> None:
    """Balls hold the shaft as they do at a static equilibrium, softer by far at this speed than standing."""
    (tmp_path / "rolling.toml").write_text(ROLLING)
    words = ["stability", str(tmp_path / "rolling.toml"), "--no-picture", "--speed", "900 Hz"]
    (free,) = frb(*words, "--json").document["natural_frequencies"]
    assert not free["stiffness_N_m"]
    assert "--shapes SPEED" in " ".join(frb(*words).out.split())


def test_speeds_that_are_asked_for_are_all_shown(frb: Frb) -> None:
    speeds = [word for speed in range(101, 126) for word in ("--speed", f"{speed} Hz")]
    assert "".join(frb("stability", "jeffcott", "--no-picture", "--set", "film.theory=short", *speeds)).count("°") == 25


def test_many_speeds_without_a_resting_position_are_told_in_short(frb: Frb) -> None:
    slow = ["--set", "film.theory=short", "--set", "speed.to=1e-8 Hz"]
    said = "".join(frb("stability", "jeffcott", "--no-picture", *slow, code=3))
    assert "No modes at 60 of 60 speeds" in said
    assert said.count("Ask for a higher speed") == 1


SHORT = ("--set", "film.theory=short")
AROUND = ("--set", "speed.from=165 Hz", "--set", "speed.to=185 Hz")  # Hopf point and fold of the Jeffcott rotor


@pytest.mark.nightly  # three diagrams, 14 s
def test_a_diagram_over_a_number_of_the_case_meets_that_over_the_speed() -> None:
    """Rigid rotor at w = 2.72: Hopf point and fold over the viscosity lie where the diagrams over the speed of these
    viscosities have theirs."""
    case = rigid(4.538, 2.4, 2.9)
    viscosity, speed = case.oil.viscosity, 2.72 * UNIT_Hz
    found = limit_cycles_over(case, "oil.viscosity", f"{0.6 * viscosity!r} Pa*s", f"{1.1 * viscosity!r} Pa*s", speed)
    assert (found.over, found.unit) == ("oil.viscosity", "Pa*s")
    for kind in ("hopf", "fold"):
        (point,) = found.of(kind)
        other = diagram(4.538 * point.value / viscosity, 2.4, 2.9).of(kind)[0]
        assert other.speed_Hz == pytest.approx(speed, rel=1e-7)
        assert point.frequency_Hz == pytest.approx(other.frequency_Hz, rel=1e-6)
        assert point.criticality == other.criticality
        assert point.eccentricity_max[0] == pytest.approx(other.eccentricity_max[0], abs=1e-4)


def test_the_command_goes_over_a_number_of_the_case(frb: Frb, tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "rigid.toml").write_text(rigid(4.538, 2.4, 2.9).source_text)
    words = ["limit-cycles", str(tmp_path / "rigid.toml"), "--json", "--csv"]
    words += [str(tmp_path / "over.csv"), "-o", str(tmp_path / "over.png")]
    words += ["--speed", f"{2.7 * UNIT_Hz} Hz", "--parameter"]
    document = frb(*words, "bearing.clearance=48..60 um").document
    assert (document["over"], document["unit"]) == ("bearing.clearance", "um")
    assert 47.9 < document["equilibria"][0]["value"] < 60.1
    assert document["special"]
    for point in document["special"]:  # of short films, beside those of finite length
        assert 1e-3 * point["value"] < point["value_uncertainty"] < 0.1 * point["value"]
        assert point["speed_uncertainty_Hz"] is None
    assert (tmp_path / "over.csv").read_text().startswith("bearing.clearance,branch")
    frb(*words, "bearing.clearance=-1..60 um", code=2)
    frb(*words, "bearing.clearance", code=2)


def test_a_map_without_a_point_says_so(frb: Frb) -> None:
    """Below its threshold of 178 Hz the rotor whirls at no clearance near its own."""
    words = ["limit-cycles", "jeffcott", "--set", "film.theory=short", "--speed", "120 Hz", "--no-picture"]
    words += ["--parameter", "bearing.clearance=34..36 um", "--points", "2"]
    told = frb(*words, "--and", "oil.viscosity=12..13 mPa*s").out
    assert "no whirl begins or ends between these values" in " ".join(told.split())


def test_whirls_with_unbalance_are_told(frb: Frb, tmp_path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """Of the Jeffcott rotor, whose whirl locks in; refused over a number and without unbalance."""
    monkeypatch.chdir(tmp_path)
    words = ["limit-cycles", "jeffcott", "--with-unbalance", "--set", "speed.from=186 Hz", "--set", "speed.to=192 Hz"]
    document = frb(*words, "--json", "--csv", "table.csv").document
    whirls = document["branches"][0]["with_unbalance"]
    assert whirls
    for whirl in whirls:
        assert whirl["locked"]
        assert whirl["stable"]
        assert whirl["frequency_Hz"] == pytest.approx(0.5 * whirl["speed_Hz"])
        assert whirl["lines"][0]["name"] == "Omega / 2"
    assert ",locked," in (tmp_path / "table.csv").read_text()
    told = frb(*words, "--no-picture").out
    assert "Locked in with unbalance" in told
    assert "Omega/2" in told
    assert max(map(len, told.splitlines())) <= 80
    over = ["--parameter", "bearing.clearance=30..45 um"]
    assert "--with-unbalance is of the diagram" in frb(*words, *over, code=2).err
    assert "is zero" in frb(*words, "--set", "rotor.unbalance=0 g*mm", code=2).err


def test_json_has_what_is_promised(frb: Frb, tmp_path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.chdir(tmp_path)
    document = frb("limit-cycles", "jeffcott", *SHORT, *AROUND, "--json", "--csv", "table.csv").document
    assert set(document["equilibria"][0]) >= {"speed_Hz", "displacement", "stable"}
    (branch,) = document["branches"]
    assert set(branch["points"][0]) >= {"speed_Hz", "frequency_Hz", "eccentricity_max", "stable", "multipliers"}
    assert [point["kind"] for point in document["special"]] == ["hopf", "fold"]
    assert document["special"][0]["criticality"] == "subcritical"
    assert document["special"][1]["speed_Hz"] < document["special"][0]["speed_Hz"]
    assert (tmp_path / "jeffcott-limit-cycles.png").exists()
    assert (tmp_path / "table.csv").read_text().startswith("branch,speed_Hz,frequency_Hz,stable")


def test_stability_tells_a_hard_threshold() -> None:
    case, found = rigid(4.538, 2.4, 2.9), diagram(4.538, 2.4, 2.9)
    kind = threshold_kind(case, found.of("hopf")[0].speed_Hz)
    assert kind is not None
    assert kind.criticality == "subcritical"
    # The diagram has five times as many harmonics there, for the multipliers.
    assert kind.fold_Hz == pytest.approx(found.of("fold")[0].speed_Hz, rel=3e-6)


def test_a_film_whose_cycles_are_not_followed_has_no_kind_of_threshold() -> None:
    assert threshold_kind(frbcli.load_case("jeffcott", ["film.cavitation=reynolds"]), 170.0) is None


def test_onset_and_offset_are_explained() -> None:
    found = diagram(4.538, 2.4, 2.9)
    (hopf,), (fold,) = found.of("hopf"), found.of("fold")
    seen = [("onset", hopf.speed_Hz + 20.0, hopf.frequency_Hz), ("offset", fold.speed_Hz - 3.0, fold.frequency_Hz)]
    events = [{"kind": kind, "speed_Hz": speed, "frequency_Hz": frequency} for kind, speed, frequency in seen]
    onset, offset = explanations(found, [*events, {"kind": "contact", "speed_Hz": 1.0, "frequency_Hz": None}])
    assert "hard Hopf point" in onset
    assert "20.0 Hz later" in onset
    assert "end in the fold" in offset
    assert "3.0 Hz away" in offset


@pytest.mark.nightly  # 14 s; the option alone: tests/helpers/output_options.py
def test_runs_are_drawn_over_the_diagram(tmp_path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.chdir(tmp_path)
    short = [*SHORT, *AROUND, "--set", "speed.duration=0.3 s"]
    assert run(["rundown", "jeffcott", *short, "--no-picture", "-o", "down.h5", "--explain", "--quiet"]) == 0
    up, down = run_tracks(frbcli.read_run("down.h5"), "down")
    assert up.rising
    assert not down.rising
    whole = frbcli.read_run("down.h5").signals["eccentricity"][:].max()
    assert max(up.largest[""].max(), down.largest[""].max()) == pytest.approx(whole)
    assert run(["limit-cycles", "jeffcott", *short, "--runs", "down.h5", "-o", "all.svg", "--quiet"]) == 0
    told = (tmp_path / "all.svg").read_text()
    assert up.label in told
    assert down.label in told
