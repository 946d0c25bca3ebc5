"""Run-up and run-down as a library: what a run holds, how it ends, how a broken one goes on."""

import math
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba.core.event import trigger_event
from resumed import assert_same, interrupt_after

from frbcli.analysis.events import find_events
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.compiled import COMPILE
from frbcli.errors import InputError, NotConverged
from frbcli.results.store import Run, read_run
from frbcli.runs import march
from frbcli.runs import run as run_module
from frbcli.runs.march import Progress
from frbcli.runs.run import rundown, runup

SHORT = ("film.theory=short", "speed.duration=0.4 s", "speed.to=120 Hz")
WAVY = (*SHORT, "speed.from=60 Hz", "rotor.unbalance=60 g*mm")  # much moves, and the critical speed is near
COST = {"cpu_s", "error_cpu_s", "compile_cpu_s", "predicted_cpu_s", "wall_s", "steps", "rejected_steps",
        "steps_per_revolution", "film_solves", "ms_per_film_solve", "simulated_ms_per_hour"}  # fmt: skip
SECOND = {"second_run_cpu_s", "second_run_predicted_cpu_s"}  # of a run that has ended, the former if it was made


def short_case(*settings: str) -> Case:
    return load_case("jeffcott", (*SHORT, *settings))


def plain(event: dict[str, Any]) -> dict[str, Any]:
    """An event without what the second run says of it."""
    second = ("uncertainty", "uncertainty_Hz", "certain", "reason")
    return {name: value for name, value in event.items() if not name.endswith(second)}


def found_again(run: Run) -> list[dict[str, Any]]:
    """The events in the signals of a run."""
    return [plain(asdict(event)) for event in find_events(run)]


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks at the clock so often that a short run has many of them."""
    monkeypatch.setattr(march, "BUDGET", 60)


# --- what a run holds ---


def test_runup_holds_its_signals_and_tells_its_cost_and_error(tmp_path: Path) -> None:
    case = short_case("output.step=1e-4 s")
    run = runup(case, tmp_path / "run.h5")
    assert (run.status, run.command, run.t_end_s) == ("finished", "runup", 0.4)
    np.testing.assert_allclose(run["time_s"], np.arange(4001) * 1e-4, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run["speed_Hz"], 300.0 * run["time_s"], rtol=0, atol=1e-9)
    from_centre = np.hypot(run["journal_x_m"], run["journal_y_m"]) / 35e-6
    np.testing.assert_allclose(run["eccentricity"], from_centre, rtol=1e-12)
    assert run["disk_y_m"][-1] < run["journal_y_m"][-1]  # the shaft sags
    known = {name: value for name, value in run.references.items() if not name.startswith("critical_speed")}
    assert known == {"clearance_m": 35e-6, "contact_eccentricity": 0.9999}
    critical = [run.references[f"critical_speed_{number + 1}_Hz"] for number in range(len(run.references) - 3)]
    assert run.references["critical_speeds"] == len(critical) > 0
    np.testing.assert_allclose(critical, 143.5, atol=1.5)  # of the linearised machine; the run ends just below
    assert load_case_text(run.case_text) == case
    assert COST <= set(run.cost) <= COST | SECOND
    assert run.cost["steps_per_revolution"] > 40
    assert 0.0 < run.error["time_integration"] < 1e-3
    assert run.error["film_force_relative"] > 0.01  # the short bearing is a short bearing
    assert run.error["oil_balance_relative"] is None
    assert_same(read_run(tmp_path / "run.h5"), run)


def test_rundown_goes_up_holds_and_goes_down(tmp_path: Path) -> None:
    settings = ("speed.from=10 Hz", "speed.hold=0.1 s", "speed.down_duration=0.2 s", "output.step=1 ms")
    run = rundown(short_case(*settings), tmp_path / "run.h5")
    assert (run.command, run.status, run.t_end_s) == ("rundown", "finished", pytest.approx(0.7))
    corners = np.interp(run["time_s"], [0.0, 0.4, 0.5, 0.7], [10.0, 120.0, 120.0, 10.0])
    np.testing.assert_allclose(run["speed_Hz"], corners, rtol=0, atol=1e-9)


def test_rundown_without_a_hold_turns_at_once(tmp_path: Path) -> None:
    run = rundown(short_case("speed.hold=0 s", "speed.duration=0.1 s", "output.step=1 ms"), tmp_path / "run.h5")
    assert run.t_end_s == pytest.approx(0.2)
    assert run["speed_Hz"].max() == pytest.approx(120.0)


# --- how a run ends ---


def test_contact_ends_the_run_and_keeps_it(tmp_path: Path) -> None:
    run = runup(short_case("contact.eccentricity=0.6", "speed.from=5 Hz"), tmp_path / "run.h5")
    assert run.status == "contact"
    assert 0.0 < run.t_end_s < 0.4
    assert [event["kind"] for event in run.events] == ["contact"]
    assert run["time_s"][-1] <= run.t_end_s
    assert_same(read_run(tmp_path / "run.h5"), run)


def test_elastic_contact_lets_the_run_finish(tmp_path: Path) -> None:
    settings = ("contact.policy=elastic", "contact.stiffness=1e8 N/m", "contact.eccentricity=0.6", "speed.from=5 Hz")
    run = runup(short_case(*settings), tmp_path / "run.h5")
    assert run.status == "finished"
    assert 0.6 < run["eccentricity"].max() < 1.0


def test_a_tolerance_that_cannot_be_met_ends_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    control_of = march.control_of  # no case may ask for so much
    monkeypatch.setattr(march, "control_of", lambda *given: control_of(*given)._replace(tolerance=1e-60))
    run = runup(short_case(), tmp_path / "run.h5")
    assert run.status == "not-converged"
    assert run.t_end_s < 0.4
    assert read_run(tmp_path / "run.h5").status == "not-converged"


def test_what_is_compiled_while_the_clock_runs_is_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that only the second call of the time loop needs, as in a first start."""
    calls, advance = count(), march.advance

    def compile_late(*given: Any) -> Any:
        if next(calls) == 2:
            with trigger_event(COMPILE):
                until = time.process_time() + 0.3  # from within: what is measured has begun before
                while time.process_time() < until:
                    pass
        return advance(*given)

    monkeypatch.setattr(march, "advance", compile_late)
    cost = runup(short_case(), tmp_path / "run.h5").cost
    assert next(calls) > 3
    assert cost["compile_cpu_s"] >= 0.3
    assert cost["cpu_s"] < 0.3 > cost["wall_s"]


