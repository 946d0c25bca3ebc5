"""A sweep as table, picture and command. What a sweep is given: ranges, linked keys, keys of bearings by name,
distributions; and what it says of machines."""

import csv
import json
import math
import os
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from commands import Frb
from scipy.stats import norm, truncnorm
from sweep_points import CLEARANCES, SHORT, TWO, VISCOSITIES

from frbcli import Case, InputError, load_case
from frbcli.plot.studies import can_draw, sweep_figure
from frbcli.studies.sweep import Sweep, SweepPoint, Workers, _wilson, scatter, sweep, whirl_speed, write_table
from frbcli.studies.sweep_points import linked, read_correlation, read_distribution, read_values, samples
from frbcli.studies.sweep_workers import NO_WHIRL


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("jeffcott", SHORT)


def test_parquet_needs_its_library(case: Case, tmp_path: Path) -> None:
    found = sweep(case, {"oil.viscosity": VISCOSITIES}, tmp_path, "stability", workers=TWO)
    with pytest.raises(InputError, match="not a format"):
        write_table(found, tmp_path / "t.xls", "xls")
    if find_spec("pyarrow") is None:
        with pytest.raises(InputError, match="pyarrow"):
            write_table(found, tmp_path / "t.parquet", "parquet")
    else:
        import pandas as pd

        read = pd.read_parquet(write_table(found, tmp_path / "t.parquet", "parquet"))
        pd.testing.assert_frame_equal(read, found.to_pandas(), check_dtype=False)


def test_map_and_curve_show_the_thresholds(case: Case, tmp_path: Path) -> None:
    axes = {"oil.viscosity": ["12 mPa*s", "8 mPa*s"], "bearing.clearance": [*CLEARANCES, "1 m"]}
    found = sweep(case, axes, tmp_path / "map", "stability", workers=TWO)
    speeds = found.to_pandas()["threshold_speed_Hz"].to_numpy().reshape(2, 3)
    figure = sweep_figure(found)
    drawn = np.ma.filled(figure.axes[0].collections[0].get_array(), np.nan)
    # across: viscosity, ascending; up: clearance, ascending, "1 m" beside the others' um: as written
    np.testing.assert_array_equal(drawn, speeds[::-1].T)
    assert figure.axes[0].get_xlabel() == "oil viscosity in mPa s"
    assert [label.get_text() for label in figure.axes[0].get_xticklabels()] == ["8", "12"]
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["30 um", "35 um", "1 m"]
    curve = sweep(case, {"bearing.clearance": ["35 um", "30 um", "2000 um"]}, tmp_path / "c", "stability", workers=TWO)
    line, missing = sweep_figure(curve).axes[0].lines
    np.testing.assert_array_equal(line.get_xdata(), [30.0, 35.0, 2000.0])
    expected = curve.to_pandas()["threshold_speed_Hz"].to_numpy()
    np.testing.assert_array_equal(line.get_ydata(), expected[[1, 0, 2]])
    np.testing.assert_array_equal(missing.get_xdata(), [2000.0])
    three = sweep(case, [{"oil.viscosity": "8 mPa*s"}, {"oil.density": "800 kg/m^3"}, {"speed.to": "260 Hz"}],
                  tmp_path / "three", "stability", workers=TWO)  # fmt: skip
    assert not can_draw(three)


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("elsewhere")
def test_the_command_says_one_document_and_leaves_table_and_picture(frb: Frb) -> None:
    words = ["sweep", "jeffcott", "--set", "film.theory=short", "--set", "oil.viscosity=8 mPa*s,12 mPa*s"]
    told = frb(*words, "--stability", "--json", "--jobs", "2")
    document = json.loads(told.out)
    assert list(document) == ["command", "case", "points", "table", "picture"]
    assert [point["set"] for point in document["points"]] == [{"oil.viscosity": value} for value in VISCOSITIES]
    for point in document["points"]:
        assert list(point) == ["set", "status", "message", "events", "cost", "run"]
        assert set(point["cost"]) == {"cpu_s", "wall_s"}
        assert [event["kind"] for event in point["events"]] == ["threshold"]
        assert set(point["events"][0]) == {
            "kind", "film", "t_s", "speed_Hz", "frequency_Hz", "frequency_ratio", "speed_uncertainty_Hz",
            "frequency_uncertainty_Hz",
        }  # fmt: skip
    assert "1/2 " in told.err
    assert "2/2 " in told.err
    with Path(document["table"]).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["oil.viscosity"] for row in rows] == VISCOSITIES
    events = [point["events"][0]["speed_Hz"] for point in document["points"]]
    assert [float(row["threshold_speed_Hz"]) for row in rows] == events
    assert Path(document["picture"]).read_bytes().startswith(b"\x89PNG")


