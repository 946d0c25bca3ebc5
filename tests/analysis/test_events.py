"""Events of made-up motions whose moments are known from their formulas."""

import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from ring_whirls import RingWhirl, ring_run
from scipy.special import expit
from synthetic_run import CLEARANCE, Rotor, as_run, make_run, signals

from frbcli.analysis import signals as signals_of_a_run
from frbcli.analysis import subsynchronous
from frbcli.analysis.events import WHIRL_BEGINS, Event, Kind, find_events
from frbcli.analysis.order_tracking import order_track
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.linear import critical_speeds
from frbcli.linear.critical_speeds import linear_critical_speeds
from frbcli.plot.summary import _words
from frbcli.results.columns import event_name
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.cost import CRITICAL_s, before_s
from frbcli.scene.planning.plan import make_plan
from frbcli.units import HERTZ


def found(rotor: Rotor, status: str = "finished") -> dict[str, Event]:
    """The events by kind, where each kind comes once."""
    events = find_events(make_run(rotor, status))
    assert len({event.kind for event in events}) == len(events)
    assert [event.t_s for event in events] == sorted(event.t_s for event in events)
    return {event.kind: event for event in events}


def onset_s(rotor: Rotor) -> float:
    """When the logistic growth of the whirl passes the threshold."""
    assert rotor.whirl_s is not None
    return float(rotor.whirl_s - np.log(rotor.whirl_amplitude / WHIRL_BEGINS - 1.0) / rotor.growth_1_s)


def slice_run(run: Run, until_s: float, status: str) -> Run:
    kept = run["time_s"] <= until_s
    return as_run({name: run[name][kept] for name in run.signals}, status)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_run_up_has_its_critical_speed_and_its_onset(noise: float) -> None:
    rotor = Rotor(noise=noise)
    events = found(rotor)
    assert set(events) == {"critical-speed", "onset"}
    critical, onset = events["critical-speed"], events["onset"]
    assert critical.speed_Hz == pytest.approx(145.4, abs=0.5 + 40 * noise)  # the peak of resonance at 5 % damping
    assert critical.t_s == pytest.approx(critical.speed_Hz / 30.0, abs=1e-6)
    assert (critical.frequency_Hz, critical.frequency_ratio) == (critical.speed_Hz, 1.0)
    assert onset.t_s == pytest.approx(onset_s(rotor), abs=0.01)
    assert onset.frequency_ratio == pytest.approx(0.465, abs=0.01)
    assert onset.frequency_Hz == pytest.approx(onset.frequency_ratio * onset.speed_Hz)
    assert onset.film is None


@pytest.mark.parametrize("growth_1_s", [15.0, 60.0, 300.0])
@pytest.mark.parametrize(("ratio", "lock_Hz"), [(0.47, 125.0), (0.35, 75.0), (0.3, 150.0)])
def test_onset_is_found_within_two_hundredths_of_a_second(growth_1_s: float, ratio: float, lock_Hz: float) -> None:
    rotor = Rotor(growth_1_s=growth_1_s, whirl_ratio=ratio, lock_Hz=lock_Hz)
    onset = found(rotor)["onset"]
    assert onset.t_s == pytest.approx(onset_s(rotor), abs=0.02 if growth_1_s > 20 else 0.05)
    expected = ((ratio * onset.speed_Hz) ** -8 + lock_Hz**-8) ** (-1 / 8)
    assert onset.frequency_Hz == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    "rotor",
    [
        Rotor(whirl_s=None),
        Rotor(whirl_s=None, noise=0.05),
        Rotor(whirl_s=None, unbalance_m=10e-6),
        Rotor(whirl_s=None, critical_Hz=None, noise=0.05),
        Rotor(whirl_s=None, critical_Hz=None, speeds_Hz=(200.0, 200.0), duration_s=3.0),
        Rotor(whirl_s=None, critical_Hz=None, speeds_Hz=(0.0, 0.0), duration_s=1.0),
        Rotor(whirl_s=None, critical_Hz=None, speeds_Hz=(300.0, 0.0)),
        Rotor(whirl_s=None, critical_Hz=None, duration_s=0.05),
    ],
    ids=str,
)
def test_a_run_without_whirl_has_no_onset(rotor: Rotor) -> None:
    expected = set() if rotor.critical_Hz is None else {"critical-speed"}
    assert set(found(rotor)) == expected


