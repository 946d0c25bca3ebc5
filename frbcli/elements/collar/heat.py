"""The temperature of the oil on the pads of a thrust bearing: what the film dissipates leaves with the oil and through
collar and pads, as in the films of journals (docs/heat.md).

Grooves are fed with oil of the supply temperature, as much as leaves at the inner and outer radius; what passes the
trailing edges goes on to the next pads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from frbcli.case.oil import Oil
from frbcli.case.surroundings.over_time import largest
from frbcli.case.thermal import Thermal, WallNode
from frbcli.thermal.model import FROM_SUPPLY, OIL_AT, HeatModel
from frbcli.thermal.steady import FilmHeat, steady_heat

NAME = "thrust bearing"


LossAndFlow = Callable[[float], tuple[float, float]]  # W and m^3/s of all pads of a side, by the viscosity in Pa s


@dataclass(frozen=True)
class PadHeat:
    """The heat of a case, as far as it concerns thrust bearings."""

    oil: Oil
    thermal: Thermal

    def warm(self, film: LossAndFlow, omega: float, gap: float, inverse_gap: float) -> tuple[float, float]:
        """The viscosity in Pa s and the temperature in K at which the heat of a film balances.

        omega: rad/s; gap: over the lands in m; inverse_gap: integral of 1/h over the pads of a side, m. Raises
        NotConverged if the film becomes hotter than thermal.hottest_film.
        """

        def solve(viscosities: np.ndarray, _: np.ndarray) -> FilmHeat:
            loss, flow = film(float(viscosities[0]))
            return FilmHeat(np.array([loss]), np.array([flow]), np.array([omega]))

        model, start = self._model(gap, inverse_gap)
        steady = steady_heat(model, (NAME,), solve, start, np.array([omega]))
        return float(steady.viscosities[0]), float(steady.temperatures[0])

    def _model(self, gap: float, inverse_gap: float) -> tuple[HeatModel, np.ndarray]:
        """Nodes, the film first, and the temperatures in K to begin from."""
        oil, thermal = self.oil, self.thermal
        transfer = thermal.nusselt * oil.thermal_conductivity * inverse_gap
        nodes = [(1.0, thermal.start_temperature or largest(thermal.supply_temperature))]  # heat capacity, temperature
        links: list[tuple[int, int, float]] = []
        for wall in (thermal.shaft, thermal.housing):
            if isinstance(wall, str):  # adiabatic
                continue
            links.append((0, len(nodes), transfer))
            if isinstance(wall, WallNode):
                nodes += [(wall.capacity, largest(wall.temperature)), (math.inf, largest(wall.temperature))]
                links.append((len(nodes) - 2, len(nodes) - 1, wall.conductance))
            else:
                nodes.append((math.inf, largest(wall)))
        first, last = (oil.density * oil.heat_capacity_at(at) for at in OIL_AT)
        slope, law = (last - first) / (OIL_AT[1] - OIL_AT[0]), oil.law
        assert law is not None  # the checks of a case see to it
        model = HeatModel(
            capacity=np.array([capacity for capacity, _ in nodes]),
            links=np.array([link[:2] for link in links], dtype=np.int64).reshape(-1, 2),
            conductance=np.array([link[2] for link in links]),
            of_film=np.full(len(links), -1),
            supply=np.array([largest(thermal.supply_temperature)]),
            inlet=np.array([FROM_SUPPLY]),
            mixing=thermal.mixing,
            oil_heat=np.array([first - slope * OIL_AT[0], slope]),
            viscosity=np.array([law.eta_0, law.a, law.c]),
            clearance=np.array([gap]),
            reference=np.array([gap]),
            expansion=np.zeros((1, len(nodes))),
            growth=np.zeros((1, 1)),
            hottest=thermal.hottest_film,
        )
        return model, np.array([temperature for _, temperature in nodes])
