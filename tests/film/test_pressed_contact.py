"""A journal pressed into an elastic shell: all films keep a gap by one rule, cells settle in it, runs go on."""

import functools
import math
from collections.abc import Callable

import films
import numpy as np
import pytest
from differences import differences
from marches import planned_system, rigid

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.film.cavitation.conditions import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.two_phase import Peeken, TwoPhase
from frbcli.film.cells.balance.states import FRACTION
from frbcli.film.cells.data import COS, GAP, SIN, WET, VolumeFilms
from frbcli.film.gap import LARGEST_ECCENTRICITY
from frbcli.film.rectangles.film_force import film_force
from frbcli.film.roughness.contact import KEPT, closes_freely_until, contact_gap
from frbcli.runs.march import March
from frbcli.scene.machine.system import Segment, System
from frbcli.scene.planning.cell_choice import run_up_profile
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.films.cells import EMPTY, OPEN, cell_response, move_even
from frbcli.solve.films.steps import make_work
from frbcli.solve.stage.equations import BY_X, BY_Y, FORCE, JOURNAL_ROWS, OMEGA, U_0, X_0, FilmMotion, U
from frbcli.solve.stage.forces import push_back
from frbcli.solve.stage.journal_newton import forces
from frbcli.solve.state import FINISHED, RUNNING, Control

BASE = "axial-groove-two-phase"
TOUCHES = [0.98, 0.995, 0.9995]  # from where the gap is kept
SOFT = 1e-6  # N/m: a spring that presses with nothing worth the name

# --- the gap ---


@pytest.mark.parametrize("at", [*TOUCHES, 0.9999])
def test_a_fifth_of_the_gap_is_kept(at: float) -> None:
    begins = closes_freely_until(at)
    assert begins == min(at, 0.9995)  # the films can be computed in what is then left
    felt = [float(np.hypot(*contact_gap(begins, eccentricity, 0.0, 0.0, 0.0)[:2])) for eccentricity in (begins, 1.5)]
    assert felt == pytest.approx([begins, 1.0 - KEPT * (1.0 - begins)], abs=1e-12)
    assert max(felt) < LARGEST_ECCENTRICITY + 1e-12


@pytest.mark.parametrize("begins", TOUCHES)
@pytest.mark.parametrize("depth", [1e-6, 0.3, 1.0, 10.0])
def test_the_felt_velocity_is_the_rate_of_the_felt_displacement(begins: float, depth: float) -> None:
    """Both matrices against differences; depth: over the gap at which the surfaces touch."""
    d, v = films.polar(begins + depth * (1.0 - begins), 0.7), np.array([3.0, -8.0])
    felt = contact_gap(begins, *d, *v)
    follows, turns = (np.array([[felt[i], felt[i + 2]], [felt[i + 2], felt[i + 1]]]) for i in (4, 7))
    measured = differences(lambda place: contact_gap(begins, *place, *v)[:4], d, 1e-7 * (1.0 - begins))
    assert follows == pytest.approx(measured[:2], abs=1e-5)
    assert np.array(felt[2:4]) == pytest.approx(follows @ v, rel=1e-12)
    assert turns == pytest.approx(measured[2:], abs=1e-4 * np.hypot(*v) / (1.0 - begins))


@pytest.mark.parametrize("begins", TOUCHES)
def test_the_gap_and_its_rate_have_no_jump(begins: float) -> None:
    """Just after the surfaces touch the film feels what it felt before."""
    d, v = films.polar(begins * (1.0 + 1e-9), 0.7), np.array([3.0, -8.0])
    felt = np.array(contact_gap(begins, *d, *v))
    assert felt[:7] == pytest.approx([*d, *v, 1.0, 1.0, 0.0], abs=1e-6)
    assert felt[7:] == pytest.approx(np.zeros(3), abs=1e-4 * np.hypot(*v) / (1.0 - begins))


# --- every kind of film ---

MESH = "accuracy.mesh=[6,48]"
CASES = {
    "axial grooves": ("axial-groove",),
    "penalty": ("jeffcott", "film.cavitation=penalty"),
    "penalty, cells": ("jeffcott", "film.cavitation=penalty", "film.solution=cells", MESH),
    "two-phase, cells": ("jeffcott", "film.cavitation=two-phase", "film.two-phase.steepness=0.9", MESH),
    "published, cells": (
        "jeffcott", "film.cavitation=two-phase", "film.two-phase.form=published", "film.two-phase.steepness=0.9", MESH,
    ),
}  # fmt: skip
TABULATED = [*films.KINDS, "axial grooves", "penalty"]
ALL = [*TABULATED, "penalty, cells", "two-phase, cells", "published, cells"]
# Films without a pressure of their own, which no work can be taken from where nothing turns.
PASSIVE = [*films.EQUAL_PRESSURES, "penalty", "penalty, cells"]

