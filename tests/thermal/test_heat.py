"""Steady heat: the balance of films, rings and walls, its limits, and machines that are warm. Kernels of the balance of
heat against their plain forms."""

import math
from pathlib import Path

import numpy as np
import pytest
from commands import Frb
from printed_sheets import printed

from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import NotConverged
from frbcli.linear.stability import stability
from frbcli.materials import OILS
from frbcli.scene.machine.heat import heat_of, warm_case, warm_system
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.thermal.exchange import (
    BOOKS,
    CARRIED,
    CHANGES,
    CLEARANCE,
    DISSIPATED,
    ETA,
    FILM_ROWS,
    FLOW,
    GIVEN,
    IN_FILMS,
    LENGTH,
    POWER,
    SHARE,
    HeatArrays,
    arrays_of,
    heat_step,
    viscosity_at,
    write_clearances,
    write_rates,
)
from frbcli.thermal.model import HeatModel, clearances_at, rates, viscosities_at

ZERO = 273.15
RING = """
title = "concentric floating ring"
[rotor]
kind = "rigid"
mass = "6 kg"
gravity = "0 m/s^2"
[bearing]
kind = "floating-ring"
ring = { mass = "75 g", inertia = "20 kg*mm^2", conductivity = "60 W/(m*K)" }
[bearing.inner]
width = "20 mm"
diameter = "25 mm"
clearance = "40 um"
supply = { kind = "circumferential-groove", pressure = "2 bar" }
side_flow_factor = 0.6
[bearing.outer]
width = "16 mm"
diameter = "40 mm"
clearance = "50 um"
supply = { kind = "circumferential-groove", pressure = "2 bar" }
[oil]
viscosity = { grade = "SAE 10W-40" }
density = "830 kg/m^3"
heat_capacity = "2100 J/(kg*K)"
conductivity = "0.14 W/(m*K)"
[thermal]
model = "lumped"
supply_temperature = "70 degC"
[speed]
from = "0 Hz"
to = "900 Hz"
duration = "3 s"
"""
CONCENTRIC = "thermal.side_flow=concentric"


def ring_case(*settings: str) -> Case:
    return load_case_text(RING, settings, name="ring")


# --- the concentric limit --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("row", printed("thermal-concentric.csv"), ids=lambda row: f"{row['speed_Hz']:.0f}")
def test_concentric_ring_has_the_temperatures_of_an_independent_balance(row: dict[str, float]) -> None:
    warm = warm_machine(ring_case(CONCENTRIC), row["speed_Hz"])
    inner, outer = warm.films
    (ring,) = warm.rings
    found = (inner.temperature, outer.temperature, ring.inner, ring.outer)
    expected = [row[f"T_{name}_degC"] + ZERO for name in ("inner", "outer", "ring_inner", "ring_outer")]
    assert found == pytest.approx(expected, abs=0.1)
    assert ring.speed_ratio == pytest.approx(row["ring_speed_ratio"], abs=1e-4)
    for film, name in ((inner, "inner"), (outer, "outer")):
        assert 1e3 * film.viscosity == pytest.approx(row[f"eta_{name}_mPas"], rel=2e-3)
        assert film.power == pytest.approx(row[f"P_{name}_W"], rel=2e-3)
        assert 1e6 * film.flow == pytest.approx(row[f"Q_{name}_ml_s"], rel=2e-3)
    assert warm.balance < 1e-6


