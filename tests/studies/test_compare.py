"""`frb compare`: the same run-up with several models of the films. Runs beside each other: the same as one after the
other, with progress and a clean end."""

import json
import os
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from commands import Frb
from synthetic_run import Rotor, as_run, signals

from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cavitation.table import names
from frbcli.plot.studies import comparison_figure
from frbcli.results.store import Run, check_output, read_run
from frbcli.runs import march
from frbcli.runs.march import Progress
from frbcli.runs.run import runup
from frbcli.studies.against import RunTask, in_turn, side_by_side
from frbcli.studies.compare import Comparison, Deviation, Variant, compare, deviation, make_variants

QUICK = ("speed.duration=0.4 s", "speed.from=20 Hz", "speed.to=120 Hz", "output.step=2e-4 s", "accuracy.mesh=[4, 48]")
HALF, FULL = "half-sommerfeld", "sommerfeld"


def quick_case(*settings: str) -> Case:
    return load_case("jeffcott", (*QUICK, *settings))


@pytest.fixture(scope="module")
def compared() -> Comparison:
    return compare(quick_case(), theories=["finite", "short"])


@pytest.mark.bitwise
def test_each_variant_is_the_run_of_its_models(compared: Comparison, tmp_path: Path) -> None:
    assert [result.variant for result in compared.results] == [Variant("finite", HALF), Variant("short", HALF)]
    alone = runup(quick_case("film.theory=short"), tmp_path / "short.h5")
    for name in alone.signals:
        np.testing.assert_array_equal(compared.results[1].run[name], alone[name])
    assert load_case_text(compared.results[1].run.case_text).film.theory == "short"


def test_deviation_is_from_the_first(compared: Comparison) -> None:
    first, other = compared.results
    apart = np.abs(first.run["eccentricity"] - other.run["eccentricity"])
    assert first.deviation == Deviation(0.0, 0.0, 0.4)
    assert other.deviation.largest == apart.max() > 0.01
    assert other.deviation.rms == pytest.approx(np.sqrt(np.mean(apart**2)))
    assert 0.0 < other.deviation.rms < other.deviation.largest


def whirling(at: float | None, eccentricity_off: float = 0.0, lasts: float = 1.0) -> Run:
    columns = signals(Rotor(duration_s=lasts, step_s=1e-3, whirl_s=None, critical_Hz=None))
    columns["eccentricity"] = columns["eccentricity"] + eccentricity_off * (columns["time_s"] > 0.5)
    onset = {"kind": "onset", "film": None, "t_s": at, "speed_Hz": 150.0, "frequency_Hz": 70.0, "frequency_ratio": 0.47}
    return replace(as_run(columns), events=[] if at is None else [onset])


@pytest.mark.parametrize(
    ("run", "reference", "largest", "until"),
    [
        (whirling(None, 0.1), whirling(None), 0.1, 1.0),
        (whirling(0.4, 0.1), whirling(None), 0.0, 0.4),
        (whirling(None, 0.1), whirling(0.4), 0.0, 0.4),
        (whirling(0.9, 0.1), whirling(0.7, -0.1), 0.2, 0.7),
    ],
)
def test_deviation_counts_before_the_first_whirl_of_either(
    run: Run, reference: Run, largest: float, until: float
) -> None:
    found = deviation(run, reference)
    assert found.until_s == until
    assert found.largest == pytest.approx(largest)
    share = max(0.0, until - 0.5) / until
    assert found.rms == pytest.approx(largest * np.sqrt(share), rel=5e-3)


def test_a_whirl_from_the_beginning_leaves_nothing_to_compare() -> None:
    found = deviation(whirling(0.0), whirling(None))
    assert np.isnan([found.largest, found.rms]).all()


# --- which models ---


def test_options_combine_and_repeat_nothing() -> None:
    case = quick_case("film.theory=short", f"film.cavitation={FULL}")
    assert make_variants(case, [HALF, FULL, HALF]) == (Variant("short", HALF), Variant("short", FULL))
    assert make_variants(case, [], ["finite", "short"]) == (Variant("finite", FULL), Variant("short", FULL))
    assert len(make_variants(case, [HALF, FULL], ["finite", "short"])) == 4
    everything = make_variants(case)
    assert everything[0] == Variant("short", FULL)
    assert len(set(everything)) == len(everything) == 4


def test_models_that_keep_oil_are_compared_where_they_are_asked_for() -> None:
    case = quick_case("film.theory=finite")
    assert make_variants(case, ["elrod", HALF]) == (Variant("finite", "elrod"), Variant("finite", HALF))
    assert {variant.cavitation for variant in make_variants(case)} == {HALF, FULL}


