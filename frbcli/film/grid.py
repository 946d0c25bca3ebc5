"""Grids of the developed gap: quadratic elements on a rectangle, periodic in phi (section 3.4.2).

scikit-fem owns the meshes, the elements and the assembled operators; the compiled solvers run on what it assembles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array

# Axial modes of films between axial grooves, of those that a load independent of z excites: the next has a hundredth of
# a per cent of the force.
CHAIN_MODES = 5
NO_SEALS = (0.0, 0.0)


@dataclass(frozen=True)
class Mesh:
    """Elements of one film section: `axial` over its width, `circumferential` over the turn (quadratic); lines: times
    the usual number of those along which the pressure is clipped and integrated around."""

    axial: int
    circumferential: int
    lines: int = 1


@dataclass(frozen=True)
class AxialModes:
    """The axial half of the separated problem on quadratic elements.

    eigenvalues: (k,) of K_z phi = lambda M_z phi, pressure zero at open ends, dphi/dz = phi / seal at sealed ones;
    seals: see Section; loads: (k,) integral of each mode over
    z (its share of a load that does not depend on z); shapes: (k, n) values at the n axial nodes; nodes: (n,) in [0,
    1].
    Modes without a share in such a load (the odd ones) are left out: they stay zero.
    """

    eigenvalues: Array
    loads: Array
    shapes: Array
    nodes: Array
    mass: Array
    seals: tuple[float, float] = NO_SEALS

    def project(self, values: Array) -> Array:
        """(k,) coefficients of a pressure given at the nodes (n,): the modes are orthonormal in M_z."""
        coefficients: Array = self.shapes @ (self.mass @ values)
        return coefficients

    def at(self, z: Array) -> Array:
        """(k, m) values of the modes at the axial positions z (m,), by the elements' own shape functions."""
        return self.shapes @ quadratic_interpolation(self.nodes, z)


def ring_vertices(elements: int, contraction: float = 1.0) -> Array:
    """(elements,) angles of the element boundaries over one turn, denser around Theta = pi, the narrowest gap.

    The angles follow tan((Theta - pi)/2) = c tan((gamma - pi)/2) with gamma equidistant. c = 1 is equidistant;
    c = sqrt((1 - eps)/(1 + eps)) is Sommerfeld's substitution, which makes H and the pressure smooth at any eps.
    """
    half_angle = np.pi * (np.arange(elements) / elements - 0.5)
    return np.pi + 2.0 * np.arctan2(contraction * np.sin(half_angle), np.cos(half_angle))


def quadratic_interpolation(nodes: Array, points: Array) -> Array:
    """(n, m) values of the n quadratic shape functions (element ends at even indices, middles at odd) at m points."""
    ends = nodes[::2]
    element = np.clip(np.searchsorted(ends, points, side="right") - 1, 0, len(ends) - 2)
    xi = (points - ends[element]) / (ends[element + 1] - ends[element])
    values = np.zeros((len(nodes), len(points)))
    column = np.arange(len(points))
    values[2 * element, column] = (1 - xi) * (1 - 2 * xi)
    values[2 * element + 1, column] = 4 * xi * (1 - xi)
    values[2 * element + 2, column] += xi * (2 * xi - 1)
    return values


# Of a quadratic element of the length 1: integrals of the products of the slopes, and of the values, of its shapes.
ELEMENT_STIFFNESS = np.array([[7.0, -8.0, 1.0], [-8.0, 16.0, -8.0], [1.0, -8.0, 7.0]]) / 3.0
ELEMENT_MASS = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30.0


def axial_vertices(elements: int) -> Array:
    """(elements + 1,) element boundaries over the width of a section, denser at the edges, where the pressure of a
    narrow gap has its steepest fall (Chebyshev's spacing)."""
    return 0.5 * (1.0 - np.cos(np.pi * np.arange(elements + 1) / elements))


def axial_modes(vertices: Array, seals: tuple[float, float] = NO_SEALS) -> AxialModes:
    """Generalised eigenvectors of the axial stiffness and mass on quadratic elements of [0, 1] between the vertices."""
    from scipy.linalg import eigh

    nodes = np.sort(np.concatenate([vertices, 0.5 * (vertices[1:] + vertices[:-1])]))
    k_z, m_z = np.zeros((2, len(nodes), len(nodes)))
    for element, length in enumerate(np.diff(vertices)):
        its = slice(2 * element, 2 * element + 3)
        k_z[its, its] += ELEMENT_STIFFNESS / length
        m_z[its, its] += ELEMENT_MASS * length
    for node, seal in zip((0, -1), seals, strict=True):
        if seal > 0.0:
            k_z[node, node] += 1.0 / seal
    inner = slice(0 if seals[0] > 0.0 else 1, len(nodes) if seals[1] > 0.0 else -1)
    eigenvalues, vectors = eigh(k_z[inner, inner], m_z[inner, inner])
    shapes = np.zeros((len(eigenvalues), len(nodes)))
    shapes[:, inner] = vectors.T
    loads = shapes @ m_z.sum(axis=1)
    excited = np.abs(loads) > 1e-6 * np.abs(loads).max()
    return AxialModes(eigenvalues[excited], loads[excited], shapes[excited], nodes, m_z, seals)


FINER = 2  # times the elements or cells each way
SAMPLES = 48  # states of a run
