"""Housings out of rotor files of ROSS: point masses under its bearings, against ROSS, supports and closed forms.

Two equal masses m, each on a spring k to the ground and joined by another, k_c, have omega^2 = k / m, moving alike by
1/sqrt(2 m), and (k + 2 k_c) / m, moving against each other.
"""

import copy
import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paths import DATA
from series_rotors import HEAVY

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case_text
from frbcli.case.reading.settings import to_toml
from frbcli.case.surroundings import shape
from frbcli.errors import InputError
from frbcli.linear.response import response
from frbcli.linear.stability_point import eigenvalues
from frbcli.scene.machine.rotor import make_rotor

STEEL = {"name": "Steel", "rho": 7850.0, "E": 210e9, "G_s": 210e9 / 2.6}
SUPPORTS = tomllib.loads((DATA / "ross-supports.toml").read_text())
MILLIMETRES = ((25, 20), (33, 20), (22, 25), (105, 28), (39, 25))  # lengths and diameters of the shaft's elements
FEW = {"rotor": {"kind": "turbocharger", "modes": 6}}
FRONT, REAR = 6, 7  # nodes of the masses; 0 to 5 are those of the shaft


def bearing(tag: str, n: int, **values: Any) -> dict[str, Any]:
    coefficients = {key: [0.0] for key in ("kxy", "kyx", "cxy", "cyx", "mxx", "mxy", "myx", "myy")}
    return {f"BearingElement_{tag}": {"n": n, "tag": tag, **coefficients, **values}}


def rotor_file() -> dict[str, Any]:
    """As `Rotor.save` of ROSS 2.3.0 writes the rotor of ross-supports.toml, with one element for each section."""
    data: dict[str, Any] = {"ross_version": "2.3.0", "parameters": {}}
    for n, (length, diameter) in enumerate(MILLIMETRES):
        size = {"L": 1e-3 * length, "odl": 1e-3 * diameter, "odr": 1e-3 * diameter, "idl": 0.0, "idr": 0.0}
        data[f"ShaftElement_Shaft Element {n}"] = {"n": n, **size, "material": STEEL, "axial_force": 0, "torque": 0}
    for tag, n, mass, polar, diametral in (("compressor", 1, 1.0, 1.4e-3, 1e-3), ("turbine", 5, 4.0, 4.5e-3, 4e-3)):
        data[f"DiskElement_{tag}"] = {"n": n, "m": mass, "Ip": polar, "Id": diametral, "tag": tag}
    data |= bearing("front", 3, n_link=FRONT, kxx=[1.2e7], kyy=[1.5e7], cxx=[3e3], cyy=[4e3])
    data |= bearing("rear", 4, n_link=REAR, kxx=[2e7], kyy=[1.8e7], cxx=[5e3], cyy=[5e3])
    data |= bearing("under front", FRONT, kxx=[3e7], kyy=[5e7], cxx=[800], cyy=[500])
    data |= bearing("under rear", REAR, kxx=[8e7], kyy=[6e7], cxx=[1200], cyy=[1200])
    for tag, n, mass in (("one", FRONT, 3.0), ("other", REAR, 5.0)):
        data[f"PointMass_{tag}"] = {"n": n, "m": mass, "mx": mass, "my": mass, "mz": mass, "tag": tag}
    return data


def case_with(data: dict[str, Any], folder: Path, name: str = "rotor.toml", **tables: Any) -> frbcli.Case:
    text = json.dumps(data) if name.endswith("json") else "# written by ROSS\n\n" + to_toml(data)
    (folder / name).write_text(text, encoding="utf-8")
    return case_from_dict(HEAVY | {"housing": {"file": name}} | tables, "heavy", folder=folder)


def changed(element: str, **values: Any) -> dict[str, Any]:
    data = copy.deepcopy(rotor_file())
    data[element] = data.get(element, {}) | values
    return data


def own_values(case: frbcli.Case, speed_Hz: float) -> np.ndarray:
    """Eigenvalues with a positive frequency, ascending."""
    none = np.zeros((0, 2, 2))
    values = eigenvalues(make_rotor(case), 2.0 * math.pi * speed_Hz, none, none)
    found = values[values.imag > 1.0]
    return np.asarray(found[np.argsort(found.imag)])


