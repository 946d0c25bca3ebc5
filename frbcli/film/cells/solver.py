"""The state of one film for a motion of its journal, to round-off: for kinematic tests, static equilibria and starts.

Balances, derivatives and elimination are the compiled ones of the time loop. Here stands what leads Newton's method to
a solution from afar. The law's kinks make plain Newton steps oscillate between sets of cavitated cells. A storage of w
in each cell, over a pseudo-time step that is longer the less there is left to balance (switched evolution relaxation),
keeps the steps short as long as they have to be; the solution does not know of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import FilmUnsolved
from frbcli.film.cavitation.compiled import given_parameters
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.balances import balances
from frbcli.film.cells.balance.boundaries import feed_at, is_limited, limited
from frbcli.film.cells.balance.ends import CREATED, ENDS_NET, FLOWS, INFLOW, OUTFLOW, SUPPLY_NET
from frbcli.film.cells.balance.states import (
    BEFORE_UPSTREAM,
    CARRIED_GAS,
    FRACTION,
    FRACTION_SLOPE,
    PRESSURE,
    PRESSURE_SLOPE,
    SOURCE,
    STATES,
    TURNOVER,
    UPWIND,
    before_upstream,
    cell_states,
)
from frbcli.film.cells.block_cyclic import CENTRE, ENTRIES, solve_blocks
from frbcli.film.cells.cavity_edge import GapRise, full_cells, gap_rise, set_edges
from frbcli.film.cells.data import SIDES, film_alone, seen_by_grid
from frbcli.film.cells.film import Flows, Motion, Storage, VolumeFilm, VolumeSolution
from frbcli.film.cells.gas.balance import FreeGas, GasMixing, KeptGas, free_gas
from frbcli.film.cells.gas.carry import FACTOR, GAS_PAST, HEIGHT, PATHS, carry_gas, follow_oil, replace_oil
from frbcli.film.gap import gap_rate

ROUND_OFF = 1e-15  # residual of a cell over the terms that it is the sum of
SETTLED = 1e-12  # the same, for a residual that does not fall any more
FALLING = 0.6  # outflow into the air (4.37) falls by e an iteration where nothing else sets the level of a film
LARGEST = 1e9  # beyond this, w is the mark of a singular matrix
SHRINK = 0.3  # the pseudo-time step shrinks to no less than this in one iteration
DRY = -1e-6  # an oil fraction below this is none
REPEATED = 3  # each leaves a tenth of what the oil fractions of the one before are off by
GAS_ROUND_OFF, GAS_SETTLED = 1e-13, 1e-11  # what free gas is off by; the latter where it does not fall any more
# How close cells come to their balances where gas is solved with the oil: where it begins to go with the oil, and last.
# Solutions that are REPEATED may leave more, times PASSED_ON for each that follows and leaves a tenth of it.
BEGUN, CLOSE, PASSED_ON = 1e-4, 1e-14, 10.0
TINY = np.finfo(float).tiny
RUNS_DRY = "the film runs dry: more oil leaves at its ends than can enter it"
# A film is at rest that exchanges less than these shares of what its surfaces can carry, and of its oil in a time step.
STILL_MOTION, STILL_STEP = 1e-4, 1e-6


@dataclass(frozen=True)
class Attempt:
    """One way to go. first: the first pseudo-time step times the motion's rate; growth: the most that it grows by in
    one iteration; limit: of iterations, twice as many while each leaves less than FALLING of the residual; gas: share
    of its change that free gas follows in one iteration."""

    first: float
    growth: float
    limit: int
    gas: float = 1.0


PLAIN = Attempt(math.inf, 1.0, 20)
DAMPED = Attempt(1.0, 4.0, 150)
GENTLE = Attempt(0.1, 1.5, 300)
ATTEMPTS = (PLAIN, DAMPED, GENTLE)
# Gas that begins to go with the oil answers with more than it is given, the finer the cells the more.
GAS_DAMPED, GAS_GENTLE = replace(DAMPED, limit=50, gas=0.5), replace(GENTLE, limit=900, gas=0.2)
GAS_BEGINS: tuple[Attempt, ...] = (GAS_DAMPED, GAS_GENTLE)
GAS_ATTEMPTS: tuple[Attempt, ...] = (replace(PLAIN, limit=60), *GAS_BEGINS)


class FilmSolver:
    """Solves one film for any motion. Its arrays are filled anew in every iteration."""

    def __init__(self, film: VolumeFilm, like: VolumeFilm | None = None) -> None:
        """like: a film that differs from this one in the numbers of its law alone, if its arrays may be at hand."""
        kept, (m, k) = film_alone(film if like is None else like), film.grid.shape
        self.film, self.data = film, kept._replace(films=kept.films.copy())  # how full its openings are is set here
        self.data.films["parameters"][0] = given_parameters(film.law)
        self._parts = self.data.films[0], self.data.ring[0], self.data.places[0], self.data.cells[0]
        self._carries, self._off = False, 0.0  # whether free gas goes with the oil; what it has changed by last
        self._law = np.append(given_parameters(film.law), np.nan)  # where a cell is empty: not asked for here
        self._area = np.where(film.grid.fixed, 0.0, film.grid.area)
        self._states, self._stencil = np.zeros((STATES, m, k)), np.zeros((ENTRIES, m, k))
        self._before, self._paths = np.full((m, k), UPWIND), np.zeros((PATHS, m, k))
        self._blocks, self._fields, self._flows = np.zeros((m, k, k)), np.zeros((m, k, k + SIDES)), np.zeros(FLOWS)

    def steady(self, motion: Motion, start: Array | None = None, upwind: bool = False) -> VolumeSolution:
        """Cells whose oil fraction does not change while the journal moves as it does.

        Oil is carried upwind: what passes a cavity of one pressure does not depend on the oil fraction in it. Where the
        law draws oil in, the pressure in the cavity follows from that oil: then it is carried with second order, each
        of REPEATED solutions holding the oil fractions of the one before.

        start: field of a solution to begin from, else a full film; upwind: whether oil is carried upwind by every law.
        Gas that goes with the oil from the start needs no solution without it before. Where the supply gives a flow at
        most, the openings are filled accordingly. Raises FilmUnsolved. """
        if not is_limited(self.film.section):
            return self._steady(motion, start, upwind)

        def solve(filling: float, near: VolumeSolution | None) -> VolumeSolution:
            return self.filled(filling, motion, start if near is None else near.w, upwind)

        return limited(self.film, solve)

    def filled(self, filling: float, motion: Motion, start: Array | None, upwind: bool = False) -> VolumeSolution:
        """The steady film with its openings at a filling, see boundaries.py. Raises FilmUnsolved."""
        self.fill(filling)
        return replace(self._steady(motion, start, upwind), filling=filling)

    def fill(self, filling: float) -> None:
        """Fill the openings for what is solved from here on, see boundaries.py."""
        own, _, _, _ = self._parts
        own.share, own.fraction = feed_at(self.film, filling)

    def _steady(self, motion: Motion, start: Array | None, upwind: bool) -> VolumeSolution:
        grid, law = self.film.grid, self.film.law
        self._before = np.full(grid.shape, UPWIND)
        rate = gap_rate(motion.velocity_at(grid.height), grid.centre[:, None])
        storage = Storage(rate, np.zeros(grid.shape))
        repeated = REPEATED if law.keeps_oil and not (law.starves or upwind) else 0
        if law.carries_gas:
            return self._steady_with_gas(motion, start, storage, repeated)
        self._settle_gas()
        if start is None:
            start = full_cells(self.film, motion) if self.film.edged else self.film.full()
        solution = self._solve(motion, start, storage)
        for _ in range(repeated):
            self._before = before_upstream(solution.state.fraction, motion.omega)
            solution = self._again(motion, solution, storage)
        return solution

    def _steady_with_gas(
        self, motion: Motion, start: Array | None, storage: Storage, repeated: int
    ) -> VolumeSolution:
        """See steady. Each stage begins from the same stage of a film near by, if `start` includes it; else the gas is
        in equilibrium first, and then begins to go with the oil."""
        begun = start if start is not None and start.ndim > self._area.ndim else np.zeros((0, 0))
        closes = [CLOSE, *(GAS_ROUND_OFF * PASSED_ON**number for number in range(1, 1 + repeated))][::-1]
        self._settle_gas()
        if len(begun) == 0:
            solution = self._solve(motion, self.film.full() if start is None else start, storage)
            self._hold_gas(self.film.gaps(motion), storage, 0.0)
            solution = self._again(motion, solution, storage, BEGUN)
            solution = self._again(motion, solution, storage, closes[0])
        else:
            self._hold_gas(self.film.gaps(motion), storage, 0.0)
            solution = self._solve(motion, self._start_of(begun[0]), storage, closes[0])
        stages = [self._stage(solution)]
        for number in range(1, repeated + 1):
            self._before = before_upstream(solution.state.fraction, motion.omega)
            near = self._start_of(begun[number]) if number < len(begun) else solution.w
            refined = self._solve(motion, near, storage, closes[number])
            solution = replace(refined, iterations=solution.iterations + refined.iterations)
            stages.append(self._stage(solution))
        return replace(solution, stages=np.array(stages))

    def _start_of(self, stage: Array) -> Array:
        """(m, k) w of a stage; the gas of the states <- gas of the stage."""
        w, self._states[CARRIED_GAS], self._states[TURNOVER] = stage
        return np.asarray(w)

    def _stage(self, solution: VolumeSolution) -> Array:
        """(3, m, k) of a solution that the states hold."""
        return np.stack([solution.w, self._states[CARRIED_GAS], self._states[TURNOVER]])

    def keep(
        self, motion: Motion, flowing: Motion, w: Array, rate: float, past: Array, gas: KeptGas | None = None
    ) -> tuple[VolumeSolution, Array]:
        """One step of any implicit formula: d(H theta)/dt = rate H theta - past with past (m, k) from earlier steps.

        motion: at the end of the step; flowing: motion whose gap the oil flows through; w: (m, k) unknown to begin
        from; gas: of a law that carries any. Returns (solution, content H theta). Raises
        FilmUnsolved.
        """
        gap = self.film.gaps(motion)
        storage = Storage(rate * gap, past)
        self._settle_gas()
        if gas is not None:
            self._states[CARRIED_GAS], self._states[TURNOVER] = gas.guess
            self._hold_gas(gap, storage, gas.past)
        self._before = before_upstream(self.film.cells(w, gas and gas.guess).fraction, motion.omega)
        solution = self._solve(flowing, w, storage)
        return solution, gap * solution.state.fraction

    def _again(
        self, motion: Motion, solution: VolumeSolution, storage: Storage, close: float = CLOSE
    ) -> VolumeSolution:
        """The solution that follows one of the same motion, with the iterations of both."""
        refined = self._solve(motion, solution.w, storage, close)
        return replace(refined, iterations=solution.iterations + refined.iterations)

    def _settle_gas(self) -> None:
        """Gas in equilibrium, as it is at once in oil that is not replaced."""
        self._carries, self._off = False, 0.0
        self._states[CARRIED_GAS : TURNOVER + 1] = 0.0

    def _hold_gas(self, gap: Array, storage: Storage, past: Array | float) -> None:
        """What is stored of the gas in cells of the gap H."""
        self._carries = True
        self._paths[HEIGHT], self._paths[FACTOR], self._paths[GAS_PAST] = gap, storage.factor, past

    def _carry(self, motion: Motion) -> float:
        """Free gas follows the oil of the states as they are. Returns the most that it has changed by."""
        off = self._follow(motion)
        return max(off, carry_gas(self._parts[0], motion.omega >= 0.0, 0.0, self._paths, self._states))

    def _follow(self, motion: Motion) -> float:
        """The paths of the oil of the states as they are, see replace_oil."""
        film, _, _, cells = self._parts
        follow_oil(*self._parts, self._states, seen_by_grid(motion, still=True), self._paths)
        return replace_oil(film, cells, self._states, self._paths)

    def _solve(self, motion: Motion, start: Array, storage: Storage, close: float = CLOSE) -> VolumeSolution:
        """Solve by the first attempt that converges. close: what free gas and its oil may be off by."""
        spent, failure = 0, ""
        start = np.ascontiguousarray(start, dtype=np.float64)  # as the kernels take it
        gas = self._states[CARRIED_GAS:BEFORE_UPSTREAM].copy()
        with_gas = GAS_ATTEMPTS if close < BEGUN else GAS_BEGINS
        for attempt in with_gas if self._carries else ATTEMPTS:
            self._states[CARRIED_GAS:BEFORE_UPSTREAM] = gas
            w, iterations, failure = self._iterate(motion, start, storage, attempt, close)
            spent += iterations
            if not failure and np.min(self._states[FRACTION]) < DRY:
                failure = RUNS_DRY  # also where a matrix was so near to a singular one that w leapt far away
            if not failure:
                return self._solution(motion, w, storage, spent)
        if failure == RUNS_DRY:
            raise FilmUnsolved(failure)
        tried = "plain, damped, and damped more"
        raise FilmUnsolved(f"the film did not converge in {spent} Newton iterations ({tried}): {failure}")

    def _iterate(
        self, motion: Motion, w: Array, storage: Storage, attempt: Attempt, close: float
    ) -> tuple[Array, int, str]:
        """(w, iterations, what is wrong or nothing)."""
        passed, mixing = self._passed(motion), GasMixing(self.film.law.gas_content) if self._carries else None
        pseudo_rate, left_before, largest_before = motion.rate / attempt.first, math.inf, math.inf
        worst, off_before = np.zeros_like(w), math.inf
        rise = gap_rise(self.film, motion) if self.film.edged else None
        for iteration in range(1, 2 * attempt.limit + 1):
            residual = self._assemble(motion, w, storage, rise, mixing, attempt.gas)
            with np.errstate(over="ignore"):  # on the way to a failure
                worst = np.abs(residual) / self._terms(passed, w, storage)
            largest, left = float(np.max(worst)), float(np.abs(residual).sum())
            off = self._off
            settled = largest < ROUND_OFF or 0.5 * largest_before <= largest < SETTLED
            if settled and (off < GAS_ROUND_OFF or 0.5 * off_before <= off < GAS_SETTLED):
                return w, iteration, ""
            if 0.0 < off < close and largest < close:
                return w, iteration, ""
            if iteration >= attempt.limit and not largest < FALLING * largest_before:
                return w, iteration, self._where(worst)
            largest_before, off_before = largest, off
            if left_before < math.inf:
                pseudo_rate /= min(max(left_before / left, SHRINK), attempt.growth)
            left_before = left
            self._stencil[CENTRE] += pseudo_rate * self._area
            solve_blocks(self._stencil, self._blocks, self._fields, self._stencil[0, 0], self._fields[0, 0])
            w = w + self._fields[:, :, w.shape[1]]
            if not np.max(np.abs(w)) < LARGEST:
                return w, iteration, "the equations became singular, as they are for a film that no oil can enter"
        return w, 2 * attempt.limit, self._where(worst)

    def _assemble(
        self, motion: Motion, w: Array, storage: Storage, rise: GapRise | None, mixing: GasMixing | None, gas: float
    ) -> Array:
        """(m, k) what does not balance, and in the arrays of the solver Newton's equations. rise: of the gap where the
        edge of the cavity lies within cells; mixing: of the gas that the oil carries; gas: see Attempt."""
        self._states[BEFORE_UPSTREAM] = self._before
        self._set_states(w)
        if rise is not None:
            set_edges(self.film, rise, w, self._states)
        if mixing is not None:
            carried = self._states[CARRIED_GAS:BEFORE_UPSTREAM]
            before = carried.copy()
            self._off = self._carry(motion)
            carried[:2] = mixing.mixed(before[:2], carried[:2], gas)
            self._set_states(w)
        self._flow(motion, storage.past)
        states, kept = self._states, self._area * storage.factor
        self._stencil[CENTRE] += kept * states[FRACTION_SLOPE]
        right = self._fields[:, :, w.shape[1]]
        right -= kept * states[FRACTION]
        return -right

    def states_at(self, motion: Motion, w: Array) -> Array:
        """(STATES, m, k) of the cells and openings with the unknown w, of a film without memory; until it is asked
        for the next ones."""
        self._states[BEFORE_UPSTREAM] = self._before
        self._set_states(w)
        if self.film.edged:
            set_edges(self.film, gap_rise(self.film, motion), w, self._states)
        return self._states

    def _set_states(self, w: Array) -> None:
        """The states of the cells and openings with the unknown w."""
        cell_states(self._parts[0], self._parts[-1], self._law, 0.0, w, self._states)

    def _flow(self, motion: Motion, past: Array) -> None:
        """Balances of the states without what is stored now."""
        at, past = seen_by_grid(motion, still=True), np.ascontiguousarray(past)  # the solver stores by itself
        balances(*self._parts, self._states, at, past, self._stencil, self._fields, self._flows)

    def _passed(self, motion: Motion) -> tuple[Array, Array]:
        """(m, k) what a cell passes on per pressure and per oil fraction of its own, from the derivatives."""
        passed = []
        for slope in (PRESSURE_SLOPE, FRACTION_SLOPE):
            self._states[:CARRIED_GAS] = self._states[BEFORE_UPSTREAM] = 0.0
            self._states[slope] = 1.0
            self._flow(motion, np.zeros(self.film.grid.shape))
            passed.append(self._stencil[CENTRE].copy())
        return passed[0], passed[1]

    def _terms(self, passed: tuple[Array, Array], w: Array, storage: Storage) -> Array:
        """(m, k) size of the terms that the residual is the sum of: it is round-off of theirs."""
        pressure, fraction = self._states[PRESSURE], self._states[FRACTION]
        kept = np.abs(storage.factor * fraction) + np.abs(storage.past) + self._states[SOURCE]
        size = passed[0] * np.abs(pressure) + passed[1] * np.abs(fraction) + self._area * kept
        terms: Array = np.maximum(size + np.abs(self._stencil[CENTRE]) * (1.0 + np.abs(w)), TINY)
        return terms

    def _solution(self, motion: Motion, w: Array, storage: Storage, iterations: int) -> VolumeSolution:
        """The solution that the arrays of the solver hold."""
        film, (pressure, fraction, source) = self.film, self._states[:PRESSURE_SLOPE]
        state = CellState(*self._states[:CARRIED_GAS].copy())
        if film.law.clips:  # so do the flows, as the loads
            pressure[:] = film.pressure(state)
            self._flow(motion, storage.past)
        area = self._area
        still = STILL_MOTION * motion.rate + STILL_STEP * np.abs(storage.past)
        flows = Flows(
            inflow=float(self._flows[INFLOW]),
            outflow=float(self._flows[OUTFLOW]),
            source=float((area * source).sum()) + float(self._flows[CREATED]),
            stored=float((area * (storage.factor * fraction - storage.past)).sum()),
            supply=float(self._flows[SUPPLY_NET]),
            ends=float(self._flows[ENDS_NET]),
            still=float((area * still).sum()),
        )
        return VolumeSolution(w, state, iterations, flows, self._before, self._gas(motion))

    def _gas(self, motion: Motion) -> FreeGas | None:
        """The free gas of the states as they are, None of oil without any."""
        film = self.film
        if not self._carries:
            return None
        self._follow(motion)
        return free_gas(film.law, film.scales, film.grid, self._states, self._paths, self._off)

    def _where(self, worst: Array) -> str:
        """Which cells do not balance."""
        grid = self.film.grid
        i, j = np.unravel_index(int(np.argmax(worst)), worst.shape)
        open_cells = int(np.count_nonzero(worst > SETTLED))
        angle = math.degrees(float(np.mod(grid.centre[i], 2.0 * math.pi)))
        return (
            f"{open_cells} of {worst.size} cells do not balance, the worst at phi = {angle:.0f} deg, "
            f"z = {grid.height[j]:.2f} of the section by {worst[i, j]:.1e} of its flow"
        )
