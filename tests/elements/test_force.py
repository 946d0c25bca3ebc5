"""Forces on places of a machine: closed forms, equal ways to say the same, runs against the response, and faults."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.cli.main import run as frb
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.errors import InputError
from frbcli.linear.response import response
from frbcli.linear.stability import stability
from frbcli.plot.machine.response import response_figure
from frbcli.plot.waterfall import orders, run_spectra
from frbcli.report.sketch import rotor_sketch
from frbcli.rotor.loads import loads_at
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor

M, K, C, U = 6.0, 1e6, 300.0, 3e-6  # kg; N/m and N s/m of one bearing; kg m
RIGID = {"kind": "rigid", "mass": f"{M} kg", "gravity": 0.0}
JEFFCOTT = {"kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m"}
BEARING = {"kind": "coefficients", "stiffness": f"{K!r} N/m", "damping": f"{C!r} N*s/m"}
SPEED = {"from": "10 Hz", "to": "200 Hz", "duration": "1 s"}
TURN = 2.0 * math.pi


def machine(rotor: dict[str, Any], *forces: dict[str, Any], **tables: object) -> frbcli.Case:
    data = {"rotor": rotor, "bearing": BEARING, "speed": SPEED, "force": list(forces)} | tables
    return case_from_dict(data, "forced")


def push(at: str = "journal", x: float = 10.0, y: float = 0.0, **keys: object) -> dict[str, Any]:
    return {"at": at, "force": [f"{x!r} N", f"{y!r} N"]} | keys


def rigid_compliance(omega: Any) -> Any:
    """Motion of the rigid rotor over the force on it."""
    return 1.0 / (2.0 * K + 2j * omega * C - M * omega**2)


@pytest.mark.parametrize(
    ("keys", "frequency"),
    [({"order": 2.0}, lambda s: 2.0 * s), ({"frequency": "35 Hz"}, lambda s: 35.0 + 0.0 * s),
     ({"order": 1.0}, lambda s: s)],
    ids=["order", "frequency", "order 1"],
)  # fmt: skip
def test_the_response_to_a_force_in_a_direction_is_the_closed_form(keys: dict[str, Any], frequency: Any) -> None:
    """With amplitude and phase; there is one at each of both journals."""
    found = response(machine(RIGID, push(y=4.0, phase="30 deg", **keys)), [20.0, 90.0, 150.0], excitation="force 1")
    omega = TURN * frequency(found.speeds_Hz)
    for axis, size in enumerate((10.0, 4.0)):
        expected = 2.0 * size * np.exp(1j * math.pi / 6.0) * rigid_compliance(omega)
        np.testing.assert_allclose(found.motion[:, 0, axis], expected, rtol=1e-9)
        np.testing.assert_allclose(
            found.forces[:, 0, axis], -(K + 1j * omega * C) * found.motion[:, 0, axis], rtol=1e-9
        )


def test_a_force_on_the_disk_bends_the_shaft_as_the_closed_form() -> None:
    found = response(machine(JEFFCOTT, push("disk", order=3.0)), [40.0], excitation="force 1")
    s = 2j * math.pi * 120.0
    journal = 2.0 * (K + C * s) + 0.1 * s**2
    disk = 10.0 / (6.0 * s**2 + 5e6 * journal / (5e6 + journal))
    named = dict(zip(found.points, found.motion[0, :, 0], strict=True))
    assert abs(named["disk"] - disk) < 1e-9 * abs(disk)
    assert abs(named["journal"] - disk * 5e6 / (5e6 + journal)) < 1e-9 * abs(disk)


def test_phases_and_dots_of_a_response_to_one_load_count_from_its_angle() -> None:
    """Also of one whose motion is the same at all speeds: a point in the polar diagram."""
    case = machine(RIGID | {"unbalance": f"{U!r} kg*m"}, push(frequency="35 Hz", phase="30 deg"))
    found, unbalanced = response(case, [20.0, 90.0], excitation="force 1"), response(case, [20.0, 90.0])
    assert (found.angle, unbalanced.angle) == ("angle of force 1", "angle of the rotor")
    panels = response_figure(found).axes
    titles = [panel.get_title(loc="left") for panel in panels]
    assert "orbits at 90 Hz; dots: force 1 at angle 0" in titles
    polar = panels[titles.index("polar diagram; dots: highest speed")]
    (x, y), forward = polar.lines[-1].get_data(), found.forward[-1, 0]
    assert polar.lines[-1].get_marker() == "o"
    np.testing.assert_allclose([x[0], y[0]], [1e6 * forward.real, 1e6 * forward.imag])


@pytest.mark.parametrize(("order", "sense"), [(1.0, 1), (-1.0, -1), (2.5, 1), (-2.5, -1)])
def test_a_rotating_force_moves_the_rotor_on_a_circle_in_its_sense(order: float, sense: int) -> None:
    found = response(machine(RIGID, push(rotating=True, order=order)), [90.0], excitation="force 1")
    along, against = (found.forward, found.backward) if sense > 0 else (found.backward, found.forward)
    size = 20.0 * abs(rigid_compliance(abs(order) * TURN * 90.0))
    assert abs(abs(along[0, 0]) - size) < 1e-9 * size
    assert abs(against[0, 0]) < 1e-12 * size


def test_a_rotating_force_of_the_size_of_the_unbalance_is_the_unbalance() -> None:
    """At one speed; the unbalance of phase 0 points to y at angle 0."""
    pull = 0.5 * (TURN * 80.0) ** 2 * U
    forced = response(machine(RIGID, push(x=0.0, y=pull, rotating=True)), [80.0])
    unbalanced = response(machine(RIGID | {"unbalance": f"{U!r} kg*m"}), [80.0])
    np.testing.assert_allclose(forced.motion, unbalanced.motion, rtol=1e-9)
    both = response(machine(RIGID | {"unbalance": f"{U!r} kg*m"}, push(x=0.0, y=pull, rotating=True)), [80.0])
    np.testing.assert_allclose(both.motion, 2.0 * unbalanced.motion, rtol=1e-9)


def test_a_constant_force_is_a_weight() -> None:
    """Half the weight of the rotor, lifted at both journals, leaves what a rotor under half the gravity has."""
    film = load_case("rigid", ["film.theory=short"])
    weight = film.rotor.mass * film.rotor.gravity
    forced = film.with_settings({"force": [push(x=0.0, y=0.25 * weight)]})
    light = film.with_settings({"rotor.gravity": 0.5 * film.rotor.gravity})
    found = [stability(case, [60.0], threshold=True) for case in (forced, light)]
    one, other = (each.points[0].films[0] for each in found)
    np.testing.assert_allclose(one.displacement, other.displacement, rtol=1e-9)
    assert found[1].threshold is not None
    threshold = found[1].threshold.speed_Hz
    near = {"speed.from": f"{0.99 * threshold} Hz", "speed.to": f"{1.005 * threshold} Hz"}  # a short branch
    hopf = [limit_cycles(case.with_settings(near)).special[0].speed_Hz for case in (forced, light)]
    assert abs(hopf[0] - hopf[1]) < 1e-6 * hopf[1]


def test_harmonics_at_a_moment_are_what_the_case_says() -> None:
    rotor = make_rotor(machine(RIGID, push(y=4.0, order=2.0, phase="90 deg"), push(frequency="10 Hz", rotating=True)))
    angle, t = 0.3, 0.013
    total = loads_at(rotor.loads, rotor.size, np.array([t]), np.array([angle]))[0]
    swings = np.cos(2.0 * angle + 0.5 * math.pi) * np.array([20.0, 8.0])
    turns = 20.0 * np.array([np.cos(TURN * 10.0 * t), np.sin(TURN * 10.0 * t)])
    np.testing.assert_allclose(total, swings + turns, rtol=1e-12)


RUN = {"speed.from": "40 Hz", "speed.to": "40 Hz", "speed.duration": "600 ms", "accuracy.tolerance": 1e-7}


@pytest.mark.parametrize(
    ("keys", "frequency"),
    [({"order": 0.5, "phase": "40 deg"}, 20.0), ({"frequency": "130 Hz"}, 130.0),
     ({"order": -1.5, "rotating": True}, 60.0)],
)  # fmt: skip
def test_a_run_at_constant_speed_has_the_motion_of_the_response(
    keys: dict[str, Any], frequency: float, tmp_path: Path
) -> None:
    """With amplitude and phase, of a force on the support of a Jeffcott rotor."""
    support = {"mass": "1 kg", "stiffness": ["4e6 N/m", "7e6 N/m"], "damping": "2000 N*s/m"}
    shaft = JEFFCOTT | {"gravity": 0.0, "external_damping": "500 N*s/m"}
    case = machine(shaft, push("support", y=5.0, **keys), bearing=BEARING | {"support": support}).with_settings(RUN)
    found, run = response(case, [40.0], excitation="force 1"), runup(case, tmp_path / "run.h5")
    late = run["time_s"] >= run.t_end_s - 0.2
    turn = np.exp(2j * math.pi * frequency * run["time_s"][late])
    columns = np.column_stack([np.ones(len(turn)), turn.real, -turn.imag])
    for number, name in enumerate(found.points):
        for axis, letter in enumerate("xy"):
            _, real, imaginary = np.linalg.lstsq(columns, run[f"{name}_{letter}_m"][late], rcond=None)[0]
            expected = found.motion[0, number, axis]
            assert abs(real + 1j * imaginary - expected) < 1e-4 * abs(expected), name


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_the_force_of_a_film_carries_what_acts_on_the_rotor(tmp_path: Path) -> None:
    """The signal of the film's force is what the equation of motion leaves for it."""
    settings = {"force": [push(x=40.0, order=2.0)], "output.signals": ["force"], "start.position": "resting",
                "speed.from": "50 Hz", "speed.to": "50 Hz", "speed.duration": "40 ms",
                "accuracy.tolerance": 1e-8}  # fmt: skip
    case = load_case("rigid", ["film.theory=short"]).with_settings(settings)
    run = runup(case, tmp_path / "run.h5")
    x, t = run["journal_x_m"], run["time_s"]
    acceleration = np.gradient(np.gradient(x, t), t)[50:-50]
    applied = 80.0 * np.cos(2.0 * TURN * 50.0 * t)[50:-50]
    left = case.rotor.mass * acceleration - applied
    np.testing.assert_allclose(2.0 * run["film_force_x_N"][50:-50], left, atol=2e-3 * 80.0)