def independent_balance(
    speed: float, supply: float, mixing: float, nusselt: float, gauge: float, walls: tuple[float | None, float | None]
) -> tuple[np.ndarray, float]:
    """(inner, outer film, ring inside, outside) in K and the ring speed ratio of RING by a root finder of its own;
    walls: temperatures of shaft and housing in K, None: adiabatic."""
    from scipy.optimize import root

    law, omega = OILS["SAE 10W-40"].law, 2.0 * math.pi * speed
    radius, width, clearance = np.array([12.5e-3, 20e-3]), np.array([20e-3, 16e-3]), np.array([40e-6, 50e-6])
    transfer = nusselt * 0.14 / clearance * 2.0 * math.pi * radius * width
    conduction = 2.0 * math.pi * 60.0 * 20e-3 / math.log(40.0 / 25.0)

    def state(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        eta = np.array([law.at(float(x)) for x in t[:2]])
        k = 2.0 * math.pi * eta * radius**3 * width / clearance
        ratio = k[0] / k.sum()
        flow = 2.0 * 2.0 * math.pi * radius * clearance**3 * gauge / (12.0 * eta * 0.5 * width)
        return k * np.array([1.0 - ratio, ratio]) ** 2 * omega**2, flow, float(ratio)

    def left(t: np.ndarray) -> list[float]:
        power, flow, _ = state(t)
        oil = 830.0 * 2100.0 * flow * (t[:2] - supply) / mixing
        to_ring = transfer * (t[:2] - t[2:])
        to_walls = [0.0 if wall is None else h * (x - wall) for wall, h, x in zip(walls, transfer, t, strict=False)]
        through = conduction * (t[2] - t[3])
        films = power - oil - to_ring - np.array(to_walls)
        return [*films, to_ring[0] - through, to_ring[1] + through]

    best = min(
        (root(left, np.full(4, supply + more), method="hybr") for more in (5.0, 20.0, 50.0, 90.0)),
        key=lambda found: float(np.abs(found.fun).max()),
    )
    assert np.abs(best.fun).max() < 1e-6
    return best.x, state(best.x)[2]


@pytest.mark.parametrize("seed", range(12))
def test_other_rings_have_the_temperatures_of_an_independent_balance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    speed, supply, nusselt = rng.uniform(50.0, 1500.0), rng.uniform(20.0, 110.0), rng.uniform(2.0, 8.0)
    mixing, gauge = (0.5, 1.0)[seed % 2], rng.uniform(0.3, 4.0)
    walls = [None if rng.random() < 0.4 else float(rng.uniform(40.0, 160.0)) for _ in range(2)]
    told = [f"thermal.{name}={wall} degC" for name, wall in zip(("shaft", "housing"), walls, strict=True)
            if wall is not None]  # fmt: skip
    pressures = [f"bearing.{side}.supply.pressure={1.0 + gauge} bar" for side in ("inner", "outer")]
    case = ring_case(f"thermal.supply_temperature={supply} degC", f"thermal.mixing={mixing}",
                     f"thermal.nusselt={nusselt}", *pressures, *told)  # fmt: skip
    warm = warm_machine(case, speed)
    kelvin = tuple(None if wall is None else wall + ZERO for wall in walls)
    expected, ratio = independent_balance(speed, supply + ZERO, mixing, nusselt, 1e5 * gauge, kelvin)  # type: ignore[arg-type]
    found = [film.temperature for film in warm.films] + [warm.rings[0].inner, warm.rings[0].outer]
    assert found == pytest.approx(expected.tolist(), abs=0.02)
    assert warm.rings[0].speed_ratio == pytest.approx(ratio, abs=2e-5)


def test_flow_of_a_concentric_film_is_the_formula_with_a_groove() -> None:
    solved = warm_machine(ring_case("bearing.inner.side_flow_factor=1"), 300.0)
    formula = warm_machine(ring_case("bearing.inner.side_flow_factor=1", CONCENTRIC), 300.0)
    for one, other in zip(solved.films, formula.films, strict=True):
        assert one.temperature == pytest.approx(other.temperature, abs=1e-3)
        assert one.flow == pytest.approx(other.flow, rel=1e-4)


def test_check_and_stability_tell_the_same_heat(tmp_path: Path, frb: Frb) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(RING)
    arguments = ["stability", str(file), "--set", CONCENTRIC, "--no-picture", "--json"]
    said = frb(*arguments, "--speed", "900 Hz", "--speed", "300 Hz")
    fast, slow = (point["thermal"] for point in said.document["points"])
    checked = frb("check", str(file), "--set", CONCENTRIC, "--json").document["thermal"]
    assert checked["films"][0]["temperature_K"] == pytest.approx(153.8 + ZERO, abs=0.1)
    assert slow["films"][0]["temperature_K"] == pytest.approx(103.2 + ZERO, abs=0.1)
    assert fast["rings"][0]["speed_ratio"] == pytest.approx(checked["rings"][0]["speed_ratio"], abs=1e-6)
    assert set(checked["films"][0]) >= {"film", "temperature_K", "viscosity_Pa_s", "power_W", "flow_m3_s"}
    assert set(checked["rings"][0]) == {"ring", "inner_K", "outer_K", "speed_ratio"}
    assert checked["balance_relative"] < 1e-6


def test_heat_is_told_in_words(tmp_path: Path, frb: Frb) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(RING)
    frb("check", str(file), "--json")  # compiles what is not on disk
    told = frb("check", str(file)).out
    assert "heat at the top speed" in told
    assert "W leave with the oil" in told


# --- closed forms ----------------------------------------------------------------------------------------------------

SINGLE = ["thermal.supply_temperature=50 degC", "oil.viscosity={ grade = 'SAE 10W-40' }", "rotor.gravity=0",
          "oil.density=830 kg/m^3", "oil.heat_capacity=2100 J/(kg*K)", "oil.conductivity=0.14 W/(m*K)",
          "bearing.supply.pressure=2 bar", "film.theory=short"]  # fmt: skip


def single(*settings: str) -> Case:
    return load_case("jeffcott", [*SINGLE, *settings])


@pytest.mark.parametrize("mixing", [0.5, 1.0])
def test_adiabatic_film_warms_by_its_power_over_its_flow(mixing: float) -> None:
    (film,) = warm_machine(single(f"thermal.mixing={mixing}"), 200.0).films
    rise = film.temperature - 50.0 - ZERO
    assert rise == pytest.approx(mixing * film.power / (830.0 * 2100.0 * film.flow), rel=1e-6)
    radius, width, clearance, omega = 12.5e-3, 20e-3, 35e-6, 2.0 * math.pi * 200.0
    petrov = 2.0 * math.pi * film.viscosity * omega**2 * radius**3 * width / clearance
    assert film.power == pytest.approx(petrov, rel=1e-6)
    flow = 2.0 * math.pi * 2.0 * radius * clearance**3 * 1e5 / (12.0 * film.viscosity * 0.5 * width)
    assert film.flow == pytest.approx(flow, rel=1e-4)


def test_walls_of_given_temperature_and_nodes_take_heat() -> None:
    transfer = 3.77 * 0.14 / 35e-6 * 2.0 * math.pi * 12.5e-3 * 20e-3
    given = warm_machine(single("thermal.housing=60 degC"), 200.0)
    (film,) = given.films
    assert given.steady.given == pytest.approx(transfer * (film.temperature - 60.0 - ZERO), rel=1e-6)
    node = "thermal.housing={ capacity = '100 J/K', conductance = '5 W/K', temperature = '60 degC' }"
    through = warm_machine(single(node), 200.0)
    (film,) = through.films
    series = 1.0 / (1.0 / transfer + 1.0 / 5.0)
    assert through.steady.given == pytest.approx(series * (film.temperature - 60.0 - ZERO), rel=1e-6)
    assert through.balance < 1e-6


ROTATION = [
    "bearing.supply={ kind = 'circumferential-groove', pressure = '2 bar' }", "oil.heat_capacity=2100 J/(kg*K)",
    'oil.viscosity={ grade = "SAE 10W-40" }', "motion={eccentricity=0.6, angle='-60 deg', speed='50 Hz'}",
]  # fmt: skip
WARM_ROTATION = [*ROTATION, "thermal.model=lumped", "thermal.supply_temperature=50 degC"]


@pytest.mark.parametrize("cavitation", ["half-sommerfeld", "two-phase"])
def test_rotation_has_the_film_whose_heat_balances(cavitation: str) -> None:
    """Without walls the film warms by half of its power over its flow, and its forces are those of that temperature."""
    case = load_case("bearing", WARM_ROTATION)
    (result,) = rotation(case, [cavitation]).results
    assert result.heat is not None
    assert result.loads is not None
    (temperature,), (power,), (flow,) = result.heat.temperatures, result.heat.films.power, result.heat.films.flow
    assert temperature - 50.0 - ZERO == pytest.approx(0.5 * power / (case.oil.density * 2100.0 * flow), rel=1e-4)
    assert power == pytest.approx(-result.loads.torque.journal * 100.0 * math.pi, rel=1e-6)
    assert result.heat.balance < 1e-5
    alike = load_case("bearing", [*ROTATION, f"oil.temperature={temperature} K"])
    (same,) = rotation(alike, [cavitation]).results
    assert same.loads is not None
    assert result.loads.force == pytest.approx(same.loads.force, rel=1e-5)


def test_rotation_under_a_load_with_heat_is_told(frb: Frb) -> None:
    """More load makes the film thinner and its oil hotter."""
    found = []
    for load in (100, 400):
        motion = f"motion={{load='{load} N', speed='50 Hz'}}"
        sets = [word for setting in [*WARM_ROTATION[:3], *WARM_ROTATION[4:], motion] for word in ("--set", setting)]
        said = frb("rotation", "bearing", *sets, "--cavitation", "half-sommerfeld", "--no-picture", "--json")
        (result,) = said.document["results"]
        assert result["force_N"] == pytest.approx([0.0, load], abs=1e-3 * load)
        (film,) = result["thermal"]["films"]
        found.append((film["power_W"], film["flow_m3_s"], film["temperature_K"]))
    assert found[1][0] > found[0][0] * 0.9
    assert found[1][1] > found[0][1]  # an eccentric film loses more oil
    said = frb("rotation", "bearing", *sets, "--cavitation", "half-sommerfeld", "--no-picture")
    assert "the film when it is warm" in said.out


def test_a_bearing_may_have_walls_and_supply_of_its_own() -> None:
    own = single("thermal.housing=60 degC", "bearing.housing=adiabatic", "bearing.supply_temperature=40 degC")
    other = single("thermal.supply_temperature=40 degC")
    one, two = (warm_machine(case, 200.0).films[0] for case in (own, other))
    assert one.temperature == pytest.approx(two.temperature)


def test_clearances_follow_shaft_and_housing() -> None:
    """(4.24): with both parts of steel at given temperatures."""
    walls = ["thermal.shaft=120 degC", "thermal.housing=70 degC", "thermal.clearance=follows"]
    (film,) = warm_machine(single(*walls), 200.0).films
    assert film.clearance == pytest.approx(35e-6 + 12.5e-3 * 1.18e-5 * (70.0 - 120.0), rel=1e-9)
    cold = ("bearing.clearance={ cold = '30 um', shell_temperature = '90 degC', journal_temperature = '90 degC', "
            "shell_expansion = '2e-5 1/K', journal_expansion = '1e-5 1/K' }")  # fmt: skip
    (film,) = warm_machine(single(*walls, cold), 200.0).films
    assert film.clearance == pytest.approx(30e-6 + 12.5e-3 * (2e-5 * 50.0 - 1e-5 * 100.0), rel=1e-9)
    (film,) = warm_machine(single("thermal.centrifugal_growth=follows"), 900.0).films
    growth = 0.25 * 7870.0 * (2.0 * math.pi * 900.0 * 12.5e-3) ** 2 * 0.73 / 210e9 * 12.5e-3
    assert film.clearance == pytest.approx(35e-6 - growth, rel=1e-9)


# --- trends ----------------------------------------------------------------------------------------------------------


def test_threshold_is_that_of_the_warm_machine() -> None:
    """The case at the viscosity that the film has at the threshold has the same threshold."""
    loaded = ["rotor.gravity=9.81", "thermal.supply_temperature=90 degC"]
    found = stability(single(*loaded), [150.0], threshold=True).threshold
    assert found is not None
    film = warm_machine(single(*loaded), found.speed_Hz).films[0]
    viscosity = f"oil.viscosity={film.viscosity}"
    isothermal = load_case("jeffcott", [*SINGLE[6:], "oil.density=830 kg/m^3", "rotor.gravity=9.81", viscosity])
    again = stability(isothermal, [150.0], threshold=True).threshold
    assert again is not None
    assert again.speed_Hz == pytest.approx(found.speed_Hz, rel=1e-4)


# --- a warm machine without new tables -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "settings",
    [
        [],
        ["bearing.supply.pressure=1 bar"],
        ["film.theory=short"],
        ["film.cavitation=reynolds"],
        ["film.cavitation=two-phase"],
    ],
    ids=str,
)
def test_scaled_film_is_the_film_of_that_viscosity_and_clearance(settings: list[str]) -> None:
    case = load_case("jeffcott", ["bearing.supply.pressure=2 bar", *settings])
    plan = make_plan(case)
    system = make_system(case, plan)
    warm, clearance = np.array([7e-3]), np.array([31e-6])
    scaled = warm_system(case, plan, system, warm, clearance)
    again = make_system(warm_case(case, warm, clearance), plan)
    assert scaled.drags == pytest.approx(again.drags)
    place, velocity = np.array([12e-6, -9e-6]), np.array([1e-4, 2e-4])
    one, other = (machine.films.force(0, place, velocity, 900.0) for machine in (scaled, again))
    for name in ("force", "by_displacement", "by_velocity"):
        expected = getattr(other, name)
        assert np.allclose(getattr(one, name), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


# --- what leaves a film ----------------------------------------------------------------------------------------------


# --- bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (["bearing.inner.supply.pressure=1 bar", "bearing.outer.supply.pressure=1 bar"], "no way out"),
        (["thermal.hottest_film=120 degC"], "film inner becomes hotter"),
        (["thermal.clearance=follows", "thermal.shaft=280 degC", "thermal.shaft_material=aluminium",
          "bearing.inner.clearance=20 um"], "closes the gap of the film inner"),
    ],
)  # fmt: skip
def test_heat_that_does_not_balance_is_told(settings: list[str], words: str) -> None:
    with pytest.raises(NotConverged, match=words):
        warm_machine(ring_case(*settings), 900.0)


