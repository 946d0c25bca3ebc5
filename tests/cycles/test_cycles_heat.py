"""Limit cycles with heat: derivatives, the limit of much oil, and a run, whose temperature is a state."""

import math
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cycles.heat import WarmSpeed, warm_courses
from frbcli.cycles.limit_cycles import check, limit_cycles
from frbcli.cycles.method.balance import packed
from frbcli.cycles.method.continuation import Place
from frbcli.cycles.method.equilibria import at_rest
from frbcli.cycles.method.follower import Follower
from frbcli.cycles.unbalance import Synchronous, driven_equations
from frbcli.equilibrium.static_machine import WarmMachines
from frbcli.errors import InputError
from frbcli.film.cells.balance.ends import outflow
from frbcli.film.cells.film import Motion
from frbcli.film.cells.mean_film import mean_end_flows
from frbcli.film.cells.solver import FilmSolver
from frbcli.runs.run import runup
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

OIL = ["oil.viscosity={grade='SAE 10W-40'}", "film.theory=short", "bearing.supply.pressure=2 bar"]
HEAT = ["thermal.model=lumped", "thermal.supply_temperature=70 degC"]

GROOVES = [f"bearing.{film}.supply={{kind='circumferential-groove', pressure='2 bar'}}" for film in ("inner", "outer")]


HOLES = 'bearing.supply={kind="bores", count=6, diameter="2 mm", pressure="2 bar", on="journal"}'
TURNING = [OIL[0], *HEAT, HOLES, "accuracy.mesh=[4,24]"]


def jeffcott(*settings: str) -> Case:
    return load_case("jeffcott", [*OIL, *settings])


def turning(*settings: str) -> Case:
    return load_case("jeffcott", [*TURNING, *settings])


def course_at_rest(case: Case) -> tuple[WarmSpeed, np.ndarray]:
    """The course of a case over its speed, and u at rest at the highest one."""
    plan = make_plan(case)
    system = make_system(case, plan)
    make, position = warm_courses(case, plan, system, check(case, shooting=True)[1])
    course = make(system)
    return course, at_rest(course.top, position)


def test_openings_that_turn_let_the_mean_over_their_angle_out() -> None:
    """Of films on the same cells with the openings at twelve angles, at 1.7 times the viscosity of the table. Between
    its eccentricities and angles the table is 0.4 % off."""
    films = make_system(turning(), make_plan(turning())).films
    (end,) = films.smooth_ends(films.smooth([0.0]))
    (film,), omega, thicker = films.with_fields, 2.0 * math.pi * 80.0, 1.7
    for x, y in ((0.35, -0.3), (0.02, 0.01)):
        leaving = []
        for angle in np.linspace(0.0, math.pi / 3.0, 12, endpoint=False):
            c, s = math.cos(angle), math.sin(angle)
            d = c * x + s * y, c * y - s * x
            turning_journal = Motion(d, (0.0, 0.0), thicker * omega)
            solution = FilmSolver(film).steady(turning_journal)
            leaving.append(outflow(film, turning_journal, film.pressure(solution.state)) / thicker)
        motion = np.array([[x, y, 0.5 * omega * y, -0.5 * omega * x]])
        found = films.clearances[0] * mean_end_flows(end, motion, np.array([omega]), thicker)  # type: ignore[arg-type]
        assert found == pytest.approx(np.mean(leaving), rel=6e-3)


