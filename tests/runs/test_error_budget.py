"""The errors that a run states, by their parts, and what its second, coarser run says of its events."""

import json
import re
import tracemalloc
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from commands import Frb
from marches import planned_system

from frbcli.analysis.uncertainty import partners
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.results.store import Run, read_run
from frbcli.runs import march, second_run
from frbcli.runs.error_budget import FewerCells, FilmErrors, grows_from, summed
from frbcli.runs.march import March
from frbcli.runs.run import run_cost, runup
from frbcli.runs.second_run import about_certainty, grows_late, on_fewer_cells
from frbcli.scene.cost import expected_cost
from frbcli.scene.machine.system import make_segments
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import cost_of_run, is_cheap, make_plan, second_run_s
from frbcli.solve.state import ERROR_LARGEST, ERROR_SPANS, NUMBERS, RUN_END, RUNNING, TIME
from frbcli.solve.step import ERROR_MEMORY, book_error
from frbcli.studies.accuracy import difference, verify

SHORT_RUN = ("speed.duration=0.3 s", "speed.to=30 Hz", "output.step=1e-3 s")


def test_sums_of_local_errors_by_spans_of_the_run() -> None:
    """A burst of steps of error 1e-6 every 1e-3 s for 0.2 s: 200 of them, and at most what 0.1 s of memory holds."""
    numbers, errors = np.zeros(NUMBERS), np.zeros((2, ERROR_SPANS))
    numbers[RUN_END] = 1.0
    for t in np.arange(1, 1000) * 1e-3:
        numbers[TIME] = t
        book_error(numbers, errors, 1e-3, 1e-6 if t <= 0.2 else 0.0)
    largest, whole = summed(errors, 1.0)
    assert whole == pytest.approx(200e-6, rel=0.01)
    assert largest == pytest.approx(1e-6 * ERROR_MEMORY / 1e-3 * (1.0 - np.exp(-2.0)), rel=0.02)
    assert largest == numbers[ERROR_LARGEST]
    assert summed(errors, 0.1)[1] == pytest.approx(100e-6, rel=0.05)
    assert summed(errors, 0.05)[0] < 0.5 * largest
    assert summed(np.zeros((2, ERROR_SPANS)), 0.0) == (0.0, 0.0)


def test_the_stated_error_does_not_depend_on_when_the_run_is_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = load_case("jeffcott", [*SHORT_RUN, "accuracy.tolerance=1e-3"])
    often = runup(case, tmp_path / "a.h5").error
    monkeypatch.setattr(march, "BUDGET", 7)
    monkeypatch.setattr(march, "BUFFER", 10)
    assert runup(case, tmp_path / "b.h5").error == often


def test_an_error_that_arises_late_says_from_when_on() -> None:
    """Of two runs that part with exp(10 t), a third of what they differ by at 1 s is reached at 1 - ln(3)/10."""
    times = np.linspace(0.0, 2.0, 201)
    case = load_case("jeffcott-two-phase")
    system = planned_system(case)
    samples = np.zeros((201, 2 * system.rotor.size + 2))
    other, along_x = samples.copy(), system.films.seen(system.rotor.journals)[0][0]
    other[:, : system.rotor.size] = 1e-9 * np.exp(10.0 * times)[:, None] * along_x
    other[times > 1.5] = 1.0  # afterwards nothing counts
    fewer = FewerCells(1.0, other)
    late = grows_from(system, np.zeros((2, ERROR_SPANS)), fewer, times, samples, 1.0, 2.0)
    assert late == pytest.approx(1.0 - np.log(3.0) / 10.0, abs=0.01)
    assert grows_late({"quiet_until_s": 1.0, "error_grows_from_s": late}) == ", two thirds of it after 0.89 s"
    assert grows_late({"quiet_until_s": 2.0, "error_grows_from_s": late}) == ""
    assert grows_from(system, np.zeros((2, ERROR_SPANS)), FewerCells(1.0, other[:50]), times, samples, 1.0, 2.0) is None


