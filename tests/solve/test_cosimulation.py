"""Couplings of rotor and films (chapter 5): how they approach each other, and what they cost."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.runs.march import control_of
from frbcli.runs.run import runup
from frbcli.runs.start import first_state, in_turn, micro_cost, rotor_data
from frbcli.scene.coupling import COUPLINGS, chosen_coupling
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.cosimulation import MICRO_STEPS, advance_in_turn
from frbcli.solve.state import FINISHED, METHODS, STEPS, State, make_output
from frbcli.solve.time_loop import advance
from frbcli.studies.compare import compare

HEAVY = ("film.theory=short", "speed.from=20 Hz", "speed.to=22 Hz", "speed.duration=0.05 s", "output.step=1e-4 s")
WET = ("film.cavitation=two-phase", "bearing.supply.pressure=2 bar", "accuracy.mesh=[3, 12]", "speed.from=20 Hz",
       "speed.to=21 Hz", "speed.duration=2 ms", "output.step=2e-5 s")  # fmt: skip
FREE = 1e6  # a tolerance that leaves all steps at their longest


def marched(case: Case, apart: bool, longest: float, tolerance: float) -> tuple[Array, State]:
    """Displacements over the clearance at the output times, and the last state."""
    plan = make_plan(case)
    system, profile = make_system(case, plan), run_up_profile(case)
    control = control_of(case, plan)._replace(longest_step=longest, tolerance=tolerance, steps_per_revolution=1.0)
    state = first_state(case.start, system, profile)
    if apart:
        state = in_turn(system, state, float(profile.speeds[0]))
    rows = int(profile.end / control.output_step) + 10
    output = make_output(rows, system.rotor.size, len(system.films.with_fields))
    step = advance_in_turn if apart else advance
    tableau = METHODS["esdirk4"].tableau
    status, written = step(rotor_data(system, profile), system.films.loop, tableau, control, state, 10**8, output)
    assert status == FINISHED
    return output.q[:written] / system.clearances[0], state


def test_a_rigid_rotor_approaches_the_monolithic_one_with_third_order() -> None:
    """Forces are extrapolated by parabolas: what they are off by shrinks with the cube of the macro step."""
    case = load_case("rigid", HEAVY)
    exact, _ = marched(case, apart=False, longest=1e-5, tolerance=1e-10)
    errors = []
    for macro_step in (20e-6, 10e-6, 5e-6):
        found, state = marched(case, apart=True, longest=macro_step, tolerance=FREE)
        assert state.numbers[STEPS] == pytest.approx(case.speed.duration / macro_step, rel=0.1)
        errors.append(np.abs(found - exact).max())
    orders = [math.log2(a / b) for a, b in pairwise(errors)]
    assert all(2.5 < order < 3.5 for order in orders)
    assert errors[-1] < 1e-7


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_forces_act_between_the_exchanges_of_a_co_simulation() -> None:
    """A force of order 2 moves the journal as far as it does where rotor and film are solved together."""
    push = 'force=[{at="journal", force=["40 N", "0 N"], order=2}]'
    pushed, still = load_case("rigid", [*HEAVY, push]), load_case("rigid", HEAVY)
    exact, none = (marched(case, apart=False, longest=1e-5, tolerance=FREE)[0] for case in (pushed, still))
    assert np.max(np.abs(exact - none)) > 0.01
    found, _ = marched(pushed, apart=True, longest=1e-6, tolerance=FREE)
    np.testing.assert_allclose(found, exact, atol=1e-5)


def test_beyond_its_stable_step_a_co_simulation_is_off_but_its_control_holds_it() -> None:
    """The method is explicit. Left alone at 80 us it goes astray; the same longest step under control does not."""
    case = load_case("rigid", HEAVY)
    exact, _ = marched(case, apart=False, longest=1e-5, tolerance=1e-10)
    alone, _ = marched(case, apart=True, longest=80e-6, tolerance=FREE)
    held, _ = marched(case, apart=True, longest=80e-6, tolerance=1e-6)
    assert np.abs(alone - exact).max() > 1e-2
    assert np.abs(held - exact).max() < 1e-4


def test_a_film_with_oil_of_its_own_follows_as_in_the_monolithic_system() -> None:
    case = load_case("jeffcott", WET)
    exact, _ = marched(case, apart=False, longest=1e-5, tolerance=1e-7)
    found, state = marched(case, apart=True, longest=5e-7, tolerance=1e-6)
    assert np.abs(exact[-1]).max() > 1e-3
    np.testing.assert_allclose(found, exact, atol=2e-5)
    cost = micro_cost(state, 1.0)
    assert cost["micro_steps_per_macro_step"] >= 1.0
    assert cost["micro_steps"] == state.numbers[MICRO_STEPS]


def test_the_case_chooses_the_coupling() -> None:
    assert make_plan(load_case("jeffcott")).coupling == "dynamic-static"
    assert make_plan(load_case("jeffcott", ["film.cavitation=elrod"])).coupling == "monolithic"
    plan = make_plan(load_case("jeffcott", ["film.coupling=co-simulation", "accuracy.macro_step=2 us"]))
    assert (plan.coupling, plan.macro_step) == ("co-simulation", 2e-6)
    assert make_plan(load_case("jeffcott", ["film.coupling=monolithic"])).macro_step is None
    assert {chosen_coupling("auto", cavitation) for cavitation in ("penalty", "peeken")} <= set(COUPLINGS)


QUICK = ("speed.duration=0.02 s", "speed.from=20 Hz", "speed.to=22 Hz", "output.step=1e-4 s", "accuracy.mesh=[4, 48]")


def test_all_couplings_of_a_jeffcott_rotor_agree() -> None:
    found = compare(load_case("jeffcott", [*QUICK, "film.theory=short"]), couplings=COUPLINGS)
    assert [result.variant.coupled for result in found.results] == list(COUPLINGS)
    monolithic, static, semi, apart = found.results
    # A film without a state makes the same equations of both.
    np.testing.assert_array_equal(static.run["eccentricity"], monolithic.run["eccentricity"])
    assert 0.0 < semi.deviation.largest < 1e-4
    assert semi.run.cost["film_solves"] < static.run.cost["film_solves"]
    assert 0.0 < apart.deviation.largest < 1e-4
    assert apart.run.cost["micro_steps_per_macro_step"] == 1.0
    assert apart.run.cost["steps"] > 0.02 / 1e-6
    table = found.to_pandas()
    assert table["coupling"].tolist() == list(COUPLINGS)
    assert table["micro_steps_per_macro_step"].isna().tolist() == [True, True, True, False]
    assert (table["simulated_ms_per_hour"] > 0.0).all()


def test_a_co_simulation_of_a_floating_ring(tmp_path: Path) -> None:
    settings = [*QUICK, "film.cavitation=half-sommerfeld", "accuracy.mesh=[3, 12]", "speed.duration=2 ms"]
    settings.append("accuracy.tolerance=2e-5")
    runs = [runup(load_case("floating-ring", [*settings, f"film.coupling={name}"]), tmp_path / f"{name}.h5")
            for name in ("monolithic", "co-simulation")]  # fmt: skip
    for name in ("eccentricity_inner", "eccentricity_outer"):
        np.testing.assert_allclose(runs[1][name], runs[0][name], atol=1e-4)
    speeds = [run["ring_speed_Hz"] for run in runs]
    assert abs(speeds[0][-1]) > 1e-3
    np.testing.assert_allclose(speeds[1], speeds[0], atol=1e-3 * abs(speeds[0][-1]))


MACRO = "accuracy.macro_step=4 us"
PIN = 'bearing.pin={radius="16 mm", play="0.01 mm", stiffness="1e6 N/m"}'
FROM_60 = ("speed.from=60 Hz", "speed.to=100 Hz", "speed.duration=10 ms", "output.step=0.5 ms")
OVER_SPEED = ", ".join([
    'speed=["0 Hz", "300 Hz"]',
    *(f'{name}=["{low}", "{high}"]' for name, low, high in (
        ("kxx", "1e5 N/m", "2e5 N/m"), ("kxy", "0 N/m", "5e4 N/m"), ("kyx", "0 N/m", "-5e4 N/m"),
        ("kyy", "1e5 N/m", "2e5 N/m"), ("cxx", "10 N*s/m", "20 N*s/m"), ("cyy", "10 N*s/m", "20 N*s/m"),
        ("cxy", "0 N*s/m", "0 N*s/m"), ("cyx", "0 N*s/m", "0 N*s/m"), ("mxx", "0 kg", "1 kg"), ("myy", "0 kg", "1 kg"),
        ("mxy", "0 kg", "0 kg"), ("myx", "0 kg", "0 kg"),
    )),
])  # fmt: skip
SEAL = (
    'bearing=[{kind="single-film", width="20 mm", diameter="25 mm", clearance="35 um"}, '
    f'{{kind="coefficients", name="seal", over_speed={{{OVER_SPEED}}}}}]'
)
RISING = (
    'bearing.supply={kind="circumferential-groove", pressure=[["0 s", "1 bar"], ["5 ms", "3 bar"], ["1 s", "3 bar"]]}'
)
FINE = "accuracy.steps_per_revolution=4000"  # the pressure in the middle of a step counts for all of it
FAST = ("speed.from=1500 Hz", "speed.to=1600 Hz", "speed.duration=4 ms", "output.step=0.05 ms")


@pytest.mark.nightly  # each compiles two time loops
@pytest.mark.parametrize(
    ("name", "settings", "other", "share"),
    [
        ("jeffcott", (SEAL, *FROM_60), SEAL.replace("1 kg", "0 kg"), 1e-4),
        ("jeffcott", (RISING, *FROM_60, FINE), RISING.replace("3 bar", "1.2 bar"), 1e-4),
        ("floating-ring", (PIN, "start.displacement=[0.1, -0.3]", *FROM_60), PIN.replace("1e6 N/m", "1e5 N/m"), 2e-3),
        ("turbocharger-car-cartridge", FAST, "bearing.ring.inertia=1e-9 kg*m^2", 1e-4),
    ],
    ids=["coefficients over the speed, with mass", "supply over time", "pin", "cartridge that turns"],
)
def test_what_acts_on_a_rotor_acts_in_a_co_simulation(
    name: str, settings: tuple[str, ...], other: str, share: float, tmp_path: Path
) -> None:
    """As where rotor and films are solved together; the same machine without it moves otherwise."""
    both = [*settings, "film.cavitation=half-sommerfeld"]
    apart = runup(load_case(name, [*both, "film.coupling=co-simulation", MACRO]), tmp_path / "apart.h5")
    exact = runup(load_case(name, [*both, "accuracy.tolerance=1e-7"]), tmp_path / "exact.h5")
    without = runup(load_case(name, [*both, other, "accuracy.tolerance=1e-7"]), tmp_path / "without.h5")
    moved = 0.0
    for signal in [signal for signal in exact.signals if signal.startswith(("journal", "disk", "ring", "pin_angle"))]:
        found, expected, changed = (np.array(run[signal]) for run in (apart, exact, without))
        size = np.ptp(expected)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=share * size, err_msg=signal)
        moved = max(moved, float(np.max(np.abs(changed - expected)) / size))
    assert moved > 5.0 * share
