"""Motion of the ground: closed forms of the transmissibility, equal ways to say the same, runs, and faults.

Displacements q are those against the ground, which moves by u = -a / omega^2 with the acceleration a.
"""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.linear.response import response
from frbcli.plot.waterfall import load_lines
from frbcli.report.sketch import rotor_sketch
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor

M, K, C, G = 6.0, 1e6, 300.0, 9.81  # kg; N/m and N s/m of one bearing; m/s^2
SHELL, SPRING, DAMPER = 1.5, 4e6, 200.0  # of one support
RIGID = {"kind": "rigid", "mass": f"{M} kg", "gravity": 0.0}
JEFFCOTT = {"kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m"}
BEARING = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m"}
SUPPORT = {"mass": f"{SHELL} kg", "stiffness": f"{SPRING!r} N/m", "damping": f"{DAMPER!r} N*s/m"}
MODES = {"modes": [{"frequency": "90 Hz", "damping": 0.02, "at": {"bearing": [0.0, 0.5]}}]}
SPEED = {"from": "10 Hz", "to": "200 Hz", "duration": "1 s"}
TURN = 2.0 * math.pi


def machine(rotor: dict[str, Any], base: Any, **tables: object) -> frbcli.Case:
    data = {"rotor": rotor, "bearing": BEARING, "speed": SPEED, "base": base} | tables
    return case_from_dict(data, "shaken")


def shaken(**keys: object) -> dict[str, Any]:
    return {"acceleration": ["2 m/s^2", "0 m/s^2"], "order": 2.0} | keys


def transmitted(found: Any, node: str, frequency: float) -> complex:
    """Absolute motion of a node over that of the ground, in x."""
    ground = -2.0 / (TURN * frequency) ** 2
    return complex((found.motion[0, found.points.index(node), 0] + ground) / ground)


@pytest.mark.parametrize(
    ("keys", "frequency"),
    [({}, 60.0), ({"order": 4.0, "speed": "50 Hz"}, 200.0), ({"order": None, "speed": "35 Hz"}, 35.0)],
    ids=["order of the rotor", "order of an engine", "engine"],
)
def test_the_transmissibility_of_a_rigid_rotor_is_the_closed_form(keys: dict[str, Any], frequency: float) -> None:
    s = 1j * TURN * frequency
    found = response(machine(RIGID, shaken(**keys)), [30.0], excitation="base")
    expected = 2.0 * (K + C * s) / (2.0 * (K + C * s) + M * s**2)
    assert abs(transmitted(found, "journal", frequency) - expected) < 1e-9 * abs(expected)
    assert np.all(found.motion[0, 0, 1] == 0.0)


def test_the_transmissibility_through_bearing_and_support_is_the_closed_form() -> None:
    """Ground, support, bearing, rotor: two masses in series."""
    frequency = 60.0
    s = 1j * TURN * frequency
    case = machine(RIGID, shaken(), bearing=BEARING | {"support": SUPPORT})
    found = response(case, [30.0], excitation="base")
    bearing, support = 2.0 * (K + C * s), 2.0 * (SPRING + DAMPER * s)
    matrix = np.array([[bearing + M * s**2, -bearing], [-bearing, bearing + support + 2.0 * SHELL * s**2]])
    rotor, shell = np.linalg.solve(matrix, [0.0, support])
    assert abs(transmitted(found, "journal", frequency) - rotor) < 1e-9 * abs(rotor)
    assert abs(transmitted(found, "support", frequency) - shell) < 1e-9 * abs(shell)


def test_a_ground_that_is_accelerated_upwards_is_gravity() -> None:
    """Of every body: the inertia against the ground is the weight over g."""
    held = {"bearing.0.support": SUPPORT, "rotor.gravity": G}
    heavy = load_case("turbocharger-heavy").with_settings(held | {"base": shaken(acceleration=[0.0, 1.0])})
    ring = load_case("floating-ring").with_settings({"base": shaken(acceleration=[0.0, 1.0])})
    up = shaken(acceleration=[0.0, 1.0])
    housed = machine(JEFFCOTT, up, housing={"mass": "20 kg", "mounts": [{"stiffness": "1e7 N/m"}]})
    elastic = machine(JEFFCOTT, up, housing=MODES | {"masses": {"bearing": "4 kg"}})
    for case in (machine(JEFFCOTT, up), heavy, ring, housed, elastic):
        rotor = make_rotor(case)
        (load,) = rotor.loads
        np.testing.assert_allclose(case.rotor.gravity * load.columns[0], rotor.static_load, rtol=1e-12, atol=1e-15)


