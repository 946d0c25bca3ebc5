"""Uncertainties of events by hand: which events of two runs belong together, and what their differences say."""

from dataclasses import asdict
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from synthetic_run import Rotor, as_run, make_run

from frbcli.analysis.events import WHIRL_BEGINS, find_events
from frbcli.analysis.uncertainty import (
    BETWEEN,
    BY_SHARE,
    FAINT,
    NEAR,
    NEAR_REVOLUTIONS,
    SAFETY,
    SMALLER,
    STUDENT,
    TRIMMED,
    partners,
    slow_uncertainties,
    with_uncertainties,
)
from frbcli.results.store import Run

RAMP = 30.0  # Hz/s of the synthetic run


@pytest.fixture(scope="module")
def run() -> Run:
    return make_run(Rotor())


def event(t_s: float, kind: str = "onset", frequency_Hz: float = 90.0, **more: Any) -> dict[str, Any]:
    speed = RAMP * t_s
    return {"kind": kind, "film": None, "t_s": t_s, "speed_Hz": speed, "frequency_Hz": frequency_Hz,
            "frequency_ratio": frequency_Hz / speed, "point": "journal", "amplitude": 0.8, **more}  # fmt: skip


def test_what_agrees_by_chance_is_as_uncertain_as_the_other_whirls(run: Run) -> None:
    """Four whirls that are 1, 1, 1 % and nothing off."""
    own = [event(t) for t in (4.0, 5.0, 6.0, 7.0)]
    second = [event(t) for t in (4.04, 5.05, 6.06, 7.0)]
    found = with_uncertainties(run, own, second)
    usual = TRIMMED * 0.01 * (2.0 / 3.0) ** 0.5  # by the root mean square of 0, 1 and 1 %, three of the four
    assert found[3]["speed_uncertainty_Hz"] == pytest.approx(SAFETY * STUDENT[2] / STUDENT[0] * usual * 210.0)
    assert found[0]["speed_uncertainty_Hz"] == pytest.approx(0.5 * BY_SHARE * 0.01 * 120.0)
    on_cells = with_uncertainties(run, own, second, share=1.2)  # no more than of a whirl that is alone
    assert on_cells[0]["speed_uncertainty_Hz"] == pytest.approx(SAFETY * 0.01 * 120.0)


@pytest.mark.parametrize(("whirls", "runs", "median"), [(1, 1600, 6.5), (4, 400, 5.0)])
def test_normal_errors_of_half_the_differences_are_held_in_nine_of_ten_cases(
    run: Run, whirls: int, runs: int, median: float
) -> None:
    """Of a single whirl that is Student's t of one degree of freedom: no factor of one difference holds as many with a
    median below 6.3 times the errors."""
    rng, ratios = np.random.default_rng(1), []
    for _ in range(runs):
        own = [event(t) for t in (4.0, 5.0, 6.0, 7.0)[:whirls]]
        second = [event(each["t_s"] * (1.0 + 0.01 * rng.normal())) for each in own]
        for each in with_uncertainties(run, own, second):
            ratios.append(each["speed_uncertainty_Hz"] / (0.005 * each["speed_Hz"] * abs(rng.normal())))
    assert np.mean(np.array(ratios) >= 1.0) > 0.88
    assert np.median(ratios) < median


def test_a_whirl_that_grows_out_of_the_error_of_the_run_is_later_with_a_smaller_one(run: Run) -> None:
    """It grows by exp(60 t) to 0.8 of the clearance: out of a hundredth of its seed it takes ln(100) / 60 s more, in
    which the ramp rises by 2.3 Hz. What is above the error from the start has no such seed."""
    (onset,) = [each for each in map(asdict, find_events(run)) if each["kind"] == "onset"]
    later = RAMP * np.log(SMALLER) / 60.0
    grown = with_uncertainties(run, [onset], [onset], amplitude=1e-3)[0]
    assert grown["speed_uncertainty_Hz"] == pytest.approx(later, rel=0.1)
    assert grown["frequency_uncertainty_Hz"] == pytest.approx(onset["frequency_ratio"] * later, rel=0.1)
    assert with_uncertainties(run, [onset], [onset])[0]["speed_uncertainty_Hz"] < 0.1 * later


def test_an_event_of_a_ring_is_resolved_by_its_windows(run: Run) -> None:
    """A ramp of 30 Hz/s takes the longest windows, of 0.1 s, every 0.01 s. Moments that are equal may stand in the same
    window; those that are not lie between two."""
    ring = event(6.0, film="inner")
    found = with_uncertainties(run, [ring], [ring])[0]
    assert found["speed_uncertainty_Hz"] == pytest.approx(0.3)
    assert found["frequency_uncertainty_Hz"] == pytest.approx(0.5 * 0.3)
    apart = with_uncertainties(run, [ring], [event(6.0001, film="inner")])[0]
    assert apart["speed_uncertainty_Hz"] == pytest.approx(BETWEEN * 0.3)
    touch = ring | {"kind": "contact", "frequency_Hz": None, "frequency_ratio": None, "amplitude": None}
    assert with_uncertainties(run, [touch], [touch])[0]["frequency_uncertainty_Hz"] is None


def test_a_step_of_the_clearance_is_given(run: Run) -> None:
    step = event(6.0, "clearance-step") | {"frequency_Hz": None, "amplitude": None}
    assert with_uncertainties(run, [step], [step])[0]["speed_uncertainty_Hz"] == 0.0