def test_a_waterfall_has_a_line_for_each_frequency_beside_the_rotor_speed(tmp_path: Path) -> None:
    """Order 2 twice is one line; an order of 1 is the rotor speed itself."""
    forces = (push(order=2.0), push(y=4.0, order=-2.0), push(rotating=True), push(frequency="35 Hz"))
    case = machine(RIGID, *forces).with_settings({"speed.from": "40 Hz", "speed.to": "50 Hz", "speed.duration": "1 s"})
    run = runup(case, tmp_path / "run.h5")
    found = run_spectra(run, "journal", None, "x")
    lines = dict(orders(run, "journal", found))
    assert list(lines) == ["1X", "2X", "35 Hz", "0.5X"]
    np.testing.assert_allclose(lines["2X"], 2.0 * found.speed_Hz)
    assert np.all(lines["35 Hz"] == 35.0)
    assert found.frequency_Hz[-1] >= 100.0  # order 2 at the highest speed


def test_the_sketch_shows_forces() -> None:
    case = machine(JEFFCOTT, push("disk", order=2.0), push("journal", rotating=True))
    assert rotor_sketch(case)[0].count(">F1<") == 1  # at the disk
    assert rotor_sketch(case)[0].count(">F2<") == 2  # at both journals


def test_places_of_a_turbocharger_are_bearings_and_disks() -> None:
    heavy = load_case("turbocharger-heavy")
    bearing, bearings = heavy.bearings[0].name, {each.name for each in heavy.bearings}
    disk = next(each.name for each in heavy.disks if each.name not in bearings)
    forced = heavy.with_settings({"force": [push(f"journal_{bearing}"), push(disk)]})
    load = make_rotor(forced).static_load - make_rotor(heavy).static_load
    points = dict(make_rotor(heavy).points)
    expected = 10.0 * (points[f"journal_{bearing}"][0] + points[f"disk_{disk}"][0])
    np.testing.assert_allclose(load, expected, atol=1e-9)
    assert ">F2<" in rotor_sketch(forced)[0]


