"""Jakobsson, Floberg and Olsson's condition in Elrod's manner (3.34) to (3.37): full, or at p_cav and partly empty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, CellState, FilmOil, Key, Law, Numbers, Scales

BAR = 1e5


@dataclass(frozen=True)
class Elrod(Law):
    """bulk_modulus: beta of the full film over 12 eta / psi^2, in 1/s; infinite for an incompressible oil."""

    bulk_modulus: float = math.inf

    name = "elrod"
    label = "Elrod"
    equation = "(3.34) to (3.37)"
    meaning = "Elrod's model."
    cell_words = "the cell is full and above `p_cav`, or it is at `p_cav` and holds less oil"
    keys = (
        Key("bulk_modulus", None, "of the full film; incompressible by default", "210 GPa", unit="Pa", above=0.0),
    )
    starves = True
    empties = True
    fronts = 2.3

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        return cls() if given.bulk_modulus is None else cls(given.bulk_modulus / oil.scale)

    @classmethod
    def legend(cls, given: Any) -> str:
        modulus = given.bulk_modulus
        return f"Elrod, {'incompressible' if modulus is None else f'bulk modulus {modulus / BAR:.4g} bar'}"

    def cells(self, w: Array, scales: Scales) -> CellState:
        """w = (p - p_cav) / reference in a full cell, whose theta is (3.35), and theta - 1 in others."""
        full = w > 0.0
        above = np.where(full, w, 0.0) * scales.reference
        packed = above / self.bulk_modulus  # ln(theta), (3.35); beyond 1 the law goes on linearly, for Newton's method
        fraction = np.exp(np.minimum(packed, 1.0)) * np.maximum(packed, 1.0) + np.where(full, 0.0, w)
        steep = np.exp(np.minimum(packed, 1.0)) * scales.reference / self.bulk_modulus
        zero = np.zeros_like(w)
        return CellState(
            pressure=scales.cavitation + above,
            fraction=fraction,
            source=zero,
            pressure_slope=np.where(full, scales.reference, 0.0),
            fraction_slope=np.where(full, steep, 1.0),
            source_slope=zero,
        )

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        if w > 0.0:
            if parameters[0] == math.inf:  # without exp, which the vector units would take for the cavity as well
                return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
            packed = w * scales.reference / parameters[0]
            held = math.exp(min(packed, 1.0))
            steep = held * scales.reference / parameters[0]
            return (
                scales.cavitation + w * scales.reference, held * max(packed, 1.0), 0.0, scales.reference, steep, 0.0
            )  # fmt: skip
        return scales.cavitation, 1.0 + w, 0.0, 0.0, 1.0, 0.0

    def curve(self, ratio: Array) -> Array:
        """theta (3.35) of a full film, 0 below p_cav: at p_cav itself it takes every value up to 1."""
        return np.asarray(np.where(ratio < 1.0, 0.0, np.exp((ratio - 1.0) / self.bulk_modulus)), dtype=np.float64)