@pytest.mark.parametrize("settings", [(), ("film.theory=short",), ("accuracy.mesh=[2, 24]",)])
def test_stated_error_bounds_the_true_one(settings: tuple[str, ...], tmp_path: Path) -> None:
    """Against a reference of twice the elements and a hundredth of the tolerance."""
    run = runup(load_case("jeffcott", [*SHORT_RUN, *settings]), tmp_path / "run.h5")
    fine = ("film.theory=finite", "accuracy.mesh=[12, 192]", "accuracy.tolerance=1e-7")
    apart = difference(run, runup(load_case("jeffcott", [*SHORT_RUN, *fine]), tmp_path / "fine.h5"))
    assert 0.0 < apart.largest < run.error["eccentricity"] < 20.0 * apart.largest
    assert apart.signals["disk_y_m"] < run.error["displacement"]
    if run.error["mesh_relative"] is not None:  # the bound of the short bearing's 40 % is a coarse one for disks
        assert run.error["displacement"] < 20.0 * apart.signals["disk_y_m"]


STARVING = ("accuracy.target=1e-3", "speed.duration=0.2 s", "speed.from=20 Hz", "speed.to=40 Hz", "output.step=1e-3 s")


@pytest.fixture(scope="module")
def fine_cells(tmp_path_factory: pytest.TempPathFactory) -> Run:
    case = load_case("jeffcott-two-phase", [*STARVING, "accuracy.mesh=[12, 120]"])
    return runup(case, tmp_path_factory.mktemp("fine") / "fine.h5")


@pytest.mark.parametrize(
    "settings",
    [
        ("accuracy.mesh=[4, 32]",),
        pytest.param((), marks=pytest.mark.nightly),
        pytest.param(("accuracy.mesh=[8, 64]",), marks=pytest.mark.nightly),
    ],
)
def test_stated_error_of_cells_bounds_the_true_one(
    settings: tuple[str, ...], fine_cells: Run, tmp_path: Path
) -> None:
    """A film that loses oil; against more than twice the cells of the plan."""
    run = runup(load_case("jeffcott-two-phase", [*STARVING, *settings]), tmp_path / "run.h5")
    apart = difference(run, fine_cells)
    assert 1e-4 < apart.largest < run.error["eccentricity"] < 8.0 * apart.largest
    assert apart.signals["disk_y_m"] < run.error["displacement"]
    assert apart.signals["oil_fraction"] < run.error["oil_fraction"]
    assert 0.3 * run.error["eccentricity"] < run.error["cells"] < run.error["eccentricity"]
    assert run.cost["error_cpu_s"] > 0.0


@pytest.mark.parametrize(("least", "stated"), [(0.0, 0.0), (3e-3, 3e-3), (0.1, 1e-2)])
def test_runs_that_agree_by_chance(least: float, stated: float) -> None:
    """The journal goes to 1e-2 of the clearance in both runs: no error larger than that is stated."""
    case = load_case("rigid-two-phase")
    system = planned_system(case)
    row = np.zeros((1, 2 * system.rotor.size + 2))
    row[0, 0] = 1e-2 * system.clearances[0]
    found = FewerCells(0.5, row, least).error(row, system)
    assert found is not None
    assert (found.eccentricity, found.displacement) == pytest.approx((stated, stated))


def test_between_rings_only_lengths_count() -> None:
    """A journal that is as far out in another direction errs in its place, but not in its eccentricity."""
    case = load_case("floating-ring")
    system = planned_system(case)
    out, n = 0.5 * min(system.clearances), system.rotor.size
    row, away = np.zeros((1, 2 * n + 3)), np.zeros((1, 2 * n + 3))
    along, across = (np.linalg.pinv(np.concatenate(system.rotor.journals))[:, [i, 2 + i]].sum(axis=1) for i in (0, 1))
    row[0, :n], away[0, :n] = out * along, out * across
    found = FewerCells(1.0, away).error(row, system)
    assert found is not None
    assert found.eccentricity == pytest.approx(0.0, abs=1e-12)
    assert found.displacement > 0.1


def test_a_run_that_does_not_begin_on_fewer_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case("rigid-two-phase")
    plan = make_plan(case)
    run = march.March(case, plan, make_segments(case, plan), run_up_profile(case))

    def fails(*_: object) -> object:
        raise NotConverged("no")

    monkeypatch.setattr(march, "make_segments", fails)
    assert on_fewer_cells(run, 1.0) is None


