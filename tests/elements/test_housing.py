"""Housings: closed forms of masses in series, a rigid body against its modes, faults. With impedances Z = K + s C + s^2
M, links in series have 1 / Z = 1 / Z_1 + 1 / Z_2; a symmetric rotor has two of each bearing, and one housing. Housings
out of rotor files of ROSS: point masses under its bearings, against ROSS, supports and closed forms. Two equal masses
m, each on a spring k to the ground and joined by another, k_c, have omega^2 = k / m, moving alike by 1/sqrt(2 m), and
(k + 2 k_c) / m, moving against each other."""

import copy
import json
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paths import DATA
from scipy.linalg import eigh
from series_rotors import HEAVY, assert_eigenvalues, in_series

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.reading.settings import to_toml
from frbcli.case.surroundings import shape
from frbcli.errors import InputError
from frbcli.linear.modes import critical_map, natural_modes
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.linear.stability_point import eigenvalues
from frbcli.report.sketch import WIDTH, rotor_sketch
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.plan import make_plan

G, M, U = 9.81, 6.0, 3e-6  # m/s^2, kg, kg m
K, C = 1e6, 300.0  # N/m, N s/m of one bearing
HOUSING, SPRINGS, DAMPERS = 40.0, (8e6, 5e6), (400.0, 250.0)  # kg; N/m and N s/m in x and y of the one mount
SPEED = {"from": "10 Hz", "to": "200 Hz", "duration": "1 s"}
JEFFCOTT = {
    "kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m",
    "unbalance": "3e-6 kg*m", "external_damping": "1 N*s/m", "shaft_damping": "0.1 N*s/m",
}  # fmt: skip
RIGID = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{U!r} kg*m"}
BODY = {
    "mass": f"{HOUSING} kg",
    "mounts": [{"stiffness": [f"{k!r} N/m" for k in SPRINGS], "damping": [f"{c!r} N*s/m" for c in DAMPERS]}],
}


def in_housing(rotor: dict[str, Any], housing: dict[str, Any] | None = None, **bearing: object) -> frbcli.Case:
    """A symmetric rotor in bearings of given coefficients in a housing."""
    given = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m"} | bearing
    data = {"rotor": rotor, "bearing": given, "housing": BODY if housing is None else housing, "speed": SPEED}
    return case_from_dict(data, "in-housing")


def bearing_impedance(s: Any) -> Any:
    return 2.0 * (K + s * C)


def housing_impedance(s: Any, axis: int) -> Any:
    return SPRINGS[axis] + s * DAMPERS[axis] + s**2 * HOUSING


def test_eigenvalues_of_a_rigid_rotor_in_a_housing_are_the_roots_of_the_closed_form() -> None:
    bodies = [[HOUSING, DAMPERS[axis], SPRINGS[axis]] for axis in (0, 1)]
    assert_eigenvalues(in_housing(RIGID), M, [2 * C, 2 * K], bodies)


def test_the_response_of_a_jeffcott_rotor_in_a_housing_is_the_closed_form() -> None:
    """Housing, bearing, journal, shaft and disk in series and beside each other."""
    found = response(in_housing(JEFFCOTT), [20.0, 90.0, 150.0])
    assert found.points == ("journal", "disk", "housing")
    named = dict(zip(found.points, np.moveaxis(found.motion, 1, 0), strict=True))
    s = 2j * math.pi * found.speeds_Hz
    shaft = 5e6 + 0.1 * s
    for axis, pull in enumerate((1.0j, 1.0)):
        bearing, housing = bearing_impedance(s), housing_impedance(s, axis)
        journal = 0.1 * s**2 + in_series(bearing, housing)
        disk = -(s**2) * U * pull / (6.0 * s**2 + 1.0 * s + in_series(shaft, journal))
        moved = disk * shaft / (shaft + journal)
        np.testing.assert_allclose(named["disk"][:, axis], disk, rtol=1e-9)
        np.testing.assert_allclose(named["journal"][:, axis], moved, rtol=1e-9)
        np.testing.assert_allclose(named["housing"][:, axis], moved * bearing / (bearing + housing), rtol=1e-9)


def test_supports_stand_in_the_housing() -> None:
    """Rotor, bearing, shell, support, housing, mount and ground follow each other."""
    found = response(in_housing(RIGID, support={"mass": "2 kg", "stiffness": "4e6 N/m"}), [20.0, 90.0, 150.0])
    assert found.points == ("journal", "support", "housing")
    s = 2j * math.pi * found.speeds_Hz
    for axis, pull in enumerate((1.0j, 1.0)):
        shell = 2.0 * 2.0 * s**2 + in_series(2.0 * 4e6, housing_impedance(s, axis))
        rotor = -(s**2) * U * pull / (M * s**2 + in_series(bearing_impedance(s), shell))
        np.testing.assert_allclose(found.motion[:, 0, axis], rotor, rtol=1e-9)


