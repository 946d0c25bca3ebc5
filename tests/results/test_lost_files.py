"""Files that cannot be written: what is refused before the work, and what stays of it."""

import json
import os
from pathlib import Path

import pytest
from commands import Frb
from output_options import MODELS, SETTINGS, SHORT

from frbcli.case.reading.load import load_case
from frbcli.cli.progress import Display
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.results.store import Run, read_run
from frbcli.runs.march import March
from frbcli.runs.run import runup

QUICK = ["jeffcott", *SHORT]


@pytest.fixture(autouse=True)
def in_a_directory_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def without_progress(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside other work commands announce how long they will take yet; what they say of files is the same."""
    monkeypatch.setattr(Display, "line", lambda *_: None)


WAYS = {
    "runup": (["runup", *QUICK], "run.h5", "run-summary.png"),
    "rundown": (["rundown", *QUICK], "run.h5", "run-summary.png"),
    "compare": (["compare", *QUICK, *MODELS], "a.png", "a.png"),
    "stability": (["stability", *QUICK], "a.png", "a.png"),
    "accuracy": (["accuracy", "jeffcott", "--until", "10 ms"], "a.png", "a.png"),
    "rotation": (["rotation", "bearing-axial-groove"], "a.png", "a.png"),
    "law": (["plot", "jeffcott", "--what", "law"], "a.png", "a.png"),
    "waterfall": (["waterfall", "whole.h5"], "a.png", "a.png"),
    "plot": (["plot", "whole.h5"], "a.png", "a.png"),
    "export": (["export", "whole.h5"], "a.csv", "a.csv"),
    "sweep": (["sweep", *QUICK, "--set", "rotor.unbalance=1 g*mm,2 g*mm"], "study", "study/sweep.png"),
    "table": (["sweep", *QUICK, "--set", "rotor.unbalance=1 g*mm,2 g*mm"], "study", "study/sweep.csv"),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A run file."""
    return runup(load_case("jeffcott", SETTINGS), tmp_path_factory.mktemp("whole") / "run.h5").path.read_bytes()


@pytest.fixture
def nothing_runs(whole: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """To compute anything from now on is a failure; there is a run in whole.h5."""
    Path("whole.h5").write_bytes(whole)

    def fail(*_: object) -> None:
        raise AssertionError("computed")

    monkeypatch.setattr(March, "__init__", fail)
    monkeypatch.setattr(StaticMachines, "__init__", fail)
    monkeypatch.setattr("frbcli.bearing_tests.kinematic._test", fail)


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("way", WAYS)
def test_a_place_that_is_a_directory_is_refused_before_the_work(way: str, frb: Frb) -> None:
    words, output, place = WAYS[way]
    Path(place).mkdir(parents=True)
    assert "is not a file" in frb(*words, "-o", output, code=2).err


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("way", [way for way in WAYS if "sweep" not in WAYS[way][0]])
def test_a_name_that_is_too_long_is_refused_before_the_work(way: str, frb: Frb) -> None:
    words, output, _ = WAYS[way]
    assert "File name too long" in frb(*words, "-o", f"{'n' * 252}{Path(output).suffix}", code=2).err
    assert os.listdir() == ["whole.h5"]


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("length", [251, 247])  # with .part, with -summary.png in place of .h5
def test_what_is_put_behind_the_name_of_a_run_counts(length: int, frb: Frb) -> None:
    assert "File name too long" in frb("runup", *QUICK, "-o", f"{'n' * (length - 3)}.h5", code=2).err
    assert os.listdir() == ["whole.h5"]


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("content", [None, "of the user"])
def test_what_is_in_place_of_the_lock_of_a_run_is_named(content: str | None, frb: Frb) -> None:
    lock = Path("run.h5.lock")
    lock.mkdir() if content is None else lock.write_text(content)
    for words in (["runup", *QUICK, "-o", "run.h5"], ["rundown", *QUICK, "-o", "run.h5", "--no-picture"]):
        assert "run.h5.lock" in frb(*words, code=2).err
    assert lock.is_dir() if content is None else lock.read_text() == content


FULL = Path("/dev/full")


@pytest.mark.usefixtures("without_progress")
@pytest.mark.parametrize("way", ["runup", "stability", "sweep"])
def test_a_picture_that_the_disk_does_not_take_is_a_remark(way: str, frb: Frb) -> None:
    words, output, place = WAYS[way]
    Path(place).parent.mkdir(exist_ok=True)
    Path(place).symlink_to(FULL)
    options = {"sweep": ["--stability", "--jobs", "1"], "stability": ["--speed", "30 Hz"],
               "accuracy": ["--theory", "short"],
               "rotation": ["--set", "accuracy.mesh=[4, 16]", "--cavitation", "half-sommerfeld"]}  # fmt: skip
    said = frb(*words, "-o", output, *options.get(way, []))
    remarks = [line for line in said.err.splitlines() if not line.startswith(("1/2", "2/2"))]
    assert remarks == [
        f"No picture {place}: cannot be written: No space left on device. Choose another place with -o."
    ]
    assert said.out != ""


@pytest.mark.parametrize(
    "words", [["waterfall", "run.h5", "--window", "10 ms"], ["plot", "run.h5"], ["report", "run.h5"]], ids=" ".join
)
def test_a_file_that_a_command_is_for_is_an_error(words: list[str], frb: Frb) -> None:
    runup(load_case("jeffcott", SETTINGS), "run.h5")
    place = Path("a.html" if words[0] == "report" else "a.png")
    place.symlink_to(FULL)
    assert "No space left on device" in frb(*words, "-o", str(place), code=2).err
    assert place.is_symlink()


@pytest.mark.usefixtures("without_progress")
def test_a_picture_that_cannot_be_drawn_leaves_run_document_and_code(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    def broken(_: Run) -> None:
        raise RuntimeError("no font\nat all")

    monkeypatch.setattr("frbcli.plot.summary.summary_figure", broken)
    said = frb("runup", *QUICK, "-o", "run.h5", "--json")
    assert json.loads(said.out)["status"] == "finished"
    assert said.err.endswith("No picture run-summary.png: RuntimeError: no font at all\n")
    assert read_run("run.h5").status == "finished"


def test_an_older_picture_stays_where_a_new_one_cannot_be_drawn(monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    runup(load_case("jeffcott", SETTINGS), "run.h5")
    Path("run-summary.png").write_text("older")

    def broken(*_: object, **__: object) -> None:
        raise ValueError("no")

    monkeypatch.setattr(FigureCanvasAgg, "print_png", broken)
    frb("plot", "run.h5", "--what", "summary", code=2)
    assert Path("run-summary.png").read_text() == "older"


@pytest.mark.usefixtures("without_progress")
@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_letters_that_a_font_lacks_are_one_remark(suffix: str, frb: Frb) -> None:
    words = ["stability", *QUICK, "--speed", "30 Hz", "--set", "title=漢字 漢", "-o", f"a{suffix}"]
    said = frb(*words)
    assert f"Campbell diagram: a{suffix}" in said.out
    expected = "" if suffix == ".svg" else f"a{suffix}: the font has no 漢, 字; boxes are drawn instead.\n"
    assert said.err in (expected, f"a{suffix}: the font has no 漢, 字; boxes are drawn instead.\n")
