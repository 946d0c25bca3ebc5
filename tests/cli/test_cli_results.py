"""`frb waterfall`, `frb plot`, `frb export` on a run file."""

import json
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commands import Frb
from scipy.io import loadmat
from synthetic_run import CLEARANCE, UNITS, Rotor, signals

from frbcli.results.store import Header, RunWriter, read_run

COLUMNS = ["time_s", "speed_Hz", "eccentricity", "journal_x_m", "journal_y_m", "disk_x_m", "disk_y_m"]
PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("made") / "run.h5"
    columns = signals(Rotor(duration_s=1.0, step_s=1e-4, whirl_s=0.7, growth_1_s=200.0))
    units = {name: UNITS.get(name, "m") for name in columns}
    header = Header("Jeffcott rotor", "runup", "test", "", units, references={"clearance_m": CLEARANCE})
    writer = RunWriter(path, header)
    writer.append(columns)
    writer.finish("finished", {}, {}, [])
    return path.read_bytes()


@pytest.fixture
def run_file(made: bytes, tmp_path: Path) -> Path:
    path = tmp_path / "run.h5"
    path.write_bytes(made)
    return path


@pytest.mark.parametrize(
    "options",
    [
        ["--signal", "disk", "--over", "speed"],
        ["--cascade", "--window", "100 ms"],
        ["--direction", "forward", "--log", "--window", "0.1"],
        ["--signal", "journal", "--direction", "y"],
    ],
)
def test_waterfall_takes_its_options(run_file: Path, options: list[str], frb: Frb) -> None:
    picture = run_file.with_name("w.pdf")
    frb("waterfall", str(run_file), "-o", str(picture), *options)
    assert picture.read_bytes().startswith(b"%PDF")


def test_waterfall_takes_a_window_that_fits_the_ramp_and_tells_what_a_longer_one_loses(
    run_file: Path, frb: Frb
) -> None:
    """300 Hz in 1 s: 2.3 widths part 1X and 0.5X from 75 Hz on, which is longer than 1/sqrt(300) s."""
    picture = run_file.with_name("w.svg")
    document = frb("waterfall", str(run_file), "-o", str(picture), "--json").document
    assert document["window_s"] == pytest.approx(2.3 / 37.5, rel=1e-3)
    assert document["synchronous_low_dB"] == pytest.approx(0.063, abs=0.001)
    assert "dB low" not in picture.read_text()
    said = frb("waterfall", str(run_file), "-o", str(picture), "--json", "--window", "0.2 s")
    assert json.loads(said.out)["synchronous_low_dB"] == pytest.approx(3.66, abs=0.05)
    assert "up to 3.7 dB low" in picture.read_text()
    assert said.err == ""


def test_waterfall_draws_amplitudes_by_order(run_file: Path, frb: Frb) -> None:
    document = frb("waterfall", str(run_file), "--signal", "disk", "--order", "1,0.5", "--json").document
    assert document["output"] == str(run_file.with_name("run-orders.png"))
    assert Path(document["output"]).read_bytes().startswith(PNG)
    assert (document["over"], document["direction"]) == ("speed", "x")
    first, half = document["orders"]
    assert list(first) == ["order", "amplitude_max_m", "t_s", "speed_Hz"]
    assert (first["order"], half["order"]) == (1.0, 0.5)
    assert half["amplitude_max_m"] > 10 * CLEARANCE / 35  # the whirl: 0.8 of the clearance at the journal
    for words in (["--over", "time", "--log"], ["--direction", "forward"]):
        frb("waterfall", str(run_file), "--order", "1", "--quiet", *words)


@pytest.mark.parametrize("what", ["eccentricity", "orbit", "displacement", "summary"])
def test_plot_draws_each_picture(run_file: Path, what: str, frb: Frb) -> None:
    frb("plot", str(run_file), "--what", what)
    assert run_file.with_name(f"run-{what}.png").read_bytes().startswith(PNG)


def test_plot_overlays_runs_between_two_times(run_file: Path, made: bytes, frb: Frb) -> None:
    other = run_file.with_name("other.h5")
    other.write_bytes(made)
    picture = run_file.with_name("both.svg")
    words = ["plot", str(run_file), str(other), "--from", "0.4 s", "--to", "600 ms", "-o", str(picture), "--json"]
    said = frb(*words)
    drawn = picture.read_text()
    assert ">other<" in drawn
    ticks = [float(text) for text in re.findall(r">(0\.\d+)<", drawn.split("time in s")[0])]
    assert min(ticks) == 0.4
    assert max(ticks) == 0.6
    assert said.document["run"] == [str(run_file), str(other)]


def test_csv_has_the_signals_with_all_their_digits(run_file: Path, frb: Frb) -> None:
    document = frb("export", str(run_file), "--json").document
    assert document["columns"] == COLUMNS
    assert Path(document["output"]).read_text().splitlines()[0] == ",".join(COLUMNS)
    table = np.loadtxt(document["output"], delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table, read_run(run_file).to_pandas().to_numpy())


def test_csv_goes_to_stdout(run_file: Path, frb: Frb) -> None:
    said = frb("export", str(run_file), "-o", "-")
    assert said.out.splitlines()[0] == ",".join(COLUMNS)
    assert len(said.out.splitlines()) == len(read_run(run_file)) + 1
    assert said.err == ""
    assert list(run_file.parent.iterdir()) == [run_file]


def test_mat_has_the_signals_as_columns(run_file: Path, frb: Frb) -> None:
    frb("export", str(run_file), "--format", "mat", "--quiet")
    content = loadmat(run_file.with_suffix(".mat"))
    np.testing.assert_array_equal(content["disk_x_m"][:, 0], read_run(run_file)["disk_x_m"])
    assert content["title"][0] == "Jeffcott rotor"


def test_parquet_needs_its_extra(run_file: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.setattr("frbcli.results.export.find_spec", lambda _: None)
    assert "pip install frbcli[parquet]" in frb("export", str(run_file), "--format", "parquet", code=2).err
    assert not run_file.with_suffix(".parquet").exists()


@pytest.mark.skipif(find_spec("pyarrow") is None, reason="the extra parquet is not installed")
def test_parquet_has_the_signals(run_file: Path, frb: Frb) -> None:
    frb("export", str(run_file), "--format", "parquet")
    assert list(pd.read_parquet(run_file.with_suffix(".parquet")).columns) == COLUMNS