def test_the_nearest_place_is_the_remedy() -> None:
    with pytest.raises(InputError, match='Did you mean "disk"'):
        machine(JEFFCOTT, push("dsk"))


def test_a_load_that_the_case_does_not_have_is_refused() -> None:
    film = load_case("rigid", ["film.theory=short"]).with_settings({"force": [push(order=2.0)]})
    with pytest.raises(InputError, match="is no load of the case"):
        response(film, [50.0], excitation="force 2")


SLOW, SOFT = {"from": "10 Hz", "to": "200 Hz", "duration": "4 s"}, {"stiffness": "4e5 N/m", "damping": "150 N*s/m"}
OWN_EVENTS = {"critical-speed"}  # of the rotor alone


def _soft(folder: Path, **tables: object) -> tuple[set[str], list[float]]:
    """Kinds of the events of a stable linear rotor, and its critical speeds."""
    rotor = {"kind": "rigid", "mass": "6 kg", "unbalance": "3e-6 kg*m"}
    data = {"rotor": rotor, "bearing": {"kind": "coefficients", **SOFT}, "speed": SLOW} | tables
    run = runup(case_from_dict(data, "forced"), folder / "run.h5", force=True)
    critical = [event["speed_Hz"] for event in run.events if event["kind"] == "critical-speed"]
    return {event["kind"] for event in run.events}, critical