def test_the_command_takes_a_list_and_tells_of_failures(elsewhere: Path, frb: Frb) -> None:
    Path("points.csv").write_text("oil.viscosity,bearing.clearance\n8 mPa*s,35 um\n-8 mPa*s,35 um\n")
    words = ["sweep", "jeffcott", "--list", "points.csv", "--set", "film.theory=short", "--set", "speed.duration=0.3 s"]
    told = frb(*words, "--json", "-o", "out", "--jobs", "2", code=3)
    good, bad = json.loads(told.out)["points"]
    assert (good["status"], good["run"]) == ("finished", str(elsewhere / "out" / "runs" / "001.h5"))
    assert (bad["status"], bad["events"], bad["cost"], bad["run"]) == ("input-error", [], {}, None)
    assert "greater than 0" in bad["message"]
    assert "did not finish" not in told.err
    assert frb(*words, "--quiet", "-o", "out", "--jobs", "2", code=3) == ("", "")


def children() -> list[Path]:
    """The entries in /proc of all processes that this one has started."""
    entries = [entry for entry in Path("/proc").iterdir() if entry.name.isdigit()]
    parents = [(entry / "stat").read_text().rpartition(")")[2].split()[1] for entry in entries]
    return [entry for entry, parent in zip(entries, parents, strict=True) if parent == str(os.getpid())]


def worked_and_waited() -> tuple[float, float]:
    """CPU time of the children's main threads, and how long these could have run, but for other programs, in s."""
    times = [[float(number) for number in (child / "schedstat").read_text().split()[:2]] for child in children()]
    return sum(cpu for cpu, _ in times) / 1e9, sum(queued for _, queued in times) / 1e9


@pytest.mark.nightly
@pytest.mark.timing
@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="needs the scheduler's statistics of Linux")
def test_all_cores_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """64 run-ups of some tenths of a second each: the share of the cores' time that the workers ask for."""
    jobs = len(os.sched_getaffinity(0))
    case = load_case("jeffcott", ["film.theory=short", "speed.duration=20 s", "output.step=1 ms"])
    sweep(case, {"oil.viscosity": ["7 mPa*s", "7.5 mPa*s"]}, tmp_path / "warm")
    (cpu, queued), began = worked_and_waited(), time.perf_counter()
    found = sweep(case, {"oil.viscosity": [f"{8 + 0.25 * n} mPa*s" for n in range(64)]}, tmp_path / "s")
    wall, (cpu_after, queued_after) = time.perf_counter() - began, worked_and_waited()
    cpu, queued = cpu_after - cpu, queued_after - queued
    with capsys.disabled():
        sys.stdout.write(
            f"\n64 run-ups on {jobs} cores: {wall:.1f} s wall; the workers computed {cpu / wall / jobs:.0%} of it "
            f"and waited {queued / wall / jobs:.0%} for a core that another program had\n"
        )
    assert all(point.status in ("finished", "contact") for point in found.points)
    assert (cpu + queued) / wall / jobs >= 0.9


THEORY = "film.theory=short"


# --- values and keys ---


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("10..20 um / 6", ("10 um", "12 um", "14 um", "16 um", "18 um", "20 um")),
        ("10 um..20 um/3", ("10 um", "15 um", "20 um")),
        ("2..1 / 2, 5", ("2", "1", "5")),
        ("1e-3..3e-3/3", ("0.001", "0.002", "0.003")),
        ("8 mPa*s, 12 mPa*s", ("8 mPa*s", "12 mPa*s")),
        ("'../a.csv'", ("'../a.csv'",)),
    ],
)
def test_ranges_are_written_out(text: str, values: tuple[str, ...]) -> None:
    assert read_values(text) == values


