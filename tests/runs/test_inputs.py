"""Inputs over time: pressure and temperature of the supply, temperature of walls, and onsets while the oil warms up.

The whirl of a cold start begins to grow where the machine at the temperature, pressure and speed of that moment has its
threshold of stability. A whirl that grows is seen later than that: its amplitude is exp of the integral of the growth
rate. So a small whirl is followed from the start, and the moment is that at which it neither decays nor grows.
"""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marches import planned_system
from resumed import assert_resumable

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.reading.time_tables import inputs_of
from frbcli.equilibrium.resting import resting_position
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import InputError
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.inputs import RunInputs
from frbcli.runs.run import rundown, runup
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.inputs import value_at

ZERO = 273.15
STILL = ["rotor.unbalance=0", "start.position=resting"]
HEAT = ['oil.viscosity={ grade = "SAE 10W-40" }', "oil.density=830", "thermal.supply_temperature=50 degC",
        "thermal.housing=60 degC"]  # fmt: skip
CELLS = ["film.cavitation=penalty", "film.solution=cells", "accuracy.mesh=[4, 16]"]


def points(*rows: tuple[float, str]) -> str:
    return "[" + ", ".join(f'["{time} s", "{value}"]' for time, value in rows) + "]"


def pressure(*rows: tuple[float, str]) -> str:
    return f"bearing.supply.pressure={points(*rows)}"


def supplied(*rows: tuple[float, str]) -> str:
    return f"thermal.supply_temperature={points(*rows)}"


def at_speed(speed: float, duration: float) -> list[str]:
    return [f"speed.from={speed}", f"speed.to={speed}", f"speed.duration={duration}"]


def machine(*settings: str) -> frbcli.Case:
    """Films that are not on cells are short ones: one time loop serves all these runs."""
    short = [] if "film.solution=cells" in settings else ["film.theory=short"]
    return load_case("jeffcott", [*short, *settings])


@pytest.mark.parametrize("heat", [False, True], ids=["cold", "heat"])
def test_a_table_of_one_value_is_the_value(heat: bool, tmp_path: Path) -> None:
    """Bit for bit; the last row lies beyond the end."""
    common = [*(HEAT if heat else []), *at_speed(60.0, 0.02)]
    hot = [supplied((0, "50 degC"), (1, "50 degC")), f"thermal.housing={points((0, '60 degC'), (1, '60 degC'))}"]
    given = [pressure((0, "2 bar"), (1, "2 bar")), *(hot if heat else [])]
    constant = runup(machine(*common, "bearing.supply.pressure=2 bar"), tmp_path / "constant.h5")
    table = runup(machine(*common, *given), tmp_path / "table.h5")
    for name in constant.signals:
        np.testing.assert_array_equal(table[name], constant[name], strict=True, err_msg=name)
    added = table.signals.keys() - constant.signals.keys()
    assert added == {"supply_pressure_Pa", *({"supply_temperature_K"} if heat else ())}
    assert table.error["film_force_relative"] == pytest.approx(constant.error["film_force_relative"], rel=1e-9)


def test_values_between_rows_are_those_of_a_line() -> None:
    """The kernel and numpy; rows of several tables lie behind each other."""
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.01, 0.2, 20))
    time -= time[0]
    values = rng.uniform(1.5, 3.0, 20)
    rows = zip(time.tolist(), (f"{value!r} bar" for value in values.tolist()), strict=True)
    case = machine(*HEAT, pressure(*rows), supplied((0, "20 degC"), (1, "60 degC")), *at_speed(60.0, 0.1))
    system = planned_system(case)
    inputs = RunInputs.of(case, system).loop(system)
    at = rng.uniform(0.0, time[-1], 50)
    assert [value_at(inputs, 1, t) for t in at] == pytest.approx(1e5 * np.interp(at, time, values), rel=1e-12)
    assert value_at(inputs, 0, 0.25) == pytest.approx(ZERO + 30.0, rel=1e-12)


@pytest.mark.parametrize("theory", ["short", "finite"])
def test_a_share_of_the_pressure_of_a_table_is_that_pressure(theory: str) -> None:
    """The film that was made for 3 bar, asked for 1.5 bar, nearly nothing and nothing, and those made for these. That
    of no gauge pressure is a closed form or a table of its own, from which the integrals of the others differ."""
    rng, common = np.random.default_rng(5), [f"film.theory={theory}", "bearing.supply.pressure={} bar"]

    def system(bar: float) -> object:
        case = machine(*(each.format(bar) for each in common))
        return planned_system(case)

    full = system(3.0)
    for gauge, share, close in ((0.5, 0.25, 1e-9), (2e-5, 1e-5, 1e-6), (0.0, 1e-9, 2e-3)):
        asked, made = full.films.supplied(np.array([share])), system(1.0 + gauge).films  # type: ignore[attr-defined]
        for _ in range(20):
            place, rate = 35e-6 * rng.uniform(-0.6, 0.6, 2), 35e-6 * rng.uniform(-300.0, 300.0, 2)
            one, other = (films.force(0, place, rate, 800.0) for films in (asked, made))
            for name in ("force", "by_displacement", "by_velocity") if gauge else ("force",):
                expected = getattr(other, name)
                assert getattr(one, name) == pytest.approx(expected, abs=close * np.abs(expected).max())


