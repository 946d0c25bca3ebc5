"""The sheet of a bearing against printed tables, closed forms, and the program's own run-up films."""

import csv
import json
import math
import os
import re
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
from printed_sheets import CASE, OMEGA, Row, grooves, printed

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.cli.main import run as frb
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import InputError
from frbcli.linear.sheets.bearing import BearingSheet, bearing_sheet, sommerfeld_chart
from frbcli.linear.sheets.film_state import FilmState

NO_SUPPLY = '{ kind = "none" }'

ROSS = os.environ.get("FRB_ROSS_PYTHON", "")  # an interpreter that has it


BUTENSCHOEN = [row for row in printed("butenschoen.csv") if row["width_over_diameter"] in (1.0, 0.5, 0.25, 0.125)]


@pytest.mark.parametrize("row", BUTENSCHOEN, ids=lambda row: f"{row['width_over_diameter']}-{row['eccentricity']}")
def test_load_attitude_and_side_flow_of_butenschoen(row: Row) -> None:
    """The film begins at the widest gap: there is a groove of half a degree."""
    radius, clearance = 0.01, 20e-6
    width = 2e3 * radius * row["width_over_diameter"]
    supply = grooves(1, row["attitude_deg"], 0.5)
    case = load_case_text(
        CASE.format(viscosity=10, width=width, diameter=20, clearance=20, supply=supply, load=1), name="plain"
    )
    state = sommerfeld_chart(case, [row["eccentricity"]], 50.0).points[0]
    flow = state.side_flow / (radius**3 * (clearance / radius) * OMEGA)
    # printed to four places: of the narrowest bearings 2 % of the smallest Sommerfeld number
    assert state.sommerfeld_number == pytest.approx(row["sommerfeld_number"], rel=0.01, abs=6e-5)
    assert state.attitude_deg == pytest.approx(row["attitude_deg"], abs=0.25)
    assert flow == pytest.approx(row["side_flow"], rel=0.006)


@pytest.mark.parametrize(
    "row", printed("lund-thomsen.csv"), ids=lambda row: f"{row['width_over_diameter']}-{row['s']}"
)
def test_coefficients_of_lund_and_thomsen(row: Row) -> None:
    """Within 1.6 % of the largest entry; their x lies along the load, y across."""
    width, clearance = 0.1 * row["width_over_diameter"], 1e-4
    load = 0.02 * 50.0 * width * 0.1 * (0.05 / clearance) ** 2 / row["s"]
    case = load_case_text(
        CASE.format(viscosity=20, width=1e3 * width, diameter=100, clearance=100, supply=grooves(2, 90, 20), load=load)
    )
    state = bearing_sheet(case).points[0]
    assert state.eccentricity == pytest.approx(row["eccentricity"], abs=2e-3)
    assert state.attitude_deg == pytest.approx(row["attitude_deg"], abs=0.2)
    assert_coefficients(state, row, load, clearance, 0.016)


@pytest.mark.parametrize("row", printed("lund-thomsen-lemon.csv"), ids=lambda row: f"{row['s']}")
def test_coefficients_of_a_lemon_bore_of_lund_and_thomsen(row: Row) -> None:
    """Within 0.7 % of the largest entry. Their numbers refer to the clearance of a lobe, twice that of the bearing."""
    clearance = 2e-4
    load = 0.02 * 50.0 * 0.1 * 0.1 * (0.05 / clearance) ** 2 / row["s"]
    text = CASE.format(viscosity=20, width=100, diameter=100, clearance=100, supply=grooves(2, 90, 20), load=load)
    lobes = "lobes = { count = 2, preload = 0.5 }"
    state = bearing_sheet(load_case_text(text.replace("[film]", f"{lobes}\n[film]"))).points[0]
    assert 0.5 * state.eccentricity == pytest.approx(row["eccentricity"], abs=2e-3)
    if row["s"] != 0.161:  # a misprint, see the table
        assert state.attitude_deg == pytest.approx(row["attitude_deg"], abs=0.1)
    assert_coefficients(state, row, load, clearance, 0.007)


