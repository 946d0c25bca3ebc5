"""What the stages of a step work in, whichever loop takes them. Compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from frbcli.solve.inverse import prepare
from frbcli.solve.stage import JOURNAL_ROWS, STAGE_ROWS
from frbcli.solve.state import INVERSE_G, INVERSE_SPEED, Array


class Scratch(NamedTuple):
    """pick (m, n): the journals' displacements from the rotor's; products, loads, spread, compliance: see prepare of
    inverse.py; at (STAGE_ROWS, n), film (JOURNAL_ROWS, m): rows of stage.py; stage_v, stage_a (n, stages)."""

    pick: Array
    products: Array
    loads: Array
    spread: Array
    compliance: Array
    at: Array
    film: Array
    stage_v: Array
    stage_a: Array


@njit(cache=True, error_model="numpy")
def make_scratch(rotor, numbers, stages):  # type: ignore[no-untyped-def]
    """Scratch for a rotor; its inverse is the one that the numbers tell of, if any."""
    n, m = rotor.mass.shape[0], 2 * rotor.clearances.shape[0]
    pick, products, loads = np.empty((m, n)), np.zeros((3, n, n)), np.zeros((3, n))
    spread, compliance = np.zeros((n, m)), np.zeros((m, m))
    for k in range(m):
        pick[k] = rotor.journals[k // 2, k % 2]
    if numbers[INVERSE_G] > 0.0:
        prepare(
            rotor, pick, numbers, numbers[INVERSE_G], numbers[INVERSE_SPEED], products, loads, spread, compliance
        )
    at, film = np.zeros((STAGE_ROWS, n)), np.zeros((JOURNAL_ROWS, m))
    return Scratch(
        pick, products, loads, spread, compliance, at, film, np.zeros((n, stages)), np.zeros((n, stages))
    )
