"""What a cavitation law is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CellState:
    """What a law says of cells with the unknown w, arrays of its shape: pressure over the ambient pressure, scaled, in
    1/s; oil fraction theta; source of oil in 1/s; and the derivatives of the three by w."""

    pressure: Array
    fraction: Array
    source: Array
    pressure_slope: Array
    fraction_slope: Array
    source_slope: Array


@dataclass(frozen=True)
class Scales:
    """Scaled gauge pressures in 1/s of one film: reference (> 0) of the unknown, cavitation, ambient (absolute)."""

    reference: float
    cavitation: float
    ambient: float


FRONTS = 1.5  # fronts between cells make the order 1 to 2: the middle of it


class Law(Protocol):
    """A cavitation model.

    conserves: whether oil neither appears nor vanishes in its cells; clips: whether loads take no pressure below p_cav;
    order: by which forces become exact with smaller cells.
    """

    @property
    def conserves(self) -> bool: ...

    @property
    def clips(self) -> bool: ...

    @property
    def order(self) -> float: ...

    def cells(self, w: Array, scales: Scales) -> CellState:
        """The state of cells with the unknown w, of any shape."""
        ...
