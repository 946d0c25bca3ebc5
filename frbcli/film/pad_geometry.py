"""A pad of a thrust bearing: a sector of a ring whose gap narrows from its leading edge to a land; and what plans say
of its film.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

MESH, COARSE = (16, 32), (8, 16)  # elements in the radius and in the angle: planned, and for its error
SOMMERFELD, HALF_SOMMERFELD, REYNOLDS = LAWS = ("sommerfeld", "half-sommerfeld", "reynolds")  # of cavitation

Profile = Literal["taper", "step"]


@dataclass(frozen=True)
class Pad:
    """A fixed pad, in m and rad.

    angle: of the sector; taper_angle: from the leading edge, where the taper ends and the land begins; taper: depth of
    the taper at the leading edge below the land; profile: "taper", a plane in the angle, or "step", of constant depth
    """

    inner_radius: float
    outer_radius: float
    angle: float
    taper_angle: float
    taper: float
    profile: Profile = "taper"

    def depth(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Depth in m of the pad below its land at angles from the leading edge."""
        if self.profile == "step":
            return np.where(theta < self.taper_angle, self.taper, 0.0)
        return self.taper * np.maximum(0.0, 1.0 - theta / self.taper_angle)
