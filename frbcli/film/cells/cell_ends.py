"""What the heat of the time loop asks films on cells for the oil that leaves them."""

from __future__ import annotations

from typing import NamedTuple

from frbcli.arrays import Array
from frbcli.compiled import Indices
from frbcli.film.cells.data import Records


class CellEnds(NamedTuple):
    """Films on cells as they were made, for the heat of the time loop. far_open (F,); units (F,) m^2: a flow of 1 over
    the clearance; films, feed_holes, given (F, m, k) pressures: of VolumeFilms at the reference; resistance
    (channels,) over the viscosity; groove_pressure (channels,) Pa; exponents (F, p): by which the parameters of the
    laws follow the scale of the pressures."""

    far_open: Indices
    units: Array
    films: Records
    given: Array
    feed_holes: Records
    resistance: Array
    exponents: Array
    groove_pressure: Array
