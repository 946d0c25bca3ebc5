"""What `frb check` finds before the plan: masses, loads, natural frequencies, Sommerfeld numbers. The reasons of a plan
say what is so: what is set is said to be set, and what is not is not. What a plan says of loads and inputs that change
with time: their frequencies beside steps and samples. The tilt of journals that `frb check` states: closed forms of
beams, and how it reaches the gap. The eccentricity that a plan expects: limits of the short bearing, and runs."""

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb
from paths import DATA
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import frbcli
from frbcli.case.reading.load import case_from_dict, load_case, load_case_text
from frbcli.case.schema import Case
from frbcli.cli.main import run
from frbcli.report.sketch import rotor_sketch
from frbcli.runs.advice import accuracy_advice
from frbcli.runs.run import runup
from frbcli.scene.course import CHOICE, highest_frequency
from frbcli.scene.machine.findings import film_tilts, findings
from frbcli.scene.planning.cell_choice import LARGEST, PLAIN, expected_eccentricity, gap_ratio, mobility, resting_load
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import expected_error, make_plan


def test_of_a_jeffcott_rotor() -> None:
    found = findings(load_case("jeffcott"))
    assert found.mass == pytest.approx(6.1)
    assert found.frequencies_Hz == (pytest.approx(math.sqrt(5e6 / 6.0) / (2.0 * math.pi)),)
    (film,) = found.films
    assert film.load == pytest.approx(0.5 * 6.1 * 9.81)
    assert film.mean_pressure == pytest.approx(film.load / (0.02 * 0.025))
    # (3.14): F psi^2 / (B D eta omega)
    psi, omega = 35e-6 / 0.0125, 2.0 * math.pi * 300.0
    assert film.sommerfeld_number == pytest.approx(film.load * psi**2 / (0.02 * 0.025 * 0.012 * omega))


@pytest.mark.parametrize("name", ["turbocharger-car", "turbocharger-heavy"])
def test_bearings_carry_the_weight_and_outer_films_their_rings(name: str) -> None:
    case = load_case(name)
    found = findings(case)
    inner = sum(film.load for film in found.films if "inner" in film.film)
    assert found.mass is not None
    assert inner == pytest.approx(9.81 * found.mass, rel=1e-9)
    outer = sum(film.load for film in found.films if "outer" in film.film)
    rings = sum(bearing.ring_mass for bearing in case.bearings)  # type: ignore[union-attr]
    assert outer - inner == pytest.approx(9.81 * rings, rel=1e-9)
    solid = sum(0.25 * math.pi * (s.diameter**2 - s.inner_diameter**2) * s.length * s.density for s in case.shaft)
    assert found.mass == pytest.approx(solid + sum(disk.mass for disk in case.disks), rel=1e-9)


def test_a_kinematic_test_has_its_load_or_none(frb: Frb) -> None:
    found = findings(load_case("bearing"))
    assert (found.mass, found.frequencies_Hz) == (None, ())
    assert [film.load for film in found.films] == [29.9]
    assert findings(load_case("squeeze")).films == ()
    document = frb("check", "bearing", "--json").document
    assert document["findings"]["films"][0]["load_N"] == 29.9


@pytest.mark.parametrize("setting", ["bearing.1.position=42 mm", "shaft.0.diameter=1e-9 m"])
def test_bearings_that_do_not_hold_the_rotor_have_no_static_load(setting: str, frb: Frb) -> None:
    """At one place, or on a shaft like a string: both ended in a traceback."""
    assert "static loads" not in frb("check", "turbocharger-car", "--set", setting).out
    assert run(["stability", "turbocharger-car", "--set", setting, "--speed", "100 Hz", "--no-picture"]) in (0, 2, 3)


def test_values_are_shown_on_demand_and_fit_the_screen(frb: Frb) -> None:
    said = frb("check", "turbocharger-heavy").out
    assert "youngs_modulus" not in said
    lines = [line.strip() for line in frb("check", "turbocharger-heavy", "--all").out.splitlines()]
    assert "[bearing.0.inner.clearance]" in lines
    assert any(line.startswith("reference_temperature ") for line in lines)
    assert max(map(len, lines)) <= 80


def test_a_name_that_is_nearly_a_command_is_suggested(frb: Frb) -> None:
    assert 'Did you mean "stability"?' in frb("stabilty", "jeffcott", code=2).err
    assert "Did you mean" not in frb("zzz", code=2).err


OWN = 'cavitation = "half-sommerfeld"'
PLANS = tomllib.loads((DATA / "plans.toml").read_text(encoding="utf-8"))["plan"]