@pytest.mark.parametrize("critical_Hz", [None, 330.0, 600.0])
def test_a_monotone_rise_is_no_critical_speed(critical_Hz: float | None) -> None:
    assert found(Rotor(critical_Hz=critical_Hz, whirl_s=None)) == {}
    assert set(found(Rotor(critical_Hz=critical_Hz))) == {"onset"}


@pytest.mark.parametrize("critical_Hz", [60.0, 100.0, 170.0])
def test_critical_speed_is_found_where_it_is(critical_Hz: float) -> None:
    assert found(Rotor(critical_Hz=critical_Hz))["critical-speed"].speed_Hz == pytest.approx(critical_Hz, rel=0.01)


def test_critical_speed_is_found_from_the_journal_alone() -> None:
    columns = signals(Rotor(unbalance_m=2e-6))
    run = as_run({name: values for name, values in columns.items() if not name.startswith("disk")})
    critical = next(event for event in find_events(run) if event.kind == "critical-speed")
    assert critical.speed_Hz == pytest.approx(145.4, abs=1.0)


def _ramp(folder: Path, rate: float, unbalance: float) -> Run:
    """A run of the Jeffcott rotor through its critical speed into its whirl."""
    settings = ("speed.from=100 Hz", "speed.to=185 Hz", f"speed.duration={85.0 / rate} s", "output.step=0.2 ms")
    return runup(load_case("jeffcott", [*settings, f"rotor.unbalance={unbalance} g*mm"]), folder / "run.h5")


SHORT = {(24.0, 10), (24.0, 50), (5.0, 15), (5.0, 40)}  # ramp in Hz/s, unbalance in g mm


@pytest.mark.parametrize(
    ("rate", "unbalance"),
    [
        pytest.param(rate, size, marks=() if (rate, size) in SHORT else pytest.mark.nightly)
        for rate in (24.0, 5.0, 1.4, 0.35)
        for size in (10, 15, 25, 40, 50)
    ],
)
def test_the_critical_speed_is_the_largest_synchronous_motion_whatever_comes_after(
    rate: float, unbalance: float, tmp_path: Path
) -> None:
    """A whirl that begins at 167 to 181 Hz cuts off the far side of the peak, the sooner the slower the ramp."""
    run = _ramp(tmp_path, rate, unbalance)
    (critical,) = (event for event in run.events if event["kind"] == "critical-speed")
    track = order_track(run, 1.0, "disk")
    before = track.speed_Hz < 165.0
    largest = int(np.argmax(track.amplitude("forward")[before]))
    assert critical["speed_Hz"] == pytest.approx(track.speed_Hz[before][largest], abs=1.0)
    assert critical["point"] == "disk"


@pytest.mark.parametrize(
    ("speeds", "there"),
    [
        ((120.0, 160.0), True),
        ((143.0, 180.0), False),
        pytest.param((120.0, 204.0), True, marks=pytest.mark.nightly),
        pytest.param((130.0, 204.0), True, marks=pytest.mark.nightly),
    ],
)
def test_a_run_that_begins_beside_its_resonance_has_its_critical_speed(
    speeds: tuple[float, float], there: bool, tmp_path: Path
) -> None:
    """The amplitude is largest at 141 Hz; it rises by less than a quarter before, and there is no peak from 143 Hz."""
    first, last = speeds
    settings = (f"speed.from={first} Hz", f"speed.to={last} Hz", f"speed.duration={(last - first) / 1.4} s")
    run = runup(load_case("jeffcott", [*settings, "rotor.unbalance=20 g*mm"]), tmp_path / "run.h5")
    criticals = [event["speed_Hz"] for event in run.events if event["kind"] == "critical-speed"]
    assert criticals == ([pytest.approx(141.0, abs=0.5)] if there else [])


