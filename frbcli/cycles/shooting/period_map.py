"""What a time of constant speed makes of a machine: the map of the time loop that runs use.

The state is x = (q, v, s, theta, c): displacements and velocities of the rotor, and of finite-volume films the filling
of the openings of each one with a flow-limited supply, and of each cell of the mass-conserving films its fraction and,
where the oil carries gas, its free gas over what it has in all, seen from the housing. Plain films have cells that turn
with the oil; what they hold is brought back over the angle that they have turned by, with cubics through four cells.
The steps are of equal length and their number is fixed, so that the map is smooth enough for differences: error control
would change it from one evaluation to the next. Gas is renewed with the oil that it goes with, however slowly it is
released and absorbed. """

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array, Truths
from frbcli.case.schema import Case
from frbcli.cycles.method.continuation import Unreachable
from frbcli.errors import NotConverged
from frbcli.film.cells.balance.boundaries import ALL
from frbcli.film.cells.balance.ends import FILLING, FLOWS
from frbcli.film.cells.data import FILM, GAS, GAS_RATE, OIL, PASSED, RATE, UNKNOWN, W_BEFORE, WET, WET_WITH_GAS, W
from frbcli.rotor.loads import speed_profile
from frbcli.runs.inputs import RunInputs
from frbcli.runs.start import control_of, rotor_data, state_at
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan
from frbcli.solve.state import (
    ERROR_SPANS,
    FINISHED,
    GRID,
    HISTORY,
    METHODS,
    NUMBERS,
    RUN_END,
    RUNNING,
    STEP,
    STEP_DONE,
    Control,
    State,
    Tableau,
    make_output,
)
from frbcli.solve.time_loop import advance

STEPS_PER_REVOLUTION = 100
SMOOTHEST = "esdirk4"  # method where no cells limit the accuracy: 100 steps leave 1e-5 of a cycle
TOLERANCE, SHARPEST = 2e-6, 1e-8  # of the equations in a stage, with cells or without: the rest blurs differences
FIRST_STEP = 1e-6  # of the time: over it the accelerations and rates of the oil settle that belong to the state
NEAREST = 0.99  # eccentricity up to which equal steps are short enough for films without cells
PLACES = (0.25, 0.5, 0.75)  # of the cells at the start of a cycle after the first, in lengths of a cell
SAMPLES = 256  # moments at which displacements are evaluated
MOST_STEPS = 10**6


@dataclass(frozen=True)
class Wet:
    """A machine at one moment. q, v, a: (n,) displacements, velocities and accelerations of the rotor, rings at their
    angle 0; content: (n, m, k) oil fractions of the fields of cells, and behind them, where oil carries gas, their free
    gas over the oil; rate: of H theta and H theta c in 1/s; w: (fields, m, k) unknowns; filling: (fields,) of the
    openings, see boundaries.py. a, rate and w follow from the rest within the first step, and are carried along as its
    guess."""

    q: Array
    v: Array
    a: Array
    content: Array
    rate: Array
    w: Array
    filling: Array


@dataclass(frozen=True)
class Passage:
    """What a time has led to: the state at its end; displacements: (samples + 1, J, 2) over the clearances at equal
    moments from its start to its end, see PeriodMap."""

    end: Wet
    displacements: Array