def assert_coefficients(state: FilmState, row: Row, load: float, clearance: float, share: float) -> None:
    """Stiffness and damping are the printed ones within a share of their largest entries."""
    assert state.stiffness is not None
    assert state.damping is not None
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])  # to the frame of the table
    k = turn @ state.stiffness @ turn.T * clearance / load
    b = turn @ state.damping @ turn.T * clearance * OMEGA / load
    given = np.array([[row["kxx"], row["kxy"]], [row["kyx"], row["kyy"]]])
    assert np.abs(k - given).max() < share * np.abs(given).max()
    given = np.array([[row["bxx"], row["bxy"]], [row["bxy"], row["byy"]]])
    assert np.abs(b - given).max() < share * np.abs(given).max()


@pytest.fixture(scope="module")
def plain() -> BearingSheet:
    text = CASE.format(viscosity=10, width=10, diameter=20, clearance=20, supply=NO_SUPPLY, load=30)
    return sommerfeld_chart(load_case_text(text, name="plain"), [0.01, 0.3, 0.6, 0.9], 50.0)


def test_a_nearly_centred_journal_has_the_torque_of_petroff(plain: BearingSheet) -> None:
    state = plain.points[0]
    petroff = 2.0 * math.pi * 0.01 * OMEGA * 0.01**3 * 0.01 / 20e-6
    assert -state.torque == pytest.approx(petroff, rel=1e-3)
    assert state.power == pytest.approx(-state.torque * OMEGA, rel=1e-12)
    assert state.film_thickness_min == pytest.approx(0.99 * 20e-6, rel=1e-6)


@pytest.mark.parametrize("eccentricity", [0.5, 0.8])
def test_friction_of_sommerfeld_s_film(eccentricity: float) -> None:
    """mu R / C = (1 + 2 eps^2) / (3 eps) of an infinitely long film full of oil: what twice the width adds to torque
    and load, in which the ends do not count. Cells 5 mm and 10 mm wide leave 0.3 %."""
    short, long = (_sommerfeld_s_film(width, eccentricity) for width in (200, 400))
    friction, load = np.array([[state.friction_variable, np.hypot(*state.load)] for state in (short, long)]).T
    added = np.diff(friction * load)[0] / np.diff(load)[0]
    assert added == pytest.approx((1.0 + 2.0 * eccentricity**2) / (3.0 * eccentricity), rel=5e-3)


def _sommerfeld_s_film(width: float, eccentricity: float) -> FilmState:
    text = CASE.format(viscosity=10, width=width, diameter=20, clearance=20, supply=NO_SUPPLY, load=30)
    case = load_case_text(text.replace('"reynolds"', '"sommerfeld"'), name="long")
    return sommerfeld_chart(case, [eccentricity], 50.0).points[0]