def test_a_film_that_carries_little_counts_as_little() -> None:
    times = np.arange(20.0)
    errors, sizes = np.full(20, 1.0), np.full(20, 1000.0)
    errors[::2], sizes[::2] = 50.0, 60.0  # every other film is off by all that it carries, which is little
    assert FilmErrors(times, errors, sizes).relative() == pytest.approx(1e-3)
    assert FilmErrors(times, errors, np.full(20, 1000.0)).relative() == pytest.approx(50e-3)
    assert FilmErrors(times, errors, np.zeros(20)).relative() is None
    empty = np.where(times < 10.0, 1e-313, sizes)  # a film that is empty at first: no number is divided by that
    assert FilmErrors(times, errors, empty).relative(9.0) is None
    assert FilmErrors(times, errors, empty).relative() == pytest.approx(1e-3)


def test_parts_that_a_run_has(tmp_path: Path) -> None:
    finite = runup(load_case("jeffcott", SHORT_RUN), tmp_path / "a.h5").error
    short = runup(load_case("jeffcott", [*SHORT_RUN, "film.theory=short"]), tmp_path / "b.h5").error
    assert (finite["model_relative"], short["mesh_relative"]) == (None, None)
    assert finite["mesh_relative"] == finite["film_force_relative"] < 1e-3
    assert short["model_relative"] == short["film_force_relative"] > 1e-2
    assert 0.0 < finite["coupling"] < 1e-5
    assert finite["modal_reduction"] is None
    assert (finite["cells"], finite["ring_speed"], finite["oil_fraction"]) == (None, None, None)
    assert finite["quiet_until_s"] == pytest.approx(0.3)


def test_steps_beside_rings_have_no_larger_error_than_is_stated(tmp_path: Path) -> None:
    """A turbocharger near the onset of its whirl amplifies what its steps leave: the same cells with a fifteenth of the
    tolerance move it by 1.1e-3, where half of the sum of the local errors is 0.7e-3."""
    settings = ["speed.to=125 Hz", "speed.duration=0.05 s", "accuracy.mesh=[8, 56]", "output.step=0.1 ms"]
    runs = [
        runup(load_case("turbocharger-car", [*settings, f"accuracy.tolerance={size}"]), tmp_path / f"{size}.h5")
        for size in (7.5e-5, 5e-6)
    ]
    stated = runs[0].error["time_integration"]
    assert 0.5 * stated < difference(*runs).largest < stated


def test_verified_by_shorter_steps(tmp_path: Path) -> None:
    case = load_case("jeffcott", [*SHORT_RUN, "film.coupling=dynamic-static-semi-implicit"])
    run = runup(case, tmp_path / "run.h5")
    found = verify(case, run)
    assert 0.0 < found.eccentricity < run.error["time_integration"]
    assert found.status == "finished"
    assert found.coupling is not None
    assert 0.0 < found.coupling < 1e-3
    assert run.error["coupling"] is None


def test_command_tells_what_a_finer_run_changes(tmp_path: Path, frb: Frb) -> None:
    settings = [part for setting in SHORT_RUN for part in ("--set", setting)]
    options = ["--verify", "--json", "--no-picture", "-o", str(tmp_path / "run.h5")]
    out = frb("runup", "jeffcott", *settings, *options)
    verified = json.loads(out.out)["error"]["verified"]
    assert 0.0 < verified["eccentricity"] < 1e-3
    assert verified["coupling"] is None
    options.remove("--json")
    assert "verified: with half the tolerance" in frb("runup", "jeffcott", *settings, *options, "--force").out


CASE = ("film.theory=short", "output.step=0.2 ms")


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("jeffcott", CASE)


