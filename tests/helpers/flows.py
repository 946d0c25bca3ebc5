"""Oil that a film took in during a run, from the state of the run."""

from __future__ import annotations

from frbcli.film.cells.balance.balances import CHANNELS_NET, ENDS_NET, SUPPLY_NET
from frbcli.film.cells.data import PASSED
from frbcli.solve.state import State


def net_flow(state: State, film: int) -> float:
    """Oil that came in through openings, ends and coupled channels less what left, in units of R b C."""
    passed = state.flows[PASSED, film]
    return float(passed[SUPPLY_NET] - passed[ENDS_NET] + passed[CHANNELS_NET])
