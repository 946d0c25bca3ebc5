"""Heat of squeeze film dampers, of journals along a given motion, and of thrust bearings, against closed forms. Runs
with heat whose clearance steps, and those whose films are solved in turn."""

import math
from pathlib import Path

import numpy as np
import pytest
from resumed import assert_resumable
from test_heat import ring_case, single
from test_heat_run import HOT_HOUSING, STILL, at_speed

import frbcli
from frbcli.bearing_tests.kinematic import KinematicResult, rotation, squeeze, whirl
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import InputError, NotConverged
from frbcli.linear.sheets.thrust import ThrustState
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.changes import case_at
from frbcli.scene.machine.heat import heat_of
from frbcli.thermal.model import SteadyHeat

WIDTH, DIAMETER, CLEARANCE, MASS = 20e-3, 50e-3, 80e-6, 0.5
DAMPER = (
    'bearing.damper={width="20 mm", diameter="50 mm", clearance="80 um", mass="500 g", spring="2e6 N/m", '
    'cavitation="sommerfeld"}'
)
HOUSING = "thermal.housing=40 degC"
STEEL = 434.0  # J/(kg K)


def test_heat_passes_through_shell_and_damper_to_the_housing() -> None:
    """A damper at rest without supply neither heats nor feeds: film, shell, its film and housing lie in series."""
    case = single(DAMPER, HOUSING)
    found, heat = warm_machine(case, 200.0), heat_of(case)
    t = dict(zip(heat.nodes, found.steady.temperatures, strict=True))
    film, damper = found.films
    assert (damper.power, damper.flow) == (0.0, 0.0)
    oil = case.oil
    transfer = [3.77 * oil.thermal_conductivity / c * math.pi * d * b
                for c, d, b in ((35e-6, 25e-3, 20e-3), (CLEARANCE, DIAMETER, WIDTH))]  # fmt: skip
    passed = transfer[0] * (t["film"] - t["shell"])
    assert passed > 10.0
    assert transfer[1] * (t["shell"] - t["damper"]) == pytest.approx(passed, rel=1e-6)
    assert transfer[1] * (t["damper"] - t["housing"]) == pytest.approx(passed, rel=1e-6)
    assert found.steady.given == pytest.approx(passed, rel=1e-6)
    assert heat.model.capacity[heat.nodes.index("shell")] == pytest.approx(MASS * STEEL)
    assert film.temperature == t["film"]


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_squeezing_heats_a_damper_by_the_closed_form(tmp_path: Path) -> None:
    """Power of a short film without rotation: pi eta R (B/C)^3 (r'^2 (1 + 2 eps^2)/(1 - eps^2)^2.5 + (r phi')^2/(1 -
    eps^2)^1.5), the integral of its pressure over the rate of the gap."""
    settings = ["rotor.unbalance=300 g*mm", "speed.from=250 Hz", "speed.to=250 Hz", "speed.duration=0.03 s"]
    run = runup(single(DAMPER, *settings, "output.step=1e-5 s"), tmp_path / "run.h5")
    t, x, y = (run[name] for name in ("time_s", "shell_x_m", "shell_y_m"))
    v_x, v_y, r = np.gradient(x, t), np.gradient(y, t), np.maximum(np.hypot(x, y), 1e-12)
    radial, across, rest = (x * v_x + y * v_y) / r, (x * v_y - y * v_x) / r, 1.0 - (r / CLEARANCE) ** 2
    damping = math.pi * run["viscosity_damper_Pa_s"] * 0.5 * DIAMETER * (WIDTH / CLEARANCE) ** 3
    power = damping * (radial**2 * (3.0 - 2.0 * rest) / rest**2.5 + across**2 / rest**1.5)
    late = t > 0.01
    assert np.max(r[late]) > 0.05 * CLEARANCE
    assert np.mean(run["power_damper_W"][late]) == pytest.approx(np.mean(power[late]), rel=5e-3)
    assert run["temperature_damper_K"][-1] > run["temperature_damper_K"][0]
    # the balance compares sums of heat, of which the temperatures are known to round-off of their absolute size
    temperature, steps = run["temperature_damper_K"], run.cost["steps"]
    round_off = np.finfo(float).eps * temperature[-1] / (temperature[-1] - temperature[0])
    assert run.error["heat_balance_relative"] < math.sqrt(steps) * round_off


