"""Measured files as instruments write them, put together here byte by byte: each is read right, or refused with one
error that says where."""

import random
import struct
import time as clock
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from frbcli.analysis.measured import Measurement, measured_run
from frbcli.cli.main import run as frb
from frbcli.errors import InputError

RATE_Hz, SPEED_Hz, AMPLITUDE_um = 4000.0, 120.0, 12.5
COUNT = 2000
TIME = np.arange(COUNT) / RATE_Hz
X = AMPLITUDE_um * np.cos(2.0 * np.pi * SPEED_Hz * TIME)
Y = 0.5 * AMPLITUDE_um * np.sin(2.0 * np.pi * SPEED_Hz * TIME)
GIVEN = Measurement("x", 35e-6, "y", time="t", speed="n", unit_m=1e-6)


def holds(path: Path, given: Measurement, precision: float = 2e-3) -> None:
    """Assert that a file holds the motion above."""
    run = measured_run(path, given)
    assert len(run) == COUNT
    np.testing.assert_allclose(np.diff(run["time_s"]), 1.0 / RATE_Hz, rtol=1e-3)
    np.testing.assert_allclose(run["speed_Hz"], SPEED_Hz, rtol=1e-9)
    np.testing.assert_allclose(run["journal_x_m"], 1e-6 * X, atol=precision * 1e-6 * AMPLITUDE_um)
    np.testing.assert_allclose(run["journal_y_m"], 1e-6 * Y, atol=precision * 1e-6 * AMPLITUDE_um)


def written(path: Path, head: str, rows: list[str], tail: str = "", encoding: str = "utf-8", end: str = "\n") -> Path:
    path.write_bytes((end.join([*head.splitlines(), *rows]) + tail).encode(encoding))
    return path


def said(path: Path, given: Measurement = GIVEN) -> str:
    """The one error of a file, which is told within two seconds."""
    began = clock.process_time()
    with pytest.raises(InputError) as caught:
        measured_run(path, given)
    assert clock.process_time() - began < 2.0
    assert len(caught.value.faults) == 1
    return str(caught.value)


# --- tables ---


def test_a_data_logger_with_preamble_units_and_decimal_commas(tmp_path: Path) -> None:
    head = "\ufeffGerät;Logger 3000\nDatum;03.05.2024 10:11:12\nAbtastrate;4000,0 Hz\n\nt;x;y;n\n[s];[µm];[µm];[1/min]"
    found = (f"{t:.6f};{x:.5f};{y:.5f};{60 * SPEED_Hz:.1f}" for t, x, y in zip(TIME, X, Y, strict=True))
    rows = [row.replace(".", ",") for row in found]
    path = written(tmp_path / "logger.csv", head, rows, "\r\n", "utf-8", "\r\n")
    assert 'Give --speed-unit "1 1/min"' in said(path, replace(GIVEN, speed_unit_Hz=1.0))
    holds(path, replace(GIVEN, unit_m=None))


def test_a_data_logger_in_latin_1_with_units_in_its_names(tmp_path: Path) -> None:
    head = "Zeit [ms]\tx [µm]\ty [µm]\tn [Hz]\tStatus"
    rows = [f"{1e3 * t:.3f}\t{x:.5f}\t{y:.5f}\t{SPEED_Hz}\tOK" for t, x, y in zip(TIME, X, Y, strict=True)]
    path = written(tmp_path / "logger.txt", head, rows, "\n", "latin-1")
    given = Measurement("x [µm]", 35e-6, "y [µm]", time="Zeit [ms]", speed="n [Hz]", unit_m=1e-6)
    assert 'Give --time-unit "1 ms"' in said(path, replace(given, time_unit_s=1.0))
    holds(path, Measurement(given.x, 35e-6, given.y, time=given.time, speed=given.speed, unit_m=1e-6, time_unit_s=1e-3))
    of_words = Measurement("Status", 35e-6, time="Zeit [ms]", time_unit_s=1e-3)
    assert 'no numbers in the column "Status"' in said(path, of_words)


