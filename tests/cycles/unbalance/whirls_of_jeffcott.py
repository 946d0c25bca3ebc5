"""Cycles and motions of two frequencies of a Jeffcott rotor, with their runs."""

from __future__ import annotations

import numpy as np

import frbcli
from frbcli.cycles.unbalance.two_frequencies import Torus

SHORT = "film.theory=short"


def jeffcott(unbalance: float, *settings: str) -> frbcli.Case:
    return frbcli.load_case("jeffcott", [f"rotor.unbalance={unbalance} g*mm", *settings])


def harmonic(torus: Torus, j: int, k: int) -> np.ndarray:
    return torus.motion[(torus.orders == [j, k]).all(axis=1)][0]