SUPPLIED = 50.0 + 273.15
WARM = [
    "bearing.supply={ kind = 'circumferential-groove', pressure = '2 bar' }", "oil.heat_capacity=2100 J/(kg*K)",
    'oil.viscosity={ grade = "SAE 10W-40" }', "thermal.model=lumped", "thermal.supply_temperature=50 degC",
    "accuracy.mesh=[8, 32]",
]  # fmt: skip


def moved(motion: str, *settings: str) -> Case:
    return load_case("squeeze", [*WARM, f"motion={{{motion}}}", *settings])


def heat(found: KinematicResult) -> SteadyHeat:
    assert found.heat is not None
    return found.heat


def rise(found: KinematicResult) -> float:
    return float(heat(found).temperatures[0]) - SUPPLIED


def test_steady_whirl_has_the_temperature_of_a_rotation_that_whirls() -> None:
    """On a circle a film without memory dissipates the same at each moment, as a rotation with this whirl speed does.
    Both have the same cells; those of the rotation are finer at the narrowest gap."""
    circle = "eccentricity=0.4, speed='50 Hz'"
    (turned,) = whirl(moved(f"{circle}, frequency='20 Hz', periods=3"), ["half-sommerfeld"]).results
    (lasting,) = rotation(moved(f"{circle}, angle='0 deg', whirl_speed='20 Hz'"), ["half-sommerfeld"]).results
    assert rise(lasting) > 10.0
    assert rise(turned) == pytest.approx(rise(lasting), rel=5e-3)
    assert heat(turned).films.power == pytest.approx(heat(lasting).films.power, rel=5e-3)
    assert heat(turned).films.flow == pytest.approx(heat(lasting).films.flow, rel=5e-3)


@pytest.mark.parametrize("cavitation", ["half-sommerfeld", "two-phase"])
def test_power_of_a_squeeze_is_the_work_of_its_force(cavitation: str) -> None:
    """Without rotation the journal puts in -F . v alone; without walls the oil that leaves carries it away."""
    case = moved("eccentricity=0.6, frequency='20 Hz', periods=1")
    (found,) = squeeze(case, [cavitation]).results
    assert found.history is not None
    (temperature,), (power,), (flow,) = heat(found).temperatures, heat(found).films.power, heat(found).films.flow
    assert temperature - SUPPLIED == pytest.approx(0.5 * power / (case.oil.density * 2100.0 * flow), rel=1e-3)
    times, force = found.history.time_s, found.history.force[:, 1]
    rate = 2.0 * np.pi * 20.0
    speed = -found.plan.section.clearance * 0.6 * rate * np.cos(rate * times)
    assert power == pytest.approx(-float(np.mean((force * speed)[-found.plan.steps :])), rel=1e-4)
    assert found.plan.section.viscosity == pytest.approx(heat(found).viscosities[0])


def test_less_than_a_period_has_no_mean() -> None:
    with pytest.raises(InputError, match="less than one period"):
        squeeze(moved("eccentricity=0.6, frequency='20 Hz', periods=0.5"))


SPEED, SUPPLY = [2000.0], 343.15
GRADE = "oil.viscosity={grade='SAE 10W-40'}"


def warm(*settings: str) -> Case:
    thermal = 'thermal={model="lumped", supply_temperature="70 degC"}'
    return frbcli.load_case("thrust", [GRADE, thermal, *settings])


def at(case: Case, gap: float = 10e-6) -> ThrustState:
    (state,) = frbcli.thrust_sheet(case, [gap], SPEED).points
    return state


