"""Run files: what goes in comes out, whatever happens to the process or to the file."""

import io
import os
import pickle
import random
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from paths import ROOT

from frbcli.errors import InputError, RunFileError
from frbcli.results import records
from frbcli.results.container import USER_BLOCK, seal
from frbcli.results.store import Header, Run, RunWriter, check_output, read_run

HEADER = Header(
    title="Rotor of a test",
    command="runup",
    case_name="test",
    case_text='title = "Rotor of a test"  # 35 µm\n',
    units={"time_s": "s", "speed_Hz": "Hz", "eccentricity": ""},
    versions={"frbcli": "0.1"},
    references={"clearance_m": 35e-6},
)
EVENT = {"kind": "onset", "film": None, "t_s": 0.05, "speed_Hz": 1.5, "frequency_Hz": 0.7, "frequency_ratio": 0.47}


def chunk(first: int, last: int) -> dict[str, np.ndarray]:
    time_s = np.arange(first, last) * 1e-3
    return {"time_s": time_s, "speed_Hz": 30.0 * time_s, "eccentricity": np.cos(time_s)}


@pytest.fixture
def run_path(tmp_path: Path) -> Path:
    path = tmp_path / "run.h5"
    writer = RunWriter(path, HEADER)
    writer.append(chunk(0, 60))
    writer.checkpoint({"q": np.arange(4.0), "step": np.array(7)}, {"cpu_s": 1.0}, {}, t=0.06)
    writer.append(chunk(60, 100))
    writer.finish("contact", {"cpu_s": 2.0, "steps": np.int64(3)}, {"time_integration": 1e-4}, [EVENT], t=0.0995)
    return path


def reseal(path: Path, content: io.BytesIO) -> None:
    """Put changed HDF5 content back with a valid checksum, as a faulty program would."""
    seal(content)
    path.write_bytes(content.getvalue())


def test_a_run_comes_back_as_it_was_written(run_path: Path) -> None:
    run = read_run(run_path)
    for name, values in chunk(0, 100).items():
        np.testing.assert_array_equal(run[name], values)
        assert run.signals[name].unit == HEADER.units[name]
    assert list(run.signals) == ["time_s", "speed_Hz", "eccentricity"]
    assert (run.title, run.command, run.case_name, run.case_text) == (
        HEADER.title, HEADER.command, HEADER.case_name, HEADER.case_text,
    )  # fmt: skip
    assert (run.versions, run.references) == (HEADER.versions, HEADER.references)
    assert (run.status, run.t_end_s, run.events) == ("contact", 0.0995, [EVENT])
    assert (run.cost, run.error) == ({"cpu_s": 2.0, "steps": 3}, {"time_integration": 1e-4})
    assert run.checkpoint is not None
    np.testing.assert_array_equal(run.checkpoint["q"], np.arange(4.0))
    assert (int(run.checkpoint["step"]), run.checkpoint_samples, len(run)) == (7, 60, 100)


def test_unknown_signal_is_refused_with_the_names_there_are(run_path: Path) -> None:
    with pytest.raises(RunFileError, match=r"disk_x_m.*time_s, speed_Hz, eccentricity"):
        read_run(run_path)["disk_x_m"]


def test_other_programs_can_open_a_run(run_path: Path) -> None:
    with h5py.File(run_path, "r") as file:
        assert file["signals/time_s"].shape == (100,)
        assert file["signals/time_s"].chunks is None


def test_the_file_exists_before_the_first_sample(tmp_path: Path) -> None:
    RunWriter(tmp_path / "run.h5", HEADER)
    run = read_run(tmp_path / "run.h5")
    assert (run.status, len(run), run.checkpoint) == ("interrupted", 0, None)


