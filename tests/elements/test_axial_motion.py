"""The motion of a rotor along its axis in a run."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.case.schema import Case
from frbcli.elements.collar import AxialMotion, axial_motion, collar_of
from frbcli.errors import InputError
from frbcli.plot.motion import quantity_figure
from frbcli.rotor.loads import speed_profile
from frbcli.scene.machine.rotor import collar_tilt, make_rotor
from frbcli.scene.planning.cell_choice import run_up_profile

LENGTH, TOP, MASS = 0.08, 500.0, 0.03157
STILL = '{ from = "500 Hz", to = "500 Hz", duration = "0.04 s" }'


PADS = """
    [[thrust_bearing]]
    inner_radius = "5 mm"
    outer_radius = "11 mm"
    pads = 4
    pad_angle = "75 deg"
    taper_angle = "50 deg"
    taper = "20 um"
    end_play = "100 um"
    """


def case_of(load: str, speed: str = '{ from = "0 Hz", to = "500 Hz", duration = "0.5 s" }', more: str = "") -> Case:
    spring = 'kind = "coefficients", stiffness = "2e6 N/m", damping = "40 N*s/m"'
    return frbcli.load_case_text(
        f"""
        speed = {speed}
        rotor = {{ kind = "turbocharger", modes = 4 }}
        shaft = [{{ length = "80 mm", diameter = "8 mm" }}]
        bearing = [
            {{ name = "left", position = "10 mm", {spring} }}, {{ name = "right", position = "70 mm", {spring} }},
        ]
        oil = {{ viscosity = "8 mPa*s", density = "830 kg/m^3" }}
        axial = {{ load = {load} }}
        {more}
        {PADS}
        position = "20 mm"
        """
    )


def motion_of(case: Case) -> AxialMotion:
    found = axial_motion(case, run_up_profile(case), MASS)
    assert found is not None
    return found


def test_a_slow_load_is_carried_as_at_rest() -> None:
    case = case_of('{ at = "500 Hz", load = "40 N" }')
    motion, collar = motion_of(case), collar_of(case)
    assert collar is not None
    times = np.array([0.25, 0.4, 0.5])
    position, gap, loss = motion.at(times)
    for i, t in enumerate(times):
        rest = collar.rest(2.0 * math.pi * TOP * float(t) / 0.5)
        # what is left is the lag by the damping, c h' / k with h' from the change of the rests
        assert gap[i] == pytest.approx(rest.gap, abs=0.01 * rest.gap)
        assert position[i] == pytest.approx(50e-6 - gap[i], abs=1e-12)
        assert loss[i] == pytest.approx(rest.torque * rest.omega, rel=5e-3)


def test_a_small_step_of_the_load_decays_as_the_linear_motion() -> None:
    """m u'' + c u' + k u = 0 from the displacement by the step, with k and c where the collar comes to rest."""
    case = case_of('[["0 s", "40 N"], ["1e-6 s", "40.4 N"], ["1 s", "40.4 N"]]', '{ from = "499 Hz", to = "500 Hz", '
                   'duration = "0.04 s" }')  # fmt: skip
    profile = speed_profile([0.0, 1e-6, 0.04], [2.0 * math.pi * TOP] * 3)
    motion, collar = axial_motion(case, profile, MASS), collar_of(case)
    assert motion is not None and collar is not None  # noqa: PT018
    times = np.linspace(0.0, 0.03, 200)
    position, _, _ = motion.at(times)
    rest = collar.rest(2.0 * math.pi * TOP)
    roots = np.roots([MASS, rest.damping, rest.stiffness])
    shares = np.linalg.solve(np.array([[1.0, 1.0], roots]), [1.0, 0.0])
    decay = np.real(shares @ np.exp(np.outer(roots, times)))
    left = (position[-1] - position) / (position[-1] - position[0])
    np.testing.assert_allclose(left, decay, atol=1e-2)
    assert position[-1] - position[0] == pytest.approx(0.4 / rest.stiffness, rel=2e-2)


def test_a_load_that_lifts_the_collar_fast_is_refused() -> None:
    rising = '{ from = "499 Hz", to = "500 Hz", duration = "0.04 s" }'
    fast = case_of('[["0 s", "60 N"], ["0.02 s", "60 N"], ["0.0201 s", "-60 N"], ["1 s", "-60 N"]]', rising)
    with pytest.raises(InputError, match=r"below oil.cavitation_pressure would carry \d+% of the load"):
        motion_of(fast)
    motion_of(case_of('[["0 s", "60 N"], ["0.04 s", "40 N"], ["1 s", "40 N"]]', rising))


