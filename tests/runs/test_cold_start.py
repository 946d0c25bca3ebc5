"""Onsets while the oil warms up: the whirl of a run begins to grow where the machine at the temperature, pressure and
speed of that moment has its threshold of stability.

A whirl that grows is seen later than that: its amplitude is exp of the integral of the growth rate. So a small whirl is
followed from the start of the run, and the moment is that at which it neither decays nor grows.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.run import runup

ZERO, WHIRL = 273.15, 61.0  # K; Hz: about the frequency of the whirl at any of the thresholds
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
