"""What a film in the published two-phase form carries through a run: its state as arrays, and the books of its oil.

State.wet is (WET, 1, e, 9) here: unknowns of the nodes of each element, now and at the start of the step before; oil
fraction and its rate at the points. State.flows is (2, 1, BOOKS) in m^3 and m^3/s: what has passed so far, and what
passes now; the oil in the film changes by what comes in less what leaves and by what the form creates.
"""

from __future__ import annotations

import contextlib
from typing import NamedTuple

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.cells.balances import ENDS_NET, FLOWS, INFLOW, OUTFLOW, SUPPLY_NET
from frbcli.film.cells.plain.balance import Motion
from frbcli.film.grid import Array
from frbcli.film.published.film import PublishedFilm
from frbcli.film.published.loads import oil_content, oil_flows, open_area
from frbcli.film.published.newton import REFERENCES
from frbcli.film.published.unknown import make_unknowns, unknowns_of
from frbcli.solve.films import NOW, OIL, PASSED, RATE, W_BEFORE, WET, W
from frbcli.solve.state import State

GAINED, BOOKS = FLOWS, FLOWS + 1  # by which the oil in the film has grown


class FilmStep(NamedTuple):
    """The film at the end of a step. w (nodes,) unknowns; pressure (2 a, 2 k + 1); fraction, rate (e, 9) at points."""

    w: Array
    pressure: Array
    fraction: Array
    rate: Array


class Layers(NamedTuple):
    """Views of State.wet, each (e, 9)."""

    w: Array
    w_before: Array
    fraction: Array
    rate: Array


def film_layers(state: State) -> Layers:
    """The film's state in that of the run."""
    wet = state.wet[:, 0]
    return Layers(wet[W], wet[W_BEFORE], wet[OIL], wet[RATE])


def unknowns_in(film: PublishedFilm, layer: Array) -> Array:
    """(nodes,) of a layer (e, 9)."""
    w = np.empty(film.mesh.phi.size)
    w[film.mesh.nodes] = layer
    return w


def first_film(film: PublishedFilm, displacement: Array, omega: float) -> tuple[Array, Array]:
    """State.wet and State.flows at the start, the journal at rest at a displacement (2,) in m: settled where that is
    possible, else full at the ambient pressure. omega: omega_J + omega_S in rad/s."""
    d, state = displacement / film.section.clearance, film.full()
    moves = bool(np.any(d != 0.0)) and omega != 0.0
    # Next to an opening of higher pressure a full film at the ambient one is none: its elements would dip below p_cav.
    fixed = film.elements.fixed.reshape(film.mesh.phi.shape)
    fed = bool(np.any(film.mesh.fixed_pressure[fixed] > state.pressure.min()))
    if moves or fed:
        with contextlib.suppress(NotConverged):
            motion = Motion((float(d[0]), float(d[1])), (0.0, 0.0), omega if moves else 0.0)
            state = film.steady(motion).state
    step = film.step_law
    unknowns = make_unknowns(film.mesh, film.elements.fixed, step, REFERENCES[0] * step.cavity)
    wet = np.zeros((WET, 1, *film.mesh.nodes.shape))
    wet[W, 0] = wet[W_BEFORE, 0] = unknowns_of(unknowns, step, state.pressure.ravel())[film.mesh.nodes]
    wet[OIL, 0] = state.fraction
    return wet, np.zeros((2, 1, BOOKS))


def book_step(film: PublishedFilm, state: State, end: FilmStep, place: Array, omega: float, step: float) -> None:
    """Move the film's state on by a step in s, and book what has passed at the mean of the flows before and after.

    place: (2, 3) displacement before and after the step, and velocity after it, over the clearance.
    """
    layers, books = film_layers(state), state.flows[:, 0]
    before, after, rate = ((float(x), float(y)) for x, y in place.T)
    gained = oil_content(film, after, end.fraction) - oil_content(film, before, layers.fraction)
    past = -end.rate  # theta_t as it is
    flows = oil_flows(film, Motion(after, rate, omega), end.pressure, 0.0, past)
    passing = np.zeros(BOOKS)
    passing[[INFLOW, OUTFLOW, ENDS_NET, SUPPLY_NET]] = flows.inflow, flows.outflow, flows.ends, flows.supply
    books[PASSED] += 0.5 * step * (books[NOW] + passing)
    books[NOW] = passing
    books[PASSED, GAINED] += gained
    layers.w_before[:] = layers.w
    layers.w[:] = end.w[film.mesh.nodes]
    layers.fraction[:], layers.rate[:] = end.fraction, end.rate


def mean_fraction(film: PublishedFilm, fraction: Array) -> float:
    """The factor (4.46) of oil fractions (e, 9)."""
    area = open_area(film)
    return float((area * fraction).sum() / area.sum())


def oil_created(state: State) -> float:
    """Oil in m^3 that the form has created so far: what left more than came in and what the film holds more."""
    passed = state.flows[PASSED, 0]
    return float(passed[OUTFLOW] - passed[INFLOW] + passed[GAINED])


def created_share(film: PublishedFilm, state: State) -> float:
    """Size of the oil created over what has passed, or over what the full film holds if less than that has passed."""
    full = oil_content(film, (0.0, 0.0), np.ones(film.mesh.nodes.shape))
    passed = state.flows[PASSED, 0]
    return abs(oil_created(state)) / max(float(passed[INFLOW]), float(passed[OUTFLOW]), full)


def published_oil(state: State) -> dict[str, float]:
    """Oil in m^3 that came in, that left, and that the form created so far."""
    passed = state.flows[PASSED, 0]
    return {
        "oil_in_m3": float(passed[INFLOW]),
        "oil_out_m3": float(passed[OUTFLOW]),
        "oil_created_m3": oil_created(state),
    }
