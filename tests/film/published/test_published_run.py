"""Run-ups in the published two-phase form: known limits, orders, its stage by itself, and the oil that it creates."""

from __future__ import annotations

import math
import os
import signal
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cells.balance.balances import GridMotion
from frbcli.film.cells.motion import Motion
from frbcli.film.published.data import HELD, ElementFilm, make_room
from frbcli.film.published.equations.unknown import pressures_of, unknowns_of
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.loads import oil_flows, open_area, published_loads
from frbcli.film.published.moving import oil_held, oil_passing, residual
from frbcli.film.state import NOW, OIL, W
from frbcli.runs.march import control_of
from frbcli.runs.start import first_state, rotor_data
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.scene.planning.planned import Plan
from frbcli.scene.planning.profiles import run_up_profile
from frbcli.solve.films.elements import HERE, MOST_ITERATIONS, ElementWork, make_element_work
from frbcli.solve.stage.equations import FORCE, JOURNAL_ROWS, OMEGA, U_0, X_0, U
from frbcli.solve.stage.journal_newton import correct, forces
from frbcli.solve.state import FINISHED, RUNNING, Control, State, make_output
from frbcli.solve.tableau import METHODS
from frbcli.solve.time_loop import advance

Array = NDArray[np.float64]
SHORT = ["speed.from=30Hz", "speed.to=30Hz", "speed.duration=0.02s", "output.step=0.5ms", "accuracy.mesh=[4,14]"]
PUBLISHED = ["film.cavitation=two-phase", "film.two-phase.form=published"]
SOFT = "film.two-phase.steepness=0.9"
# Ambient pressure far above p_cav: the film stays full, and every form is Reynolds' equation; theta'_0 makes it denser
# by a hundredth.
FULL = [
    "oil.ambient_pressure=11bar", "oil.cavitation_pressure=1bar", "bearing.supply.pressure=11bar",
    "bearing.ends=oil-bath",
]  # fmt: skip


def case_of(*settings: str, name: str = "jeffcott") -> Case:
    return load_case(name, [*SHORT, *PUBLISHED, *settings])


def planned(case: Case) -> tuple[Plan, System]:
    plan = make_plan(case)
    return plan, make_system(case, plan)


def run(
    case: Case, plan: Plan, system: System, control: Control | None = None, budget: int = 10**6
) -> tuple[Array, State]:
    """Displacements (rows, n) at the output times, and the last state."""
    profile = run_up_profile(case)
    state, n = first_state(case.start, system, profile), system.rotor.size
    output = make_output(2000, n, len(system.names))
    status, written = RUNNING, 0
    tableau, rotor = METHODS[plan.method].tableau, rotor_data(system, profile)
    while status == RUNNING:
        status, fresh = advance(
            rotor, system.films.loop, tableau, control or control_of(case, plan), state, budget, output.after(written)
        )
        written += fresh
    assert status == FINISHED
    return output.q[:written], state


def fixed_steps(case: Case, plan: Plan, steps: int) -> Control:
    """Equal steps, a number of them in the whole run."""
    return control_of(case, plan)._replace(tolerance=1e-2, longest_step=case.speed.duration / steps)


def film_of(system: System) -> PublishedFilm:
    (film,) = system.films.own
    assert isinstance(film, PublishedFilm)
    return film


def data_of(system: System) -> ElementFilm:
    (data,) = system.films.loop
    assert isinstance(data, ElementFilm)
    return data


def test_a_full_film_is_that_of_the_other_forms() -> None:
    case, other = case_of(*FULL), load_case("jeffcott", [*SHORT, *FULL, "film.cavitation=sommerfeld"])
    plan, system = planned(case)
    found, state = run(case, plan, system)
    expected, _ = run(other, *planned(replace_mesh(other)))
    assert np.max(np.abs(found)) > 0.5 * system.clearances[0]
    assert np.max(np.abs(found - expected)) < 5e-3 * system.clearances[0]
    assert np.all(state.wet[OIL] >= 1.0)


def replace_mesh(case: Case) -> Case:
    """The case on the mesh that is planned for it."""
    return case.with_settings({"accuracy.mesh": None})


def test_a_fed_film_moves_as_in_the_conservative_form() -> None:
    settings = ["bearing.supply.pressure=2bar", "bearing.ends=oil-bath", SOFT, "speed.duration=0.03s"]
    case = case_of(*settings, "accuracy.mesh=[5,20]")
    other = load_case("jeffcott", [*SHORT, "film.cavitation=two-phase", *settings, "accuracy.mesh=[8,96]"])
    plan, system = planned(case)
    found, _ = run(case, plan, system)
    expected, _ = run(other, *planned(other))
    apart, moved = np.abs(found - expected), np.abs(found - found[0])
    assert np.max(moved) > 0.3 * system.clearances[0]
    assert np.max(apart) < 0.02 * system.clearances[0]