Pressed = Callable[[Array, Array], Array]  # displacement and velocity over the clearance -> rows of equations.py


@functools.cache
def system_of(kind: str) -> System:
    if kind in films.KINDS:
        bearing = films.KINDS[kind][0]
        return films.system_of(rigid(6.0, 0.0, 0.0), (bearing,), (films.film_of(*films.KINDS[kind]),))
    case = load_case(CASES[kind][0], CASES[kind][1:])
    return planned_system(case)


def rows_of(system: System, d: Array, v: Array, omega: float, g: float) -> Array:
    rows = np.zeros((JOURNAL_ROWS, 2))
    rows[U] = rows[U_0] = v * system.clearances[0]
    rows[X_0] = d * system.clearances[0] - g * rows[U]
    rows[OMEGA] = omega
    return rows


def contact_at(eccentricity: float, stiffness: float) -> Control:
    """Of shells that give way; the rest is of no meaning here."""
    return Control(1e-4, 24.0, 1e-3, 1e-3, eccentricity, stiffness)


def pressed(kind: str, touches: float, omega: float, g: float, stiffness: float = SOFT) -> Pressed:
    """A film with a shell that gives way, ready for stages with this g; films with cells go on from call to call."""
    system = system_of(kind)
    data, clearances = system.films.loop, np.array(system.clearances)
    cells = isinstance(data, VolumeFilms)
    shape = data.cells.shape[2:] if isinstance(data, VolumeFilms) else (0, 0)
    work = make_work(data, np.zeros((WET, int(cells), *shape)), 2)
    if system.remembers and cells:
        work.past[0], work.w[0] = gaps(system, (touches - 0.006) * AHEAD) / g, 0.1  # full just before

    def ask(d: Array, v: Array) -> Array:
        rows = rows_of(system, d, v, omega, g)
        for iteration in range(24):
            forces(data, work, clearances, contact_at(touches, stiffness), g, 1, iteration, rows)
            if not cells or work.grids[0].balance != OPEN:
                return rows
            move_even(data, work, 0, 0.0, 0.0, g)
        raise AssertionError(f"{kind} did not settle at {d}")

    return ask


AHEAD = films.polar(1.0, -1.1)  # the direction in which journals are pressed in
ASIDE = films.polar(1.0, 0.47)


@pytest.mark.parametrize("kind", ALL)
def test_the_force_has_no_jump_over_the_contact(kind: str) -> None:
    """A journal that moves in and slides: where the force is continuous, half the distance makes half the largest
    difference."""
    touches, v = 0.995, 2.0 * AHEAD + 30.0 * ASIDE

    def largest_difference(count: int) -> float:
        ask = pressed(kind, touches, 600.0, 2e-5)
        way = touches + (1.0 - touches) * np.linspace(-1.0, 3.0, count)
        found = np.array([ask(e * AHEAD, v)[FORCE] for e in way])
        return float(np.linalg.norm(np.diff(found, axis=0), axis=1).max() / np.abs(found).max())

    coarse, fine = largest_difference(101), largest_difference(201)
    assert fine < 0.6 * coarse
    assert fine < 0.1


@pytest.mark.parametrize("kind", TABULATED)
def test_the_force_has_no_kink_where_the_surfaces_touch(kind: str) -> None:
    ask, v, step = pressed(kind, 0.995, 600.0, 2e-5), 2.0 * AHEAD + 30.0 * ASIDE, 1e-6
    before, at, after = (ask((0.995 + side) * AHEAD, v)[FORCE] for side in (-step, 0.0, step))
    assert after - at == pytest.approx(at - before, rel=0.01, abs=1e-3 * np.abs(at - before).max())


