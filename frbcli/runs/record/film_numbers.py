"""The numbers of the films of a run that heat and inputs over time change, at its samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.scene.machine.system import System


@dataclass(frozen=True)
class FilmNumbers:
    """The numbers of films that heat and inputs change, at k samples, or once for all: (k, films) or (1, films) each.

    clearances m; drags N m s; scales: 12 eta / psi^2 over its value for the films as they were made, over the share of
    their gauge supply pressures.
    """

    clearances: Array
    drags: Array
    scales: Array


def unchanged(system: System) -> FilmNumbers:
    """The numbers of films without heat, with one row: clearances in m, drags in N m s, scales 1."""
    clearances, drags = np.array([system.clearances]), np.array([system.drags])
    return FilmNumbers(clearances, drags, np.ones_like(drags))


def supplied(system: System, warm: FilmNumbers | None, shares: Array | None) -> FilmNumbers | None:
    """The numbers `warm` with shares (k, films) of the gauge supply pressures; None where nothing changes."""
    if shares is None:
        return warm
    films = warm or unchanged(system)
    clearances, drags = (np.broadcast_to(each, shares.shape) for each in (films.clearances, films.drags))
    return FilmNumbers(clearances, drags, films.scales / shares)
