"""Events of floating rings: whirls of inner and outer films, lock-in, and what is none."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from ring_whirls import ROOM, RingWhirl, ring_run
from synthetic_run import CLEARANCE, Rotor, as_run, make_run, signals

from frbcli.analysis.events import Event, find_events
from frbcli.analysis.subsynchronous import whirl_names, whirls
from frbcli.analysis.uncertainty import BETWEEN


def kinds(events: tuple[Event, ...]) -> list[tuple[str, str | None]]:
    return [(event.kind, event.film) for event in events if event.kind != "critical-speed"]


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_inner_whirl_locks_into_a_mode_and_the_outer_one_follows(noise: float) -> None:
    run = ring_run(RingWhirl("inner", 0.5, 2.0, 150.0), RingWhirl("outer", 2.3, 9.0, 1e3), noise=noise)
    events = [event for event in find_events(run) if event.kind != "critical-speed"]
    assert kinds(tuple(events)) == [("onset", "inner"), ("lock-in", "inner"), ("offset", "inner"), ("onset", "outer")]
    onset, lock_in, offset, outer = events
    assert onset.t_s == pytest.approx(0.5 - np.log(0.3 / 0.025) / 100.0, abs=0.03)
    assert onset.frequency_Hz == pytest.approx(0.625 * onset.speed_Hz, rel=0.05)  # seen is rather what grows after it
    assert lock_in.t_s == pytest.approx(150.0 / 0.95 / 187.5, abs=0.02)  # 5 % below the line of the free whirl
    assert lock_in.frequency_Hz == pytest.approx(150.0, rel=0.02)
    assert offset.t_s == pytest.approx(2.0 + np.log(0.3 / 0.0125) / 100.0, abs=0.04)
    assert outer.frequency_Hz == pytest.approx(0.125 * outer.speed_Hz, rel=0.03)
    assert outer.frequency_ratio == pytest.approx(0.125, rel=0.03)
    assert whirl_names([asdict(event) for event in events]) == ["Sub_i"] * 3 + ["Sub_o"]


@pytest.mark.parametrize("rings", [True, False])
def test_an_event_moves_with_the_motion_also_between_two_steps_of_the_search(rings: bool) -> None:
    """The same motion a part of a step later: windows of rings are 10 ms apart. What is read moves as much, to 3 % of a
    step, and the frequency of the onset with the speed, to a fiftieth of a line of the windows."""

    def moved(by_s: float) -> dict[str, Event]:
        if rings:
            run = ring_run(RingWhirl("inner", 0.5 + by_s, 2.0 + by_s, 1e3))
        else:
            run = make_run(Rotor(critical_Hz=None, whirl_s=6.5 + by_s))
        return {event.kind: event for event in find_events(run)}

    first, ramp, step_s = moved(0.0), *((300.0, 0.01) if rings else (30.0, 1.0 / (8 * 194.0)))
    for later_s in (0.1 * step_s, 0.3 * step_s, 0.5 * step_s, 0.9 * step_s):
        for kind, event in moved(later_s).items():
            assert event.t_s - first[kind].t_s == pytest.approx(later_s, abs=BETWEEN * step_s)
        onset = first["onset"]
        frequency = onset.frequency_ratio * ramp * later_s
        assert moved(later_s)["onset"].frequency_Hz - onset.frequency_Hz == pytest.approx(frequency, abs=0.2)


def test_three_whirls_of_a_turbocharger_have_their_names() -> None:
    """Conical, then cylindrical, then the outer film; the second goes on beside the third."""
    run = ring_run(
        RingWhirl("inner", 0.3, 1.0, 100.0),
        RingWhirl("inner", 1.0, 9.0, 260.0),
        RingWhirl("outer", 2.5, 9.0, 1e3, 0.1),
        name="turbine",
    )
    events = find_events(run)
    named = {
        (event.kind, name): event
        for event, name in zip(events, whirl_names([asdict(event) for event in events]), strict=True) if name
    }  # fmt: skip
    assert set(named) == {("onset", "Sub 1"), ("lock-in", "Sub 1"), ("offset", "Sub 1"), ("onset", "Sub 2"),
                          ("lock-in", "Sub 2"), ("onset", "Sub 3")}  # fmt: skip
    assert {event.film for event in events if event.film} == {"turbine_inner", "turbine_outer"}
    assert named["offset", "Sub 1"].t_s == pytest.approx(1.0, abs=0.05)
    assert named["onset", "Sub 2"].t_s == pytest.approx(1.0, abs=0.06)
    assert named["onset", "Sub 2"].frequency_Hz == pytest.approx(187.5, rel=0.05)
    assert named["onset", "Sub 3"].t_s == pytest.approx(2.5, abs=0.05)


@pytest.mark.parametrize("faster", [1.0, 16.0])
def test_whirls_are_found_in_a_run_of_any_length(faster: float) -> None:
    """All speeds and frequencies so many times as high: r T^2 is the same, and so are the events."""
    slow = ring_run(RingWhirl("inner", 0.5, 2.0, 150.0), RingWhirl("outer", 2.3, 9.0, 1e3))
    columns = {name: slow[name] for name in slow.signals}
    columns["time_s"] = columns["time_s"] / faster
    for name in ("speed_Hz", "ring_speed_Hz"):
        columns[name] = columns[name] * faster
    events = find_events(replace(as_run(columns), references=slow.references))
    expected = [event for event in find_events(slow) if event.kind != "critical-speed"]
    found = [event for event in events if event.kind != "critical-speed"]
    assert kinds(tuple(found)) == kinds(tuple(expected))
    for event, other in zip(found, expected, strict=True):
        assert faster * event.t_s == pytest.approx(other.t_s, abs=0.011)  # a window further, at most
        assert event.frequency_Hz == pytest.approx(faster * other.frequency_Hz, rel=0.02)


def test_combinations_of_two_whirls_are_no_whirls() -> None:
    two = ring_run(RingWhirl("inner", 0.3, 9.0, 100.0), RingWhirl("inner", 1.2, 9.0, 1e3, 0.5))
    difference = two["journal_x_m"] + 1j * two["journal_y_m"]
    made = 0.1 * difference * np.abs(difference / ROOM) ** 2  # contains 2 f_1 - f_2 and 2 f_2 - f_1
    columns = {name: two[name] for name in two.signals}
    columns |= {"journal_x_m": (difference + made).real, "journal_y_m": (difference + made).imag}
    events = find_events(replace(as_run(columns), references=two.references))
    assert [kind for kind in kinds(events) if kind[0] == "onset"] == [("onset", "inner")] * 2


def test_the_fall_of_the_start_is_no_whirl_that_grows_out_of_it() -> None:
    """It whirls with the films, fades to less than a whirl, and is never lost before one grows: the onset is that of
    the growth, as of a run that begins at rest."""
    faint, grown = RingWhirl("inner", -9.0, 9.0, 1e3, 0.017), RingWhirl("inner", 0.8, 9.0, 1e3)
    fall = RingWhirl("inner", -9.0, 0.25, 1e3, 0.06)
    (onset, *_), (of_rest, *_) = (find_events(ring_run(*whirls)) for whirls in ((faint, grown, fall), (faint, grown)))
    assert (onset.kind, of_rest.kind) == ("onset", "onset")
    assert 0.7 < onset.t_s == pytest.approx(of_rest.t_s, abs=1e-3)


def test_a_whirl_of_the_start_that_grows_begins_there_although_it_fades_and_returns() -> None:
    """Behind its end a faint motion goes on, out of which it grows once more."""
    faint, again = RingWhirl("inner", -9.0, 9.0, 1e3, 0.017), RingWhirl("inner", 2.0, 9.0, 1e3)
    onset, *_ = find_events(ring_run(faint, again, RingWhirl("inner", 0.15, 1.2, 1e3, 0.5)))
    assert onset.kind == "onset"
    assert onset.t_s < 0.3


def test_rings_without_whirl_have_no_events() -> None:
    assert kinds(find_events(ring_run())) == []
    assert kinds(find_events(ring_run(noise=0.05))) == []
    assert kinds(find_events(ring_run(RingWhirl("inner", 1.0, 1.02, 1e3)))) == []  # a burst


def test_the_film_that_touches_is_the_one_that_ends_a_run() -> None:
    run = ring_run()
    columns = {name: run[name] for name in run.signals}
    columns["eccentricity_inner"] = np.full(len(run), 0.4)
    columns["eccentricity_outer"] = np.linspace(0.1, 0.99, len(run))
    events = find_events(replace(as_run(columns, "contact"), references=run.references))
    assert kinds(events) == [("contact", "outer")]


def test_a_bump_without_a_change_of_phase_is_no_critical_speed() -> None:
    """A film that runs dry lets the unbalance move the journal more for a while; nothing resonates."""
    quiet = Rotor(critical_Hz=None, whirl_s=None)
    columns = signals(quiet)
    turn = 2 * np.pi * np.cumsum(columns["speed_Hz"]) * quiet.step_s
    size = 0.01 * (1.0 + 2.0 * np.exp(-(((columns["time_s"] - 4.0) / 0.5) ** 2)))
    for name in ("journal", "disk"):
        columns[f"{name}_x_m"] = columns[f"{name}_x_m"] + size * CLEARANCE * np.cos(turn)
        columns[f"{name}_y_m"] = columns[f"{name}_y_m"] + size * CLEARANCE * np.sin(turn)
    assert find_events(as_run(columns)) == ()


def test_a_rotor_that_turns_the_other_way_round_has_the_same_events() -> None:
    columns = signals(Rotor())
    mirrored = {name: -values if name.endswith("_y_m") or name == "speed_Hz" else values
                for name, values in columns.items()}  # fmt: skip
    expected, found_here = find_events(as_run(columns)), find_events(as_run(mirrored))
    assert [event.kind for event in found_here] == [event.kind for event in expected] == ["critical-speed", "onset"]
    for event, one in zip(found_here, expected, strict=True):
        assert event.t_s == one.t_s
        assert event.speed_Hz == -one.speed_Hz
        assert event.frequency_ratio == pytest.approx(one.frequency_ratio)


def test_events_of_a_run_are_whirls_from_where_they_begin_to_where_they_end() -> None:
    """Two whirls of one film, of which the first one ends while the second one lasts, and one of another film."""
    told = (("onset", "left_inner", 10.0), ("onset", "left_outer", 12.0), ("lock-in", "left_inner", 14.0),
            ("onset", "left_inner", 20.0), ("offset", "left_inner", 21.0), ("critical-speed", "", 22.0))  # fmt: skip
    events = [{"kind": kind, "film": film, "speed_Hz": speed} for kind, film, speed in told]
    found = whirls(events)
    assert [(whirl.name, whirl.film, whirl.begin["speed_Hz"]) for whirl in found] == [
        ("Sub 1", "left_inner", 10.0), ("Sub 2", "left_outer", 12.0), ("Sub 3", "left_inner", 20.0)
    ]  # fmt: skip
    assert [whirl.locked and whirl.locked["speed_Hz"] for whirl in found] == [14.0, None, None]
    assert [whirl.end and whirl.end["speed_Hz"] for whirl in found] == [21.0, None, None]
