"""Films on volumes as arrays for the compiled kernels: all films of a machine beside each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.film.cavitation.compiled import addresses, given_parameters
from frbcli.film.cavitation.table import LARGEST_PARAMETERS
from frbcli.film.cells.balance.ends import end_slopes
from frbcli.film.cells.balance.plain import NO_DISTANCE
from frbcli.film.cells.elimination.ring_solver import ring_solver
from frbcli.film.cells.film import VolumeFilm
from frbcli.film.cells.mesh.grid import force_weights
from frbcli.film.gap import gap_height
from frbcli.film.grid import Array

TIGHTLY = 1e-4  # settled, where nothing is said of it

ENDS = {"symmetry": 0, "oil-bath": 1, "groove": 1, "free-to-air": 2}
CLOSED, GIVEN, FREE = range(3)

# Numbers of one film. FOLLOW_AT, CELLS_AT: addresses of its compiled law; SOLVER_AT: of ring_solver; CENTRIFUGAL: by
# which given pressures fall with the square of the grid's speed, in s; CLIPS: 1 where forces clip the pressure at p_cav
# cell by cell, 2 where between the middles of cells; BORED: 1 where flows around take the gaps of both cells, as beside
# bores; SETTLED: share of its pace that its balances may be off by in the mean; from PARAMETERS on: those of its law,
# of a centred journal at 1 rad/s.
(
    ASPECT,
    REFERENCE,
    CAVITY,
    AMBIENT,
    FOLLOW_AT,
    CELLS_AT,
    SOLVER_AT,
    CLIPS,
    REMEMBERS,
    NEAR,
    FAR,
    FAR_PRESSURE,
    NEAR_RISE,
    NEAR_BEND,
    FAR_RISE,
    FAR_BEND,
    FORCE_SCALE,
    CENTRIFUGAL,
    BORED,
    SETTLED,
    PARAMETERS,
) = range(21)
SCALES_END = AMBIENT + 1  # REFERENCE, CAVITY and AMBIENT stand beside each other, as Scales has them
FILM_NUMBERS = PARAMETERS + LARGEST_PARAMETERS
# Rows around the ring: sine and cosine, gap of the centred journal in the middle of each cell and at the face after it;
# length of the cell; what a unit of pressure on it pushes the journal by.
SIN, COS, GAP, FACE_SIN, FACE_COS, FACE_GAP, LENGTH, PUSH_X, PUSH_Y, RING_ROWS = range(10)
# Layers of cells: area in the balance; share of the cell that is film, and by how much the area exceeds it over the
# cell's length; conductance of a gap of 1 to the next cell around and along, 0: none; given pressure; 1 where the
# pressure is an unknown; conductance to the channel of a ring that opens there, and 1 + the number of that hole in
# its film, 0: none; weight in the force; area in which oil is sheared; conductance to the next cell around with a gap
# of its own, beside the edge of an opening, 0: none, and sine, cosine and gap of the centred journal there.
(
    AREA,
    SHARE,
    EXCESS,
    AROUND,
    ALONG,
    GIVEN_PRESSURE,
    UNKNOWN,
    EXCHANGE,
    FEED_HOLE,
    LOAD,
    SHEARED,
    EDGE,
    EDGE_SIN,
    EDGE_COS,
    EDGE_GAP,
    CELL_LAYERS,
) = range(16)
# Numbers of a feed hole: its film and which one of that film it is; what a flow of 1 in the film's units is in m^3/s,
# and a pressure of 1 in Pa; the sum of its cells' conductances.
FILM, SLOT, FLOW_SCALE, PRESSURE_SCALE, CONDUCTANCE, FEED_HOLE_NUMBERS = range(6)
# Numbers of a channel: its feed holes in the inner and in the outer film, the latter -1 in a groove; its resistance in
# Pa s / m^3; gauge pressure of the groove in Pa; by what the pressure rises from the inner to the outer end with the
# square of the ring's speed, in Pa s^2 (4.27).
INNER, OUTER, RESISTANCE, GROOVE_PRESSURE, CHANNEL_CENTRIFUGAL, CHANNEL_NUMBERS = range(6)


class VolumeFilms(NamedTuple):
    """Films of equal numbers of cells m x k. numbers: (films, FILM_NUMBERS); ring: (films, RING_ROWS, m); width:
    (films, 1, k) sizes of the cells along the axis; cells: (films, CELL_LAYERS, m, k). Of coupled
    channels: channels (channels, CHANNEL_NUMBERS), feed_holes (holes, FEED_HOLE_NUMBERS) and their cells,
    feed_hole_cells (holes, n, 2), filled up with -1."""

    numbers: Array
    ring: Array
    width: Array
    cells: Array
    channels: Array
    feed_holes: Array
    feed_hole_cells: NDArray[np.int64]


def volume_films(
    films: Sequence[VolumeFilm],
    centrifugal: Sequence[float] = (),
    settled: float = TIGHTLY,
) -> VolumeFilms:
    """The films as arrays; all have grids of the same shape. centrifugal: in s; settled: see SETTLED."""
    m, k = films[0].grid.shape
    data = VolumeFilms(
        np.zeros((len(films), FILM_NUMBERS)),
        np.zeros((len(films), RING_ROWS, m)),
        np.zeros((len(films), 1, k)),
        np.zeros((len(films), CELL_LAYERS, m, k)),
        np.zeros((0, CHANNEL_NUMBERS)),
        np.zeros((0, FEED_HOLE_NUMBERS)),
        np.zeros((0, 0, 2), dtype=np.int64),
    )
    for index, film in enumerate(films):
        _fill(film, data.numbers[index], data.ring[index], data.width[index], data.cells[index])
        data.numbers[index, CENTRIFUGAL] = centrifugal[index] if centrifugal else 0.0
        data.numbers[index, SETTLED] = settled
    return data


def _fill(film: VolumeFilm, numbers: Array, ring: Array, width: Array, cells: Array) -> None:
    section, grid, scales, law = film.section, film.grid, film.scales, film.law
    follow_at, cells_at = addresses(law)
    near, far = end_slopes(grid.z)
    centred = (0.0, 0.0)
    values = {
        ASPECT: section.aspect,
        REFERENCE: scales.reference,
        CAVITY: scales.cavitation,
        AMBIENT: scales.ambient,
        FOLLOW_AT: follow_at,
        CELLS_AT: cells_at,
        SOLVER_AT: ring_solver(grid.shape[1]),
        CLIPS: float(law.clips) + float(film.clips_between),
        REMEMBERS: float(law.keeps_oil),
        NEAR: ENDS[section.near],
        FAR: ENDS[section.far],
        FAR_PRESSURE: section.far_pressure / section.pressure_scale if section.far == "groove" else 0.0,
        NEAR_RISE: near.rise,
        NEAR_BEND: near.bend,
        FAR_RISE: far.rise,
        FAR_BEND: far.bend,
        BORED: float(grid.has_bores),
        FORCE_SCALE: section.copies * section.radius * section.width * section.pressure_scale,
    }
    for place, value in values.items():
        numbers[place] = value
    numbers[PARAMETERS:] = given_parameters(law)
    face = grid.phi[1:]
    ring[SIN], ring[COS], ring[GAP] = (
        np.sin(grid.centre),
        np.cos(grid.centre),
        gap_height(section, centred, grid.centre),
    )
    ring[FACE_SIN], ring[FACE_COS], ring[FACE_GAP] = np.sin(face), np.cos(face), gap_height(section, centred, face)
    ring[LENGTH] = np.diff(grid.phi)
    ring[PUSH_X], ring[PUSH_Y] = -np.diff(np.cos(grid.phi)), -np.diff(np.sin(grid.phi))
    width[0] = np.diff(grid.z)
    cells[AREA], cells[SHARE], cells[EXCESS] = grid.area, grid.share, grid.excess
    cells[SHEARED] = (1.0 - grid.cover) * grid.size
    cells[LOAD] = force_weights(section, grid)
    around = np.where(grid.around > 0.0, width[0] / np.maximum(grid.around, NO_DISTANCE), 0.0)
    edge = grid.at != grid.phi[1:, None]
    cells[AROUND], cells[EDGE] = np.where(edge, 0.0, around), np.where(edge, around, 0.0)
    cells[EDGE_SIN], cells[EDGE_COS] = np.sin(grid.at), np.cos(grid.at)
    cells[EDGE_GAP] = gap_height(section, centred, grid.at.ravel()).reshape(grid.shape)
    open_along = np.where(grid.along > 0.0, ring[LENGTH][:, None] / np.maximum(grid.along, NO_DISTANCE), 0.0)
    cells[ALONG, :, :-1] = section.aspect * open_along
    cells[GIVEN_PRESSURE], cells[UNKNOWN] = grid.fixed_pressure, np.where(grid.fixed, 0.0, 1.0)
