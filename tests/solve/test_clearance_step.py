"""Clearances that change during a run: it ends where the new one belongs, keeps its oil, and says what it cannot do."""

import math
from pathlib import Path

import numpy as np
import pytest
from plain_balances import net_flow
from resumed import assert_resumable

import frbcli
from frbcli.arrays import Array
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.equilibrium.resting import resting_position
from frbcli.film.cells.data import OIL
from frbcli.rotor.loads import speed_profile
from frbcli.runs.march import March
from frbcli.scene.changes import case_at
from frbcli.scene.machine.system import Segment, make_segments, make_system
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.state import FINISHED, RUNNING, State

STEADY = ["speed.from=60Hz", "speed.to=60Hz", "speed.duration=0.4s", "rotor.unbalance=0 kg*m", "output.step=0.5ms"]
RESTING = [*STEADY, "start.position=resting"]
CELLS = ["accuracy.mesh=[4,32]", "bearing.supply.pressure=2bar"]


def step_to(clearance: str, time: str = "0.1 s", key: str = "bearing") -> str:
    return f'{key}.clearance_steps=[{{time="{time}",clearance="{clearance}"}}]'


def under_way(case: Case) -> March:
    plan = make_plan(case)
    march = March(case, plan, make_segments(case, plan), run_up_profile(case))
    march.compile()
    return march


def finish(march: March) -> tuple[int, dict[str, Array]]:
    status, found = RUNNING, []
    while status == RUNNING:
        status, signals = march.chunk()
        found.append(signals)
    return status, {name: np.concatenate([part[name] for part in found]) for name in found[0]}


def test_profile_with_stops_is_the_same_profile() -> None:
    profile = speed_profile([0.0, 2.0, 3.0], [0.0, 400.0, 400.0])
    stopping = profile.with_stops([0.7, 2.0, 2.5, 3.0, 9.0])
    assert stopping.times.tolist() == [0.0, 0.7, 2.0, 2.5, 3.0]
    for t in (0.0, 0.3, 0.7, 1.9, 2.2, 2.8):
        assert stopping.rotation(t) == pytest.approx(profile.rotation(t), rel=1e-14)
    assert stopping.until(2.5).times.tolist() == [0.0, 0.7, 2.0, 2.5]
    assert stopping.until(2.5).angle(2.3) == pytest.approx(profile.angle(2.3), rel=1e-14)


def test_a_rotor_comes_to_rest_where_the_new_clearance_has_it() -> None:
    case = load_case("jeffcott", [*RESTING, "speed.duration=1.5s", step_to("25 um")])
    after = make_system(case_at(case, 1.0), make_plan(case))
    rests = np.hypot(*resting_position(after, 2.0 * math.pi * 60.0).journals[0]) / after.clearances[0]
    status, signals = finish(under_way(case))
    eccentricity, time = signals["eccentricity"], signals["time_s"]
    assert status == FINISHED
    assert np.ptp(eccentricity[time < 0.1]) < 1e-4
    assert abs(eccentricity[time < 0.1][0] - rests) > 0.1
    assert eccentricity[-1] == pytest.approx(rests, abs=2e-4)


@pytest.mark.parametrize("clearance", ["20 um", "100 um"])
def test_oil_stays_or_leaves_through_the_ends(clearance: str) -> None:
    case = load_case("jeffcott", [*RESTING, *CELLS, "film.cavitation=elrod", step_to(clearance)])
    march, segments = under_way(case), make_segments(case, make_plan(case))
    while march.time < 0.1:
        before = march.snapshot()
        status, _ = march.chunk()
    assert status == RUNNING
    after = march.snapshot()
    assert own_oil(segments[1], after) == pytest.approx(own_oil(segments[0], before), rel=1e-12)
    finish(march)
    end = march.snapshot()
    assert own_oil(segments[1], end) == pytest.approx(own_oil(segments[0], before), rel=1e-10)
    defect = march.error_so_far()["oil_balance_relative"]
    assert defect is not None
    assert defect < 1e-6