@pytest.mark.parametrize("row", PLANS, ids=lambda row: " ".join([row["case"], *row.get("settings", ())])[:90])
def test_a_plan_says_what_is_modelled_and_why(row: dict[str, Any]) -> None:
    """And the case has a text that gives it again, and a drawing."""
    case = load_case(row["case"], row.get("settings", ()))
    decisions = make_plan(case).decisions
    for choice, value, reason in row["lines"]:
        told = [(one.value, one.reason) for one in decisions if one.choice == choice]
        assert any(value in str(said) and reason in why for said, why in told), (choice, told)
    assert not {one.choice for one in decisions} & set(row.get("without", ()))
    assert load_case_text(case.source_text, name=case.name) == case
    assert "nan" not in rotor_sketch(case)[0]


def test_a_cavitation_model_that_no_line_sets_is_the_default() -> None:
    text = load_case("jeffcott").source_text
    assert OWN in text
    decisions = make_plan(load_case_text(text.replace(OWN, ""))).decisions
    (decision,) = (one for one in decisions if one.choice == "cavitation")
    assert decision.reason.startswith("the default; ")


def test_each_film_says_whether_its_model_is_set() -> None:
    text = load_case("floating-ring").source_text
    case = load_case_text(text, ["bearing.inner.cavitation=reynolds", "film.cavitation=penalty"])
    told = [one.reason for one in make_plan(case).decisions if one.choice == "cavitation"]
    assert all(reason.startswith("set in the case; ") for reason in told)
    assert len(told) == 2


def test_a_mesh_of_a_test_below_the_fewest_cells_is_not_said_to_be_set() -> None:
    bearing = kinematic_plan(load_case("bearing", ["accuracy.mesh=[2, 8]"]))
    (cells,) = (one for one in bearing.decisions if one.choice == "cells")
    assert (cells.value, "fewer than a film needs" in cells.reason) == ("12 x 3", True)


@pytest.mark.parametrize("law", ["elrod", "two-phase", "reynolds"])
def test_no_error_of_forces_is_expected_of_cells(law: str) -> None:
    """What is known of cells is the error of the eccentricities; that of nearly vanishing forces is 1e-2 to 1."""
    assert expected_error(make_plan(load_case("jeffcott", [f"film.cavitation={law}"]))).film_force is None


MACHINE = {
    "rotor": {"kind": "rigid", "mass": "6 kg"},
    "bearing": {"kind": "coefficients", "stiffness": "1e6 N/m", "damping": "300 N*s/m"},
    "speed": {"from": "50 Hz", "to": "50 Hz", "duration": "0.2 s"},
}


def told(case: frbcli.Case) -> list[tuple[str, str]]:
    return [(each.value, each.reason) for each in make_plan(case).decisions if each.choice == CHOICE]


def over_time(rate: float, frequency: float) -> dict[str, object]:
    time = np.arange(0.0, 0.2 + 0.5 / rate, 1.0 / rate)
    x = np.round(np.sin(2.0 * math.pi * frequency * time), 9)
    return {"at": "journal", "over_time": {"time": time.tolist(), "x": x.tolist()}}


@pytest.mark.parametrize("frequency", [40.0, 300.0, 900.0])
def test_the_highest_frequency_of_a_table_is_that_of_its_sine(frequency: float) -> None:
    time = np.linspace(0.0, 1.0, 4001)
    sine = np.sin(2.0 * math.pi * frequency * time) + 3.0 * np.sin(2.0 * math.pi * 20.0 * time)
    found = highest_frequency(time, np.column_stack([0.0 * time, sine]))
    assert found == pytest.approx(frequency, abs=3.0)  # the window is as wide
    assert highest_frequency(time, np.column_stack([5.0 + 2.0 * time, 0.0 * time])) == 0.0
    assert highest_frequency(time**2, sine[:, None]) == 0.0


def test_a_plan_tells_the_steps_of_loads_that_a_run_takes(tmp_path: Path) -> None:
    """Steps in a period of the fastest load, and samples that are too far apart to show it."""
    force = {"at": "journal", "force": ["1 N", "0 N"], "order": 8}
    case = case_from_dict(MACHINE | {"force": [force]}, "resolution")
    ((value, reason),) = told(case)
    assert value == "force 1: 400 Hz"
    steps = runup(case, tmp_path / "run.h5").cost["steps"] / (0.2 * 400.0)
    assert float(reason.split()[0]) == pytest.approx(steps, rel=0.1)
    assert "samples" not in reason
    (_, reason), = told(case.with_settings("output.step=2 ms"))
    assert reason.endswith("above the 250 Hz that samples of output.step show")