@dataclass(frozen=True)
class PeriodMap:
    """The time loop of a system, which has J journals: one in each film, or both ends of one that tilts; of a system
    without films the ports of its nonlinear forces, over their lengths. names: of films, or of these ports; films: as
    the loop takes them; journals, standing, clearances: see RotorData, standing (J, 2); seen: (m, n) displacements of
    journals and ports that the loop predicts; turned: (F, 1 + rings) shares in the speed of each film's cells; begun:
    (1 + rings,) angles in rad of rotor and rings at the start, which say how the cells lie there; held: (n, m, k) which
    content is part of the state, and its units (n, 1, 1), see Wet; limited: (fields,) the films whose filling is, and
    lowest: (fields,) the least one; driven: share of the unbalance, and of forces that turn with the rotor."""

    system: System
    names: tuple[str, ...]
    films: Any
    control: Control
    tableau: Tableau
    journals: Array
    seen: Array
    standing: Array
    clearances: Array
    turned: Array
    begun: Array
    held: Truths
    units: Array
    limited: Truths
    lowest: Array
    driven: float = 0.0

    @property
    def smooth(self) -> bool:
        """Whether no cells blur what the map makes of small differences."""
        return not self.system.films.on_cells

    @property
    def limit(self) -> float:
        """Eccentricity up to which cycles are followed; none of a machine without films."""
        if not self.system.films.count:
            return math.inf
        return NEAREST if self.smooth else self.control.contact_eccentricity

    @property
    def slow(self) -> int:
        """How many numbers of a state belong to the rotor and to fillings; the numbers of the oil follow them."""
        return 2 * self.system.rotor.size - self.system.ring_count + int(np.count_nonzero(self.limited))

    @property
    def size(self) -> int:
        """How many numbers a state has."""
        return self.slow + int(np.count_nonzero(self.held))

    @property
    def scale(self) -> float:
        """Clearance in m."""
        return float(self.clearances[0])

    @property
    def lengths(self) -> Array:
        """Units of the displacements in the state: the clearance, or where that moves journals by less, as tilts and
        some modes of a shaft do, what moves one by a clearance."""
        moves = np.abs(self.journals[..., self._kept]).max(axis=(0, 1))
        return np.asarray(self.scale / np.where(moves > 0.0, np.minimum(moves, 1.0), 1.0))

    @property
    def places(self) -> tuple[float, ...]:
        """Further PLACES of the cells at the start of a cycle, which matter where cells turn; with the unbalance the
        cells pass all places within a period."""
        return PLACES if self.turned.any() and self.driven == 0.0 else ()

    def middles(self, d: Array) -> Array:
        """(..., F, 2) displacements in the middle of the films, from displacements of the journals (..., J, 2)."""
        return np.asarray(d.reshape(*d.shape[:-2], len(self.names), -1, 2).mean(axis=-2))

    def at_ends(self, eccentricities: Array) -> Array:
        """(F,) the larger eccentricity of both ends, of the journals' (J,); empty of films that do not tilt."""
        if self.system.films.stations == 1:
            return np.zeros(0)
        return np.asarray(eccentricities.reshape(len(self.names), -1).max(axis=1))

    def packed(self, wet: Wet, omega: float) -> Array:
        """The state of a machine, of the order of 1; omega: speed in rad/s, the unit of velocities."""
        kept = self._kept
        content = (wet.content / self.units)[self.held] / math.sqrt(np.count_nonzero(self.held))
        moved = wet.q[kept] / self.lengths
        return np.concatenate([moved, self._slow(wet.v, omega), wet.filling[self.limited], content])

    def unpacked(self, x: Array, near: Wet, omega: float) -> Wet:
        """The machine of a state; near: whose guesses and given cells it takes."""
        n, kept = len(near.q), self._kept
        m = len(kept)
        q, content, filling = np.zeros(n), near.content / self.units, near.filling.copy()
        q[kept] = x[:m] * self.lengths
        v = x[m : m + n] / self._slow(np.ones(n), omega)
        filling[self.limited] = x[m + n : self.slow]
        content[self.held] = x[self.slow :] * math.sqrt(np.count_nonzero(self.held))
        content *= self.units
        w = self.system.films.oil_unknowns(content, near.content, near.w)
        return replace(near, q=q, v=v, content=content, w=w, filling=filling)

    def lying(self, share: float) -> PeriodMap:
        """The same map with cells that lie a share of their length further on at the start."""
        angle = 2.0 * math.pi * share / self.held.shape[1]
        begun = np.linalg.lstsq(self.turned, np.full(len(self.turned), angle), rcond=None)[0]
        return replace(self, begun=begun)

    def moved(self, wet: Wet, share: float) -> Wet:
        """The same machine seen by cells that lie as `lying` says."""
        angle = -2.0 * math.pi * share / self.held.shape[1]
        content, rate, w = (
            np.stack([turned_back(field, angle) for field in fields]) for fields in (wet.content, wet.rate, wet.w)
        )
        return replace(wet, content=content, rate=rate, w=w)

    def states_on(self, other: PeriodMap, states: Array) -> Array:
        """(N', k) states (N, k), or what states differ by, of the same machine on the cells of another map."""
        own, others = (int(np.count_nonzero(each.held)) for each in (self, other))
        size = self.slow
        fields = np.zeros((*self.held.shape, states.shape[1]))
        fields[self.held] = states[size:]
        oil = resampled(fields, other.held.shape)[other.held]
        return np.vstack([states[:size], oil * math.sqrt(own / max(others, 1))])

    def wet_on(self, other: PeriodMap, wet: Wet, omega: float) -> Wet:
        """The same machine on the cells of another map, turning with omega in rad/s. Raises Unreachable where its films
        settle at no oil from which the given cells follow."""
        settled = wet_at(other, wet.q, wet.v, omega)
        content = np.where(other.held, resampled(wet.content, other.held.shape), settled.content)
        w = other.system.films.oil_unknowns(content, settled.content, settled.w)
        rate = resampled(wet.rate, other.held.shape)
        return replace(settled, a=wet.a, content=content, rate=rate, w=w, filling=wet.filling)

    def motion_of(self, wet: Wet, omega: float) -> Array:
        """Rate of the state's displacements and velocities in 1/s, zero for its oil."""
        moved = np.concatenate([wet.v[self._kept] / self.lengths, self._slow(wet.a, omega)])
        return np.concatenate([moved, np.zeros(self.slow - len(moved) + np.count_nonzero(self.held))])

    def passage(self, wet: Wet, time: float, omega: float, steps: int, samples: int = SAMPLES) -> Passage:
        """After a time in s at a speed in rad/s. Raises Unreachable where the run ends before."""
        rotor = rotor_data(self.system, speed_profile([0.0, time], [omega, omega]))
        rotor = rotor._replace(
            unbalance_cos=self.driven * rotor.unbalance_cos,
            unbalance_sin=self.driven * rotor.unbalance_sin,
            profile_angles=rotor.profile_angles + self.begun[0],
            loads=rotor.loads and rotor.loads._replace(columns=self.driven * rotor.loads.columns),
        )
        control = self.control._replace(output_step=time / samples, longest_step=time / steps, steps_per_revolution=1.0)
        state = self._state(wet, time)
        output = make_output(samples + 8, len(wet.q), self.system.films.count)
        written, status = [], RUNNING
        while status == RUNNING:
            status, count = advance(rotor, self.films, self.tableau, control, state, MOST_STEPS, output)
            written.append(output.q[:count].copy())
        if status != FINISHED or not np.isfinite(state.q).all():
            raise Unreachable
        q = np.concatenate(written)[: samples + 1]
        places = (np.einsum("fij,nj->nfi", self.journals, q) + self.standing) / self.clearances[:, None]
        return Passage(self._end(state, time, omega), places)

    @property
    def _kept(self) -> NDArray[np.int64]:
        """Degrees of freedom whose displacement belongs to the state: all but the angles of rings."""
        return np.arange(self.system.rotor.size - self.system.ring_count)

    def _slow(self, v: Array, omega: float) -> Array:
        """Velocities over half of the speed; of displacements over their units, too."""
        slow = 2.0 * v / omega
        slow[self._kept] /= self.lengths
        return np.asarray(slow)

    def _gaps(self, q: Array, bodies: Array) -> Array:
        """H in the cells of films between rotor and rings at angles (1 + rings,), see Films.gaps."""
        films = self.system.films
        angles = np.repeat(self.turned @ bodies, films.stations)
        d = ((self.journals @ q + self.standing) / self.clearances[:, None])[: len(angles)]  # without films: none
        c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
        return films.gaps(np.hstack([c * d[:, :1] + s * d[:, 1:], c * d[:, 1:] - s * d[:, :1]]))

    def _state(self, wet: Wet, time: float) -> State:
        first = FIRST_STEP * time
        fields = len(wet.w)
        films = np.zeros((WET if len(wet.content) == fields else WET_WITH_GAS, *wet.w.shape))
        films[W] = films[W_BEFORE] = wet.w
        films[OIL] = wet.content[:fields] * self._gaps(wet.q, self.begun)
        films[RATE] = wet.rate[:fields]
        if len(films) > WET:
            films[GAS], films[GAS_RATE] = wet.content[fields:] * films[OIL], wet.rate[fields:]
        numbers = np.zeros(NUMBERS)
        numbers[STEP] = numbers[STEP_DONE] = first
        numbers[RUN_END] = time
        past = np.zeros((HISTORY, 1 + len(self.seen)))
        past[:, 0] = first * np.arange(1 - HISTORY, 1)
        past[:, 1:] = self.seen @ wet.v
        flows, errors = np.zeros((2, fields, FLOWS)), np.zeros((2, ERROR_SPANS))
        flows[PASSED, :, FILLING] = wet.filling
        q = wet.q.copy()
        q[list(self.system.spins)] = self.begun[1:]
        return State(numbers, q, wet.v.copy(), wet.a.copy(), past, films, flows, errors)

    def _end(self, state: State, time: float, omega: float) -> Wet:
        spins = list(self.system.spins)
        bodies = np.concatenate([[self.begun[0] + omega * time], state.q[spins]])
        angles = (self.turned @ (bodies - self.begun))[self.system.films.film_of_cells]
        content, rate, w = (
            np.array([turned_back(*each) for each in zip(fields, itertools.cycle(angles), strict=False)])
            .reshape(fields.shape)
            for fields in (*content_of(state.wet, self._gaps(state.q, bodies)), state.wet[W])
        )  # fmt: skip
        q = state.q.copy()
        q[spins] = 0.0
        return Wet(q, state.v.copy(), state.a.copy(), content, rate, w, self._filling(state))

    def _filling(self, state: State) -> Array:
        """(fields,) fillings; what a line cannot take up goes back to the supply."""
        return np.clip(state.flows[PASSED, :, FILLING], self.lowest, ALL)


