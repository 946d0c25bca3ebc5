"""A collar under an axial load: where it rests, how it swings along the axis, and what holds it in tilt."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marches import DISK, SPAN, D, rigid_shaft

import frbcli
from frbcli.case.schema import Case
from frbcli.elements.collar import NotCarried, collar_of
from frbcli.elements.thrust import ThrustElement
from frbcli.equilibrium.linearised import linearised, states
from frbcli.errors import InputError
from frbcli.linear.sheets.thrust import axial_state
from frbcli.scene.machine.rotor import make_rotor, site_of

SPEED, TOP = 2.0 * math.pi * 500.0, 500.0
LENGTH, DIAMETER, DENSITY, SPRING, ARM = 0.08, 0.008, 7850.0, 2e6, 0.03
PADS: dict[str, Any] = {
    "side": "both", "position": 0.02, "inner_radius": 5e-3, "outer_radius": 11e-3, "pads": 4,
    "pad_angle": "75 deg", "taper_angle": "50 deg", "taper": 20e-6, "end_play": 100e-6,
}  # fmt: skip
STIFF = {"youngs_modulus": 210e12, "poisson_ratio": 0.3}  # a shaft that does not bend


def collar_case(load: object = 40.0, more: dict[str, Any] | None = None, **pads: Any) -> Case:
    """A rigid shaft between two equal springs, with a collar beside its middle."""
    bearing = {key: value for key, value in {**PADS, **pads}.items() if value is not None}
    springs = [
        {"kind": "coefficients", "name": name, "position": 0.5 * LENGTH + arm, "stiffness": SPRING}
        for name, arm in (("left", -ARM), ("right", ARM))
    ]
    return frbcli.case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "modes": 2},
            "shaft": [{"length": LENGTH, "diameter": DIAMETER, "density": DENSITY, **STIFF}],
            "bearing": springs,
            "thrust_bearing": [bearing],
            "axial": {"load": load},
            "oil": {"viscosity": 8e-3, "density": 830.0},
            "speed": {"from": "400 Hz", "to": f"{TOP} Hz", "duration": "0.1 s"},
            **(more or {}),
        }
    )


@pytest.fixture(scope="module")
def case() -> Case:
    return collar_case()


def test_films_carry_the_load_where_the_collar_rests(case: Case) -> None:
    state = axial_state(case, SPEED)
    assert state is not None
    (films,) = frbcli.thrust_sheet(case, [state.films.gap], [TOP]).points
    assert films.load == pytest.approx(40.0, rel=1e-7)
    assert state.position == pytest.approx(50e-6 - films.gap, abs=1e-15)
    assert state.films.power == films.power


def test_the_other_way_round_is_a_mirror_image(case: Case) -> None:
    one, other = axial_state(case, SPEED), axial_state(collar_case(-40.0), SPEED)
    assert one is not None
    assert other is not None
    assert (other.position, other.films.gap) == (-one.position, one.films.gap)
    middle = axial_state(collar_case(0.0), SPEED)
    assert middle is not None
    assert middle.films.gap == 50e-6


def test_load_grows_with_the_square_of_the_speed() -> None:
    collar = collar_of(collar_case({"at": f"{TOP} Hz", "load": 40.0}))
    assert collar is not None
    assert collar.load_at(0.5 * SPEED) == pytest.approx(10.0)
    over_time = collar_of(collar_case([["0 s", "0 N"], ["0.1 s", "40 N"]]))
    assert over_time is not None
    assert over_time.load_at(0.9 * SPEED) == pytest.approx(20.0)  # in the middle of the run, at 450 Hz


def test_rotor_swings_along_its_axis_as_a_mass_on_a_film(case: Case) -> None:
    state = axial_state(case, SPEED)
    assert state is not None
    mass = DENSITY * 0.25 * math.pi * DIAMETER**2 * LENGTH
    half, square = 0.5 * state.films.damping / mass, state.films.stiffness / mass
    slower = -half + math.sqrt(half**2 - square) if half**2 > square else complex(-half, math.sqrt(square - half**2))
    assert state.eigenvalue == pytest.approx(slower, rel=1e-9)


def test_conical_motion_of_a_rigid_shaft_has_its_closed_form(case: Case) -> None:
    """With the tilt a = a_x + i a_y about the centre of mass I_d a'' + (c - i Omega I_p) a' + (2 k l^2 + K) a = 0,
    where the collar has K = k_xx + i k_yx; the translation has roots of its own, which the collar leaves alone."""
    collar = collar_of(case)
    assert collar is not None
    rest = collar.rest(SPEED)
    mass, radius = DENSITY * 0.25 * math.pi * DIAMETER**2 * LENGTH, 0.5 * DIAMETER
    polar, diametral = 0.5 * mass * radius**2, mass * (3.0 * radius**2 + LENGTH**2) / 12.0
    stiffness = 2.0 * SPRING * ARM**2 + complex(rest.tilt_stiffness[0, 0], rest.tilt_stiffness[1, 0])
    conical = np.roots([diametral, complex(rest.tilt_damping[0, 0], -SPEED * polar), stiffness])
    nothing = np.zeros((0, 2, 2))
    found = np.linalg.eigvals(states(linearised(make_rotor(case), SPEED, nothing, nothing), make_rotor(case).turning))
    for root in conical:
        assert np.abs(found - root).min() < 1e-9 * abs(root)
        assert np.abs(found - root.conjugate()).min() < 1e-9 * abs(root)
    translation = math.sqrt(2.0 * SPRING / mass)
    assert np.abs(found - 1j * translation).min() < 1e-9 * translation
    assert abs(stiffness.imag) > 0.1 * abs(stiffness.real - 2.0 * SPRING * ARM**2)  # so that its sign counts


def test_sheets_have_the_loads_that_the_collar_leaves_to_the_journals() -> None:
    """A rigid shaft with a disk beside its bearings: their forces and the moment -K a of the collar, whose tilt a
    follows from the places of the journals, hold the weight."""
    pads = {key: value for key, value in PADS.items() if key != "position"} | {"inner_radius": 5.5e-3, "position": 2e-3}
    more = {"thrust_bearing": [pads], "axial.load": 40.0, "disk.0.position": 0.015, "rotor.modes": 2}
    case = rigid_shaft("film.theory=short").with_settings(more)
    collar, points = collar_of(case), frbcli.bearing_sheet(case, [300.0]).points
    assert collar is not None
    omega, z = 2.0 * math.pi * 300.0, 0.5 * SPAN * np.array([-1.0, 1.0])
    loads = np.array([point.load for point in points])
    places = np.array([point.clearance * point.displacement for point in points])
    growth = (places[1] - places[0]) / SPAN
    held = -collar.rest(omega).tilt_stiffness @ np.array([-growth[1], growth[0]])
    shaft = DENSITY * 0.25 * math.pi * D**2 * 0.02
    assert loads.sum(axis=0) == pytest.approx([0.0, -9.81 * (shaft + DISK)], abs=1e-8)
    weight = 0.005 * 9.81 * DISK  # about x through the middle of the shaft, M_x = -z F_y
    assert -(z @ loads[:, 1]) == pytest.approx(weight + held[0], rel=1e-6)
    assert z @ loads[:, 0] == pytest.approx(held[1], abs=1e-6 * weight)
    assert np.hypot(*held) > 0.01 * weight


def test_without_an_axial_load_the_machine_is_as_without_the_bearing(case: Case) -> None:
    apart = case.with_settings({"axial": None})
    without = apart.with_settings({"thrust_bearing": None})
    machine, other = make_rotor(apart), make_rotor(without)
    assert machine.over_speed is None
    for name in ("mass", "damping", "gyroscopic", "stiffness"):
        assert np.array_equal(getattr(machine, name), getattr(other, name))
    assert [name for name, _ in machine.points] == [name for name, _ in other.points]


def test_a_rotor_that_does_not_tilt_has_its_axis_alone() -> None:
    bearing = {key: value for key, value in PADS.items() if key != "position"}
    more = {"thrust_bearing": [bearing], "axial.load": "40 N", "speed.from": "100 Hz"}
    case = frbcli.load_case("jeffcott").with_settings(more)
    assert make_rotor(case).over_speed is None
    (element,) = ThrustElement.of(case)
    assert "does not tilt" in element.plan_line(site_of(case))[2]
    point = frbcli.stability(case, [300.0]).points[0]
    assert point.axial is not None
    assert point.axial.films.load == pytest.approx(40.0, rel=1e-7)


def largest(amplitude: Any) -> float:
    """The half major axis of the ellipse of complex amplitudes in x and y."""
    return float(np.sqrt(0.5 * (np.sum(np.abs(amplitude) ** 2) + np.abs(np.sum(amplitude**2)))))


def test_response_and_run_agree_on_the_collar(tmp_path: Path) -> None:
    """The run turns at one speed until its start is forgotten; the response has the matrices."""
    damped = [
        {"kind": "coefficients", "name": name, "position": 0.5 * LENGTH + arm, "stiffness": SPRING, "damping": 40.0}
        for name, arm in (("left", -ARM), ("right", ARM))
    ]
    more = {
        "bearing": damped,
        "disk": [{"name": "wheel", "position": 0.0, "mass": 2e-3, "unbalance": 2e-9}],
        "speed": {"from": f"{TOP} Hz", "to": f"{TOP} Hz", "duration": "0.05 s"},
        "output": {"step": "2e-5 s"},
    }
    amplitudes = []
    for load in (400.0, 1.0):
        case = collar_case(load, more)
        response = frbcli.response(case, [TOP])
        asked = response.motion[0, response.points.index("disk_wheel")]
        run = frbcli.runup(case, tmp_path / f"{load:g}.h5")
        x, y = (run.signals[f"disk_wheel_{axis}_m"][-100:] for axis in "xy")
        across = x - x.mean(), y - y.mean()
        amplitudes.append(float(np.hypot(*across).max()))
        assert amplitudes[-1] == pytest.approx(largest(asked), rel=2e-3)
    assert abs(amplitudes[0] / amplitudes[1] - 1.0) > 0.05  # the collar does something


def test_a_load_that_no_film_carries_names_the_largest() -> None:
    case = collar_case()
    collar = collar_of(case)
    assert collar is not None
    most = collar.carried(collar.thin, SPEED)
    with pytest.raises(InputError, match=re.escape(f"the most is {most:.4g} N, at a gap of 1 um")):
        frbcli.make_plan(collar_case(1.01 * most))
    with pytest.raises(NotCarried):
        collar.rest(0.0)


def test_a_run_from_standstill_under_load_is_refused_with_a_speed_that_will_do() -> None:
    case = collar_case(40.0, {"speed": {"from": "0 Hz", "to": f"{TOP} Hz", "duration": "0.1 s"}})
    with pytest.raises(InputError, match="presses the collar onto its pads") as refused:
        frbcli.make_plan(case)
    (fault,) = refused.value.faults
    first = fault.remedy.split('"')[1]
    frbcli.make_plan(case.with_settings({"speed.from": first}))
    frbcli.make_plan(case.with_settings({"axial.load": {"at": "1000 Hz", "load": "40 N"}}))


def test_a_load_over_time_needs_speeds_that_rise(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a run-down has each speed twice"):
        frbcli.rundown(collar_case([["0 s", "10 N"], ["1 s", "40 N"]]), tmp_path / "down.h5")
