"""What reads a run needs no more memory for a long run than for a short one."""

import json
import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from nights import printed

from frbcli.errors import RunFileError
from frbcli.results.store import Header, RunWriter, read_run

UNITS = {"time_s": "s", "speed_Hz": "Hz", "eccentricity": "", "journal_x_m": "m", "journal_y_m": "m"}
STEP_s = 5e-5
PICTURES = (
    ["waterfall", "RUN", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "summary", "-o", "OUT.png"],
    ["plot", "RUN", "--over", "speed", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "displacement", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "orbit", "--from", "0 s", "-o", "OUT.png"],
)
TABLES = (["export", "RUN", "-o", "OUT.csv"], ["export", "RUN", "-o", "OUT.mat", "--format", "mat"])
MEASURED = """
    import json, sys
    from hostile_worker import call, forget_peak, peak_mb
    small, big, words = sys.argv[1], sys.argv[2], json.loads(sys.argv[3])
    for path in (small, big):
        forget_peak()
        before = peak_mb()
        code, _, told = call([path if word == "RUN" else word for word in words])
        assert code == 0, told
    print(peak_mb() - before)
"""


def write_run(path: Path, samples: int) -> Path:
    """A run-up to 300 Hz that whirls from its middle on."""
    time_s = STEP_s * np.arange(samples)
    speed = 300.0 * time_s / time_s[-1]
    writer = RunWriter(path, Header("Rotor", "runup", "long", "", UNITS, references={"clearance_m": 35e-6}))
    size = np.where(time_s > 0.5 * time_s[-1], 20e-6, 1e-6)
    angle = np.pi * np.cumsum(speed) * STEP_s
    writer.append({"time_s": time_s, "speed_Hz": speed, "eccentricity": size / 35e-6,
                   "journal_x_m": size * np.cos(angle), "journal_y_m": size * np.sin(angle)})  # fmt: skip
    writer.finish("finished", {}, {}, [])
    return path


def measured_mb(folder: Path, samples: int, commands: Sequence[list[str]]) -> dict[str, float]:
    """Memory of each command beyond that of a short run, in a process of its own."""
    small, big = write_run(folder / "small.h5", 20_000), write_run(folder / "big.h5", samples)
    found = {}
    for words in commands:
        words = [word.replace("OUT", str(folder / "out")) for word in words]
        (beyond,) = printed("-c", textwrap.dedent(MEASURED), str(small), str(big), json.dumps(words))
        found[" ".join(words)] = float(beyond)
    return found


@pytest.mark.nightly
def test_all_that_reads_a_run_of_twenty_million_samples_takes_little_memory(tmp_path: Path) -> None:
    found = measured_mb(tmp_path, 20_000_000, [*PICTURES, *TABLES])
    assert max(found.values()) < 500.0, found


def test_a_run_is_read_when_it_is_asked_for_and_not_from_a_file_in_its_place(tmp_path: Path) -> None:
    run = read_run(write_run(tmp_path / "run.h5", 1000))
    np.testing.assert_array_equal(run.read("time_s", 10, 20), STEP_s * np.arange(10, 20))
    np.testing.assert_array_equal(run["time_s"][10:20], run.read("time_s", 10, 20))
    assert (len(run), len(run.read("time_s", 990)), len(run.read("time_s", 5, 5))) == (1000, 10, 0)
    write_run(tmp_path / "run.h5", 1000)
    with pytest.raises(RunFileError, match="changed after it was opened"):
        run.read("time_s", 0, 10)
    (tmp_path / "run.h5").unlink()
    with pytest.raises(RunFileError, match="cannot be read any more"):
        run["time_s"]


@pytest.mark.nightly
def test_a_run_of_millions_of_samples_takes_little_memory(tmp_path: Path) -> None:
    """320 s of the Jeffcott rotor below its whirl: 12.8 million samples, 358 MB."""
    words = ["speed.to=170 Hz", "film.theory=short"]
    runs = {}
    for seconds in (10, 320):
        code = f"""
            from hostile_worker import call, peak_mb
            code, _, told = call(["runup", "jeffcott", "-o", {str(tmp_path / "run.h5")!r}, "--no-picture", "--force",
                                  *sum((["--set", each] for each in {words} + ["speed.duration={seconds} s"]), [])])
            assert code == 0, told
            print(peak_mb())
        """
        runs[seconds] = float(printed("-c", textwrap.dedent(code))[-1])
    assert runs[320] < max(300.0, runs[10] + 120.0), runs
