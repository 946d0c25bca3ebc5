"""What the balances of a film are asked for: the motion of the journal, and the oil that the cells store."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from frbcli.film.grid import Array


@dataclass(frozen=True)
class Motion:
    """Motion of the journal relative to the shell.

    d: displacement over the clearance; v: its rate in 1/s; omega: omega_J + omega_S in rad/s.
    """

    d: tuple[float, float]
    v: tuple[float, float]
    omega: float

    @property
    def rate(self) -> float:
        """How fast the gap changes, in 1/s: what drives pressure and flow."""
        return max(0.5 * abs(self.omega), math.hypot(*self.v), 1e-3)


class Storage(NamedTuple):
    """Oil kept in the cells per area and time, factor theta - past: factor and past are (m, 1) or (m, k), in 1/s."""

    factor: Array
    past: Array