@pytest.mark.parametrize("films", [[], CELLS], ids=["tabulated", "cells"])
def test_the_journal_goes_to_where_it_rests_at_the_last_pressure(films: list[str], tmp_path: Path) -> None:
    """From 10 bar, where it begins, to 1.2 bar; where it rests there is computed without a table."""
    common = [*films, *STILL, *at_speed(40.0, 0.3), "rotor.mass=30 kg"]
    run = runup(machine(*common, pressure((0, "10 bar"), (0.1, "1.2 bar"), (0.3, "1.2 bar"))), tmp_path / "run.h5")
    first, last = (machine(*common, f"bearing.supply.pressure={bar} bar") for bar in (10.0, 1.2))
    rest = []
    for case in (first, last):
        system = planned_system(case)
        place = system.rotor.journals[0] @ resting_position(system, 2.0 * math.pi * 40.0).displacements
        rest.append(math.hypot(*place) / 35e-6)
    assert abs(rest[1] - rest[0]) > 0.01
    assert run["eccentricity"][0] == pytest.approx(rest[0], abs=1e-4)
    assert run["eccentricity"][-1] == pytest.approx(rest[1], abs=1e-4)
    assert run["supply_pressure_Pa"][[0, -1]] == pytest.approx([1e6, 1.2e5])


def test_films_settle_at_the_last_temperatures(tmp_path: Path) -> None:
    """Cold oil that warms up, beside a wall that does: the steady machine at the last temperatures."""
    tables = [supplied((0, "20 degC"), (0.5, "70 degC"), (3, "70 degC")),
              pressure((0, "1.1 bar"), (0.3, "3 bar"), (3, "3 bar")),
              f"thermal.housing={points((0, '20 degC'), (0.5, '80 degC'), (3, '80 degC'))}"]  # fmt: skip
    last = [*HEAT, "thermal.supply_temperature=70 degC", "thermal.housing=80 degC", "bearing.supply.pressure=3 bar"]
    common = [*STILL, *at_speed(40.0, 2.0)]
    run = runup(machine(*HEAT, *common, *tables), tmp_path / "run.h5")
    (film,) = warm_machine(machine(*last, *common), 40.0).films
    assert run["temperature_K"][0] == pytest.approx(ZERO + 20.0, abs=0.5)
    assert run["temperature_K"][-1] == pytest.approx(film.temperature, abs=0.05)
    assert run["flow_m3_s"][-1] == pytest.approx(film.flow, rel=1e-2)
    assert run["temperature_housing_K"][-1] == pytest.approx(ZERO + 80.0)
    assert run.error["heat_balance_relative"] < 1e-9  # type: ignore[operator]


def test_a_run_resumed_within_its_tables_is_bit_equal(tmp_path: Path) -> None:
    tables = [supplied((0, "20 degC"), (0.05, "70 degC")), pressure((0, "1 bar"), (0.05, "3 bar"))]
    assert_resumable(machine(*HEAT, *tables, *at_speed(60.0, 0.05)), tmp_path, 0.02)


def test_an_input_is_a_table_of_the_case(tmp_path: Path) -> None:
    """From points, and from a file with units; the text of the case has it, and other analyses its largest value."""
    (tmp_path / "cold.csv").write_text("time [ms],temperature [degC]\n0,20\n500,65\n1000,40\n", encoding="utf-8")
    text = machine(*HEAT).source_text.replace('"50 degC"', '{ file = "cold.csv" }')
    case = load_case_text(text, folder=tmp_path)
    (found,) = inputs_of(case)
    assert found.key == "thermal.supply_temperature"
    assert found.values.time == (0.0, 0.5, 1.0)
    assert found.values.x == pytest.approx((ZERO + 20.0, ZERO + 65.0, ZERO + 40.0))
    assert load_case_text(case.source_text).same_run(case)
    warmest = case.with_settings("thermal.supply_temperature=65 degC")
    assert warm_machine(case, 40.0).films[0].temperature == warm_machine(warmest, 40.0).films[0].temperature
    decisions = make_plan(case.with_settings("speed.duration=1 s")).decisions
    decision = next(each for each in decisions if each.choice == "input")
    assert decision.value == "thermal.supply_temperature: 20 degC to 65 degC"
    assert "3 rows of cold.csv" in decision.reason


def test_the_remedy_for_pressures_of_two_kinds_is_possible() -> None:
    case = machine(pressure((0, "1 bar"), (20, "3 bar")), "oil.cavitation_pressure=0.5 bar", "film.solution=cells")
    assert make_plan(case).form.by_cells


