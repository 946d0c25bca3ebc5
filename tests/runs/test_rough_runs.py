"""Runs of rough bearings: from rest on the shell to the film and back, their energy, events and resume."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from films import ROUGH
from marches import planned_system
from resumed import assert_resumable
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

from frbcli.arrays import Array
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.case.schema import Case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.film.roughness.asperities import LAST, touch
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.run import rundown, runup
from frbcli.scene.machine.system import rough_surfaces

WEAR = "contact.wear=1e-7", "contact.hardness=2 GPa"
HEAVY = "rotor.gravity=40 m/s^2"  # else a ring without feed holes slips
STARTS = ("start.position=resting", "rotor.unbalance=0 g*mm", 'output.signals=["torque","power"]')


def rigid(*settings: str) -> Case:
    return load_case("rigid", [*ROUGH, *STARTS, *settings])


@pytest.fixture(scope="module")
def started(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """From standstill to 6 Hz, with fine steps."""
    case = rigid("speed.to=6 Hz", "speed.duration=0.4 s", "output.step=2e-5 s", "accuracy.tolerance=1e-9")
    return runup(case, tmp_path_factory.mktemp("started") / "run.h5")


def test_a_rotor_starts_on_its_shell_rolls_up_and_lifts_off(started: Run) -> None:
    assert started.status == "finished"
    assert started["asperity_share"][0] == pytest.approx(1.0, abs=1e-4)
    assert started["contact_power_W"][0] == 0.0
    assert started["journal_x_m"][0] == 0.0
    assert started["journal_x_m"].min() < -1e-7  # the shell takes it along, against the sense of rotation
    assert started["journal_x_m"][-1] > 1e-5  # the film carries it in the sense of rotation
    assert started["asperity_share"][-1] == 0.0
    kinds = [(event["kind"], event["t_s"]) for event in started.events if event["kind"] in ("touch", "lift-off")]
    assert [kind for kind, _ in kinds] == ["touch", "lift-off"]
    assert kinds[0][1] == 0.0
    assert 1.0 < 15.0 * kinds[1][1] < 5.0  # Hz: between friction and film of the sheet
    np.testing.assert_allclose(
        started["film_thickness_m"], 35e-6 * (1.0 - started["eccentricity"]), rtol=1e-9, atol=1e-15
    )


def whole(run: Run, values: Array) -> float:
    """Over the time of a run."""
    time = run["time_s"]
    return float(CubicSpline(time, values).integrate(time[0], time[-1]))


def stored(run: Run, case: Case) -> float:
    """What motion, weight and the summits of both bearings as springs have at the end of a run from rest, J."""
    (film,), rotor, surfaces = case.films, case.rotor, rough_surfaces(case)
    assert surfaces is not None

    def pressed(eccentricity: float) -> float:
        """Energy of the summits of one bearing."""
        free = film.clearance - LAST * surfaces.roughness
        own = quad(lambda e: touch(surfaces, 0, film.clearance, e).radial, free, max(free, eccentricity), epsrel=1e-10)
        return float(own[0])

    t, places, mass = run["time_s"], [run[f"journal_{axis}_m"] for axis in "xy"], 6.1
    speed = np.hypot(*(CubicSpline(t, place)(t[-1], 1) for place in places))
    moved = 0.5 * mass * speed**2 + mass * rotor.gravity * (places[1][-1] - places[1][0])
    return moved + 2.0 * (pressed(float(np.hypot(*(p[-1] for p in places)))) - pressed(float(-places[1][0])))


def test_drive_gives_what_films_and_friction_take_and_what_is_stored(started: Run) -> None:
    drive = whole(started, -2.0 * started["torque_N_m"] * 2.0 * np.pi * started["speed_Hz"])
    lost = whole(started, 2.0 * started["power_W"])
    assert drive - lost - stored(started, rigid()) == pytest.approx(0.0, abs=1e-8 * drive)
    assert 0.1 * drive < whole(started, 2.0 * started["contact_power_W"]) < 0.9 * drive


def test_a_torque_gives_what_rotation_load_films_and_friction_take(tmp_path: Path) -> None:
    """From standstill at free speed, through contact of the summits: the work of the torque, less that of the load."""
    inertia, torque, load = 2e-3, 0.12, 2e-4
    tables = {name: keys for name, keys in tomllib.loads(rigid().source_text).items() if name != "speed"}
    tables["rotor"] |= {"polar_inertia": f"{inertia} kg*m^2"}
    tables["drive"] = {"torque": f"{torque} N*m", "load": f"{load} N*m*s", "duration": "0.1 s"}
    case = case_from_dict(tables | {"output": tables["output"] | {"step": "20 us"}, "accuracy": {"tolerance": 1e-8}})
    run = runup(case, tmp_path / "run.h5")
    omega = 2.0 * np.pi * run["speed_Hz"]
    work, lost = whole(run, (torque - load * omega) * omega), whole(run, 2.0 * run["power_W"])
    assert work - 0.5 * inertia * omega[-1] ** 2 - lost - stored(run, case) == pytest.approx(0.0, abs=1e-6 * work)
    assert whole(run, 2.0 * run["contact_power_W"]) > 0.02 * work


@pytest.fixture
def lines_of_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tabulated films are clipped along the same lines at rest, where they have more by default, and in runs."""
    monkeypatch.setattr(static_films, "RESTING_LINES", 1)


