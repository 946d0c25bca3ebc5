"""Parameter studies: which points there are, that each is the run it would be alone, that none is ever lost."""

import math
import os
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sweep_points import CLEARANCES, SHORT, TWO, VISCOSITIES

from frbcli import Case, InputError, load_case, read_run, runup, stability, sweep
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.linear.stability import open_spans, threshold_alone
from frbcli.linear.stability_point import find_threshold, point_at_rest
from frbcli.studies import sweep as study
from frbcli.studies.sweep import LOG, SweepPoint, Workers
from frbcli.studies.sweep_points import grid, product, read_list, split_values
from frbcli.studies.sweep_workers import DIED, Task, solve, solved


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("jeffcott", SHORT)


def said(error: pytest.ExceptionInfo[InputError]) -> str:
    return str(error.value)


# --- points ---
@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("10 mPa*s,12 mPa*s", ("10 mPa*s", "12 mPa*s")),
        (" 1 , 2,3 ", ("1", "2", "3")),
        ("[0.1, 0.2],[0, 0]", ("[0.1, 0.2]", "[0, 0]")),
        ("{ kind = 'none' },{ kind = 'a,b', x = [1, 2] }", ("{ kind = 'none' }", "{ kind = 'a,b', x = [1, 2] }")),
        ('"a, b","c]"', ('"a, b"', '"c]"')),
        ("one", ("one",)),
        ("1,,2", ("1", "", "2")),
    ],
)
def test_values_are_parted_at_commas(text: str, values: tuple[str, ...]) -> None:
    assert split_values(text) == values


def test_grid_has_every_combination_and_the_last_key_changes_fastest() -> None:
    found = grid({"a": ["1", "2"], "b": [3.5, True, "x y"]})
    assert [(point["a"], point["b"]) for point in found] == [
        ("1", "3.5"), ("1", "true"), ("1", "x y"), ("2", "3.5"), ("2", "true"), ("2", "x y"),
    ]  # fmt: skip


def test_list_times_grid() -> None:
    assert product([{"a": "1"}, {"a": "2", "c": "0"}], grid({"b": [3, 4]})) == (
        {"a": "1", "b": "3"}, {"a": "1", "b": "4"}, {"a": "2", "c": "0", "b": "3"}, {"a": "2", "c": "0", "b": "4"},
    )  # fmt: skip
    with pytest.raises(InputError, match="set twice"):
        product([{"a": "1"}], [{"a": "2"}])


def test_a_list_reads_quoted_commas_blank_lines_and_empty_cells(tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    file.write_text('\ufeffoil.viscosity, start.displacement\n12 mPa*s,"[0.1, 0.2]"\n\n8 mPa*s,\n', encoding="utf-8")
    assert read_list(file) == (
        {"oil.viscosity": "12 mPa*s", "start.displacement": "[0.1, 0.2]"},
        {"oil.viscosity": "8 mPa*s"},
    )


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "holds no points"),
        (b"a,b\n", "holds no points"),
        (b"a,a\n1,2\n", "name every column once"),
        (b"a,\n1,2\n", "name every column once"),
        (b"a,b\n1,2\n1\n", "(line 3): has 1 values for 2 keys"),
        (b"\xff\xfe\x00", "no UTF-8 text"),
        (b'a,b\n"1,2\n', "cannot be read"),
        (b"a\n \n", "nothing to change"),
    ],
)
def test_a_wrong_list_is_refused(tmp_path: Path, content: bytes, problem: str) -> None:
    file = tmp_path / "points.csv"
    file.write_bytes(content)
    with pytest.raises(InputError) as error:
        read_list(file)
    assert problem in said(error)
    with pytest.raises(InputError, match="does not exist"):
        read_list(tmp_path / "absent.csv")


@pytest.mark.parametrize("points", [{}, {"oil.viscosity": []}, [], [{}]])
def test_no_points_are_refused(case: Case, points: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError):
        sweep(case, points, tmp_path / "s")
    assert not list(tmp_path.iterdir())


# --- results ---
@pytest.mark.bitwise
def test_each_point_is_the_run_it_would_be_alone(case: Case, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    found = sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path / "s", workers=TWO,
                  observe=lambda _, done, whole: seen.append((done, whole)))  # fmt: skip
    assert seen == [(1, 2), (2, 2)]
    assert [point.number for point in found.points] == [1, 2]
    for point, viscosity in zip(found.points, VISCOSITIES, strict=True):
        assert point.settings == {"oil.viscosity": viscosity}
        assert point.run is not None
        kept = read_run(point.run)
        alone = runup(load_case("jeffcott", [*SHORT, f"oil.viscosity={viscosity}"]), tmp_path / f"{point.number}.h5")
        for name in alone.signals:
            np.testing.assert_array_equal(kept[name], alone[name], strict=True)
        assert (point.status, list(point.events)) == (alone.status, alone.events)
        assert point.cost["steps"] == alone.cost["steps"]
    assert not np.array_equal(read_run(found.points[0].run or "")["eccentricity"], alone["eccentricity"])