def test_without_a_load_there_is_no_coefficient_of_friction(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["bearing", "jeffcott", "--set", "rotor.gravity=0", "--speed", "50 Hz", "--no-picture", "--json"]
    assert frb(words) == 0
    (point,) = json.loads(capsys.readouterr().out)["points"]
    assert point["torque_N_m"] < 0.0
    assert (point["friction_coefficient"], point["friction_variable"]) == (None, None)


def test_damping_is_symmetric_and_the_load_is_carried(plain: BearingSheet) -> None:
    for state in plain.points:
        assert state.damping is not None
        assert abs(state.damping[0, 1] - state.damping[1, 0]) < 1e-3 * np.abs(state.damping).max()
        assert abs(state.load[0]) < 1e-6 * abs(state.load[1])
        assert state.load[1] < 0.0
    loads = [abs(state.load[1]) for state in plain.points]
    assert loads == sorted(loads)


def test_the_load_of_the_chart_gives_its_eccentricity_back(plain: BearingSheet) -> None:
    state = plain.points[2]
    found = bearing_sheet(plain.case, [50.0], load=-float(state.load[1])).points[0]
    assert found.displacement == pytest.approx(state.displacement, abs=1e-6)
    assert found.power == pytest.approx(state.power, rel=1e-6)


def test_the_command_writes_table_picture_and_coefficients(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["bearing", "jeffcott", "--speed", "50 Hz", "--speed", "6000 rpm", "--csv", "t.csv", "--ross", "t.toml"]
    assert frb([*words, "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)["points"]
    assert (first["speed_Hz"], second["speed_Hz"]) == (pytest.approx(50.0), pytest.approx(100.0))
    assert frb(words) == 0
    said = capsys.readouterr().out
    assert "Sommerfeld number" in said
    assert max(map(len, said.splitlines())) <= 80
    assert (tmp_path / "jeffcott-bearing.png").read_bytes().startswith(b"\x89PNG")
    table = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert float(table[1]["stiffness_xy_N_m"]) == pytest.approx(second["stiffness_N_m"][0][1])
    (element,) = tomllib.loads((tmp_path / "t.toml").read_text(encoding="utf-8")).values()
    assert element["frequency"] == pytest.approx([100.0 * math.pi, 200.0 * math.pi])
    assert element["cyx"][0] == pytest.approx(first["damping_N_s_m"][1][0])
    assert set(element) == {"n", "tag", "frequency", *(f"{c}{a}" for c in "kc" for a in ("xx", "xy", "yx", "yy"))}


def test_several_films_have_a_line_each_and_their_sum(capsys: pytest.CaptureFixture[str]) -> None:
    """Of both bearings of a symmetric rotor; the ring's speed is the one of the sheet."""
    words = ["bearing", "floating-ring", "--speed", "100 Hz", "--set", "accuracy.mesh=[4, 16]", "--no-picture"]
    assert frb([*words, "--json"]) == 0
    films = json.loads(capsys.readouterr().out)["points"]
    assert frb(words) == 0
    said = capsys.readouterr().out
    rows = {line.split()[0]: line.split() for line in said.splitlines() if line.startswith("  ") and line.strip()}
    for film in films:
        assert float(rows[film["film"]][4]) == pytest.approx(film["power_W"], rel=1e-3)
        assert float(rows[film["film"]][5]) == pytest.approx(6e4 * film["side_flow_m3_s"], rel=1e-2)
    assert float(rows["both"][-2]) == pytest.approx(2.0 * sum(film["power_W"] for film in films), rel=1e-3)
    assert f"ring {films[0]['shell_speed_Hz'] / 100.0:.3f}" in said
    assert max(map(len, said.splitlines())) <= 80


def test_several_films_have_a_file_for_ross_each(tmp_path: Path) -> None:
    """`ross.BearingElement.load` takes the first table of a file and passes over the others."""
    for film, path in ross_of("floating-ring", tmp_path, "inner", "outer").items():
        (name,) = tomllib.loads(path.read_text(encoding="utf-8"))
        assert name == f"BearingElement_{film}"


def ross_of(case: str, folder: Path, *films: str, speeds: tuple[str, ...] = ("50 Hz",)) -> dict[str, Path]:
    """The files for ROSS of each film, with the numbers of the table."""
    asked = [word for speed in speeds for word in ("--speed", speed)]
    words = ["bearing", case, *asked, "--set", "accuracy.mesh=[4, 16]", "--no-picture", "--quiet"]
    assert frb([*words, "--csv", str(folder / "t.csv"), "--ross", str(folder / "t.toml")]) == 0
    paths = {film: folder / (f"t-{film}.toml" if film else "t.toml") for film in films}
    assert sorted(folder.glob("*.toml")) == sorted(paths.values())
    rows = list(csv.DictReader((folder / "t.csv").read_text(encoding="utf-8").splitlines()))
    for film, path in paths.items():
        (element,) = tomllib.loads(path.read_text(encoding="utf-8")).values()
        for name, column in (("kyx", "stiffness_yx_N_m"), ("cxy", "damping_xy_N_s_m")):
            assert element[name] == [float(row[column]) for row in rows if row["film"] == film]
    return paths


@pytest.mark.skipif(not ROSS, reason="no interpreter with ROSS (FRB_ROSS_PYTHON)")
@pytest.mark.parametrize(("case", "films"), [("jeffcott", ("",)), ("floating-ring", ("inner", "outer"))])
def test_ross_reads_the_coefficients(case: str, films: tuple[str, ...], tmp_path: Path) -> None:
    for film, path in ross_of(case, tmp_path, *films, speeds=("50 Hz", "100 Hz")).items():
        assert_read_by_ross(path, film or "bearing")


def assert_read_by_ross(path: Path, film: str) -> None:
    given = tomllib.loads(path.read_text(encoding="utf-8"))[f"BearingElement_{film}"]
    words = "import json, sys, ross; b = ross.BearingElement.load(sys.argv[1]); w = float(sys.argv[2]); "
    words += "print(json.dumps([b.K(w)[:2, :2].tolist(), b.C(w)[:2, :2].tolist()]))"
    bare = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    for place, omega in enumerate(given["frequency"]):
        line = [ROSS, "-c", words, str(path), str(omega)]
        told = subprocess.run(line, check=True, capture_output=True, text=True, timeout=300, env=bare).stdout
        for letter, matrix in zip("kc", json.loads(told.splitlines()[-1]), strict=True):
            mine = [given[f"{letter}{row}{column}"][place] for row in "xy" for column in "xy"]
            assert np.ravel(matrix) == pytest.approx(mine)


def test_over_eccentricity_the_command_draws_sommerfeld_s_chart(tmp_path: Path) -> None:
    options = ["--over", "eccentricity", "-o", str(tmp_path / "chart.svg"), "--quiet"]
    assert frb(["bearing", "bearing", "--set", "film.cavitation=reynolds", *options]) == 0
    assert "Sommerfeld number" in (tmp_path / "chart.svg").read_text(encoding="utf-8")


def test_a_sheet_fills_one_screen_unless_more_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    """Short: a row at the first and the last speed; --all: every speed, K and C; of few speeds all is short enough."""
    def said(*words: str) -> list[str]:
        assert frb(["bearing", "jeffcott", "--set", "film.theory=short", "--no-picture", *words]) == 0
        return capsys.readouterr().out.splitlines()

    def rows(lines: list[str]) -> list[float]:
        return [float(line.split()[0]) for line in lines if re.match(r"  \d", line)]

    short, everything, one = said(), said("--all"), said("--speed", "50 Hz")
    assert len(short) <= 24
    assert max(map(len, short)) <= 80
    assert (min(rows(short)), max(rows(short))) == (min(rows(everything)), max(rows(everything)))
    assert len(rows(everything)) == 3 * 20
    for words in ("stiffness K in N/um", "damping C in N s/mm"):
        assert not any(words in line for line in short if not line.startswith("--all"))
        assert any(words in line for line in everything)
        assert any(words in line for line in one)
    assert "--all" in short[-2] + short[-1]


WARM = [
    "film.cavitation=half-sommerfeld", "bearing.supply.pressure=2 bar", "oil.density=830 kg/m^3",
    "oil.heat_capacity=2100 J/(kg*K)", 'oil.viscosity={ grade = "SAE 10W-40" }', "thermal.model=lumped",
    "thermal.supply_temperature=50 degC", "thermal.mixing=0.5",
]  # fmt: skip


def test_with_heat_every_speed_has_its_warm_film() -> None:
    """An adiabatic film warms by mixing times what its power makes of its oil; with more speed more."""
    case = load_case("jeffcott", WARM)
    points = bearing_sheet(case, [50.0, 200.0]).points
    for point in points:
        (film,) = warm_machine(case, point.speed_Hz).films
        assert point.temperature == pytest.approx(film.temperature, abs=1e-3)
        assert point.viscosity == pytest.approx(film.viscosity, rel=1e-5)
        assert point.power == pytest.approx(film.power, rel=1e-3)
        assert point.side_flow == pytest.approx(film.flow, rel=2e-3)
        rise = point.power / (830.0 * 2100.0 * point.side_flow)
        assert point.temperature_rise == pytest.approx(rise)
        assert point.temperature - 323.15 == pytest.approx(0.5 * rise, rel=3e-3)
    assert points[1].temperature > points[0].temperature + 1.0
    assert points[1].viscosity < points[0].viscosity


def test_with_heat_the_load_is_that_of_the_rotor() -> None:
    case = load_case("jeffcott", WARM)
    with pytest.raises(InputError, match="takes no other"):
        bearing_sheet(case, [50.0], load=30.0)
    with pytest.raises(InputError, match="over eccentricity"):
        sommerfeld_chart(case, [0.5])


def test_the_command_tells_film_temperatures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sets = [word for setting in WARM for word in ("--set", setting)]
    table = tmp_path / "sheet.csv"
    code = frb(["bearing", "jeffcott", *sets, "--speed", "50 Hz", "--no-picture", "--csv", str(table), "--json"])
    document = json.loads(capsys.readouterr().out)
    assert code == 0
    (point,) = document["points"]
    (row,) = csv.DictReader(table.read_text(encoding="utf-8").splitlines())
    for name in ("temperature_K", "viscosity_Pa_s", "clearance_m"):
        assert float(row[name]) == pytest.approx(point[name])
    assert point["temperature_K"] > 323.15
    assert (document["oil_density_kg_m3"], document["oil_heat_capacity_J_kg_K"]) == (830.0, 2100.0)


DAMPED = 'bearing.damper={width="20 mm", diameter="50 mm", clearance="80 um", mass="500 g", spring="1e7 N/m"}'


def test_a_damper_around_a_bearing_leaves_its_sheet_as_it_is() -> None:
    """Its film does not turn and has no sheet; the film in its shell carries the same load."""
    case = load_case("jeffcott", ["film.theory=short"])
    damped = case.with_settings(DAMPED)
    for make in (lambda each: bearing_sheet(each, [40.0]), lambda each: sommerfeld_chart(each, [0.5])):
        alone, around = make(case), make(damped)
        assert around.films == alone.films
        (known,), (found,) = alone.points, around.points
        for name in ("displacement", "stiffness", "damping", "power", "side_flow", "p_max"):
            np.testing.assert_allclose(getattr(found, name), getattr(known, name), rtol=1e-9, err_msg=name)
    with pytest.raises(InputError, match="the shell sinks"):
        bearing_sheet(case.with_settings(DAMPED.replace(', spring="1e7 N/m"', "")), [40.0])
    with pytest.raises(InputError, match="load of a single film"):
        bearing_sheet(damped, [40.0], load=30.0)


@pytest.mark.parametrize("theory", ["short", "finite"])
def test_a_journal_in_the_middle_of_its_shell_has_a_sheet(theory: str) -> None:
    """Without gravity no oil leaves, and there is no temperature rise of it; half of the damping times the speed is the
    cross-coupled stiffness, and the loss is Petroff's."""
    rotor = 'kind = "rigid"\nmass = "100 kg"\ngravity = "0 m/s^2"'
    bearing = 'kind = "single-film"\nwidth = "30 mm"\ndiameter = "100 mm"\nclearance = "100 um"\nends = "oil-bath"'
    oil = 'viscosity = "30 mPa*s"\ndensity = "850 kg/m^3"'
    text = f"[rotor]\n{rotor}\n[bearing]\n{bearing}\nsupply = {NO_SUPPLY}\n[oil]\n{oil}\n"
    speed = '[speed]\nfrom = "0 Hz"\nto = "100 Hz"\nduration = "5 s"\n'
    (point,) = bearing_sheet(load_case_text(f'{text}[film]\ntheory = "{theory}"\n{speed}'), [50.0]).points
    omega = 2.0 * math.pi * 50.0
    assert point.side_flow == 0.0
    assert math.isnan(point.temperature_rise)
    assert point.largest_error < 0.1
    assert point.power == pytest.approx(2.0 * math.pi * 0.03 * 0.05**3 * 0.03 / 100e-6 * omega**2, rel=1e-3)
    k, c = point.stiffness, point.damping
    assert k[0, 1] == pytest.approx(-k[1, 0], rel=1e-5)
    assert k[0, 1] == pytest.approx(0.5 * omega * c[0, 0], rel=1e-3)
    assert abs(k[0, 0]) < 1e-4 * k[0, 1]