@pytest.mark.parametrize("mixing", [0.5, 1.0])
def test_loss_leaves_with_the_oil(mixing: float) -> None:
    """P = s Q (T - T_in) / m, with the flow out of the bearing; s is linear between 80 and 120 degC, to 0.2 % that of
    the oil at the mean temperature of inlet and outlet."""
    case = warm(f"thermal.mixing={mixing}")
    state = at(case)
    assert state.temperature is not None
    rise = (state.temperature - SUPPLY) / mixing
    heat = case.oil.density * case.oil.heat_capacity_at(SUPPLY + 0.5 * rise)
    assert state.power == pytest.approx(heat * (state.flow_inner + state.flow_outer) * rise, rel=2e-3)


def test_film_is_that_of_its_viscosity() -> None:
    state = at(warm())
    assert case_law(warm(), state.temperature) == pytest.approx(state.viscosity, rel=1e-12)
    cold = at(frbcli.load_case("thrust", [f"oil.viscosity={state.viscosity!r}"]))
    assert cold.load == pytest.approx(state.load, rel=1e-12)
    assert cold.power == pytest.approx(state.power, rel=1e-12)
    assert cold.stiffness == pytest.approx(state.stiffness, rel=1e-12)


def case_law(case: Case, temperature: float | None) -> float:
    assert case.oil.law is not None
    assert temperature is not None
    return float(case.oil.law.at(temperature))


def test_collar_and_pads_take_heat() -> None:
    """P = s Q (T - T_in) / m + sum of Nu k (T - T_wall) integral of dA / h, that in closed form."""
    wall, gap = 348.15, 10e-6
    case = warm("thermal.shaft=75 degC", "thermal.housing=75 degC")
    (bearing,), state = case.thrust_bearings, at(case, gap)
    assert state.temperature is not None
    tapered = bearing.taper_angle / bearing.taper * np.log1p(bearing.taper / gap)
    sector = tapered + (bearing.pad_angle - bearing.taper_angle) / gap
    inverse = 0.5 * bearing.pads * (bearing.outer_radius**2 - bearing.inner_radius**2) * sector
    passed = 2.0 * 3.77 * case.oil.thermal_conductivity * inverse * (state.temperature - wall)
    heat = case.oil.density * case.oil.heat_capacity_at(state.temperature)
    carried = heat * (state.flow_inner + state.flow_outer) * 2.0 * (state.temperature - SUPPLY)
    assert passed > 0.1 * state.power
    assert state.power == pytest.approx(passed + carried, rel=2e-3)
    beyond = '{capacity="100 J/K", conductance="1e9 W/K", temperature="75 degC"}'
    node = at(warm(f"thermal.shaft={beyond}", "thermal.housing=75 degC"), gap)
    assert node.temperature == pytest.approx(state.temperature, abs=1e-3)


def test_sides_have_temperatures_of_their_own() -> None:
    both = warm("thrust_bearing.0.side=both", "thrust_bearing.0.end_play=40 um")
    (state,) = frbcli.thrust_sheet(both, [10e-6], SPEED).points
    first, other = at(warm(), 10e-6), at(warm(), 30e-6)
    assert state.temperature == first.temperature
    assert state.load == pytest.approx(first.load - other.load, rel=1e-9)
    assert state.power == pytest.approx(first.power + other.power, rel=1e-9)


def test_film_that_is_too_hot_ends_the_sheet() -> None:
    with pytest.raises(NotConverged, match="thrust bearing"):
        at(warm("thermal.hottest_film=100 degC"))
    assert np.isfinite(at(warm("thermal.hottest_film=110 degC")).load)


FOLLOWS = ["thermal.clearance=follows", "thermal.shaft=130 degC", HOT_HOUSING]


def stepped(clearance: str, time: float, duration: float, *settings: str) -> Case:
    step = f'bearing.clearance_steps=[{{time="{time} s",clearance="{clearance}"}}]'
    return single("rotor.gravity=9.81", "film.theory=auto", *STILL, *at_speed(40.0, duration), step, *settings)


