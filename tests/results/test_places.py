"""Where results are written: they replace nothing but earlier results of their kind, and either whole or not at all."""

import csv
import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commands import Frb
from output_options import CALLS, CASE, RUN, SETTINGS, SHORT, TABLE, Option, other_paths, output_options
from paths import ROOT
from synthetic_run import Rotor, parser_error, signals

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import find_shipped
from frbcli.cli.main import COMMANDS, run
from frbcli.cli.options import here
from frbcli.errors import InputError
from frbcli.plot.moving import animate_orbits
from frbcli.results.container import locked
from frbcli.results.store import Header, Run, RunWriter, read_run
from frbcli.results.write import PAGE, TABLES, has_checksum, mark_table, write, written
from frbcli.runs.march import March
from frbcli.runs.run import rundown, runup

OPTIONS = output_options()


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with a case, a run of it, a measurement and a list of points."""
    folder = tmp_path_factory.mktemp("files")
    (folder / CASE).write_text(find_shipped("jeffcott"))
    (folder / "bearing.toml").write_text(find_shipped("bearing"))
    (folder / TABLE).write_text("t,x\n0,1\n1,2\n")
    (folder / "points.csv").write_text("rotor.unbalance\n1 g*mm\n2 g*mm\n")
    runup(load_case(folder / CASE, SETTINGS), folder / RUN)
    return folder


@pytest.fixture(autouse=True)
def _inside(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The working directory is a copy of these files."""
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def nothing_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """To compute anything is a failure."""

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("computed")

    monkeypatch.setattr(March, "__init__", fail)
    for place in ("linear.stability.stability", "linear.sheets.bearing.bearing_sheet", "linear.response.response",
                  "cycles.limit_cycles.limit_cycles", "studies.fit.fit", "studies.accuracy.accuracy",
                  "studies.sweep.sweep", "bearing_tests.kinematic._test"):  # fmt: skip
        monkeypatch.setattr(f"frbcli.{place}", fail)


# --- what is replaced ---


def test_every_path_of_a_command_is_read_or_written() -> None:
    assert other_paths() == []
    assert {option.command for option in OPTIONS} == set(CALLS)
    assert set(COMMANDS) - set(CALLS) == {"check", "docs", "schema", "warm-up"}  # write nothing
    assert len(OPTIONS) >= 24


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("option", [o for o in OPTIONS if not o.folder], ids=lambda o: f"{o.command} {o.name}")
def test_no_result_replaces_a_case_a_run_or_a_measurement(option: Option, frb: Frb) -> None:
    before = {name: Path(name).read_bytes() for name in (CASE, RUN, TABLE)}
    suffix = option.suffix or (".csv" if option.command == "export" else ".png")
    Path(f"run{suffix}").symlink_to(RUN)
    os.link(CASE, f"case{suffix}")
    for target in (CASE, TABLE, f"run{suffix}", f"case{suffix}"):
        wrong = "has to end|does not end|is not" if Path(target).suffix != suffix else "is not|is read by"
        if option.command in ("runup", "rundown") and target.startswith("run"):
            continue  # replaces runs, see below
        assert re.search(wrong, frb(*CALLS[option.command], option.name, target, code=2).err)
        assert {name: Path(name).read_bytes() for name in before} == before
    assert Path(f"run{suffix}").is_symlink()


def test_a_directory_of_results_is_made_of_no_file(frb: Frb) -> None:
    folders = [option for option in OPTIONS if option.folder]
    assert folders
    for option in folders:
        for target in (CASE, RUN, "points.csv"):
            before = Path(target).read_bytes()
            frb(*CALLS[option.command], option.name, target, code=2)
            assert Path(target).read_bytes() == before


def test_a_list_in_place_of_the_table_of_its_sweep_is_kept(frb: Frb) -> None:
    Path("study").mkdir()
    text = "point,rotor.unbalance,status\n,1 g*mm,\n"
    Path("study/sweep.csv").write_text(text)
    said = frb("sweep", CASE, "--list", "study/sweep.csv", "--stability", "-o", "study", code=2)
    assert "is read by this command" in said.err
    assert Path("study/sweep.csv").read_text() == text


def test_two_results_have_two_places(frb: Frb) -> None:
    Path("a.png").symlink_to("b.csv")
    assert "two results" in frb(*CALLS["bearing"], "--csv", "b.csv", "-o", "a.png", code=2).err