def step_of(model: HeatModel, now: np.ndarray, step: float, t: np.ndarray, last: np.ndarray, books: np.ndarray) -> None:
    """heat_step as runs have it: the temperatures of the films go on as in the last step."""
    ratio = step / last[LENGTH] if last[LENGTH] > 0.0 else 0.0
    ahead = t + ratio * last[CHANGES:]
    heat_step(kernel_arrays(model), now, step, t, ahead, last, np.zeros(len(t)), books)


def kernel_arrays(model: HeatModel) -> HeatArrays:
    return arrays_of(model, np.ones(2), np.ones(2), np.ones(2), by_formula=False)


def test_kernels_of_the_balance_are_their_plain_forms() -> None:
    case = ring_case("thermal.clearance=follows", "thermal.centrifugal_growth=follows", "thermal.housing=60 degC",
                     "thermal.shaft={ capacity = 40, conductance = 2, temperature = '200 degC' }")  # fmt: skip
    heat = heat_of(case)
    model = heat.model._replace(inlet=np.array([1, -1]))
    rng = np.random.default_rng(4)
    t = heat.start + 60.0 * rng.random(len(heat.start))
    power, flow, speeds = np.array([300.0, 80.0]), np.array([8e-7, 2e-6]), np.array([4000.0, 800.0])
    now, gain, state = np.zeros((FILM_ROWS, 2)), np.empty(len(t)), np.concatenate([np.zeros(BOOKS), speeds, t])
    now[POWER], now[FLOW] = power, flow
    capacity, links, films, numbers, growth = kernel_arrays(model)
    write_clearances(films, growth, len(speeds), state, now)
    clearances = now[CLEARANCE]
    assert clearances == pytest.approx(clearances_at(model, t, speeds), rel=1e-12)
    carried, given = write_rates(capacity, links, films, numbers, now, t, gain)
    assert gain == pytest.approx(rates(model, t, power, flow, clearances), rel=1e-9, abs=1e-9)
    assert float(gain.sum()) == pytest.approx(380.0 - carried, rel=1e-9)
    assert given == pytest.approx(float(gain[np.isinf(model.capacity)].sum()), rel=1e-12)
    assert [viscosity_at(numbers, x) for x in t[:2]] == pytest.approx(viscosities_at(model, t), rel=1e-12)


