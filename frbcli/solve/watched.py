"""The time loop step by step, for runs that record more than the motion of the rotor. Compiled.

It takes the same steps as `advance`, looks at rotor and films after each of them, and interpolates between the ends of
a step as they are seen: what else a run records is not known inside of a step. """

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cells.balance.balances import FILLING
from frbcli.film.cells.balance.side_flow import side_flow
from frbcli.film.cells.data import PASSED
from frbcli.film.cells.tilted.motion import level
from frbcli.solve.films.forces import drag_integral
from frbcli.solve.films.kinds import by_kind
from frbcli.solve.state import OUTPUTS, RUNNING, TIME, Control, LoopOutput, RotorData, State
from frbcli.solve.tableau import Tableau
from frbcli.solve.time_loop import Space, _advance, make_space

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
