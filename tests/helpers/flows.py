"""Oil that a film took in during a run, from the state of the run; and the flows of oil by where they begin, in plain
form."""

import numpy as np

from frbcli.arrays import Array
from frbcli.film.cells.balance.ends import CHANNELS_NET, ENDS_NET, SUPPLY_NET
from frbcli.film.cells.balance.plain import CellBalances
from frbcli.film.cells.data import PASSED
from frbcli.film.cells.gas.balance import OilPaths
from frbcli.film.cells.gas.carry import BACKWARD, DOWNWARD, GIVEN, ONWARD, OUT, UPWARD
from frbcli.solve.state import State


def net_flow(state: State, film: int) -> float:
    """Oil that came in through openings, ends and coupled channels less what left, in units of R b C."""
    passed = state.flows[PASSED, film]
    return float(passed[SUPPLY_NET] - passed[ENDS_NET] + passed[CHANNELS_NET])


def oil_paths(balances: CellBalances, pressure: Array, fraction: Array) -> OilPaths:
    """The flows of oil by where they begin, of cells with pressures and oil fractions (m, k).

    Where surfaces carry more out of a cell than into the next one, which is an opening in part, the opening takes the
    difference, or gives it.
    """
    fluxes, _, _ = balances.fluxes(pressure, fraction)
    share = balances.grid.share
    leaves = fluxes.around + share * fluxes.carried
    enters = fluxes.around + np.roll(share, -1, axis=0) * fluxes.carried
    shared = np.sign(leaves) * np.where(leaves * enters > 0.0, np.minimum(np.abs(leaves), np.abs(enters)), 0.0)
    onward, backward = np.maximum(shared, 0.0), np.maximum(-shared, 0.0)
    upward, downward = np.maximum(fluxes.along, 0.0), np.maximum(-fluxes.along, 0.0)
    out = onward + np.roll(backward, 1, axis=0)
    out[:, :-1] += upward
    out[:, 1:] += downward
    given = np.zeros_like(out)
    outside = [leaves - shared, -np.roll(enters - shared, 1, axis=0), fluxes.excess]
    for at, flow in ((0, fluxes.near), (-1, fluxes.far)):
        outside.append(np.zeros_like(out))
        outside[-1][:, at] = flow
    for flow in outside:
        out += np.maximum(flow, 0.0)
        given += np.maximum(-flow, 0.0)
    return OilPaths(onward, backward, upward, downward, out, given)


def path_layers(paths: OilPaths, layers: Array) -> None:
    """The layers of the paths of carry.py (PATHS, m, k) <- paths in array notation."""
    layers[UPWARD:OUT, :, -1] = 0.0
    layers[UPWARD, :, :-1], layers[DOWNWARD, :, :-1] = paths.upward, paths.downward
    layers[ONWARD], layers[BACKWARD], layers[OUT], layers[GIVEN] = paths.onward, paths.backward, paths.out, paths.given
