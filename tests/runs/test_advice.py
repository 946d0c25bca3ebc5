"""What is told of the end of a run: the physical cause, and nothing that is set already."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_run import as_run

from frbcli.bearing_tests.kinematic import rotation
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import FilmUnsolved, NotConverged
from frbcli.results.store import Run
from frbcli.runs.advice import RunEnd, accuracy_advice, run_advice, run_end
from frbcli.runs.run import runup
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.supply import advised, unfed_films

AIR = "bearing.ends=free-to-air"
PLAIN = 'bearing.supply={kind="none"}'
BORES = 'bearing.supply={kind="bores", count=6, diameter="2.5 mm", pressure="1 bar"}'
ELASTIC = ("contact.policy=elastic", "contact.stiffness=1e8 N/m")
ONSET = {"kind": "onset", "film": None, "t_s": 0.42, "speed_Hz": 180.0, "frequency_Hz": 88.5, "frequency_ratio": 0.49}
STUCK = RunEnd("not-converged", 0.8, 240.0, "", 0.62, 3e-13, None)


def told(case: Case, end: RunEnd) -> str:
    return " ".join(run_advice(case, end))


def jeffcott(*settings: str) -> Case:
    return load_case("jeffcott", settings)


# --- how a run ended ---


def test_end_of_a_run_is_read_from_its_last_sample_its_events_and_its_state() -> None:
    columns = {
        "time_s": np.array([0.0, 0.1]),
        "speed_Hz": np.array([10.0, 20.0]),
        "eccentricity_inner": np.array([0.9, 0.1]),
        "eccentricity_outer": np.array([0.2, 0.7]),
    }
    whirl = {**ONSET, "film": "outer"}
    run = replace(as_run(columns, "not-converged"), events=[whirl], checkpoint={"numbers": np.arange(20.0)})
    end = run_end(run)
    assert (end.film, end.eccentricity, end.speed_Hz, end.t_s) == ("outer", 0.7, 20.0, 0.1)
    assert end.step_s == 1.0
    assert end.whirl == whirl
    assert run_end(replace(run, events=[whirl, {**whirl, "kind": "offset"}])).whirl is None
    assert run_end(replace(run, events=[{**whirl, "film": "inner"}])).whirl is None
    none = run_end(as_run({name: values[:0] for name, values in columns.items()}, "not-converged"))
    assert (none.film, none.eccentricity, none.step_s) == ("", 0.0, None)


def test_a_run_without_films_that_stuck_did_not_grow() -> None:
    """Only a motion that is far beyond the machine is said to have grown."""
    columns = {"time_s": np.arange(2.0), "speed_Hz": np.full(2, 90.0), "disk_x_m": np.array([0.0, -3e-4]),
               "disk_y_m": np.zeros(2)}  # fmt: skip
    stuck = as_run(columns, "not-converged")
    stuck = replace(stuck, references={"length_m": 1e-4}, checkpoint={"numbers": np.full(20, 5e-13)})
    case = load_case("seal")
    assert run_end(stuck).grown == pytest.approx(3.0)
    assert told(case, run_end(stuck)) == "The rotor had no solution at 90 Hz with a step size below 1e-12 s."
    far = replace(stuck, references={"length_m": 1e-8})
    assert "The motion grew beyond 1e+06 times the length" in told(case, run_end(far))


# --- the eccentricity that the plan was made for ---


def near_the_shell(eccentricity: float, stated: float | None = 2e-2) -> Run:
    """A run that has an eccentricity before its whirl, and 0.99 in it."""
    times, reached = np.arange(4.0), np.array([0.0, eccentricity, 0.5, 0.99])
    columns = {"time_s": times, "speed_Hz": 10.0 * times, "eccentricity": reached}
    return replace(as_run(columns), error={"eccentricity": stated, "quiet_until_s": 2.0})


def test_a_run_that_comes_nearer_to_the_shell_than_expected_says_so() -> None:
    case = load_case("rigid-two-phase", ["accuracy.target=1e-2"])
    (sentence,) = accuracy_advice(case, near_the_shell(0.95))
    assert "reached 0.95 where the plan expected 0.87" in sentence
    assert "2.0e-02" in sentence
    assert "accuracy.target = 0.0025" in sentence


def test_a_smaller_target_is_not_advised_where_it_takes_no_finer_cells() -> None:
    case = load_case("rigid-two-phase", ["accuracy.target=1e-4"])
    (sentence,) = accuracy_advice(case, near_the_shell(0.95))
    assert sentence.endswith("above the target of 0.0001.")


def test_nothing_is_said_where_the_error_is_small_or_the_run_as_expected() -> None:
    case = load_case("rigid-two-phase", ["accuracy.target=1e-2"])
    assert accuracy_advice(case, near_the_shell(0.88)) == ()
    assert accuracy_advice(case, near_the_shell(0.95, stated=9e-3)) == ()
    assert accuracy_advice(case, near_the_shell(0.95, stated=None)) == ()
    assert accuracy_advice(load_case("rigid-two-phase", ["accuracy.mesh=[6, 48]"]), near_the_shell(0.95)) == ()
    assert accuracy_advice(jeffcott(), near_the_shell(0.95)) == ()  # no cells


# --- each status ---


def test_finished_run_needs_no_advice() -> None:
    assert run_advice(jeffcott(), replace(STUCK, status="finished")) == ()
    assert run_advice(jeffcott(AIR, "film.cavitation=two-phase"), replace(STUCK, status="finished")) == ()


@pytest.mark.parametrize("supply", ["bearing.supply.pressure=1 bar", PLAIN])
def test_finished_run_of_a_film_that_makes_its_oil_says_so(supply: str) -> None:
    text = told(jeffcott(AIR, supply, "film.cavitation=half-sommerfeld"), replace(STUCK, status="finished"))
    assert "half-sommerfeld creates the missing oil" in text
    assert ("no supply" in text) is (supply == PLAIN)
    assert ("Raise bearing.supply.pressure above 1 bar" in text) is (supply != PLAIN)
    assert 'bearing.ends = "oil-bath"' in text


def test_starved_film_names_its_cause_and_what_brings_oil() -> None:
    starved = replace(STUCK, status="starved")
    text = told(jeffcott(AIR, "film.cavitation=two-phase"), starved)
    assert "ends are free to air" in text
    assert "supply of 1 bar is not above the cavitation pressure of 1 bar" in text
    assert 'bearing.ends = "oil-bath"' in text
    text = told(jeffcott(AIR, "film.cavitation=elrod"), starved)
    assert "oil-bath" not in text  # at the pressure of the cavities a bath pushes nothing in
    text = told(jeffcott("film.cavitation=elrod"), starved)
    assert "nor is the bath" in text
    assert "bearing.ends" not in text  # is an oil bath already
    assert "Raise bearing.supply.pressure" in text


def test_contact_names_film_whirl_and_the_way_on() -> None:
    touched = replace(STUCK, status="contact", film="inner", whirl=ONSET)
    text = told(jeffcott(), touched)
    assert "The journal in the film inner reached the shell at 240 Hz" in text
    assert "whirling since 0.420 s with about 88.5 Hz" in text
    assert "--set contact.policy=elastic --set contact.stiffness=" in text
    assert "contact.stiffness" not in told(jeffcott("contact.stiffness=1e8 N/m"), touched)
    assert "no whirl before" in told(jeffcott(), replace(touched, whirl=None))
    assert "contact.policy" not in told(jeffcott(*ELASTIC), touched)
    assert "creates the missing oil" in told(jeffcott(AIR, PLAIN), touched)


@pytest.mark.parametrize("settings", [(), ELASTIC])
def test_clearance_step_that_closes_the_shell_is_the_cause_whatever_the_policy(settings: tuple[str, ...]) -> None:
    case = jeffcott("bearing.clearance_steps=[{time='0.2 s', clearance='10 um'}]", *settings)
    text = told(case, replace(STUCK, status="contact", t_s=0.2))
    assert "clearance to 10 um at 0.2 s is below the displacement" in text
    assert "contact." not in text


# --- a run that could not go on ---


def test_stuck_run_tells_film_eccentricity_contact_step_and_speed() -> None:
    text = told(jeffcott(), replace(STUCK, film="outer", whirl=ONSET))
    for word in ("240 Hz", "in the film outer was", "not in contact", "0.6200", "1e-12 s", "whirling since 0.420 s"):
        assert word in text
    assert "contact.policy" not in text  # a contact that is not there helps nobody
    assert "below 2.0e-07 s" in told(jeffcott(), replace(STUCK, step_s=2e-7))


@pytest.mark.parametrize(
    ("settings", "advised", "silent"),
    [
        ((), ("No setting is known to help",), ("accuracy.", "macro_step", "Possible remedies")),
        (("film.coupling=co-simulation",), ("macro_step", "film.coupling = auto"), ()),
        (("film.cavitation=two-phase",), (), ("steepness", "conservative")),
        (
            ("film.cavitation=two-phase", "film.two-phase.form=published", "film.two-phase.diffusion=none"),
            ('form = "conservative"', 'diffusion = "consistent"'),
            (),
        ),
        (
            ("film.cavitation=two-phase", "film.two-phase.form=published"),
            ("conservative", "steepness = 0.9 instead of 0.99"),
            ("diffusion",),
        ),
    ],
)
def test_stuck_run_is_advised_what_is_not_set(
    settings: tuple[str, ...], advised: tuple[str, ...], silent: tuple[str, ...]
) -> None:
    text = told(jeffcott(*settings), STUCK)
    assert [word for word in advised if word not in text] == []
    assert [word for word in silent if word in text] == []


# --- films without oil ---


@pytest.mark.parametrize(
    ("settings", "unfed"),
    [
        (("bearing.supply.pressure=1 bar",), True),
        (("bearing.supply.pressure=1.01 bar",), False),
        (("oil.cavitation_pressure=0.9 bar",), False),
        (("bearing.ends=oil-bath",), False),
        ((PLAIN,), True),
        ((BORES,), False),  # the surfaces carry oil out of them
        (("film.cavitation=peeken",), False),  # draws oil from the groove
        (("film.cavitation=elrod", "bearing.ends=oil-bath"), True),
        (("film.cavitation=elrod", "bearing.ends=oil-bath", "oil.ambient_pressure=2 bar"), True),
        (("film.cavitation=elrod", "bearing.ends=oil-bath", "oil.cavitation_pressure=0.5 bar"), False),
    ],
)
def test_which_films_no_oil_is_pushed_into(settings: tuple[str, ...], unfed: bool) -> None:
    if "oil.ambient_pressure=2 bar" in settings:
        settings = (*settings, "oil.cavitation_pressure=2 bar", "bearing.supply.pressure=2 bar")
    assert bool(unfed_films(jeffcott(AIR, *settings))) is unfed


def test_bearing_without_supply_in_air_is_refused_only_to_models_that_keep_oil() -> None:
    case = load_case("bearing", [PLAIN])
    result = rotation(case, ["half-sommerfeld"]).results[0]
    assert result.status == "ok"
    told = {decision.choice: decision.reason for decision in result.plan.decisions}
    assert "half-sommerfeld creates the missing oil" in told["supply"]
    with pytest.raises(Exception, match="runs dry"):
        kinematic_plan(case, "elrod")


def test_reynolds_film_in_open_air_is_solved_like_one_in_a_bath(tmp_path: Path) -> None:
    """It ended with not-converged at 0.03 s, with any target and any policy of contact. The plan would take longer
    steps for the film in open air, of which it expects a larger error."""
    settings = ("film.cavitation=reynolds", "speed.from=200 Hz", "speed.to=220 Hz", "speed.duration=0.04 s",
                "accuracy.tolerance=2e-5")  # fmt: skip
    air, bath = (runup(jeffcott(*settings, f"bearing.ends={ends}"), tmp_path / f"{ends}.h5") for ends in ENDS)
    assert air.status == bath.status == "finished"
    np.testing.assert_allclose(air["eccentricity"], bath["eccentricity"], atol=1e-6)


ENDS = ("free-to-air", "oil-bath")


def test_film_that_cannot_be_solved_is_advised_by_the_case() -> None:
    def fail(*settings: str) -> str:
        with pytest.raises(NotConverged) as told, advised(jeffcott(*settings)):
            raise FilmUnsolved("the film did not converge")
        return str(told.value)

    assert fail().startswith("the film did not converge. No setting is known to help")
    assert "no pressurised supply" in fail(AIR, "film.cavitation=elrod")
    with pytest.raises(NotConverged, match=r"^other$"), advised(jeffcott()):
        raise NotConverged("other")