def test_a_plan_tells_the_rows_of_a_table_beside_its_steps() -> None:
    coarse, fine = (case_from_dict(MACHINE | {"force": [over_time(rate, 100.0)]}, "rows") for rate in (1e3, 1e4))
    ((value, reason),) = told(coarse)
    assert value == "force 1: 201 rows, at least 0.001 s apart"
    assert reason.startswith("2 steps of 0.0005 s between them")
    assert "content up to 1" in reason
    ((_, reason),) = told(fine)
    assert reason.startswith("closer than the steps of 0.0005 s")


def test_inputs_have_a_line_and_other_machines_none() -> None:
    pressure = 'bearing.supply.pressure=[["0 s", "1 bar"], ["1 s", "3 bar"], ["10 s", "3 bar"]]'
    ((value, _),) = told(frbcli.load_case("jeffcott", [pressure]))
    assert value == "bearing.supply.pressure: 3 rows, at least 1 s apart"
    assert told(frbcli.load_case("jeffcott")) == []


L, D, E, RHO = 0.2, 0.01, 2.1e11, 7850.0
SECOND, AREA = math.pi / 64.0 * D**4, math.pi / 4.0 * D**2
HEAVY, U, WIDTH, C = 0.4, 2e-6, 0.012, 30e-6


def between_two_films(speed_Hz: float, *more: str) -> Case:
    """A shaft that ends in its bearings, with a disk in the middle."""
    film = f'{{kind = "single-film", width = "{WIDTH} m", diameter = "{D} m", clearance = "{C} m"'
    settings = (
        'rotor={kind = "turbocharger", modes = 60}',
        f'shaft=[{{length = "{L} m", diameter = "{D} m", density = "{RHO} kg/m^3", youngs_modulus = "{E} Pa"}}]',
        f'bearing=[{film}, name = "left", position = "0 m"}}, {film}, name = "right", position = "{L} m"}}]',
        f'disk=[{{position = "{0.5 * L} m", mass = "{HEAVY} kg", unbalance = "{U} kg*m"}}]',
        f"speed.to={speed_Hz} Hz",
    )
    return load_case("jeffcott", [*settings, *more])


def test_a_beam_on_two_supports_bends_by_its_weight() -> None:
    """Slope at the ends of a simply supported beam: q L^3 / (24 E I) by its own weight, F L^2 / (16 E I) by a force in
    the middle; shear does not turn the cross-sections there."""
    tilts = film_tilts(between_two_films(10.0))
    slope = RHO * AREA * 9.81 * L**3 / (24.0 * E * SECOND) + HEAVY * 9.81 * L**2 / (16.0 * E * SECOND)
    assert [film.film for film in tilts] == ["left", "right"]
    assert [film.weight for film in tilts] == pytest.approx([slope, slope], rel=1e-4)
    assert tilts[0].bent == pytest.approx((tilts[0].weight + tilts[0].unbalance) * 0.5 * WIDTH / C)


def test_unbalance_bends_as_a_force_that_turns_does() -> None:
    """Far below the natural frequency U Omega^2 L^2 / (16 E I)."""
    slow = film_tilts(between_two_films(2.0))[0]
    force = U * (2.0 * math.pi * 2.0) ** 2
    assert slow.unbalance == pytest.approx(force * L**2 / (16.0 * E * SECOND), rel=1e-3)
    fast = film_tilts(between_two_films(40.0))[0]
    assert fast.unbalance / slow.unbalance > 1.03 * 400.0  # nearer to the natural frequency


def test_cone_and_what_has_none() -> None:
    tilts = film_tilts(between_two_films(10.0))
    assert tilts[0].cone == pytest.approx(2.0 * C / L)
    assert tilts[0].whirling == pytest.approx(2.0 * C / L * 0.5 * WIDTH / C)
    assert film_tilts(load_case("jeffcott")) == ()  # moves in its plane alone
    assert film_tilts(load_case("seal")) == ()  # without films
    rings = findings(load_case("turbocharger-car")).tilts
    assert [film.film for film in rings] == ["compressor inner", "turbine inner"]  # rings do not tilt
    assert all(film.cone == pytest.approx(2.0 * 50e-6 / 32e-3) for film in rings)