def test_a_shaft_in_the_housing_of_its_ross_file_has_the_damped_modes_of_ross(tmp_path: Path) -> None:
    case = case_with(rotor_file(), tmp_path)
    expected = np.array(SUPPORTS["modes"]["1200"])
    found = own_values(case, 1200.0)[: len(expected)]
    np.testing.assert_allclose(found.imag / (2.0 * math.pi), expected[:, 0], rtol=1e-6)
    np.testing.assert_allclose(found.real, expected[:, 1], rtol=1e-5)


def test_masses_on_the_ground_are_supports(tmp_path: Path) -> None:
    """Eigenvalues, response, and the weight; the same from JSON, and without the file."""
    case = case_with(rotor_file(), tmp_path, **FEW)
    held = [each | {"support": one} for each, one in zip(HEAVY["bearing"], SUPPORTS["support"], strict=True)]  # type: ignore[call-overload]
    supported = case_from_dict(HEAVY | FEW | {"bearing": held}, "heavy")
    np.testing.assert_allclose(own_values(case, 400.0), own_values(supported, 400.0), rtol=1e-9)
    one, other = (response(each, [150.0, 700.0]) for each in (case, supported))
    for place, same in (("disk_turbine", "disk_turbine"), ("housing_rear", "support_rear")):
        motions = [each.motion[:, each.points.index(name)] for each, name in ((one, place), (other, same))]
        np.testing.assert_allclose(motions[0], motions[1], rtol=1e-9)
    sunk = []
    for each, place in ((case, "housing_rear"), (supported, "support_rear")):
        rotor = make_rotor(each)
        sunk.append(dict(rotor.points)[place] @ np.linalg.solve(rotor.stiffness, rotor.static_load))
    np.testing.assert_allclose(sunk[0], sunk[1], rtol=1e-9, atol=1e-15)
    assert case_with(rotor_file(), tmp_path, "rotor.json", **FEW).housing == case.housing
    (tmp_path / "rotor.toml").unlink()
    assert load_case_text(case.source_text, name="heavy") == case


def test_masses_that_are_joined_have_the_modes_of_the_closed_form(tmp_path: Path) -> None:
    """In x; also a third mass beside them, which has a place of its own, with dampers in proportion to the springs."""
    m, k, joined, beta = 4.0, 2e7, 5e6, 1e-4
    data = rotor_file() | bearing("joint", FRONT, n_link=REAR, kxx=[joined], kyy=[0.0], cxx=[beta * joined], cyy=[0.0])
    for tag, n in (("under front", FRONT), ("under rear", REAR)):
        data |= bearing(tag, n, kxx=[k], kyy=[k], cxx=[beta * k], cyy=[beta * k])
    for tag in ("one", "other"):
        data[f"PointMass_{tag}"] |= {"m": m, "mx": m, "my": m}
    housing = case_with(data, tmp_path).housing
    assert housing is not None
    in_x = [mode for mode in housing.modes if abs(shape(mode)["front"][0]) > 0.0]
    assert len(housing.modes) == 4
    for mode, square, sign in zip(in_x, (k / m, (k + 2.0 * joined) / m), (1.0, -1.0), strict=True):
        omega = 2.0 * math.pi * mode.frequency
        assert omega**2 == pytest.approx(square, rel=1e-12)
        assert mode.damping == pytest.approx(0.5 * beta * omega, rel=1e-9)
        front, rear = (np.array(shape(mode)[place]) for place in ("front", "rear"))
        np.testing.assert_allclose(np.abs(front), [1.0 / math.sqrt(2.0 * m), 0.0], rtol=1e-9)
        np.testing.assert_allclose(rear, sign * front, rtol=1e-9, atol=1e-15)
    beside = data | {"PointMass_foot": {"n": 8, "mx": 2.0, "my": 2.0}} | bearing("foot", 8, kxx=[k], cxx=[0.0])
    beside |= bearing("to foot", 8, n_link=REAR, kxx=[joined], cxx=[0.0])
    for tag in ("under front", "under rear", "joint"):
        beside[f"BearingElement_{tag}"] |= {"cxx": [0.0], "cyy": [0.0]}
    housing = case_with(beside, tmp_path).housing
    assert housing is not None
    assert {each.place: each.mass for each in housing.masses} == {"front": m, "rear": m, "PointMass-8": 2.0}


