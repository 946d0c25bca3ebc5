"""The Reynolds equation (3.9) with an oil fraction on finite volumes, conservative to round-off, for every law.

The motion of the journal that drives a film, also as seen from a surface that turns, and the oil that cells store.

Bores or grooves in a turning surface stand still in a frame that turns with it (section 4.1.5.3).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.cells.mesh.grid import VolumeGrid, fitted_grid, force_weights, volume_grid
from frbcli.film.gap import Displacement, Section, gap_height

if TYPE_CHECKING:
    from frbcli.film.cells.gas.balance import Carried, FreeGas

PARALLEL = (0.0, 0.0)


@dataclass(frozen=True)
class Motion:
    """Motion of the journal relative to the shell.

    d: displacement over the clearance in the middle of the section; v: its rate in 1/s; omega: omega_J + omega_S in
    rad/s; slope, slope_rate: by how much d and v grow over the width of the section, for a journal that tilts.
    """

    d: tuple[float, float]
    v: tuple[float, float]
    omega: float
    slope: tuple[float, float] = PARALLEL
    slope_rate: tuple[float, float] = PARALLEL

    @property
    def tilts(self) -> bool:
        """Whether the gap or its rate of change differs along the axis."""
        return self.slope != PARALLEL or self.slope_rate != PARALLEL

    @property
    def rate(self) -> float:
        """Rate of change of the gap in 1/s, which drives pressure and flow."""
        return max(0.5 * abs(self.omega), math.hypot(*self.v) + 0.5 * math.hypot(*self.slope_rate), 1e-3)

    def displacement_at(self, z: Array) -> Displacement:
        """Displacement over the clearance at positions z (k,) over the width of the section, linear in z."""
        return _along(self.d, self.slope, z)

    def velocity_at(self, z: Array) -> Displacement:
        """Rate of the displacement in 1/s at positions z (k,) over the width of the section."""
        return _along(self.v, self.slope_rate, z)


def _along(middle: tuple[float, float], growth: tuple[float, float], z: Array) -> Displacement:
    if growth == PARALLEL:
        return middle
    return middle[0] + (z - 0.5) * growth[0], middle[1] + (z - 0.5) * growth[1]


Path = Callable[[float], Motion]  # of the time in s


def gap_on(section: Section, motion: Motion, phi: Array, z: Array) -> Array:
    """(m, k) H at the angles phi (m,) and the positions z (k,) over the width of a section."""
    gap = gap_height(section, motion.displacement_at(z), phi[:, None])
    return np.broadcast_to(gap, (len(phi), len(z)))


class Storage(NamedTuple):
    """Oil kept in the cells per area and time, factor theta - past: factor and past are (m, 1) or (m, k), in 1/s."""

    factor: Array
    past: Array


def turned(vector: tuple[float, float], angle: float) -> tuple[float, float]:
    """A vector (x, y) turned by an angle in rad: from the axes of a frame at this angle to the axes of the lab."""
    c, s = math.cos(angle), math.sin(angle)
    return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]


def seen_from(motion: Motion, angle: float, speed: float) -> Motion:
    """A motion of the lab in a frame at an angle in rad that turns with a speed in rad/s.

    phi = phi* + angle (4.20): displacement and velocity turn back by the angle, and the frame's own turning is taken
    from them, as from the speeds of journal and shell. Nothing else changes, for a film has no inertia: forces on the
    journal come back by turned(force, angle), the slip omega_J - omega_S and the torques are the same.
    """

    def seen(place: tuple[float, float], rate: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
        relative = (rate[0] + speed * place[1], rate[1] - speed * place[0])
        return turned(place, -angle), turned(relative, -angle)

    d, v = seen(motion.d, motion.v)
    slope, slope_rate = seen(motion.slope, motion.slope_rate)
    return Motion(d, v, motion.omega - 2.0 * speed, slope, slope_rate)


def path_seen_from(path: Path, speed: float) -> Path:
    """A motion over time in s, seen from a frame that turns with a speed in rad/s and is at the angle 0 at time 0."""
    return lambda time: seen_from(path(time), speed * time, speed)


HALVINGS = 60  # of the interval in which the unknown of a cell with a given oil fraction lies

__all__ = [
    "Flows",
    "Motion",
    "Section",
    "VolumeFilm",
    "VolumeGrid",
    "VolumeSolution",
    "fitted_grid",
    "reference_pressure",
    "volume_grid",
]


@dataclass(frozen=True)
class Flows:
    """Oil per time in scaled units (R b C, 1/s), by one section: in and out at its ends, grooves and holes; made by the
    law and by artificial diffusion; stored; fed by grooves and holes net; leaving at the ends net; still: what is too
    little to count."""

    inflow: float
    outflow: float
    source: float
    stored: float
    supply: float
    ends: float
    still: float

    @property
    def defect(self) -> float:
        """Residual of the oil balance over the larger of inflow and outflow; oil that the law makes is such."""
        size = max(self.inflow, self.outflow, abs(self.stored), self.still)
        return (self.inflow - self.outflow - self.stored) / size if size > 0.0 else 0.0


@dataclass(frozen=True)
class VolumeSolution:
    """w: (m, k) unknown; state: of the cells, arrays (m, k), given values in grooves and holes; Newton iterations;
    before: (m, k) oil fractions before the upstream cells that it was solved with, see states.py; gas: of a law whose
    oil carries any; filling: of openings with limited flow, see boundaries.py; stages: (n, 3, m, k) w, c_in and r of
    a steady film with gas, first solved upwind, then each time with second order."""

    w: Array
    state: CellState
    iterations: int
    flows: Flows
    before: Array
    gas: FreeGas | None = None
    filling: float = 1.0
    stages: Array | None = None

    @property
    def field(self) -> Array:
        """The start of the search for a steady film near by: w, or the stages."""
        return self.w if self.stages is None else self.stages


def reference_pressure(section: Section, motion: Motion) -> float:
    """A scaled pressure in 1/s of the size that the motion builds up: a good reference of the unknown w."""
    return motion.rate / section.aspect


class VolumeFilm:
    """A section on a grid with a law. Constant: its methods take and return states."""

    def __init__(
        self, section: Section, grid: VolumeGrid, law: Law, reference: float, edged: bool = False
    ) -> None:  # fmt: skip
        """reference: scaled pressure in 1/s of one unit of w, see reference_pressure; edged: whether the edge of the
        cavity lies within cells where the film rests, see cavity_edge.py, if its law knows it."""
        self.section, self.grid, self.law = section, grid, law
        self.edged = edged and law.edges and section.flow_roughness == 0.0
        self.scales = Scales(
            reference,
            (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale,
            section.ambient_pressure / section.pressure_scale,
        )

    @property
    def is_followed(self) -> bool:
        """Whether its field follows from the motion alone, and smoothly: not that of a film that keeps its oil, whose
        fronts lie between cells, or whose openings take what their supply gives."""
        return not self.law.keeps_oil and math.isinf(self.section.largest_flow)

    def full(self) -> Array:
        """(m, k) unknown of a full film at the ambient pressure, gas in the oil being in equilibrium."""
        return np.full(self.grid.shape, self.law.standing(self.scales))

    @property
    def weights(self) -> Array:
        """(m, k) of the pressures of the cells in the integral over the width."""
        return force_weights(self.section, self.grid)

    def gap(self, d: tuple[float, float], phi: Array) -> Array:
        """H (4.4) at the angles phi (n,)."""
        return gap_height(self.section, d, phi)

    def gaps(self, motion: Motion) -> Array:
        """(m, k) H in the middles of the cells."""
        return gap_on(self.section, motion, self.grid.centre, self.grid.height)

    def cells(self, w: Array, carried: Carried | None = None) -> CellState:
        """State of the cells with the unknown w (m, k), with the given pressures in grooves and holes; carried: the gas
        that comes into them, else it is in equilibrium."""
        grid = self.grid
        state = self.law.cells(w, self.scales, *(carried or ()))
        return CellState(
            pressure=np.where(grid.fixed, grid.fixed_pressure, state.pressure),
            fraction=np.where(grid.fixed, 1.0, state.fraction),
            source=np.where(grid.fixed, 0.0, state.source),
            pressure_slope=np.where(grid.fixed, 0.0, state.pressure_slope),
            fraction_slope=np.where(grid.fixed, 0.0, state.fraction_slope),
            source_slope=np.where(grid.fixed, 0.0, state.source_slope),
        )

    def pressure(self, state: CellState) -> Array:
        """(m, k) scaled gauge pressure in the middles of the cells: clipped at p_cav if the law says so (3.29)."""
        return np.maximum(state.pressure, self.scales.cavitation) if self.law.clips else state.pressure

    @property
    def clips_between(self) -> bool:
        """Whether forces clip between the middles of cells, see `clipped_means`: not next to a circumferential groove,
        whose cavities end within the width, so that their edges cross the rows of cells at a slant."""
        return self.law.clips and self.section.far != "groove"

    def mean_pressure(self, state: CellState) -> Array:
        """(m, k) scaled gauge pressure for forces: where the law clips, that above p_cav in the mean over each cell."""
        if not self.clips_between:
            return self.pressure(state)
        cavity = self.scales.cavitation
        return cavity + clipped_means(state.pressure - cavity)

    def content(self, motion: Motion, w: Array, carried: Carried | None = None) -> Array:
        """(m, k) oil in the cells, H theta; carried: see cells."""
        content: Array = self.gaps(motion) * self.cells(w, carried).fraction
        return content

    def from_coarser(self, coarse: VolumeFilm, w: Array) -> Array:
        """(m, k) unknown to begin from on this grid: w of the same film on a coarser one, nearest cells."""
        grid = coarse.grid
        angle = grid.phi[0] + np.mod(self.grid.centre - grid.phi[0], 2.0 * np.pi)
        column = np.clip(np.searchsorted(grid.phi, angle, side="right") - 1, 0, grid.shape[0] - 1)
        row = np.searchsorted(grid.z, self.grid.height, side="right") - 1
        near: Array = w[np.ix_(column, row)]
        return near


def supply_share(time: float, rise_time: float) -> float:
    """f (4.11), the share of the gauge supply pressure after a time in s, with t_1 in s; all of it where t_1 is 0."""
    return -math.expm1(-time / rise_time) if rise_time > 0.0 else 1.0


def supplied(film: VolumeFilm, share: float) -> VolumeFilm:
    """A film whose grooves and holes hold a share of their gauge pressures, which the hydrostatic force follows."""
    section, grid = film.section, film.grid
    section = replace(
        section,
        far_pressure=share * section.far_pressure,
        grooves=tuple(replace(groove, pressure=share * groove.pressure) for groove in section.grooves),
        holes=tuple(replace(hole, pressure=share * hole.pressure) for hole in section.holes),
    )
    grid = replace(grid, fixed_pressure=share * grid.fixed_pressure)
    return VolumeFilm(section, grid, film.law, film.scales.reference, film.edged)


def refilled(
    old: VolumeFilm, new: VolumeFilm, d: tuple[float, float], oil: Array, w: Array, carried: Carried | None = None
) -> tuple[Array, Array]:
    """(m, k) unknowns of the film `new`, and the oil that it is given in its own units, from the oil and unknowns of
    the film `old`, which has another clearance. d: of the journal, over the new clearance; carried: see
    VolumeFilm.cells."""
    share, free = old.section.clearance / new.section.clearance, ~new.grid.fixed
    pressure = old.scales.reference * old.section.pressure_scale / (new.scales.reference * new.section.pressure_scale)
    given = share * oil
    full = np.maximum(new.full(), pressure * w)  # cells with enough oil keep their pressure
    gap = new.gap(d, new.grid.centre)[:, None]
    return np.where(free, unknown_with_fraction(new, given / gap, full, carried), w), given


def unknown_with_fraction(film: VolumeFilm, fraction: Array, full: Array, carried: Carried | None) -> Array:
    """(m, k) unknowns of cells with given oil fractions, at most `full`: they grow with each other."""
    scales = film.scales
    least = -2.0 - (scales.cavitation + scales.ambient) / scales.reference  # neither oil nor pressure
    low, high = np.full_like(full, least), full.copy()
    enough = film.cells(full, carried).fraction <= fraction
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = film.cells(middle, carried).fraction > fraction
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.where(enough, full, 0.5 * (low + high))


CURVED = 1.0 / 32.0  # of S, see clipped_means


def clipped_means(above: Array) -> Array:
    """(m, k) mean pressures above p_cav of cells around a ring, for forces; above: (m, k) in their middles, less than 0
    in the cavity. The pressure is clipped at p_cav (3.29), with the edge of the cavity between the middles of cells.

    To clip cell by cell would let the force jump as the edge moves over a cell. Here the pressure above p_cav goes on a
    straight line from a cell p to the next one n, so that a share x of the way between their middles is above p_cav,

        x = 1 where both are,   p / (p - n) where p > 0 > n,   n / (n - p) where n > 0 > p,   0 where none is,

    and half of x p and of x n, of what is above p_cav, counts as mean pressure of the two cells. In addition to the
    straight line counts -y S / 32 with y = x^2 (3 - 2 x), S = p_before - p - n + p_beyond being twice the curvature
    over the way: the sum of what the pressure is above its chord, -S / 24, and of what the cells' own pressures are off
    by. Where oil flows around, this is +S / 48, for the balances take the flow through a face by the fall of pressure
    over it; where it flows along the width, it is nothing. Half of it is taken. Without it a force would be wrong by
    the slopes at both edges of a cavity, in second order. """
    before, after, beyond = (np.roll(above, by, axis=0) for by in (1, -1, -2))
    here_full, after_full = above > 0.0, after > 0.0
    size = np.where(here_full ^ after_full, np.abs(above) + np.abs(after), 1.0)
    part = np.where(here_full, above, after) / size
    x = np.where(here_full & after_full, 1.0, np.where(here_full | after_full, part, 0.0))
    y = x**2 * (3.0 - 2.0 * x)
    curved = CURVED * y * (before - above - after + beyond)
    to_here = 0.5 * x * np.maximum(above, 0.0) - curved * np.where(here_full, 1.0 - 0.5 * y, 0.5 * y)
    to_after = 0.5 * x * np.maximum(after, 0.0) - curved * np.where(here_full, 0.5 * y, 1.0 - 0.5 * y)
    return np.asarray(to_here + np.roll(to_after, 1, axis=0))