def test_check_tells_a_tilt_that_matters(frb: Frb) -> None:
    said = frb("check", "turbocharger-car", "--json")
    tilts = json.loads(said.out)["findings"]["tilts"]
    assert tilts[0]["cone_rad"] == pytest.approx(3.125e-3)
    assert "as journals tilt" in frb("check", "turbocharger-car").out
    assert "tilt" not in frb("check", "jeffcott").out


OIL = ("speed.to=24 Hz", "speed.duration=0.8 s", "output.step=1 ms", "accuracy.target=1e-2")


@pytest.mark.parametrize("eccentricity", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("slender", [0.2, 0.6])
def test_a_journal_stays_where_it_rests(eccentricity: float, slender: float) -> None:
    """Two theories of one film, Booker's of the moving and Ocvirk's of the resting journal: under the load that
    Ocvirk's has at an eccentricity, the mobility takes the journal against the oil as fast as the oil turns it."""
    load = resting_load(eccentricity, slender)

    def velocity(e: np.ndarray) -> np.ndarray:
        return load * mobility(e, slender) + np.array([-e[1], e[0]])

    e, _, found, _ = fsolve(velocity, 0.7 * eccentricity * np.array([1.0, -1.0]), full_output=True)
    assert found == 1
    assert np.hypot(*e) == pytest.approx(eccentricity, rel=1e-2)


def test_the_fall_is_that_of_an_integration_with_small_steps() -> None:
    """From the centre along the run-up, up to 100 times more exactly; a later rest is nearer to the centre."""
    case = load_case("rigid-two-phase", OIL)
    film = case.films[0]
    slender = film.width / film.diameter / (2 if film.supply.splits else 1)
    softness = (2.0 * film.clearance / film.diameter) ** 2 / (film.width * film.diameter * case.viscosity(film))
    load = softness * 0.5 * case.rotor.mass * case.rotor.gravity

    def velocity(time: float, e: np.ndarray) -> np.ndarray:
        turning = np.pi * 24.0 / 0.8 * time
        return load * mobility(e, slender) + turning * np.array([-e[1], e[0]])

    fall = solve_ivp(velocity, (0.0, 0.8), np.zeros(2), "LSODA", rtol=1e-6, atol=1e-6)
    assert expected_eccentricity(case) == pytest.approx(np.hypot(*fall.y).max(), abs=2e-3)


def test_what_it_follows() -> None:
    def expected(*settings: str) -> float:
        found = expected_eccentricity(load_case("rigid-two-phase", settings))
        assert found is not None
        return found

    usual = expected()
    assert 0.8 < usual < 0.9
    assert expected("rotor.mass=12 kg") > usual > expected("rotor.mass=3 kg")
    assert expected("oil.viscosity=24 mPa*s") < usual
    assert expected("rotor.unbalance=20 kg*mm") > expected("rotor.unbalance=10 kg*mm") > usual
    assert expected("rotor.mass=1000 t") == LARGEST
    assert expected("rotor.gravity=0 m/s^2", "rotor.unbalance=0 kg*m") == 0.0


def test_cases_without_it() -> None:
    """Rings, whose speeds are not known; and films without cells, whose error does not depend on it."""
    assert expected_eccentricity(load_case("floating-ring")) is None
    assert make_plan(load_case("jeffcott")).eccentricity is None


def test_a_run_reaches_it(tmp_path: Path) -> None:
    case = load_case("rigid-two-phase", OIL)
    run = runup(case, tmp_path / "run.h5")
    assert expected_eccentricity(case) == pytest.approx(run["eccentricity"].max(), abs=0.05)
    assert accuracy_advice(case, run) == ()


def test_a_closer_journal_needs_more_cells() -> None:
    """The error around grows as the smallest gap falls, but not below the eccentricities that it was measured at."""
    assert gap_ratio(0.8, 0.9) == pytest.approx(2.0)
    assert gap_ratio(0.9, 0.8) == 1.0
    assert PLAIN.at(0.925).around == pytest.approx(2.0 * PLAIN.around)
    assert PLAIN.at(0.3) == PLAIN
    settings = ("film.cavitation=reynolds", "film.solution=cells", "accuracy.target=3e-3")
    light, heavy = (make_plan(load_case("rigid", (*settings, f"rotor.mass={mass} kg"))) for mass in (6, 60))
    assert light.eccentricity is not None
    assert heavy.eccentricity is not None
    assert heavy.eccentricity > 0.95 > light.eccentricity
    assert light.cells is not None
    assert heavy.cells is not None
    assert heavy.cells[0] > light.cells[0]
    assert any(each.choice == "eccentricity" and each.value == f"{heavy.eccentricity:.2f}" for each in heavy.decisions)
