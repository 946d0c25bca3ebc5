"""Docstrings of public functions: sections of numpydoc that name every parameter, with examples that run. Those that
need files or take long run in a folder with a run and a measurement; their results are not compared."""

import doctest
import inspect
import re
from pathlib import Path

import pytest

import frbcli

FUNCTIONS = sorted(name for name in frbcli.__all__ if inspect.isfunction(getattr(frbcli, name)))
ORDER = ["Parameters", "Returns", "Raises", "Notes", "References", "Examples"]


def sections(name: str) -> dict[str, str]:
    """The sections of a docstring by their titles; the summary is that of the empty title."""
    parts = re.split(r"^(\w+)\n-{3,}\n", inspect.cleandoc(getattr(frbcli, name).__doc__ or ""), flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def named(section: str) -> list[str]:
    """The parameters of a section: what stands before the colons of the lines that are not indented."""
    lines = [line for line in section.splitlines() if line and not line.startswith(" ")]
    assert all(" : " in line for line in lines), lines
    return [name.strip() for line in lines for name in line.partition(" : ")[0].split(",")]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_docstring_has_its_sections(name: str) -> None:
    found = sections(name)
    summary = found.pop("").strip()
    assert summary.endswith(".")
    assert "\n" not in summary.partition("\n\n")[0]
    assert list(found) == [title for title in ORDER if title in found]
    signature = inspect.signature(getattr(frbcli, name))
    assert sorted(named(found.get("Parameters", ""))) == sorted(signature.parameters)
    assert ("Returns" in found) == (signature.return_annotation not in (None, "None"))
    assert ">>> " in found["Examples"]


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if "# doctest: +SKIP" not in sections(name)["Examples"]])
def test_an_example_says_what_it_gives(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.chdir(str(tmp_path))
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(frbcli, name), name, globs={})
    told: list[str] = []
    result = doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert result.failed == 0, "".join(told)
    assert result.attempted > 0


OWN = {"add_law", "remove_law", "add_force_law", "remove_force_law"}  # of models that the reader has written
POWER = ('output.signals=["power"]',)
QUICK = {"measured_run", "read_run", "find_events", "order_track", "write_report", "against_measured", "damped_modes",
         "draw_eccentricity", "draw_orbit", "draw_waterfall", "draw_spectrum"}  # fmt: skip
LONG = [name for name in FUNCTIONS if "# doctest: +SKIP" in sections(name)["Examples"] and name not in OWN]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """run.h5 of a Jeffcott rotor with the loss of its film, and measured.csv with its motion in um."""
    place = tmp_path_factory.mktemp("examples")
    case = frbcli.load_case("jeffcott", ["film.theory=short", "speed.to=60 Hz", "speed.duration=2.5 s", *POWER])
    run = frbcli.runup(case, place / "run.h5")
    motion = zip(run["time_s"], 1e6 * run["journal_x_m"], 1e6 * run["journal_y_m"], run["speed_Hz"], strict=True)
    rows = [f"{t:.9g},{x:.9g},{y:.9g},{n:.9g}" for t, x, y, n in motion]
    (place / "measured.csv").write_text("\n".join(["t,x,y,n", *rows]), encoding="utf-8")
    return place


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.nightly) for name in LONG]
)
def test_an_example_runs(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(frbcli, name), name, globs={"case": None})
    for line in example.examples:
        line.options.pop(doctest.SKIP, None)
        if not line.source.startswith("import "):
            line.want = ""
    runner = doctest.DocTestRunner(checker=_Any(), verbose=False)
    told: list[str] = []
    result = runner.run(example, out=told.append)
    assert result.failed == 0, "".join(told)


class _Any(doctest.OutputChecker):
    """Takes any output: an example fails when it raises."""

    def check_output(self, want: str, got: str, optionflags: int) -> bool:  # noqa: ARG002
        return True
