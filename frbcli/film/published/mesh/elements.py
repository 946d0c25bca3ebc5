"""The mesh of a section as the compiled kernels take it, and what its nodes contribute to the force."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from frbcli.film.cells.balance.ends import PREFACTOR, STEEPNESS
from frbcli.film.gap import LobedShell
from frbcli.film.grid import Array
from frbcli.film.published.equations.assembly import Elements
from frbcli.film.published.mesh.quadratic import QuadraticMesh

Diffusion = Literal["consistent", "streamline", "none"]


def make_elements(mesh: QuadraticMesh, diffusion: Diffusion) -> Elements:
    """The elements of a mesh with the section's ends.

    diffusion: (4.42), "consistent" isotropic as published, "streamline" around only, or "none".
    """
    section = mesh.section
    covered = np.zeros(mesh.phi.size, dtype=bool)
    covered[mesh.nodes[mesh.covered].ravel()] = True
    fixed = covered.reshape(mesh.phi.shape)
    fixed[:, 0] |= section.near != "free-to-air"
    fixed[:, -1] |= section.far in ("oil-bath", "groove")
    place, angle = np.arange(len(mesh.nodes)) % mesh.along, mesh.phi.ravel()[mesh.nodes]
    # Isotropic: added as it is to both coefficients of (4.31), whose z counts over the width of the bearing.
    spread = {"consistent": (section.bearing_width / section.width) ** 2, "streamline": 0.0, "none": -1.0}[diffusion]
    return Elements(
        mesh.nodes,
        mesh.values,
        mesh.slopes,
        mesh.area,
        np.sin(mesh.angle),
        np.cos(mesh.angle),
        np.mod(angle[:, 6] - angle[:, 0], 2.0 * math.pi),
        np.ascontiguousarray(fixed.ravel()),
        np.ascontiguousarray(mesh.covered, dtype=bool),
        ~mesh.covered & (place == 0) & (section.near == "free-to-air"),
        ~mesh.covered & (place == mesh.along - 1) & (section.far == "free-to-air"),
        section.aspect,
        spread,
        PREFACTOR,
        STEEPNESS * section.pressure_scale / section.ambient_pressure,
    )


def force_weights(mesh: QuadraticMesh) -> Array:
    """(2 a, 2 k + 1, 2) integrals of the shape functions times n = (sin phi, -cos phi)."""
    normal = np.stack([np.sin(mesh.angle), -np.cos(mesh.angle)], axis=-1)
    weights = np.zeros((mesh.phi.size, 2))
    np.add.at(weights, mesh.nodes, np.einsum("eq,qa,eqx->eax", mesh.area, mesh.values, normal))
    return weights.reshape(*mesh.phi.shape, 2)


def lobe_slope(lobes: LobedShell, angle: Array) -> Array:
    """dH/dphi of the centred journal at angles (...) within the lobes."""
    within = np.mod(angle - lobes.start, lobes.arc) - lobes.offset * lobes.arc
    return np.asarray(lobes.preload / (1.0 - lobes.preload) * np.sin(within), dtype=np.float64)
