"""A bearing in operation: strains of its parts, its warm gap, Reynolds and Sommerfeld number.

Strains are the displacement of a surface over its radius, in the plane stress state of table A.2. Temperatures are
differences to the temperatures at which the parts were measured, in K. """

from __future__ import annotations

import math

from frbcli.materials.solids import Solid

LAMINAR_BELOW = 2300.0  # (3.3)
RING_SPEED = 0.3  # of the rotor's, by table A.1: what a floating ring reaches at most


def reynolds_number(density: float, omega: float, radius: float, clearance: float, viscosity: float) -> float:
    """Re (3.3) of a film, with omega = omega_J + omega_S in rad/s, all in SI. Laminar below LAMINAR_BELOW."""
    return density * abs(omega) * radius * clearance / viscosity


def sommerfeld_number(
    force: float, width: float, radius: float, clearance: float, viscosity: float, omega: float
) -> float:
    """So (3.14) of a whole bearing, with omega = omega_J + omega_S in rad/s, all in SI; NaN where nothing turns."""
    shear = 2.0 * radius * width * viscosity * abs(omega)
    return (clearance / radius) ** 2 * force / shear if shear > 0.0 else math.nan


def friction_coefficient(torque: float, force: float, radius: float) -> float:
    """mu = |T| / (R F) of the torque on the journal in N m, the load in N and the radius in m; NaN without a load."""
    return abs(torque) / (radius * force) if force > 0.0 else math.nan


def shaft_rotation_strain(solid: Solid, omega: float, radius: float) -> float:
    """Strain of the surface of a solid shaft with a radius in m that turns with omega in rad/s."""
    return 0.25 * solid.density * (omega * radius) ** 2 * (1.0 - solid.poisson) / solid.modulus


def ring_rotation_strains(solid: Solid, omega: float, inner: float, outer: float) -> tuple[float, float]:
    """Strains of the inner and the outer surface of a ring with these radii in m that turns with omega in rad/s."""
    scale = 0.25 * solid.density * omega**2 / solid.modulus
    near, across = 1.0 - solid.poisson, 3.0 + solid.poisson
    return scale * (across * outer**2 + near * inner**2), scale * (near * outer**2 + across * inner**2)
