"""The time loop: rotor and films advanced together by an implicit Runge-Kutta method with error control. Compiled.

A step is a few stages (stage/) and what all loops do around them (step.py). All that it is given and carries along is
in state.py, as the methods are.

The time loop step by step, for runs that record more than the motion of the rotor. Compiled.

It takes the same steps as `advance`, looks at rotor and films after each of them, and interpolates between the ends of
a step as they are seen: what else a run records is not known inside of a step.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import by_types, compiled, folder_of
from frbcli.film.cells.balance.ends import FILLING, side_flow
from frbcli.film.cells.data import PASSED, level
from frbcli.solve.drive import brake_at_ports, end_of_turning, overshoots, stage_rotation, turn_on, turns_freely
from frbcli.solve.films.forces import drag_integral, left_over, solved
from frbcli.solve.films.steps import (
    accept_films,
    begin_stage,
    by_kind,
    film_error,
    make_work,
    most_iterations,
    write_oil,
)
from frbcli.solve.heat import (
    NO_HEAT,
    AcceptedStep,
    LumpedHeat,
    begin_heat,
    carry_heat,
    have_heat,
    warm_stage,
    write_heat,
)
from frbcli.solve.inputs import Inputs, set_inputs, supply_warm
from frbcli.solve.ring_spin import Rings, guess_speeds, make_rings, set_speeds, spin_up
from frbcli.solve.scratch import Scratch, make_scratch, selected
from frbcli.solve.stage.equations import (
    STANDING,
    U,
    accelerate,
    begin_lag,
    guess,
    limit_of,
    norm,
    outdated,
    predict,
    prepare,
    start_stage,
)
from frbcli.solve.stage.forces import (
    add_loads,
    left_at_ports,
    prepare_cones,
    prepare_loads,
    push_ports,
    set_sliding,
    shortest,
    turn_cones,
    turn_ports,
)
from frbcli.solve.stage.journal_newton import correct, forces
from frbcli.solve.state import (
    HISTORY,
    INVERSE_SPEED,
    OUTPUTS,
    RUNNING,
    SOLVES,
    STEP_DONE,
    STUCK,
    TIME,
    Control,
    LoopOutput,
    RotorData,
    State,
    Tableau,
)
from frbcli.solve.step import (
    UNSOLVED,
    begin_past,
    begin_stages,
    begin_step,
    choose_next,
    count_step,
    displace,
    end_of_step,
    keep_past,
    local_error,
    move_on,
    reject,
    write_outputs,
)
from frbcli.thermal.exchange import SCALE

NEWTON_SHARE = 0.02  # of the tolerance that Newton's method may leave undone


class Own(NamedTuple):
    """Scratch of this loop besides the stages': newton (m, m); past (HISTORY + stages - 1, 1 + m) times and journals'
    velocities; q_new (n,)."""

    newton: Array
    past: Array
    q_new: Array
    rings: Rings


class Space(NamedTuple):
    """All scratch of this loop; work: of the films, see make_work; heat: a kind of heat.py. In kernels its parts are
    taken by their names: of tuples of tuples that are unpacked, numba releases the arrays too early."""

    scratch: Scratch
    work: Any
    own: Own
    heat: Any


def make_space(rotor: RotorData, films: Any, state: State, stages: int, heat: Any) -> Space:
    """Scratch for a machine in a state, which its heat has changed."""
    n, m = rotor.mass.shape[0], len(selected(rotor))
    begin_heat(heat, films, rotor, state.wet)
    own = Own(
        np.zeros((m, m)), np.zeros((HISTORY + stages - 1, 1 + m)), np.zeros(n), make_rings(rotor.spins.shape[0])
    )
    return Space(make_scratch(rotor, state.numbers, stages), films_work(rotor, films, state, stages, heat), own, heat)


def films_work(rotor: RotorData, films: Any, state: State, stages: int, heat: Any) -> Any:
    """Scratch for the films of a machine in a state, see make_work."""
    scales, shares = heat.now[SCALE] if isinstance(heat, LumpedHeat) else None, None
    if isinstance(rotor.inputs, Inputs) and len(rotor.inputs.pressures):
        scales, shares = rotor.inputs.scales, rotor.inputs.shares
    return make_work(films, state.wet, stages, scales, shares)


@compiled()
def _largest_eccentricity(clearances: Array, selection: Array, journal: Array, q: Array) -> float:
    largest = 0.0
    for f in range(clearances.shape[0]):
        x, y = journal[STANDING, 2 * f], journal[STANDING, 2 * f + 1]
        for i in range(q.shape[0]):
            x += selection[2 * f, i] * q[i]
            y += selection[2 * f + 1, i] * q[i]
        largest = max(largest, norm(x, y) / clearances[f])
    return largest


@compiled(inline=True)
def _smallest(clearances: Array, ports: Any) -> float:
    least = shortest(ports)
    for f in range(clearances.shape[0]):
        least = min(least, clearances[f])
    return least


def advance(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, budget: int, output: LoopOutput,
    heat: Any = NO_HEAT,
) -> tuple[int, int]:  # fmt: skip
    """Advance the state until the output is full, `budget` steps are done, or the run ends.

    The output must have two rows more than one step can write. heat: a kind of heat.py, whose state moves on, too.
    Returns (status, rows written). The course of the steps does not depend on how often this is called.
    """
    space = make_space(rotor, films, state, tableau.times.shape[0], heat)
    status, rows = _advance(rotor, films, tableau, control, state, space, budget, output)
    return int(status), int(rows)


def _at_temperatures(space, rotor, films, wet, bodies, since):  # type: ignore[no-untyped-def]
    warm_stage(space.heat, films, rotor.drag, rotor.clearances, wet, bodies, since)
    supply_warm(rotor.inputs, films, space.heat)


def _if_heat(space: Any, *_: Any) -> Any:
    heat = space.heat if isinstance(space, Space) else space.types[space.fields.index("heat")]
    return _at_temperatures if have_heat(heat) else None  # to take it out of the tuple costs a tenth of a quick stage


@by_types(_if_heat)
def _warm(space: Space, rotor: RotorData, films: Any, wet: Array, bodies: Array, since: float) -> None:
    """The films at the temperatures of a stage, see warm_stage."""


@compiled(inline=True, internal=True)
def _solve_stage(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, space: Space, s: int, t: float,
    step: float, piece: int,
) -> tuple[bool, float]:  # fmt: skip
    """Stage s of a step from t on in a piece of the speed profile: whether it is solved, and its speed."""
    scratch, work, own = space.scratch, space.work, space.own
    numbers, q, v, wet, flows = state.numbers, state.q, state.v, state.wet, state.flows
    clearances, turning, spins, grids = rotor.clearances, rotor.turning, rotor.spins, work.grids
    weights, moments = tableau.stage, tableau.times
    g, m, allowed = weights[1, 1] * step, scratch.selection.shape[0], NEWTON_SHARE * control.tolerance
    selection, products, loads, spread, compliance, elimination, at, journal, stage_v, stage_a = scratch
    newton, past, rings, least = own.newton, own.past, own.rings, _smallest(clearances, rotor.ports)
    t_s = t + moments[s] * step
    predict(weights, s, step, q, v, stage_v, stage_a, at)
    acceleration, speed, angle = stage_rotation(
        rotor.drive, rotor.profile_times, rotor.profile_speeds, rotor.profile_angles, piece, t_s, s, g, at, stage_a
    )
    if outdated(numbers, g, speed, rotor.has_gyroscopic, rotor.follows_speed):
        prepare(rotor, selection, numbers, g, speed, products, loads, spread, compliance, elimination)
        prepare_loads(rotor.loads, rotor, g, speed)
        prepare_cones(rotor.cones, rotor, g, speed)
    start_stage(acceleration, speed, angle, g, rotor.has_gyroscopic, products, loads, selection, at, journal)
    add_loads(rotor.loads, t_s, angle, g, selection, at, journal)
    turn_ports(rotor.ports, speed, angle)
    guess_speeds(spins, s, g, speed, angle, at, stage_a, rings.bodies, rings.angles)
    _warm(space, rotor, films, wet, rings.bodies, moments[s] * step)
    guess(past, tableau.guess, s, selection, q, clearances, g, t_s, limit_of(control.contact_stiffness), journal)
    turn_cones(rotor.cones, rings.bodies, s, s - 1, g, selection, at, stage_a, journal)
    set_speeds(turning, rings.bodies, rings.angles, journal, grids)
    set_sliding(control.rough, turning, rings.bodies)
    begin_stage(films, work, wet, flows, weights, s, step, g, moments[s] * step / numbers[STEP_DONE],
                moments[s] / moments[s - 1] if s > 1 else 1.0)
    lag = begin_lag(numbers, g, speed, at) if rotor.has_gyroscopic else 0.0
    for iteration in range(most_iterations(films)):
        forces(films, work, clearances, control, g, s, iteration, journal)
        push_ports(rotor.ports, clearances.shape[0], g, journal)
        numbers[SOLVES] += solved(films, clearances.shape[0])
        share, left, moved = correct(films, work, compliance, clearances, control, g, journal, newton)
        if left == math.inf:
            return False, speed
        left = left_over(films, work, left, moved)
        left = max(left, left_at_ports(rotor.ports, clearances, compliance, g, journal))
        if share == 1.0:
            late = accelerate(s, g, lag, products, spread, selection, at, journal, stage_v, stage_a)
            left = max(left, g * late / least)
            if spins.shape[0] > 0 or turns_freely(rotor.drive):
                left = max(left, spin_up(films, work, rotor, s, g, control, scratch, rings))
                brake_at_ports(rotor.ports, rotor.drive)
                left = max(left, turn_on(rotor.drive, rotor, t, t_s, s, g, rings.bodies, rings.angles, scratch, least))
                if turns_freely(rotor.drive):
                    speed = rings.bodies[0]
                    lag = g * (speed - numbers[INVERSE_SPEED]) if rotor.has_gyroscopic else 0.0
                    turn_ports(rotor.ports, speed, rings.angles[0])
                set_speeds(turning, rings.bodies, rings.angles, journal, grids)
                set_sliding(control.rough, turning, rings.bodies)
                turned = turn_cones(rotor.cones, rings.bodies, s, s, g, selection, at, stage_a, journal)
                left = max(left, g * turned / least)
            if control.linearised or left < allowed:
                past[HISTORY + s - 1, 0] = t_s
                for i in range(m):
                    past[HISTORY + s - 1, 1 + i] = journal[U, i]
                return True, speed
    return False, speed


def some_are_kept() -> bool:
    """Whether the time loop has been compiled for a machine before, and is on disk with the kernels that it calls."""
    folder = folder_of(_advance)
    return folder is not None and any(folder.glob("*_advance*.nbi"))


@compiled()
def _advance(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, space: Space, budget: int,
    output: LoopOutput,
) -> tuple[int, int]:  # fmt: skip
    """advance with the arrays that it works in."""
    work, own, scratch, heat = space.work, space.own, space.scratch, space.heat
    numbers, q, v, a, past_now, wet, flows, errors = state
    times, speeds, angles = rotor.profile_times, rotor.profile_speeds, rotor.profile_angles
    clearances, weights, journal = rotor.clearances, tableau.stage, scratch.journal
    stage_v, stage_a, q_new = scratch.stage_v, scratch.stage_a, own.q_new
    out_q, out_v, out_oil, out_heat = output
    gamma, order = weights[1, 1], float(tableau.error_order)
    stages, written, done = tableau.times.shape[0], 0, 0

    while done < budget:
        left = len(out_q) - written
        status, t, piece, h, step = begin_step(rotor.drive, v, numbers, times, speeds, angles, control, left)
        if step == 0.0:
            return status, written
        set_inputs(rotor.inputs, films, heat, t, step)
        begin_past(past_now, own.past)
        begin_stages(v, a, stage_v, stage_a)
        g, solved, speed = gamma * step, True, 0.0
        for s in range(1, stages):
            solved, speed = _solve_stage(rotor, films, tableau, control, state, space, s, t, step, piece)
            if not solved:
                break
        error = UNSOLVED
        if solved and overshoots(rotor.drive, numbers, v, stage_v, step):
            continue
        if solved:
            error = local_error(tableau.defect, rotor.observed, stage_v, stage_a, step, g)
            error = (error + film_error(films, work, flows, weights, tableau.defect, step)) / control.tolerance
        if not error <= 1.0:  # not a number counts as too large
            if reject(numbers, step, error, order):
                continue
            return STUCK, written

        t_new = end_of_step(t, step, times[piece + 1])
        displace(weights[stages - 1], stage_v, step, q, q_new)
        before = written
        written = write_outputs(numbers, stage_v, control.output_step, step, t_new, q, q_new, out_q, out_v, written)
        accept_films(films, work, wet, flows, weights, step)
        write_oil(films, work, out_oil, before, written)
        contact = control.contact_eccentricity, control.contact_stiffness, control.rough
        accepted = AcceptedStep(step, g, rotor.torque_terms[1], *contact)
        bodies = own.rings.bodies
        hot = carry_heat(heat, films, work, rotor.turning, journal, bodies, wet, accepted, clearances, rotor.drag)
        until_end = t_new - (numbers[OUTPUTS] - 1.0) * control.output_step
        write_heat(heat, out_heat, before, written, until_end, control.output_step, step)
        numbers[STEP_DONE] = step
        move_on(q, v, a, q_new, stage_v, stage_a)
        keep_past(own.past, past_now)
        done += 1
        largest = _largest_eccentricity(clearances, scratch.selection, journal, q)
        status = count_step(numbers, errors, control, t_new, step, speed, error * control.tolerance, largest)
        stands = end_of_turning(rotor.drive, numbers, stage_v, v, a)
        if status != RUNNING or hot != RUNNING or stands != RUNNING:
            return status if status != RUNNING else max(hot, stands), written
        choose_next(numbers, h, error, order, math.inf)
    return RUNNING, written


# Noted of each film: drag_integral, the oil that leaves it, the filling of its openings (boundaries.py).
DRAG, LEAVES, FILLED, NOTES = range(4)


class Notes(NamedTuple):
    """Records of a run besides its motion: now (n + NOTES films,) the rotor's accelerations and what is noted of its
    films, at the end of the last step, not a number before the first one; rows (rows, the same): at the output times;
    far_open (films,): whether the end z = 1 of the sections of finite-volume films is open."""

    now: Array
    rows: Array
    far_open: Array


def advance_watched(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, budget: int, output: LoopOutput,
    heat: Any, notes: Notes,
) -> tuple[int, int]:  # fmt: skip
    """Advance the state, see advance of time_loop.py, and take notes."""
    space = make_space(rotor, films, state, tableau.times.shape[0], heat)
    status, rows = _advance_watched(rotor, films, tableau, control, state, space, budget, output, notes)
    return int(status), int(rows)


@by_kind(
    cells=lambda films, work, flows, f, far_open: side_flow(
        films.films[f], films.ring[f], films.places[f], films.cells[f], work.states[f],
        level(work.grids[f].x, work.grids[f].y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        far_open[f] != 0.0,
    ),
)  # fmt: skip
def oil_leaving(films: Any, work: Any, flows: Array, f: int, far_open: Array) -> float:
    """Oil that leaves film f now: of cells over its scale, through the open ends; 0 of a film whose motion determines
    it."""
    return 0.0


@by_kind(cells=lambda films, flows, f: flows[PASSED, f, FILLING])
def filling(films: Any, flows: Array, f: int) -> float:
    """The filling of the openings of film f, below 1 only with a flow-limited supply."""
    return 1.0


@compiled()
def _note(
    rotor: RotorData, films: Any, work: Any, q: Array, a: Array, flows: Array, far_open: Array, noted: Array,
) -> None:  # fmt: skip
    n, count = q.shape[0], rotor.clearances.shape[0]
    for i in range(n):
        noted[i] = a[i]
    for f in range(count):
        d_x, d_y = 0.0, 0.0
        for i in range(n):
            d_x += rotor.journals[f, 0, i] * q[i] / rotor.clearances[f]
            d_y += rotor.journals[f, 1, i] * q[i] / rotor.clearances[f]
        noted[n + DRAG * count + f] = drag_integral(films, work, f, d_x, d_y, rotor.torque_terms[1])
        noted[n + LEAVES * count + f] = oil_leaving(films, work, flows, f, far_open)
        noted[n + FILLED * count + f] = filling(films, flows, f)


@compiled(makes_arrays=True)
def _advance_watched(
    rotor: RotorData, films: Any, tableau: Tableau, control: Control, state: State, space: Space, budget: int,
    output: LoopOutput, notes: Notes,
) -> tuple[int, int]:  # fmt: skip
    numbers, q, a, flows = state.numbers, state.q, state.a, state.flows
    noted, status, written, now = notes.now, RUNNING, 0, np.empty_like(notes.now)
    each = min(budget, 1)  # step: a literal would need its own compiled loop besides the one of unwatched runs
    for _ in range(budget):
        t, first = numbers[TIME], numbers[OUTPUTS] - written
        left = LoopOutput(output.q[written:], output.v[written:], output.oil[written:], output.heat[written:])
        status, rows = _advance(rotor, films, tableau, control, state, space, each, left)
        step = numbers[TIME] - t
        if step > 0.0:
            _note(rotor, films, space.work, q, a, flows, notes.far_open, now)
            for row in range(written, written + rows):
                share = min(max(((first + row) * control.output_step - t) / step, 0.0), 1.0)
                for i in range(now.shape[0]):
                    before = noted[i] if noted[i] == noted[i] else now[i]
                    notes.rows[row, i] = before + share * (now[i] - before)
            noted[:] = now
        written += rows
        if status != RUNNING or step == 0.0:
            break
    return status, written
