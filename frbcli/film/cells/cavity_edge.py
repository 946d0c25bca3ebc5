"""The edge of the cavity within a cell, and the ends of cells.

The edge of the cavity within a cell, for films at rest of laws whose cavity ends where the film has no slope.

Oil appears in a cavity as fast as its gap opens, at the rate A = omega/2 H' + dH/dt. Before the edge of the cavity the
pressure above it therefore is a r^2 / 2 with a = A / H^3 at the distance r, and has no slope at the edge. Balances of
cells with the cavity between two middles would move the edge onto one of them: forces then have an error of second
order that jumps from cell to cell, and their derivatives one of first order. Let the edge lie s < 1 cells of the length
L behind the middle of the last cell with pressure, p = a (s L)^2 / 2. The pressure flow into this cell is (s + 1/2) A
L, the one into the next cell, which is at cavity pressure, s^2 A L / 2, and the surfaces carry A L more out of it than
into it. It is balanced with a source of A (1 - s)^2 / 2, and so the edge may lie anywhere.

What the heat of the time loop asks finite-volume films for the oil that leaves them. """

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import Indices
from frbcli.film.cavitation.law import CellState
from frbcli.film.cells.balance.states import CARRIED_GAS, PRESSURE, PRESSURE_SLOPE, SOURCE, SOURCE_SLOPE
from frbcli.film.cells.data import Records
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.gap import gap_rate


class GapRise(NamedTuple):
    """How the gap of a film opens. rate: (m, 1) A in 1/s; through: (m, 1) H^3 / L^2, what flows to the next cell for a
    difference of pressure over its area."""

    rate: Array
    through: Array


def gap_rise(film: VolumeFilm, motion: Motion) -> GapRise:
    """How the gap opens in each cell around."""
    phi, centre = film.grid.phi, film.grid.centre
    length, face, gap = np.diff(phi), film.gap(motion.d, phi), film.gap(motion.d, centre)
    rate = 0.5 * motion.omega * np.diff(face) / length + gap_rate(motion.v, centre)
    return GapRise(rate[:, None], (gap**3 / length**2)[:, None])


def full_cells(film: VolumeFilm, motion: Motion) -> Array:
    """(m, k) unknown of a film that is full everywhere, with the cavity one cell behind each."""
    rate, through = gap_rise(film, motion)
    above: Array = np.maximum(rate, 0.0) / through / film.scales.reference
    return film.full() + above


def set_edges(film: VolumeFilm, rise: GapRise, w: Array, states: Array) -> None:
    """states (STATES, m, k), as the law has them without it <- with the edge of the cavity within cells. rise: of the
    gap, see gap_rise."""
    state = film.law.edged(CellState(*states[:CARRIED_GAS]), w, film.scales, *rise)
    free = ~film.grid.fixed
    for layer, values in (
        (PRESSURE, state.pressure),
        (SOURCE, state.source),
        (PRESSURE_SLOPE, state.pressure_slope),
        (SOURCE_SLOPE, state.source_slope),
    ):
        states[layer] = np.where(free, values, states[layer])


def edge_slopes(film: VolumeFilm, motion: Motion, pressure: Array) -> tuple[Array, Array]:
    """(m, k, 2) derivatives of the sources of cells with scaled gauge pressures (m, k) by displacement over the
    clearance, and by its rate: both change how the gap opens."""
    rise, phi, centre = gap_rise(film, motion), film.grid.phi, film.grid.centre

    def sides(angles: Array) -> Array:
        """(n, 2) derivatives of H by the displacement."""
        return np.column_stack([np.sin(angles), -np.cos(angles)])

    slopes = film.law.edge_slopes(pressure, film.scales, *rise)
    by_rate, by_through = (np.where(film.grid.fixed, 0.0, each)[:, :, None] for each in slopes)
    carried = 0.5 * motion.omega * np.diff(sides(phi), axis=0) / np.diff(phi)[:, None]
    wider = 3.0 * rise.through / film.gap(motion.d, centre)[:, None] * sides(centre)
    by_place = by_rate * carried[:, None] + by_through * wider[:, None]
    return by_place, by_rate * sides(centre)[:, None]


class CellEnds(NamedTuple):
    """Finite-volume films as they were made, for the heat of the time loop. far_open (F,); units (F,) m^2: a flow of 1
    over the clearance; films, feed_holes, given (F, m, k) pressures: of VolumeFilms at the reference; resistance
    (channels,) over the viscosity; groove_pressure (channels,) Pa; exponents (F, p): by which the parameters of the
    laws follow the scale of the pressures."""

    far_open: Indices
    units: Array
    films: Records
    given: Array
    feed_holes: Records
    resistance: Array
    exponents: Array
    groove_pressure: Array