# --- interruption and resumption ---


@pytest.mark.usefixtures("small_chunks")
def test_an_interrupted_run_goes_on_to_the_same_numbers(tmp_path: Path) -> None:
    case = load_case("jeffcott", WAVY)
    whole = runup(case, tmp_path / "whole.h5")
    broken = tmp_path / "broken.h5"
    handler = signal.getsignal(signal.SIGINT)
    reached = [0.0]
    for calls in (1, 5, 3):
        run = runup(case, broken, resume=True, observe=interrupt_after(calls))
        assert run.status == read_run(broken).status == "interrupted"
        assert run.t_end_s == read_run(broken).t_end_s > reached[-1]
        reached.append(run.t_end_s)
        assert signal.getsignal(signal.SIGINT) is handler
    assert reached[-1] < 0.4
    assert_same(runup(case, broken, resume=True), whole)
    assert_same(read_run(broken), whole)


WHIRLING = ("film.theory=short", "speed.from=60 Hz", "speed.to=250 Hz", "speed.duration=3 s")


@pytest.mark.usefixtures("small_chunks")
def test_an_interrupted_run_has_its_events_and_the_error_of_its_quiet_time(tmp_path: Path) -> None:
    """After the onset of the whirl, which the error must not reach beyond."""
    case, broken = load_case("jeffcott", WHIRLING), tmp_path / "broken.h5"
    whole = runup(case, tmp_path / "whole.h5")
    onset_s = whole.events[1]["t_s"]

    def interrupt(progress: Progress) -> None:
        if progress.t_s > onset_s + 0.4:
            signal.raise_signal(signal.SIGINT)

    run = runup(case, broken, observe=interrupt)
    assert run.status == "interrupted"
    assert onset_s + 0.4 < run.t_end_s < 3.0
    assert found_again(run) == [plain(event) for event in run.events]
    assert [event["kind"] for event in run.events] == ["critical-speed", "onset"]
    for event, same in zip(run.events, whole.events, strict=True):
        assert (event["t_s"], event["speed_Hz"]) == pytest.approx((same["t_s"], same["speed_Hz"]), rel=1e-6)
    assert run.error["quiet_until_s"] == pytest.approx(0.85 * onset_s)
    assert run.error["eccentricity"] == pytest.approx(whole.error["eccentricity"], rel=0.2)
    written = read_run(broken)
    assert (written.events, written.error, written.status) == (run.events, run.error, "interrupted")
    assert_same(runup(case, broken, resume=True), whole)


