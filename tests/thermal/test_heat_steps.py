"""Clearances that change during a run with heat: temperatures stay, and then follow those of the new clearance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from resumed import assert_resumable
from test_heat import single
from test_heat_run import HOT_HOUSING, STILL, at_speed

from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import InputError
from frbcli.runs.run import runup
from frbcli.scene.changes import case_at

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
