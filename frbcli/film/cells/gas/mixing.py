"""What cells are given of their gas in the next iteration of a film, from how it changed in the last ones.

Pressures and gas that are solved in turn tend to a solution by a fixed ratio, if they do: on fine cells the gas answers
a change with a larger one that is opposite. A mean over the last iterations, in which their changes cancel each other,
needs a few of them for either (D. G. Anderson, J. ACM 12, 1965, 547-560).
"""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

MEMORY = 5  # iterations
DEPENDENT = 1e-10  # of the largest: changes that are so small by themselves say nothing


class GasMixing:
    """The gas of a film over its iterations. most: all gas of the oil, beyond which none is given."""

    def __init__(self, most: float) -> None:
        self._most = most
        self._last: tuple[Array, Array] | None = None
        self._changes: list[Array] = []
        self._given: list[Array] = []

    def mixed(self, before: Array, after: Array, share: float) -> Array:
        """(2, m, k) c_in and r that cells are given, see balance.py, where an iteration made `after` of `before`.

        share: below 1, cells follow this share of the change alone.
        """
        off = after[0] - before[0]
        if self._last is not None:
            self._changes = [*self._changes, (off - self._last[0]).ravel()][-MEMORY:]
            self._given = [*self._given, after - self._last[1]][-MEMORY:]
        self._last = off, after.copy()
        if share < 1.0 or not self._changes:
            return np.asarray(before + share * (after - before))
        changes = np.array(self._changes)
        weights, *_ = np.linalg.lstsq(changes @ changes.T, changes @ off.ravel(), rcond=DEPENDENT)
        gas, turnover = after - np.tensordot(weights, np.array(self._given), 1)
        return np.stack([np.clip(gas, 0.0, self._most), np.maximum(turnover, 0.0)])