def test_the_mount_carries_the_weight_of_all() -> None:
    case = in_housing(RIGID)
    (point,) = stability(case, [80.0]).points
    assert point.rests
    rotor = make_rotor(case)
    sunk = dict(rotor.points)["housing"] @ np.linalg.solve(rotor.stiffness, rotor.static_load)
    np.testing.assert_allclose(sunk, [0.0, -(M + HOUSING) * G / SPRINGS[1]], rtol=1e-9, atol=1e-15)


# ------------------------------------------------------------------------------------- a turbocharger in its housing

BEARINGS = {"left": 0.05, "right": 0.15}  # m
CENTRE, INERTIA = 0.11, (0.3, 0.2)  # m; kg m^2 of the planes x z and y z
MOUNTS = ((0.0, (2e7, 3e7)), (0.25, (1e7, 2.5e7)))  # m, N/m
SHAFT = {
    "rotor": {"kind": "turbocharger", "modes": 4, "gravity": "9.81 m/s^2"},
    "shaft": [{"length": "200 mm", "diameter": "20 mm", "density": "7850 kg/m^3", "youngs_modulus": "210 GPa"}],
    "disk": [{"name": "wheel", "position": "200 mm", "mass": "1.5 kg", "polar_inertia": "1000 kg*mm^2",
              "diametral_inertia": "700 kg*mm^2", "unbalance": "2 g*mm"}],
    "bearing": [{"kind": "coefficients", "name": name, "position": f"{place!r} m", "stiffness": f"{K!r} N/m",
                 "damping": f"{C!r} N*s/m"} for name, place in BEARINGS.items()],
    "speed": SPEED,
}  # fmt: skip
STEADY_RATIO = 1e-4  # s: damping over stiffness of the mounts, so that the modes stay apart


def mounted() -> dict[str, Any]:
    mounts = [
        {"position": f"{z!r} m", "stiffness": [f"{k!r} N/m" for k in both],
         "damping": [f"{STEADY_RATIO * k!r} N*s/m" for k in both]}
        for z, both in MOUNTS
    ]  # fmt: skip
    inertia = [f"{value!r} kg*m^2" for value in INERTIA]
    return {"mass": f"{HOUSING} kg", "inertia": inertia, "position": f"{CENTRE!r} m", "mounts": mounts}