def test_a_report_and_a_table_replace_their_like_and_nothing_else(frb: Frb) -> None:
    for words, name, other in ((["report", RUN], "a.html", "notes"), (["export", RUN], "a.csv", "t;x\n1;2\n")):
        for _ in range(2):
            frb(*words, "-o", name, "--quiet")
        assert not Path(name).read_bytes().startswith(other.encode())
        Path(name).write_text("")
        frb(*words, "-o", name, "--quiet")
        Path(name).write_text(other)
        frb(*words, "-o", name, "--quiet", code=2)
        assert Path(name).read_text() == other


FOREIGN = {  # files of others of the kinds that frb writes, and the words that would write there
    "a.csv": (["export", RUN, "-o", "a.csv"], b"time_s,speed_Hz\n0.0,1.0\n0.1,1.5\n"),
    "b.csv": ([*CALLS["stability"], "--no-picture", "--csv", "b.csv"], b"bearing,speed_Hz,\nmine,1.5,\n"),
    "a.mat": (["export", RUN, "--format", "mat", "-o", "a.mat"], b"MATLAB 5.0 MAT-file, Platform: mine" + bytes(500)),
    "a.parquet": (["export", RUN, "--format", "parquet", "-o", "a.parquet"], b"PAR1" + bytes(500) + b"PAR1"),
    "a.html": (["report", RUN, "-o", "a.html"], b"<!DOCTYPE html>\n<title>mine</title>\n"),
    "a.png": (["plot", RUN, "-o", "a.png"], b"\x89PNG\r\n\x1a\n" + bytes(500)),
    "a.pdf": (["plot", RUN, "-o", "a.pdf"], b"%PDF-1.4\n" + bytes(500)),
    "a.svg": (["plot", RUN, "-o", "a.svg"], b"<?xml version='1.0'?>\n<svg/>"),
    "a.gif": (["plot", RUN, "--animate", "--what", "orbit", "--from", "0.09", "-o", "a.gif"], b"GIF89a" + bytes(500)),
    "a.toml": ([*CALLS["bearing"], "--no-picture", "--ross", "a.toml"], b'["BearingElement_a"]\nn = 0\n'),
    "whole-summary.png": (["runup", CASE, *SHORT, "-o", RUN], b"\x89PNG\r\n\x1a\n" + bytes(500)),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_that_frb_did_not_write_is_replaced_by_force_alone(
    name: str, frb: Frb, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("frbcli.plot.moving.FRAMES", 2)
    words, other = FOREIGN[name]
    if name.endswith(".parquet"):
        pytest.importorskip("pyarrow")
    Path(name).write_bytes(other)
    assert "--force" in frb(*words, code=2).err
    assert Path(name).read_bytes() == other
    frb(*words, "--force")
    written_first = Path(name).read_bytes()
    assert written_first != other
    frb(*words)  # it is frb's own now
    Path(name).write_bytes(written_first[:-20])
    if name.endswith(".csv"):
        frb(*words, code=2)  # and somebody's own again once it was changed


def test_force_replaces_nothing_that_the_command_reads(frb: Frb) -> None:
    before = Path(CASE).read_bytes(), Path(RUN).read_bytes()
    frb(*CALLS["bearing"], "--no-picture", "--csv", CASE, "--force", code=2)
    frb("export", RUN, "-o", RUN, "--force", code=2)
    frb("report", RUN, "-o", RUN, "--force", code=2)
    assert (Path(CASE).read_bytes(), Path(RUN).read_bytes()) == before
    frb("runup", CASE, *SHORT, "-o", CASE, "--force", "--no-picture", code=2)
    frb("runup", CASE, *SHORT, "-o", TABLE, "--force", "--no-picture", code=2)  # runs replace runs alone


def test_a_case_is_written_to_a_new_file_or_by_force(frb: Frb) -> None:
    frb("cases", "rigid", "-o", "notes.toml")
    frb("cases", "jeffcott", "-o", "notes.toml", code=2)
    assert Path("notes.toml").read_text() == find_shipped("rigid")
    frb("cases", "jeffcott", "-o", "notes.toml", "--force")
    assert Path("notes.toml").read_text() == find_shipped("jeffcott")


def test_the_checksum_of_a_table_is_in_no_number(frb: Frb) -> None:
    """All readers see the columns and numbers of a plain table, to the last bit where they read all digits."""
    run = read_run(RUN)
    frb("export", RUN, "-o", "a.csv")
    text = Path("a.csv").read_text()
    assert text.splitlines()[0] == ",".join(run.signals)
    columns = np.stack([signal.values for signal in run.signals.values()], axis=1)
    assert np.array_equal(np.loadtxt("a.csv", delimiter=",", skiprows=1), columns)
    assert np.array_equal(np.genfromtxt("a.csv", delimiter=",", names=True)["time_s"], columns[:, 0])
    with Path("a.csv").open(newline="") as file:
        assert [float(value) for value in list(csv.DictReader(file))[-1].values()] == columns[-1].tolist()
    table = pd.read_csv("a.csv")
    assert list(table) == list(run.signals)
    assert all(kind.kind == "f" for kind in table.dtypes)
    assert np.allclose(table, columns, rtol=max(1e-15, 2.0 * parser_error()), atol=0.0)


LAST_LINES = "0.0,1.5\n", "-2.5e-07,1.0\n", "a,-1e-300,3.25,\n", '"a,1.5,b",2.5\n', '"a,1.5\n', "1.5\n", "9.5,0.0\r\n"


@pytest.mark.parametrize("line", LAST_LINES)
def test_a_table_with_a_number_in_its_last_line_is_told_by_its_checksum(line: str) -> None:
    text = f"x,y\n0.0,0.0\n{line}"
    Path("t.csv").write_text(text, newline="")
    assert not has_checksum(Path("t.csv"))
    mark_table(Path("t.csv"))
    if line.count('"') == 1:  # in quotes a number is a text
        assert Path("t.csv").read_bytes() == text.encode()
        return
    marked = Path("t.csv").read_bytes()
    assert has_checksum(Path("t.csv"))
    fields, before = (list(csv.reader(csv_text.splitlines()))[-1] for csv_text in (marked.decode(), text))
    for field, was in zip(fields, before, strict=True):
        assert field == was or float(field) == float(was)
    for changed in (marked.replace(b"x,y", b"x,z"), marked + b"\n", marked[:-1], b"# mine\n" + marked):
        Path("t.csv").write_bytes(changed)
        assert not has_checksum(Path("t.csv"))


def test_a_link_stays_one_and_what_it_names_is_replaced(frb: Frb) -> None:
    Path("there").mkdir()
    Path("a.csv").symlink_to("there/b.csv")
    Path("there/b.csv").write_text("")
    Path("there/b.csv").chmod(0o640)
    frb("export", RUN, "-o", "a.csv", "--quiet")
    assert Path("a.csv").is_symlink()
    assert Path("there/b.csv").read_text().startswith("time_s")
    assert Path("there/b.csv").stat().st_mode & 0o777 == 0o640
    assert os.listdir("there") == ["b.csv"]


def test_a_pipe_takes_a_table_if_somebody_reads_it(frb: Frb) -> None:
    os.mkfifo("pipe")
    assert "nobody reads this pipe" in frb("export", RUN, "-o", "pipe", code=2).err
    frb("export", RUN, "-o", "a.csv")
    with Path("read").open("wb") as out, subprocess.Popen(["cat", "pipe"], stdout=out) as reader:
        while run(["export", RUN, "-o", "pipe"]) == 2:  # until it has opened it
            pass
        reader.wait(timeout=60.0)
    assert Path("read").read_bytes() == Path("a.csv").read_bytes()
    assert Path("pipe").is_fifo()


# --- runs ---


def test_a_run_is_replaced_by_force_alone(frb: Frb) -> None:
    before = Path(RUN).read_bytes()
    other = load_case(CASE, (*SETTINGS, "oil.viscosity=13 mPa*s"))
    same = load_case(CASE, SETTINGS)
    for again, case in ((runup, other), (rundown, same)):
        with pytest.raises(InputError, match=r"another case.*--force"):
            again(case, RUN)
    with pytest.raises(InputError, match="another case"):
        frb_compare(other)
    assert "holds this run already" in frb("runup", CASE, *SHORT, "-o", RUN, "--no-picture").err
    assert Path(RUN).read_bytes() == before
    assert runup(other, RUN, force=True).status == "finished"
    assert Path(RUN).read_bytes() != before
    Path(RUN).write_bytes(before[:-1])
    with pytest.raises(InputError, match=r"cut short.*--force"):
        runup(other, RUN)
    assert Path(RUN).read_bytes() == before[:-1]


def frb_compare(case: object) -> None:
    """A comparison that keeps its runs where another one did."""
    from frbcli.studies.compare import compare

    Path("kept").mkdir()
    shutil.copy(RUN, "kept/half-sommerfeld-short.h5")
    compare(case, ["half-sommerfeld", "sommerfeld"], keep="kept")  # type: ignore[arg-type]


HOLDS = "import sys, time; from pathlib import Path; from frbcli.results.container import locked\n" + (
    "with locked(Path(sys.argv[1])):\n    print('held', flush=True); time.sleep(60.0)"
)


@contextmanager
def held(path: str) -> Iterator[subprocess.Popen[str]]:
    """A process that writes at a path."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-c", HOLDS, path]
    with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as it:
        assert it.stdout is not None
        assert it.stdout.readline() == "held\n"
        yield it
        it.kill()


@pytest.mark.parametrize("link", [False, True])
def test_a_second_run_is_refused_at_its_start(link: bool, frb: Frb) -> None:
    if link:
        Path("link.h5").symlink_to(Path.cwd() / "a.h5")
    words = ["runup", CASE, *SHORT, "-o", "link.h5" if link else "a.h5", "--no-picture"]
    with held("a.h5") as first:
        assert f"is being written by process {first.pid}." in frb(*words, code=2).err
        frb(*words, "--force", code=2)
        assert not Path("a.h5").exists()
        Path("a.h5.0123abcd.part").write_text("of the other one")
    Path("b.h5.0123abcd.part").write_text("of nobody")
    assert Path("a.h5.lock").exists()  # it was killed
    frb(*words)
    assert sorted(path.name for path in Path().glob("?.h5*")) == ["a.h5", "b.h5.0123abcd.part"]


def test_a_run_within_itself_is_refused() -> None:
    case, said = load_case(CASE, SETTINGS), list[str]()

    def again(_: object) -> None:
        with pytest.raises(InputError) as caught:
            runup(case, "a.h5", force=True)
        said.append(str(caught.value))

    assert runup(case, "a.h5", observe=again).status == "finished"
    assert f"process {os.getpid()}" in said[0]
    assert not Path("a.h5.lock").exists()


def test_a_run_on_a_full_disk_leaves_no_lock(frb: Frb) -> None:
    there = sorted(os.listdir())
    with full_at(0):
        said = frb("runup", CASE, *SHORT, "-o", "a.h5", "--no-picture", code=2)
    assert "a.h5\n  output: cannot be written: File too large." in said.err
    assert sorted(os.listdir()) == there


def test_a_second_sweep_is_refused_at_its_start(frb: Frb) -> None:
    Path("study").mkdir()
    with held("study/sweep.jsonl") as first:
        assert f"is being written by process {first.pid}." in frb(*CALLS["sweep"], "-o", "study", code=2).err


def test_two_writers_leave_a_whole_file() -> None:
    Path("there").mkdir()
    path = Path("there/a.csv")
    with written(path, TABLES["csv"]) as first, written(path, TABLES["csv"]) as second:
        assert first != second
        first.write_text("film,1\n" * 1000)
        second.write_text("film,2\n")
    assert path.read_text() == "film,1\n" * 1000
    assert os.listdir("there") == ["a.csv"]


# --- whole or not at all ---


@contextmanager
def full_at(size: int) -> Iterator[None]:
    """As a disk that becomes full: no file of the process may have more bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


WRITING = {
    "export": ["export", RUN, "-o", "a.csv"],
    "mat": ["export", RUN, "-o", "a.mat", "--format", "mat"],
    "report": ["report", RUN, "-o", "a.html"],
    "plot": ["plot", RUN, "-o", "a.png"],
    "bearing": [*CALLS["bearing"], "--no-picture", "--csv", "a.csv"],
    "ross": [*CALLS["bearing"], "--no-picture", "--ross", "a.toml"],
    "cases": ["cases", "jeffcott", "-o", "a.toml"],
}


@pytest.mark.parametrize("way", WRITING)
def test_a_full_disk_leaves_what_was_there(way: str, frb: Frb) -> None:
    words = [*WRITING[way], "--quiet"]
    target = next(word for word in words if word.startswith("a."))
    if way != "cases":
        frb(*words)
    before = Path(target).read_bytes() if Path(target).exists() else None
    there = sorted(os.listdir())
    with full_at(100):
        said = frb(*words, code=2)
    assert f"file {target}\n  output: cannot be written: File too large." in said.err
    assert (Path(target).read_bytes() if Path(target).exists() else None) == before
    assert sorted(os.listdir()) == there


def test_an_animation_on_a_full_disk_leaves_nothing() -> None:
    run, there = read_run(RUN), sorted(os.listdir())
    animate_orbits(run, "a.gif", frames=2)
    before = Path("a.gif").read_bytes()
    with full_at(100), pytest.raises(InputError, match="File too large"):
        animate_orbits(run, "a.gif", frames=2)
    assert Path("a.gif").read_bytes() == before
    assert sorted(os.listdir()) == sorted(["a.gif", *there])


def test_an_interrupted_export_leaves_the_whole_table(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    frb("export", RUN, "-o", "a.csv")
    before, there, rows = Path("a.csv").read_bytes(), sorted(os.listdir()), [0]
    to_csv = pd.DataFrame.to_csv

    def ending(table: pd.DataFrame, *arguments: object, **options: object) -> object:
        rows[0] += 1
        if rows[0] > 2:
            raise KeyboardInterrupt
        return to_csv(table, *arguments, **options)

    monkeypatch.setattr("frbcli.results.export.LINES", 300)
    monkeypatch.setattr(pd.DataFrame, "to_csv", ending)
    frb("export", RUN, "-o", "a.csv", code=130)
    assert (Path("a.csv").read_bytes(), sorted(os.listdir())) == (before, there)


# --- names and texts of others ---


@pytest.mark.parametrize("name", ["../../x", "-x", ".x", "/x", "..", "", "x y"])
def test_the_name_of_a_case_makes_no_hidden_file_and_no_option(name: str) -> None:
    path = here(name, ".h5")
    assert path.parent == Path()
    assert path.name[0] not in ".-"


def test_a_case_with_the_name_of_another_directory_writes_here(frb: Frb) -> None:
    frb("plot", "jeffcott", "--what", "law", "--set", "name=../../x", "--quiet")
    assert Path("x-law.png").is_file()


def test_the_table_of_a_sweep_has_no_formula_of_its_list() -> None:
    Path("points.csv").write_text("title\n\"=cmd|' /C calc'!A0\"\n\x1b[31mred\n")
    words = ["sweep", CASE, *SHORT, "--list", "points.csv", "--stability", "--jobs", "1", "-o", "study", "--quiet"]
    assert run(words) in (0, 3)
    table = Path("study/sweep.csv").read_text()
    rows = list(csv.DictReader(table.splitlines()))
    assert [row["title"][:2] for row in rows] == ["'=", "?["]
    assert table.isprintable() or "\x1b" not in table


def test_a_process_for_each_of_a_million_is_refused(tmp_path: Path, frb: Frb) -> None:
    words = ["sweep", "jeffcott", "--set", "rotor.unbalance=1 g*mm,2 g*mm", "-o", str(tmp_path / "s")]
    said = frb(*words, "--jobs", "1000000", code=2)
    assert "--jobs = 1000000: are more processes than this machine can run" in said.err
    assert not (tmp_path / "s").exists()


@pytest.mark.parametrize(("end", "status"), [(1e-9, 0), (1e-30, 2), (1e-200, 2), (1e-300, 2)])
def test_a_run_of_no_time_at_all_has_a_page_or_is_refused(end: float, status: int, tmp_path: Path, frb: Frb) -> None:
    made = signals(Rotor(duration_s=0.2))
    made["time_s"] = np.linspace(0.0, end, len(made["time_s"]))
    units = {name: "s" if name == "time_s" else "Hz" if name.endswith("_Hz") else "m" if name.endswith("_m") else ""
             for name in made}  # fmt: skip
    writer = RunWriter(tmp_path / "run.h5", Header("t", "runup", "c", "", units, references={"clearance_m": 35e-6}))
    writer.append(made)
    finished: Run = writer.finish("finished", {}, {}, [])
    said = frb("report", str(finished.path), code=status)
    if status:  # steps below 1e-15 s are those of no machine
        assert "time_s has a wrong form" in said.err
        return
    assert len(read_run(finished.path)) == len(made["time_s"])
    assert said.err == ""
    assert PAGE.holds(tmp_path / "run-report.html")


def test_locks_of_a_file_system_without_them_stop_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("there").mkdir()

    def unknown(_: int) -> None:
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr("frbcli.results.container._lock", unknown)
    with locked(Path("there/a.h5")):
        write(Path("there/a.html"), PAGE, "<!doctype html>")
    assert os.listdir("there") == ["a.html"]