@pytest.mark.usefixtures("small_chunks")
def test_an_interrupted_run_does_not_wait_for_an_error_that_takes_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who interrupts wants an end: an error that takes longer than WAIT_s is left for the end of the run."""
    monkeypatch.setattr(run_module, "WAIT_s", 0.0)
    broken = runup(short_case(), tmp_path / "run.h5", observe=interrupt_after(2))
    assert broken.status == "interrupted"
    assert broken.error["film_force_relative"] is None
    assert "eccentricity" not in broken.error
    whole = runup(short_case(), tmp_path / "run.h5", resume=True)
    assert whole.error["eccentricity"] > 0.0


def test_steps_that_take_longer_than_planned_are_interrupted_as_soon(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clock is looked at so often that nobody waits, whatever a step costs."""
    slow, looks = 0.002, list[float]()

    def advance_slowly(*arguments: Any) -> tuple[int, int]:
        time.sleep(slow * arguments[5])  # the budget of steps
        return real(*arguments)

    real = march.advance
    monkeypatch.setattr(march, "advance", advance_slowly)
    runup(short_case(), tmp_path / "run.h5", observe=lambda _: looks.append(time.monotonic()))
    waits = np.diff(looks)
    assert len(waits) > 10
    assert waits.max() < 5 * march.CHUNK_s


@pytest.mark.usefixtures("small_chunks")
def test_checkpoints_do_not_change_the_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case("jeffcott", ("speed.hold=0.05 s", *WAVY[:1], "speed.duration=0.1 s", *WAVY[2:]))
    whole = rundown(case, tmp_path / "whole.h5")
    monkeypatch.setattr(run_module, "CHECKPOINT_EVERY_s", 0.0)
    monkeypatch.setattr(run_module, "CHECKPOINT_SHARE", np.inf)
    files = []

    def look(_: Progress) -> None:
        files.append(read_run(tmp_path / "often.h5"))

    assert_same(rundown(case, tmp_path / "often.h5", observe=look), whole)
    assert len({len(file) for file in files}) > 5
    assert {file.status for file in files} == {"interrupted"}


def test_a_run_killed_before_its_first_checkpoint_starts_anew(tmp_path: Path) -> None:
    case, path = short_case(), tmp_path / "run.h5"
    whole = runup(case, tmp_path / "whole.h5")
    with pytest.raises(ZeroDivisionError):
        runup(case, path, observe=lambda _: 1 / 0)
    assert read_run(path).checkpoint is None
    assert_same(runup(case, path, resume=True), whole)


def test_resuming_a_finished_run_returns_it_untouched(tmp_path: Path) -> None:
    case, path = short_case(), tmp_path / "run.h5"
    run = runup(case, path)
    before = path.read_bytes()
    assert_same(runup(case, path, resume=True), run)
    assert path.read_bytes() == before


def test_resuming_without_a_file_is_a_new_run(tmp_path: Path) -> None:
    assert runup(short_case(), tmp_path / "run.h5", resume=True).status == "finished"


@pytest.mark.usefixtures("small_chunks")
@pytest.mark.parametrize(("settings", "again"), [(("oil.viscosity=13 mPa*s",), runup), ((), rundown)])
def test_only_the_same_run_can_be_resumed(
    tmp_path: Path, settings: tuple[str, ...], again: Callable[..., Run]
) -> None:
    path = tmp_path / "run.h5"
    runup(short_case(), path, observe=interrupt_after(2))
    before = path.read_bytes()
    with pytest.raises(InputError, match="another case"):
        again(short_case(*settings), path, resume=True)
    assert path.read_bytes() == before