def own_oil(segment: Segment, snapshot: dict[str, Array]) -> float:
    """m^3 in the free cells of the only film, less what has come in since the beginning."""
    film, state = segment.system.films.with_fields[0], State(*(snapshot[name] for name in State._fields))
    inside = float((film.grid.area * state.wet[OIL, 0])[~film.grid.fixed].sum())
    return film.section.radius * film.section.width * film.section.clearance * (inside - net_flow(state, 0))


def test_a_shell_that_closes_upon_the_journal_is_contact(tmp_path: Path) -> None:
    case = load_case("jeffcott", [*RESTING, "film.cavitation=half-sommerfeld", "speed.from=10Hz", "speed.to=10Hz",
                                  step_to("10 um")])  # fmt: skip
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert (run.status, run.t_end_s) == ("contact", 0.1)
    assert [event["kind"] for event in run.events] == ["clearance-step", "contact"]


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("jeffcott", [step_to("45 um", "0.03 s")]),
        pytest.param(
            "jeffcott",
            ["film.coupling=co-simulation", "film.cavitation=two-phase", *CELLS, step_to("45 um", "0.03 s")],
            marks=pytest.mark.nightly,  # compiles a time loop that no other test has
        ),
        ("floating-ring", ["accuracy.mesh=[3,32]", step_to("60 um", "0.03 s", "bearing.outer")]),
    ],
    ids=["table", "co-simulation", "rings"],
)
def test_a_run_that_was_put_down_goes_on_with_the_same_clearance(
    name: str, settings: list[str], tmp_path: Path
) -> None:
    course = ["speed.duration=0.06s", "speed.from=20 Hz", "speed.to=21Hz", "output.step=0.1ms"]
    assert_resumable(load_case(name, [*course, *settings]), tmp_path, 0.02, 0.03, 0.04)


@pytest.mark.parametrize("change", [step_to("45 um", "0.03 s"), 'rotor.loss={time="0.03 s",unbalance="20 g*mm"}'])
def test_a_run_that_is_put_down_at_a_change_has_it(change: str, tmp_path: Path) -> None:
    """After each step, so that one look at the clock is at the moment of the change."""
    course = ["speed.duration=0.06s", "speed.from=20 Hz", "speed.to=21Hz", "output.step=0.1ms"]
    assert_resumable(load_case("jeffcott", [*course, change]), tmp_path, 0.02, 0.03, 0.04, steps=1)


@pytest.mark.nightly  # co-simulation beside the coupled loop: test_cosimulation
def test_coupled_in_turn_is_coupled_at_once(tmp_path: Path) -> None:
    """The journal jumps in the wider gap of a co-simulation as it does when rotor and film are solved together."""
    settings = ["speed.duration=0.1s", "speed.from=20 Hz", "speed.to=21Hz", step_to("45 um", "0.05 s")]
    both = [
        frbcli.runup(load_case("jeffcott", [*settings, f"film.coupling={coupling}"]), tmp_path / f"{coupling}.h5")
        for coupling in ("auto", "co-simulation")
    ]
    np.testing.assert_allclose(both[1]["eccentricity"], both[0]["eccentricity"], atol=5e-3)


def test_run_down_steps_too(tmp_path: Path) -> None:
    case = load_case("run-down", ["speed.duration=0.3s", "speed.to=60Hz", "speed.hold=0.1s", "speed.down_duration=0.2s",
                                  step_to("30 um", "0.35 s")])  # fmt: skip
    run = frbcli.rundown(case, tmp_path / "run.h5")
    assert run.status == "finished"
    (step,) = (event for event in run.events if event["kind"] == "clearance-step")
    assert step["speed_Hz"] == pytest.approx(60.0)
    assert run.references["clearance_m"] == 35e-6
    assert run.references["clearance_step_1_s"] == 0.35


def test_the_case_in_the_file_is_the_case(tmp_path: Path) -> None:
    steps = 'bearing.clearance_steps=[{time="0.02s",clearance="30um"},{time="0.03s",clearance="33um"}]'
    case = load_case("jeffcott", ["speed.duration=0.04s", "speed.to=30Hz", "output.step=1ms", steps])
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert load_case_text(run.case_text) == case
    assert [step.clearance for step in case.bearings[0].clearance_steps] == [30e-6, 33e-6]  # type: ignore[union-attr]
    assert [event["t_s"] for event in run.events if event["kind"] == "clearance-step"] == [0.02, 0.03]
