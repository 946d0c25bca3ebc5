"""MAT files by two writers: scipy for version 5, h5py in MATLAB's layout for version 7.3. Both are read the same."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

from frbcli.analysis.measured import Measurement, measured_run
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
from frbcli.plot.waterfall import waterfall_figure
from frbcli.results.measured import read_columns

RATE_Hz, SPEED_Hz = 4000.0, 120.0
TIME = np.arange(400) / RATE_Hz
X, Y = 12.5 * np.cos(2.0 * np.pi * SPEED_Hz * TIME), 6.0 * np.sin(2.0 * np.pi * SPEED_Hz * TIME)
SPEED = np.full(len(TIME), SPEED_Hz)
HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"

Write = Callable[[Path, Mapping[str, Any]], Path]


def version_5(path: Path, variables: Mapping[str, Any]) -> Path:
    savemat(path, dict(variables))
    return path


def version_7_3(path: Path, variables: Mapping[str, Any]) -> Path:
    """HDF5 behind 512 bytes; the axes of arrays reversed, each with its MATLAB_class; structs as groups; cells, and the
    fields of arrays of structs, as references to what lies in #refs#."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in variables.items():
            _put(file, file, name, value)
    with path.open("r+b") as raw:
        raw.write(HEADER)
    return path


def _put(file: h5py.File, group: Any, name: str, value: Any) -> Any:
    if isinstance(value, dict):
        made = group.create_group(name)
        made.attrs["MATLAB_class"] = np.bytes_("struct")
        for field, inner in value.items():
            _put(file, made, field, inner)
        return made
    array = np.atleast_2d(value)
    if array.dtype.names:  # an array of structs
        made = group.create_group(name)
        made.attrs["MATLAB_class"] = np.bytes_("struct")
        for field in array.dtype.names:
            made.create_dataset(field, data=_references(file, array[field]).T, dtype=h5py.ref_dtype)
        return made
    if array.dtype == object:
        made = group.create_dataset(name, data=_references(file, array).T, dtype=h5py.ref_dtype)
        made.attrs["MATLAB_class"] = np.bytes_("cell")
        return made
    if array.dtype.kind == "U":
        letters = np.array([[ord(letter) for letter in str(array[0, 0])]], dtype=np.uint16)
        made = group.create_dataset(name, data=letters.T)
        made.attrs["MATLAB_class"] = np.bytes_("char")
        return made
    if np.iscomplexobj(array):
        array = np.rec.fromarrays([array.real, array.imag], names="real,imag")
    made = group.create_dataset(name, data=array.T)
    made.attrs["MATLAB_class"] = np.bytes_("double" if array.dtype.kind in "fV" else str(array.dtype))
    return made


def _references(file: h5py.File, array: np.ndarray) -> np.ndarray:
    store = file.require_group("#refs#")
    found = np.empty(array.shape, dtype=object)
    for place in np.ndindex(array.shape):
        found[place] = _put(file, store, f"r{len(store)}", array[place]).ref
    return found


WRITERS = pytest.mark.parametrize("write", [version_5, version_7_3])


def holds(path: Path, given: Measurement) -> None:
    run = measured_run(path, given)
    np.testing.assert_allclose(run["journal_x_m"], 1e-6 * (X - X.mean()), atol=1e-15)
    np.testing.assert_allclose(run["journal_y_m"], 1e-6 * (Y - Y.mean()), atol=1e-15)
    np.testing.assert_allclose(np.diff(run["time_s"]), 1.0 / RATE_Hz, rtol=1e-9)
    np.testing.assert_allclose(run["speed_Hz"], SPEED_Hz)


def in_rate(x: str, y: str, n: str, rate: float | str = "fs") -> Measurement:
    return Measurement(x, 35e-6, y, rate=rate, speed=n, unit_m=1e-6)


@WRITERS
@pytest.mark.parametrize("shape", [(1, -1), (-1, 1)], ids=["row", "column"])
def test_rows_and_columns_beside_a_sampling_rate(write: Write, shape: tuple[int, int], tmp_path: Path) -> None:
    variables = {"x": X, "y": Y, "n": SPEED, "t": TIME}
    path = write(tmp_path / "run.mat", {name: v.reshape(shape) for name, v in variables.items()} | {"fs": RATE_Hz})
    holds(path, in_rate("x", "y", "n"))
    holds(path, in_rate("x", "y", "n", RATE_Hz))
    holds(path, Measurement("x", 35e-6, "y", time="t", speed="n", unit_m=None))
    read = read_columns(path)
    assert read.shapes["x"] == ((1, 400) if shape == (1, -1) else (400, 1))
    assert read.numbers == {"fs": RATE_Hz}