@pytest.mark.usefixtures("lines_of_the_run")
def test_a_slow_rotor_stays_where_the_sheet_has_it(tmp_path: Path) -> None:
    case = rigid('speed={points=[["0 s", "0.2 Hz"], ["0.2 s", "0.2 Hz"]]}', "output.step=1e-3 s")
    run = runup(case, tmp_path / "run.h5")
    (state,) = bearing_sheet(case, [0.2]).points
    assert state.mixed is not None
    np.testing.assert_allclose(run["eccentricity"], state.eccentricity, rtol=1e-7)
    assert run["asperity_share"][-1] == pytest.approx(state.mixed.share, rel=0.05)  # of sizes, not along the load
    assert run["contact_power_W"][-1] == pytest.approx(state.mixed.power, rel=1e-5)
    assert run["power_W"][-1] == pytest.approx(state.power, rel=5e-3)  # the sheet solves its film on cells


@pytest.mark.usefixtures("lines_of_the_run")
def test_a_disturbance_goes_on_as_the_linearised_machine_has_it(tmp_path: Path) -> None:
    """Next to rest, on film and summits: x(t) = exp(A t) x(0) with stiffness and damping of `stability`."""
    (point,) = stability(rigid(), [0.2]).points
    (film,), mass = point.films, 0.5 * 6.1
    nothing, one = np.zeros((2, 2)), np.eye(2)
    matrix = np.block([[nothing, one], [-film.stiffness / mass, -film.damping / mass]])
    moved = np.array([2e-5, -1e-5])
    x, y = (film.displacement + moved).tolist()
    case = load_case("rigid", [
        *ROUGH, "rotor.unbalance=0 g*mm", f"start.displacement=[{x!r}, {y!r}]", "output.step=1e-3 s",
        'speed={points=[["0 s", "0.2 Hz"], ["0.2 s", "0.2 Hz"]]}', "accuracy.tolerance=1e-10",
    ])  # fmt: skip
    run = runup(case, tmp_path / "run.h5")
    found = np.stack([run["journal_x_m"], run["journal_y_m"]], axis=1) / 35e-6 - film.displacement
    expected = np.array([(expm(matrix * t) @ [*moved, 0.0, 0.0])[:2] for t in run["time_s"]])
    assert np.abs(found[-1] - moved).max() > 2.0 * np.abs(moved).max()
    np.testing.assert_allclose(found, expected, atol=0.01 * np.abs(moved).max())


@pytest.mark.nightly  # minutes of compilation
@pytest.mark.parametrize("law", ["elrod", "bubbly"])
def test_cells_one_and_a_half_times_finer_agree_within_the_errors_near_contact(law: str, tmp_path: Path) -> None:
    """From summits that carry a tenth and a quarter of the load to the film alone: 3e-3 and 1.6e-2 of the clearance."""
    course = "speed.from=0.3 Hz", "speed.to=15 Hz", "speed.duration=0.3 s", "output.step=1e-3 s"
    film = f"film.cavitation={law}", "bearing.supply.pressure=2 bar"
    coarse, fine = (
        runup(rigid(*course, *film, f"accuracy.mesh=[{along}, {8 * along}]"), tmp_path / f"{along}.h5")
        for along in (6, 9)
    )
    for run in (coarse, fine):
        assert {"touch", "lift-off"} <= {event["kind"] for event in run.events}
    apart = np.abs(coarse["eccentricity"] - fine["eccentricity"]).max()
    assert apart < coarse.error["eccentricity"] + fine.error["eccentricity"]  # type: ignore[operator]
    assert np.abs(coarse["asperity_share"] - fine["asperity_share"]).max() < 0.2 * coarse["asperity_share"].max()