@pytest.mark.parametrize(
    ("text", "problem"), [("1..2 / 1", "2 to 10000"), ("1..2/99999999", "2 to"), ("1 um..2 mm / 3", "two units")]
)
def test_a_faulty_range_is_refused(text: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        read_values(text)


def test_linked_keys_change_together() -> None:
    assert linked({"a": ("1", "2"), "b": ("3", "4")}) == ({"a": "1", "b": "3"}, {"a": "2", "b": "4"})
    with pytest.raises(InputError, match="a has 2, b has 1"):
        linked({"a": ("1", "2"), "b": ("3",)})


def test_a_bearing_is_found_by_its_name_and_all_by_a_star() -> None:
    case = load_case("turbocharger-car")
    names = [bearing.name for bearing in case.bearings]
    one = case.with_settings(f"bearing.{names[1]}.inner.clearance=21 um")
    assert [bearing.inner.clearance for bearing in one.bearings] == [case.bearings[0].inner.clearance, 21e-6]  # type: ignore[union-attr]
    both = case.with_settings("bearing.*.inner.clearance=22 um")
    assert [bearing.inner.clearance for bearing in both.bearings] == [22e-6, 22e-6]  # type: ignore[union-attr]
    assert load_case("jeffcott", ["bearing.*.clearance=30 um"]).bearings[0].clearance == 30e-6  # type: ignore[union-attr]
    with pytest.raises(InputError, match=rf"or name it: bearing.{names[0]}.width; bearing.\*.width is all of them"):
        case.with_settings("bearing.left.width=9 mm")
    with pytest.raises(InputError, match=r"bearing.0.inner.clearance.*must be"):
        case.with_settings("bearing.*.inner.clearance=-1 um")


# --- distributions ---


def column(points: tuple[dict[str, str], ...], key: str) -> np.ndarray:
    return np.array([float(point[key].split()[0]) for point in points])


def test_samples_have_the_distributions_they_are_of() -> None:
    given = {"a": "normal(35 um, 2 %)", "b": "uniform(8 mPa*s, 14 mPa*s)", "c": "truncated(1, 0.5, 0.8, 2)"}
    points = samples([read_distribution(key, text) for key, text in given.items()], 1024)  # type: ignore[misc]
    a, b, c = (column(points, key) for key in "abc")
    assert points[0]["a"].endswith(" um")
    shares = (np.arange(1024) + 0.5) / 1024
    np.testing.assert_allclose(np.sort(a), norm.ppf(shares, 35.0, 0.7), atol=0.25)
    np.testing.assert_allclose(np.sort(b), 8.0 + 6.0 * shares, atol=0.01)
    cut = truncnorm(-0.4, 2.0, 1.0, 0.5)
    assert c.min() >= 0.8
    assert c.mean() == pytest.approx(cut.mean(), rel=1e-3)
    assert c.std() == pytest.approx(cut.std(), rel=5e-3)
    assert np.max(np.abs(np.corrcoef([a, b, c]) - np.eye(3))) < 0.02


def test_correlated_keys() -> None:
    two = [read_distribution("a", "normal(0, 1)"), read_distribution("b", "normal(5, 2)")]
    points = samples(two, 1024, {("a", "b"): 0.8})  # type: ignore[arg-type]
    assert np.corrcoef(column(points, "a"), column(points, "b"))[0, 1] == pytest.approx(0.8, abs=0.01)
    assert column(points, "b").std() == pytest.approx(2.0, rel=0.01)
    assert samples(two, 8, seed=1) == samples(two, 8, seed=1) != samples(two, 8, seed=2)  # type: ignore[arg-type]
    three = [*two, read_distribution("c", "uniform(0, 1)")]
    impossible = {("a", "b"): 0.9, ("b", "c"): 0.9, ("a", "c"): -0.9}
    with pytest.raises(InputError, match="contradict each other"):
        samples(three, 8, impossible)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="names d, which does not scatter"):
        samples(three, 8, {("a", "d"): 0.5})  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"not a power of 2.*Write 64"):
        samples(three, 50)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("normal(35 um)", r"Write normal\(mean, deviation\)"),
        ("normal(35 um, 0 um)", "deviation that is not above 0"),
        ("uniform(2, 1)", "lower limit"),
        ("normal(35 um, 1 mm)", "several units"),
        ("truncated(1, 1, x, 2)", "not of its form"),
    ],
)
def test_a_faulty_distribution_is_refused(text: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        read_distribution("k", text)
    assert read_distribution("k", "35 um") is None
    assert read_distribution("k", "lognormal(1, 2)") is None


def test_a_correlation_is_read() -> None:
    assert read_correlation(" a.b , c.d = -0.5") == (("a.b", "c.d"), -0.5)
    for text in ("a=0.5", "a,b", "a,b=1.5", "a,b,c=0.5", "a,b=nan"):
        with pytest.raises(InputError, match="no correlation of two keys"):
            read_correlation(text)


# --- machines ---


def machines(speeds: list[float], values: list[float]) -> Sweep:
    """Points of a sweep, infinite speeds for those that do not whirl."""
    points = []
    for number, (speed, value) in enumerate(zip(speeds, values, strict=True), 1):
        events = ({"kind": "onset", "speed_Hz": speed, "frequency_Hz": None},) if math.isfinite(speed) else ()
        message = f"{NO_WHIRL} 300 Hz." if math.isinf(speed) else ""
        status = "not-converged" if math.isnan(speed) else "finished"
        points.append(SweepPoint(number, {"a": f"{value:.9g} um"}, status, message, events))
    return Sweep(load_case("jeffcott"), "runup", tuple(points))


def test_scatter_of_known_machines() -> None:
    """Speeds 100 + 2 a: the whole of the scatter is linear in a."""
    values = np.linspace(10.0, 50.0, 100)
    found = scatter(machines([*(100.0 + 2.0 * values), math.inf, math.nan], [*values, 60.0, 70.0]), 150.0)
    assert (found.count, found.left_out) == (101, 1)
    assert found.share == pytest.approx(np.count_nonzero(100.0 + 2.0 * values < 150.0) / 101)
    assert dict(found.percentiles)[50.0] == pytest.approx(100.0 + 2.0 * values[50], rel=1e-9)
    (one,) = found.sensitivities
    assert one.rank == pytest.approx(1.0)
    assert one.per_deviation_Hz == pytest.approx(2.0 * values.std())
    assert found.explained == pytest.approx(1.0)
    with pytest.raises(InputError, match="no machine has a result"):
        scatter(machines([math.nan], [1.0]))


def test_interval_of_a_share_is_wilsons() -> None:
    """Of Newcombe 1998, table I: 81 of 263 and 0 of 20."""
    assert _wilson(81 / 263, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert _wilson(0.0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)


def test_which_machines_whirl_by_the_linear_theory(tmp_path: Path) -> None:
    """Stable up to 20 Hz, or a threshold below 250 Hz."""
    case = load_case("jeffcott", [THEORY])
    points = [{"speed.to": "20 Hz"}, {"speed.to": "250 Hz"}]
    found = sweep(case, points, tmp_path / "s", "stability", workers=Workers(jobs=1))
    assert whirl_speed(found.points[0]) == math.inf
    assert 0.0 < whirl_speed(found.points[1]) < 250.0


def test_the_command_samples_machines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "jeffcott", "--stability", "--jobs", "1", "--set", THEORY]
    told = frb(*words, "--set", "bearing.clearance=normal(35 um, 1 um)", "--samples", "8", "--json", "--quiet").document
    seen = told["scatter"]
    assert (seen["count"], seen["share"]) == (8, 1.0)
    assert abs(seen["sensitivities"][0]["rank"]) == pytest.approx(1.0)
    assert seen["explained"] > 0.95
    assert Path(told["picture"]).exists()
    both = [*words, "--set", "oil.viscosity=uniform(8, 9)", "--set", "bearing.clearance=30 um,35 um"]
    assert "while other keys scatter" in frb(*both, "-o", "other", code=2).err


def test_the_command_takes_ranges_and_links_and_gives_reasons(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "jeffcott", "--stability", "--jobs", "1", "--set", THEORY, "-o", "s", "--no-picture"]
    told = frb(*words, "--set", "speed.to=20..250 Hz / 2; bearing.clearance=35 um,36 um").out
    assert "reason" in told
    assert "Stable" in told
    frb(*words, "--set", "a=1,2; b=1,2,3", code=2)


@pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra frbcli[cluster]")
@pytest.mark.filterwarnings("ignore")
def test_a_local_cluster_is_started_where_none_is_given(tmp_path: Path) -> None:
    case = load_case("jeffcott", [THEORY])
    found = sweep(case, {"bearing.clearance": ["34 um", "35 um"]}, tmp_path / "s", "stability",
                  workers=Workers("dask", 2))  # fmt: skip
    assert [point.status for point in found.points] == ["finished", "finished"]
