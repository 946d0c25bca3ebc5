"""Examples that need files or take long: each is run in a folder with a run and a measurement. Their results are not
compared, for they are those of a run of a moment."""

import doctest
from pathlib import Path

import pytest
from test_docstrings import FUNCTIONS, sections

import frbcli

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