@pytest.fixture(scope="module")
def run(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return runup(case, tmp_path_factory.mktemp("second") / "run.h5", uncertainty=True)


def test_a_run_at_a_tenth_of_the_target_is_within_the_uncertainties(run: Run, case: Case, tmp_path: Path) -> None:
    exact = runup(case.with_settings("accuracy.target=1e-4"), tmp_path / "exact.h5")
    assert [event["kind"] for event in run.events] == ["critical-speed", "onset"]
    for event, true in zip(run.events, partners(run.events, exact.events), strict=True):
        assert event["certain"]
        assert true is not None
        for key in ("speed_Hz", "frequency_Hz", "amplitude"):
            uncertainty = event[key.removesuffix("_Hz") + "_uncertainty" + ("_Hz" if key.endswith("_Hz") else "")]
            assert abs(event[key] - true[key]) <= uncertainty < 0.03 * max(event[key], 1.0)


@pytest.mark.bitwise
def test_a_run_that_has_ended_gets_them_later(run: Run, case: Case, tmp_path: Path) -> None:
    path = tmp_path / "later.h5"
    first = runup(case, path)
    assert all(event["certain"] is None for event in first.events)
    assert "with --uncertainty" in about_certainty(first, first.events)[0]
    later = runup(case, path, uncertainty=True)
    assert later.events == run.events
    assert later.cost["cpu_s"] == first.cost["cpu_s"]
    assert all((later[name] == first[name]).all() for name in first.signals)
    assert read_run(path).checkpoint_samples == len(first)


def test_the_terminal_says_them_and_their_cost(tmp_path: Path, frb: Frb) -> None:
    words = ["jeffcott", *(word for key in CASE for word in ("--set", key)), "--no-picture"]
    words += ["-o", str(tmp_path / "run.h5")]
    assert "No uncertainties of the events: they take about 0." in frb("runup", *words).out
    told = frb("runup", *words, "--uncertainty")
    assert re.search(r"14\d\.\d\(\d\)", told.out)
    assert "second, coarser run" in told.out
    assert "--force" not in told.err


def test_an_onset_on_a_table_of_solutions_is_not_certain(tmp_path: Path) -> None:
    """Both runs have the error of the table: with numbers of another machine the onset was at 230 Hz +- 4 Hz on it, and
    at 248 Hz on cells."""
    case = load_case("jeffcott", ["film.cavitation=penalty", "speed.from=100 Hz", "speed.duration=2 s"])
    assert make_plan(case).form.table_of_solutions
    events = runup(case, tmp_path / "run.h5", uncertainty=True).events
    onsets = [event for event in events if event["kind"] == "onset"]
    assert onsets
    assert all(event["certain"] is False and "table" in event["reason"] for event in onsets)
    assert all(event["speed_uncertainty_Hz"] > 0.0 for event in onsets)


@pytest.mark.parametrize(("law", "unasked"), [("elrod", True), ("reynolds", False)])
def test_its_cost_is_announced_where_it_is_made_unasked(law: str, unasked: bool) -> None:
    """The run with Elrod's law takes 1.4 times the time without it."""
    case = load_case("jeffcott", [f"film.cavitation={law}"])
    plan, profile = make_plan(case), run_up_profile(case)
    alone = expected_cost(case, plan, profile)
    second = second_run_s(case, plan, profile)
    assert is_cheap(second, alone) == unasked
    assert cost_of_run(case, plan, profile).total_s == alone.run_s + (second if unasked else 0.0)
    assert run_cost("runup", case) == cost_of_run(case, plan, profile)


@dataclass
class Long:
    """A march of eight signals in chunks of a fifth of a second."""

    time: float = 0.0
    names: tuple[str, ...] = ("time_s", *(f"signal_{number}" for number in range(7)))

    def chunk(self) -> tuple[int, dict[str, Array]]:
        self.time += 0.2
        return RUNNING, {name: np.full(20_000, self.time) for name in self.names}


def test_the_second_run_holds_its_signals_once(monkeypatch: pytest.MonkeyPatch, case: Case, run: Run) -> None:
    """And one of them twice, while its pieces are joined."""
    monkeypatch.setattr(March, "again", lambda *_: Long())
    plan = make_plan(case)
    march = March(case, plan, make_segments(case, plan), run_up_profile(case))
    tracemalloc.start()
    try:
        found = second_run.second_run(march, run)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert found is not None
    held = 8.0 * len(found) * len(Long().names)
    assert held > 50e6
    assert peak < 1.2 * held
    assert found["time_s"][0] == pytest.approx(0.2)


def test_a_second_run_that_does_not_begin_leaves_the_events(
    monkeypatch: pytest.MonkeyPatch, case: Case, tmp_path: Path
) -> None:
    def again(*_: object) -> March:
        raise NotConverged("no")

    monkeypatch.setattr(March, "again", again)
    found = runup(case, tmp_path / "run.h5", uncertainty=True)
    assert all(event["certain"] is None for event in found.events)
    assert second_run.SECOND_RUN in found.cost
    assert "does not begin" in about_certainty(found, found.events)[0]