@pytest.mark.parametrize(
    ("settings", "step", "duration", "share"),
    [(FOLLOWS, 0.05, 0.15, 0.01), (["film.cavitation=two-phase", *FOLLOWS], 0.05, 0.3, 0.05)],
    ids=["follows", "mass-conserving"],
)
def test_a_run_settles_at_the_temperatures_of_each_clearance(
    settings: list[str], step: float, duration: float, share: float, tmp_path: Path
) -> None:
    """share: of the change in temperature by which a run is off that still refills the gap."""
    case = stepped("45 um", step, duration, *settings)
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    temperature = run["temperature_K"]
    first, last = (warm_machine(case_at(case, t), 40.0).films[0] for t in (0.0, duration))
    change = abs(first.temperature - last.temperature)
    assert change > 1.0
    before = int(np.searchsorted(run["time_s"], step)) - 1
    assert temperature[before] == pytest.approx(first.temperature, abs=share * change)
    assert temperature[-1] == pytest.approx(last.temperature, abs=share * change)
    assert run["clearance_m"][-1] == pytest.approx(last.clearance, rel=1e-6)
    assert np.abs(np.diff(temperature[before - 1 : before + 2])).max() < 0.2 * change  # the temperature does not jump
    assert run.error["heat_balance_relative"] < 1e-9  # type: ignore[operator]


def test_a_run_that_was_put_down_goes_on_with_clearance_and_heat(tmp_path: Path) -> None:
    assert_resumable(stepped("45 um", 0.03, 0.06, "output.step=0.1ms"), tmp_path, 0.02, 0.03, 0.04)


def test_steps_have_no_temperature_beside_a_cold_clearance() -> None:
    cold = ("bearing.clearance={ cold = '30 um', shell_temperature = '90 degC', journal_temperature = '90 degC', "
            "shell_expansion = '2e-5 1/K', journal_expansion = '1e-5 1/K' }")  # fmt: skip
    with pytest.raises(InputError, match="clearances of no temperature"):
        stepped("45 um", 0.1, 0.2, *FOLLOWS, cold)


APART = "film.coupling=co-simulation"
QUICK = ("speed.from=100 Hz", "speed.to=105 Hz", "speed.duration=4 ms", "output.step=1e-4 s", "rotor.unbalance=0",
         "accuracy.steps_per_revolution=2000")  # fmt: skip


def both(tmp_path: Path, case: Case) -> tuple[Run, Run]:
    """Runs of a case: rotor and films together, and in turn."""
    runs = [runup(each, tmp_path / f"{i}.h5") for i, each in enumerate((case, case.with_settings(APART)))]
    return runs[0], runs[1]


KEEPS_OIL = ("film.theory=finite", "film.cavitation=two-phase", "accuracy.mesh=[3, 16]", "speed.duration=1 ms")


def rises(run: Run, *nodes: str) -> list[float]:
    """Temperature rises at the end of a run, K."""
    return [float(np.ptp(run[f"temperature_{node}_K".replace("__", "_")][[0, -1]])) for node in nodes]


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_a_film_that_keeps_its_oil_warms_up_as_in_the_run_in_one(tmp_path: Path) -> None:
    together, apart = both(tmp_path, single(*QUICK, *KEEPS_OIL))
    assert rises(together, "")[0] > 0.2
    assert rises(apart, "") == pytest.approx(rises(together, ""), rel=2e-3)
    np.testing.assert_allclose(apart["eccentricity"], together["eccentricity"], atol=1e-4)
    assert apart.error["heat_balance_relative"] < 1e-9


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_rings_turn_as_their_warm_films_have_them(tmp_path: Path) -> None:
    together, apart = both(tmp_path, ring_case(*QUICK))
    nodes = "inner", "outer", "ring_inner", "ring_outer"
    assert rises(together, *nodes)[0] > 1.0
    assert rises(apart, *nodes) == pytest.approx(rises(together, *nodes), rel=2e-3)
    assert apart["ring_speed_Hz"][-1] == pytest.approx(together["ring_speed_Hz"][-1], rel=1e-3)
    assert apart.error["heat_balance_relative"] < 1e-9
