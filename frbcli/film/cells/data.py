"""Films on volumes as arrays for the compiled kernels: all films of a machine side by side; and the motion of a journal
as the kernels of a film see it, with the gap that it makes along the axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.cavitation.compiled import addresses, given_parameters
from frbcli.film.cavitation.table import LARGEST_PARAMETERS
from frbcli.film.cells.balance.boundaries import end_slopes, supply_line, supply_pressure
from frbcli.film.cells.block_cyclic import ring_solver
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.mesh.grid import VolumeGrid, force_weights
from frbcli.film.gap import Section, gap_height

Records = NDArray[np.record]
FEW = 64  # films whose arrays are kept
TIGHTLY = 1e-4  # settled, where nothing is said of it

CLOSED, GIVEN, FREE, FED = range(4)
ENDS = {"symmetry": CLOSED, "oil-bath": GIVEN, "groove": FED, "free-to-air": FREE}
# Right-hand sides of the balances: their own, and by the velocity of the journal, or by those at both ends
BY_ITSELF, BY_X, BY_Y, SIDES = range(4)
BY_ENDS, ALL_SIDES = 1, 5
# Of forces: how they clip the pressure at p_cav.
NO_CLIP, BY_CELLS, BETWEEN_MIDDLES = range(3)

NO_DISTANCE = 1e-30  # between two cells of a groove: nothing flows there


def record(*fields: tuple[Any, ...]) -> Any:
    """A record whose fields Python and the kernels read by name."""
    return np.dtype((np.record, np.dtype(list(fields), align=True)))


SCALES = record(("reference", "f8"), ("cavitation", "f8"), ("ambient", "f8"))  # see Scales
# An end of a section: CLOSED, GIVEN, FREE, or FED by a groove; the slope of the pressure there, see EndSlope; the
# pressure in a groove; 1 over the distance from the last unknown, with the seal, over which oil diffuses.
END = record(("kind", "i8"), ("rise", "f8"), ("bend", "f8"), ("pressure", "f8"), ("reach", "f8"))
# One film. follow_at, cells_at: addresses of its compiled law; solver_at: of ring_solver; remembers: whether it is
# mass-conserving; carries_gas: whether its oil carries free gas; bored, edges: whether flows around take
# the gaps of both cells, as next to bores, or those at edges of openings;
# centrifugal: by which given pressures fall with the square of the grid's speed, in s;
# supplied_gas, gas_content: free gas of the oil that is supplied, and all gas of the oil, of a law that carries any;
# settled: share of its pace that its balances may be off by in the mean; roughness, over the clearance, of surfaces
# that it flows between, and shear: see Section; diffuses, length, spread: whether it has an artificial diffusion, its
# L, and by how much more it acts along than around, see balance/diffusion.py; parameters: of its law, of a centred
# journal at 1 rad/s. Its openings hold the oil fraction `fraction` at `share` of the given pressures, of which `supply`
# is the largest; of a flow-limited supply: given, line and lowest of supply_line.
FILM = record(
    ("aspect", "f8"),
    ("scales", SCALES),
    ("force_scale", "f8"),
    ("near", END),
    ("far", END),
    ("centrifugal", "f8"),
    ("settled", "f8"),
    ("supplied_gas", "f8"),
    ("gas_content", "f8"),
    ("follow_at", "i8"),
    ("cells_at", "i8"),
    ("solver_at", "i8"),
    ("clips", "i8"),
    ("remembers", "?"),
    ("carries_gas", "?"),
    ("bored", "?"),
    ("edges", "?"),
    ("roughness", "f8"),
    ("shear", "f8"),
    ("diffuses", "?"),
    ("length", "f8"),
    ("spread", "f8"),
    ("fraction", "f8"),
    ("share", "f8"),
    ("supply", "f8"),
    ("given", "f8"),
    ("line", "f8"),
    ("lowest", "f8"),
    ("parameters", "f8", (LARGEST_PARAMETERS,)),
)
# Rows around the ring: sine and cosine, gap of the centred journal in the middle of each cell and at the face after it;
# length of the cell; what a unit of pressure on it pushes the journal by; its share whose free ends lie in a bath.
SIN, COS, GAP, FACE_SIN, FACE_COS, FACE_GAP, LENGTH, PUSH_X, PUSH_Y, BATHED, RING_ROWS = range(11)
# Layers of cells: area in the balance; share of the cell that is film, and by how much the area exceeds it over the
# cell's length; conductance of a gap of 1 to the next cell around and along, 0: none; given pressure; 1 where the
# pressure is an unknown; conductance to the channel of a ring that opens there, and 1 + the number of that hole in its
# film, 0: none; weight in the force; area in which oil is sheared; conductance to the next cell around with its own
# gap, next to the edge of an opening, 0: none, and sine, cosine and gap of the centred journal there.
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
# Where the middles of the cells and their edges lie along the axis, 0 at the near end and 1 at the far end: of their
# section, or of the bearing of a journal that tilts; and the sizes of the cells over the width of the section.
MIDDLES, EDGES, WIDTHS, PLACES = range(4)
# A feed hole: its film and which one of that film it is; what a flow of 1 in the film's units is in m^3/s, and a
# pressure of 1 in Pa; the sum of its cells' conductances.
FEED_HOLES = record(
    ("film", "i8"), ("slot", "i8"), ("flow_scale", "f8"), ("pressure_scale", "f8"), ("conductance", "f8")
)  # fmt: skip
# A channel: its feed holes in the inner and in the outer film, the latter -1 in a groove; its resistance in
# Pa s / m^3; gauge pressure of the groove in Pa; by what the pressure rises from the inner to the outer end with the
# square of the ring's speed, in Pa s^2 (4.27).
CHANNEL = record(
    ("inner", "i8"), ("outer", "i8"), ("resistance", "f8"), ("groove_pressure", "f8"), ("centrifugal", "f8")
)  # fmt: skip


class VolumeFilms(NamedTuple):
    """Films of equal numbers of cells m x k. films: (films,) records FILM; ring: (films, RING_ROWS, m); places:
    (films, PLACES, k + 1) of the cells along the axis; cells: (films, CELL_LAYERS, m, k). Coupled channels have records
    CHANNEL, channels (channels,), and FEED_HOLES, feed_holes (holes,), whose cells are feed_hole_cells (holes, n, 2),
    filled up with -1."""

    films: Records
    ring: Array
    places: Array
    cells: Array
    channels: Records
    feed_holes: Records
    feed_hole_cells: NDArray[np.int64]


def volume_films(
    films: Sequence[VolumeFilm],
    centrifugal: Sequence[float] = (),
    settled: float = TIGHTLY,
) -> VolumeFilms:
    """The films as arrays; all have grids of the same shape. centrifugal, settled: see FILM."""
    data = VolumeFilms(*map(np.concatenate, zip(*map(film_alone, films), strict=True)))
    data.films["centrifugal"], data.films["settled"] = centrifugal or 0.0, settled
    return data


@lru_cache(maxsize=FEW)
def film_alone(film: VolumeFilm) -> VolumeFilms:
    """A film as arrays, not to be written to. Those of a few films are cached: each is solved often."""
    ring, places, cells = _geometry(film.section, film.grid)
    own = np.array([_described(film, bool(cells[EDGE].any()))], FILM)
    channels, holes, hole_cells = np.zeros(0, CHANNEL), np.zeros(0, FEED_HOLES), np.zeros((0, 0, 2), dtype=np.int64)
    return VolumeFilms(own, ring[None], places[None], cells[None], channels, holes, hole_cells)


def _described(film: VolumeFilm, edges: bool) -> tuple[Any, ...]:
    """The record FILM of a film: all of it at once, for each field by itself takes as long as a film that is solved."""
    section, law, scale = film.section, film.law, film.section.pressure_scale
    height, seals = film.grid.height, section.seals
    slopes, reaches = end_slopes(height, seals), end_reaches(height, seals)
    grooves = 0.0, section.far_pressure / scale if section.far == "groove" else 0.0
    near, far = (
        (ENDS[kind], *slope, groove, reach)
        for kind, slope, groove, reach in zip((section.near, section.far), slopes, grooves, reaches, strict=True)
    )
    follow_at, cells_at = addresses(law)
    length, spread = diffusing(section, film.grid)
    line = supply_line(film)
    values = {
        "aspect": section.aspect,
        "scales": film.scales,
        "force_scale": section.force_scale,
        "near": near,
        "far": far,
        "centrifugal": 0.0,
        "settled": TIGHTLY,
        "supplied_gas": law.supplied_gas,
        "gas_content": law.gas_content,
        "follow_at": follow_at,
        "cells_at": cells_at,
        "solver_at": ring_solver(film.grid.shape[1]),
        "clips": (BETWEEN_MIDDLES if film.clips_between else BY_CELLS) if law.clips else NO_CLIP,
        "remembers": law.keeps_oil,
        "carries_gas": law.carries_gas,
        "bored": film.grid.has_bores,
        "edges": edges,
        "roughness": section.flow_roughness / section.clearance,
        "shear": section.shear,
        "diffuses": section.diffusion is not None,
        "length": length,
        "spread": spread,
        "fraction": 1.0,
        "share": 1.0,
        "supply": supply_pressure(section) / scale,
        "given": line.given,
        "line": line.line,
        "lowest": line.lowest,
        "parameters": given_parameters(law),
    }
    return tuple(values[name] for name in FILM.names)


@lru_cache(maxsize=FEW)
def _geometry(section: Section, grid: VolumeGrid) -> tuple[Array, Array, Array]:
    """ring (RING_ROWS, m), places (PLACES, k + 1) and cells (CELL_LAYERS, m, k) of a film, not to be written to. The
    arrays of a few films are cached: a film is solved often, at each eccentricity with its own law."""
    m, k = grid.shape
    ring, cells, width = np.zeros((RING_ROWS, m)), np.zeros((CELL_LAYERS, m, k)), np.diff(grid.z)
    face, centred = grid.phi[1:], (0.0, 0.0)
    ring[SIN], ring[COS], ring[GAP] = (
        np.sin(grid.centre),
        np.cos(grid.centre),
        gap_height(section, centred, grid.centre),
    )
    ring[FACE_SIN], ring[FACE_COS], ring[FACE_GAP] = np.sin(face), np.cos(face), gap_height(section, centred, face)
    ring[LENGTH] = np.diff(grid.phi)
    ring[PUSH_X], ring[PUSH_Y] = -np.diff(np.cos(grid.phi)), -np.diff(np.sin(grid.phi))
    ring[BATHED] = bathed(section, grid.phi)
    cells[AREA], cells[SHARE], cells[EXCESS] = grid.area, grid.share, grid.excess
    cells[SHEARED] = (1.0 - grid.cover) * grid.size
    cells[LOAD] = force_weights(section, grid)
    around = np.where(grid.around > 0.0, width / np.maximum(grid.around, NO_DISTANCE), 0.0)
    edge = grid.at != grid.phi[1:, None]
    cells[AROUND], cells[EDGE] = np.where(edge, 0.0, around), np.where(edge, around, 0.0)
    cells[EDGE_SIN], cells[EDGE_COS] = np.sin(grid.at), np.cos(grid.at)
    cells[EDGE_GAP] = gap_height(section, centred, grid.at.ravel()).reshape(grid.shape)
    open_along = np.where(grid.along > 0.0, ring[LENGTH][:, None] / np.maximum(grid.along, NO_DISTANCE), 0.0)
    cells[ALONG, :, :-1] = section.aspect * open_along
    cells[GIVEN_PRESSURE], cells[UNKNOWN] = grid.fixed_pressure, np.where(grid.fixed, 0.0, 1.0)
    return ring, places_along(grid.height, grid.z, width), cells


def places_along(middles: Array, edges: Array, widths: Array) -> Array:
    """(PLACES, k + 1) of the middles (k,), edges (k + 1,) and widths (k,) of cells along the axis."""
    k = len(middles)
    places = np.zeros((PLACES, k + 1))
    places[MIDDLES, :k], places[EDGES], places[WIDTHS, :k] = middles, edges, widths
    return places


# Layers of the films' state: unknown w now and at the start of the step before, oil H theta, its rate; where the oil of
# any film carries free gas, also that, H theta c, and its rate.
W, W_BEFORE, OIL, RATE, WET = range(5)
GAS, GAS_RATE, WET_WITH_GAS = range(WET, WET + 3)
PASSED, NOW = range(2)  # layers of their oil: what has passed so far, and passes now


def diffusing(section: Section, grid: VolumeGrid) -> tuple[float, float]:
    """L of the diffusion of a film in rad, at least the mean length of its cells, and by how much more it acts along
    than around, whose coordinate counts over the width of the section; 0 where there is none."""
    given = section.diffusion
    if given is None or given.length == 0.0:
        return 0.0, 0.0
    along = (section.bearing_width / section.width) ** 2 if given.along else 0.0
    return max(given.length, 2.0 * math.pi / grid.shape[0]), along


def end_reaches(height: Array, seals: tuple[float, float]) -> tuple[float, float]:
    """1 over the distances of the last unknowns, at `height` (k,), from the oil beyond the ends z = 0 and z = 1."""
    return 1.0 / (float(height[0]) + seals[0]), 1.0 / (1.0 - float(height[-1]) + seals[1])


class GridMotion(NamedTuple):
    """Motion of the journal relative to a film's grid, in the grid's directions, and its share in a time step.

    d: displacement over the clearance; omega: omega_J + omega_S relative to the grid; spin: angular speed of the grid,
    which turns the velocity v; g: how far a velocity moves the journal within the stage, 0: not at all; rate: of what
    is stored, 1 / g of a film that remembers its oil, else 0. Of a journal that tilts d and v are at the place 0 along
    the axis, see PLACES, and grow up to the place 1 by `more`; by_ends: whether derivatives are by the velocities at
    both.
    """

    d_x: float
    d_y: float
    omega: float
    v_x: float = 0.0
    v_y: float = 0.0
    spin: float = 0.0
    g: float = 0.0
    rate: float = 0.0
    more_x: float = 0.0
    more_y: float = 0.0
    more_v_x: float = 0.0
    more_v_y: float = 0.0
    by_ends: bool = False


def seen_by_grid(motion: Motion, g: float = 0.0, by_ends: bool = False, still: bool = False) -> GridMotion:
    """A motion over a section whose places begin at its end z = 0. still: without the velocities, which a solver
    stores by itself."""
    (x, y), (more_x, more_y), omega = motion.d, motion.slope, float(motion.omega)
    (v_x, v_y), (more_v_x, more_v_y) = ((0.0, 0.0), (0.0, 0.0)) if still else (motion.v, motion.slope_rate)
    near = (x - 0.5 * more_x, y - 0.5 * more_y), (v_x - 0.5 * more_v_x, v_y - 0.5 * more_v_y)
    (d_x, d_y), (v_x, v_y), (more_x, more_y, more_v_x, more_v_y) = (
        tuple(map(float, each)) for each in (*near, (more_x, more_y, more_v_x, more_v_y))
    )
    return GridMotion(d_x, d_y, omega, v_x, v_y, 0.0, g, 0.0, more_x, more_y, more_v_x, more_v_y, by_ends)


@compiled(inline=True)
def level(
    d_x: float, d_y: float, omega: float, v_x: float, v_y: float, spin: float, g: float, rate: float
) -> GridMotion:
    """The motion of a journal that does not tilt."""
    return GridMotion(d_x, d_y, omega, v_x, v_y, spin, g, rate, 0.0, 0.0, 0.0, 0.0, False)


@compiled(inline=True)
def gap_along(gap: float, s: float, c: float, motion: GridMotion) -> tuple[float, float]:
    """H at the place 0 along the axis, and by how much more it is at 1, from the gap of a centred journal and sine and
    cosine of the angle."""
    return gap + motion.d_x * s - motion.d_y * c, motion.more_x * s - motion.more_y * c


@compiled(inline=True)
def add_by_motion(right: Array, i: int, j: int, z: float, by_ends: bool, by_x: float, by_y: float) -> None:
    """Add what changes with the velocity at the place z along the axis, to the sides by the velocities."""
    first = right.shape[1] + BY_ENDS
    if by_ends:
        far_x, far_y = z * by_x, z * by_y
        right[i, j, first] += by_x - far_x
        right[i, j, first + 1] += by_y - far_y
        right[i, j, first + 2] += far_x
        right[i, j, first + 3] += far_y
    else:
        right[i, j, first] += by_x
        right[i, j, first + 1] += by_y
