"""Flow through the channels between two films, and their pressures, compiled; see data.py.

The flow from the outer to the inner end of a channel follows from the mean pressures of the cells at its feed holes,

    Q = (p_o - p_i - Delta p) / (R + 1 / k_i + 1 / k_o),    Delta p by (4.27),

with Hagen and Poiseuille's resistance R and the conductances k of the cells of a feed hole to the channel. It is taken
from one film and given to the other one, so that no oil is lost however far the films are from balance.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices, compiled
from frbcli.film.cells.balance.ends import CHANNELS_NET
from frbcli.film.cells.balance.faces import press_cells
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, pressure_of
from frbcli.film.cells.block_cyclic import CENTRE
from frbcli.film.cells.data import EXCHANGE, FEED_HOLE, SIDES, Records


@compiled()
def exchange(cells: Array, states: Array, channel: Array, stencil: Array, right: Array, flows: Array) -> None:
    """Add to the balances of a film (see balances) what channels of the pressures channel (m, k) bring to its cells."""
    m, k = channel.shape
    for i in range(m):
        for j in range(k):
            open_ = cells[EXCHANGE, i, j]
            if open_ != 0.0:
                brought = open_ * (channel[i, j] - states[PRESSURE, i, j])
                right[i, j, k] += brought
                stencil[CENTRE, i, j] += open_ * states[PRESSURE_SLOPE, i, j]
                flows[CHANNELS_NET] += brought


@compiled()
def ask_of_channels(cells: Array, right: Array) -> None:
    """The last layers of right (m, k, k + SIDES + slots) <- derivatives of exchange by the channels' pressures."""
    m, k, layers = right.shape
    for i in range(m):
        for j in range(k):
            for layer in range(k + SIDES, layers):
                right[i, j, layer] = 0.0
            if cells[FEED_HOLE, i, j] != 0.0:
                right[i, j, k + SIDES - 1 + int(cells[FEED_HOLE, i, j])] = cells[EXCHANGE, i, j]


@compiled()
def feed_hole_pressure(
    film: np.record, cells: Array, law: Array, w: Array, feed_hole: np.record, places: Indices
) -> float:
    """Mean pressure of the cells of a feed hole, by their conductances."""
    total = 0.0
    for n in range(places.shape[0]):
        i, j = places[n, 0], places[n, 1]
        if i >= 0:
            total += cells[EXCHANGE, i, j] * pressure_of(film, law, w[i, j])
    return total / float(feed_hole.conductance)


@compiled()
def _entry(feed_hole: np.record) -> float:
    """Resistance between the cells of a feed hole and the channel, Pa s / m^3."""
    return float(feed_hole.pressure_scale / (feed_hole.flow_scale * feed_hole.conductance))


@compiled()
def channel_pressures(channels: Records, feed_holes: Records, spins: Array, means: Array) -> None:
    """means (feed_holes,) of the pressures at the feed holes <- the pressures of the channels' ends, in the units of
    their films. spins: (films,) speeds of their grids."""
    for c in range(channels.shape[0]):
        inner, outer = channels[c].inner, channels[c].outer
        scale, entry = feed_holes[inner].pressure_scale, _entry(feed_holes[inner])
        spin = spins[feed_holes[inner].film]
        fall = -scale * means[inner] - channels[c].centrifugal * spin * spin
        resistance = channels[c].resistance + entry
        if outer >= 0:
            fall += feed_holes[outer].pressure_scale * means[outer]
            resistance += _entry(feed_holes[outer])
        else:
            fall += channels[c].groove_pressure
        flow = fall / resistance
        means[inner] += flow * entry / scale
        if outer >= 0:
            means[outer] -= flow * _entry(feed_holes[outer]) / feed_holes[outer].pressure_scale


@compiled()
def follow_means(channels: Records, feed_holes: Records, matrix: Array) -> None:
    """matrix (feed_holes, n) of changes of the means at the feed holes <- those at the channels' ends, as
    channel_pressures."""
    for c in range(channels.shape[0]):
        inner, outer = channels[c].inner, channels[c].outer
        scale, entry = feed_holes[inner].pressure_scale, _entry(feed_holes[inner])
        resistance = channels[c].resistance + entry
        if outer >= 0:
            resistance += _entry(feed_holes[outer])
        for n in range(matrix.shape[1]):
            flow = -scale * matrix[inner, n] / resistance
            if outer >= 0:
                flow += feed_holes[outer].pressure_scale * matrix[outer, n] / resistance
                matrix[outer, n] -= flow * _entry(feed_holes[outer]) / feed_holes[outer].pressure_scale
            matrix[inner, n] += flow * entry / scale


@compiled()
def mean_changes(
    cells: Array, states: Array, fields: Array, feed_hole: np.record, places: Indices, changes: Array
) -> None:
    """changes (SIDES + slots,) <- changes of the mean pressure of a feed hole with the layers of fields, see
    film_newton."""
    k = fields.shape[1]
    for layer in range(changes.shape[0]):
        changes[layer] = 0.0
    for n in range(places.shape[0]):
        i, j = places[n, 0], places[n, 1]
        if i >= 0:
            share = cells[EXCHANGE, i, j] * states[PRESSURE_SLOPE, i, j] / feed_hole.conductance
            for layer in range(changes.shape[0]):
                changes[layer] += share * fields[i, j, k + layer]


@compiled()
def push_of_channel(
    film: np.record, ring: Array, cells: Array, states: Array, fields: Array, slot: int, push: Array,
) -> tuple[float, float]:  # fmt: skip
    """(x, y): the force on the journal in N per pressure of one channel, see film_loads. push: see press_cells."""
    m, k = states.shape[1], states.shape[2]
    press_cells(film, ring, cells, states, fields, push)
    x, y = 0.0, 0.0
    for i in range(m):
        for j in range(k):
            change = states[PRESSURE_SLOPE, i, j] * fields[i, j, k + SIDES + slot]
            x += push[0, i, j] * change
            y += push[1, i, j] * change
    return film.force_scale * x, film.force_scale * y
