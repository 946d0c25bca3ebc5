"""`frb accuracy`: the ladder, its reference, its front, table and picture."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.errors import InputError, NotConverged
from frbcli.linear.stability import stability
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.planning.plan import make_plan
from frbcli.studies import accuracy as accuracy_module
from frbcli.studies.accuracy import AccuracyLadder, Rung, RungError, RungResult, accuracy, ladder, planned_rung

QUICK = ("speed.duration=0.4 s", "speed.from=20 Hz", "speed.to=60 Hz", "output.step=2e-4 s", "accuracy.mesh=[4, 48]")
UNTIL = 0.1


@pytest.fixture(scope="module")
def found() -> AccuracyLadder:
    return accuracy(load_case("jeffcott", QUICK), UNTIL)


def test_the_reference_is_finer_and_says_how_sure_it_is(found: AccuracyLadder) -> None:
    reference, change = found.reference, found.reference.error
    assert reference.rung.mesh == (8, 96)
    assert found.coarser.mesh == (6, 72)
    assert found.coarser.tolerance == pytest.approx(2.0 * reference.rung.tolerance)
    assert 0.0 < change.eccentricity_rms < change.eccentricity_largest
    planned = next(item for item in found.ladder if item.planned)
    assert change.eccentricity_largest < 0.5 * planned.error.eccentricity_largest


def test_errors_are_those_of_the_runs(found: AccuracyLadder, tmp_path: Path) -> None:
    """The short bearing carries less than the finite one: its error is that of the theory, whatever the tolerance."""
    short = [item.error for item in found.ladder if item.rung.theory == "short"]
    assert all(error.eccentricity_largest > 0.01 and error.force_relative > 0.1 for error in short)
    assert all(item.error.until_s == UNTIL for item in found.ladder)
    end = 20.0 + 40.0 * UNTIL / 0.4
    settings = [*QUICK, f"speed.duration={UNTIL} s", f"speed.to={end} Hz"]
    fine = load_case("jeffcott", [*settings, "accuracy.mesh=[8, 96]", "accuracy.tolerance=2e-7"])
    exact = runup(fine, tmp_path / "a.h5")
    own = runup(load_case("jeffcott", settings), tmp_path / "b.h5")
    planned = next(item for item in found.ladder if item.planned)
    apart = np.abs(own["eccentricity"] - exact["eccentricity"])
    assert planned.error.eccentricity_largest == pytest.approx(apart.max(), rel=1e-6)


def test_thresholds_are_those_of_linear_stability() -> None:
    """Of the whole case, whatever the run is cut to; the short bearing's is another one, the tolerance has none."""
    course = ["speed.from=150 Hz", "speed.to=200 Hz", "speed.duration=0.01 s", "output.step=1e-4 s"]
    quick = [*course, "accuracy.mesh=[4, 48]"]
    case = load_case("jeffcott", quick)
    found = accuracy(case, 0.005)
    error = {(item.rung.theory, item.rung.mesh): item.error.threshold_Hz for item in found.ladder}
    fine, short = (stability(load_case("jeffcott", [*quick, setting])).threshold
                   for setting in ("accuracy.mesh=[8, 96]", "film.theory=short"))
    assert fine is not None
    assert short is not None
    assert error["short", None] == pytest.approx(short.speed_Hz - fine.speed_Hz, abs=1e-6)
    assert 0.0 < abs(error["finite", (4, 48)]) < abs(error["finite", (2, 24)])
    assert len(error) == 4


def test_a_rotor_that_does_not_turn_has_no_threshold() -> None:
    course = ["speed.from=0 Hz", "speed.to=0 Hz", "speed.duration=0.01 s", "output.step=1e-4 s"]
    found = accuracy(load_case("jeffcott", [*course, "accuracy.mesh=[2, 24]"]), theories=["finite"])
    assert found.complete
    assert all(np.isnan(item.error.threshold_Hz) for item in (found.reference, *found.ladder))


def made(cpu_s: float, error: float) -> RungResult:
    rung = Rung("finite", "half-sommerfeld", (1, 12), 1e-5, "dynamic-static")
    return RungResult(rung, "finished", cpu_s, RungError(error, error, 1.0, np.nan, np.nan))


def test_the_front_is_what_nothing_cheaper_beats(found: AccuracyLadder) -> None:
    results = [made(1.0, 0.1), made(2.0, 0.2), made(3.0, 0.01), made(4.0, 0.01), made(5.0, np.nan)]
    assert replace(found, ladder=tuple(results)).front == (results[0], results[2])


def test_distance_from_the_front(found: AccuracyLadder) -> None:
    """The choice of the plan costs three times as much as what is closer, and as much as nothing that is less close."""
    planned = replace(made(3.0, 0.1), planned=True, work_s=2.0)
    loose, tight = (replace(planned.rung, tolerance=tolerance) for tolerance in (1e-3, 1e-6))
    cheap = replace(made(0.5, 0.2), rung=loose, work_s=0.1)
    few = replace(found, ladder=(cheap, replace(made(1.0, 0.05), rung=tight, work_s=1.6), planned))
    assert few.above_front() == pytest.approx(3.0)
    assert few.above_front(quiet=True) == pytest.approx(1.25)
    assert replace(found, ladder=(cheap, planned)).above_front() == 1.0
    at_once, free = replace(cheap, cpu_s=0.0, error=planned.error), replace(planned, cpu_s=0.0)
    assert replace(found, ladder=(at_once, planned)).above_front() == np.inf  # runs that end at once cost nothing
    assert replace(found, ladder=(at_once, free)).above_front() == 1.0
    unknown = replace(planned, error=replace(planned.error, eccentricity_largest=np.nan))
    assert np.isnan(replace(found, ladder=(cheap, unknown)).above_front())


