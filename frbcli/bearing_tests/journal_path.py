"""How a kinematic test moves the journal: squeeze (4.47) and whirl (4.48), (4.49)."""

from __future__ import annotations

import math
from collections.abc import Callable

from frbcli.film.cells.motion import Motion

Path = Callable[[float], Motion]  # of the time in s

RISE_TIME = 0.01  # s, t_1 of (4.49)


def squeeze_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """D_y = -C eps sin(2 pi f t) (4.47)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        y, v = -eccentricity * math.sin(rate * t), -eccentricity * rate * math.cos(rate * t)
        return Motion((0.0, y), (0.0, v), omega)

    return path


def whirl_path(eccentricity: float, frequency: float, omega: float) -> Path:
    """A circle (4.48) that is reached within some t_1 (4.49)."""
    rate = 2.0 * math.pi * frequency

    def path(t: float) -> Motion:
        fading = math.exp(-t / RISE_TIME)
        e, growth = eccentricity * (1.0 - fading), eccentricity * fading / RISE_TIME
        c, s = math.cos(rate * t), math.sin(rate * t)
        return Motion((e * c, e * s), (growth * c - e * rate * s, growth * s + e * rate * c), omega)

    return path
