"""State and answers of a film of the published form."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.film.cells.motion import Motion
from frbcli.film.grid import Array


@dataclass(frozen=True)
class NodeState:
    """State of a film. pressure: (2 a, 2 k + 1) scaled gauge pressure of the nodes; fraction: (e, 9) of oil at
    the points."""

    pressure: Array
    fraction: Array


@dataclass(frozen=True)
class ForceResponse:
    """force: (2,) N on the journal by the whole bearing; by_d, by_v: (2, 2) its derivatives by displacement (N) and
    velocity (N s) over the clearance, row: direction of the force."""

    force: Array
    by_d: Array
    by_v: Array


@dataclass(frozen=True)
class PublishedSolution:
    """rate, past: of theta_t = rate theta - past, past (e, 9); residual: left over, relative to the sum of its terms;
    unsettled: share of the force by which another correction would change it; iterations: assemblies of the equations.
    """

    state: NodeState
    response: ForceResponse
    motion: Motion
    rate: float
    past: Array
    residual: float
    unsettled: float
    iterations: int