def test_a_film_without_a_short_theory_has_no_such_rung() -> None:
    case = load_case("jeffcott", [*QUICK, "film.cavitation=reynolds"])
    rungs = list(ladder(case, planned_rung(make_plan(case))))
    assert {rung.theory for rung in rungs} == {"finite"}
    with pytest.raises(InputError, match="short"):
        list(ladder(case, planned_rung(make_plan(case)), theories=["short"]))


def test_a_rung_that_does_not_begin_leaves_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    real = accuracy_module.runup

    def begins_but_on_short_films(case: Case, *arguments: Any, **named: Any) -> Run:
        if case.film.theory == "short":
            raise NotConverged("the film has no resting position")
        return real(case, *arguments, **named)

    monkeypatch.setattr(accuracy_module, "runup", begins_but_on_short_films)
    found = accuracy(load_case("jeffcott", QUICK), 0.02, ["short", "finite"])
    assert found.complete
    assert {item.rung.theory for item in found.ladder} == {"finite"}
    assert {rung.theory for rung, _ in found.failed} == {"short"}
    assert {problem for _, problem in found.failed} == {"the film has no resting position"}


GAS = ("film.cavitation=bubbly", "bearing.supply.pressure=2 bar", "accuracy.mesh=[4, 24]", "output.step=1e-3 s")


def test_a_ladder_of_bubbly_oil_stands_on_a_reference_that_a_finer_run_confirms(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On three times the cells of the plan. Gas that goes upwind with the oil leaves an error of first order: that of
    the reference, on 8 cells along, is 1/8 over 1/6 - 1/8 times its change on 6, and errors are known to so much."""
    monkeypatch.setattr(accuracy_module, "TOLERANCES", (1.0,))
    course = ("speed.from=80 Hz", "speed.to=80 Hz", "speed.duration=0.01 s")
    case = load_case("rigid", [*GAS, *course])
    found = accuracy(case)
    assert found.complete
    assert not found.failed
    assert {item.rung.theory for item in found.ladder} == {"finite"}
    fine = runup(case.with_settings("accuracy.mesh=[12, 72]", "accuracy.tolerance=1e-6"), tmp_path / "fine.h5")
    blur = 3.0 * found.reference.error.eccentricity_largest
    errors = {item.rung.mesh: item.error for item in found.ladder}
    own = runup(case.with_settings("accuracy.mesh=[2, 12]"), tmp_path / "own.h5")
    true = np.abs(own["eccentricity"] - fine["eccentricity"]).max()
    assert true == pytest.approx(errors[2, 12].eccentricity_largest, abs=blur)
    assert blur < 0.5 * errors[2, 12].eccentricity_largest
    assert errors[6, 36].eccentricity_largest < 0.5 * errors[2, 12].eccentricity_largest
    assert errors[6, 36].force_relative < 0.5 * errors[2, 12].force_relative


def test_a_ladder_at_a_given_flow_has_the_errors_that_a_finer_run_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While the line of the supply empties: on three times the cells of the plan, to the error of the reference."""
    monkeypatch.setattr(accuracy_module, "TOLERANCES", (1.0,))
    supply = "bearing.supply={kind='circumferential-groove', pressure='3 bar', flow=4e-7}"
    settings = ("film.cavitation=elrod", supply, "accuracy.mesh=[4, 24]", "output.step=1e-3 s")
    case = load_case("rigid", [*settings, "speed.from=80 Hz", "speed.to=80 Hz", "speed.duration=0.02 s"])
    found = accuracy(case)
    assert found.complete
    assert not found.failed
    blur = found.reference.error.eccentricity_largest
    fine = runup(case.with_settings("accuracy.mesh=[12, 72]", "accuracy.tolerance=1e-6"), tmp_path / "fine.h5")
    assert fine["supply_pressure_Pa"].min() < 2e5
    errors = {item.rung.mesh: item.error.eccentricity_largest for item in found.ladder}
    for along, around in ((2, 12), (4, 24), (6, 36)):
        path = tmp_path / f"{along}.h5"
        own = runup(case.with_settings(f"accuracy.mesh=[{along}, {around}]"), path)
        true = np.abs(own["eccentricity"] - fine["eccentricity"]).max()
        assert true == pytest.approx(errors[along, around], abs=blur)
    assert blur < 0.2 * errors[2, 12]


def test_names_that_there_are_not() -> None:
    with pytest.raises(InputError) as caught:
        accuracy(load_case("jeffcott", QUICK), theories=["long"], couplings=["glue"])
    assert [fault.key for fault in caught.value.faults] == ["--theory", "--coupling"]


def test_a_run_shorter_than_a_sample_is_refused() -> None:
    with pytest.raises(InputError, match="output step"):
        accuracy(load_case("jeffcott", QUICK), 1e-5)


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "a.png"
    settings = [part for setting in QUICK for part in ("--set", setting)]
    options = ["--until", "0.02 s", "--theory", "short", "--json", "-o", str(picture)]
    code = frb(["accuracy", "jeffcott", *settings, *options])
    out = capsys.readouterr()
    code = frb(["accuracy", "jeffcott", *settings, *[word for word in options if word != "--json"]])
    text = capsys.readouterr().out
    document = json.loads(out.out)
    assert code == 0
    assert picture.stat().st_size > 10_000
    assert set(document["ladder"][0]) >= {
        "theory", "cavitation", "mesh", "tolerance", "coupling", "cpu_s", "error", "planned"}
    assert document["reference"]["change"]["window_s"] == [0.0, 0.02]
    assert sum(item["planned"] for item in document["ladder"]) == 1
    assert "Pareto" in text
    assert document["ladder"][0]["stated"]["eccentricity"] > 0.0
    assert "times Pareto's front" in text
