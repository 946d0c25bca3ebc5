"""Flows of a finite-volume film through its ends and openings, compiled: what the balances of its cells take of them,
and what leaves through its open ends for the balance of its heat. A groove is no open end."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import wright_omega
from frbcli.film.cells.balance.boundaries import BEND, PREFACTOR, STEEPNESS
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, STATES, rests
from frbcli.film.cells.block_cyclic import ABOVE, BELOW, CENTRE
from frbcli.film.cells.data import (
    BATHED,
    BY_ITSELF,
    CLOSED,
    COS,
    EDGES,
    FED,
    FREE,
    GAP,
    LENGTH,
    SIN,
    UNKNOWN,
    GridMotion,
    VolumeFilms,
    add_by_motion,
    film_alone,
    gap_along,
    seen_by_grid,
)
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.roughness.contact import flowing_cube

# Sums over the ends and the given cells: what flows in and out there, the net outflow through the ends and the net
# supply by given cells and grooves; what channels of a ring bring net; free gas that comes in and leaves with the oil,
# and what leaves the solution net, see gas/carry.py; oil created by artificial diffusion, see diffusion.py; and the
# rate of the filling of openings with a flow-limited supply, see boundaries.py.
INFLOW, OUTFLOW, ENDS_NET, SUPPLY_NET, CHANNELS_NET, GAS_IN, GAS_OUT, GAS_RELEASED, CREATED, FILLING, FLOWS = range(11)


class SectionEnd(NamedTuple):
    """The end z = 0 of a section, or z = 1. kind: see ENDS; last, beyond: numbers of the last cell along, and of the
    one before it; place: along the axis; unit: conductance per length around and cube of the gap; bend: see EndSlope;
    groove: scaled pressure there; steepness: b of (4.37) for scaled pressures; roughness: see FILM."""

    kind: int
    last: int
    beyond: int
    place: float
    unit: float
    bend: float
    groove: float
    steepness: float
    roughness: float


@compiled(inline=True)
def section_end(film: np.record, places: Array, k: int, far: bool) -> SectionEnd:
    """An end of a section with k cells along."""
    steepness, aspect, rough = STEEPNESS / film.scales.ambient, film.aspect, film.roughness
    if far:
        end, groove = film.far, film.share * film.far.pressure
        unit = aspect * end.rise
        return SectionEnd(end.kind, k - 1, max(k - 2, 0), places[EDGES, k], unit, end.bend, groove, steepness, rough)
    end = film.near
    unit = aspect * end.rise
    return SectionEnd(end.kind, 0, min(1, k - 1), places[EDGES, 0], unit, end.bend, 0.0, steepness, rough)


def without_ends(film: np.record) -> np.record:
    """A film of which no oil leaves but into its openings, to sum up what these take."""
    closed = film.copy()
    for end in (closed.near, closed.far):
        if end.kind != FED:
            end.kind = CLOSED
    return closed


@compiled(inline=True)
def felt_at_end(last: float, beyond: float, bend: float, groove: float) -> tuple[float, float, float]:
    """Pressure towards an end above the pressure of the groove there, or of the air, by a parabola through the last
    cell and the one beyond it; and its derivatives by the pressures of the two."""
    rise, change = last - groove, bend * (last - beyond)
    by_last, by_beyond = 1.0 + bend, -bend
    if abs(change) > BEND * abs(rise):
        side = math.copysign(BEND, change) * math.copysign(1.0, rise) if rise != 0.0 else 0.0
        change, by_last, by_beyond = side * rise, 1.0 + side, 0.0
    return rise + change, by_last, by_beyond


@compiled()
def falls_to_air(end: SectionEnd, ring: Array, pressures: Array, motion: GridMotion, falls: Array) -> None:
    """falls (m,) <- of the pressure from the last cells to an end, if it is free, times the steepness b of (4.37):
    Wright's omega function, see boundaries.py. pressures: (m, k) of the cells."""
    if end.kind != FREE:
        return
    m, first = pressures.shape[0], PREFACTOR * end.steepness / end.unit
    for i in range(m):
        near, more = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
        cube, _ = flowing_cube(near + end.place * more, end.roughness)
        felt, _, _ = felt_at_end(pressures[i, end.last], pressures[i, end.beyond], end.bend, 0.0)
        falls[i] = math.log(first / cube) + end.steepness * felt
    for i in range(m):  # side by side
        falls[i], _ = wright_omega(falls[i])