def test_a_rotor_that_rests_stays_there() -> None:
    case = case_of(SOFT, "start.position=resting", "rotor.unbalance=0 kg*m", "speed.duration=0.05s")
    plan, system = planned(case)
    q, _ = run(case, plan, system)
    assert np.max(np.abs(q - q[0])) < 1e-4 * system.clearances[0]


def test_a_fed_film_starts_full() -> None:
    case = case_of("bearing.supply.pressure=2bar")
    _, system = planned(case)
    state = first_state(case.start, system, run_up_profile(case))
    assert np.all(state.wet[OIL] >= 1.0)


def stage_of(system: System, d: tuple[float, float]) -> tuple[ElementFilm, PublishedFilm, ElementWork, Array]:
    """A settled film with the unknowns, past and journal's rows of a stage of 0.1 ms."""
    film, data, g, omega = film_of(system), data_of(system), 1e-4, 2 * math.pi * 30.0
    start = film.steady(Motion(d, (0.0, 0.0), omega)).state
    rows = np.zeros((JOURNAL_ROWS, 2))
    clearance = film.section.clearance
    rows[X_0] = np.array(d) * clearance
    rows[U] = rows[U_0] = np.array([3.0, -8.0]) * clearance
    rows[OMEGA] = omega
    work = make_element_work((data,), 2)
    work.films[0].w[HERE] = unknowns_of(data.unknowns, data.step, start.pressure.ravel())
    work.films[0].past[:] = start.fraction / g
    return data, film, work, rows


def solve_stage(
    data: ElementFilm, work: ElementWork, clearance: float, g: float, contact: tuple[float, float],
    compliance: Array, rows: Array,
) -> int:  # fmt: skip
    """Newton's method of a stage until the film has settled; the iterations."""
    clearances, newton, control = np.array([clearance]), np.zeros((2, 2)), Control(1e-4, 24.0, 1e-3, 1e-3, *contact)
    for iteration in range(MOST_ITERATIONS):
        forces((data,), work, clearances, control, g, 1, iteration, rows)
        share, _, moved, unsettled = correct((data,), work, compliance, clearances, control, g, rows, newton)
        if share == 1.0 and unsettled == 0 and moved < 1e-7:
            return iteration + 1
    raise AssertionError("the stage did not settle")


@pytest.mark.parametrize(("d", "spin"), [((0.1, -0.5), 0.0), ((0.3, -0.92), 0.0), ((0.1, -0.5), 400.0)])
def test_right_sides_of_a_stage_are_derivatives(d: tuple[float, float], spin: float) -> None:
    """Also where the openings turn."""
    _, system = planned(case_of(SOFT))
    data, _, work, rows = stage_of(system, (0.1, -0.5))
    g, omega, own = 1e-4, float(rows[OMEGA, 0]), work.films[0]
    v = np.array([3.0, -8.0])

    def missing(v: Array) -> Array:
        at = np.array(d) + g * v
        against = v[0] + spin * at[1], v[1] - spin * at[0]
        motion = GridMotion(at[0], at[1], omega - 2.0 * spin, *against, spin, g, 1.0 / g)
        residual(data, own.room, own.w[HERE], own.past, motion)
        return own.room.right.copy()

    exact, size = missing(v), 1e-3
    for k in range(2):
        change = np.eye(2)[k] * size
        measured = (missing(v + change)[..., 0] - missing(v - change)[..., 0]) / (2.0 * size)
        np.testing.assert_allclose(measured, exact[..., 1 + k], rtol=1e-5, atol=1e-6 * np.abs(exact[..., 1 + k]).max())


def test_a_stage_holds_both_equations() -> None:
    """The force is that of the film alone, moved as the stage says; the journal moves as that force has it."""
    _, system = planned(case_of(SOFT))
    data, film, work, rows = stage_of(system, (0.1, -0.5))
    g, clearance, compliance = 1e-4, film.section.clearance, 2e-4 * np.eye(2)
    assert solve_stage(data, work, clearance, g, (0.99, 0.0), compliance, rows) <= 8
    d, v = (rows[X_0] + g * rows[U]) / clearance, rows[U] / clearance
    motion = Motion((float(d[0]), float(d[1])), (float(v[0]), float(v[1])), float(rows[OMEGA, 0]))
    alone = film.keep(motion, film.full().pressure, 1.0 / g, work.films[0].past)
    np.testing.assert_allclose(rows[FORCE], alone.response.force, rtol=1e-4)
    assert np.hypot(*(rows[U] - rows[U_0])) > 1e-2 * np.hypot(*rows[U])  # the force does move the journal
    np.testing.assert_allclose(rows[U], rows[U_0] + compliance @ rows[FORCE], rtol=1e-9)


