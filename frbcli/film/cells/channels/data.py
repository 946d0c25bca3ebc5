"""Channels that couple two films hydraulically, as arrays for the kernels.

A feed hole lies over some cells of a film, whose oil and pressure follow the law of that film as in all others. Each
cell of a feed hole exchanges oil with the channel over a conductance that is large against the gap's, so that they have
one pressure as long as they are full; a feed hole in a cavity takes what comes at the cavity's pressure. """

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.film.cells.block_cyclic import UNKNOWN_SIDES, ring_solver
from frbcli.film.cells.channels.channel import Channel, FeedHole
from frbcli.film.cells.data import CHANNEL, EXCHANGE, FEED_HOLE, FEED_HOLES, UNKNOWN, Records, VolumeFilms
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.mesh.bores import hole_opening

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
        flow_scale = section.copies * section.radius * section.width * section.clearance
        feed_holes.append((feed_hole.film, slot, flow_scale, section.pressure_scale, conductance))
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