@pytest.mark.parametrize("damping", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("whirl_s", [6.0, 6.5, 8.0])
def test_a_whirl_soon_after_a_damped_resonance_leaves_its_critical_speed(damping: float, whirl_s: float) -> None:
    """145 Hz are passed after 4.8 s, the peak is at 145 Hz / sqrt(1 - 2 damping^2)."""
    event = found(Rotor(damping=damping, whirl_s=whirl_s))["critical-speed"]
    assert event.speed_Hz == pytest.approx(145.0 / np.sqrt(1.0 - 2.0 * damping**2), abs=1.5)


@pytest.mark.parametrize("whirl_s", [3.0, 4.0])
def test_a_whirl_before_the_peak_leaves_no_critical_speed(whirl_s: float) -> None:
    assert "critical-speed" not in found(Rotor(damping=0.1, whirl_s=whirl_s))


@pytest.mark.parametrize(("kinds", "point"), [(("disk", "journal"), "disk"), (("journal",), "journal")])
def test_an_event_names_the_point_that_shows_it(kinds: tuple[str, ...], point: str) -> None:
    columns = {name: values for name, values in signals(Rotor()).items() if name.startswith((*kinds, "time", "speed"))}
    critical, onset = find_events(as_run(columns))
    assert (critical.point, onset.point) == (point, "journal")


@pytest.mark.parametrize(
    ("kind", "film", "point", "told"),
    [
        ("touch", None, "ring", "ring touches its pin"),
        ("lift-off", None, "ring_turbine", "ring turbine leaves its pin"),
        ("touch", "inner", None, "asperities touch, inner"),
        ("lift-off", None, None, "asperities part"),
        ("contact", None, "collar", "collar touches pads"),
        ("contact", "inner", None, "contact inner"),
        ("onset", None, "ring_turbine", "onset ring turbine"),
    ],
)
def test_an_event_says_who_touches_what(kind: Kind, film: str | None, point: str | None, told: str) -> None:
    event = asdict(Event(kind, film, 1.0, 50.0, None, None, point))
    assert event_name(event) == told
    assert kind == "onset" or _words(event, HERTZ) == f"{told}\n50.0 Hz"


def test_resonance_after_the_onset_of_whirl_is_not_told_as_critical_speed() -> None:
    assert set(found(Rotor(critical_Hz=250.0))) == {"onset"}


def test_whirl_that_ends_has_an_offset() -> None:
    up = Rotor()
    run = make_run(up)
    mirrored = {name: np.concatenate([run[name], run[name][-2::-1]]) for name in run.signals}
    # played backwards a motion turns backwards: mirror it to turn forward again
    half = len(run["time_s"])
    mirrored["time_s"] = np.arange(2 * half - 1) * up.step_s
    for node in ("journal", "disk"):
        mirrored[f"{node}_x_m"][half:] *= -1.0
    onset, offset = (event for event in find_events(as_run(mirrored)) if event.kind in ("onset", "offset"))
    assert (onset.kind, offset.kind) == ("onset", "offset")
    assert offset.t_s == pytest.approx(2 * up.duration_s - onset.t_s, abs=0.01)
    assert offset.frequency_ratio == pytest.approx(onset.frequency_ratio, abs=0.01)


@pytest.mark.parametrize(("begins_s", "seen"), [(0.0, [3.0]), (-1.0, [-0.5, 3.0]), (1e9, [])])
def test_a_clearance_that_changed_outside_of_the_run_is_no_event(begins_s: float, seen: list[float]) -> None:
    columns = signals(Rotor(critical_Hz=None, whirl_s=None, step_s=1e-3))
    run = as_run(columns | {"time_s": columns["time_s"] + begins_s})
    run.references.update({"clearance_step_1_s": -0.5, "clearance_step_2_s": 3.0, "clearance_step_3_s": 99.0})
    assert [event.t_s for event in find_events(run) if event.kind == "clearance-step"] == seen


def test_a_short_burst_is_no_whirl() -> None:
    columns = signals(Rotor(whirl_s=None))
    burst = 0.3 * CLEARANCE * np.exp(-(((columns["time_s"] - 6.0) / 0.015) ** 2))
    angle = np.pi * np.cumsum(columns["speed_Hz"]) * 5e-5
    columns["journal_x_m"] += burst * np.cos(angle)
    columns["journal_y_m"] += burst * np.sin(angle)
    assert {event.kind for event in find_events(as_run(columns))} == {"critical-speed"}


def test_backward_motion_is_no_whirl() -> None:
    columns = signals(Rotor(critical_Hz=None))
    columns["journal_x_m"] = -columns["journal_x_m"]
    assert "onset" not in {event.kind for event in find_events(as_run(columns))}


def test_a_run_that_stops_in_contact_shows_onset_and_contact() -> None:
    run = slice_run(make_run(), 6.56, "contact")
    events = {event.kind: event for event in find_events(run)}
    assert set(events) == {"critical-speed", "onset", "contact"}
    assert events["onset"].t_s == pytest.approx(onset_s(Rotor()), abs=0.01)
    assert events["contact"].t_s == run["time_s"][-1]
    assert {event.kind for event in find_events(replace(run, status="interrupted"))} == {"critical-speed"}


def test_a_bouncing_journal_is_one_contact() -> None:
    columns = signals(Rotor(whirl_s=None, critical_Hz=None))
    for moment in (3.0, 3.01, 3.05, 7.0):
        columns["eccentricity"][round(moment / 5e-5)] = 1.0
    contacts = find_events(as_run(columns))
    assert [event.kind for event in contacts] == ["contact", "contact"]
    np.testing.assert_allclose([event.t_s for event in contacts], [3.0, 7.0])
    assert contacts[1].speed_Hz == pytest.approx(210.0)


def test_each_bearing_has_its_own_events() -> None:
    calm, restless = signals(Rotor(whirl_s=None, critical_Hz=None)), signals(Rotor(critical_Hz=None))
    columns = {"time_s": calm["time_s"], "speed_Hz": calm["speed_Hz"]}
    for bearing, motion in (("left", calm), ("right", restless)):
        columns |= {f"journal_{bearing}_{axis}_m": motion[f"journal_{axis}_m"] for axis in "xy"}
        columns[f"eccentricity_{bearing}"] = motion["eccentricity"]
    events = find_events(as_run(columns))
    assert [(event.kind, event.film) for event in events] == [("onset", "right")]


def test_an_empty_run_has_no_events() -> None:
    assert find_events(as_run({name: values[:0] for name, values in signals(Rotor(duration_s=0.1)).items()})) == ()


def test_events_do_not_depend_on_the_pieces_that_a_run_is_read_in(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [make_run(Rotor(noise=0.01)), ring_run(RingWhirl("inner", 0.5, 2.0, 150.0), noise=0.02)]
    whole = [find_events(run) for run in runs]
    for module in (signals_of_a_run, subsynchronous):
        monkeypatch.setattr(module, "PIECE", 1777)
    for run, events in zip(runs, whole, strict=True):
        again = find_events(run)
        assert [(event.kind, event.film) for event in again] == [(event.kind, event.film) for event in events]
        for one, other in zip(again, events, strict=True):
            assert (one.t_s, one.speed_Hz) == pytest.approx((other.t_s, other.speed_Hz), rel=1e-9)


# ------------------------------------------------------------------- critical speeds and what is none
STARVED = Rotor(critical_Hz=86.0, damping=0.05, whirl_s=None)


def with_own_vibration(frequency_Hz: float = 86.0, begin_s: float = 2.9, end_s: float = 3.7, size: float = 0.2) -> Run:
    """A resonance at 86 Hz after which the journal goes on to vibrate with a frequency of its own."""
    columns = signals(STARVED)
    time_s = columns["time_s"]
    there = expit(60.0 * (time_s - begin_s)) * expit(60.0 * (end_s - time_s))
    for node in ("journal", "disk"):
        columns[f"{node}_x_m"] += size * CLEARANCE * there * np.cos(2 * np.pi * frequency_Hz * time_s)
    return as_run(columns)


def knowing(run: Run, *critical_speeds_Hz: float) -> Run:
    """The run with the critical speeds of its linearised machine."""
    known = {f"critical_speed_{number}_Hz": speed for number, speed in enumerate(critical_speeds_Hz, start=1)}
    return replace(run, references=run.references | {"critical_speeds": len(known)} | known)


@pytest.mark.parametrize("references", [(), (142.0, 145.0), None])
def test_a_vibration_that_keeps_its_frequency_is_self_excited_and_no_critical_speed(
    references: tuple[float, ...] | None,
) -> None:
    run = with_own_vibration()
    events = find_events(run if references is None else knowing(run, *references))
    assert [event.kind for event in events] == ["self-excited"]
    assert events[0].frequency_Hz == pytest.approx(86.0, abs=1.0)
    assert 2.8 < events[0].t_s < 3.2
    assert events[0].frequency_ratio == pytest.approx(events[0].frequency_Hz / events[0].speed_Hz)


def test_what_rings_on_with_a_mode_of_the_machine_is_the_end_of_its_resonance() -> None:
    events = find_events(knowing(with_own_vibration(), 86.0))
    assert [event.kind for event in events] == ["critical-speed"]
    assert events[0].speed_Hz == pytest.approx(86.2, abs=7.0)  # both interfere


def test_a_resonance_away_from_every_mode_is_no_critical_speed() -> None:
    run = make_run(STARVED)
    assert [event.kind for event in find_events(run)] == ["critical-speed"]
    assert [event.kind for event in find_events(knowing(run, 80.0, 142.0))] == ["critical-speed"]
    assert find_events(knowing(run, 142.0)) == ()
    assert find_events(knowing(run)) == ()


def test_a_short_ringing_is_not_self_excited() -> None:
    assert [event.kind for event in find_events(with_own_vibration(end_s=3.0))] == ["critical-speed"]


def test_a_starved_film_has_no_critical_speed_where_its_journal_vibrates(tmp_path: Path) -> None:
    """jeffcott-two-phase with 30 Hz/s past the 84 Hz of its mode on the starved film; the rotor's critical speed is 143
    Hz. The vibration is seen near 0.8 of the speed, between the orders of a whirl and of a self-excited vibration."""
    around = ("speed.from=80 Hz", "speed.to=122 Hz", "speed.duration=1.4 s", "accuracy.mesh=[6, 48]")
    run = runup(load_case("jeffcott-two-phase", around), tmp_path / "run.h5")
    (event,) = find_events(run)
    assert event.kind in ("self-excited", "onset")
    assert (event.speed_Hz, event.frequency_Hz) == (pytest.approx(112.0, abs=5.0), pytest.approx(88.5, abs=2.0))
    assert run.error["quiet_until_s"] == pytest.approx(0.85 * event.t_s)


def test_a_self_excited_vibration_is_the_same_in_a_mirror() -> None:
    run = with_own_vibration()
    columns = {name: run[name] * (-1.0 if name.endswith("_y_m") or name == "speed_Hz" else 1.0) for name in run.signals}
    (event,), (mirrored,) = find_events(run), find_events(as_run(columns))
    assert (mirrored.kind, mirrored.t_s, mirrored.speed_Hz) == (event.kind, event.t_s, -event.speed_Hz)
    assert mirrored.frequency_ratio == pytest.approx(event.frequency_ratio)


def test_a_run_of_any_length_has_events_or_none() -> None:
    """Also one that is as long as a window, or a step longer."""
    columns = signals(Rotor(speeds_Hz=(100.0, 100.0), duration_s=0.5, whirl_s=None, critical_Hz=None))
    for revolutions in (0.01, 1.0, 4.0, 8.0, 16.0, 32.0):
        for samples in range(-30, 31, 10):
            count = round(revolutions * 200) + samples
            assert find_events(as_run({name: values[: max(count, 0)] for name, values in columns.items()})) == ()


@pytest.mark.parametrize("damping", [0.02, 0.05, 0.2])
def test_a_resonance_that_is_passed_at_any_damping_is_a_critical_speed(damping: float) -> None:
    events = find_events(knowing(make_run(Rotor(damping=damping, whirl_s=None)), 145.0))
    assert [event.kind for event in events] == ["critical-speed"]


@pytest.mark.parametrize("kind", ["jeffcott", "jeffcott-two-phase"])
def test_linear_critical_speeds_are_those_of_the_full_film(kind: str) -> None:
    """The rotor on rigid supports: sqrt(5e6 / 6) rad/s = 145.3 Hz; the films make it a little softer."""
    found = linear_critical_speeds(load_case(kind))
    assert found
    np.testing.assert_allclose(found, 143.5, atol=1.5)


def test_linear_critical_speeds_on_cells_are_those_of_the_mesh_of_static_results(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They take a quarter of the cells, and an announced time."""
    case = load_case("jeffcott", ['bearing.supply={kind="bores", count=3, diameter="3 mm", pressure="2 bar"}'])
    found = linear_critical_speeds(case)
    meshes: list[tuple[int, int]] = []

    def fine(case: Case, coarse: bool) -> StaticMachines:
        coarsest = StaticMachines(case, coarse=coarse)
        meshes.append(coarsest.static.own.plan.cells or (0, 0))
        return StaticMachines(case)

    monkeypatch.setattr(critical_speeds, "StaticMachines", fine)
    assert found == pytest.approx(linear_critical_speeds(case), rel=1e-4)
    assert meshes == [(72, 10)]
    assert before_s(case, make_plan(case)) >= CRITICAL_s


def test_linear_critical_speeds_of_a_fast_ramp_and_of_a_rigid_rotor() -> None:
    fast = linear_critical_speeds(load_case("jeffcott", ["speed.to=3 kHz"]))
    assert fast
    np.testing.assert_allclose(fast, 143.5, atol=1.5)
    assert linear_critical_speeds(load_case("rigid")) == ()
    assert linear_critical_speeds(load_case("floating-ring")) is None


@pytest.mark.nightly
@pytest.mark.timing
def test_two_hundred_thousand_samples_take_less_than_half_a_second() -> None:
    run = make_run()
    assert len(run) > 200_000
    start = time.perf_counter()
    find_events(run)
    assert time.perf_counter() - start < 0.5
