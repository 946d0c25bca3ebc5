"""The motion of the journal that drives a film, also as seen from a surface that turns, and the oil that cells store.

Bores or grooves in a turning surface stand still in a frame that turns with it (section 4.1.5.3).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.film.gap import Displacement, Section, gap_height

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
