"""Channels that couple the films of a ring: oil, networks computed by hand, limits, derivatives."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from marches import run_up
from numba import njit
from plain_balances import CellBalances, net_flow
from scipy.optimize import brentq

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.errors import InputError
from frbcli.film.cells.balance.ends import CHANNELS_NET
from frbcli.film.cells.channels import with_channels
from frbcli.film.cells.data import OIL, PASSED, UNKNOWN, W, volume_films
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Channel, channel_resistance
from frbcli.linear.stability import stability
from frbcli.runs.films import oil_defect
from frbcli.runs.march import control_of
from frbcli.runs.start import first_state, rotor_data
from frbcli.scene.films import coupled_channels
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.cosimulation import _solve_films
from frbcli.solve.films.steps import begin_stage, make_work
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, JOURNAL_ROWS, OMEGA, X_0, U
from frbcli.solve.state import METHODS, State, make_output
from frbcli.solve.time_loop import advance

COUPLED = ("bearing.channels=coupled", "accuracy.mesh=[5,32]", "output.step=1e-4")
AT_END = ('bearing.outer.supply={kind="circumferential-groove", pressure="2 bar", axial_position=1}',)
TWO_PHASE = ("film.cavitation=two-phase", "film.two-phase.steepness=0.9")
SHORT = ("speed.from=20 Hz", "speed.to=40 Hz", "speed.duration=0.03 s")
STILL = ("rotor.gravity=0", "rotor.unbalance=0", "film.cavitation=sommerfeld", "speed.from=1e-3 Hz", "speed.to=1e-3 Hz")
BORES = 6


def ringed(*settings: str) -> Case:
    return load_case("floating-ring", (*COUPLED, *settings))


def system_of(case: Case, change: Callable[[Channel], Channel] = lambda channel: channel) -> System:
    """The system of a case, its channels changed."""
    system = make_system(case, make_plan(case))
    channels = [change(channel) for channel in coupled_channels(case, system.films.with_fields)]
    data = volume_films(system.films.with_fields)
    films = replace(system.films, data=with_channels(data, system.films.with_fields, channels))
    return replace(system, films=films)


@njit
def begin(films, work, wet, flows, weights, g):  # type: ignore[no-untyped-def]
    begin_stage(films, work, wet, flows, weights, 1, g, g, 0.0, 1.0)


def feed_hole_pressures(system: System, state: State) -> tuple[float, float]:
    """Gauge pressures in Pa at the first feed holes of the inner and of the outer film."""
    means = []
    for film, w in zip(system.films.with_fields, state.wet[W], strict=True):
        pressure = film.law.cells(w, film.scales).pressure * film.section.pressure_scale
        first = np.argwhere(film.grid.fixed)[0]
        means.append(float(pressure[tuple(first)]))
    return means[0], means[1]


# ------------------------------------------------------------------------------------------------------------- oil


@pytest.mark.parametrize("supply", [AT_END, ()], ids=["end", "groove"])
def test_oil_that_leaves_one_film_enters_the_other(supply: tuple[str, ...]) -> None:
    case = ringed(*AT_END[: len(supply)], *TWO_PHASE, *SHORT)
    system = make_system(case, make_plan(case))
    first = first_state(case.start, system, run_up_profile(case))
    _, last = run_up(case, make_plan(case), system)
    feed_holes = system.films.loop.feed_holes  # type: ignore[union-attr]
    sizes = [film.section.copies * film.section.radius * film.section.width * film.section.clearance
             for film in system.films.with_fields]  # fmt: skip
    assert feed_holes[0].flow_scale == sizes[0]
    brought = np.array(sizes) * last.flows[PASSED, :, CHANNELS_NET]
    if supply:
        assert brought[0] > 0.0
        assert brought.sum() == pytest.approx(0.0, abs=1e-10 * brought[0])
    for i, film in enumerate(system.films.with_fields):
        own = system.films.loop.cells[i, UNKNOWN] != 0.0  # type: ignore[union-attr]
        gained = (film.grid.area * (last.wet[OIL, i] - first.wet[OIL, i]))[own].sum()
        assert gained == pytest.approx(net_flow(last, i), abs=1e-10 * last.flows[PASSED, i].max())
    defect = oil_defect(system, last)
    assert defect is not None
    assert defect < 1e-5


# -------------------------------------------------------------------------------------------------------- networks


def _fed(film: VolumeFilm, feed_holes: float, groove: float) -> float:
    """Oil in m^3/s that six feed holes of a gauge pressure feed into a film beside a groove of another, at rest."""
    section, grid, scale = film.section, film.grid, film.section.pressure_scale
    there = VolumeFilm(
        replace(section, far_pressure=groove),
        replace(grid, fixed_pressure=np.where(grid.fixed, feed_holes / scale, 0.0)),
        film.law, film.scales.reference,
    )  # fmt: skip
    motion = Motion((0.0, 0.0), (0.0, 0.0), 0.0)
    solution = FilmSolver(there).steady(motion)
    flow = solution.flows.supply
    if section.far == "groove":  # which supplies oil as well
        state = solution.state
        fluxes = CellBalances(there.section, there.grid, motion).fluxes(state.pressure, state.fraction)
        flow += float(fluxes.far.sum())
    return flow * section.copies * section.radius * section.width * section.clearance


@pytest.mark.parametrize("resistance", [0.0, 1e13, 1e30], ids=lambda value: f"{value:g}")
def test_films_at_rest_are_a_network(resistance: float) -> None:
    """Oil from the groove leaks through the outer film, passes six channels and leaks through the inner film.

    What the films let pass follows from plain ones with given pressures, one at a time.
    """
    case = ringed(*STILL, *AT_END, "speed.duration=1e-3 s", "accuracy.mesh=[5,36]")  # as many cells under all holes
    system = system_of(case, lambda channel: replace(channel, resistance=resistance))
    inner, outer = system.films.with_fields
    supplied = 1e5
    leak = _fed(inner, 1e5, 0.0) / 1e5
    through = 1.0 / (resistance / BORES + 1.0 / leak)  # flow through channels and inner film per pressure outside

    def left(p_o: float) -> float:
        return -_fed(outer, p_o, supplied) - through * p_o

    p_o = float(brentq(left, 0.0, supplied, xtol=1e-6 * supplied))
    p_i = p_o * through / leak
    found = feed_hole_pressures(system, run_up(case, make_plan(case), system)[1])
    assert found == pytest.approx((p_i, p_o), rel=2e-4, abs=1e-4 * supplied)
    assert 0.3 * supplied < p_o < 0.6 * supplied


def test_resistance_of_a_bore() -> None:
    """128 eta L / (pi d^4); for 2.5 mm through 7.5 mm of ring, with 12 mPa s."""
    assert channel_resistance(2.5e-3, 7.5e-3, 12e-3) == pytest.approx(9.387e7, rel=1e-4)
    case = ringed(*AT_END)
    (first, *_) = coupled_channels(case, make_system(case, make_plan(case)).films.with_fields)
    assert first.resistance == channel_resistance(2.5e-3, 7.5e-3, 12e-3)
    assert first.centrifugal == pytest.approx(830 / 2 * (20e-3**2 - 12.5e-3**2))


def test_a_channel_without_resistance_has_one_pressure_less_what_is_thrown_outwards() -> None:
    """(4.28), of a ring that turns with 100 Hz."""
    inert = ("bearing.ring.inertia=1e6 kg*m^2", "speed.duration=1e-3 s")
    case = ringed(*STILL, *AT_END, *inert)
    system = system_of(case, lambda channel: replace(channel, resistance=0.0))
    state = first_state(case.start, system, run_up_profile(case))
    spin = 200.0 * math.pi
    state.v[list(system.spins)] = spin
    plan = make_plan(case)
    rotor, tableau = rotor_data(system, run_up_profile(case)), METHODS[plan.method].tableau
    parts = rotor, system.films.loop, tableau, control_of(case, plan)
    advance(*parts, state, 10**6, make_output(100, system.rotor.size, 2))
    inner, outer = feed_hole_pressures(system, state)
    assert outer - inner == pytest.approx(830 / 2 * (20e-3**2 - 12.5e-3**2) * spin**2, rel=1e-3)


# ----------------------------------------------------------------------------------------------------- derivatives


@pytest.mark.parametrize("model", [TWO_PHASE, ("film.cavitation=sommerfeld",)], ids=["two-phase", "sommerfeld"])
def test_forces_by_the_velocities_of_both_journals(model: tuple[str, ...]) -> None:
    """Against differences: of the force of one film by the journal of the other, too."""
    case = ringed(*model, *AT_END, "speed.from=100 Hz", "start.displacement=[0.3,-0.4]")
    plan = make_plan(case)
    system, g, control = make_system(case, plan), 1e-5, control_of(case, plan)
    state = first_state(case.start, system, run_up_profile(case))
    clearances = np.array(system.clearances)
    place = (system.rotor.journals @ state.q).ravel()
    weights, turn = np.array([[0.0, 0.0], [0.0, 1.0]]), 0.0 if system.remembers else 0.3

    def solved(u: Array) -> tuple[Array, Array]:
        work = make_work(system.films.loop, state.wet, 2)
        work.grids["turn"], work.grids["speed"] = turn, 150.0  # turn and speed of the ring
        begin(system.films.loop, work, state.wet, state.flows, weights, g)
        film = np.zeros((JOURNAL_ROWS, 4))
        film[U], film[X_0] = u, place
        film[OMEGA] = np.repeat([2 * math.pi * 100.0 + 150.0, 150.0], 2)
        for _ in range(2):  # the derivatives are those of the second time, where all has settled
            assert _solve_films(system.films.loop, work, clearances, control, g, 1, film) > 0
        own = np.zeros((4, 4))
        for f in (0, 2):
            own[f : f + 2, f], own[f : f + 2, f + 1] = film[BY_X, f : f + 2], film[BY_Y, f : f + 2]
        return film[FORCE].copy(), own + work.cross

    at = np.array([1e-3, -2e-3, 1.5e-3, 1e-3])
    _, slopes = solved(at)
    np.testing.assert_allclose(slopes, differences(lambda u: solved(u)[0], at, 1e-5), atol=2e-3 * np.abs(slopes).max())
    assert np.abs(slopes[:2, 2:]).max() > 0.01 * np.abs(slopes).max()


# ------------------------------------------------------------------------------------------------------- and so on


def test_coupled_films_have_no_coefficients_of_their_own() -> None:
    with pytest.raises(InputError, match="neither has coefficients"):
        stability(ringed(*AT_END, "film.cavitation=penalty"), [100.0])


def test_the_plan_tells_of_coupled_channels() -> None:
    (told,) = [decision for decision in make_plan(ringed(*AT_END)).decisions if decision.choice == "channels"]
    assert told.value == "coupled"
    assert "the outer film; resistance 9.39e+07 Pa s/m^3" in told.reason
