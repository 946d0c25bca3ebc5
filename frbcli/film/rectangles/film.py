"""The film of a section that is made of rectangles, and the force of such a film in SI units.

A rectangular film solved at one position, without any table: what the tables are measured against.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import Section, groove_pressure
from frbcli.film.grid import Mesh, axial_modes, axial_vertices, ring_vertices
from frbcli.film.kept import kept_beside
from frbcli.film.parabola import summit
from frbcli.film.rectangles.chain import ChainFilm, chain_grid, chain_table
from frbcli.film.rectangles.fields import LINES, FieldsFilm, field_grid, field_table
from frbcli.film.rectangles.film_force import FilmData, film_force
from frbcli.film.rectangles.modal import clipped_line, element_lengths, force_weights, unit_fields
from frbcli.film.rectangles.short import ShortFilm, SuppliedShortFilm, sealed_shape, sealed_share
from frbcli.film.rectangles.table import TableFilm, force_table, ring_contraction, table_force

GAUSS = 24  # Gauss points over the width
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(GAUSS)
MODES_AT_ONCE = 64  # solved between two looks at Ctrl-C, and held in memory


@dataclass(frozen=True)
class SectionPressure:
    """Sommerfeld's pressure of one section, scaled, gauge: values (2 m, GAUSS) at the ring's nodes and axial Gauss
    points.

    vertices: (m,) Theta of the element boundaries; z, weights: (GAUSS,) axial positions and weights over [0, 1].
    """

    vertices: Array
    z: Array
    weights: Array
    values: Array


@dataclass(frozen=True)
class _Motion:
    """Motion in the frame of the line of centres: eccentricity, unit vectors along and across it, w_r and w_t in
    1/s."""

    eccentricity: float
    along: Array
    across: Array
    w_r: float
    w_t: float


def _motion(section: Section, displacement: Array, velocity: Array, omega: float) -> _Motion:
    d, v = np.asarray(displacement) / section.clearance, np.asarray(velocity) / section.clearance
    eccentricity = math.hypot(d[0], d[1])
    along = np.array([1.0, 0.0]) if eccentricity == 0.0 else d / eccentricity
    across = np.array([-along[1], along[0]])
    w = v - 0.5 * omega * np.array([-d[1], d[0]])
    return _Motion(eccentricity, along, across, float(w @ along), float(w @ across))


def direct_force(
    section: Section, cavitation: str, mesh: Mesh, displacement: Array, velocity: Array, omega: float
) -> Array:
    """(2,) force in N on the journal by the whole bearing; displacement in m, velocity in m/s, omega in rad/s."""
    motion = _motion(section, displacement, velocity, omega)
    pressure = section_pressure(section, mesh, motion.eccentricity, motion.w_r, motion.w_t)
    level = (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale
    if not law_named(cavitation).clips:  # any level below all pressures: a constant pressure carries nothing
        level = float(pressure.values.min())
    weights, lengths = force_weights(pressure.vertices), element_lengths(pressure.vertices)
    total = np.zeros(2)
    for line, share in zip(pressure.values.T, pressure.weights, strict=True):
        part = np.zeros((1, 2))
        clipped_line(np.ascontiguousarray(line[None]), level, pressure.vertices, lengths, weights, part)
        total += share * part[0]
    force: Array = section.force_scale * (total[0] * motion.along + total[1] * motion.across)
    return force


def section_pressure(
    section: Section, mesh: Mesh, eccentricity: float, w_r: float, w_t: float
) -> SectionPressure:
    """Solve one section in the frame of the line of centres for the velocity (w_r, w_t) in 1/s."""
    eigenvalues, loads, *shapes = _modes(mesh.axial, section.seals)
    vertices = ring_vertices(mesh.circumferential, ring_contraction(eccentricity))
    decays = (section.radius / section.width) ** 2 * eigenvalues
    z = 0.5 * (POINTS + 1.0)
    sigma, (a, b) = section.far_pressure / section.pressure_scale, sealed_shape(section.seals)
    values, along = np.zeros((2 * len(vertices), GAUSS)) + sigma * (a + b * z), np.column_stack(shapes)
    for first in range(0, len(decays), MODES_AT_ONCE):
        some = slice(first, first + MODES_AT_ONCE)
        fields = unit_fields(vertices, eccentricity, decays[some], loads[some])
        values += (w_r * fields[0] + w_t * fields[1]).T @ along[some]
    return SectionPressure(vertices, z, 0.5 * WEIGHTS, values)


@kept_beside(clipped_line)
def _modes(elements: int, seals: tuple[float, float]) -> Array:
    """(2 + GAUSS, k) eigenvalues, loads and values at the Gauss points of the modes of a section with so many elements
    along. They are kept on disk: on fine meshes they take longer than all else, and on any the solver of the
    eigenproblem takes long to import."""
    modes = axial_modes(axial_vertices(elements), seals)
    return np.vstack([modes.eigenvalues, modes.loads, modes.at(0.5 * (POINTS + 1.0)).T])


def largest_pressure(
    section: Section, mesh: Mesh, displacement: Array, velocity: Array, omega: float
) -> float:
    """Largest pressure in the film, Pa absolute: parabola through the largest nodal value and its neighbours, each
    way."""
    motion = _motion(section, displacement, velocity, omega)
    field = section_pressure(section, mesh, motion.eccentricity, motion.w_r, motion.w_t)
    n = len(field.vertices)
    angles = np.empty(2 * n)
    angles[::2] = field.vertices
    angles[1::2] = field.vertices + 0.5 * element_lengths(field.vertices)
    i, j = np.unravel_index(np.argmax(field.values), field.values.shape)
    ring = np.array([i - 1, i, i + 1]) % (2 * n)
    gain = _highest(np.unwrap(angles[ring]), field.values[ring, j]) - field.values[i, j]
    if 0 < j < GAUSS - 1:
        gain += _highest(field.z[j - 1 : j + 2], field.values[i, j - 1 : j + 2]) - field.values[i, j]
    highest = float((field.values[i, j] + gain) * section.pressure_scale + section.ambient_pressure)
    return max(highest, section.ambient_pressure + section.far_pressure)


def _highest(x: Array, y: Array) -> float:
    """Largest value of the parabola through three points with the largest in the middle."""
    low, middle, high = y.tolist()
    return summit(low, middle, high, float(x[1] - x[0]), float(x[2] - x[1]))[1]


EQUAL_PRESSURES = 1e-9  # relative to the ambient pressure

# Tables depend on the shape of the film alone: films of other clearances, viscosities and speeds share them.
_force_table, _field_table = kept_beside(table_force)(force_table), kept_beside(table_force)(field_table)


def make_film(section: Section, theory: str, cavitation: str, mesh: Mesh) -> FilmData:
    """The film of a section over the whole width, see whole_width. theory: "short" | "finite"; cavitation: a closed
    law."""
    clipped = law_named(cavitation).clips
    sigma = section.far_pressure / section.pressure_scale
    level = (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale
    if section.grooves:
        return _grooved_film(section, clipped, level, mesh)
    limit = EQUAL_PRESSURES * section.ambient_pressure / section.pressure_scale
    # Without cavitation the hydrostatic pressure carries nothing: it is the same all around.
    equal = not clipped or (abs(sigma) <= limit and abs(level) <= limit)
    scale, radius_to_width, seals = section.force_scale, section.radius / section.width, section.seals
    if theory == "short":
        slenderness = radius_to_width**-2
        if equal:
            return ShortFilm(scale * sealed_share(seals), slenderness, int(clipped))
        return SuppliedShortFilm(scale, slenderness, sigma, level)
    if equal:
        return TableFilm(scale, _force_table(mesh, radius_to_width, clipped, seals))
    mesh = replace(mesh, circumferential=max(mesh.circumferential, mesh.lines * LINES))  # the grid also holds its lines
    return FieldsFilm(scale, sigma, level, _field_table(mesh, radius_to_width, seals), field_grid(mesh, seals))


def _grooved_film(section: Section, clipped: bool, level: float, mesh: Mesh) -> ChainFilm:
    """The film between axial grooves, finite length; all grooves have the same pressure."""
    scale, pressure = section.pressure_scale, section.grooves[0]

    def profile(z: Array) -> Array:
        distance = np.minimum(z, 1.0 - z) * section.bearing_width
        return groove_pressure(section, pressure, distance) / scale

    grooves = sorted(section.grooves, key=lambda groove: groove.position)
    ends = np.array([groove.position + 0.5 * groove.opening for groove in grooves])
    starts = np.array([groove.position - 0.5 * groove.opening for groove in grooves])
    edges = np.column_stack([ends, np.append(starts[1:], starts[0] + 2 * np.pi)])
    grid = chain_grid(edges, mesh.circumferential)
    # Over the grooves their own pressure acts; where the films are clipped, the level itself over the rest of the turn.
    middles = np.asarray((np.arange(1000) + 0.5) / 1000.0, dtype=np.float64)
    mean = float(np.mean(profile(middles)))
    across = np.array([np.sum(np.cos(starts) - np.cos(ends)), np.sum(np.sin(starts) - np.sin(ends))])
    constant = (mean - (level if clipped else 0.0)) * across
    radius_to_width = section.radius / section.bearing_width
    table = chain_table(mesh, radius_to_width, profile, constant, section.seals)
    clip_level = level if clipped else 0.0
    return ChainFilm(section.force_scale, int(clipped), clip_level, table, grid)


@dataclass(frozen=True)
class FieldSlopes:
    """How a settled finite-volume film follows a journal at rest at `place` (c,) in m and rad, and `total`, omega_J +
    omega_S in rad/s. by_place (..., c), by_total (...): of its field (...); fraction: (...) of the oil fractions by the
    field; force: (c,) of the force by the total, in N s and N m s."""

    place: Array
    total: float
    by_place: Array
    by_total: Array
    fraction: Array
    force: Array


@dataclass(frozen=True)
class FilmForce:
    """Force on the journal by a whole section, N; stiffness dF/dD (2, 2) in N/m and damping dF/dD' (2, 2) in N s/m;
    field: of a finite-volume film, from which a film near by is sought, see VolumeSolution; fraction: (m, k) its oil
    fractions, None of others; slopes: of the field, None of films without one and where they are not known; off: last
    step of a field that was followed over its largest unknown: what derivatives are off by, the force by its square."""

    force: Array
    by_displacement: Array
    by_velocity: Array
    field: Array | None = None
    fraction: Array | None = None
    slopes: FieldSlopes | None = None
    off: float = 0.0

    def foreseen(self, place: Array, total: float | None = None) -> FilmForce:
        """This film with field and oil fractions to first order as they are with its journal at rest at another place
        (c,) and another omega_J + omega_S, by default the same one; as it is where its slopes are not known."""
        slopes = self.slopes
        if slopes is None or self.field is None:
            return self
        faster = 0.0 if total is None else total - slopes.total
        change = slopes.by_place @ (place - slopes.place) + faster * slopes.by_total
        fraction = None if self.fraction is None else self.fraction + slopes.fraction * change
        there = replace(slopes, place=place, total=slopes.total + faster)
        return replace(self, field=self.field + change, fraction=fraction, slopes=there)

    def plus(self, other: FilmForce, sign: float = 1.0) -> FilmForce:
        """This film with another force added, or subtracted (sign = -1)."""
        return replace(
            self,
            force=self.force + sign * other.force,
            by_displacement=self.by_displacement + sign * other.by_displacement,
            by_velocity=self.by_velocity + sign * other.by_velocity,
        )


def none_of(coordinates: int) -> FilmForce:
    """No force on a journal of so many coordinates."""
    return FilmForce(np.zeros(coordinates), *np.zeros((2, coordinates, coordinates)))


def evaluate(film: FilmData, clearance: float, displacement: Array, velocity: Array, omega: float) -> FilmForce:
    """One evaluation in SI units: displacement (2,) in m, velocity (2,) in m/s, omega = omega_J + omega_S in rad/s."""
    d, v = np.asarray(displacement) / clearance, np.asarray(velocity) / clearance
    values = np.array(film_force(film, d[0], d[1], v[0], v[1], omega))
    return FilmForce(values[:2], values[2:6].reshape(2, 2) / clearance, values[6:].reshape(2, 2) / clearance)