def test_one_point_of_each_kind_is_compiled_before_the_processes_start(
    case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two points that differ in a number one is enough; rough surfaces and a start at rest have kernels of their
    own, which all processes would compile at the same time."""
    rough = ("contact.model=asperities", "contact.roughness=0.5 um", "contact.summit_radius=20 um",
             "contact.summit_density=4e10 1/m^2")  # fmt: skip
    points = (), ("oil.viscosity=8 mPa*s",), rough, (*rough, "oil.viscosity=8 mPa*s"), ("start.position=resting",)
    compiled: list[Case] = []
    monkeypatch.setattr(study, "solve", lambda task: compiled.append(task.case))
    study._compile([Task(n, {}, case.with_settings(*given), "runup", None) for n, given in enumerate(points, 1)])
    assert [(each.contact.rough, each.start.position) for each in compiled] == [
        (False, "centre"), (True, "centre"), (False, "resting"),
    ]  # fmt: skip


def test_runs_that_are_not_kept_leave_nothing(case: Case, tmp_path: Path) -> None:
    found = sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path / "s", keep_runs=False, workers=TWO)
    assert [point.status for point in found.points] == ["finished", "finished"]
    assert [point.run for point in found.points] == [None, None]
    assert [file.name for file in (tmp_path / "s").iterdir()] == [LOG]


@pytest.mark.bitwise
def test_thresholds_are_those_of_the_linear_stability(case: Case, tmp_path: Path) -> None:
    found = sweep(case, {"bearing.clearance": CLEARANCES}, tmp_path, "stability", workers=TWO)
    for point, clearance in zip(found.points, CLEARANCES, strict=True):
        alone = stability(load_case("jeffcott", [*SHORT, f"bearing.clearance={clearance}"])).threshold
        event = point.first("threshold")
        assert alone is not None
        assert event is not None
        assert (event["speed_Hz"], event["frequency_Hz"]) == (alone.speed_Hz, alone.frequency_Hz)
        assert event["frequency_ratio"] == alone.whirl_ratio
    # a wider clearance at the same load: a lower load parameter of the film, hence an earlier whirl
    narrow, wide = found.to_pandas()["threshold_speed_Hz"]
    assert narrow > wide


def test_a_threshold_alone_is_that_of_the_stability_with_all_errors(case: Case) -> None:
    alone, whole = threshold_alone(case), stability(case)
    assert alone.note == whole.note
    assert alone.threshold == whole.threshold
    assert alone.threshold is not None
    growths = [[point.growth for point in found.sweep] for found in (alone, whole)]
    assert growths[0] == growths[1]
    assert np.isnan(alone.points[0].films[0].error)
    assert whole.points[0].films[0].error > 0.0


FEED_HOLES = 'bearing.supply={kind = "bores", count = 4, diameter = "2 mm", pressure = "1 bar"}'


def test_a_threshold_on_cells_is_sought_on_few_and_found_on_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where a speed lies between the thresholds of both meshes, which then disagree about it."""
    case = load_case("jeffcott", [FEED_HOLES])

    def found(speeds: tuple[float, ...], coarse: bool) -> float:
        machines = StaticMachines(case, coarse=coarse)
        points = [point_at_rest(machines.at(2.0 * math.pi * speed, with_error=False), speed) for speed in speeds]
        threshold, _ = find_threshold(case, machines, points)
        assert threshold is not None
        return threshold.speed_Hz

    def on_all_cells(speeds: tuple[float, ...]) -> tuple[int, float]:
        """(how many of the points, threshold)."""
        monkeypatch.setattr("frbcli.linear.stability.default_speeds", lambda _: speeds)
        alone = threshold_alone(case)
        own = StaticMachines(case)
        exact = [point_at_rest(own.at(2.0 * math.pi * speed, with_error=False), speed) for speed in speeds]
        same = [abs(a.growth - b.growth) < 1e-6 * abs(b.growth) for a, b in zip(alone.sweep, exact, strict=True)]
        assert alone.threshold is not None
        return sum(same), alone.threshold.speed_Hz

    few, whole = found((170.0, 190.0), True), found((170.0, 190.0), False)
    assert abs(few - whole) > 1e-6 * whole
    assert on_all_cells((150.0, 165.0, 190.0, 220.0)) == (2, pytest.approx(whole, rel=1e-8))
    assert on_all_cells((165.0, 0.5 * (few + whole), 190.0)) == (3, pytest.approx(whole, rel=1e-8))


def test_short_thresholds_start_no_processes(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless a number of them is asked for; where the points take long, all cores work."""
    asked: list[int] = []

    def recorded(tasks: list[Task], workers: Workers) -> Iterator[SweepPoint]:
        asked.append(workers.jobs)
        yield from map(solve, tasks)

    monkeypatch.setattr(study, "solved", recorded)
    axes = {"bearing.clearance": ["30 um", "32 um", "35 um"]}
    found = [sweep(case, axes, tmp_path / str(jobs), "stability", workers=Workers(jobs=jobs)) for jobs in (-1, 2)]
    monkeypatch.setattr(study, "START_s", 0.0)
    found.append(sweep(case, axes, tmp_path / "all", "stability"))
    assert asked == [1, 2, -1]
    events = [[point.events for point in each.points] for each in found]
    assert events[0] == events[1] == events[2]
    assert [point.number for point in found[0].points] == [1, 2, 3]


def test_a_range_without_a_threshold_finishes_and_says_where_it_lies(case: Case, tmp_path: Path) -> None:
    found = sweep(case, {"speed.to": ["100 Hz", "300 Hz"]}, tmp_path, "stability", workers=TWO)
    low, high = found.points
    assert (low.status, low.events) == ("finished", ())
    assert "above 100 Hz" in low.message
    assert high.first("threshold")
    assert math.isnan(found.to_pandas()["threshold_speed_Hz"][0])


def test_points_that_fail_are_kept_and_the_others_go_on(case: Case, tmp_path: Path) -> None:
    points = [
        {"oil.viscosity": "-1 Pa*s"},
        {"start.position": "resting"},  # there is no resting position at standstill
        {"film.cavitation": "no-such-model"},
        {"contact.eccentricity": "0.6"},
        {"oil.viscosity": "12 mPa*s"},
    ]
    found = sweep(case, points, tmp_path, workers=TWO)
    assert [point.status for point in found.points] == [
        "input-error", "not-converged", "input-error", "contact", "finished",
    ]  # fmt: skip
    assert "must be greater than 0" in found.points[0].message
    assert "static equilibrium" in found.points[1].message
    assert "contact at" in found.points[3].message
    assert [point.message for point in found.points if "\n" in point.message] == []
    table = found.to_pandas()
    assert list(table["point"]) == [1, 2, 3, 4, 5]
    assert list(table["status"]) == [point.status for point in found.points]


def test_a_sweep_of_faults_alone_is_refused(case: Case, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="clearanse"):
        sweep(case, {"bearing.clearanse": CLEARANCES}, tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_a_bug_at_one_point_is_its_result() -> None:
    broken: Any = None
    point = solve(Task(3, {"a": "1"}, broken, "runup", None))
    assert (point.number, point.status) == (3, "error")
    assert "AttributeError" in point.message


class Bomb:
    """Ends the process that unpickles it."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (1,)


@pytest.mark.nightly  # a worker that dies: test_hard_cases.py
def test_a_process_that_dies_takes_no_other_point_with_it(case: Case) -> None:
    bomb: Any = Bomb()
    stability(case, [100.0])  # compiled once, not in each process
    tasks = [Task(n, {"n": str(n)}, bomb if n == 3 else case, "stability", None) for n in range(1, 9)]
    found = {point.number: point for point in solved(tasks, TWO)}
    assert sorted(found) == list(range(1, 9))
    assert (found[3].status, found[3].message) == ("error", DIED)
    assert {found[n].status for n in found if n != 3} == {"finished"}


# --- broken off ---
def table_of(points: tuple[SweepPoint, ...]) -> list[tuple[Any, ...]]:
    return [(point.number, point.settings, point.status, point.events, point.run) for point in points]


def test_a_broken_sweep_goes_on_with_what_is_missing(case: Case, tmp_path: Path) -> None:
    axes = {"oil.viscosity": VISCOSITIES, "bearing.clearance": CLEARANCES}
    whole = sweep(case, axes, tmp_path / "whole", "stability", workers=TWO)

    def break_off(_point: SweepPoint, done: int, _whole: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    broken = sweep(case, axes, tmp_path / "s", "stability", workers=TWO, observe=break_off)
    assert sorted(point.status for point in broken.points) == ["finished"] * 2 + ["interrupted"] * 2
    log = tmp_path / "s" / LOG
    log.write_bytes(log.read_bytes()[:-20])  # a crash tears the last line
    computed: list[int] = []
    found = sweep(case, axes, tmp_path / "s", "stability", workers=TWO,
                  observe=lambda point, *_: computed.append(point.number))  # fmt: skip
    assert len(computed) == 3
    assert table_of(found.points) == table_of(whole.points)
    again = sweep(case, axes, tmp_path / "s", "stability", workers=TWO, observe=break_off)
    assert again == found  # nothing left to do, the costs are those of the first time


def test_an_interrupted_run_goes_on_from_its_file(case: Case, tmp_path: Path) -> None:
    axes = {"oil.viscosity": VISCOSITIES}
    found = sweep(case, axes, tmp_path, workers=TWO)
    (tmp_path / LOG).unlink()
    stamps = [(tmp_path / "runs" / name).stat().st_mtime_ns for name in ("001.h5", "002.h5")]
    again = sweep(case, axes, tmp_path, workers=TWO)
    assert again == found
    assert stamps == [(tmp_path / "runs" / name).stat().st_mtime_ns for name in ("001.h5", "002.h5")]


def test_a_directory_of_another_sweep_is_left_alone(case: Case, tmp_path: Path) -> None:
    sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path, "stability", workers=TWO)
    before = (tmp_path / LOG).read_bytes()
    with pytest.raises(InputError, match="another sweep"):
        sweep(case, {"oil.viscosity": [*VISCOSITIES, "9 mPa*s"]}, tmp_path, "stability", workers=TWO)
    with pytest.raises(InputError, match="another sweep"):
        sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path, "runup", workers=TWO)
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / LOG).write_bytes(b"\x93PNG not a log")
    with pytest.raises(InputError, match="is no UTF-8 text"):
        sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path / "foreign", "stability", workers=TWO)
    assert (tmp_path / LOG).read_bytes() == before
    assert (tmp_path / "foreign" / LOG).read_bytes() == b"\x93PNG not a log"


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"method": "no-such"}, "method"),
        ({"workers": Workers("no-such")}, "--backend"),
        ({"workers": Workers(jobs=0)}, "--jobs"),
        ({"workers": Workers(scheduler="tcp://localhost:1")}, "--scheduler"),
        ({"directory": "file"}, "cannot be made"),
    ],
)
def test_wrong_options_are_refused(case: Case, options: dict[str, Any], problem: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a directory")
    directory = tmp_path / options.pop("directory", "s")
    with pytest.raises(InputError) as error:
        sweep(case, {"oil.viscosity": VISCOSITIES}, directory, **options)
    assert problem in said(error)
    assert not (tmp_path / "s").exists()


# --- a cluster ---
@pytest.mark.filterwarnings("default")  # not of frb
def test_a_cluster_gives_the_same_table(case: Case, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    axes = {"oil.viscosity": VISCOSITIES, "bearing.clearance": CLEARANCES}
    here = sweep(case, axes, tmp_path / "here", "stability", workers=TWO)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(tmp_path)
    ) as cluster:
        workers = Workers("dask", scheduler=cluster.scheduler_address)
        found = sweep(case, axes, tmp_path / "there", "stability", workers=workers)
        runs = sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path / "runs", workers=workers)
    assert table_of(found.points) == table_of(here.points)
    assert [point.status for point in runs.points] == ["finished"] * 2
    assert all(read_run(point.run or "").status == "finished" for point in runs.points)


@pytest.mark.filterwarnings("default")
def test_a_cluster_that_is_not_there_is_wrong_input(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("frbcli.studies.sweep_workers.CONNECT_WITHIN_s", 0.5)
    with pytest.raises(InputError, match="cannot be reached"):
        sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path, workers=Workers("dask", scheduler="tcp://127.0.0.1:9"))


@pytest.mark.parametrize(
    ("growths", "spans"),
    [
        ([-3.0, -1.0, -2.0, 1.0, 2.0], [(0.0, 2.0), (2.0, 3.0)]),  # a whirl may begin and end about the first maximum
        ([-3.0, -2.0, -1.0], [(1.0, 2.0)]),
        ([1.0, 2.0, -1.0], [(0.0, 0.0)]),
    ],
)
def test_speeds_beside_a_maximum_of_growth_are_tried(growths: list[float], spans: list[tuple[float, float]]) -> None:
    points: Any = [SimpleNamespace(speed_Hz=float(number), growth=each) for number, each in enumerate(growths)]
    assert open_spans(points) == spans
