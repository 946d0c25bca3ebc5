"""Hostile run files: each is refused with one message, or read by all commands, in little time and memory."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hostile_runs import KINDS
from hostile_worker import SETTINGS
from nights import printed, seeds_tonight
from synthetic_run import Rotor, signals

from frbcli.case.reading.load import load_case
from frbcli.results.store import Header, RunWriter
from frbcli.runs.run import runup

LONGEST_CPU_s = 10.0
MOST_MB = 500.0
GATE, SEEDS, NIGHTS = 1, 32, 16  # files of each kind: of every change, and in so many nights
# What broke the summary once: times of 1e-300 s, a whirl ratio of 1e300, a clearance that changed before the run, a
# legend of 30 films beside a low panel.
BROKE = ("times:26", "events:31", "record_values:31", "many_signals:17", "many_signals:27")


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an interrupted run of a rotor in one film, and one on a floating ring."""
    folder = tmp_path_factory.mktemp("hostile")
    case = load_case("jeffcott", SETTINGS)
    run = runup(case, folder / "jeffcott.h5")
    writer = RunWriter(folder / "jeffcott.h5", Header(
        run.title, "runup", run.case_name, run.case_text, {name: signal.unit for name, signal in run.signals.items()},
        run.versions, run.references))  # fmt: skip
    writer.append({name: run[name] for name in run.signals})
    assert run.checkpoint is not None
    writer.checkpoint(run.checkpoint, run.cost, run.error, run.t_end_s)
    columns = signals(Rotor(duration_s=0.5, step_s=1e-3, whirl_s=0.2, growth_1_s=200.0))
    inner = columns.pop("eccentricity")
    columns |= {"eccentricity_inner": inner, "eccentricity_outer": 0.5 * inner, "oil_fraction_inner": 1 - 0.2 * inner}
    columns |= {"ring_x_m": 0.5 * columns["journal_x_m"], "ring_y_m": 0.5 * columns["journal_y_m"]}
    columns["ring_speed_Hz"] = 0.25 * columns["speed_Hz"]
    suffixes = {"_m": "m", "_s": "s", "Hz": "Hz"}
    units = {name: suffixes.get(name[-2:], "") for name in columns}
    references = {"clearance_m": 4e-5, "clearance_m_inner": 4e-5, "clearance_m_outer": 5e-5}
    text = load_case("floating-ring").source_text
    writer = RunWriter(folder / "ring.h5", Header("Rotor", "runup", "ring", text, units, {"frbcli": "0.1"}, references))
    writer.append(columns)
    state = {"numbers": np.zeros(17), "q": np.zeros(7), "v": np.zeros(7), "a": np.zeros(7), "past": np.zeros((3, 5)),
             "errors": np.zeros((2, 256)), "clock": np.zeros(2), "film_samples": np.zeros((5, 17))}  # fmt: skip
    writer.checkpoint(state, run.cost, run.error, 0.5)
    return folder


def tried(folder: Path, commands: str, names: Sequence[str]) -> None:
    """Assert that no file of these breaks a command, or takes it more time or memory than it may."""
    worker = str(Path(__file__).with_name("hostile_worker.py"))
    said = [json.loads(line) for line in printed(worker, str(folder), commands, *names, limited=True)]
    results = [line for line in said if "codes" in line]
    assert len(results) == len(names)
    bad = [line for line in results if line["bad"] or line["cpu_s"] > LONGEST_CPU_s or line["mb"] > MOST_MB]
    assert not bad, "\n".join(map(str, bad))
    assert {line["codes"][0] for line in results} == {0, 2}


def test_a_hostile_run_file_is_refused_or_read(bases: Path) -> None:
    tried(bases, "few", [f"{kind}:{seed}" for kind in KINDS for seed in range(GATE)] + list(BROKE))


@pytest.mark.nightly
def test_many_hostile_run_files_are_refused_or_read(bases: Path) -> None:
    tried(bases, "many", [f"{kind}:{seed}" for kind in KINDS for seed in seeds_tonight(range(SEEDS), NIGHTS)])