@pytest.mark.parametrize("settings", [(), ("bearing.ends=oil-bath",), ("bearing.supply.pressure=2bar",)])
def test_the_oil_of_the_loop_is_that_of_the_plain_flows(settings: tuple[str, ...]) -> None:
    """What comes in, leaves and is held while the journal moves, with the ends free to air and in an oil bath."""
    _, system = planned(case_of(SOFT, *settings))
    film, data = film_of(system), data_of(system)
    motion = Motion((0.1, -0.5), (3.0, -8.0), 2 * math.pi * 30.0)
    start = film.steady(motion).state
    w = unknowns_of(data.unknowns, data.step, start.pressure.ravel())
    pressure = pressures_of(data.unknowns, data.step, w)[0].reshape(start.pressure.shape)
    rate = 0.7 * np.cos(film.mesh.angle)
    plain = oil_flows(film, motion, pressure, 0.0, -rate)
    found = oil_passing(data, make_room(data), w, -rate, *motion.d, *motion.v, motion.omega)
    assert min(plain.inflow, plain.outflow) > 0.0
    assert found == pytest.approx((plain.inflow, plain.outflow), rel=1e-9)
    held = data.volume * float((open_area(film) * film.gap(motion).height * start.fraction).sum())
    assert oil_held(data, *motion.d, start.fraction) == pytest.approx(held, rel=1e-12)


def test_order_of_the_time_steps() -> None:
    """Third order with a smooth theta(p): errors against eight times as many steps."""
    case = case_of("film.two-phase.steepness=0.5", "bearing.ends=oil-bath", "start.displacement=[0.1,-0.3]",
                   "speed.duration=0.004s", "bearing.supply.pressure=2bar", "accuracy.target=3e-3")  # fmt: skip
    plan, system = planned(case)
    ends = [run(case, plan, system, fixed_steps(case, plan, steps))[1].q for steps in (8, 16, 128)]
    errors = [float(np.max(np.abs(end - ends[-1]))) for end in ends[:2]]
    assert errors[0] < 1e-2 * system.clearances[0]
    assert math.log2(errors[0] / errors[1]) > 2.0


def test_pauses_do_not_change_the_run() -> None:
    case = case_of("speed.duration=0.005s")
    plan, system = planned(case)
    whole, end = run(case, plan, system)
    pieces, paused = run(case, plan, system, budget=7)
    np.testing.assert_array_equal(pieces, whole)
    for one, other in zip(paused, end, strict=True):
        np.testing.assert_array_equal(one, other)


def test_an_interrupted_run_goes_on_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    case = case_of("speed.duration=0.01s")
    whole = frbcli.runup(case, tmp_path / "whole.h5")
    count = 0

    def interrupt(_: object) -> None:
        nonlocal count
        count += 1
        if count == 1:
            os.kill(os.getpid(), signal.SIGINT)

    first = frbcli.runup(case, tmp_path / "pieces.h5", observe=interrupt)
    assert first.status == "interrupted"
    assert 0.0 < first.t_end_s < 0.01
    pieces = frbcli.runup(case, tmp_path / "pieces.h5", resume=True)
    assert pieces.status == whole.status == "finished"
    for name in ("journal_x_m", "eccentricity", "oil_fraction"):
        np.testing.assert_array_equal(pieces[name], whole[name])
    for name in ("oil_in_m3", "oil_created_m3"):
        assert pieces.cost[name] == whole.cost[name]


def test_the_oil_that_it_creates_is_told() -> None:
    """At rest the run creates oil at the rate that the film alone does."""
    case = case_of("start.position=resting", "rotor.unbalance=0 kg*m", SOFT, "speed.duration=0.02s")
    plan, system = planned(case)
    q, end = run(case, plan, system)
    profile = run_up_profile(case)
    film = film_of(system)
    d = system.rotor.journals[0] @ q[-1] / system.clearances[0]
    steady = film.steady(Motion((float(d[0]), float(d[1])), (0.0, 0.0), float(profile.speeds[0])))
    oil = published_loads(film, steady).oil
    rate = -oil.defect_relative * max(oil.in_m3_s, oil.out_m3_s)
    assert rate > 0.1 * oil.out_m3_s
    assert system.films.oil_passed(end.flows)["oil_created_m3"] == pytest.approx(rate * case.speed.duration, rel=2e-2)
    assert np.all(np.isfinite(end.wet[W]))


