"""The numbers of the films of a run that heat changes, at its samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.scene.machine.system import System
from frbcli.solve.state import Array


@dataclass(frozen=True)
class FilmNumbers:
    """The numbers of films that heat changes, at the k samples, or once for all: (k, films) or (1, films) each.

    clearances m; drags N m s; scales: 12 eta / psi^2 over that of the films as they were made.
    """

    clearances: Array
    drags: Array
    scales: Array


def unchanged(system: System) -> FilmNumbers:
    """Those of films without heat."""
    clearances, drags = np.array([system.clearances]), np.array([system.drags])
    return FilmNumbers(clearances, drags, np.ones_like(drags))