def test_a_bearing_on_the_ground_does_not_move_and_two_masses_have_no_weight(tmp_path: Path) -> None:
    """Masses of both directions that differ are no mass in kg: the modes stand without masses."""
    data = changed("PointMass_one", mx=2.0, my=4.0)
    del data["BearingElement_rear"]["n_link"]
    housing = case_with(data, tmp_path).housing
    assert housing is not None
    assert housing.masses == ()
    assert [shape(mode)["rear"] for mode in housing.modes] == [(0.0, 0.0)] * 2
    assert sorted(max(shape(mode)["front"]) for mode in housing.modes) == pytest.approx([0.5, 1.0 / math.sqrt(2.0)])


UNDER = "BearingElement_under front"
FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "no masses": ({k: v for k, v in rotor_file().items() if not k.startswith("PointMass")}, "has no PointMass: its"),
    "a mass of nothing": (changed("PointMass_one", mx=0.0), 'no mass in x or y in "PointMass_one"'),
    "a node without mass": (changed("BearingElement_front", n_link=9), "do not stand on one PointMass"),
    "a spring to nowhere": (changed(UNDER, n_link=9), "at node 9, which has no PointMass"),
    "over the frequency": (changed(UNDER, kxx=[1e7, 2e7], frequency=[0.0, 1.0]), "has a kxx over the frequency"),
    "cross-coupled": (changed(UNDER, kxy=[1e6], kyx=[-1e6]), "kxy and kyx"),
    "a bearing with mass": (changed(UNDER, mxx=[1.0]), "has a mass in"),
    "loose": (changed(UNDER, kxx=[0.0]), "that no spring holds"),
    "overdamped": (changed(UNDER, cxx=[1e5]), "of the critical one"),
    "no proportion": (
        changed(UNDER) | bearing("joint", FRONT, n_link=REAR, kxx=[1e7], cxx=[0.0]), "dampers that couple the modes",
    ),
    "no shaft": ({"PointMass_one": {"n": 6, "m": 1.0}}, "has no shaft elements"),
    "elsewhere": (changed("ShaftElement_Shaft Element 0", L=0.026), "no bearing at 80 mm, where the case has"),
    "text": (changed(UNDER, kxx=["stiff"]), 'lacks a number "kxx"'),
}  # fmt: skip


@pytest.mark.parametrize("given", FAULTS.values(), ids=FAULTS.keys())
def test_bad_files_are_one_fault(given: tuple[dict[str, Any], str], tmp_path: Path) -> None:
    data, problem = given
    with pytest.raises(InputError) as caught:
        case_with(data, tmp_path)
    (fault,) = caught.value.faults
    assert (fault.key, problem in fault.problem, bool(fault.remedy)) == ("housing.file", True, True), fault


def test_a_symmetric_rotor_has_no_such_housing(tmp_path: Path) -> None:
    held = {"kind": "coefficients", "stiffness": "1e6 N/m"}
    with pytest.raises(InputError, match="shaft of sections"):
        case_with(rotor_file(), tmp_path, rotor={"kind": "rigid", "mass": "1 kg"}, bearing=held, shaft=None, disk=None)


def test_a_rotor_file_with_masses_under_its_bearings_is_taken_with_what_carries_them(tmp_path: Path) -> None:
    both = HEAVY | {"rotor": {"kind": "turbocharger", "file": "rotor.toml"}, "shaft": None, "disk": None}
    case = case_with(rotor_file(), tmp_path, **both)
    assert [disk.mass for disk in case.disks] == [1.0, 4.0]
    assert case.housing is not None
    assert len(case.housing.modes) == 4
    with pytest.raises(InputError, match="which bearings stand on, and the case has no housing"):
        case_from_dict({name: table for name, table in both.items() if name != "housing"}, folder=tmp_path)