def test_step_of_heat_is_that_of_the_rates_and_loses_nothing() -> None:
    heat = heat_of(ring_case("thermal.housing=60 degC"))
    model, count = heat.model, len(heat.start)
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    t, last, books = heat.start.copy(), np.zeros(CHANGES + count), np.zeros(BOOKS)
    step = 1e-7
    step_of(model, now, step, t, last, books)
    expected = step * rates(model, heat.start, now[POWER], now[FLOW], now[CLEARANCE]) / model.capacity
    assert t - heat.start == pytest.approx(expected, rel=1e-6, abs=1e-12)
    for _ in range(200):
        step_of(model, now, 1e-2, t, last, books)  # longer than the films' time constants
    free = np.isfinite(model.capacity)
    kept = float(model.capacity[free] @ (t - heat.start)[free])
    assert books[DISSIPATED] == pytest.approx(380.0 * (2.0 + step), rel=1e-12)
    assert books[DISSIPATED] == pytest.approx(books[CARRIED] + books[GIVEN] + kept, rel=1e-10)


def test_a_long_step_of_heat_ends_in_balance_and_loses_nothing() -> None:
    """Steps a thousand times as long as nodes of little capacity take."""
    node = "{ capacity = 1e-15, conductance = 2, temperature = 330 }"
    heat = heat_of(ring_case(f"thermal.shaft={node}", f"thermal.housing={node}"))
    model, count = heat.model._replace(inlet=np.array([1, -1])), len(heat.start)
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    t, last, books = heat.start.copy(), np.zeros(CHANGES + count), np.zeros(BOOKS)
    for _ in range(30):
        step_of(model, now, 10.0, t, last, books)
    free = np.isfinite(model.capacity)
    assert rates(model, t, now[POWER], now[FLOW], now[CLEARANCE])[free] == pytest.approx(0.0, abs=1e-9 * 380.0)
    kept = float(model.capacity[free] @ (t - heat.start)[free])
    assert books[DISSIPATED] == pytest.approx(books[CARRIED] + books[GIVEN] + kept, rel=1e-10)