@pytest.mark.parametrize(
    "tables",
    [{"force": [push(x=60.0, frequency="62 Hz")]},
     {"force": [push(x=60.0, order=0.5)]},
     {"force": [push(x=60.0, y=20.0, frequency="41 Hz"), push(x=40.0, frequency="-75 Hz", rotating=True)]},
     {"base": {"acceleration": ["20 m/s^2", "0 m/s^2"], "order": 1, "speed": "62 Hz"}},
     {"base": {"acceleration": ["20 m/s^2", "5 m/s^2"], "order": 2, "speed": "20 Hz"}}],
    ids=["force", "order", "forces", "ground", "ground of an engine"],
)  # fmt: skip
def test_motion_that_is_forced_is_no_whirl(tables: dict[str, Any], tmp_path: Path) -> None:
    """The rotor is linear and stable: its critical speed is that without the force."""
    kinds, own = _soft(tmp_path)
    assert kinds == OWN_EVENTS
    kinds, critical = _soft(tmp_path, **tables)
    assert kinds == OWN_EVENTS
    assert critical == pytest.approx(own, rel=3e-3)


@pytest.mark.parametrize("broad", [False, True])
def test_the_lines_of_a_table_are_no_whirl(broad: bool, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    time = np.arange(0.0, 4.5, 1e-3)
    x, y = 40.0 * np.cos(TURN * 62.0 * time), 25.0 * np.sin(TURN * 41.0 * time)
    if broad:
        x = np.random.default_rng(0).normal(0.0, 40.0, len(time))
    rows = "\n".join(f"{t:.3f},{a:.9f},{b:.9f}" for t, a, b in zip(time, x, y, strict=True))
    (tmp_path / "force.csv").write_text(f"time,x,y\n{rows}\n", encoding="utf-8")
    (tmp_path / "case.toml").write_text(
        'rotor = { kind = "rigid", mass = "6 kg", unbalance = "3 g*mm" }\n'
        'bearing = { kind = "coefficients", stiffness = "4e5 N/m", damping = "150 N*s/m" }\n'
        'speed = { from = "10 Hz", to = "200 Hz", duration = "4 s" }\n'
        '[[force]]\nat = "journal"\nfile = "force.csv"\n', encoding="utf-8")  # fmt: skip
    assert frb(["runup", str(tmp_path / "case.toml"), "-o", str(tmp_path / "run.h5")]) == 0
    told = " ".join("".join(capfd.readouterr()).split())
    assert ("not separated from whirl" in told) is broad
    if not broad:
        assert {event["kind"] for event in frbcli.read_run(tmp_path / "run.h5").events} == OWN_EVENTS


@pytest.mark.parametrize("frequency", [41, 62])
def test_whirl_beside_a_force_is_that_without_it(frequency: int, tmp_path: Path) -> None:
    """A small force moves the journal by its frequency, and the whirl of the film is found beside it."""
    settings = ("film.theory=short", "speed.from=150 Hz", "speed.to=230 Hz", "speed.duration=4 s")
    alone = load_case("jeffcott", settings)
    pushed = load_case_text(
        alone.source_text + f'\n[[force]]\nat = "disk"\nforce = ["4 N", "0 N"]\nfrequency = "{frequency} Hz"\n',
        name="jeffcott",
    )
    found = [runup(case, tmp_path / f"{number}.h5").events for number, case in enumerate((alone, pushed))]
    own, beside = ([event for event in events if event["kind"] in ("onset", "offset")] for events in found)
    assert [event["kind"] for event in own] == [event["kind"] for event in beside] == ["onset"]
    assert beside[0]["speed_Hz"] == pytest.approx(own[0]["speed_Hz"], rel=0.05)
    assert beside[0]["frequency_Hz"] == pytest.approx(own[0]["frequency_Hz"], rel=0.05)