def test_a_spreadsheet_in_utf_16(tmp_path: Path) -> None:
    rows = [f"{t:.6f}\t{x:.5f}\t{y:.5f}\t{SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]
    holds(written(tmp_path / "sheet.txt", "t\tx\ty\tn", rows, "\n", "utf-16"), GIVEN)


def test_an_oscilloscope_with_numbers_as_names_and_units_below(tmp_path: Path) -> None:
    rows = [f"{t - 0.25:+.9E},{x / 125:+.8E},{y / 125:+.8E}" for t, x, y in zip(TIME, X, Y, strict=True)]
    path = written(tmp_path / "scope.csv", "x-axis,1,2\nsecond,Volt,Volt", rows, "\n")
    holds(path, Measurement("1", 35e-6, "2", time="x-axis", speed_Hz=SPEED_Hz, unit_m=125e-6))


def test_an_oscilloscope_that_writes_settings_beside_its_samples(tmp_path: Path) -> None:
    """It writes no names: columns are called by their numbers."""
    settings = ["Record Length,2000,Points", "Sample Interval,2.5e-04,s", "Trigger Point,1000,Samples"]
    rows = [f"{settings[k] if k < 3 else ',,'},{TIME[k]:.6f},{X[k]:.5f}," for k in range(COUNT)]
    path = written(tmp_path / "scope.csv", "", rows, "\n")
    run = measured_run(path, Measurement("5", time="4", speed_Hz=SPEED_Hz))
    np.testing.assert_allclose(run["journal_x_m"], 1e-6 * X, atol=1e-11)


def test_a_table_in_blanks_with_comments(tmp_path: Path) -> None:
    rows = [f"  {t:.6f}   {x:9.5f} {y:9.5f}  {SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]
    holds(written(tmp_path / "table.txt", "# rig 3\n  t  x y   n", [*rows[:9], "# paused", *rows[9:]], "\n"), GIVEN)


def plain_rows() -> list[str]:
    return [f"{t:.6f},{x:.5f},{y:.5f},{SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]


def test_a_comma_behind_every_row_shifts_no_column(tmp_path: Path) -> None:
    holds(written(tmp_path / "table.csv", "t,x,y,n", [row + "," for row in plain_rows()], "\n"), GIVEN)
    holds(written(tmp_path / "both.csv", "t,x,y,n,", [row + "," for row in plain_rows()], "\n"), GIVEN)


@pytest.mark.parametrize(
    ("row", "problem"),
    [
        ("1.0,2.0,3.0", "row 100 (line 101) has 3 fields, and the line of names 4"),
        ("1.0,2.0,3.0,4.0,5.0", "row 100 (line 101) has 5 fields, and the line of names 4"),
        ("0.024750,1,5,2.5,120", "row 100 (line 101) has 5 fields"),
        ("0.024750,,1.0,120", 'no number in row 100 (line 101) of the column "x"'),
        ("0.024750,OVER,1.0,120", 'no number in row 100 (line 101) of the column "x"'),
        ("0.024750,True,1.0,120", 'no number in row 100 (line 101) of the column "x"'),
        ("0.024750,1e300,1.0,120", 'the number 1e+300 in row 100 (line 101) of the column "x"'),
        ("1e300,1.0,1.0,120", 'the number 1e+300 in row 100 (line 101) of the column "t"'),
        ("0.024500,1.0,1.0,120", "do not rise at row 100 (line 101)"),
        ("0.024750,1.0,1.0,2500", "4000 samples per second, too few for a rotor of up to 2500 Hz"),
    ],
)
def test_a_row_that_is_none_is_named(row: str, problem: str, tmp_path: Path) -> None:
    rows = plain_rows()
    rows[99] = row
    assert problem in said(written(tmp_path / "table.csv", "t,x,y,n", rows, "\n"))


def test_a_last_row_that_was_cut_off_is_named(tmp_path: Path) -> None:
    assert "row 2001 (line 2002)" in said(written(tmp_path / "table.csv", "t,x,y,n", [*plain_rows(), "0.5,1."]))


@pytest.mark.parametrize("names", ["t,x,x ,y,n", "t,x, x,y,n", 't,x,"x",y,n'])
def test_names_that_differ_by_a_blank_are_not_taken_for_each_other(names: str, tmp_path: Path) -> None:
    rows = [f"{t:.6f},{x:.5f},1,{y:.5f},{SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]
    assert '"x" is the name of 2 columns' in said(written(tmp_path / "table.csv", names, rows, "\n"))


@pytest.mark.parametrize(
    ("head", "rows", "problem"),
    [
        ("", ["0,1,2,3"] * 9, 'no column "x". It has: "1", "2", "3", "4"'),
        ("t,x,y,n", [], "no rows of numbers"),
        ("t,x,y,n", ["a,b,c,d"] * 9, "no rows of numbers"),
        ("t;x;y;n", ["0,1;1.5;2;3"] * 9, "both with a decimal point and with a decimal comma"),
        ("t,x,y,n", ["0,1,2,3"], "no rows of numbers"),
        (",".join(f"c{k}" for k in range(100_000)), [",".join(["1"] * 100_000)] * 3, "100000 columns"),
    ],
)
def test_a_table_that_is_none_is_refused(head: str, rows: list[str], problem: str, tmp_path: Path) -> None:
    assert problem in said(written(tmp_path / "table.csv", head, rows, "\n"))


def test_a_gap_in_the_times_is_refused_and_no_vibration_is_seen(tmp_path: Path) -> None:
    """A synchronous motion of 600 Hz, from which half a second is lost, had a self-excited one of 598.8 Hz."""
    time = np.arange(8000) / 2500.0
    time[4000:] += 0.5
    rows = [
        f"{t:.6f},{10 * np.cos(1200 * np.pi * t):.5f},{10 * np.sin(1200 * np.pi * t):.5f},600" for t in time
    ]
    path = written(tmp_path / "gap.csv", "t,x,y,n", rows, "\n")
    assert 'a step of 0.5004 s in "t" before row 4001 (line 4002), and else of 0.0004 s' in said(path)


def test_times_that_scatter_add_no_frequency(tmp_path: Path) -> None:
    """What lies near the highest frequency that samples show keeps its amplitude, and there is nothing beside it."""
    chance = np.random.default_rng(1)
    time = (np.arange(8000) + chance.uniform(-0.2, 0.2, 8000)) / 4000.0
    angle = 2.0 * np.pi * 600.0 * time
    rows = [f"{t:.9f},{10 * np.cos(a):.6f},{10 * np.sin(a):.6f},600" for t, a in zip(time, angle, strict=True)]
    run = measured_run(written(tmp_path / "shaken.csv", "t,x,y,n", rows, "\n"), GIVEN)
    inner = slice(100, -100)
    expected = 1e-5 * np.cos(2.0 * np.pi * 600.0 * run["time_s"])
    assert np.sqrt(np.mean((run["journal_x_m"] - expected)[inner] ** 2)) < 0.02e-5
    assert run.events == []


@pytest.mark.parametrize("faster", [1.0, 5.0])
def test_times_since_1970_are_times(faster: float, tmp_path: Path) -> None:
    """They are known to 2.4e-7 s."""
    rows = [f"{1.7e9 + t / faster:.6f},{x:.5f},{y:.5f},{faster * SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]
    path = written(tmp_path / "epoch.csv", "t,x,y,n", rows, "\n")
    assert len(measured_run(path, GIVEN)["time_s"]) >= COUNT
    words = ["--x", "x", "--y", "y", "--time", "t", "--speed-column", "n", "--clearance", "35 um", "--quiet"]
    assert frb(["waterfall", str(path), *words, "-o", str(tmp_path / "a.png")]) == 0


@pytest.mark.parametrize("unit", ["ms", "us"])
def test_times_in_another_unit_are_told_at_once(unit: str, tmp_path: Path) -> None:
    one = {"ms": 1e-3, "us": 1e-6}[unit]
    rows = [f"{t / one:.3f},{x:.5f},{y:.5f},{SPEED_Hz}" for t, x, y in zip(TIME, X, Y, strict=True)]
    path = written(tmp_path / "table.csv", "t,x,y,n", rows, "\n")
    assert "Check --time-unit and --speed-unit" in said(path)
    holds(path, Measurement("x", 35e-6, "y", time="t", speed="n", unit_m=1e-6, time_unit_s=one))


# --- WAV ---


def wav(
    samples: np.ndarray, bits: int, kind: int = 1, rate: int = int(RATE_Hz), extra: bytes = b"", lost: int = 0
) -> bytes:
    """A file of samples (n, channels) from -1 to 1; kind 1: whole numbers, 3: floating point."""
    channels = samples.shape[1]
    if kind == 3:
        data = samples.astype("<f4").tobytes()
    elif bits == 8:
        data = np.round(samples * 127.0 + 128.0).astype("u1").tobytes()
    else:
        whole = np.round(samples * (2.0 ** (bits - 1) - 1.0)).astype("<i4")
        data = whole.view("u1").reshape(*whole.shape, 4)[..., : bits // 8].tobytes()
    form = struct.pack("<HHIIHH", kind, channels, rate, rate * channels * bits // 8, channels * bits // 8, bits)
    chunks = b"fmt " + struct.pack("<I", len(form)) + form + extra + b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks[: len(chunks) - lost]


MOTION = np.stack([X, Y], axis=1) / 50.0  # of a full scale of 50 um
IN_WAV = Measurement("1", 35e-6, "2", speed_Hz=SPEED_Hz, unit_m=50e-6)
NOTES = b"bext" + struct.pack("<I", 8) + b"rig no 3"


@pytest.mark.parametrize(("bits", "kind"), [(8, 1), (16, 1), (24, 1), (32, 1), (32, 3)])
@pytest.mark.parametrize("extra", [b"", NOTES], ids=["plain", "notes"])
def test_samples_of_any_width_have_the_same_amplitude(bits: int, kind: int, extra: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.wav"
    path.write_bytes(wav(MOTION, bits, kind, extra=extra))
    holds(path, IN_WAV, precision=0.04 if bits == 8 else 2e-3)
    assert np.ptp(measured_run(path, IN_WAV)["journal_x_m"]) == pytest.approx(2e-6 * AMPLITUDE_um, rel=0.02)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (wav(MOTION, 16, lost=1000), "cannot be read"),
        (wav(MOTION, 16, lost=1001), "cannot be read"),
        (wav(MOTION, 16)[:50], "cannot be read"),
        (wav(MOTION, 16, kind=7), "cannot be read"),
        (wav(MOTION, 16, rate=0), "no samples per second"),
        (wav(MOTION, 16, rate=1), "1 samples per second, too few for a rotor of up to 120 Hz"),
        (wav(MOTION[:0], 16), "no samples"),
        (wav(np.zeros((3, 2000)), 16), "2000 channels"),
        (wav(np.full((9, 2), np.nan), 32, 3), "no numbers in the column"),
    ],
    ids=["short", "odd", "head", "law", "rate 0", "rate 1", "empty", "channels", "NaN"],
)
def test_a_damaged_recording_is_refused(content: bytes, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "run.wav"
    path.write_bytes(content)
    assert problem in said(path, IN_WAV)


# --- MAT ---


def element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def matrix(name: str, values: np.ndarray, imaginary: np.ndarray | None = None) -> bytes:
    """A matrix of doubles as MATLAB keeps it: by columns, compressed."""
    flags = element(6, struct.pack("<II", 6 | (0x0800 if imaginary is not None else 0), 0))
    head = flags + element(5, struct.pack("<ii", *values.shape)) + element(1, name.encode())
    parts = [element(9, part.astype("<f8").tobytes("F")) for part in (values, imaginary) if part is not None]
    packed = zlib.compress(element(14, head + b"".join(parts)))
    return struct.pack("<II", 15, len(packed)) + packed


def mat(path: Path, **variables: np.ndarray) -> Path:
    head = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    path.write_bytes(head + b"".join(matrix(name, np.atleast_2d(values)) for name, values in variables.items()))
    return path


def test_whole_numbers_in_a_matrix(tmp_path: Path) -> None:
    counts = np.round(np.stack([X, Y], axis=1) / 5e-4).astype(np.int16)
    savemat(tmp_path / "run.mat", {"adc": counts, "title": "rig 3", "rig": {"serial": 3.0}})
    given = Measurement("adc.1", 35e-6, "adc.2", rate=RATE_Hz, speed_Hz=SPEED_Hz, unit_m=5e-10)
    holds(tmp_path / "run.mat", given)


@pytest.mark.parametrize(
    ("variables", "x", "problem"),
    [
        ({"x": X, "y": Y[:-1]}, "x", "unequal length"),
        ({"probes": np.ones((1001, 1002))}, "probes.1", "1001 x 1002 values, more than 1000 columns"),
        ({"x": np.where(TIME > 0.1, np.nan, X), "y": Y}, "x", "no number in row 402"),
        ({"fs": np.array([1.0])}, "x", "no columns of numbers"),
    ],
)
def test_variables_that_are_no_signals_are_refused(
    variables: dict[str, np.ndarray], x: str, problem: str, tmp_path: Path
) -> None:
    path = mat(tmp_path / "run.mat", **variables)
    assert problem in said(path, Measurement(x, 35e-6, "y", rate=RATE_Hz, speed_Hz=SPEED_Hz, unit_m=1e-6))


def test_a_damaged_file_of_matlab_7_3_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<H", 0x0200) + b"IM"
    path.write_bytes(head.ljust(512, b"\0") + b"\x89HDF\r\n\x1a\n" + bytes(500))
    assert "cannot be read" in said(path)


# --- options ---


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"rate": float("nan"), "time": None}, "samples per second"),
        ({"rate": float("inf"), "time": None}, "samples per second"),
        ({"clearance": 1e-300}, "clearance"),
        ({"unit_m": 1e300}, "Check --unit"),
        ({"speed": None, "speed_Hz": 1e300}, "too few for a rotor"),
        ({"speed_unit_Hz": 60.0}, "too few for a rotor"),
        ({"time_unit_s": 1e-12}, "turns 6e-11 times"),
    ],
)
def test_options_that_no_machine_has_are_refused(
    changed: dict[str, float | None], problem: str, tmp_path: Path
) -> None:
    path = written(tmp_path / "table.csv", "t,x,y,n", plain_rows(), "\n")
    assert problem in said(path, Measurement(**{**vars(GIVEN), **changed}))


# --- anything ---

TOKENS = ("", "nan", "inf", "-inf", "1e300", "-1e15", "1e-320", "0", "1,5", "abc", '"', "#", ";", "\t", "True", "1+2j",
          "0x10", "\x1b[31m", "1_000", "9" * 400, "\ufeff", "''", "-", "1e", "µ")  # fmt: skip
SEEDS = [*range(6), *(pytest.param(seed, marks=pytest.mark.nightly) for seed in range(6, 96))]


def hostile_table(chance: random.Random) -> bytes:
    delimiter = chance.choice([",", ";", "\t", " "])
    rows = [row.split(",") for row in ["t,x,y,n", *plain_rows()[: chance.choice([3, 30, 500])]]]
    for _ in range(chance.choice([1, 1, 5, 200])):
        row = chance.choice([rows[0], chance.choice(rows)])
        change = chance.randrange(4)
        if change == 0 and row:
            row[chance.randrange(len(row))] = chance.choice(TOKENS)
        elif change == 1:
            row.insert(chance.randrange(len(row) + 1), chance.choice(TOKENS))
        elif change == 2 and row:
            del row[chance.randrange(len(row))]
        else:
            rows.insert(chance.randrange(len(rows) + 1), [chance.choice(TOKENS) for _ in range(chance.randrange(8))])
    text = chance.choice(["\n", "\r\n", "\r"]).join(delimiter.join(row) for row in rows)
    return text.encode(chance.choice(["utf-8", "utf-8", "utf-16", "utf-8-sig"]), "replace")


def hostile_bytes(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(chance.choice([1, 1, 4, 50])):
        at = chance.randrange(chance.choice([min(200, len(changed)), len(changed)]))
        changed[at] = chance.choice([0, 1, 127, 128, 255, chance.randrange(256)])
    return bytes(changed[: chance.choice([len(changed), len(changed), chance.randrange(len(changed))])])


@pytest.mark.parametrize("seed", SEEDS)
def test_any_file_is_read_or_refused_by_one_error(
    seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Warnings of Python are errors in tests."""
    chance = random.Random(seed)
    kind = ("csv", "wav", "mat")[seed % 3]
    path = tmp_path / f"run.{kind}"
    if kind == "csv":
        path.write_bytes(hostile_table(chance))
        words = ["--x", "x", "--y", "y", chance.choice(["--time", "--rate"]), "t", "--speed-column", "n"]
        words = [word if words[4] == "--time" or word != "t" else "4000" for word in words]
    elif kind == "wav":
        bits, form = chance.choice([(8, 1), (16, 1), (24, 1), (32, 3)])
        path.write_bytes(hostile_bytes(wav(MOTION, bits, form, extra=NOTES), chance))
        words = ["--x", "1", "--y", "2", "--speed-at", chance.choice(["120 Hz", "1e-9 Hz", "1e9 Hz"])]
    else:
        mat(path, t=TIME, x=X, y=Y, n=np.full(COUNT, SPEED_Hz))
        path.write_bytes(hostile_bytes(path.read_bytes(), chance))
        words = ["--x", "x", "--y", "y", "--time", "t", "--speed-column", "n"]
    began = clock.process_time()
    code = frb(["waterfall", str(path), *words, "--clearance", "35 um", "-o", str(tmp_path / "a.png"), "--quiet"])
    told = capsys.readouterr().err
    assert code in (0, 2), told
    assert told.count("frb: ") == (1 if code else 0)
    assert len(told) < 2000
    assert clock.process_time() - began < 10.0