def test_engine_orders_add_up_and_each_has_its_response() -> None:
    case = machine(RIGID, [shaken(order=2.0, speed="25 Hz"), shaken(order=4.0, speed="25 Hz", phase="90 deg")])
    both = [response(case, [30.0], excitation=f"base {number}").motion[0, 0, 0] for number in (1, 2)]
    for frequency, phase, found in zip((50.0, 100.0), (0.0, 90.0), both, strict=True):
        s = 1j * TURN * frequency
        expected = -M * 2.0 * np.exp(1j * math.radians(phase)) / (2.0 * (K + C * s) + M * s**2)
        assert abs(found - expected) < 1e-9 * abs(expected)


def test_a_run_on_a_shaken_ground_has_the_motion_of_the_response(tmp_path: Path) -> None:
    """Also with the acceleration as a table; and the waterfall has the line of the engine."""
    settings = {"speed.from": "40 Hz", "speed.to": "40 Hz", "speed.duration": "300 ms", "accuracy.tolerance": 1e-7}
    shaft = JEFFCOTT | {"gravity": 0.0, "external_damping": "900 N*s/m"}
    case = machine(shaft, shaken(order=1.0, speed="130 Hz", phase="40 deg")).with_settings(settings)
    times = np.linspace(0.0, 0.3, 1201)
    samples = np.column_stack([times, 2.0 * np.cos(TURN * 130.0 * times + math.radians(40.0))])
    np.savetxt(tmp_path / "ground.csv", samples, delimiter=",", header="time,acceleration", comments="")
    tables = {"rotor": shaft, "bearing": BEARING, "speed": SPEED,
              "base": {"file": "ground.csv", "acceleration": [1.0, 0.0]}}  # fmt: skip
    tabled = case_from_dict(tables, "tabled", folder=tmp_path).with_settings(settings)
    found = response(case, [40.0], excitation="base")
    for name, each, bound in (("harmonic", case, 1e-4), ("table", tabled, 6e-3)):  # samples: (pi / 30.8)^2 / 2
        run = runup(each, tmp_path / f"{name}.h5")
        late = run["time_s"] >= 0.2
        turn = np.exp(1j * TURN * 130.0 * run["time_s"][late])
        columns = np.column_stack([np.ones(len(turn)), turn.real, -turn.imag])
        for number, node in enumerate(found.points):
            _, real, imaginary = np.linalg.lstsq(columns, run[f"{node}_x_m"][late], rcond=None)[0]
            expected = found.motion[0, number, 0]
            assert abs(real + 1j * imaginary - expected) < bound * abs(expected), (name, node)
        assert [line.name for line in load_lines(run)] == (["130 Hz"] if name == "harmonic" else [])


def test_the_sketch_shows_a_ground_that_moves() -> None:
    """One line of ground more than that of a machine at rest, as wide as the drawing, below all other parts."""
    still = rotor_sketch(machine(RIGID, []))[0]
    one, two = (rotor_sketch(machine(RIGID, base))[0] for base in (shaken(), [shaken(), shaken(order=4.0)]))
    assert "B1" not in still
    assert ">B1<" in one
    assert ">B1, B2<" in two
    grounds = [[float(y) for y in re.findall(r'y1="([\d.]+)"[^>]*class="ground"', each)] for each in (still, one)]
    assert len(grounds[1]) == len(grounds[0]) + 1
    assert max(grounds[1]) > max(grounds[0])
    assert max(grounds[1]) < float(re.findall(r'viewBox="0 0 \d+ (\d+)"', one)[0])
    drawing, told = rotor_sketch(load_case("turbocharger-engine"))
    assert ">B1, B2, B3<" in drawing
    assert told.endswith("not directions: B a motion of the ground, numbered as in the case.")
    assert "Arrows" not in rotor_sketch(machine(RIGID, []))[1]