def period_map(case: Case, cells: tuple[int, int] | None = None) -> PeriodMap:
    """The map of a case whose films are all on cells. cells: (around, along), default: the cells of its plan."""
    plan = replace(make_plan(case), tolerance=TOLERANCE)  # finite-volume films follow the tolerance
    plan = plan if cells is None else replace(plan, cells=cells)
    system = make_system(case, plan)
    own = system.films
    plan = plan if own.on_cells else replace(plan, tolerance=SHARPEST)
    films = own.changeable().loop if RunInputs.of(case, system).limited else own.loop
    contents, ports = own.gas_contents, system.rotor.ports
    if own.on_cells:
        held = (films.cells[:, UNKNOWN] != 0.0) & np.array(own.remembering)[own.film_of_cells, None, None]
        tableau, turned, records = METHODS[plan.method].tableau, system.turning[:, GRID], films.films
    else:
        held, records = np.zeros((0, 0, 0), dtype=bool), np.zeros(0, FILM)
        tableau, turned = METHODS[SMOOTHEST].tableau, np.zeros_like(system.turning[:, GRID])
    journals, lengths = own.seen(system.rotor.journals), np.repeat(system.clearances, own.stations)
    seen = np.concatenate([journals.reshape(-1, system.rotor.size), *(port.place for port in ports)])
    if not own.count:
        journals, lengths = seen.reshape(-1, 2, system.rotor.size), np.array([port.law.length for port in ports])
    return PeriodMap(
        system=system,
        names=system.names or tuple(port.name.replace("_force", "") for port in ports),
        films=films,
        control=control_of(case, plan, system.asperities),
        tableau=tableau._replace(defect=np.zeros_like(tableau.defect)),
        journals=journals,
        seen=seen,
        standing=own.seen(own.standing) if own.count else np.zeros((len(ports), 2)),
        clearances=lengths,
        turned=turned,
        begun=np.zeros(1 + system.ring_count),
        held=np.concatenate([held, held[: len(contents)] & (contents > 0.0)[:, None, None]]),
        units=np.concatenate([np.ones(len(held)), np.where(contents > 0.0, contents, 1.0)])[:, None, None],
        limited=records["given"] > 0.0,
        lowest=records["lowest"],
    )