def test_a_run_outside_of_the_main_thread_leaves_signals_alone(tmp_path: Path) -> None:
    found: list[object] = []
    handler = signal.getsignal(signal.SIGINT)

    def work() -> None:
        found.append(runup(short_case(), tmp_path / "run.h5", observe=lambda _: found.append(None)))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert isinstance(found[-1], Run)
    assert found[-1].status == "finished"
    assert signal.getsignal(signal.SIGINT) is handler


@pytest.mark.usefixtures("small_chunks")
def test_progress_counts_up_to_the_end(tmp_path: Path) -> None:
    seen: list[Progress] = []
    run = runup(short_case(), tmp_path / "run.h5", observe=seen.append)
    assert len(seen) > 10
    assert all(later.t_s >= sooner.t_s for sooner, later in pairwise(seen))
    assert seen[-1].t_s == seen[-1].end_s == run.t_end_s
    assert seen[-1].left_s == 0.0
    assert seen[-1].speed_Hz == pytest.approx(120.0)
    assert seen[-1].eccentricity == pytest.approx(run["eccentricity"][-1])
    assert seen[-1].steps == run.cost["steps"]


def test_the_time_left_is_not_known_from_the_first_steps() -> None:
    """A run of 1 s began with "58:36 left": its first steps, from rest, are the shortest."""
    assert march.time_left(0.0, 10.0, 0.5) == math.inf
    assert march.time_left(3e-5, 10.0, 0.01) == math.inf
    assert march.time_left(0.2, 10.0, 0.01) == pytest.approx(0.49)
    assert march.time_left(1e-3, 10.0, 2.0) == pytest.approx(2e4 - 2.0)
    assert march.time_left(10.0, 10.0, 3.0) == 0.0


# --- where it cannot be written ---


def test_output_in_no_directory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        runup(short_case(), tmp_path / "nowhere" / "run.h5")


@pytest.mark.parametrize("resume", [False, True])
def test_a_foreign_file_is_left_alone(tmp_path: Path, resume: bool) -> None:
    path = tmp_path / "notes.h5"
    path.write_text("years of work")
    with pytest.raises(InputError, match="not replaced"):
        runup(short_case(), path, resume=resume)
    assert path.read_text() == "years of work"


# --- where it starts ---


def test_a_rotor_that_starts_resting_stays_there(tmp_path: Path) -> None:
    settings = ("rotor.unbalance=0 g*mm", "speed.from=25 Hz", "speed.to=25 Hz", "start.position=resting")
    run = runup(short_case(*settings), tmp_path / "run.h5")
    for name in ("journal_x_m", "journal_y_m", "disk_x_m", "disk_y_m"):
        assert np.ptp(run[name]) < 1e-5 * 35e-6
    assert run["eccentricity"][0] > 0.1
    centred = runup(short_case(*settings[:3], "speed.duration=2 s"), tmp_path / "centred.h5")
    assert centred["eccentricity"][0] == 0.0
    assert centred["eccentricity"][-1] == pytest.approx(run["eccentricity"][0], rel=1e-3)  # and there it belongs


def test_no_resting_position_at_standstill(tmp_path: Path) -> None:
    with pytest.raises(NotConverged, match="static equilibrium"):
        runup(short_case("start.position=resting"), tmp_path / "run.h5")


def test_a_rotor_starts_where_its_journal_is_held(tmp_path: Path) -> None:
    run = runup(short_case("start.displacement=[0.3, -0.4]"), tmp_path / "run.h5")
    assert run["eccentricity"][0] == pytest.approx(0.5)
    assert run["journal_x_m"][0] == pytest.approx(0.3 * 35e-6)
    assert run["journal_y_m"][0] == pytest.approx(-0.4 * 35e-6)
    sag = 6.0 * 9.81 / 5e6
    assert run["disk_y_m"][0] == pytest.approx(run["journal_y_m"][0] - sag)
    assert run["disk_x_m"][0] == pytest.approx(run["journal_x_m"][0])