@pytest.mark.nightly  # 2 s each: tables of fields
@pytest.mark.parametrize(
    "case",
    [
        turning("speed.from=90 Hz", "speed.to=100 Hz"),
        load_case(
            "floating-ring-heat",
            ["film.cavitation=half-sommerfeld", "accuracy.mesh=[4,24]", "speed.from=50 Hz", "speed.to=100 Hz"],
        ),
    ],
    ids=["holes in the journal", "holes in a ring"],
)
def test_a_machine_whose_openings_turn_is_as_warm_at_rest_as_with_its_openings_in_one_place(case: Case) -> None:
    course, rest = course_at_rest(case)
    plan, omega = make_plan(case), 2.0 * math.pi * 100.0
    warm = course._heat.warm(rest[None].astype(complex), 0.0, omega)
    steady = WarmMachines(case, plan, make_system(case, plan)).at(omega).steady
    assert warm.temperatures == pytest.approx(steady.temperatures, abs=0.2)
    assert steady.temperatures[0] > course._heat.heat.model.supply[0] + 5.0


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        pytest.param("jeffcott", TURNING, marks=pytest.mark.nightly),
        ("jeffcott", [*OIL, *HEAT, "thermal.housing=60 degC"]),
        ("floating-ring-heat", ["film.cavitation=half-sommerfeld", "thermal.clearance=fixed", *GROOVES]),
    ],
)
def test_equations_change_with_the_motion_as_their_derivatives_say(name: str, settings: list[str]) -> None:
    """The temperatures of films and rings follow from the motion, and so do their parts of the derivatives."""
    case = load_case(name, [*settings, "speed.from=90 Hz", "speed.to=100 Hz"])
    course, rest = course_at_rest(case)
    follower, c, films = Follower(course, 0.9), course.top.size, course.top.film_count
    motion = np.zeros((3, c), dtype=complex)
    motion[0] = rest
    motion[1, : 2 * films] = np.tile([0.1 + 0.05j, 0.05 - 0.1j], films)
    motion[2] = 0.01
    y = np.concatenate([packed(motion), [0.5, 0.9]])
    equations, found = follower.equations(Place(y, np.ones(len(y)))), course._warm(y)
    _, slope = equations(y)
    for i in (0, c - 1, c, 3 * c - 1, len(y) - 2, len(y) - 1):
        step = 1e-6 * np.eye(len(y))[i]
        ahead, behind = (course._warm(y + sign * step).machine.scales for sign in (1.0, -1.0))
        warmer = np.log(ahead / behind) / 2e-6
        assert found.by_motion[:, i] == pytest.approx(warmer, rel=1e-4, abs=1e-5)
        if i >= len(y) - 2:  # the forces of tables have derivatives by displacement that are not exact
            changed = (equations(y + step)[0] - equations(y - step)[0]) / 2e-6
            assert slope[:, i] == pytest.approx(changed, abs=1e-5 * float(np.abs(changed).max()))
    assert np.abs(found.by_motion).max() > 1e-2


def test_oil_of_endless_capacity_keeps_its_temperature() -> None:
    course = ["speed.to=116 Hz", "speed.from=105 Hz"]
    warm = limit_cycles(jeffcott(*HEAT, "oil.heat_capacity=2e9 J/(kg*K)", *course), [114.0])
    cold = limit_cycles(jeffcott("oil.temperature=70 degC", *course), [114.0])
    (one,), (other,) = warm.of("hopf"), cold.of("hopf")
    assert one.speed_Hz == pytest.approx(other.speed_Hz, rel=1e-5)
    at_114 = [next(p for p in found.branches[0].points if p.kind == "asked") for found in (warm, cold)]
    assert at_114[0].frequency_Hz == pytest.approx(at_114[1].frequency_Hz, rel=1e-5)
    assert at_114[0].eccentricity_max == pytest.approx(at_114[1].eccentricity_max, rel=1e-3)
    assert one.value_uncertainty == pytest.approx(other.value_uncertainty, rel=1e-2)
    assert one.frequency_uncertainty_Hz == pytest.approx(other.frequency_uncertainty_Hz, rel=1e-2)
    for name in ("frequency_uncertainty_Hz", "eccentricity_max_uncertainty"):
        stated = [getattr(point, name) for point in at_114]
        assert stated[0] == pytest.approx(stated[1], rel=1e-2)
        assert np.all(stated[1] > 0.0)
    assert at_114[0].temperatures_K == pytest.approx([343.15], abs=1e-3)
    assert not len(at_114[1].temperatures_K)


def test_cycle_is_where_a_run_with_heat_settles(tmp_path: Path) -> None:
    """The temperature of a run swings with the whirl by 0.1 K; its mean, power, size and frequency are the cycle's."""
    found = limit_cycles(jeffcott(*HEAT, "speed.from=105 Hz", "speed.to=116 Hz"), [115.0])
    cycle = next(p for p in found.branches[0].points if p.kind == "asked")
    assert cycle.stable
    displacement = cycle.orbit()[0]
    start = f"start.displacement=[{displacement[0]}, {displacement[1]}]"
    steady = ["speed.from=115 Hz", "speed.to=115 Hz", "speed.duration=1 s", "rotor.unbalance=0", "output.step=0.2 ms"]
    run = runup(jeffcott(*HEAT, *steady, start), tmp_path / "run.h5")
    later = run["time_s"] > 0.7
    x, y = (run[f"journal_{axis}_m"][later] for axis in "xy")
    angle = np.unwrap(np.arctan2(y - y.mean(), x - x.mean()))
    turns = (angle[-1] - angle[0]) / (2.0 * math.pi * (run["time_s"][later][-1] - run["time_s"][later][0]))
    assert cycle.frequency_Hz == pytest.approx(turns, rel=2e-3)
    assert cycle.eccentricity_max[0] == pytest.approx(run["eccentricity"][later].max(), rel=5e-3)
    assert cycle.temperatures_K[0] == pytest.approx(run["temperature_K"][later].mean(), abs=0.05)
    assert cycle.torque_N_m * 2.0 * math.pi * 115.0 == pytest.approx(run["power_W"][later].mean(), rel=5e-3)
    assert cycle.temperatures_K[0] > 343.15 + 10.0