@pytest.mark.parametrize("eccentricity", [0.99, 0.9965, 1.001])
@pytest.mark.parametrize("kind", [*TABULATED, "penalty, cells"])
def test_derivatives_are_those_of_the_force(kind: str, eccentricity: float) -> None:
    """By the journal's velocity at the end of a stage, with the displacement that it makes, before and in contact."""
    omega, g, stiffness = 600.0, 1e-6 if "cells" in kind else 1e-4, 1e9
    ask, clearance = pressed(kind, 0.995, omega, g, stiffness), system_of(kind).clearances[0]
    d, v, size = eccentricity * AHEAD, 1.0 * AHEAD + 20.0 * ASIDE, 1e-3 if "cells" in kind else 1e-5
    ask(d, v)  # cells tell the derivatives of where they were when they were asked
    exact = ask(d, v)
    found = differences(lambda u: ask(d + g * (u - v), u)[FORCE], v, size).T / clearance
    near = 0.02 if "cells" in kind else 1e-3  # those of a film are those of its integral, not of the sum for it
    assert found == pytest.approx(exact[[BY_X, BY_Y]], rel=near, abs=near * np.abs(found).max())


@pytest.mark.parametrize("kind", PASSIVE)
@pytest.mark.parametrize("slide", [0.0, 0.003, 0.03])
def test_a_cycle_into_the_shell_and_back_takes_energy(kind: str, slide: float) -> None:
    """Nothing turns: whatever way a journal takes in and out of the shell, the film dissipates. slide: along the shell,
    over the clearance, a quarter of a period after the way in."""
    ask = pressed(kind, 0.995, 0.0, 1e-5)
    work, turnover = 0.0, 0.0
    for angle in np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False) + 0.05:
        at, along = 0.997 + 0.006 * math.sin(angle), slide * math.cos(angle)
        rate, slip = 100.0 * 0.006 * math.cos(angle), -100.0 * slide * math.sin(angle)
        n, t = films.polar(1.0, -1.1 + along), films.polar(1.0, 0.5 * math.pi - 1.1 + along)
        v = rate * n + at * slip * t
        power = float(ask(at * n, v)[FORCE] @ v)
        work, turnover = work + power, turnover + abs(power)
    assert work < -0.5 * turnover


@pytest.mark.parametrize("depth", [-0.1, 0.3, 1.2])
def test_table_and_cells_press_alike(depth: float) -> None:
    """The same penalty film by its table and on cells, before and in contact; depth: over the gap at contact."""
    touches, omega = 0.9, 600.0
    d, v = (0.9 + 0.1 * depth) * AHEAD, 3.0 * AHEAD + 40.0 * ASIDE
    table, cells = (pressed(kind, touches, omega, 1e-5)(d, v)[FORCE] for kind in ("penalty", "penalty, cells"))
    assert np.hypot(*(table - cells)) < 0.06 * np.hypot(*table)


@pytest.mark.parametrize("kind", TABULATED)
@pytest.mark.parametrize("eccentricity", [0.5, 0.9994, 0.9997])
def test_nothing_is_changed_where_contact_ends_the_run(kind: str, eccentricity: float) -> None:
    data, d, v = system_of(kind).films.loop, eccentricity * AHEAD, np.array([3.0, -8.0])
    got = pressed(kind, 0.9999, 600.0, 0.0, stiffness=0.0)(d, v)
    assert tuple(got[FORCE]) == film_force(data[0], *(got[X_0] / system_of(kind).clearances[0]), *v, 600.0)[:2]


def test_the_shell_pushes_back_along_the_line_of_centres() -> None:
    clearance, stiffness = 35e-6, 1e9
    d = 1.01 * AHEAD
    f_x, f_y, xx, yy, xy = push_back(*d, clearance, 0.995, stiffness)
    assert np.array([f_x, f_y]) == pytest.approx(-stiffness * clearance * 0.015 * AHEAD)
    found = differences(lambda at: push_back(*at, clearance, 0.995, stiffness)[:2], d, 1e-7)
    assert -found == pytest.approx(np.array([[xx, xy], [xy, yy]]), rel=1e-6)
    assert push_back(0.995, 0.0, clearance, 0.995, stiffness) == (0.0,) * 5
    assert push_back(*d, clearance, 0.995, 0.0) == (0.0,) * 5


# --- cells in contact ---


def cells_of(*settings: str) -> System:
    case = load_case(BASE, ["bearing.supply.pressure=4 bar", "accuracy.mesh=[6,48]", *settings])
    return planned_system(case)


def settle(system: System, felt: Array, w: Array, past: Array, g: float, leaps: bool) -> tuple[int, Array, Array]:
    """(iterations, force, oil fractions) of a film that feels a journal at rest; 24 iterations: it has not settled.
    past: oil at the start over g; leaps: cells may leap over their transition."""
    data: object = system.films.loop
    work = make_work(data, np.zeros((4, 1, *w.shape)), 2)
    work.w[0], work.past[0], grid = w, past, work.grids[0]
    force, states, iteration = np.zeros(2), work.states[0], 0
    at = FilmMotion(felt[0], felt[1], 0.0, 0.0, 1700.0)
    for iteration in range(24):
        force = np.array(cell_response(data, work, 0, at, g, 1, iteration)[:2])  # type: ignore[arg-type]
        if grid.balance != OPEN:
            return iteration, force, states[FRACTION]
        if leaps:
            grid.law[EMPTY] = -math.inf
        move_even(data, work, 0, 0.0, 0.0, g)  # type: ignore[arg-type]
    return iteration + 1, force, states[FRACTION]


