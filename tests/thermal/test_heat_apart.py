"""Heat in a co-simulation: the temperatures of rotor and films that are solved together, and a balance that closes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_heat import ring_case, single

from frbcli.case.schema import Case
from frbcli.results.store import Run
from frbcli.runs.run import runup

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