def test_a_table_must_last_as_long_as_the_run(tmp_path: Path) -> None:
    case = machine(pressure((0.5, "1 bar"), (9, "3 bar")))
    with pytest.raises(InputError) as error:
        runup(case, tmp_path / "run.h5")
    told = {fault.problem for fault in error.value.faults}
    assert told == {
        "has a table that begins at 0.5 s, and the run begins at 0 s.",
        "has a table that ends at 9 s, and the run ends at 10 s.",
    }
    with pytest.raises(InputError, match=r"the run ends at 20\.5 s"):
        rundown(machine(pressure((0, "1 bar"), (15, "3 bar"))), tmp_path / "run.h5")


WHIRL = 61.0  # Hz: about the frequency of the whirl at any of the thresholds
PERIODS = 3  # of the whirl on each side of a moment, over which its amplitude is a mean
SMALL = 1e-3  # displacement from rest over the clearance


def spindle(**tables: dict[str, Any]) -> frbcli.Case:
    """The machine of `cold-start` on a ground that does not shake, without unbalance, on short films."""
    data = tomllib.loads(load_case("cold-start", ["film.theory=short", "rotor.unbalance=0"]).source_text)
    del data["base"]
    for name, changed in tables.items():
        data[name] = changed if name == "speed" else data.get(name, {}) | changed
    return case_from_dict(data, "spindle")


def rows(*given: tuple[float, float], unit: str) -> list[list[str]]:
    return [[f"{time} s", f"{value} {unit}"] for time, value in given]


def at_the_ends(values: tuple[float, float], duration: float, unit: str) -> list[list[str]]:
    return rows((0.0, values[0]), (duration, values[1]), unit=unit)


def still(speed: float, celsius: float, bar: float) -> frbcli.Case:
    """The machine whose films keep their temperature."""
    supply = {"kind": "circumferential-groove", "pressure": f"{bar} bar"}
    machine = spindle(speed={"from": f"{speed} Hz", "to": f"{speed} Hz", "duration": "1 s"})
    settings = {"thermal": {"model": "none", "supply_temperature": f"{celsius} degC"}, "bearing.supply": supply}
    return machine.with_settings(settings, {"oil.temperature": f"{celsius} degC"})


def neither_grows_nor_decays(run: Run) -> float:
    """The time in s at which the amplitude of the whirl has its only extremum."""
    time = run["time_s"]
    motion = run["journal_x_m"] + 1j * run["journal_y_m"]
    per_period = round(1.0 / (WHIRL * (time[1] - time[0])))
    window = np.hanning(2 * PERIODS * per_period + 1)
    window /= window.sum()
    around = motion - np.convolve(motion, window, "same")  # less where the journal would rest
    amplitude = np.abs(np.convolve(around * np.exp(-2j * np.pi * WHIRL * time), window, "same"))
    inside = slice(len(window), -len(window))
    curve = np.polynomial.Polynomial.fit(time[inside], np.log(amplitude[inside]), 3)
    roots = [root.real for root in curve.deriv().roots() if abs(root.imag) < 1e-9]
    (moment,) = [root for root in roots if time[inside][0] < root < time[inside][-1]]
    return float(moment)


HISTORIES = {  # speed in Hz, supply temperature in degC, pressure in bar, at the start and at the end; threshold in Hz
    "the oil warms up": ((160.0, 160.0), (50.0, 80.0), (1.1, 1.1), 160.0),
    "a run-up while the oil warms up": ((110.0, 190.0), (40.0, 60.0), (1.1, 1.1), 136.0),
    "the pressure builds up": ((120.0, 120.0), (30.0, 30.0), (1.0, 1.3), 120.0),
}


@pytest.mark.parametrize("name", HISTORIES)
def test_a_whirl_grows_from_the_threshold_of_its_moment_on(name: str, tmp_path: Path) -> None:
    """Within 2 %: the moving machine lags behind a little, and its films warm and cool a little within a whirl."""
    speeds, celsius, bar, expected = HISTORIES[name]
    duration = 1.0
    rest = stability(still(speeds[0], celsius[0], bar[0]), [speeds[0]]).points[0].films[0].displacement
    supply = {"kind": "circumferential-groove", "pressure": at_the_ends(bar, duration, "bar")}
    case = spindle(
        speed={"points": at_the_ends(speeds, duration, "Hz")},
        thermal={"supply_temperature": at_the_ends(celsius, duration, "degC")},
        start={"displacement": [rest[0] + SMALL, rest[1]]},
        bearing={"supply": supply},
        output={"step": "0.4 ms"},
    )
    run = runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    moment = neither_grows_nor_decays(run)
    here = {signal: float(np.interp(moment, run["time_s"], run[signal]))
            for signal in ("speed_Hz", "temperature_K", "supply_pressure_Pa")}  # fmt: skip
    at = still(2.0 * here["speed_Hz"], here["temperature_K"] - ZERO, 1e-5 * here["supply_pressure_Pa"])
    threshold = stability(at.with_settings("speed.from=10 Hz")).threshold
    assert threshold is not None
    assert here["speed_Hz"] == pytest.approx(threshold.speed_Hz, rel=0.02)  # 0.2 to 1.5 %
    assert threshold.speed_Hz == pytest.approx(expected, rel=0.02)
