"""Channels that couple two films hydraulically: their feed holes as arrays, the flow through them and their pressures.

A feed hole lies over some cells of a film, whose oil and pressure follow the law of that film as in all others. Each
cell of a feed hole exchanges oil with the channel over a conductance that is large against the gap's, so that they have
one pressure as long as they are full; a feed hole in a cavity takes what comes at the cavity's pressure.

The flow from the outer to the inner end of a channel follows from the mean pressures of the cells at its feed holes,

    Q = (p_o - p_i - Delta p) / (R + 1 / k_i + 1 / k_o),    Delta p by (4.27),

with Hagen and Poiseuille's resistance R and the conductances k of the cells of a feed hole to the channel. It is taken
from one film and given to the other one, so that no oil is lost however far the films are from balance.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import Indices, compiled
from frbcli.film.cells.balance.ends import CHANNELS_NET
from frbcli.film.cells.balance.faces import press_cells
from frbcli.film.cells.balance.states import PRESSURE, PRESSURE_SLOPE, pressure_of
from frbcli.film.cells.block_cyclic import CENTRE, UNKNOWN_SIDES, ring_solver
from frbcli.film.cells.data import CHANNEL, EXCHANGE, FEED_HOLE, FEED_HOLES, SIDES, UNKNOWN, Records, VolumeFilms
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.mesh.bores import hole_opening
from frbcli.film.gap import Channel, FeedHole

IN_GROOVE = -1  # instead of a feed hole
OPENNESS = 1e5  # of a feed hole over its gap, centred: the conductances between channel and film, and along the film


def with_channels(data: VolumeFilms, films: Sequence[VolumeFilm], channels: Sequence[Channel]) -> VolumeFilms:
    """The films with channels between them; the cells of their feed holes, given in `films`, become unknown.

    A bore that is too small for the mesh has no cells: its channel is closed.
    """
    channels = [channel for channel in channels if _is_open(films, channel.inner) and _is_open(films, channel.outer)]
    if not channels:
        return data
    cells, own = data.cells.copy(), data.films.copy()
    own["solver_at"] = ring_solver(cells.shape[-1], UNKNOWN_SIDES)
    rows: Records = np.zeros(len(channels), CHANNEL)
    feed_holes, places = [], []
    slots = dict.fromkeys(range(len(films)), 0)

    def opened(feed_hole: FeedHole) -> int:
        film, size = films[feed_hole.film], cells[feed_hole.film]
        inside = _cells(film, feed_hole)
        slot = slots[feed_hole.film]
        slots[feed_hole.film] += 1
        size[UNKNOWN][inside], size[EXCHANGE][inside] = 1.0, _conductances(film)[inside]
        size[FEED_HOLE][inside] = 1.0 + slot
        section, conductance = film.section, size[EXCHANGE][inside].sum()
        feed_holes.append((feed_hole.film, slot, section.flow_scale, section.pressure_scale, conductance))
        places.append(np.argwhere(inside))
        return len(feed_holes) - 1

    for row, channel in zip(rows, channels, strict=True):
        row.inner = opened(channel.inner)
        row.outer = IN_GROOVE if channel.outer is None else opened(channel.outer)
        row.resistance, row.groove_pressure = channel.resistance, channel.groove_pressure
        row.centrifugal = channel.centrifugal
    filled = np.full((len(places), max(map(len, places)), 2), -1, dtype=np.int64)
    for place, cells_of in zip(filled, places, strict=True):
        place[: len(cells_of)] = cells_of
    return data._replace(
        films=own,
        cells=cells,
        channels=rows,
        feed_holes=np.array(feed_holes, FEED_HOLES),
        feed_hole_cells=filled,
    )


def _cells(film: VolumeFilm, feed_hole: FeedHole) -> NDArray[np.bool_]:
    """(m, k) those under a feed hole."""
    return hole_opening(film.section, feed_hole.hole, film.grid.phi, film.grid.z, film.grid.height).inside


def _is_open(films: Sequence[VolumeFilm], feed_hole: FeedHole | None) -> bool:
    return feed_hole is None or bool(_cells(films[feed_hole.film], feed_hole).any())


def _conductances(film: VolumeFilm) -> Array:
    """(m, k) of each cell to a channel above it."""
    around, along = np.diff(film.grid.phi)[:, None], np.diff(film.grid.z)[None, :]
    return np.asarray(OPENNESS * (along / around + film.section.aspect * around / along), dtype=np.float64)


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
