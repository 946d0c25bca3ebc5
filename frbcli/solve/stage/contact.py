"""Elastic contact of journals and shells in the time loop, compiled: what films feel of it, and what it pushes with."""

from __future__ import annotations

import math

import numpy as np

from frbcli.arrays import Array
from frbcli.compiled import compiled
from frbcli.film.contact_gap import ELASTIC_LIMIT, closes_freely_until, contact_gap
from frbcli.solve.state import Control


@compiled(inline=True)
def touches(eccentricity: float, contact_at: float, contact_stiffness: float) -> float:
    """Whether a film feels less than the displacement. Where contact ends the run, stiffness 0, it never does."""
    return contact_stiffness > 0.0 and eccentricity > closes_freely_until(contact_at)


@compiled(inline=True)
def shell_ahead(eccentricity: float, contact_at: float, contact_stiffness: float) -> float:
    """Eccentricity at which the gap ends for Newton's method: at the shell, and in contact as far ahead as the gap was
    wide there, but no further than a shell gives way."""
    if contact_stiffness > 0.0:
        return min(max(1.0, eccentricity + 1.0 - closes_freely_until(contact_at)), ELASTIC_LIMIT)
    return 1.0


@compiled()
def feel(
    d_x: float, d_y: float, v_x: float, v_y: float, contact_at: float, contact_stiffness: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """The ten numbers of contact_gap, in contact or not."""
    if touches(math.sqrt(d_x * d_x + d_y * d_y), contact_at, contact_stiffness):
        return contact_gap(closes_freely_until(contact_at), d_x, d_y, v_x, v_y)
    return d_x, d_y, v_x, v_y, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0


@compiled()
def push_back(
    d_x: float, d_y: float, clearance: float, contact_at: float, contact_stiffness: float,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """The radial spring of the surfaces beyond the eccentricity of contact: force (x, y) in N, and what it falls by per
    displacement over the clearance (xx, yy, xy)."""
    eccentricity = math.sqrt(d_x * d_x + d_y * d_y)
    if contact_stiffness <= 0.0 or eccentricity <= contact_at:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    k, n_x, n_y = contact_stiffness * clearance, d_x / eccentricity, d_y / eccentricity
    along = k * (1.0 - contact_at / eccentricity)
    return (
        -along * d_x,
        -along * d_y,
        along + (k - along) * n_x * n_x,
        along + (k - along) * n_y * n_y,
        (k - along) * n_x * n_y,
    )


def felt_motion(control: Control, d: Array, v: Array) -> Array:
    """(2, 2) displacement and velocity that a film feels of those of its journal, d and v (2,), over the clearance."""
    felt = feel(d[0], d[1], v[0], v[1], control.contact_eccentricity, control.contact_stiffness)
    return np.array(felt[:4]).reshape(2, 2)
