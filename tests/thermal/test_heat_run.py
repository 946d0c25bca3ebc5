"""Heat in runs: its balance, where a run settles, what films on cells and clearances make of it, and how it is told."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from commands import Frb
from resumed import assert_resumable
from test_heat import RING, ring_case, single

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import NotConverged
from frbcli.materials import OILS
from frbcli.plot.motion import quantity_figure
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.machine.heat import heat_of, warm_case
from frbcli.studies.compare import compare

HOUSING = "thermal.housing=60 degC"
HOT_HOUSING = "thermal.housing=100 degC"
STILL = ["rotor.unbalance=0", "start.position=resting"]


def at_speed(speed: float, duration: float) -> list[str]:
    return [f"speed.from={speed}", f"speed.to={speed}", f"speed.duration={duration}"]


def test_walls_that_store_next_to_nothing_run_as_those_that_store_little(tmp_path: Path) -> None:
    def run_of(capacity: float) -> Run:
        node = f"thermal.housing={{ capacity = {capacity}, conductance = 2, temperature = '90 degC' }}"
        return runup(single("rotor.gravity=9.81", *at_speed(40.0, 0.05), "thermal.clearance=follows", node),
                     tmp_path / "run.h5", force=True)  # fmt: skip

    little = run_of(1e-5)
    for capacity in (1e-9, 1e-15):
        run = run_of(capacity)
        for name in ("temperature_K", "temperature_housing_K"):  # one for a step, in which they rise by 0.3 K at first
            np.testing.assert_allclose(run[name][1:], little[name][1:], rtol=0.0, atol=0.5)
            assert run[name][-1] == pytest.approx(little[name][-1], abs=0.01)
        np.testing.assert_allclose(run["eccentricity"], little["eccentricity"], rtol=0.0, atol=2e-4)
        assert run.cost["steps"] < 1.2 * little.cost["steps"]
        assert run.error["heat_balance_relative"] < 1e-9  # type: ignore[operator]


def warming(steps: int, path: Path) -> Run:
    """A plain film that warms up at 40 Hz, with so many steps per revolution."""
    fine = ("accuracy.tolerance=1e-6", f"accuracy.steps_per_revolution={steps}", "output.step=1ms")
    return runup(single("rotor.gravity=9.81", "film.theory=short", *STILL, *at_speed(40.0, 0.1), *fine), path)


def test_temperatures_are_of_second_order_in_the_step(tmp_path: Path) -> None:
    """With viscosities of the step before the first of these has errors of 4e-2 K and 1e-4 of the clearance."""
    exact, *runs = (warming(steps, tmp_path / f"{steps}.h5") for steps in (1280, 40, 80, 160))
    for name, largest in (("temperature_K", 1e-3), ("eccentricity", 1e-5)):
        errors = [float(np.abs(run[name] - exact[name]).max()) for run in runs]
        assert errors[0] < largest
        assert np.diff(np.log2(errors)) == pytest.approx(-2.0, abs=0.25)


def test_a_warm_rotor_comes_to_rest(tmp_path: Path) -> None:
    """Temperatures that go on as in the last step end where nothing moves any more."""
    case = single("rotor.gravity=9.81", "film.theory=short", *STILL, *at_speed(40.0, 3.0), "output.step=1ms",
                  "thermal.housing=75 degC", "thermal.films=states")  # fmt: skip
    run = runup(case, tmp_path / "run.h5")
    settled = run["time_s"] > 2.7
    assert np.ptp(run["temperature_K"][settled]) < 1e-11
    assert np.ptp(run["eccentricity"][settled]) < 1e-12


# --- where a run settles ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "settings",
    [
        ["film.theory=short", "thermal.mixing=1", "thermal.housing=75 degC"],
        ["film.cavitation=reynolds"],
        ["film.cavitation=two-phase", "thermal.clearance=follows", "thermal.shaft=130 degC", HOT_HOUSING],
        # The bulk modulus of its oil is infinite: fronts pass whole cells, and in longer steps by 0.06 K of chance.
        ["film.cavitation=elrod", HOT_HOUSING, "accuracy.tolerance=1e-6"],
    ],
    ids=str,
)
def test_run_at_constant_speed_settles_at_the_steady_temperatures(settings: list[str], tmp_path: Path) -> None:
    case = single("rotor.gravity=9.81", "film.theory=auto", *STILL, *at_speed(40.0, 0.4), *settings)
    run = runup(case, tmp_path / "run.h5")
    (film,) = warm_machine(case, 40.0).films
    assert run.status == "finished"
    assert run["temperature_K"][-1] == pytest.approx(film.temperature, abs=0.05)
    assert run["eccentricity"][-1] == pytest.approx(run["eccentricity"][-200], abs=1e-3)  # no whirl
    assert run["power_W"][-1] == pytest.approx(film.power, rel=2e-3)
    # the cells of a mass-conserving film turn in a run, and those of a film at rest do not
    turning = "oil_fraction" in run.signals
    assert run["flow_m3_s"][-1] == pytest.approx(film.flow, rel=4e-2 if turning else 1e-2)
    assert run["clearance_m"][-1] == pytest.approx(film.clearance, rel=1e-6)
    balance = run.error["heat_balance_relative"]
    assert balance is not None
    assert balance < 1e-9


def slow_ring(*settings: str) -> Case:
    light = ["rotor.gravity=9.81", "bearing.ring.heat_capacity=40 J/(kg*K)", "bearing.inner.side_flow_factor=1"]
    return ring_case(*light, *STILL, *settings)


def test_ring_settles_at_the_steady_temperatures(tmp_path: Path) -> None:
    case = slow_ring(*at_speed(50.0, 4.0), "thermal.supply_temperature=40 degC")
    run = runup(case, tmp_path / "run.h5")
    warm = warm_machine(case, 50.0)
    (ring,) = warm.rings
    assert run["eccentricity_outer"][-1] == pytest.approx(math.hypot(*_outer(warm)), abs=1e-3)  # no whirl
    assert run["temperature_inner_K"][-1] == pytest.approx(warm.films[0].temperature, abs=0.1)
    assert run["temperature_ring_inner_K"][-1] == pytest.approx(ring.inner, abs=0.1)
    assert run["temperature_ring_outer_K"][-1] == pytest.approx(ring.outer, abs=0.1)
    assert run["ring_speed_Hz"][-1] / 50.0 == pytest.approx(ring.speed_ratio, rel=1e-3)


def _outer(warm: object) -> np.ndarray:
    system = warm.system  # type: ignore[attr-defined]
    return np.asarray(warm.resting.journals[1] / system.clearances[1])  # type: ignore[attr-defined]


SIGNALS = 'output.signals=["force", "film-thickness", "power", "torque", "oil-flow"]'


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param(["film.theory=short"], id="closed form"),
        pytest.param([], id="tabulated", marks=pytest.mark.nightly),
        pytest.param(["film.cavitation=two-phase"], id="mass-conserving", marks=pytest.mark.nightly),
    ],
)
def test_chosen_signals_are_those_of_the_warm_films(settings: list[str], tmp_path: Path) -> None:
    """At rest: the weight on the film, power as torque times speed, flow and gap as the heat of the run has them."""
    given = ["rotor.gravity=9.81", "film.theory=auto", *STILL, *at_speed(40.0, 0.2), "thermal.clearance=follows",
             "thermal.housing=120 degC", *settings]  # fmt: skip
    plain, run = (runup(single(*given, *more), tmp_path / "run.h5", force=True) for more in ([], [SIGNALS]))
    for name in plain.signals:
        np.testing.assert_array_equal(plain[name], run[name])
    later, omega = slice(len(run["time_s"]) // 2, None), 2.0 * math.pi * 40.0
    force = np.column_stack([run["film_force_x_N"], run["film_force_y_N"]])[later]
    assert run["viscosity_Pa_s"][-1] < 0.8 * run["viscosity_Pa_s"][0]
    assert np.abs(run["clearance_m"][-1] - run["clearance_m"][0]) > 2e-6
    np.testing.assert_allclose(force, [[0.0, 6.1 * 9.81 / 2.0]] * len(force), atol=0.15)  # the oil still settles
    np.testing.assert_allclose(-run["torque_N_m"][later] * omega, run["power_W"][later], rtol=4e-3)  # one for a step
    gap = (1.0 - run["eccentricity"]) * run["clearance_m"]
    np.testing.assert_allclose(run["film_thickness_m"], gap, rtol=1e-4)
    flow = run["flow_m3_s"][later]
    np.testing.assert_allclose(run["oil_flow_m3_s"][later], flow, rtol=5e-2 if "oil_fraction" in run.signals else 4e-3)
    assert np.mean(run["oil_flow_m3_s"][later]) == pytest.approx(np.mean(flow), rel=2e-3)  # cells that turn ripple


# --- the balance of a run --------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def ring_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    case = ring_case("rotor.gravity=9.81", "speed.to=300 Hz", "speed.duration=0.5 s", "thermal.housing=60 degC",
                     "output.step=2e-5 s")  # fmt: skip
    return runup(case, tmp_path_factory.mktemp("ring") / "run.h5")


def test_heat_of_a_run_up_balances_by_its_signals(ring_run: Run) -> None:
    """What the signals say of power, flow and temperatures, not the books of the run."""
    model, t = heat_of(ring_case("thermal.housing=60 degC")).model, ring_run["time_s"]
    names = ("inner", "outer", "ring_inner", "ring_outer")
    warm = {name: ring_run[f"temperature_{name}_K"] for name in names}
    whole = sum(np.trapezoid(ring_run[f"power_{film}_W"], t) for film in names[:2])
    rise = {film: warm[film] - model.supply[0] for film in names[:2]}
    oil = sum(np.trapezoid(830.0 * 2100.0 * ring_run[f"flow_{film}_m3_s"] * rise[film] / 0.5, t) for film in names[:2])
    transfer = 3.77 * 0.14 / 50e-6 * math.pi * 40e-3 * 16e-3
    housing = np.trapezoid(transfer * (warm["outer"] - 333.15), t)
    kept = sum(c * (warm[name][-1] - warm[name][0]) for c, name in zip(model.capacity, names, strict=False))
    assert whole == pytest.approx(oil + housing + kept, rel=1e-3)
    assert ring_run.cost["heat_dissipated_J"] == pytest.approx(whole, rel=1e-3)
    assert ring_run.error["heat_balance_relative"] < 1e-9  # type: ignore[operator]


COUPLED = [
    "bearing.channels=coupled", "film.cavitation=two-phase", "film.two-phase.steepness=0.9", "accuracy.mesh=[5,32]",
    'bearing.inner.supply={ kind = "bores", count = 6, diameter = "2.5 mm", pressure = "2 bar" }',
    'bearing.outer.supply={ kind = "circumferential-groove", pressure = "2 bar", axial_position = 1 }',
]  # fmt: skip


def test_oil_through_coupled_channels_brings_the_heat_of_the_outer_film(tmp_path: Path) -> None:
    """The oil that leaves the inner film was warmed in the outer one first, and what it took along is missing there. By
    the signals, within what steps of 0.8 ms make of films that settle in 3 ms."""
    case = ring_case(*COUPLED, "rotor.gravity=9.81", "speed.from=60 Hz", "speed.to=100 Hz", "speed.duration=0.06 s",
                     "output.step=1e-5 s", "thermal.housing=90 degC")  # fmt: skip
    run = runup(case, tmp_path / "run.h5")
    t, heat, supply = run["time_s"], 830.0 * 2100.0, 343.15
    assert heat_of(case).model.inlet.tolist() == [1, -1]
    assert run.status == "finished"
    inner, outer = (run[f"temperature_{film}_K"] for film in ("inner", "outer"))
    let_out = [run[f"flow_{film}_m3_s"] for film in ("inner", "outer")]
    through = let_out[0] * (outer - supply)
    leaves = (let_out[0] * (inner - outer) + let_out[1] * (outer - supply)) / 0.5
    assert outer[-1] > inner[-1] > supply + 1.0  # the housing warms the outer film
    assert np.trapezoid(heat * (through + leaves), t) == pytest.approx(run.cost["heat_carried_J"], rel=0.015)
    assert np.trapezoid(through, t) > 0.05 * np.trapezoid(through + leaves, t)
    dissipated = sum(np.trapezoid(run[f"power_{film}_W"], t) for film in ("inner", "outer"))
    assert run.cost["heat_dissipated_J"] == pytest.approx(dissipated, rel=1e-3)
    assert run.error["heat_balance_relative"] < 1e-9  # type: ignore[operator]
    assert run.error["oil_balance_relative"] < 1e-3  # type: ignore[operator]


def test_channels_that_open_to_a_groove_bring_oil_of_the_supply() -> None:
    groove = 'bearing.outer.supply={ kind = "circumferential-groove", pressure = "2 bar" }'
    assert heat_of(ring_case(*COUPLED[:-1], groove)).model.inlet.tolist() == [-1, -1]


def test_film_error_of_a_run_is_that_of_its_warm_gap(tmp_path: Path) -> None:
    """A warm journal in a cold shell leaves 70 % of the cold clearance: the errors are those of a film made so."""
    case = single("rotor.gravity=200", *STILL, *at_speed(40.0, 0.4), "thermal.clearance=follows",
                  "thermal.shaft=90 degC", "thermal.housing=20 degC", "thermal.nusselt=200")  # fmt: skip
    (film,) = warm_machine(case, 40.0).films
    alike = warm_case(case, np.array([film.viscosity]), np.array([film.clearance]))
    warm, made = (runup(each, tmp_path / "run.h5", force=True) for each in (case, alike))
    assert film.clearance < 0.75 * 35e-6
    assert warm["eccentricity"][-1] > 0.3
    assert warm["eccentricity"][-1] == pytest.approx(made["eccentricity"][-1], abs=5e-3)
    error, expected = (run.error["film_force_relative"] for run in (warm, made))
    assert error == pytest.approx(expected, rel=0.3)  # type: ignore[arg-type]


def test_films_in_balance_at_each_instant_are_like_those_that_store_heat(ring_run: Run, tmp_path: Path) -> None:
    """Beside a ring and a wall a film settles within 2 to 5 ms, in which these temperatures change by 0.3 K."""
    settings = ("rotor.gravity=9.81", "speed.to=300 Hz", "speed.duration=0.5 s", "thermal.housing=60 degC")
    run = runup(ring_case(*settings, "output.step=2e-5 s", "thermal.films=quasi-steady"), tmp_path / "run.h5")
    later = slice(len(run) // 2, None)
    for name, bound in (("inner", 0.5), ("outer", 0.5), ("ring_inner", 0.15), ("ring_outer", 0.15)):
        apart = np.abs(run[f"temperature_{name}_K"] - ring_run[f"temperature_{name}_K"])[later].max()
        assert 0.0 < apart < bound, name
    assert run["ring_speed_Hz"][-1] == pytest.approx(ring_run["ring_speed_Hz"][-1], rel=5e-3)
    assert run.cost["heat_dissipated_J"] == pytest.approx(ring_run.cost["heat_dissipated_J"], rel=1e-2)
    assert run.error["heat_balance_relative"] < 1e-3  # type: ignore[operator]


def test_a_run_that_was_interrupted_goes_on_as_if_it_had_not(tmp_path: Path) -> None:
    case = single("speed.duration=0.2 s", "film.cavitation=two-phase", "film.theory=auto", "speed.to=100 Hz",
                  "thermal.clearance=follows", HOUSING)  # fmt: skip
    assert_resumable(case, tmp_path, 0.1)


def test_without_heat_a_run_tells_none(tmp_path: Path) -> None:
    settings = ["thermal.model=none", "oil.temperature=70 degC", "speed.duration=0.1 s"]
    run = runup(single(*settings), tmp_path / "run.h5")
    assert not [name for name in run.signals if "temperature" in name or "power" in name]
    assert not [name for name in (*run.cost, *run.error) if "heat" in name]


# --- how it ends, and how it is told ---------------------------------------------------------------------------------
def test_a_film_that_boils_ends_the_run_with_its_name(tmp_path: Path, frb: Frb) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(RING)
    settings = ["--set", "thermal.hottest_film=90 degC", "--set", "speed.duration=0.5 s", "--no-picture"]
    document = frb("runup", str(file), *settings, "-o", str(tmp_path / "run.h5"), "--json", code=3).document
    assert document["status"] == "overheated"
    assert 0.0 < document["t_end_s"] < 0.5
    told = " ".join("".join(frb("runup", str(file), *settings, "-o", str(tmp_path / "run.h5"), code=3)).split())
    assert "film inner became too hot (90 degC, thermal.hottest_film)" in told


def test_a_gap_that_heat_closes_before_the_start_is_told(tmp_path: Path) -> None:
    """A journal of 290 degC grows by 40 um, twice the clearance."""
    case = single("thermal.clearance=follows", "thermal.shaft=290 degC", "thermal.housing=20 degC",
                  "bearing.clearance=20 um", "speed.duration=0.1 s")  # fmt: skip
    with pytest.raises(NotConverged, match="closes the gap of the film at the temperatures that the run begins with"):
        runup(case, tmp_path / "run.h5")


def test_heat_of_a_run_is_printed_and_drawn(ring_run: Run, tmp_path: Path, frb: Frb) -> None:
    assert len(quantity_figure([ring_run], "heat").axes) == 4
    assert len(quantity_figure([ring_run, ring_run], "heat", over="speed").axes) == 4
    frb("plot", str(ring_run.path), "--what", "heat", "-o", str(tmp_path / "heat.png"))
    assert (tmp_path / "heat.png").stat().st_size > 10_000
    file = tmp_path / "ring.toml"
    file.write_text(RING)
    short = ["--set", "speed.duration=0.02 s", "--no-picture"]
    told = " ".join(frb("runup", str(file), *short, "-o", str(tmp_path / "r.h5")).out.split())
    assert "J with the oil" in told
    assert "unaccounted for" in told


def _petrov(run: Run) -> float:
    """W of concentric films of RING at 70 degC and the speeds at the end of a run."""
    eta, rotor, ring = OILS["SAE 10W-40"].law.at(343.15), run["speed_Hz"][-1], run["ring_speed_Hz"][-1]
    films = ((12.5e-3, 20e-3, 40e-6, rotor - ring), (20e-3, 16e-3, 50e-6, ring))
    return sum(2.0 * math.pi * eta * r**3 * b * (2.0 * math.pi * slip) ** 2 / c for r, b, c, slip in films)


def test_comparison_with_and_without_heat(tmp_path: Path) -> None:
    case = ring_case("speed.to=200 Hz", "speed.duration=0.1 s")
    found = compare(case, thermals=("none", "lumped"), keep=tmp_path)
    without, with_heat = found.results
    assert (without.variant.thermal, with_heat.variant.thermal) == ("none", "lumped")
    assert without.loss > with_heat.loss > 0.0  # colder oil is thicker
    assert without.loss == pytest.approx(_petrov(without.run), rel=0.02)
    assert with_heat.ring_ratios["ring_speed_Hz"] < without.ring_ratios["ring_speed_Hz"]


def test_comparison_with_heat_is_a_table(tmp_path: Path, frb: Frb) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(RING)
    short = ["--set", "speed.duration=0.05 s", "--set", "speed.to=100 Hz", "--no-picture"]
    out = frb("compare", str(file), "--thermal", "none,lumped", *short).out
    assert re.search(r"ring over *\n.* rotor ", out)  # a head may take two lines
    assert re.search(r"with heat +0\.\d+ ", out)
    frb("compare", str(file), "--thermal", "warm", *short, code=2)


def test_shipped_case_without_heat_says_what_is_missing(frb: Frb) -> None:
    assert "thermal.supply_temperature" in frb("compare", "jeffcott", "--thermal", "none,lumped", code=2).err
    assert load_case("jeffcott").heat is None