def test_wear_is_its_rate_times_pressure_and_path(tmp_path: Path) -> None:
    """The volume is that of the work of friction over its coefficient, the deepest place where the gap is narrowest."""
    speeds = 'speed={points=[["0 s", "0.2 Hz"], ["0.2 s", "0.2 Hz"]]}'
    case = rigid(speeds, "output.step=1e-3 s", *WEAR)
    run = runup(case, tmp_path / "run.h5")
    assert run.checkpoint is not None
    (depths,) = run.checkpoint["wear"]
    work = 1e-3 * run["contact_power_W"].sum()
    assert len(depths) == 72
    volume = depths.sum() * 12.5e-3 * 20e-3 * 2.0 * np.pi / len(depths)
    assert volume == pytest.approx(1e-7 / 2e9 * work / 0.12, rel=2e-2)
    lowest = np.degrees(np.arctan2(-run["journal_x_m"][0], run["journal_y_m"][0])) % 360.0
    assert run.cost["wear_angle_deg"] == pytest.approx(lowest, abs=2.5)
    assert run.cost["wear_depth_m"] == depths.max() > 0.0


def test_a_run_down_ends_on_the_shell(tmp_path: Path) -> None:
    settings = "speed.to=20 Hz", "speed.duration=0.2 s", "speed.hold=0.1 s", "output.step=1e-3 s"
    case = rigid(*settings, "speed.down_duration=0.6 s", "oil.viscosity=1 mPa*s")  # thin oil is soon squeezed out
    run = rundown(case, tmp_path / "run.h5")
    kinds = [event["kind"] for event in run.events if event["kind"] in ("touch", "lift-off")]
    assert run.status == "finished"
    assert kinds == ["touch", "lift-off", "touch"]
    assert run["asperity_share"][-1] > 0.5
    assert run["speed_Hz"][-1] == pytest.approx(0.0, abs=1e-9)


def test_an_interrupted_run_goes_on_in_contact_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    settings = "speed.to=6 Hz", "speed.duration=0.4 s", "output.step=1e-4 s", "accuracy.tolerance=1e-8"
    whole = assert_resumable(rigid(*settings, *WEAR), tmp_path, 0.1, steps=30)
    assert whole["asperity_share"][np.searchsorted(whole["time_s"], 0.1)] > 0.0
    assert whole.checkpoint is not None
    assert "wear" in whole.checkpoint


@pytest.mark.nightly  # minutes of compilation
def test_a_run_with_flow_factors_stays_where_its_film_rests_on_fewer_summits(tmp_path: Path) -> None:
    """And where the sheet has it, within the errors that both state."""
    still = 'speed={points=[["0 s", "0.3 Hz"], ["0.05 s", "0.3 Hz"]]}', "output.step=1e-3 s", "accuracy.mesh=[12, 96]"
    case, omega = rigid(*still, "contact.flow_factors=true"), 2.0 * np.pi * 0.3
    (sheet,) = bearing_sheet(case, [0.3]).points
    assert sheet.mixed is not None
    run = runup(case, tmp_path / "run.h5")
    system = planned_system(case)
    (place,) = resting_position(system, omega).journals
    film, _ = system.films.power_and_flow(0, place, omega, omega, 0.0)
    np.testing.assert_allclose(run["eccentricity"], np.hypot(*place) / 35e-6, rtol=1e-9)
    assert run["power_W"][-1] == pytest.approx(film + run["contact_power_W"][-1], rel=1e-4)
    assert run["eccentricity"] == pytest.approx(sheet.eccentricity, abs=run.error["eccentricity"] + sheet.place_error)
    assert run["asperity_share"][-1] == pytest.approx(sheet.mixed.share, rel=0.1)
    finer = runup(rigid(*still, "contact.flow_factors=true", "accuracy.mesh=[18, 144]"), tmp_path / "finer.h5")
    assert finer["eccentricity"] == pytest.approx(run["eccentricity"], abs=run.error["eccentricity"])
    smooth = runup(rigid(*still, "film.solution=cells"), tmp_path / "smooth.h5")
    assert smooth["asperity_share"][-1] > run["asperity_share"][-1] > 0.0


