"""Exports of instruments: each head is read, units are taken from the file or said.

The files of tests/data/instruments hold the first lines of exports of one motion, of 20 um at 20 Hz, sampled with 2048
Hz while the rotor speed rises from 1200 rpm.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from frbcli.analysis.measured import Measurement, measured_run
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
from frbcli.results.measured import read_columns
from frbcli.results.store import Run
from frbcli.units import SPEED, ValueFault, quantity

FILES = Path(__file__).parents[1] / "data" / "instruments"
STEP_s, AMPLITUDE_m, SPEED_Hz = 1.0 / 2048.0, 20e-6, 20.0


def is_the_motion(run: Run) -> None:
    """Assert that a run begins with the motion of the files."""
    time = run["time_s"]
    assert np.diff(time) == pytest.approx(STEP_s, rel=2e-3)
    x, moved = run["journal_x_m"], np.cos(2.0 * np.pi * SPEED_Hz * (time - time[0])) - 1.0
    assert x - x[0] == pytest.approx(AMPLITUDE_m * moved, abs=1.2e-6)


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("blankcols.csv", Measurement("x", y="y", time="t", speed="n")),
        ("diadem.csv", Measurement("X", y="Y", time="Time", speed="n")),
        ("iso.csv", Measurement("X Direct", y="Y Direct", time="Timestamp", speed="Speed")),
        ("lvm_one.txt", Measurement("X probe", y="Y probe", time="X_Value", speed_Hz=20.0)),
        ("micron.csv", Measurement("X", y="Y", time="Time", speed="Speed")),
        ("pico_clip.csv", Measurement("Channel A", y="Channel B", time="Time", speed_Hz=20.0, unit_m=125e-6)),
        ("rigol.csv", Measurement("CH1", y="CH2", speed_Hz=20.0, unit_m=1e-6)),
        ("rigol.csv", Measurement("CH1", y="CH2", rate="Increment", speed_Hz=20.0, unit_m=1e-6)),
        ("toa5.csv", Measurement("X_probe", y="Y_probe", time="TIMESTAMP", speed="Speed")),
    ],
)
def test_the_export_of_an_instrument_is_read(name: str, given: Measurement) -> None:
    run = measured_run(FILES / name, given)
    is_the_motion(run)
    assert run["speed_Hz"][0] == pytest.approx(20.0, rel=1e-3)  # 1200 rpm


def rows(rate: float = 2048.0, count: int = 1000, decimals: int = 7) -> list[tuple[str, float, float, float]]:
    time = np.arange(count) / rate
    angle = 2.0 * np.pi * SPEED_Hz * time
    return [(f"{t:.{decimals}f}", 20.0 * np.cos(a), 20.0 * np.sin(a), 1200.0) for t, a in zip(time, angle, strict=True)]


def table(path: Path, head: str, lines: list[str]) -> Path:
    path.write_text("\n".join([*([head] if head else []), *lines]) + "\n", encoding="utf-8")
    return path


PLAIN = [f"{t},{x:.5f},{y:.5f},{n}" for t, x, y, n in rows()]


# --- heads ---


@pytest.mark.parametrize(
    "head",
    [
        "1,2,3,4\nt,x,y,n\ns,um,um,rpm",  # numbers of channels above the names
        "Channels,3,,\nRate,2048,,\nt,x,y,n\ns,um,um,rpm\nMin,-20,-20,1200\nMax,20,20,1200",
        "Title\n\nt [s],x [um],y [um],n [rpm]",
        "Serial,77,,\nt,x,y,n\n(s),(um),(um),(rpm)\n,,Smp,Smp",
        "# made by hand\n# t [s],x [um],y [um],n [rpm]",
    ],
)
def test_rows_begin_where_a_block_is_whole(head: str, tmp_path: Path) -> None:
    run = measured_run(table(tmp_path / "a.csv", head, PLAIN), Measurement("x", y="y", time="t", speed="n"))
    assert len(run) == len(PLAIN)
    is_the_motion(run)
    assert run["speed_Hz"] == pytest.approx(20.0)


def test_names_between_blanks_keep_their_units_in_brackets(tmp_path: Path) -> None:
    lines = [line.replace(",", "  ") for line in PLAIN]
    path = table(tmp_path / "a.txt", "% t [s]  x [um pp]  y (um pp)  n (rpm)", lines)
    run = measured_run(path, Measurement("x [um pp]", y="y (um pp)", time="t", speed="n"))
    is_the_motion(run)
    assert "x [um pp] in um pp" in run.remarks[-1]


def test_a_table_without_names_has_its_columns_by_number(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "", PLAIN)
    is_the_motion(measured_run(path, Measurement("2", y="3", time="1", speed="4", speed_unit_Hz=1 / 60)))


def test_names_that_are_double_are_numbered_and_one_without_a_name_is_read(tmp_path: Path) -> None:
    lines = [f"{t},{x:.5f},{y:.5f},7,{n}" for t, x, y, n in rows()]
    path = table(tmp_path / "a.csv", "t [s],x [um],x [um],,n [rpm]", lines)
    is_the_motion(measured_run(path, Measurement("x [um].1", y="x [um].2", time="t", speed="n")))
    with pytest.raises(InputError, match=r'"x \[um\]" is the name of 2 columns. Write "x \[um\]\.1"'):
        measured_run(path, Measurement("x [um]", time="t", speed="n"))
    assert "4" in read_columns(path).values


@pytest.mark.parametrize("word", ["OVERLOAD", "∞", "", "NAN", ])
@pytest.mark.parametrize("mark", [".", ","])
def test_a_word_for_a_gap_spoils_its_own_row_alone(word: str, mark: str, tmp_path: Path) -> None:
    lines = [";".join([t, f"{x:.5f}", f"{y:.5f}", "1.5"]).replace(".", mark) for t, x, y, _ in rows()]
    cells = lines[6].split(";")
    lines[6] = ";".join([*cells[:3], word])
    path = table(tmp_path / "a.csv", "t;x;y;gain", lines)
    is_the_motion(measured_run(path, Measurement("x", y="y", time="t", speed_Hz=20.0)))
    column = read_columns(path).values["gain"]
    assert np.isfinite(column).sum() == len(lines) - 1
    with pytest.raises(InputError, match=r"row 7 \(line 8\)"):
        measured_run(path, Measurement("gain", time="t", speed_Hz=20.0))


@pytest.mark.parametrize(
    ("head", "stamp"),
    [
        ("when", "2023-05-04T23:59:59.{:07d}Z"),
        ("when", "04.05.2023 23:59:59,{:07d}"),
        ("when", "23:59:59.{:07d}"),
        ("when", "04-May-2023 23:59:59.{:07d}"),
        ("when", "04.05.23 23:59:59.{:07d}"),
        ("date;when", "05/04/2023;11:59:59.{:07d} PM"),
    ],
)
def test_time_stamps_are_times(head: str, stamp: str, tmp_path: Path) -> None:
    lines = []
    for k, (_, x, y, n) in enumerate(rows()):
        ticks = round(k * STEP_s * 1e7) + 9_900_000  # midnight passes after 10 ms
        text = stamp.format(ticks % 10_000_000)
        if ticks >= 10_000_000:
            text = text.replace("11:59:59", "12:00:00").replace(" PM", " AM").replace("23:59:59", "00:00:00")
            text = text.replace("04-May", "05-May")
            text = text.replace("2023-05-04", "2023-05-05").replace("04.05.", "05.05.").replace("05/04/", "05/05/")
        lines.append(f"{text};{x:.5f};{y:.5f};{n}")
    path = table(tmp_path / "a.csv", f"{head};x [um];y [um];n [rpm]", lines[:2048])
    is_the_motion(measured_run(path, Measurement("x", y="y", time="when", speed="n")))


def test_times_in_words_are_no_numbers(tmp_path: Path) -> None:
    lines = [f"Thu May 4 9h51 {t},{x:.5f}" for t, x, *_ in rows()]
    path = table(tmp_path / "a.csv", "t,x", lines)
    with pytest.raises(InputError, match=r'no numbers in the column "t".*times may be stamps such as'):
        measured_run(path, Measurement("x", time="t", speed_Hz=20.0))


@pytest.mark.parametrize("name", ["run.tdms", "run.xlsx"])
def test_a_file_that_is_not_read_says_what_to_do(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(b"TDSm")
    with pytest.raises(InputError, match="Export its channels as CSV or MAT"):
        read_columns(tmp_path / name)


# --- times ---


@pytest.mark.parametrize("decimals", [3, 4, 5])
def test_even_times_that_are_rounded_are_even(decimals: int, tmp_path: Path) -> None:
    """Made even by splines, 2048 Hz with four decimals had lines of -42 dB."""
    lines = [f"{t},{x:.6f},{y:.6f},{n}" for t, x, y, n in rows(count=4096, decimals=decimals)]
    path = table(tmp_path / "a.csv", "t [s],x [um],y [um],n [rpm]", lines)
    run = measured_run(path, Measurement("x", y="y", time="t", speed="n"))
    assert len(run) == 4096
    spectrum = np.abs(np.fft.rfft(run["journal_x_m"] * np.hanning(4096)))
    frequency = np.fft.rfftfreq(4096, STEP_s)
    assert 20.0 * np.log10(spectrum[np.abs(frequency - 20.0) > 5.0].max() / spectrum.max()) < -80.0


def test_a_lost_sample_among_rounded_times_is_a_gap(tmp_path: Path) -> None:
    lines = [f"{t},{x:.6f},{y:.6f},{n}" for t, x, y, n in rows(decimals=4)]
    path = table(tmp_path / "a.csv", "t [s],x [um],y [um],n [rpm]", lines[:500] + lines[503:])
    with pytest.raises(InputError, match="row 501"):
        measured_run(path, Measurement("x", y="y", time="t", speed="n"))


def test_a_rate_that_is_an_interval_is_refused(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "t,x,y,n", PLAIN)
    with pytest.raises(InputError, match="Give --rate 2048"):
        measured_run(path, Measurement("x", rate=4.8828125e-4, speed_Hz=20.0))


# --- slow channels ---


def test_a_slow_speed_has_empty_cells(tmp_path: Path) -> None:
    lines = [f"{t},{x:.5f},{y:.5f},{1200 + k if k % 10 == 0 else ''}" for k, (t, x, y, _) in enumerate(rows())]
    path = table(tmp_path / "a.csv", "t [s],x [um],y [um],n [rpm]", lines)
    run = measured_run(path, Measurement("x", y="y", time="t", speed="n"))
    assert run["speed_Hz"][:990] == pytest.approx((1200.0 + np.arange(990)) / 60.0)


def test_a_slow_speed_has_times_of_its_own(tmp_path: Path) -> None:
    lines = [f"{t},{x:.5f},{y:.5f}," + (f"{k * 0.01:.3f},{1200 + k}" if k < 50 else ",")
             for k, (t, x, y, _) in enumerate(rows())]  # fmt: skip
    path = table(tmp_path / "a.csv", "t [s],x [um],y [um],t_n [s],n [rpm]", lines)
    run = measured_run(path, Measurement("x", y="y", time="t", speed="n", speed_time="t_n"))
    early = run["time_s"] < 0.48
    assert run["speed_Hz"][early] == pytest.approx((1200.0 + run["time_s"][early] / 0.01) / 60.0)


def test_a_speed_that_is_missing_for_long_is_refused(tmp_path: Path) -> None:
    lines = [f"{t},{x:.5f},{y:.5f},{'' if 300 < k < 600 else n}" for k, (t, x, y, n) in enumerate(rows())]
    path = table(tmp_path / "a.csv", "t [s],x [um],y [um],n [rpm]", lines)
    with pytest.raises(InputError, match=r'no number in row 302 .* of the column "n \[rpm\]"|no number in row 302'):
        measured_run(path, Measurement("x", y="y", time="t", speed="n"))


# --- units ---


@pytest.mark.parametrize(
    ("head", "factors"),
    [
        ("time_ms,x_mm,y_mm,speed_rpm", (1e3, 1e-3, 1.0)),
        ("t [ms],x [mil],y [mil],rpm", (1e3, 1 / 25.4, 1.0)),
        ("t sec,x micron,y micron,n [1/min]", (1.0, 1.0, 1.0)),
        ("t_s,x_um,y_um,n_Hz", (1.0, 1.0, 1 / 60.0)),
        ("t [s],x [um pp],y [um pk-pk],n [r/min]", (1.0, 1.0, 1.0)),
        ("t [s],x [um],y [um],n [cpm]", (1.0, 1.0, 1.0)),
        ("t [s],x [um],y [um],n [min-1]", (1.0, 1.0, 1.0)),
        ("t_ns,x,y,n_1/min", (1e9, 1.0, 1.0)),
        ("t_min,x,y,n_min-1", (1 / 60.0, 1.0, 1.0)),
        ("Time (days),x,y,run.rpm", (1 / 86400.0, 1.0, 1.0)),
        ("t,x,y,omega_rad_s", (1.0, 1.0, np.pi / 30.0)),
        ("t,x,y,speed_radps", (1.0, 1.0, np.pi / 30.0)),
    ],
)
def test_a_name_may_hold_its_unit(head: str, factors: tuple[float, float, float], tmp_path: Path) -> None:
    times, lengths, speeds = factors
    lines = [f"{float(t) * times:.9g},{x * lengths:.9g},{y * lengths:.9g},{n * speeds:.9g}" for t, x, y, n in rows()]
    path = table(tmp_path / "a.csv", head, lines)
    time, x, y, speed = head.split(",")
    run = measured_run(path, Measurement(x, y=y, time=time, speed=speed))
    is_the_motion(run)
    assert run["speed_Hz"] == pytest.approx(20.0)
    assert f"{speed} in Hz (no unit" not in run.remarks[0]
    assert f"{time} in s (no unit" not in run.remarks[0] or time == "t"


def test_days_without_a_unit_are_no_seconds(tmp_path: Path) -> None:
    """Times of a spreadsheet were read as a record of some microseconds."""
    lines = [f"{45050.4 + float(t) / 86400.0:.12f},{x:.5f},{n}" for t, x, _, n in rows()]
    path = table(tmp_path / "a.csv", "Time,x [um],n [rpm]", lines)
    with pytest.raises(InputError, match=r"a rotor of 20 Hz turns 0\.0001\d times. Check --time-unit"):
        measured_run(path, Measurement("x", time="Time", speed="n"))


@pytest.mark.parametrize(("given", "remedy"), [
    (Measurement("x", y="y", time="t1", speed_Hz=20.0), "Give columns that have their times in common"),
    (Measurement("x", time="t1", speed="n"), r'Give --speed-time "t3 \[s\]"'),
])  # fmt: skip
def test_a_channel_with_times_of_its_own_is_not_taken_at_others(
    given: Measurement, remedy: str, tmp_path: Path
) -> None:
    lines = [f"{t},{x:.5f},{float(t) + 0.1:.6f},{y:.5f},{2.0 * float(t):.6f},{n}" for t, x, y, n in rows()]
    path = table(tmp_path / "a.csv", "t1 [s],x [um],t2 [s],y [um],t3 [s],n [rpm]", lines)
    with pytest.raises(InputError, match=remedy):
        measured_run(path, given)
    run = measured_run(path, Measurement("x", time="t1", speed="n", speed_time="t3"))
    assert run["speed_Hz"] == pytest.approx(20.0)


def test_a_number_for_a_missing_one_is_no_displacement(tmp_path: Path) -> None:
    lines = [*PLAIN[:300], PLAIN[300].split(",")[0] + ",-9999,-9999,1200", *PLAIN[301:]]
    path = table(tmp_path / "a.csv", "t,x,y,n", lines)
    with pytest.raises(InputError, match=r"the number -9999 in row 301"):
        measured_run(path, Measurement("x", time="t", speed_Hz=20.0))


def test_the_units_that_were_taken_are_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = table(tmp_path / "a.csv", "t,x [um],y,n [rpm]", PLAIN)
    words = ["--x", "x", "--y", "y", "--time", "t", "--speed-column", "n", "--clearance", "35 um", "--json"]
    assert frb(["waterfall", str(path), *words, "-o", str(tmp_path / "a.png")]) == 0
    told = capsys.readouterr()
    assert "Units: x in um, y in um (no unit in the file; --unit changes it), t in s (no unit" in told.err
    assert "n in rpm" in told.err
    assert json.loads(told.out)["command"] == "waterfall"


def universal(path: Path, kind: int, length: float | None) -> Path:
    """A Universal File of the motion, of a data type, with the unit of length of data set 164."""
    pyuff = pytest.importorskip("pyuff")
    time = np.arange(1000) * STEP_s
    file = pyuff.UFF(str(path))
    if length is not None:
        units = {"type": 164, "units_code": 9, "units_description": "own", "temp_mode": 1, "length": length}
        file.write_sets({**units, "force": 1.0, "temp": 1.0, "temp_offset": 273.15}, "add")
    for node, every, values in ((1, 1, (length or 1.0) * AMPLITUDE_m * np.cos(2.0 * np.pi * SPEED_Hz * time)),
                                (2, 10, np.full(1000, 20.0))):  # fmt: skip
        moments = time[::every]
        one = pyuff.prepare_58(
            binary=0, id1="probe", func_type=1, rsp_node=node, rsp_dir=1, ref_node=1, ref_dir=1, x=moments,
            data=values[::every], abscissa_spacing=1, abscissa_inc=STEP_s * every, abscissa_min=0.0, z_axis_value=0.0,
            ordinate_axis_units_lab="NONE", num_pts=len(moments), ord_data_type=4, orddenom_spec_data_type=0,
            abscissa_spec_data_type=17, ordinate_spec_data_type=kind if node == 1 else 0,
        )  # fmt: skip
        file.write_sets(one, "add")
    return path


def test_a_universal_file_has_units_and_slow_channels(tmp_path: Path) -> None:
    """Displacements in mm by data type 8 and data set 164; the speed with times of its own."""
    path = universal(tmp_path / "a.uff", 8, 1000.0)
    run = measured_run(path, Measurement("1:+X", time="time", speed="2:+X"))
    assert np.ptp(run["journal_x_m"]) == pytest.approx(2.0 * AMPLITUDE_m, rel=1e-3)
    assert run["speed_Hz"] == pytest.approx(20.0)


def test_an_acceleration_of_a_universal_file_is_no_displacement(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no displacement"):
        measured_run(universal(tmp_path / "a.uff", 12, None), Measurement("1:+X", time="time", speed_Hz=20.0))


def test_an_acceleration_is_no_displacement(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "t [s],x [m/s^2],y [mm/s],n [rpm]", PLAIN)
    for name in ("x", "y"):
        with pytest.raises(InputError, match="no displacement"):
            measured_run(path, Measurement(name, time="t", speed="n"))


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [
        ("3 barg", "Pa", 'is a gauge pressure; pressures are absolute here. Write "4.01 bar"'),
        ("3 bar gauge", "Pa", 'Write "4.01 bar"'),
        ("300 kPa (g)", "Pa", 'Write "401 kPa"'),
        ("30 psig", "Pa", 'Write "44.7 psi"'),
        ("0,015 mm", "m", 'has a decimal comma. Write "0.015 mm"'),
        ("0,002", "1", 'Write "0.002"'),
        ("1,500 rpm", SPEED, 'Write "1.500 rpm" or "1500 rpm"'),
        ("150.000rpm", SPEED, "can be 150 rpm or 150000 rpm"),
    ],
)
def test_a_number_that_can_be_misread_says_what_to_write(text: str, unit: str, said: str) -> None:
    with pytest.raises(ValueFault) as caught:
        quantity(text, unit)
    assert said in str(caught.value)


# --- heads of other instruments, written here ---

DEWESOFT = (
    "File name:\tC:\\data\\run1.dxd\nSample rate:\t2048 Hz\nEvents:\n\n"
    "\tX probe (um)\tY probe (um)\tSpeed (rpm)\nTime (s)\tACT\tACT\tACT"
)
CATMAN = (
    "HBM_CATMAN_DATAFILE_40\n\nT0 = 04.05.2023 09:51:39\nTime  1 - default sample rate\tX probe\tY probe\tn\n"
    "s\tµm\tµm\tU/min\n2048 Hz\t2048 Hz\t2048 Hz\t2048 Hz"
)
LVM = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\t\n\t\n"
    "Channels\t2\t\nSamples\t1000\t1000\nY_Unit_Label\tum\tum\nDelta_X\t4.8828125E-4\t4.8828125E-4\n***End_of_Header***\t\t\n"
    "X_Value\tX probe\tY probe\tComment"
)
SIGLENT = (
    "Record Length,Analog:1000\nSample Interval,0.00048828125\nVertical Units,V,V\nHorizontal Units,S\nSource,CH1,CH2\n"
    "Second,Value,Value"
)
BENTLY = 'Machine,"Turbine, A"\n"Timestamp","X (mil pp)","Y (mil pp)","Speed (RPM)"'
PROSIG = "DATS\nSampling rate: 2048\n\n,Ch 1,Ch 2,Ch 3\nUnits,um,um,rpm"
GERMAN = "Zeit;Weg x;Weg y;Drehzahl\ns;µm;µm;1/min\n;;;"


@pytest.mark.parametrize(
    ("suffix", "head", "row", "given"),
    [
        ("txt", DEWESOFT, "{t:.7f}\t{x:.5f}\t{y:.5f}\t1200",
         Measurement("X probe", y="Y probe", time="Time", speed="Speed")),
        ("asc", CATMAN, "{t:.7f}\t{x:.5f}\t{y:.5f}\t1200",
         Measurement("X probe", y="Y probe", time="Time  1 - default sample rate", speed="n")),
        ("lvm", LVM, "\t{x:.6f}\t{y:.6f}", Measurement("X probe", y="Y probe", speed_Hz=20.0)),
        ("csv", SIGLENT, "{t:.9f},{v:.7f},{w:.7f}",
         Measurement("CH1", y="CH2", time="Second", speed_Hz=20.0, unit_m=125e-6)),
        ("csv", BENTLY, '"5/4/2023 9:51:39.{ticks:07d} AM",{mx:.6f},{my:.6f},1200',
         Measurement("X", y="Y", time="Timestamp", speed="Speed")),
        ("csv", PROSIG, "{t:.7f},{x:.5f},{y:.5f},1200", Measurement("Ch 1", y="Ch 2", rate=2048.0, speed="Ch 3")),
        ("csv", GERMAN, "{t:.7f};{x:.5f};{y:.5f};1200", Measurement("Weg x", y="Weg y", time="Zeit", speed="Drehzahl")),
        ("csv", "", "{k},{x:.5f},{y:.5f},0.1", Measurement("2", y="3", rate=2048.0, speed_Hz=20.0)),
    ],
    ids=["dewesoft", "catman", "lvm", "siglent", "bently", "prosig", "german", "no head"],
)  # fmt: skip
def test_a_head_of_another_instrument(suffix: str, head: str, row: str, given: Measurement, tmp_path: Path) -> None:
    lines = []
    for k, (text, x, y, _) in enumerate(rows()):
        t = float(text)
        lines.append(
            row.format(k=k, t=t, x=x, y=y, v=x / 125, w=y / 125, mx=x / 25.4, my=y / 25.4, ticks=round(1e7 * t))
        )
    is_the_motion(measured_run(table(tmp_path / f"a.{suffix}", head, lines), given))