def own_modes() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(4,) frequencies in rad/s of the housing, and (4, 2) displacements of both bearings, of unit modal mass: each
    plane by itself, with its displacement and its slope."""
    frequencies, left, right = [], [], []
    for axis in (0, 1):
        mass = np.diag([HOUSING, INERTIA[axis]])
        arms = [np.array([1.0, z - CENTRE]) for z, _ in MOUNTS]
        stiffness = sum(both[axis] * np.outer(arm, arm) for arm, (_, both) in zip(arms, MOUNTS, strict=True))
        squares, vectors = eigh(stiffness, mass)
        frequencies += np.sqrt(squares).tolist()
        for vector in vectors.T:
            for found, place in zip((left, right), BEARINGS.values(), strict=True):
                found.append(np.eye(2)[axis] * (vector @ [1.0, place - CENTRE]))
    return np.array(frequencies), np.array(left), np.array(right)


def by_modes() -> dict[str, Any]:
    modes = [
        {"frequency": f"{float(omega) / (2 * math.pi)!r} Hz", "damping": 0.5 * STEADY_RATIO * float(omega),
         "at": {"left": left.tolist(), "right": right.tolist()}}
        for omega, left, right in zip(*own_modes(), strict=True)
    ]  # fmt: skip
    return {"modes": modes}


def test_modes_of_a_housing_are_those_of_the_body_that_has_them() -> None:
    """Eigenvalues of the machine, response at all points, without the weight, which modes do not tell."""
    rigid, modal = (
        case_from_dict(SHAFT | {"housing": housing}).with_settings("rotor.gravity=0 m/s^2")
        for housing in (mounted(), by_modes())
    )
    one, other = (stability(case, [150.0]).points[0].eigenvalues for case in (rigid, modal))
    assert len(one) == len(other) == 2 * (8 + 4)
    for value in one:
        assert np.abs(other - value).min() < 1e-9 * abs(value)
    found = [response(case, [40.0, 150.0]) for case in (rigid, modal)]
    for name in ("journal_left", "disk_wheel", "housing_left", "housing_right"):
        motions = [each.motion[:, each.points.index(name)] for each in found]
        np.testing.assert_allclose(motions[0], motions[1], rtol=1e-9, err_msg=name)


def test_modes_with_masses_are_orthonormal_and_have_the_weight() -> None:
    """Two lumps on springs: a mode each, 1/sqrt(m) at its lump."""
    modes = [{"frequency": f"{80.0 + 10.0 * i + 5.0 * axis} Hz",
              "at": {"left": [0.0, 0.0], "right": [0.0, 0.0], name: (np.eye(2)[axis] / math.sqrt(mass)).tolist()}}
             for i, (name, mass) in enumerate({"left": 4.0, "right": 9.0}.items()) for axis in (0, 1)]  # fmt: skip
    case = case_from_dict(SHAFT | {"housing": {"modes": modes, "masses": {"left": "4 kg", "right": "9 kg"}}})
    np.testing.assert_allclose(make_rotor(case).static_load[-4:], [0.0, -2.0 * G, 0.0, -3.0 * G], rtol=1e-12)
    assert load_case_text(case.source_text, name=case.name) == case
    with pytest.raises(InputError, match="instead of 1"):
        case.with_settings({"housing.masses": {"left": "5 kg", "right": "9 kg"}})
    turned = [*modes[:3], modes[3] | {"at": {"left": [0.0, 0.0], "right": [0.2, 0.2]}}]
    with pytest.raises(InputError, match="with mode 3"):
        case.with_settings({"housing.modes": turned})


# ------------------------------------------------------------------------------------------------- a table of modes

TABLE = """frequency_Hz,damping,left_x,left_y,right_x,right_y
80,0.02,0.5,0,0,0
85.3,0.01,0,0.5,0,0
91,0,0,0,0.3333333333333333,0
99.7,0.03,0,0,0,0.3333333333333333
"""
LUMPS = {"left": "4 kg", "right": "9 kg"}


def from_table(folder: Path, text: str, **keys: object) -> frbcli.Case:
    (folder / "modes.csv").write_text(text, encoding="utf-8")
    return case_from_dict(SHAFT | {"housing": {"file": "modes.csv", **keys}}, "table", folder=folder)


def test_modes_out_of_a_table_are_those_that_stand_in_the_case(tmp_path: Path) -> None:
    """Bit for bit: matrices, eigenvalues and a run, also of the case that the run keeps."""
    rows = [line.split(",") for line in TABLE.splitlines()[1:]]
    modes = [{"frequency": f"{row[0]} Hz", "damping": float(row[1]),
              "at": {"left": [float(each) for each in row[2:4]], "right": [float(each) for each in row[4:]]}}
             for row in rows]  # fmt: skip
    inline = case_from_dict(SHAFT | {"housing": {"modes": modes, "masses": LUMPS}}, "table")
    table = from_table(tmp_path, TABLE, masses=LUMPS)
    assert table.same_run(inline)
    for one, other in zip(stability(inline, [80.0]).points, stability(table, [80.0]).points, strict=True):
        np.testing.assert_array_equal(other.eigenvalues, one.eigenvalues)
    short = {"speed.duration": "20 ms"}
    runs = [runup(case.with_settings(short), tmp_path / f"{i}.h5") for i, case in enumerate((inline, table))]
    for name in runs[0].signals:
        np.testing.assert_array_equal(runs[1][name], runs[0][name], strict=True)
    assert load_case_text(table.source_text, name="table") == table


BAD_TABLES = {
    "orthonormal": (TABLE.replace("91,0,0,0,0.33", "91,0,0,0,0.4"), {"masses": LUMPS}, "instead of 1"),
    "half a place": (TABLE.replace(",right_y", ""), {}, "has 6 values in row 1"),
    "no y": ("frequency_Hz,left_x,right_x\n80,1,1\n", {}, "lacks left_y, right_y"),
    "no frequency": (TABLE.replace("frequency_Hz", "mode"), {}, "lacks frequency_Hz"),
    "unknown column": (TABLE.replace("damping", "zeta"), {}, '"zeta", which is not known'),
    "twice": (TABLE.replace("left_y", "left_x"), {}, '"left_x" twice'),
    "no number": (TABLE.replace("85.3", "nan"), {}, "no finite number"),
    "no rows": (TABLE.splitlines()[0], {}, "has 0 modes"),
    "empty": ("", {}, "is empty"),
    "beside modes": (TABLE, {"modes": [{"frequency": "80 Hz", "at": {"left": [1.0, 0.0], "right": [0.0, 0.0]}}]},
                     "with modes"),
    "a bearing left out": ("frequency_Hz,left_x,left_y\n80,1,0\n", {}, "no displacement at right"),
    "beside a rigid housing": (TABLE, {"mass": "3 kg"}, "with modes"),
}  # fmt: skip


@pytest.mark.parametrize("given", BAD_TABLES.values(), ids=BAD_TABLES.keys())
def test_bad_tables_of_modes_are_one_fault(given: tuple[str, dict[str, Any], str], tmp_path: Path) -> None:
    text, keys, problem = given
    with pytest.raises(InputError) as caught:
        from_table(tmp_path, text, **keys)
    (fault,) = caught.value.faults
    assert problem in fault.problem
    assert fault.remedy


# ---------------------------------------------------------------------------------------------------------- in runs


def test_a_run_in_an_elastic_housing_has_the_motion_of_the_response(tmp_path: Path) -> None:
    modes = [{"frequency": f"{value} Hz", "damping": 0.2, "at": {"bearing": at}}
             for value, at in ((90.0, [0.3, 0.1]), (110.0, [-0.1, 0.25]))]  # fmt: skip
    case = in_housing(JEFFCOTT, {"modes": modes}, damping="3000 N*s/m").with_settings(
        {"speed.from": "60 Hz", "speed.to": "60 Hz", "speed.duration": "1 s", "start.position": "resting",
         "accuracy.tolerance": 1e-7}
    )  # fmt: skip
    found, run = response(case, [60.0]), runup(case, tmp_path / "run.h5")
    late = run["time_s"] >= run.t_end_s - 10.0 / 60.0
    turn = np.exp(2j * math.pi * 60.0 * run["time_s"][late])
    columns = np.column_stack([np.ones(len(turn)), turn.real, -turn.imag])
    for number, name in enumerate(found.points):
        for axis, letter in enumerate("xy"):
            _, real, imaginary = np.linalg.lstsq(columns, run[f"{name}_{letter}_m"][late], rcond=None)[0]
            amplitude = real + 1j * imaginary
            assert abs(amplitude - found.motion[0, number, axis]) < 1e-3 * abs(found.motion[0, number, axis]), name


def test_forces_on_the_housing() -> None:
    """One, also with a symmetric rotor, whose housing is one."""
    plain = in_housing(RIGID)
    pushed = plain.with_settings({"force": [{"at": "housing", "force": ["10 N", "20 N"]}]})
    moved = make_rotor(pushed).static_load - make_rotor(plain).static_load
    np.testing.assert_allclose(moved, [0.0, 0.0, 10.0, 20.0])


def test_the_sketch_has_forces_on_the_housing_at_it() -> None:
    """Above the bar of the housing and within the drawing, also at the place of a bearing."""
    push = {"force": [{"at": "housing", "force": ["1 N", "0 N"]}]}
    both = {"force": [*push["force"], {"at": "housing_left", "force": ["1 N", "0 N"]}]}
    for case, numbers in ((in_housing(RIGID).with_settings(push), 1),
                          (case_from_dict(SHAFT | {"housing": mounted()} | both), 2)):  # fmt: skip
        sketch = rotor_sketch(case)[0]
        bar = min(float(y) for y in re.findall(r'<rect x="[\d.]+" y="([\d.]+)" [^>]*class="shell"', sketch))
        found = [float(y) for y in re.findall(r'y="([\d.]+)"[^>]*>F\d<', sketch)]
        assert len(found) == numbers
        assert all(0.0 < y < bar for y in found)


def test_plan_and_sketch_show_the_housing() -> None:
    for case, value, grounds in (
        (in_housing(RIGID), "40 kg on one mount", 4),
        (case_from_dict(SHAFT | {"housing": mounted()}), "40 kg on 2 mounts", 4),
        (case_from_dict(SHAFT | {"housing": by_modes()}), "4 modes", 2),
    ):
        assert [each.value for each in make_plan(case).decisions if each.choice == "housing"] == [value]
        sketch = rotor_sketch(case)[0]
        assert sketch.count('class="ground"') == grounds  # bearings stand in the housing, and that on the ground
        boxes = re.findall(r'<rect x="([\d.]+)" y="[\d.]+" width="([\d.]+)"', sketch)
        assert all(0.0 <= float(x) <= float(x) + float(width) <= WIDTH for x, width in boxes)
        assert load_case_text(case.source_text, name=case.name) == case


def test_analyses_of_a_rotor_on_the_ground_refuse_a_housing() -> None:
    heavy = load_case("turbocharger-heavy").with_settings({"housing": mounted()})
    for analysis in (lambda: critical_map(heavy), lambda: natural_modes(heavy, 1e7)):
        with pytest.raises(InputError) as caught:
            analysis()
        assert caught.value.faults[0].key == "housing"


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