def test_derivatives_of_the_response_to_unbalance_have_the_temperatures() -> None:
    case = jeffcott(*HEAT, "rotor.unbalance=20 g*mm", "speed.from=90 Hz", "speed.to=100 Hz")
    course, rest = course_at_rest(case)
    follower, c = Synchronous(course, 0.8), course.top.size
    motion = np.array([rest, [0.1 + 0.05j, 0.05 - 0.1j], np.full(c, 0.01)], dtype=complex)
    y = np.concatenate([packed(motion), [0.9, 0.9]])
    equations = follower.equations(Place(y, np.ones(len(y))))
    _, slope = equations(y)
    _, staying = driven_equations(course.machine(y), motion)(y)
    for i in (0, c - 1, c, 3 * c - 1, len(y) - 2, len(y) - 1):
        step = 1e-6 * np.eye(len(y))[i]
        changed = (equations(y + step)[0] - equations(y - step)[0]) / 2e-6
        assert slope[:, i] == pytest.approx(changed, abs=1e-4 * float(np.abs(changed).max()))  # forces of a table
        assert np.abs(slope - staying)[:, i].max() > 1e-3


def test_response_to_unbalance_is_where_a_run_with_heat_settles(tmp_path: Path) -> None:
    """And with oil of endless capacity, that without heat."""
    heavy, course = "rotor.unbalance=20 g*mm", ["speed.from=88 Hz", "speed.to=90 Hz"]
    endless = limit_cycles(jeffcott(*HEAT, heavy, "oil.heat_capacity=2e9 J/(kg*K)", *course)).synchronous[0]
    cold = limit_cycles(jeffcott("oil.temperature=70 degC", heavy, *course)).synchronous[0]
    assert endless.eccentricity_max == pytest.approx(cold.eccentricity_max, rel=1e-5)
    slow = np.abs(endless.multipliers[:, None] - cold.multipliers).min(axis=1) > 1e-4
    assert slow.sum() == 1  # of the temperature
    found = limit_cycles(jeffcott(*HEAT, heavy, *course)).synchronous[0]
    assert found.stable
    assert abs(float(found.eccentricity_max[0] / cold.eccentricity_max[0]) - 1.0) > 0.1
    steady = ["speed.from=90 Hz", "speed.to=90 Hz", "speed.duration=2 s", "output.step=0.2 ms"]
    run = runup(jeffcott(*HEAT, heavy, *steady), tmp_path / "run.h5")
    later = run["time_s"] > 1.7
    assert found.eccentricity_max[0] == pytest.approx(run["eccentricity"][later].max(), rel=2e-4)
    assert found.temperatures_K[0] == pytest.approx(run["temperature_K"][later].mean(), abs=0.01)
    assert found.torque_N_m * 2.0 * math.pi * 90.0 == pytest.approx(run["power_W"][later].mean(), rel=5e-4)


@pytest.mark.nightly
def test_a_whirl_that_locks_in_is_where_a_run_with_heat_settles(tmp_path: Path) -> None:
    """The temperature of the run swings by 0.5 K within two turns, and with it the eccentricity by some 1e-3."""
    light, speed = "rotor.unbalance=2 g*mm", 116.0
    found = limit_cycles(jeffcott(*HEAT, light, "speed.from=115.5 Hz", f"speed.to={speed} Hz"), with_unbalance=True)
    (branch,) = found.branches
    whirl = max(branch.with_unbalance, key=lambda each: each.speed_Hz)
    steady = [f"speed.from={speed} Hz", f"speed.to={speed} Hz", "speed.duration=6 s", "output.step=0.2 ms"]
    run = runup(jeffcott(*HEAT, light, *steady, "start.displacement=[0.3, 0]"), tmp_path / "run.h5")
    later = run["time_s"] > 5.0
    assert whirl.stable
    assert whirl.speed_Hz == pytest.approx(speed)
    assert whirl.eccentricity_max[0] == pytest.approx(run["eccentricity"][later].max(), rel=3e-3)
    assert whirl.temperatures_K[0] == pytest.approx(run["temperature_K"][later].mean(), abs=0.01)


@pytest.mark.parametrize(
    ("settings", "whirls", "said"),
    [
        (["thermal.clearance=follows"], False, "over which the motions of a branch are measured"),
        (["film.theory=auto", "film.cavitation=two-phase"], False, "settles over many periods"),
        (["film.theory=auto", "film.cavitation=reynolds"], True, "settles over many periods"),
    ],
)
def test_what_has_no_cycle_with_heat(settings: list[str], whirls: bool, said: str) -> None:
    with pytest.raises(InputError, match=said):
        limit_cycles(jeffcott(*HEAT, *settings), with_unbalance=whirls)