@WRITERS
@pytest.mark.parametrize("transposed", [False, True])
def test_samples_of_a_matrix_are_along_its_longer_side(write: Write, transposed: bool, tmp_path: Path) -> None:
    probes = np.stack([X, Y, SPEED], axis=1)
    path = write(tmp_path / "run.mat", {"probes": probes.T if transposed else probes, "fs": RATE_Hz})
    holds(path, in_rate("probes.1", "probes.2", "probes.3"))


@WRITERS
def test_structs_in_structs(write: Write, tmp_path: Path) -> None:
    rig = {"serial": 3.0, "title": "rig", "probe": {"x": X, "y": Y[:, None]}, "speed": {"n": SPEED, "fs": RATE_Hz}}
    path = write(tmp_path / "run.mat", {"rig": rig})
    holds(path, in_rate("rig.probe.x", "rig.probe.y", "rig.speed.n", "rig.speed.fs"))
    assert read_columns(path).doubtful == {"rig.title": "holds text"}


@WRITERS
def test_arrays_of_structs_and_cells(write: Write, tmp_path: Path) -> None:
    channels = np.zeros((1, 2), dtype=[("data", object), ("gain", object)])
    for number, motion in enumerate((X, Y)):
        channels[0, number] = (np.atleast_2d(motion), np.array([[8.0 + number]]))
    cells = np.empty((1, 2), dtype=object)
    cells[0, 0], cells[0, 1] = np.atleast_2d(SPEED), np.array([[RATE_Hz]])
    path = write(tmp_path / "run.mat", {"channels": channels, "cells": cells})
    holds(path, in_rate("channels.1.data", "channels.2.data", "cells.1", "cells.2"))
    assert read_columns(path).numbers["channels.2.gain"] == 9.0


@WRITERS
def test_what_cannot_be_a_column_is_named(write: Write, tmp_path: Path) -> None:
    path = write(tmp_path / "run.mat", {"x": X, "z": X + 1j * Y, "cube": np.ones((2, 3, 4)), "fs": RATE_Hz})
    with pytest.raises(InputError, match='"z" holds complex numbers'):
        read_columns(path)["z"]
    with pytest.raises(InputError, match=r'"cube" has 3 dimensions'):
        read_columns(path)["cube"]
    with pytest.raises(InputError, match=r'"fs" is the single number 4000, not a column. It has: "x"'):
        read_columns(path)["fs"]
    with pytest.raises(InputError, match=r'no column "X_probe". It has: "x"'):
        read_columns(path)["X_probe"]


def test_sparse_matrices_are_named(tmp_path: Path) -> None:
    path = version_5(tmp_path / "run.mat", {"x": X, "s": csc_array(np.eye(3))})
    assert read_columns(path).doubtful == {"s": "is sparse"}
    with h5py.File(version_7_3(tmp_path / "new.mat", {"x": X}), "r+") as file:
        file.create_group("s").attrs["MATLAB_sparse"] = 3
        opaque = file.create_dataset("table", data=np.zeros((6, 1), dtype=np.uint32))
        opaque.attrs["MATLAB_class"] = np.bytes_("timetable")
    found = read_columns(tmp_path / "new.mat").doubtful
    assert found["s"] == "is sparse"
    assert "an object of MATLAB" in found["table"]


def test_a_cell_that_holds_itself_ends(tmp_path: Path) -> None:
    with h5py.File(version_7_3(tmp_path / "run.mat", {"x": X}), "r+") as file:
        cell = file.create_dataset("c", shape=(1, 1), dtype=h5py.ref_dtype)
        cell.attrs["MATLAB_class"] = np.bytes_("cell")
        cell[0, 0] = cell.ref
    assert list(read_columns(tmp_path / "run.mat").doubtful.values()) == ["is nested too deeply"]


@WRITERS
def test_a_file_without_times_tells_its_numbers(write: Write, tmp_path: Path) -> None:
    path = write(tmp_path / "run.mat", {"x": X, "fs": RATE_Hz})
    with pytest.raises(InputError, match="fs = 4000"):
        measured_run(path, Measurement("x", 35e-6, speed_Hz=SPEED_Hz, unit_m=1e-6))
    with pytest.raises(InputError, match='no single number "sampling"'):
        measured_run(path, Measurement("x", 35e-6, rate="sampling", speed_Hz=SPEED_Hz, unit_m=1e-6))