def test_a_run_reports_it(tmp_path: Path) -> None:
    found = frbcli.runup(case_of("speed.duration=0.01s"), tmp_path / "run.h5")
    assert found.status == "finished"
    cost, share = found.cost, found.error["oil_balance_relative"]
    assert share is not None
    assert 0.0 < share < 1.0
    assert cost["oil_out_m3"] > 0.0
    assert "oil_created_m3" in cost


@pytest.mark.parametrize(
    ("name", "setting", "key"),
    [
        ("floating-ring", "bearing.channels=coupled", "bearing.channels"),
        ("floating-ring", "bearing.outer.cavitation=half-sommerfeld", "film.cavitation"),
        ("jeffcott", "film.grid=half-speed", "film.grid"),
        ("jeffcott", "film.two-phase.whirl_steepness=0.9", "film.two-phase.whirl_steepness"),
    ],
)
def test_what_the_published_form_cannot_do_is_refused(name: str, setting: str, key: str) -> None:
    with pytest.raises(InputError) as refused:
        make_plan(load_case(name, [*PUBLISHED, setting]))
    assert key in [fault.key for fault in refused.value.faults]


RINGED = ["film.two-phase.steepness=0.9", "accuracy.mesh=[3, 12]", "speed.from=100 Hz", "speed.to=101 Hz",
          "speed.duration=3 ms", "output.step=0.1 ms"]  # fmt: skip


@pytest.mark.nightly  # compiles two time loops of two films
def test_a_floating_ring_moves_alike_however_rotor_and_films_are_solved(tmp_path: Path) -> None:
    """Its inner film is fed by holes in the ring, whose elements turn with it."""
    case = load_case("floating-ring", [*PUBLISHED, *RINGED])
    whole = frbcli.runup(case, tmp_path / "whole.h5")
    settings = {"film.coupling": "co-simulation", "accuracy.macro_step": "2 us"}
    apart = frbcli.runup(case.with_settings(settings), tmp_path / "apart.h5")
    for name in ("eccentricity_inner", "eccentricity_outer", "ring_speed_Hz"):
        moved = np.ptp(whole[name])
        assert moved > 1e-2
        np.testing.assert_allclose(apart[name], whole[name], rtol=0.0, atol=5e-3 * moved)
    assert "oil_created_m3" in apart.cost


@pytest.mark.nightly  # compiles a time loop of two films
def test_full_films_around_a_ring_are_those_of_the_other_forms(tmp_path: Path) -> None:
    """The turning holes, too."""
    full = [*RINGED, "accuracy.mesh=[5, 24]", "oil.ambient_pressure=11 bar", "oil.cavitation_pressure=1 bar",
            "bearing.inner.supply.pressure=13 bar", "bearing.outer.supply.pressure=13 bar",
            "bearing.inner.ends=oil-bath", "bearing.outer.ends=oil-bath"]  # fmt: skip
    found = frbcli.runup(load_case("floating-ring", [*PUBLISHED, *full]), tmp_path / "found.h5")
    other = [*full, "accuracy.mesh=[10, 96]", "film.cavitation=sommerfeld"]
    expected = frbcli.runup(load_case("floating-ring", other), tmp_path / "expected.h5")
    for name in ("eccentricity_inner", "eccentricity_outer", "ring_speed_Hz"):
        moved = np.ptp(expected[name])
        assert moved > 1e-2
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=2e-2 * moved)


def test_a_wider_gap_keeps_its_oil_which_no_longer_fills_it() -> None:
    """What the film creates is not what a step of the clearance moves; and there is no pressure left."""
    case = case_of(SOFT, "start.position=resting")
    _, system = planned(case)
    _, after = planned(case.with_settings({"bearing.clearance": "36 um"}))
    state = first_state(case.start, system, run_up_profile(case))
    d = system.rotor.journals[0] @ state.q / after.films.clearances[0]
    before, oil = system.films.oil_passed(state.flows)["oil_created_m3"], state.flows[NOW, 0, HELD]
    force = after.films.refill(0, system.films, (float(d[0]), float(d[1])), state.wet, state.flows)
    assert force is not None
    assert np.hypot(*force) < 0.1 * 29.9  # N, the load
    assert state.flows[NOW, 0, HELD] == pytest.approx(oil, rel=1e-2)
    assert after.films.oil_passed(state.flows)["oil_created_m3"] == pytest.approx(before, abs=1e-18)