def test_without_a_time_a_run_ends_with_its_last_sample(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.h5", HEADER)
    writer.append(chunk(0, 11))
    assert writer.finish("finished", {}, {}, []).t_end_s == pytest.approx(0.01)


def test_appended_arrays_may_be_reused_by_the_caller(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.h5", HEADER)
    buffer = chunk(0, 5)
    writer.append(buffer)
    buffer["time_s"][:] = -1.0
    np.testing.assert_array_equal(writer.finish("finished", {}, {}, [])["time_s"], chunk(0, 5)["time_s"])


def test_chunks_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.h5", HEADER)
    with pytest.raises(ValueError, match="announced"):
        writer.append({"time_s": np.zeros(3)})
    with pytest.raises(ValueError, match="same shape"):
        writer.append(chunk(0, 3) | {"time_s": np.zeros(2)})
    assert writer.samples == 0


def test_resumed_run_equals_the_unbroken_one(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    writer = RunWriter(path, HEADER)
    writer.append(chunk(0, 40))
    writer.checkpoint({"q": np.ones(2)}, {"cpu_s": 1.0}, {}, t=0.04)
    writer.append(chunk(40, 50))
    writer.finish("interrupted", {"cpu_s": 1.5}, {}, [])
    assert len(read_run(path)) == 50
    resumed = RunWriter.resume(path)
    assert resumed.samples == 40
    resumed.append(chunk(40, 80))
    run = resumed.finish("finished", {"cpu_s": 2.0}, {}, [EVENT])
    for name, values in chunk(0, 80).items():
        np.testing.assert_array_equal(run[name], values)
    assert (run.case_text, run.references, run.status) == (HEADER.case_text, HEADER.references, "finished")


def test_an_ended_run_cannot_be_resumed(run_path: Path) -> None:
    with pytest.raises(RunFileError, match="contact"):
        RunWriter.resume(run_path)


def test_a_file_cut_short_is_refused(run_path: Path) -> None:
    whole = run_path.read_bytes()
    for length in [0, 1, 9, 10, 100, USER_BLOCK - 1, *range(USER_BLOCK, len(whole), 97), len(whole) - 1]:
        run_path.write_bytes(whole[:length])
        with pytest.raises(RunFileError):
            read_run(run_path)


def test_a_damaged_file_is_refused(run_path: Path) -> None:
    whole = run_path.read_bytes()
    chance = random.Random(1)
    for place in [*range(0, USER_BLOCK, 7), *range(USER_BLOCK, len(whole), 61)]:
        damaged = bytearray(whole)
        damaged[place] ^= chance.randrange(1, 256)
        run_path.write_bytes(damaged)
        with pytest.raises(RunFileError):
            read_run(run_path)


@pytest.mark.parametrize("content", [b"", b"time_s,speed_Hz\n0,0\n", b"frb-run 1 ", b"frb-run 1 length=0\n"])
def test_a_file_of_another_kind_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other.h5"
    path.write_bytes(content)
    with pytest.raises(RunFileError):
        read_run(path)


def test_missing_file_directory_and_foreign_hdf5_are_refused(tmp_path: Path) -> None:
    foreign = tmp_path / "foreign.h5"
    with h5py.File(foreign, "w") as file:
        file["a"] = 1.0
    for path in (tmp_path / "none.h5", tmp_path, foreign, Path("a\0b")):
        with pytest.raises(RunFileError):
            read_run(path)


PARTS = ["title", "status", "case_text", "events", "cost", "versions", "signals", "signals/time_s", "checkpoint/q"]


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("change", ["missing", "number", "text", "group", "table"])
def test_a_run_with_a_wrong_part_is_refused_or_read(run_path: Path, part: str, change: str) -> None:
    content = io.BytesIO(run_path.read_bytes())
    with h5py.File(content, "r+") as file:
        del file[part]
        if change == "group":
            file.create_group(part)
        elif change != "missing":
            file[part] = {"number": 1.5, "text": "3", "table": np.zeros((2, 2))}[change]
    reseal(run_path, content)
    must_fail = part in ("events", "cost", "versions", "signals") or (change, part) == ("missing", "title")
    if must_fail:
        with pytest.raises(RunFileError):
            read_run(run_path)
    else:
        try:
            assert isinstance(read_run(run_path), Run)
        except RunFileError as error:
            assert str(run_path) in str(error)  # noqa: PT017


@pytest.mark.parametrize("count", [50_589, 50_590, 51_000])
def test_a_rotor_may_stand_still_a_whole_step_after_the_last_sample(count: int) -> None:
    """Where its speed fades away, the standstill is extrapolated to there; steps differ by round-off."""
    times = 2e-4 * np.arange(count)
    stands = times[-1] + (times[-1] - times[-2])
    assert not records.wrong_event([{"t_s": stands}], times)
    assert records.wrong_event([{"t_s": times[-1] + 2.1e-4}], times)


def test_signals_of_different_length_are_refused(run_path: Path) -> None:
    content = io.BytesIO(run_path.read_bytes())
    with h5py.File(content, "r+") as file:
        del file["signals/time_s"]
        file["signals/time_s"] = np.zeros(3)
        file["signals/time_s"].attrs["unit"] = "s"
    reseal(run_path, content)
    with pytest.raises(RunFileError, match="length"):
        read_run(run_path)


KILLED = """
    import sys
    import numpy as np
    from frbcli.results.store import Header, RunWriter
    names = [f"disk_{i}_x_m" for i in range(10)]
    units = {"time_s": "s", "speed_Hz": "Hz"} | dict.fromkeys(names, "m")
    writer = RunWriter(sys.argv[1], Header("t", "runup", "c", "", units))
    sys.stdout.write("go\\n")
    sys.stdout.flush()
    for n in range(100_000):
        values = {"time_s": np.arange(500 * n, 500 * (n + 1)) * 1e-3, "speed_Hz": np.zeros(500)}
        writer.append(values | {name: np.full(500, float(n)) for name in names})
        writer.checkpoint({"n": np.array(n)}, {"n": n}, {}, t=float(n))
"""


def test_a_killed_run_leaves_a_file_that_opens(tmp_path: Path) -> None:
    chance = random.Random(2)
    path = tmp_path / "run.h5"
    reached = []
    for _ in range(6):
        arguments = [sys.executable, "-c", textwrap.dedent(KILLED), str(path)]
        with subprocess.Popen(arguments, stdout=subprocess.PIPE, cwd=ROOT) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"go\n"
            time.sleep(chance.uniform(0.0, 0.15))
            os.kill(process.pid, signal.SIGKILL)
        run = read_run(path)
        assert run.status == "interrupted"
        if run.checkpoint is not None:
            n = int(run.checkpoint["n"])
            assert len(run) == run.checkpoint_samples == 500 * (n + 1)
            assert run["disk_9_x_m"][-1] == run.t_end_s == run.cost["n"] == n
        reached.append(run.t_end_s)
    assert max(reached) > 0.0  # at least one was killed while it was writing checkpoints


@pytest.mark.nightly
@pytest.mark.timing
def test_ten_seconds_are_written_quickly(tmp_path: Path) -> None:
    """In CPU time, for a busy disk is no fault of the writer."""
    names = [f"signal_{i}" for i in range(12)]
    writer = RunWriter(tmp_path / "run.h5", Header("t", "runup", "c", "", dict.fromkeys(names, "m")))
    writer.append({name: np.random.default_rng(0).random(200_000) for name in names})
    writer.checkpoint({}, {}, {}, t=10.0)
    durations = []
    for _ in range(5):
        start = time.process_time()
        writer.checkpoint({}, {}, {}, t=10.0)
        durations.append(time.process_time() - start)
    assert min(durations) < 0.05


def test_output_must_be_new_or_a_run(tmp_path: Path, run_path: Path) -> None:
    check_output(tmp_path / "new.h5")
    check_output(run_path)
    notes = tmp_path / "notes.txt"
    notes.write_text("keep me")
    for path, why in [
        (notes, "not a run"),
        (tmp_path, "not a file"),
        (tmp_path / "nowhere" / "run.h5", "does not exist"),
        (Path("a\0b"), "cannot be used"),
        (tmp_path / ("long" * 100), "cannot be used"),
    ]:
        with pytest.raises(InputError, match=why):
            check_output(path)
    with pytest.raises(InputError):
        RunWriter(notes, HEADER)
    assert notes.read_text() == "keep me"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_output_without_permission_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(InputError, match="permission"):
            check_output(tmp_path / "run.h5")
    finally:
        tmp_path.chmod(0o700)


def test_a_text_that_cannot_be_found_is_refused_at_once(run_path: Path) -> None:
    content = bytearray(run_path.read_bytes())
    heap = content.index(b"GCOL")
    for change in ({8: 0, 9: 0}, {16: 0, **dict.fromkeys(range(24, 32), 0)}, {24: 255}):
        broken = bytearray(content)
        for at, byte in change.items():
            broken[heap + at] = byte
        reseal(run_path, io.BytesIO(broken))
        with pytest.raises(RunFileError, match="not a complete run"):
            read_run(run_path)
    crowded = bytes(content) + b"GCOL\x01\0\0\0" * 20_000
    reseal(run_path, io.BytesIO(crowded))
    with pytest.raises(RunFileError, match="texts"):
        read_run(run_path)


def test_a_file_of_holes_is_refused_for_its_size(run_path: Path) -> None:
    size = 20 * 1024**3
    head = b"frb-run 1 length=%d crc32=00000000\n" % (size - USER_BLOCK)
    with run_path.open("r+b") as file:
        file.write(head.ljust(USER_BLOCK, b"\0"))
        file.truncate(size)
    began = time.process_time()
    with pytest.raises(RunFileError, match="larger than 8 GiB"):
        read_run(run_path)
    assert time.process_time() - began < 1.0


def test_a_run_that_is_too_long_for_memory_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(records, "IN_MEMORY", 100)
    path = tmp_path / "run.h5"
    writer = RunWriter(path, HEADER)
    for first in range(0, 40, 8):
        writer.append(chunk(first, first + 8))
    assert all(signal.bytes == 0 for signal in writer._signals.values())
    early = writer.so_far()
    writer.checkpoint({"q": np.ones(2)}, {"cpu_s": 1.0}, {}, t=0.04)
    writer.append(chunk(40, 43))
    resumed = RunWriter.resume(path)
    resumed.append(chunk(40, 80))
    run = resumed.finish("finished", {"cpu_s": 2.0}, {}, [EVENT])
    for name, values in chunk(0, 80).items():
        np.testing.assert_array_equal(run[name], values)
        np.testing.assert_array_equal(read_run(path)[name], values)
        np.testing.assert_array_equal(run.read(name, 36, 44), values[36:44])
        np.testing.assert_array_equal(early[name], values[:40])
        np.testing.assert_array_equal(np.asarray(pickle.loads(pickle.dumps(run)).signals[name]), values)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["run.h5"]


def test_a_signal_for_which_the_disk_has_no_room_stays_in_memory(tmp_path: Path) -> None:
    signal = records.GrowingSignal()
    signal.append(np.arange(3.0))
    signal.move(tmp_path / "nowhere")
    signal.append(np.arange(3.0, 5.0))
    np.testing.assert_array_equal(signal[1:5], np.arange(1.0, 5.0))
    signal.move(tmp_path)
    assert signal.bytes == 0
    signal.append(np.arange(5.0, 7.0))
    np.testing.assert_array_equal(signal[:], np.arange(7.0))
    np.testing.assert_array_equal(signal[6:2], np.empty(0))