WARM = ('oil.viscosity={ grade = "SAE 10W-40" }', "oil.density=830", "thermal.supply_temperature=50 degC",
        "thermal.housing=60 degC", "film.theory=short", "speed.from=100", "speed.to=100", "speed.duration=0.2",
        "start.position=resting")  # fmt: skip
WARMING = [["0 s", "50 degC"], ["1 s", "60 degC"]]


def warm_case(*more: str) -> Case:
    """A rotor that does not tilt, in films and on pads with heat, at one speed."""
    return frbcli.load_case("jeffcott", [*WARM, *more])


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_heat_of_films_and_of_pads_stand_beside_each_other(tmp_path: Path) -> None:
    """The collar is warm as at rest under its load; the films of the journals are as without it, bit for bit."""
    pads = tomllib.loads(PADS)["thrust_bearing"]
    case = warm_case().with_settings({"thrust_bearing": pads, "axial.load": "10 N"})
    run = frbcli.runup(case, tmp_path / "run.h5")
    alone = frbcli.runup(warm_case(), tmp_path / "alone.h5")
    for name in alone.signals:
        np.testing.assert_array_equal(run[name], alone[name], err_msg=name)
    (state,) = frbcli.thrust_sheet(case, speeds_Hz=[100.0]).points
    assert state.load == pytest.approx(10.0, rel=1e-4)
    assert run["thrust_film_thickness_m"] == pytest.approx(state.gap, rel=1e-3)
    assert run["thrust_loss_W"] == pytest.approx(state.power, rel=1e-3)
    cold = frbcli.thrust_sheet(case.with_settings({"thermal": None, "oil.temperature": "50 degC"}), speeds_Hz=[100.0])
    assert cold.points[0].power > 1.05 * state.power  # and so the heat is told from none


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("supply_temperature", WARMING),
        ("shaft", {"capacity": "1 J/K", "conductance": "1 W/K", "temperature": WARMING}),
    ],
)
def test_pads_do_not_follow_a_temperature_over_time(key: str, given: object, tmp_path: Path) -> None:
    pads = tomllib.loads(PADS)["thrust_bearing"]
    case = warm_case().with_settings({"thrust_bearing": pads, "axial.load": "10 N", f"thermal.{key}": given})
    with pytest.raises(InputError, match="films on the pads do not follow") as refused:
        frbcli.runup(case, tmp_path / "run.h5")
    assert [fault.key for fault in refused.value.faults] == [f"thermal.{key}"]
    frbcli.make_plan(case.with_settings({"axial": None}))  # one remedy


def test_run_records_its_axis(tmp_path: Path) -> None:
    case = case_of('"40 N"', STILL)
    run = frbcli.runup(case, tmp_path / "run.h5")
    collar = collar_of(case)
    assert collar is not None
    rest = collar.rest(2.0 * math.pi * TOP)
    again = frbcli.read_run(tmp_path / "run.h5")
    assert again["axial_position_m"] == pytest.approx(50e-6 - rest.gap, abs=1e-10)
    assert again["thrust_loss_W"][-1] == pytest.approx(rest.torque * rest.omega, rel=1e-5)
    assert np.all(again["thrust_film_thickness_m"] <= rest.gap + 1e-10)
    assert run.status == "finished"
    assert len(quantity_figure([again], "axial").axes) == 3


def test_collar_that_tilts_onto_its_pads_ends_the_run(tmp_path: Path) -> None:
    pushed = 'force = [{ at = "journal_left", force = ["600 N", "0 N"] }]'
    case = case_of('"40 N"', STILL, pushed)
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert run.status == "contact"
    assert run.t_end_s == run["time_s"][-1] < 0.04
    assert run["thrust_film_thickness_m"][-1] <= 1e-6 < run["thrust_film_thickness_m"][:-1].min()
    (event,) = [each for each in run.events if each["kind"] == "contact"]
    assert event["point"] == "collar"


def test_collar_sees_the_slope_of_the_shaft() -> None:
    """A rigid tilt about the centre of mass moves both ends against each other, and the collar by its slope."""
    case = case_of('"40 N"', STILL)
    tilt, machine = collar_tilt(case), make_rotor(case)
    assert tilt is not None
    nodes = dict(machine.points)
    rigid = np.zeros(machine.size)
    rigid[1] = 1.0  # the second free mode of the x-plane
    slope = (nodes["journal_right"] @ rigid - nodes["journal_left"] @ rigid)[0] / 0.06
    assert tilt @ rigid == pytest.approx([0.0, slope], rel=1e-9)  # about y: x = x_0 + z tilt_y
