"""The error budget of a run: its parts, its sum, and whether it is true."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from frbcli.analysis.differences import difference
from frbcli.analysis.verify import verify
from frbcli.case.load import load_case
from frbcli.cli.main import run as frb
from frbcli.solve.error_budget import BEFORE_WHIRL, FIRST, quiet_until, summed
from frbcli.solve.march import ERROR_MEMORY
from frbcli.solve.run import runup

SHORT_RUN = ("speed.duration=0.3 s", "speed.to=30 Hz", "output.step=1e-3 s")


def test_sums_of_local_errors_from_their_fading_sum() -> None:
    """A burst of steps of error 1e-6 every 1e-3 s for 0.2 s: 200 of them, and at most what 0.1 s of memory holds."""
    times = np.arange(0.0, 1.0, 1e-3)
    fading = [0.0]
    for t in times[1:]:
        fading.append(fading[-1] * np.exp(-1e-3 / ERROR_MEMORY) + (1e-6 if t <= 0.2 else 0.0))
    largest, whole = summed(np.column_stack([times, fading]), 1.0)
    assert whole == pytest.approx(200e-6, rel=0.02)
    assert largest == pytest.approx(1e-6 * ERROR_MEMORY / 1e-3 * (1.0 - np.exp(-2.0)), rel=0.02)
    assert summed(np.column_stack([times, fading]), 0.1)[1] == pytest.approx(100e-6, rel=0.02)
    assert summed(FIRST, 1.0) == (0.0, 0.0)


def test_quiet_until_a_whirl_grows() -> None:
    events = [{"kind": "critical-speed", "t_s": 1.0}, {"kind": "onset", "t_s": 4.0}, {"kind": "contact", "t_s": 5.0}]
    assert quiet_until(events, 10.0) == BEFORE_WHIRL * 4.0
    assert quiet_until(events, 2.0) == 2.0
    assert quiet_until([], 3.0) == 3.0


@pytest.mark.parametrize("settings", [(), ("film.theory=short",), ("accuracy.mesh=[2, 24]",)])
def test_stated_error_bounds_the_true_one(settings: tuple[str, ...], tmp_path: Path) -> None:
    """Against a reference of twice the elements and a hundredth of the tolerance."""
    run = runup(load_case("jeffcott", [*SHORT_RUN, *settings]), tmp_path / "run.h5")
    fine = ("film.theory=finite", "accuracy.mesh=[12, 192]", "accuracy.tolerance=1e-7")
    apart = difference(run, runup(load_case("jeffcott", [*SHORT_RUN, *fine]), tmp_path / "fine.h5"))
    assert 0.0 < apart.largest < run.error["eccentricity"] < 20.0 * apart.largest
    assert apart.signals["disk_y_m"] < run.error["displacement"]
    if run.error["mesh_relative"] is not None:  # the bound of the short bearing's 40 % is a coarse one for disks
        assert run.error["displacement"] < 20.0 * apart.signals["disk_y_m"]


def test_parts_that_a_run_has(tmp_path: Path) -> None:
    finite = runup(load_case("jeffcott", SHORT_RUN), tmp_path / "a.h5").error
    short = runup(load_case("jeffcott", [*SHORT_RUN, "film.theory=short"]), tmp_path / "b.h5").error
    assert (finite["model_relative"], short["mesh_relative"]) == (None, None)
    assert finite["mesh_relative"] == finite["film_force_relative"] < 1e-3
    assert short["model_relative"] == short["film_force_relative"] > 1e-2
    assert 0.0 < finite["coupling"] < 1e-5
    assert finite["modal_reduction"] is None
    assert finite["quiet_until_s"] == pytest.approx(0.3)


def test_verified_by_shorter_steps(tmp_path: Path) -> None:
    case = load_case("jeffcott", [*SHORT_RUN, "film.coupling=dynamic-static-semi-implicit"])
    run = runup(case, tmp_path / "run.h5")
    found = verify(case, run)
    assert 0.0 < found.eccentricity < run.error["time_integration"]
    assert found.status == "finished"
    assert found.coupling is not None
    assert 0.0 < found.coupling < 1e-3
    assert run.error["coupling"] is None


def test_command_tells_what_a_finer_run_changes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = [part for setting in SHORT_RUN for part in ("--set", setting)]
    options = ["--verify", "--json", "--no-picture", "-o", str(tmp_path / "run.h5")]
    assert frb(["runup", "jeffcott", *settings, *options]) == 0
    out = capsys.readouterr()
    verified = json.loads(out.out)["error"]["verified"]
    assert 0.0 < verified["eccentricity"] < 1e-3
    assert verified["coupling"] is None
    assert "verified: with half the tolerance" in out.err
