"""Rotor files of ROSS: shaft and disks are taken, faults are named, and the case stays whole in itself."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.reading.ross import RossElement, _rotor
from frbcli.case.reading.settings import to_toml
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.linear.modes import natural_modes
from frbcli.linear.stability import stability

STEEL = {"name": "Steel", "rho": 7810.0, "E": 211e9, "G_s": 81.2e9, "color": "#525252"}

CASE = """
[rotor]
kind = "turbocharger"
file = "rotor.toml"
[[disk]]
name = "Disk-1"
unbalance = "2 g*mm"
phase = "90 deg"
[[disk]]
name = "nut"
position = "0 mm"
mass = "0.1 kg"
[[bearing]]
kind = "single-film"
position = "50 mm"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
[[bearing]]
kind = "single-film"
position = "150 mm"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
[oil]
viscosity = "12 mPa*s"
[speed]
from = "0 Hz"
to = "300 Hz"
duration = "1 s"
"""


def shaft(n: int, length: float = 0.05, **other: Any) -> dict[str, Any]:
    values = {"L": length, "idl": 0.0, "odl": 0.02, "idr": 0.0, "odr": 0.02, "n": n, "axial_force": 0, "torque": 0,
              "shear_effects": True, "rotary_inertia": True, "gyroscopic": True, "shear_method_calc": "cowper",
              "tag": f"ShaftElement {n}", "material": STEEL}  # fmt: skip
    return {**values, **other}


def disk(number: int, node: int, mass: float = 1.0) -> dict[str, Any]:
    return {"n": node, "m": mass, "Id": 1e-3, "Ip": 1.5e-3, "tag": f"Disk {number}", "scale_factor": 1.0,
            "color": "Firebrick"}  # fmt: skip


def rotor_file() -> dict[str, Any]:
    """Four elements, the third a tube, the last a cone; two disks; a bearing."""
    elements = [shaft(0), shaft(1), shaft(2, idl=0.01, idr=0.01), shaft(3, odl=0.02, odr=0.03)]
    data: dict[str, Any] = {"ross_version": "2.3.0", "parameters": {}}
    data |= {f"ShaftElement_{element['tag']}": element for element in elements}
    data |= {"DiskElement_Disk 0": disk(0, 0), "DiskElement_Disk 1": disk(1, 4, 2.0)}
    return data | {"BearingElement_Bearing 0": {"n": 1, "kxx": [1e6], "cxx": [0.0], "tag": "Bearing 0"}}


def case_with(data: dict[str, Any], folder: Path, text: str = CASE) -> Case:
    (folder / "rotor.toml").write_text("# written by ROSS\n\n" + to_toml(data), encoding="utf-8")
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return load_case(folder / "case.toml")


def fault_of(data: dict[str, Any], folder: Path) -> Fault:
    with pytest.raises(InputError) as caught:
        case_with(data, folder)
    return next(fault for fault in caught.value.faults if fault.key == "rotor.file")


def test_shaft_and_disks(tmp_path: Path) -> None:
    case = case_with(rotor_file(), tmp_path)
    cone = case.shaft[2:]
    assert [round(part.length, 6) for part in case.shaft[:2]] == [0.1, 0.05]  # equal neighbours are one
    assert sum(part.length for part in cone) == pytest.approx(0.05)
    assert [part.inner_diameter for part in case.shaft] == [0.0, 0.01, *[0.0] * len(cone)]
    ends = 0.02 + 0.01 * (np.arange(len(cone)) + 0.5) / len(cone)
    assert [part.diameter for part in cone] == pytest.approx(ends)
    assert max(np.diff(ends) / ends[:-1]) < 0.025
    first = case.shaft[0]
    assert (first.density, first.youngs_modulus) == (7810.0, 211e9)
    assert first.poisson_ratio == pytest.approx(211 / (2 * 81.2) - 1)
    assert [(d.name, d.mass, round(d.position, 9)) for d in case.disks] == [
        ("Disk-1", 2.0, 0.2), ("nut", 0.1, 0.0), ("Disk-0", 1.0, 0.0)
    ]  # fmt: skip
    assert (case.disks[0].polar_inertia, case.disks[0].diametral_inertia) == (1.5e-3, 1e-3)
    assert (case.disks[0].unbalance, case.disks[0].phase) == pytest.approx((2e-6, math.pi / 2))


def test_cylinders_of_a_cone_keep_its_mass(tmp_path: Path) -> None:
    case = case_with(rotor_file(), tmp_path)
    cone = math.pi / 12 * 0.05 * (0.02**2 + 0.02 * 0.03 + 0.03**2) * 7810.0
    mass = sum(math.pi / 4 * part.diameter**2 * part.length * part.density for part in case.shaft[2:])
    assert mass == pytest.approx(cone, rel=2e-4)


def test_case_is_whole_without_the_file(tmp_path: Path) -> None:
    case = case_with(rotor_file(), tmp_path)
    (tmp_path / "rotor.toml").unlink()
    assert "rotor.toml" not in case.source_text
    assert load_case_text(case.source_text) == case
    assert not [value.key for value in values(case) if value.bare]  # what the file has in SI has its unit there


def test_json_is_the_same_and_settings_reach_the_file_name(tmp_path: Path) -> None:
    data = rotor_file()
    (tmp_path / "other.json").write_text(json.dumps({"_note": "by ROSS", **data}))
    case = case_with(data, tmp_path)
    assert load_case(tmp_path / "case.toml", ["rotor.file=other.json"]) == case
    assert load_case_text(CASE, ["rotor.file=other.json"], folder=tmp_path, name="case") == case


def test_published_frequencies_of_the_example_rotor_of_ross(tmp_path: Path) -> None:
    """Its documentation: 91.79655318 and 96.28899977 rad/s at rest, in planes with bearings of 0.8e6 and 1e6 N/m."""
    inertias = {"m": 32.58972765, "Id": 0.17808928, "Ip": 0.32956362}
    data: dict[str, Any] = {f"ShaftElement_{n}": shaft(n, 0.25, odl=0.05, odr=0.05) for n in range(6)}
    data |= {f"DiskElement_Disk {n}": {**disk(n, 2 + 2 * n), **inertias} for n in range(2)}
    ends = CASE.replace('"50 mm"', '"0 m"').replace('"150 mm"', '"1.5 m"')
    nut = CASE[CASE.index('[[disk]]\nname = "nut"') : CASE.index("[[bearing]]")]
    case = case_with(data, tmp_path, ends.replace(nut, ""))
    for stiffness, printed in ((0.8e6, 91.79655318), (1e6, 96.28899977)):
        slowest = natural_modes(case, stiffness, [0.0]).points[0].modes[0]
        assert 2 * math.pi * slowest.frequency_Hz == pytest.approx(printed, rel=5e-6)


@pytest.mark.parametrize("inner", [0.0, 0.01])
def test_one_cone_is_the_shaft_of_many_short_ones(inner: float, tmp_path: Path) -> None:
    """60 to 20 mm over 300 mm as one element and as sixty: natural frequencies differ by less than 2e-4."""
    found = []
    for parts in (1, 60):
        data: dict[str, Any] = {"ShaftElement_0": shaft(0, 0.3, idl=inner, idr=inner, odl=0.06, odr=0.06)}
        for k in range(parts):
            left, right = (0.06 - 0.04 * at / parts for at in (k, k + 1))
            data[f"ShaftElement_{k + 1}"] = shaft(k + 1, 0.3 / parts, idl=inner, idr=inner, odl=left, odr=right)
        data["DiskElement_Disk 1"] = disk(1, parts + 1, 10.0)
        case = case_with(data, tmp_path)
        found.append([mode.frequency_Hz for mode in natural_modes(case, 1e8, [0.0]).points[0].modes[:6]])
    assert found[0] == pytest.approx(found[1], rel=2e-4)


def least(stiffness: float, parts: int, **dampings: float) -> list[complex]:
    """Slowest eigenvalue of each mode at rest: a shaft of 60 mm, 10 kg at its end, bearings at 0 and 0.5 m."""
    data = {f"ShaftElement_{n}": shaft(n, 0.8 / parts, odl=0.06, odr=0.06, **dampings) for n in range(parts)}
    data["DiskElement_Disk 1"] = disk(1, parts, 10.0) | {"Id": 0.02, "Ip": 0.04}
    places = [{"position": place, "name": name} for name, place in (("l", "0 m"), ("r", "0.5 m"))]
    sections, disks = _rotor([RossElement(name, name.split("_")[0], each) for name, each in data.items()], False)
    held = {"kind": "coefficients", "stiffness": f"{stiffness} N/m", "damping": "100 N*s/m"}
    case = case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "gravity": 0, "modes": 16},
            "shaft": sections,
            "disk": disks,
            "bearing": [held | place for place in places],
            "speed": {"from": "0 Hz", "to": "100 Hz", "duration": "1 s"},
        },
        "damped",
    )
    values = stability(case, [0.01]).points[0].eigenvalues
    turning = sorted((each for each in values.tolist() if each.imag > 1.0), key=abs)
    return turning[::2]


@pytest.mark.parametrize(("alpha", "beta"), [(20.0, 1e-4), (20.0, 0.0), (0.0, 1e-4)])
def test_alpha_and_beta_damp_the_shaft_and_not_the_disk(alpha: float, beta: float) -> None:
    """Growth rates fall by beta w^2 / 2 of a mode that bends, and by a share of alpha / 2 for the disk has none. ROSS
    has -23.2 and -631 1/s for both; its three elements have the second mode 0.5 % too fast."""
    free, damped = (least(1e9, 8, **each) for each in ({}, {"alpha": alpha, "beta": beta}))
    expected = {(20.0, 1e-4): (-23.2, -631.0)}.get((alpha, beta))
    if expected:
        assert damped[0].real == pytest.approx(expected[0], abs=0.05)
        assert damped[1].real == pytest.approx(expected[1], rel=8e-3)
    bent = beta * abs(free[0]) ** 2 / 2.0
    assert free[0].real > -1e-3
    assert -bent - alpha / 2.0 < damped[0].real < -0.98 * bent - 0.01 * alpha
    assert damped[0].imag == pytest.approx(free[0].imag, rel=2e-3)


def test_mass_damping_acts_on_a_rigid_rotor_and_stiffness_damping_does_not() -> None:
    """On soft springs, whose own damping is what is left without both."""
    none, of_mass, of_stiffness = (least(1e3, 4, **each) for each in ({}, {"alpha": 8.0}, {"beta": 1e-5}))
    assert of_stiffness[0].real == pytest.approx(none[0].real, rel=1e-6)
    assert none[0].real - 4.0 < of_mass[0].real < none[0].real - 0.5


def _change(element: str, **values: Any) -> dict[str, Any]:
    data = rotor_file()
    data[element] |= values
    return data


# Keys of the elements of ROSS 2.3 and 3 that have an effect there and are not modelled
REFUSED = {"torque": 5.0, "shear_effects": False, "rotary_inertia": False, "gyroscopic": False,
           "shear_method_calc": "hutchinson", "a_key_of_later": 1.0}  # fmt: skip


CHANGED: list[tuple[dict[str, Any], str]] = [
    (_change("ShaftElement_ShaftElement 1", n=2), "where the element from node 1 belongs"),
    (_change("ShaftElement_ShaftElement 1", axial_force=10.0), "axial_force"),
    *((_change("ShaftElement_ShaftElement 1", **{key: value}), key) for key, value in REFUSED.items()),
    (_change("ShaftElement_ShaftElement 1", L="long"), 'a number "L"'),
    (_change("ShaftElement_ShaftElement 1", material="Steel"), '"E" in "ShaftElement_ShaftElement 1.material"'),
    (_change("ShaftElement_ShaftElement 0", L=True), 'a number "L"'),
    (_change("DiskElement_Disk 0", n=9), "beyond the shaft"),
    (_change("ShaftElement_ShaftElement 1", L=10**400), "no finite number"),
    (_change("ShaftElement_ShaftElement 1", odl=math.nan), "no finite number"),
    (_change("ShaftElement_ShaftElement 1", alpha=-1.0), '"alpha" in "ShaftElement_ShaftElement 1" that is -1 1/s'),
    (_change("ShaftElement_ShaftElement 1", beta="much"), 'a number "beta"'),
    (_change("ShaftElement_ShaftElement 1", odl=-0.02), '"odl" in "ShaftElement_ShaftElement 1" that is -20 mm'),
    (_change("ShaftElement_ShaftElement 2", idr=0.03), "no thickness"),
    (_change("ShaftElement_ShaftElement 1", material={**STEEL, "E": 0.0, "G_s": 0.0}), '"E" in'),
    (_change("ShaftElement_ShaftElement 1", material={**STEEL, "G_s": 211e9}), "Poisson ratio of -0.5"),
    (_change("ShaftElement_ShaftElement 1", material={**STEEL, "rho": 0.0}), '"rho" in'),
    (_change("DiskElement_Disk 0", m=0.0), '"m" in "DiskElement_Disk 0" that is 0 kg'),
    (_change("DiskElement_Disk 0", Ip=1.0), "more than twice Id"),
    ({**rotor_file(), "PointMass_Point 0": {"n": 5, "m": 1.0}}, "the case has no housing and no supports"),
    ({**rotor_file(), "PointMass_Point 0": {"n": 4, "m": 1.0}}, "on the shaft, which has disks"),
    ({**rotor_file(), "GearElement_Gear 0": {"n": 1, "m": 1.0}}, "does not model"),
    ({"parameters": {}}, "no shaft elements"),
]


@pytest.mark.parametrize(("data", "problem"), CHANGED, ids=[problem for _, problem in CHANGED])
def test_faults_of_a_file(data: dict[str, Any], problem: str, tmp_path: Path) -> None:
    fault = fault_of(data, tmp_path)
    assert problem in fault.problem
    assert (fault.value, fault.line) == ('"rotor.toml"', 4)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"{", "neither"), (b"\xff\xfe", "no UTF-8 text"), (b"a = 1" + b"0" * 5000, "neither"), (None, "names no file"),
        (b"x = 1\n" + b"a." * 250_000 + b"b = 1", "key with too many dots"),  # took forty seconds
        (b"[" + b"a." * 250_000 + b"b]", "key with too many dots"),
        (b"a = " + b"[" * 50_000, "nested too deeply"),
    ],
    ids=["open", "bytes", "digits", "none", "dotted", "header", "nested"],
)  # fmt: skip
def test_files_that_hold_no_rotor(content: bytes | None, problem: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "rotor.toml").write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_case_text(CASE, folder=tmp_path)
    assert {fault.key: fault.problem for fault in caught.value.faults}["rotor.file"].startswith(("is", "names"))
    assert problem in str(caught.value)
    assert len(caught.value.faults) == 1  # neither the shaft nor the masses that the file would have


def test_not_beside_sections(tmp_path: Path) -> None:
    (tmp_path / "rotor.toml").write_text(to_toml(rotor_file()))
    text = CASE.replace("[oil]", '[[shaft]]\nlength = "1 m"\ndiameter = "10 mm"\n[oil]')
    with pytest.raises(InputError, match=r"given with \[\[shaft\]\]"):
        load_case_text(text, folder=tmp_path)


def test_own_disk_needs_its_mass_if_the_file_has_none_of_its_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"disk\.0\.mass"):
        case_with(rotor_file(), tmp_path, CASE.replace("Disk-1", "Disk-7"))