def test_films_in_balance_gain_nothing() -> None:
    """Power proportional to the viscosity, flow to its inverse; the inner film is fed through the outer one."""
    heat = heat_of(ring_case("thermal.housing=60 degC", "thermal.films=quasi-steady"))
    model = heat.model._replace(inlet=np.array([1, -1]))
    assert model.balanced
    now = np.zeros((FILM_ROWS, 2))
    now[POWER], now[FLOW], now[CLEARANCE], now[SHARE] = (300.0, 80.0), (8e-7, 2e-6), model.reference, 1.0
    now[ETA] = viscosities_at(model, heat.start)
    t, last, books = heat.start.copy(), np.zeros(CHANGES + len(heat.start)), np.zeros(BOOKS)
    step_of(model, now, 1e-12, t, last, books)
    thicker = viscosities_at(model, t) / now[ETA]
    handed_on = now[FLOW] / (1.0, thicker[1])  # what the inner film has let out
    for film, flow in ((0, now[FLOW] / thicker), (1, handed_on)):
        left = rates(model, t, now[POWER] * thicker, flow, now[CLEARANCE])
        assert left[film] == pytest.approx(0.0, abs=1e-6)
    assert t[0] > heat.start[0] + 5.0
    assert t[2:] == pytest.approx(heat.start[2:], abs=1e-6)
    assert books[IN_FILMS] == 0.0