def gaps(system: System, felt: Array) -> Array:
    """(m, 1) the gap of the cells."""
    ring = system.films.loop.ring[0]  # type: ignore[union-attr]
    return np.asarray(ring[GAP] + felt[0] * ring[SIN] - felt[1] * ring[COS])[:, None]


def test_a_cell_without_oil() -> None:
    scales, law = Scales(3.0, 0.0, 0.1), TwoPhase(0.99)
    w = law.empty(law.parameters, scales)
    fractions = law.cells(np.array([w - 0.1, w, 0.0, 0.1]), scales).fraction
    below, between, above = np.diff(fractions) / (0.1, -w, 0.1)
    assert max(below, above) < 0.1 * between
    others: tuple[Law, ...] = (Peeken(0.1), Elrod(1e5))
    for other in others:  # their oil goes on below
        assert other.empty(other.parameters, scales) == -math.inf
        steep = other.cells(np.array([-1.1, -0.5]), scales).fraction_slope
        assert min(steep) > 0.9 * max(steep)


def test_cells_of_a_closing_gap_settle() -> None:
    """The narrowest column is to be half full after a very short step, and begins with a huge pressure."""
    system, g = cells_of(), 1e-7
    ring = system.films.loop.ring[0]  # type: ignore[union-attr]
    felt = 0.9997 * np.array([-ring[SIN, 14], ring[COS, 14]])
    past = np.repeat(gaps(system, felt) / g, 6, axis=1)
    past[14] *= 0.6
    w = np.full(past.shape, 0.1)
    w[14] = 25.0
    iterations, _, theta = settle(system, felt, w, past, g, leaps=False)
    assert iterations < 8
    assert theta[14] == pytest.approx(0.6, abs=0.05)
    assert settle(system, felt, w, past, g, leaps=True)[0] == 24


def test_the_force_of_cells_has_no_jump_over_the_contact() -> None:
    """A journal at rest anywhere from before the contact to deep in the shell, as above but each film for itself."""
    system, g, begins = cells_of(), 2e-5, closes_freely_until(0.9999)
    ring = system.films.loop.ring[0]  # type: ignore[union-attr]
    n = np.array([-ring[SIN, 14], ring[COS, 14]])
    past = np.repeat(gaps(system, (begins - 1.2 * (1.0 - begins)) * n) / g, 6, axis=1)

    def largest_difference(count: int) -> float:
        found, w = [], np.full(past.shape, 0.1)
        for depth in np.linspace(-1.0, 3.0, count):
            d = (begins + depth * (1.0 - begins)) * n
            felt = np.array(contact_gap(begins, *d, 0.0, 0.0)[:2]) if depth > 0.0 else d
            iterations, force, _ = settle(system, felt, w, past, g, leaps=False)
            assert iterations < 24
            found.append(force)
        return float(np.max(np.linalg.norm(np.diff(found, axis=0), axis=1)) / np.max(np.abs(found)))

    coarse, fine = largest_difference(401), largest_difference(801)
    assert fine < 0.6 * coarse
    assert fine < 0.05


# --- runs in contact ---


@pytest.mark.parametrize("touches", [0.995, pytest.param(0.9999, marks=pytest.mark.nightly)])
def test_a_whirl_in_the_shell_goes_on(touches: float) -> None:
    """Wherever the gap begins to be kept, the journal sinks into the shell and the run gets to its end."""
    speed = ["speed.from=260 Hz", "speed.to=270 Hz", "speed.duration=0.3 s"]
    case = load_case(BASE, ["bearing.supply.pressure=4 bar", f"contact.eccentricity={touches}", *speed])
    plan, system, profile = make_plan(case), cells_of(), run_up_profile(case)
    march = March(case, plan, [Segment(0.0, case, system)], profile)
    status, largest = RUNNING, 0.0
    while status == RUNNING:
        status, signals = march.chunk()
        largest = max(largest, *signals["eccentricity"], 0.0)
    assert status == FINISHED
    assert 1.0 < largest < 1.03
