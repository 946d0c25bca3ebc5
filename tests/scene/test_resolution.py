"""What a plan says of loads and inputs that change with time: their frequencies beside steps and samples."""

import math
from pathlib import Path

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.runs.run import runup
from frbcli.scene.course import CHOICE, highest_frequency
from frbcli.scene.planning.plan import make_plan

MACHINE = {
    "rotor": {"kind": "rigid", "mass": "6 kg"},
    "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m", "damping": "300 N*s/m"},
    "speed": {"from": "50 Hz", "to": "50 Hz", "duration": "0.2 s"},
}


def told(case: frbcli.Case) -> list[tuple[str, str]]:
    return [(each.value, each.reason) for each in make_plan(case).decisions if each.choice == CHOICE]


def over_time(rate: float, frequency: float) -> dict[str, object]:
    time = np.arange(0.0, 0.2 + 0.5 / rate, 1.0 / rate)
    x = np.round(np.sin(2.0 * math.pi * frequency * time), 9)
    return {"at": "journal", "over_time": {"time": time.tolist(), "x": x.tolist()}}


@pytest.mark.parametrize("frequency", [40.0, 300.0, 900.0])
def test_the_highest_frequency_of_a_table_is_that_of_its_sine(frequency: float) -> None:
    time = np.linspace(0.0, 1.0, 4001)
    sine = np.sin(2.0 * math.pi * frequency * time) + 3.0 * np.sin(2.0 * math.pi * 20.0 * time)
    found = highest_frequency(time, np.column_stack([0.0 * time, sine]))
    assert found == pytest.approx(frequency, abs=3.0)  # the window is as wide
    assert highest_frequency(time, np.column_stack([5.0 + 2.0 * time, 0.0 * time])) == 0.0
    assert highest_frequency(time**2, sine[:, None]) == 0.0


def test_a_plan_tells_the_steps_of_loads_that_a_run_takes(tmp_path: Path) -> None:
    """Steps in a period of the fastest load, and samples that are too far apart to show it."""
    force = {"at": "journal", "force": ["1 N", "0 N"], "order": 8}
    case = case_from_dict(MACHINE | {"force": [force]}, "resolution")
    ((value, reason),) = told(case)
    assert value == "force 1: 400 Hz"
    steps = runup(case, tmp_path / "run.h5").cost["steps"] / (0.2 * 400.0)
    assert float(reason.split()[0]) == pytest.approx(steps, rel=0.1)
    assert "samples" not in reason
    (_, reason), = told(case.with_settings("output.step=2 ms"))
    assert reason.endswith("above the 250 Hz that samples of output.step show")


def test_a_plan_tells_the_rows_of_a_table_beside_its_steps() -> None:
    coarse, fine = (case_from_dict(MACHINE | {"force": [over_time(rate, 100.0)]}, "rows") for rate in (1e3, 1e4))
    ((value, reason),) = told(coarse)
    assert value == "force 1: 201 rows, at least 0.001 s apart"
    assert reason.startswith("2 steps of 0.0005 s between them")
    assert "content up to 1" in reason
    ((_, reason),) = told(fine)
    assert reason.startswith("closer than the steps of 0.0005 s")


def test_inputs_have_a_line_and_other_machines_none() -> None:
    pressure = 'bearing.supply.pressure=[["0 s", "1 bar"], ["1 s", "3 bar"], ["10 s", "3 bar"]]'
    ((value, _),) = told(frbcli.load_case("jeffcott", [pressure]))
    assert value == "bearing.supply.pressure: 3 rows, at least 1 s apart"
    assert told(frbcli.load_case("jeffcott")) == []
