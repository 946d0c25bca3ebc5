"""A sweep as table, picture and command."""

import csv
import json
import os
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from sweep_points import CLEARANCES, SHORT, TWO, VISCOSITIES

from frbcli import Case, InputError, load_case, sweep
from frbcli.cli.main import run as frb
from frbcli.plot.studies import can_draw, sweep_figure
from frbcli.studies.sweep import write_table


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("jeffcott", SHORT)


def test_parquet_needs_its_library(case: Case, tmp_path: Path) -> None:
    found = sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path, "stability", workers=TWO)
    with pytest.raises(InputError, match="not a format"):
        write_table(found, tmp_path / "t.xls", "xls")
    if find_spec("pyarrow") is None:
        with pytest.raises(InputError, match="pyarrow"):
            write_table(found, tmp_path / "t.parquet", "parquet")
    else:
        import pandas as pd

        read = pd.read_parquet(write_table(found, tmp_path / "t.parquet", "parquet"))
        pd.testing.assert_frame_equal(read, found.to_pandas(), check_dtype=False)


def test_map_and_curve_show_the_thresholds(case: Case, tmp_path: Path) -> None:
    axes = {"oil.viscosity": ["12 mPa*s", "8 mPa*s"], "bearing.clearance": [*CLEARANCES, "1 m"]}
    found = sweep(case, axes, tmp_path / "map", "stability", workers=TWO)
    speeds = found.to_pandas()["threshold_speed_Hz"].to_numpy().reshape(2, 3)
    figure = sweep_figure(found)
    drawn = np.ma.filled(figure.axes[0].collections[0].get_array(), np.nan)
    # across: viscosity, ascending; up: clearance, ascending, "1 m" beside the others' um: as written
    np.testing.assert_array_equal(drawn, speeds[::-1].T)
    assert figure.axes[0].get_xlabel() == "oil viscosity in mPa s"
    assert [label.get_text() for label in figure.axes[0].get_xticklabels()] == ["8", "12"]
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["30 um", "35 um", "1 m"]
    curve = sweep(case, {"bearing.clearance": ["35 um", "30 um", "2000 um"]}, tmp_path / "c", "stability", workers=TWO)
    line, missing = sweep_figure(curve).axes[0].lines
    np.testing.assert_array_equal(line.get_xdata(), [30.0, 35.0, 2000.0])
    expected = curve.to_pandas()["threshold_speed_Hz"].to_numpy()
    np.testing.assert_array_equal(line.get_ydata(), expected[[1, 0, 2]])
    np.testing.assert_array_equal(missing.get_xdata(), [2000.0])
    three = sweep(case, [{"oil.viscosity": "8 mPa*s"}, {"oil.density": "800 kg/m^3"}, {"speed.to": "260 Hz"}],
                  tmp_path / "three", "stability", workers=TWO)  # fmt: skip
    assert not can_draw(three)


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("elsewhere")
def test_the_command_says_one_document_and_leaves_table_and_picture(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["sweep", "jeffcott", "--set", "film.theory=short", "--set", "oil.viscosity=8 mPa*s,12 mPa*s"]
    assert frb([*words, "--stability", "--json", "--jobs", "2"]) == 0
    told = capsys.readouterr()
    document = json.loads(told.out)
    assert list(document) == ["command", "case", "points", "table", "picture"]
    assert [point["set"] for point in document["points"]] == [{"oil.viscosity": value} for value in VISCOSITIES]
    for point in document["points"]:
        assert list(point) == ["set", "status", "message", "events", "cost", "run"]
        assert set(point["cost"]) == {"cpu_s", "wall_s"}
        assert [event["kind"] for event in point["events"]] == ["threshold"]
        assert set(point["events"][0]) == {
            "kind", "film", "t_s", "speed_Hz", "frequency_Hz", "frequency_ratio", "speed_uncertainty_Hz",
            "frequency_uncertainty_Hz",
        }  # fmt: skip
    assert "1/2 " in told.err
    assert "2/2 " in told.err
    with Path(document["table"]).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["oil.viscosity"] for row in rows] == VISCOSITIES
    events = [point["events"][0]["speed_Hz"] for point in document["points"]]
    assert [float(row["threshold_speed_Hz"]) for row in rows] == events
    assert Path(document["picture"]).read_bytes().startswith(b"\x89PNG")


def test_the_command_takes_a_list_and_tells_of_failures(elsewhere: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("points.csv").write_text("oil.viscosity,bearing.clearance\n8 mPa*s,35 um\n-8 mPa*s,35 um\n")
    words = ["sweep", "jeffcott", "--list", "points.csv", "--set", "film.theory=short", "--set", "speed.duration=0.3 s"]
    assert frb([*words, "--json", "-o", "out", "--jobs", "2"]) == 3
    told = capsys.readouterr()
    good, bad = json.loads(told.out)["points"]
    assert (good["status"], good["run"]) == ("finished", str(elsewhere / "out" / "runs" / "001.h5"))
    assert (bad["status"], bad["events"], bad["cost"], bad["run"]) == ("input-error", [], {}, None)
    assert "greater than 0" in bad["message"]
    assert "did not finish" not in told.err
    assert frb([*words, "--quiet", "-o", "out", "--jobs", "2"]) == 3
    assert capsys.readouterr() == ("", "")


def children() -> list[Path]:
    """The entries in /proc of all processes that this one has started."""
    entries = [entry for entry in Path("/proc").iterdir() if entry.name.isdigit()]
    parents = [(entry / "stat").read_text().rpartition(")")[2].split()[1] for entry in entries]
    return [entry for entry, parent in zip(entries, parents, strict=True) if parent == str(os.getpid())]


def worked_and_waited() -> tuple[float, float]:
    """CPU time of the children's main threads, and how long these could have run, but for other programs, in s."""
    times = [[float(number) for number in (child / "schedstat").read_text().split()[:2]] for child in children()]
    return sum(cpu for cpu, _ in times) / 1e9, sum(queued for _, queued in times) / 1e9


@pytest.mark.nightly
@pytest.mark.timing
@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="needs the scheduler's statistics of Linux")
def test_all_cores_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """64 run-ups of some tenths of a second each: the share of the cores' time that the workers ask for."""
    jobs = len(os.sched_getaffinity(0))
    case = load_case("jeffcott", ["film.theory=short", "speed.duration=20 s", "output.step=1 ms"])
    sweep(case, {"oil.viscosity": ["7 mPa*s", "7.5 mPa*s"]}, tmp_path / "warm")
    (cpu, queued), began = worked_and_waited(), time.perf_counter()
    found = sweep(case, {"oil.viscosity": [f"{8 + 0.25 * n} mPa*s" for n in range(64)]}, tmp_path / "s")
    wall, (cpu_after, queued_after) = time.perf_counter() - began, worked_and_waited()
    cpu, queued = cpu_after - cpu, queued_after - queued
    with capsys.disabled():
        sys.stdout.write(
            f"\n64 run-ups on {jobs} cores: {wall:.1f} s wall; the workers computed {cpu / wall / jobs:.0%} of it "
            f"and waited {queued / wall / jobs:.0%} for a core that another program had\n"
        )
    assert all(point.status in ("finished", "contact") for point in found.points)
    assert (cpu + queued) / wall / jobs >= 0.9
