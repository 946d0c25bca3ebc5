"""Given coefficients beside films, their files, and the faults of both."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from given_rotors import JEFFCOTT, TURN, bearing, growing_seal, matrix, rigid, speed

import frbcli
from frbcli.case.reading.listing import machine_fault
from frbcli.case.reading.load import case_from_dict, load_case_text
from frbcli.equilibrium.linearised import coefficients_of
from frbcli.equilibrium.resting import resting_position
from frbcli.errors import InputError
from frbcli.linear.stability import stability
from frbcli.linear.stability_point import eigenvalues
from frbcli.rotor.loads import LinearPart
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.sweep import sweep

SHORT_FILM = {
    "kind": "single-film", "width": "20 mm", "diameter": "25 mm", "clearance": "35 um", "ends": "oil-bath",
    "supply": {"kind": "circumferential-groove", "pressure": "1 bar"},
}  # fmt: skip
OIL = {"viscosity": "12 mPa*s", "density": "830 kg/m^3", "ambient_pressure": "1 bar", "cavitation_pressure": "1 bar"}


def in_film(*elements: dict[str, Any], **tables: object) -> frbcli.Case:
    bearings = [SHORT_FILM, *elements] if elements else SHORT_FILM
    data = {"rotor": JEFFCOTT, "bearing": bearings, "oil": OIL, "film": {"theory": "short"},
            "speed": speed(0.0, 300.0, 0.4)}  # fmt: skip
    return case_from_dict(data | tables, "film")


def test_a_seal_of_zero_coefficients_changes_nothing(tmp_path: Path) -> None:
    nothing = {"kind": "coefficients", "name": "seal", "stiffness": "0 N/m"}
    without, beside = (runup(case, tmp_path / f"{number}.h5") for number, case in
                       enumerate((in_film(), in_film(nothing))))  # fmt: skip
    assert without.status == beside.status == "finished"
    assert list(without.signals) == list(beside.signals)
    for name in without.signals:
        np.testing.assert_array_equal(np.array(without[name]), np.array(beside[name]))
    assert stability(in_film()).threshold == stability(in_film(nothing)).threshold


def test_a_seal_shifts_the_threshold_as_its_stiffness_in_the_matrices() -> None:
    """The same stiffness added by hand: twice, for a symmetric rotor has two bearings."""
    seal = {"kind": "coefficients", "name": "seal", "stiffness": matrix(2e5, 5e4, "N/m"), "damping": "50 N*s/m"}
    case, alone = in_film(seal), in_film()
    threshold, before = stability(case).threshold, stability(alone).threshold
    assert threshold is not None
    assert before is not None
    assert abs(threshold.speed_Hz / before.speed_Hz - 1.0) > 0.02
    place = dict(make_rotor(alone).points)["journal"]
    part = LinearPart(
        np.zeros(1), np.array([[[2e5, 5e4], [-5e4, 2e5]]]), 50.0 * np.eye(2)[None], np.zeros((1, 2, 2))
    )  # fmt: skip
    by_hand = make_rotor(alone)
    stiffness = by_hand.stiffness + 2.0 * place.T @ part.stiffness[0] @ place
    damping = by_hand.damping + 2.0 * place.T @ part.damping[0] @ place
    rotor = replace(by_hand, stiffness=stiffness, damping=damping)
    system = make_system(alone, make_plan(alone), rotor)
    for share, grows in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
        omega = share * TURN * threshold.speed_Hz
        films = resting_position(system, omega).films
        found = eigenvalues(
            rotor, omega, *(-np.array([getattr(film, name) for film in films]) for name in
                            ("by_displacement", "by_velocity"))
        )  # fmt: skip
        assert (found.real.max() > 0.0) == grows


CSV = """speed_Hz,kxx,kxy,kyx,kyy,cxx,cxy,cyx,cyy
50,1e6,1e5,-1e5,1e6,300,0,0,300
100,1.5e6,2e5,-2e5,1.5e6,250,0,0,250
"""


def with_file(folder: Path, name: str, **keys: object) -> frbcli.Case:
    rotor = {"kind": "rigid", "mass": "6 kg"}
    element = {"kind": "coefficients", "name": "seal", "file": name} | keys
    return case_from_dict({"rotor": rotor, "bearing": element, "speed": speed(10.0, 200.0)}, "rigid", folder)


def test_a_csv_is_linear_between_its_speeds_and_constant_beyond(tmp_path: Path) -> None:
    (tmp_path / "seal.csv").write_text(CSV)
    case = with_file(tmp_path, "seal.csv")
    rotor = make_rotor(case)
    for speed_Hz, k, q, c in ((10.0, 1e6, 1e5, 300.0), (75.0, 1.25e6, 1.5e5, 275.0), (500.0, 1.5e6, 2e5, 250.0)):
        here = rotor.at(TURN * speed_Hz)
        np.testing.assert_allclose(here.stiffness, 2.0 * np.array([[k, q], [-q, k]]), rtol=1e-12)
        np.testing.assert_allclose(here.damping, 2.0 * c * np.eye(2), rtol=1e-12)
    told = {d.value: d.reason for d in make_plan(case).decisions if d.choice == "bearings"}
    assert told["seal: given coefficients, over speed from seal.csv"].startswith("2 speeds, 50 to 100 Hz")
    (tmp_path / "seal.csv").unlink()  # the case has all of its numbers
    assert load_case_text(case.source_text, name="rigid") == case


@pytest.mark.parametrize(("column", "one"), [("speed_Hz", 1.0), ("speed_rpm", 60.0), ("speed_rad_s", TURN)])
def test_a_table_states_the_unit_of_its_speeds(column: str, one: float, tmp_path: Path) -> None:
    (tmp_path / "seal.csv").write_text(CSV.replace("speed_Hz", column).replace("50,1e6", f"{50 * one!r},1e6")
                                       .replace("100,1.5e6", f"{100 * one!r},1.5e6"))  # fmt: skip
    here = make_rotor(with_file(tmp_path, "seal.csv")).at(TURN * 75.0)
    np.testing.assert_allclose(here.stiffness, 2.0 * np.array([[1.25e6, 1.5e5], [-1.5e5, 1.25e6]]), rtol=1e-9)


@pytest.mark.parametrize("key", ["frequency", "speed"])
def test_a_table_of_ross_2_and_3_is_read(key: str, tmp_path: Path) -> None:
    """Their speeds are in rad/s."""
    lists = {"kxx": [1e6, 1.5e6], "kyy": [1e6, 1.5e6], "kxy": [1e5, 2e5], "kyx": [-1e5, -2e5],
             "cxx": [300.0, 250.0], "cyy": [300.0, 250.0], "cxy": [0.0, 0.0], "cyx": [0.0, 0.0],
             key: [50.0 * TURN, 100.0 * TURN]}  # fmt: skip
    rows = "".join(f"{name} = {values}\n" for name, values in lists.items())
    (tmp_path / "bearing.toml").write_text(f'["BearingElement_Bearing 0"]\nn = 0\n{rows}tag = "Bearing 0"\n')
    here = make_rotor(with_file(tmp_path, "bearing.toml")).at(TURN * 75.0)
    np.testing.assert_allclose(here.stiffness, 2.0 * np.array([[1.25e6, 1.5e5], [-1.5e5, 1.25e6]]), rtol=1e-9)


def test_the_file_of_a_bearing_sheet_and_a_csv_give_the_same(tmp_path: Path) -> None:
    from frbcli.linear.sheets.bearing import bearing_sheet
    from frbcli.results.export import write_ross

    sheet = bearing_sheet(in_film(), [40.0, 80.0, 120.0])
    frame = sheet.to_pandas()
    write_ross(frame, tmp_path / "bearing.toml")
    kinds = (("k", "stiffness", "N_m"), ("c", "damping", "N_s_m"))
    names = {f"{letter}{axes}": f"{kind}_{axes}_{unit}" for letter, kind, unit in kinds
             for axes in ("xx", "xy", "yx", "yy")}  # fmt: skip
    lines = [",".join(["speed_Hz", *names])]
    lines += [",".join(repr(float(row[c])) for c in ("speed_Hz", *names.values())) for _, row in frame.iterrows()]
    (tmp_path / "bearing.csv").write_text("\n".join(lines) + "\n")
    of_ross, of_table = (make_rotor(with_file(tmp_path, name)) for name in ("bearing.toml", "bearing.csv"))
    film = sheet.points[1]
    assert film.stiffness is not None
    np.testing.assert_allclose(of_ross.at(TURN * 80.0).stiffness, 2.0 * film.stiffness, rtol=1e-12)
    for speed_Hz in (0.0, 55.0, 80.0, 200.0):
        mine, other = of_ross.at(TURN * speed_Hz), of_table.at(TURN * speed_Hz)
        np.testing.assert_allclose(mine.stiffness, other.stiffness, rtol=1e-12)
        np.testing.assert_allclose(mine.damping, other.damping, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CSV.replace(",cyy", "").replace(",300\n", "\n").replace(",250\n", "\n"), "lacks cyy"),
        (CSV.replace("100,", "50,"), "do not ascend"),
        (CSV.replace("1.5e6,2e5", "nan,2e5"), "no finite number"),
        (CSV.replace("1.5e6,2e5", "1.5 MN/m,2e5"), "no number"),
        (CSV.replace("cxx", "damping"), "not known here"),
        (CSV.replace("100,1.5e6,", "100,"), "8 values in row 2"),
        (CSV.splitlines()[0], "0 speeds"),
        ("", "is empty"),
        (CSV.replace("cyy", "cyy,mxx,mxy,myx,myy").replace("0,300\n", "0,300,1,0,0,-1\n")
         .replace(",250\n", ",250,1,0,0,1\n"), "mass matrix at 50 Hz"),
        (CSV.replace("cyy", "cyy,mxx").replace(",300\n", ",300,1\n").replace(",250\n", ",250,1\n"), "lacks mxy"),
    ],
)  # fmt: skip
def test_a_table_that_cannot_be_used_is_one_fault(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "seal.csv").write_text(text)
    with pytest.raises(InputError) as caught:
        with_file(tmp_path, "seal.csv")
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("bearing.file", '"seal.csv"')
    assert words in fault.problem
    assert fault.remedy


def test_a_case_without_films_has_no_oil() -> None:
    with pytest.raises(InputError, match="oil"):
        _ = rigid(bearing()).oil


@pytest.mark.nightly  # 10 s; Hopf point and threshold: test_support.py
def test_limit_cycles_of_a_film_beside_an_element() -> None:
    """A seal that takes some of the damping away lowers the Hopf point to the threshold of stability."""
    seal = {"kind": "coefficients", "name": "seal", "stiffness": matrix(1e5, 5e4, "N/m")}
    case = in_film(seal, speed=speed(20.0, 320.0))
    threshold = stability(case).threshold
    assert threshold is not None
    found = frbcli.limit_cycles(in_film(seal, speed=speed(0.95 * threshold.speed_Hz, 1.02 * threshold.speed_Hz)))
    (hopf,) = [point for point in found.special if point.kind == "hopf"][:1]
    assert hopf.speed_Hz == pytest.approx(threshold.speed_Hz, rel=1e-6)
    assert any(len(branch.points) > 3 for branch in found.branches)
    growing = in_film(growing_seal(300.0), speed=speed(195.0, 200.0))
    threshold, found = stability(growing).threshold, frbcli.limit_cycles(growing)
    assert threshold is not None
    assert [point.speed_Hz for point in found.of("hopf")] == pytest.approx([threshold.speed_Hz], rel=1e-6)


def test_coefficients_can_be_swept(tmp_path: Path) -> None:
    case = in_film({"kind": "coefficients", "name": "seal", "stiffness": "0 N/m"}, speed=speed(20.0, 320.0))
    found = sweep(case, {"bearing.1.stiffness": ["0 N/m", "2e5 N/m"]}, tmp_path, "stability")
    frame = found.to_pandas()
    assert list(frame["status"]) == ["finished", "finished"]
    assert frame["threshold_speed_Hz"].nunique() == 2
    assert machine_fault("bearing.1.stiffness", "--key") is None
    assert coefficients_of(())[0].shape == (0, 2, 2)