@pytest.mark.nightly  # the same loop as above
def test_friction_warms_a_run_to_the_temperature_of_rest(tmp_path: Path) -> None:
    heat = "oil.viscosity={grade='SAE 10W-40'}", 'thermal={model="lumped", supply_temperature="70 degC"}'
    slow = "speed.from=1 Hz", "speed.to=1 Hz", "speed.duration=14 s", "output.step=5e-2 s", "rotor.gravity=100 m/s^2"
    case = rigid(*slow, *heat)
    run = runup(case, tmp_path / "run.h5")
    (film,) = warm_machine(case, 1.0).films
    assert run["contact_power_W"][-1] > 0.2 * run["power_W"][-1]
    assert run["temperature_K"][-1] == pytest.approx(film.temperature, abs=0.05)
    assert run["power_W"][-1] == pytest.approx(film.power, rel=5e-3)


@pytest.mark.nightly  # likewise
def test_a_ring_sticks_to_its_shell_until_its_rotor_has_lifted_off(tmp_path: Path) -> None:
    """Friction inside turns a ring, friction outside, under its own weight too and with a longer arm, holds it."""
    settings = ("film.cavitation=half-sommerfeld", "speed.from=0 Hz", "speed.to=30 Hz", "speed.duration=0.3 s")
    case = load_case("floating-ring", [*ROUGH, *STARTS, *settings, "output.step=1e-4 s"])
    run = runup(case, tmp_path / "run.h5")
    sliding = run["asperity_share_inner"] > 0.5
    assert sliding[:400].all()
    creep = 1e-3 / (2.0 * np.pi * 0.5 * case.films[1].diameter)  # Hz, of a surface that sticks
    assert np.abs(run["ring_speed_Hz"]).max() < 2.0 * creep
    held = run["torque_inner_N_m"] - run["torque_outer_N_m"]  # what is left over for the ring
    assert np.abs(held[100:]).max() < 0.05 * np.abs(run["torque_outer_N_m"]).max()
    assert [(event["kind"], event["film"]) for event in run.events if event["kind"] != "critical-speed"] == [
        ("touch", "inner"), ("touch", "outer"), ("lift-off", "inner"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    "films",
    [
        ("film.theory=short", 'bearing.inner.supply={kind="circumferential-groove", pressure="2 bar"}', HEAVY),
        pytest.param((), marks=pytest.mark.nightly),  # compiles a time loop of its own for a minute
    ],
    ids=["grooves", "feed holes"],
)
def test_a_ring_that_friction_holds_rests_as_in_a_run(films: tuple[str, ...], tmp_path: Path) -> None:
    """It sticks to its shell and creeps there, as Coulomb's law near rest has it. With it creep its feed holes, by
    2e-4 rad in the run: the rest, which has them at its angle 0, is that of the beginning to 1e-6, and of the end to
    what so small an angle changes."""
    course = ("speed.from=4.0 Hz", "speed.to=4.0 Hz", "speed.duration=0.2 s")
    case = load_case("floating-ring", [*ROUGH, *STARTS, "film.cavitation=half-sommerfeld", *films, *course])
    system = planned_system(case)
    rest = resting_position(system, 2.0 * np.pi * 4.0)
    run = runup(case, tmp_path / "run.h5")
    eccentricities = np.hypot(*rest.journals.T) / system.clearances
    assert run["asperity_share_outer"][-1] > 0.0
    for name, expected in zip(("inner", "outer"), eccentricities, strict=True):
        assert run[f"eccentricity_{name}"][-1] == pytest.approx(expected, abs=2e-5)
    ring = run["ring_speed_Hz"] / (rest.ring_speeds[0] / (2.0 * np.pi)) - 1.0
    assert np.abs(ring[run["time_s"] < 0.02]).max() < 1e-6
    assert np.abs(ring).max() < 1e-4
    smooth = resting_position(replace(system, asperities=None), 60.0 * np.pi)
    assert rest.ring_speeds[0] / 4.0 < smooth.ring_speeds[0] / 30.0
    assert rest.ring_speeds[0] < 2.0 * np.pi * 4.0 * 2e-4


def test_a_ring_whose_summits_do_not_touch_rests_as_between_smooth_surfaces() -> None:
    """Bit for bit."""
    case = load_case("floating-ring", [*ROUGH, "film.cavitation=half-sommerfeld"])
    system, omega = planned_system(case), 2.0 * np.pi * 30.0
    rough, smooth = (resting_position(each, omega) for each in (system, replace(system, asperities=None)))
    np.testing.assert_array_equal(rough.ring_speeds, smooth.ring_speeds)
    np.testing.assert_allclose(rough.displacements, smooth.displacements, rtol=1e-9)