def test_a_contact_is_not_certain_where_the_journal_has_long_been_as_near_as_its_eccentricity_is_uncertain() -> None:
    """The whirl of the synthetic run has an eccentricity of 0.8 to 0.9 long before 8 s, and 0.3 before 6 s."""
    ended = make_run(Rotor(), "contact")
    for t_s, amplitude, certain in ((8.0, 0.01, True), (8.0, 0.3, False), (6.0, 0.3, True)):
        touch = event(t_s, "contact") | {"frequency_Hz": None, "amplitude": None}
        (found,) = with_uncertainties(ended, [touch], [touch], amplitude)
        assert found["certain"] is certain
        assert ("grazes" in (found["reason"] or "")) is not certain


def test_a_contact_has_no_frequency(run: Run) -> None:
    touch = event(6.0, "contact") | {"frequency_Hz": None, "amplitude": None}
    found = with_uncertainties(run, [touch], [touch | {"t_s": 6.01, "speed_Hz": 180.3}])[0]
    assert found["speed_uncertainty_Hz"] == pytest.approx(SAFETY * 0.3)
    assert (found["frequency_uncertainty_Hz"], found["amplitude_uncertainty"]) == (None, None)
    assert found["certain"] is False  # it does not end the run
    ended = make_run(Rotor(), "contact")
    assert with_uncertainties(ended, [touch], [touch])[0]["certain"] is True


@pytest.mark.parametrize(
    ("second", "words"),
    [
        ([], "not in the second run"),
        ([event(6.0, "offset")], "not in the second run"),
        ([event(6.0, point="disk")], "not in the second run"),
        ([event(6.0 * (1.0 + 2.0 * NEAR))], "at 216 Hz in the second run: it starts from round-off, or is near a fold"),
    ],
)
def test_an_event_that_the_second_run_lacks_is_not_certain(run: Run, second: list[Any], words: str) -> None:
    found = with_uncertainties(run, [event(6.0)], second)[0]
    assert found["certain"] is False
    assert words in found["reason"]
    assert "speed_uncertainty_Hz" not in found


def test_a_motion_that_comes_and_goes_is_chaotic(run: Run) -> None:
    own = [event(5.0 + 0.3 * i) for i in range(4)]
    found = with_uncertainties(run, own, [own[0]])
    assert [one["certain"] for one in found] == [True, False, False, False]
    assert "chaotic" in found[1]["reason"]


def test_a_faint_whirl_is_not_certain_even_if_both_runs_have_it(run: Run) -> None:
    faint = event(6.0, amplitude=0.9 * FAINT * WHIRL_BEGINS)
    found = with_uncertainties(run, [faint], [faint])[0]
    assert found["certain"] is False
    assert "close to the 0.05" in found["reason"]
    assert found["speed_uncertainty_Hz"] > 0.0


def test_pairs_do_not_cross() -> None:
    """The nearest pair is 5.02 and 5.03; what is left on either side of it stays there."""
    own, second = [event(5.0), event(5.02), event(5.3)], [event(5.03), event(5.1)]
    assert partners(own, second) == [None, second[0], second[1]]


times = st.lists(st.floats(1.0, 9.0), max_size=6, unique=True).map(sorted)


@given(times, times)
def test_every_event_has_one_partner_at_most_and_all_are_in_order(own: list[float], second: list[float]) -> None:
    found = partners([event(t) for t in own], [event(t) for t in second])
    matched = [(t, other["t_s"]) for t, other in zip(own, found, strict=True) if other is not None]
    assert [other for _, other in matched] == sorted({other for _, other in matched})
    assert all(
        abs(t - other) <= NEAR * t + 1e-12 or 0.5 * RAMP * abs(t**2 - other**2) <= NEAR_REVOLUTIONS + 1e-9
        for t, other in matched
    )


def test_revolutions_between_two_events_are_those_of_the_ramp() -> None:
    """From 30 Hz on 39 until 57 Hz, and 45 until 60 Hz, of which the speed of the former alone would make 30."""
    assert partners([event(1.0)], [event(1.9)]) == [event(1.9)]
    assert partners([event(1.0)], [event(2.0)]) == [None]


def rings(speed_Hz: float, wave_Hz: float, warm_K: float) -> Run:
    """A ring that turns and sways, and a film that becomes warm."""
    time = np.linspace(0.0, 10.0, 20_001)
    plain = {"time_s": time, "speed_Hz": 30.0 * time}
    ring = speed_Hz + wave_Hz * np.sin(2.0 * np.pi * 50.0 * time)
    return as_run(plain | {"ring_speed_Hz": ring, "temperature_inner_K": 300.0 + warm_K * time})


def test_a_slow_signal_is_as_uncertain_as_its_means_differ() -> None:
    """The sway of 50 Hz is not part of it; a temperature that rises 0.1 K/s faster is 1 K off at the end of 10 s, and
    half of a hundredth less in the mean of the last part."""
    found = slow_uncertainties(rings(40.0, 5.0, 2.0), rings(40.5, 1.0, 2.1))
    assert found == {
        "ring_speed_uncertainty_Hz": pytest.approx(SAFETY * 0.5, rel=1e-3),
        "temperature_uncertainty_K": pytest.approx(SAFETY * 0.995, rel=1e-3),
    }
    assert slow_uncertainties(make_run(Rotor()), make_run(Rotor())) == {}