@WRITERS
def test_a_file_is_listed(write: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path / "run.mat", {"probes": np.stack([X, Y]), "fs": RATE_Hz, "rig": {"title": "rig 3"}})
    assert frb(["waterfall", str(path), "--columns", "--json", "--quiet"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["columns"]}
    assert rows["probes.2"] == {"name": "probes.2", "shape": [2, 400], "unit": None, "kind": "column"}
    assert rows["fs"]["kind"] == "number 4000"
    assert rows["rig.title"]["kind"] == "not usable: holds text"
    assert frb(["waterfall", str(path), "--columns"]) == 0
    assert "2 x 400" in capsys.readouterr().out


def test_amplitudes_in_um_need_no_clearance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = version_5(tmp_path / "run.mat", {"x": np.tile(X, 10), "y": np.tile(Y, 10), "fs": RATE_Hz})
    words = ["waterfall", str(path), "--x", "x", "--y", "y", "--rate", "fs", "--speed-at", "120 Hz"]
    out = ["-o", str(tmp_path / "a.png"), "--quiet"]
    assert frb([*words, "--linear", *out]) == 0
    assert frb([*words, "--order", "1", *out]) == 0
    assert capsys.readouterr().err == ""
    assert frb([*words, *out]) == 2
    assert "--linear does without" in capsys.readouterr().err
    run = measured_run(path, Measurement("x", y="y", rate=RATE_Hz, speed_Hz=SPEED_Hz, unit_m=1e-6))
    with pytest.raises(InputError, match="--clearance, or --linear"):
        waterfall_figure(run)


def test_units_of_a_file_are_taken(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    rows = [f"{1e3 * t:.4f};{x / 25.4:.7f};{y / 25.4:.7f};{60 * SPEED_Hz:g}".replace(".", ",")
            for t, x, y in zip(TIME, X, Y, strict=True)]  # fmt: skip
    path.write_text("\n".join(["time [ms];X probe [mil];Y probe (mils);n [U/min]", *rows, ""]), encoding="utf-8")
    given = Measurement("X probe", 35e-6, "Y probe", time="time", speed="n", unit_m=None, time_unit_s=None,
                        speed_unit_Hz=None)  # fmt: skip
    run = measured_run(path, given)
    np.testing.assert_allclose(run["journal_x_m"], 1e-6 * (X - X.mean()), atol=1e-11)
    np.testing.assert_allclose(run["speed_Hz"], SPEED_Hz, rtol=1e-9)
    path.write_text(path.read_text(encoding="utf-8").replace("[mil]", "[V]"), encoding="utf-8")
    with pytest.raises(InputError, match=r'"X probe" is in V, which is no unit of this kind. Say by --unit'):
        measured_run(path, given)


# --- universal files ---


def universal(path: Path, data: Mapping[str, np.ndarray], function: int = 1) -> Path:
    pyuff = pytest.importorskip("pyuff")
    sets = [
        pyuff.prepare_58(
            binary=0, id1=name, func_type=function, rsp_node=11 + k, rsp_dir=k + 1, ref_node=1, ref_dir=1,
            x=TIME, data=values, abscissa_spacing=1, abscissa_inc=1 / RATE_Hz, abscissa_min=0.0, z_axis_value=0.0,
            ordinate_axis_units_lab="um" if k < 2 else "Hz", num_pts=len(TIME), ord_data_type=4,
            orddenom_spec_data_type=0, abscissa_spec_data_type=17, ordinate_spec_data_type=8,
        )
        for k, (name, values) in enumerate(data.items())
    ]  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")
    return path


def test_a_universal_file_without_responses_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no response over time"):
        read_columns(universal(tmp_path / "run.uff", {"x": X}, function=4))
    (tmp_path / "none.uff").write_text("no universal file", encoding="utf-8")
    with pytest.raises(InputError, match="no response over time"):
        read_columns(tmp_path / "none.uff")


def test_a_universal_file_asks_for_its_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("frbcli.results.measured.find_spec", lambda _: None)
    (tmp_path / "run.uff").write_text("-1", encoding="utf-8")
    with pytest.raises(InputError, match=r"pip install frbcli\[uff\]"):
        read_columns(tmp_path / "run.uff")
