"""Runs with heat whose clearance steps, and those whose films are solved in turn."""

from pathlib import Path

import numpy as np
import pytest
from resumed import assert_resumable
from test_heat import ring_case, single
from test_heat_run import HOT_HOUSING, STILL, at_speed

from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import warm_machine
from frbcli.errors import InputError
from frbcli.results.store import Run
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
