"""Outflow of a section at its ends z = 0 and z = 1 (sections 3.2.1 and 4.2.1.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.film.gap import Edge
from frbcli.film.grid import NO_SEALS

BEND = 0.5  # share of the pressure of an end cell by which a parabola may change it; more than that is a front
PREFACTOR, STEEPNESS = 0.01, 100.0  # a in 1/s and b of (4.37)


class EndSlope(NamedTuple):
    """Slope at an end, rise (p_0 + bend (p_0 - p_1) - p_end), by the pressures of the last two cells."""

    rise: float
    bend: float


def end_slope(distances: Array, seal: float) -> EndSlope:
    """The slope at an end from the distances (k,) of the cells' unknowns, over the width.

    Behind a seal of this length, over the width, lies the pressure p_end: at the end of the film it is higher by the
    slope times that length.
    """
    first = float(distances[0])
    rise, bend = 1.0 / first, 0.0
    if len(distances) > 1:
        second = float(distances[1])
        rise, bend = (first + second) / (first * second), first**2 / (second**2 - first**2)
    return EndSlope(rise / (1.0 + rise * seal), bend)


def end_slopes(height: Array, seals: tuple[float, float] = NO_SEALS) -> tuple[EndSlope, EndSlope]:
    """The slopes at z = 0 and z = 1 for the places `height` (k,) of the cells' unknowns; seals: see Section."""
    return end_slope(height, seals[0]), end_slope(1.0 - height[::-1], seals[1])


def end_outflow(
    kind: Edge, pressure: Array, conductance: Array, length: Array, groove: float, ambient: float, bathed: Array
) -> tuple[Array, Array]:
    """Outflow of the last cells (n,) through an end and its derivative by their pressure.

    pressure: of the cells; conductance: from their middle to the end; length: of their share of the end, each (n,);
    groove: pressure in a groove at this end; ambient: absolute ambient pressure; bathed: (n,) share of a free end that
    lies in a bath. Pressures are scaled (1/s), and all
    but the last are over the ambient pressure.
    """
    if kind == "symmetry":
        return np.zeros_like(pressure), np.zeros_like(pressure)
    if kind == "oil-bath":
        return conductance * pressure, conductance
    if kind == "groove":
        return conductance * (pressure - groove), conductance
    out, slope = _free_to_air(pressure, conductance, length, STEEPNESS / ambient)
    return (1.0 - bathed) * out + bathed * conductance * pressure, (1.0 - bathed) * slope + bathed * conductance


def _free_to_air(pressure: Array, conductance: Array, length: Array, steepness: float) -> tuple[Array, Array]:
    """conductance (p - p_edge) = a exp(b p_edge) length, (4.36) and (4.37), solved by Wright's omega function."""
    from scipy.special import wrightomega

    omega = wrightomega(np.log(PREFACTOR * steepness * length / conductance) + steepness * pressure)
    return conductance / steepness * omega, conductance * omega / (1.0 + omega)
