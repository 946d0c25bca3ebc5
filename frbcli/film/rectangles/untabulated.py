"""A rectangular film solved at one position, without any table: what the tables are measured against."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import Section
from frbcli.film.grid import Mesh, axial_modes, axial_vertices, ring_vertices
from frbcli.film.kept import kept_beside
from frbcli.film.parabola import summit
from frbcli.film.rectangles.clip import clipped_line, force_weights
from frbcli.film.rectangles.modal import element_lengths, unit_fields
from frbcli.film.rectangles.short import sealed_shape
from frbcli.film.rectangles.table import ring_contraction

LINES = 24  # Gauss points over the width
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(LINES)
MODES_AT_ONCE = 64  # solved between two looks at Ctrl-C, and held in memory


@dataclass(frozen=True)
class SectionPressure:
    """Sommerfeld's pressure of one section, scaled, gauge: values (2 m, LINES) at the ring's nodes and axial Gauss
    points.

    vertices: (m,) Theta of the element boundaries; z, weights: (LINES,) axial positions and weights over [0, 1].
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
    values, along = np.zeros((2 * len(vertices), LINES)) + sigma * (a + b * z), np.column_stack(shapes)
    for first in range(0, len(decays), MODES_AT_ONCE):
        some = slice(first, first + MODES_AT_ONCE)
        fields = unit_fields(vertices, eccentricity, decays[some], loads[some])
        values += (w_r * fields[0] + w_t * fields[1]).T @ along[some]
    return SectionPressure(vertices, z, 0.5 * WEIGHTS, values)


@kept_beside(clipped_line)
def _modes(elements: int, seals: tuple[float, float]) -> Array:
    """(2 + LINES, k) eigenvalues, loads and values at the Gauss points of the modes of a section with so many elements
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
    if 0 < j < LINES - 1:
        gain += _highest(field.z[j - 1 : j + 2], field.values[i, j - 1 : j + 2]) - field.values[i, j]
    highest = float((field.values[i, j] + gain) * section.pressure_scale + section.ambient_pressure)
    return max(highest, section.ambient_pressure + section.far_pressure)


def _highest(x: Array, y: Array) -> float:
    """Largest value of the parabola through three points with the largest in the middle."""
    low, middle, high = y.tolist()
    return summit(low, middle, high, float(x[1] - x[0]), float(x[2] - x[1]))[1]
