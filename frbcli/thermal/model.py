"""The lumped model of heat: nodes with one temperature each, conductances between them, and films as heat sources.

Of a film f with the power P that journal and shell put into it and the oil flow Q through its ends

    C dT/dt = P - s Q (T - T_in)/m - s Q_fed (T - T_in) - sum over walls of h A (T - T_wall),   h = Nu k / C_r,

where s is the volumetric heat capacity of the oil, A = 2 pi R B, C_r the radial clearance, and Q_fed what films take
that are fed from this one. All other nodes have conductances only; a node of infinite capacity keeps its temperature.
The films are the first nodes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array

FROM_SUPPLY = -1
OIL_AT = 353.15, 393.15  # K between which the heat capacity of the oil is taken as linear
AT_ZERO, SLOPE = range(2)  # volumetric heat capacity AT_ZERO + SLOPE T, J/(m^3 K), T in K


class HeatModel(NamedTuple):
    """n nodes, the first F of them films, l links. capacity (n,) J/K, infinite where a temperature is given; links
    (l, 2) nodes, conductance (l,) W/K at the clearances `reference` (F,), of_film (l,) the film whose clearance it
    divides by, -1: none; supply (F,) K; inlet (F,) the film that feeds this one, or FROM_SUPPLY; mixing: m; oil_heat
    (2,): AT_ZERO, SLOPE; viscosity (3,): eta_0, A, C of Vogel's law; clearance (F,) m at no temperature and speed,
    expansion (F, n) m/K and growth (F, bodies) m s^2 by the squares of the speeds of rotor and rings, see
    clearances_at; hottest: K; balanced: whether films are in balance at each instant of a run."""

    capacity: Array
    links: NDArray[np.int64]
    conductance: Array
    of_film: NDArray[np.int64]
    supply: Array
    inlet: NDArray[np.int64]
    mixing: float
    oil_heat: Array
    viscosity: Array
    clearance: Array
    reference: Array
    expansion: Array
    growth: Array
    hottest: float
    balanced: bool = False


def clearances_at(model: HeatModel, temperatures: Array, speeds: Array) -> Array:
    """(F,) m: C + sum of expansion T + sum of growth omega^2, (4.24), with the temperatures (n,) in K and the speeds
    (bodies,) in rad/s."""
    return np.asarray(model.clearance + model.expansion @ temperatures + model.growth @ np.square(speeds))


def viscosities_at(model: HeatModel, temperatures: Array) -> Array:
    """(F,) Pa s of the films at the temperatures (n,) in K of all nodes, (3.12)."""
    eta_0, a, c = model.viscosity
    return np.asarray(eta_0 * np.exp(a / (temperatures[: len(model.supply)] + c)))


def rates(model: HeatModel, temperatures: Array, power: Array, flow: Array, clearances: Array) -> Array:
    """(n,) W that each node gains; power, flow: (F,) W and m^3/s; clearances (F,) m."""
    films, t = len(power), temperatures
    fed = model.inlet >= 0
    at = np.where(fed, t[model.inlet], model.supply)
    rise = t[:films] - at
    heat = (model.oil_heat[AT_ZERO] + model.oil_heat[SLOPE] * (at + 0.5 * rise / model.mixing)) * flow
    gain = np.zeros(len(t))
    gain[:films] = power - heat * rise / model.mixing
    np.subtract.at(gain, model.inlet[fed], (heat * (t[model.inlet] - model.supply[model.inlet]))[fed])
    conductance = model.conductance.copy()
    of_film = model.of_film >= 0
    conductance[of_film] *= (model.reference / clearances)[model.of_film[of_film]]
    passed = conductance * (t[model.links[:, 0]] - t[model.links[:, 1]])
    np.subtract.at(gain, model.links[:, 0], passed)
    np.add.at(gain, model.links[:, 1], passed)
    return gain
