"""Bubbly oil: free gas goes with the oil, leaves the solution and goes back into it, each at its own rate.

The oil is incompressible, its free gas ideal and isothermal. With c the volume of free gas at the saturation pressure
p_s over the volume of the oil, and u = p / p_s absolute,

    theta = u / (u + c).

Henry's law: the oil dissolves the volume alpha u, alpha being Bunsen's coefficient; with all the gas that it carries,
C = alpha + c_0 (it is supplied saturated at p_s, with the free gas c_0), the free gas in equilibrium is c_e = max(C -
alpha u, 0). It approaches this with the oil,

    dc/dt = (c_e - c) / tau,   tau = tau_release where c < c_e, tau_absorption where c > c_e.

An implicit balance of the free gas of a cell has the one solution

    c = c_in + (c_e - c_in) / (1 + tau r),

c_in being what the balance would give without exchange and r the rate in 1/s at which the oil of the cell is replaced
or stored anew (balance.py in cells/gas/). So c follows from the pressure of the cell, and a film has one unknown per
cell, as with any other law. tau = 0 is Peeken's model: c = c_e. With tau = oo the film is barotropic, of a constant c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cavitation.law import CellState, CellWithGas, FilmOil, Key, Law, Numbers, Scales

INSTANT = 1e-25  # s, as good as none


@dataclass(frozen=True)
class Bubbly(Law):
    """bunsen: alpha; supplied: c_0; saturation: p_s in 1/s; release_time, absorption_time: in s."""

    bunsen: float
    supplied: float
    saturation: float
    release_time: float
    absorption_time: float

    name = "bubbly"
    label = "bubbly"
    equation = "(Henry's law with rates)"
    meaning = "Bubbles that last: gas is released and absorbed at rates, and goes with the oil."
    cell_words = "free gas goes with the oil, and is released and absorbed in time"
    keys = (
        Key("bunsen", 0.1, "Bunsen's coefficient, share of dissolved gas", "0.1", least=0.0),
        Key("entrained", 0.0, "free gas over volume of supplied oil, at saturation_pressure", "0.02", least=0.0),
        Key("saturation_pressure", None, "of the supplied oil, absolute; by default oil.cavitation_pressure",
            "1 bar", unit="Pa", above=0.0),
        Key("release_time", 1e-3, "time constant of the gas", "1 ms", unit="s", least=0.0),
        Key("absorption_time", 1.0, "time constant of the gas", "1 s", unit="s", least=0.0),
    )  # fmt: skip
    carries_gas = True
    cost = 1.7

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        pressure = oil.cavitation if given.saturation_pressure is None else given.saturation_pressure
        return cls(given.bunsen, given.entrained, pressure / oil.scale, given.release_time, given.absorption_time)

    @classmethod
    def legend(cls, given: Any) -> str:
        return f"bubbly, $\\alpha_B$ = {given.bunsen:g}, in equilibrium"

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> CellWithGas:  # type: ignore[override]
        """State of one cell; its c_in and r are the last two parameters, its c and by how much this grows with c_in at
        the same pressure the last two results.

        w + 1 + p_cav / reference = theta + p / reference is a quadratic in u where c = a - b u, which holds with other
        a and b for release, absorption, and absorption of all gas. Below p = 0 the law goes on linearly. Without a
        branch, so that cells are computed side by side: a cell is below the level of u if level (u + c) < ratio u (u +
        c) + u. """
        bunsen, supplied, saturation, release_time, absorption_time, carried, turnover = parameters
        ratio, total = saturation / scales.reference, bunsen + supplied
        level = w + 1.0 + (scales.cavitation + scales.ambient) / scales.reference
        per_slope = 1.0 / max(bunsen, 1e-300)
        balanced, clear = (total - carried) * per_slope, total * per_slope
        releases = (balanced > 0.0) & ((level - ratio * balanced) * (balanced + carried) < balanced)
        share = 1.0 / (1.0 + (release_time if releases else absorption_time) * turnover)
        passed = 1.0 - share
        kept = passed * carried
        dissolves = releases | ((clear > 0.0) & ((level - ratio * clear) * (clear + kept) < clear))
        a, slope = (kept + share * total, share * bunsen) if dissolves else (kept, 0.0)
        e, inside = 1.0 - slope, max(level, 0.0)
        b = ratio * a + 1.0 - inside * e
        root = math.sqrt(max(b * b + 4.0 * ratio * e * inside * a, 1e-300))
        upper, lower = (2.0 * inside * a, b + root) if b > 0.0 else (root - b, 2.0 * ratio * e)
        u = upper / lower
        by_w = (a + e * u) / root
        u += min(level, 0.0) * by_w
        return (
            u * saturation - scales.ambient, level - ratio * u, 0.0, saturation * by_w, 1.0 - ratio * by_w, 0.0,
            a - slope * max(u, 0.0), passed,
        )  # fmt: skip

    @property
    def parameters(self) -> Numbers:
        """See Law.parameters. Times are longer than none: oil that is replaced at once keeps the gas it comes with."""
        rates = (max(time, INSTANT) for time in (self.release_time, self.absorption_time))
        return (self.bunsen, self.supplied, self.saturation, *rates)

    @property
    def supplied_gas(self) -> float:
        """See Law.supplied_gas: c_0."""
        return self.supplied

    @property
    def gas_content(self) -> float:
        """See Law.gas_content: C."""
        return self.bunsen + self.supplied

    def standing(self, scales: Scales) -> float:
        u = scales.ambient / self.saturation
        free = max(self.gas_content - self.bunsen * u, 0.0)
        return -free / (u + free) - scales.cavitation / scales.reference

    def free_gas(self, state: CellState, scales: Scales) -> Array:
        """See Law.free_gas: c."""
        u = (state.pressure + scales.ambient) / self.saturation
        return np.asarray(u * (1.0 / state.fraction - 1.0))

    def exchanged(self, pressure: Array, carried: Array, scales: Scales) -> tuple[Array, Array]:
        """See Law.exchanged: c_e and tau."""
        settled = self.bunsen + self.supplied - self.bunsen * (pressure + scales.ambient) / self.saturation
        settled = np.maximum(settled, 0.0)
        return settled, np.where(carried < settled, self.release_time, self.absorption_time)

    def curve(self, ratio: Array) -> Array:
        """theta at p / p_cav of oil whose gas is in equilibrium; the ratio is above 0."""
        u = ratio / self.saturation
        free = np.maximum(self.bunsen + self.supplied - self.bunsen * u, 0.0)
        return np.asarray(u / (u + free), dtype=np.float64)