@compiled(inline=True)
def flow_at_end(
    end: SectionEnd, ring: Array, pressures: Array, motion: GridMotion, fall: float, i: int
) -> tuple[float, float, float, float]:
    """What leaves column i through an end, and its derivatives by the pressures of the last two cells and by the gap.

    fall: at a free end, see falls_to_air; of it the share that lies in a bath is at the ambient pressure."""
    near, more = gap_along(ring[GAP, i], ring[SIN, i], ring[COS, i], motion)
    (cube, grows), unit = flowing_cube(near + end.place * more, end.roughness), end.unit * ring[LENGTH, i]
    conductance, bathed = cube * unit, ring[BATHED, i]
    felt, by_last, by_beyond = felt_at_end(pressures[i, end.last], pressures[i, end.beyond], end.bend, end.groove)
    slope, per_conductance, by_conductance = conductance, felt, felt
    if end.kind == FREE and bathed < 1.0:
        free, share = 1.0 - bathed, fall / (1.0 + fall)
        slope *= free * share + bathed
        per_conductance = free * fall / end.steepness + bathed * felt
        by_conductance = free * fall * share / end.steepness + bathed * felt
    out = conductance * per_conductance
    return out, slope * by_last, slope * by_beyond, by_conductance * grows * unit


@compiled()
def take(outflow: float, flows: Array) -> None:
    """Openings take oil out of a film, or give it to it where it is less than 0."""
    flows[SUPPLY_NET] -= outflow
    if outflow > 0.0:
        flows[OUTFLOW] += outflow
    else:
        flows[INFLOW] -= outflow


@compiled(makes_arrays=True)
def flow_through_ends(
    film: np.record, ring: Array, cells: Array, places: Array, states: Array, motion: GridMotion, stencil: Array,
    right: Array, flows: Array,
) -> None:  # fmt: skip
    """Add to the balances what leaves through the ends."""
    m, k, falls = states.shape[1], states.shape[2], np.empty(states.shape[1])
    for far in (False, True):
        end = section_end(film, places, k, far)
        if end.kind == CLOSED:
            continue
        j, b, z = end.last, end.beyond, end.place
        falls_to_air(end, ring, states[PRESSURE], motion, falls)
        for i in range(m):
            if cells[UNKNOWN, i, j] == 0.0 or rests(states, i):
                continue
            flow, by_last, by_beyond, by_gap = flow_at_end(end, ring, states[PRESSURE], motion, falls[i], i)
            by_gap *= motion.g
            right[i, j, k + BY_ITSELF] -= flow
            add_by_motion(right, i, j, z, motion.by_ends, -by_gap * ring[SIN, i], by_gap * ring[COS, i])
            stencil[CENTRE, i, j] += by_last * states[PRESSURE_SLOPE, i, j]
            if b > j:
                stencil[ABOVE, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            elif b < j:
                stencil[BELOW, i, j] += by_beyond * states[PRESSURE_SLOPE, i, b]
            leave(end.kind, flow, flows)


@compiled()
def leave(kind: int, flow: float, flows: Array) -> None:
    """Oil leaves through an end of a kind, or comes in where the flow is less than 0."""
    if kind == FED:
        flows[SUPPLY_NET] -= flow
    else:
        flows[ENDS_NET] += flow
    if flow > 0.0:
        flows[OUTFLOW] += flow
    else:
        flows[INFLOW] -= flow


@compiled(makes_arrays=True)
def side_flow(
    film: np.record, ring: Array, places: Array, cells: Array, states: Array, motion: GridMotion, far_open: bool
) -> float:
    """Outflow through the ends in the film's units, by one section."""
    m, k = states.shape[1], states.shape[2]
    total, falls = 0.0, np.empty(m)
    for far in (False, True):
        end = section_end(film, places, k, far)
        if end.kind == CLOSED or (far and not far_open):
            continue
        falls_to_air(end, ring, states[PRESSURE], motion, falls)
        for i in range(m):
            if cells[UNKNOWN, i, end.last] != 0.0:
                flow, _, _, _ = flow_at_end(end, ring, states[PRESSURE], motion, falls[i], i)
                total += max(flow, 0.0)
    return total


def outflow(film: VolumeFilm, motion: Motion, pressure: Array, known: VolumeFilms | None = None) -> float:
    """Outflow through the open ends of the whole bearing in m^3/s, or of a land where the lands differ. pressure (m,
    k): scaled gauge pressures of the cells; known: the film as arrays, where its openings are filled in part."""
    data = known or film_alone(film)
    states = np.zeros((STATES, *pressure.shape))
    states[PRESSURE] = pressure
    own = data.films[0], data.ring[0], data.places[0], data.cells[0]
    return film.section.flow_scale * float(side_flow(*own, states, seen_by_grid(motion), opens_far(film)))


def opens_far(film: VolumeFilm) -> bool:
    """Whether the end z = 1 of a film's section is an end of the bearing."""
    return film.section.far in ("oil-bath", "free-to-air")