def wet_at(flow: PeriodMap, q: Array, v: Array, omega: float) -> Wet:
    """A machine with displacements q and velocities v whose films have settled there. Raises Unreachable."""
    try:
        state = state_at(flow.system, speed_profile([0.0, 1.0], [omega, omega]), q, v)
    except NotConverged:
        raise Unreachable from None
    content, rate = content_of(state.wet, flow._gaps(q, flow.begun))
    return Wet(state.q, state.v, state.a, content, rate, state.wet[W], flow._filling(state))


def content_of(wet: Array, gaps: Array) -> tuple[Array, Array]:
    """(n, m, k) content and rates, see Wet, of films in a state of the time loop whose cells have the gaps H."""
    content, rates = [wet[OIL] / gaps], [wet[RATE]]
    if len(wet) > WET:
        content.append(wet[GAS] / np.where(wet[OIL] > 0.0, wet[OIL], 1.0))
        rates.append(wet[GAS_RATE])
    return np.concatenate(content), np.concatenate(rates)


def resampled(fields: Array, shape: tuple[int, ...]) -> Array:
    """(f, m, k, ...) fields of equal cells on others of a shape (f, m, k): straight between the middles of cells."""
    for axis in (1, 2):
        count, wanted = fields.shape[axis], shape[axis]
        at = (np.arange(wanted) + 0.5) * count / wanted - 0.5
        at = at if axis == 1 else np.clip(at, 0.0, count - 1.0)  # around the last cell lies next to the first
        low = np.floor(at).astype(int)
        share = (at - low).reshape(-1, *(1,) * (fields.ndim - axis - 1))
        below, above = (np.take(fields, index % count, axis) for index in (low, low + 1))
        fields = below + share * (above - below)
    return fields


def turned_back(field: Array, angle: float) -> Array:
    """(m, k) a field of m equal cells around that have turned by an angle in rad, seen from where they began."""
    cells = angle / (2.0 * math.pi) * len(field)
    whole = math.floor(cells + 1e-9)
    x = cells - whole
    if abs(x) < 1e-9:
        return np.roll(field, whole, axis=0)
    weights = (
        -x * (x - 1.0) * (x - 2.0) / 6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        -(x + 1.0) * x * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    )
    return np.asarray(sum(weight * np.roll(field, whole + j - 1, axis=0) for j, weight in enumerate(weights)))
