"""Force and torques of the summits of a film with all their derivatives, for machines whose rings turn.

A ring that sticks and slips follows the motion: the torques on journal and shell then count as the force does, by
displacement, velocity and both speeds. The time loop, which has the speeds from stage to stage, takes rub alone.
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array
from frbcli.film.roughness.asperities import SLOW, Asperities, touch_along

# What is found: force on the journal in N, torques in N m on the journal and on the shell, each about its own middle
F_X, F_Y, ON_JOURNAL, ON_SHELL, FOUND = range(5)
# Columns of each: its value, and its derivatives by displacement, velocity, slip and speed of the shell
VALUE, BY_X, BY_Y, BY_V_X, BY_V_Y, BY_SLIP, BY_SHELL, COLUMNS = range(8)
LEAST = 1e-300  # m: eccentricity in the middle, which has no line of centres


def rub_slopes(asperities: Asperities, f: int, clearance: float, motions: Array) -> Array:
    """(k, FOUND, COLUMNS) of film f in motions (k, 6): displacement in m and velocity in m/s of the journal in its
    shell, slip omega_J - omega_S and speed omega_S of the shell in rad/s. See rub of asperities.py."""
    place, rate, (slip, shell) = motions[:, :2], motions[:, 2:4], motions[:, 4:].T
    e = np.maximum(np.hypot(*place.T), LEAST)
    touched = np.zeros((len(motions), 4))
    touch_along(asperities, f, clearance, e, touched)
    normal, radial, normal_slope, radial_slope = touched.T
    radius, away = float(asperities.radii[f]), place / e[:, None]
    across = np.column_stack([-away[:, 1], away[:, 0]])  # to which the line of centres turns
    share = radial / np.maximum(normal, LEAST)
    along = np.sum(across * rate, axis=1) - shell * e
    outwards = (radial_slope - share * normal_slope) / np.maximum(normal, LEAST) * along - share * shell
    turned = -share * np.sum(away * rate, axis=1) / e

    def spread(value: Array, by_e: Array | float, by_turn: Array | float, by_rate: Array, last: list[Array]) -> Array:
        """(k, COLUMNS) by derivatives outwards, across, by the velocity across, and by both speeds."""
        by_place = np.reshape(by_e, (-1, 1)) * away + np.reshape(by_turn, (-1, 1)) * across
        return np.column_stack([value, by_place, by_rate[:, None] * across, *last])

    sliding = spread(
        radius * slip + share * along, outwards, turned, share, [np.full_like(e, radius), -share * e]
    )
    held = np.tanh(sliding[:, VALUE] / SLOW)
    coefficient = asperities.friction / SLOW * (1.0 - held**2)[:, None] * sliding
    coefficient[:, VALUE] = asperities.friction * held

    def by_friction(size: Array, by_e: Array) -> Array:
        """(k, COLUMNS) of the coefficient of friction times a size, which the eccentricity changes."""
        found = size[:, None] * coefficient
        found[:, BY_X : BY_Y + 1] += (coefficient[:, VALUE] * by_e)[:, None] * away
        return found

    friction = by_friction(radial, radial_slope)
    still = np.zeros_like(e)
    pressed = spread(radial, radial_slope, 0.0, still, [still, still])
    force = -away[:, :, None] * pressed[:, None] - across[:, :, None] * friction[:, None]
    turns = across / e[:, None]  # by which both directions turn with the displacement
    force[:, :, BY_X : BY_Y + 1] += (
        friction[:, None, :1] * away[:, :, None] - pressed[:, None, :1] * across[:, :, None]
    ) * turns[:, None]
    on_journal = by_friction(-radius * normal, -radius * normal_slope)
    on_shell = by_friction(e * radial + radius * normal, radial + e * radial_slope + radius * normal_slope)
    return np.concatenate([force, on_journal[:, None], on_shell[:, None]], axis=1)
