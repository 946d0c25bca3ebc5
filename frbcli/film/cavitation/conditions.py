"""The classical conditions of cavitation: Sommerfeld and half-Sommerfeld, Reynolds, and Elrod's mass-conserving one.

Sommerfeld's condition, no cavitation at all, and half-Sommerfeld (3.29), which clips its result.

The Reynolds or Swift-Stieber condition (3.30): the pressure ends at p_cav with no slope. Oil appears in the cavity.

As a complementarity: either the pressure is above p_cav, or a source keeps it there. w < 0 is the source.

Jakobsson, Floberg and Olsson's condition in Elrod's manner (3.34) to (3.37): full, or at p_cav and partly empty.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import Cell, CellState, FilmOil, Key, Law, Numbers, Scales, slopes_at_edge


@dataclass(frozen=True)
class Sommerfeld(Law):
    """No parameters."""

    name = "sommerfeld"
    label = "Sommerfeld"
    cell_words = "no cavitation: pressures below `p_cav` pull"
    keeps_oil = False
    cavitates = False
    closed = True
    cost = 1.0

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """w = (p - p_cav) / reference."""
        return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0


@dataclass(frozen=True)
class HalfSommerfeld(Sommerfeld):
    """Reynolds' equation without cavitation; the loads take no pressure below p_cav (3.29)."""

    name = "half-sommerfeld"
    label = "half-Sommerfeld"
    equation = "(3.29)"
    cell_words = "as `sommerfeld`; the loads are computed with `p_cav` where the pressure is below it"
    cavitates = True
    clips = True


@dataclass(frozen=True)
class Reynolds(Law):
    """No parameters."""

    name = "reynolds"
    label = "Reynolds"
    equation = "(3.30)"
    cell_words = "the pressure is above `p_cav`, or a source keeps it there"
    conserves = False
    keeps_oil = False
    holds_cavity = True
    edges = True
    cost = 1.0

    def edged(self, state: CellState, w: Array, scales: Scales, rate: Array, through: Array) -> CellState:
        """See Law.edged. s is linear in w, so that pressure and source have no kink: w reference = 2 s A / (2 through),
        which is the pressure and once more that at s = 1 where s > 1."""
        opens, value = np.maximum(rate, 0.0), w * scales.reference
        most = np.broadcast_to(0.5 * opens / through, w.shape)
        place = np.divide(value, 2.0 * most, out=np.where(value > 0.0, 1.0, 0.0), where=most > 0.0)
        near = np.clip(place, 0.0, 1.0)
        return CellState(
            pressure=scales.cavitation + np.where(place < 1.0, most * near**2, value - most),
            fraction=state.fraction,
            source=0.5 * opens * (1.0 - near) ** 2 - through * np.minimum(value, 0.0),
            pressure_slope=scales.reference * near,
            fraction_slope=state.fraction_slope,
            source_slope=-scales.reference * through * (1.0 - near),
        )

    def edge_slopes(self, pressure: Array, scales: Scales, rate: Array, through: Array) -> tuple[Array, Array]:
        """See Law.edge_slopes."""
        return slopes_at_edge(pressure - scales.cavitation, 0.0, rate, through)

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """w = (p - p_cav) / reference in a full cell; minus the source over the reference in others."""
        if w > 0.0:
            return scales.cavitation + w * scales.reference, 1.0, 0.0, scales.reference, 0.0, 0.0
        return scales.cavitation, 1.0, -w * scales.reference, 0.0, 0.0, -scales.reference


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

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """w = (p - p_cav) / reference in a full cell, whose theta is (3.35), and theta - 1 in others. From theta = e on
        the law goes on linearly, for Newton's method."""
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