def test_models_that_do_not_fit_the_case_are_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"film[.]theory"):
        compare(quick_case("film.theory=short"), [HALF, "elrod"], keep=tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_every_unknown_model_is_named_with_what_there_is() -> None:
    with pytest.raises(InputError) as caught:
        make_variants(quick_case(), ["foam", FULL, "wet"], ["long"])
    faults = caught.value.faults
    assert [(fault.key, fault.value) for fault in faults] == [
        ("--cavitation", "foam"), ("--cavitation", "wet"), ("--theory", "long")
    ]  # fmt: skip
    assert f"There are: {', '.join(names())}." in faults[0].remedy
    assert "short, finite" in faults[2].remedy


@pytest.mark.parametrize("test", ["rotation", "polka"])
def test_other_tests_are_refused_before_any_work(test: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=test):
        compare(quick_case(), test=test, keep=tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


# --- files ---


def test_runs_are_kept_where_asked_for(tmp_path: Path) -> None:
    found = compare(quick_case("film.theory=short"), [HALF, FULL], keep=tmp_path / "a" / "b")
    names = ["half-sommerfeld-short.h5", "sommerfeld-short.h5"]
    assert sorted(os.listdir(tmp_path / "a" / "b")) == names
    for result, name in zip(found.results, names, strict=True):
        kept = read_run(tmp_path / "a" / "b" / name)
        np.testing.assert_array_equal(kept["eccentricity"], result.run["eccentricity"])


def test_a_directory_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="--keep"):
        compare(quick_case(), keep=tmp_path / "file" / "runs")


def test_ctrl_c_ends_the_comparison_with_the_run_under_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(march, "BUDGET", 60)
    seen: list[str] = []

    def observe(variant: Variant, number: int, count: int, _: Progress) -> None:
        assert 1 <= number <= count == 2
        seen.append(variant.name)
        if seen.count("sommerfeld short") == 2:
            signal.raise_signal(signal.SIGINT)

    found = compare(quick_case("film.theory=short"), [HALF, FULL], observe=observe)
    assert [result.run.status for result in found.results] == ["finished", "interrupted"]
    assert list(dict.fromkeys(seen)) == ["half-sommerfeld short", "sommerfeld short"]


# --- picture and command ---


def test_a_rotor_of_constant_speed_has_no_axis_of_speeds() -> None:
    found = compare(quick_case("speed.to=20 Hz", "film.theory=short"), [HALF, FULL])
    assert not comparison_figure(found).axes[0].child_axes


SETTINGS = [word for setting in QUICK for word in ("--set", setting)]


def test_command_says_one_json_document_one_table_one_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.chdir(tmp_path)
    said = frb("compare", "jeffcott", *SETTINGS, "--json")
    text = frb("compare", "jeffcott", *SETTINGS).out
    found = json.loads(said.out)
    assert list(found) == ["command", "case", "test", "results"]
    assert [found[key] for key in ("command", "case", "test")] == ["compare", "jeffcott", "runup"]
    assert len(found["results"]) == 4
    for result in found["results"]:
        assert list(result) == ["cavitation", "theory", "coupling", "status", "events", "deviation", "cost", "error"]
        assert result["coupling"] == "dynamic-static"
        assert list(result["deviation"]) == ["eccentricity_largest", "eccentricity_rms", "until_s"]
    assert max(map(len, text.splitlines())) <= 80
    assert all(f"{result['cavitation']} {result['theory']}" in text for result in found["results"])
    assert "stated error of the eccentricity" in text  # beside deviations of eccentricities no other
    errors = [line.split()[-2] for line in text.splitlines() if line.split()[:1] in ([HALF], [FULL])]
    stated = [f"{result['error']['eccentricity']:.0e}" for result in found["results"]]
    assert sorted(map(float, errors)) == sorted(map(float, stated))
    assert os.listdir() == ["jeffcott-compare.png"]
    assert Path("jeffcott-compare.png").read_bytes().startswith(b"\x89PNG")


def test_a_variant_that_ends_early_is_exit_3(frb: Frb) -> None:
    words = ["--theory", "short", "--cavitation", f"{HALF},{FULL}", "--no-picture", "--json"]
    said = frb("compare", "jeffcott", *SETTINGS, *words, "--set", "contact.eccentricity=0.75", code=3)
    words.remove("--json")
    text = frb("compare", "jeffcott", *SETTINGS, *words, "--set", "contact.eccentricity=0.75", code=3).out
    assert [result["status"] for result in json.loads(said.out)["results"]] == ["finished", "contact"]
    assert "sommerfeld short: contact at" in text


BRIEF = ("speed.from=20 Hz", "speed.to=120 Hz", "film.theory=short", "output.step=2e-4 s")
LAWS = ("half-sommerfeld", "sommerfeld")


def tasks(folder: Path, duration: str) -> list[RunTask]:
    settings = (*BRIEF, f"speed.duration={duration}")
    cases = [load_case("jeffcott", (*settings, f"film.cavitation={law}")) for law in LAWS]
    numbered = enumerate(cases, start=1)
    return [RunTask(number, "runup", case, folder / f"{number}.h5", False) for number, case in numbered]


def untold(number: int, progress: Progress) -> None:
    """Nobody listens."""


def test_runs_beside_each_other_are_those_one_after_the_other(tmp_path: Path) -> None:
    for name in ("alone", "beside"):
        (tmp_path / name).mkdir()
    (tmp_path / "beside" / "2.h5").write_text("not a run")  # in the way of the second one
    alone = dict(in_turn(tasks(tmp_path / "alone", "0.2 s"), untold))
    beside = dict(side_by_side(tasks(tmp_path / "beside", "0.2 s"), untold))
    first, second = alone[1], beside[1]
    assert isinstance(first, Run)
    assert isinstance(second, Run)
    assert list(first.signals) == list(second.signals)
    for signal_name in first.signals:
        np.testing.assert_array_equal(first[signal_name], second[signal_name])
    with pytest.raises(InputError) as expected:
        check_output(tmp_path / "beside" / "2.h5")
    assert isinstance(beside[2], InputError)
    assert beside[2].faults == expected.value.faults


def test_ctrl_c_ends_all_runs_under_way_as_it_does_one(tmp_path: Path) -> None:
    numbers: set[int] = set()

    def report(number: int, progress: Progress) -> None:
        numbers.add(number)
        assert progress.end_s == 400.0
        if numbers == {1, 2}:
            signal.raise_signal(signal.SIGINT)

    ended = dict(side_by_side(tasks(tmp_path, "400 s"), report))
    statuses = {number: run.status for number, run in ended.items() if isinstance(run, Run)}
    assert statuses == {1: "interrupted", 2: "interrupted"}
    assert sorted(file.name for file in tmp_path.iterdir()) == ["1.h5", "2.h5"]
