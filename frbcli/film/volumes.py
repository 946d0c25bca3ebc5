"""The Reynolds equation (3.9) with an oil fraction on finite volumes: conservative to round-off, for every cavitation law.

The plain version: vectorised assembly, a sparse direct solve, Newton's method on the unknown w of the law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.errors import NotConverged
from frbcli.film.balance import Balance, Motion, Stencil, Storage, gap_height
from frbcli.film.cavitation.law import CellState, Law, Scales
from frbcli.film.gap import Section
from frbcli.film.grid import Array
from frbcli.film.volume_grid import VolumeGrid, fitted_grid, volume_grid

__all__ = ["Motion", "Section", "VolumeFilm", "VolumeGrid", "VolumeSolution", "fitted_grid", "volume_grid"]

DEBUG = False
NEWTON_LIMIT = 60
SETTLED = 4e-13
class VolumeSolution:
    pass
@dataclass(frozen=True)
class VolumeSolution:
    w: Array
    state: CellState
    iterations: int
    flows: object = None


class VolumeFilm:
    """A section on a grid with a law. Constant; solve() takes and returns states."""

    def __init__(self, section: Section, grid: VolumeGrid, law: Law, reference: float) -> None:
        """reference: scaled pressure in 1/s that one unit of w stands for."""
        self.section, self.grid, self.law = section, grid, law
        self.scales = Scales(
            reference,
            (section.cavitation_pressure - section.ambient_pressure) / section.pressure_scale,
            section.ambient_pressure / section.pressure_scale,
        )
        self._order, self._indices, self._indptr = _pattern(*grid.shape)

    def cells(self, w: Array) -> CellState:
        """State (m, k) of the cells with the unknown w (m, k)"""
        fixed, shape = self.grid.fixed, self.grid.shape
        s = self.law.cells(w.ravel(), self.scales)
        p, t, q, p_w, t_w, q_w = (
            a.reshape(shape)
            for a in (s.pressure, s.fraction, s.source, s.pressure_slope, s.fraction_slope, s.source_slope)
        )
        return CellState(
            np.where(fixed, self.grid.fixed_pressure, p),
            np.where(fixed, 1.0, t),
            *(np.where(fixed, 0.0, a) for a in (q, p_w, t_w, q_w)),
        )

    def matrix(self, stencil: Stencil):
        from scipy.sparse import csc_matrix
        data = np.concatenate([
            stencil.centre.ravel(), stencil.before.ravel(), stencil.behind.ravel(),
            stencil.below[:, 1:].ravel(), stencil.above[:, :-1].ravel()])
        n = len(self._indptr) - 1
        return csc_matrix((data[self._order], self._indices, self._indptr), shape=(n, n))

    def newton(self, balance, w, storage, limit=NEWTON_LIMIT, mode=""):
        from scipy.sparse.linalg import splu
        hist = []
        for iteration in range(1, limit + 1):
            state = self.cells(w)
            r, size, stencil = balance.residual(state, storage)
            norm = np.max(np.abs(r) / size)
            hist.append(norm)
            if DEBUG: print(iteration, "%.2e %.2e" % (norm, np.abs(r).sum()/size.sum()), (state.fraction<1).sum())
            if norm < SETTLED:
                return VolumeSolution(w, state, iteration)
            dw = splu(self.matrix(stencil)).solve(-r.ravel()).reshape(w.shape)
            if not np.all(np.isfinite(dw)): raise NotConverged("infinite")
            if "chop" in mode:
                new = w + dw
                cross = (w * new < 0) & (np.abs(w) > 1e-10)
                new = np.where(cross, np.sign(new) * 1e-12, new)
                w = new
            else:
                w = w + dw
        raise NotConverged("no " + " ".join("%.0e" % h for h in hist[-6:]))

    def steady(self, motion: Motion, start=None, mode=""):
        balance = Balance(self.section, self.grid, motion)
        rate = (motion.v[0] * np.sin(self.grid.centre) - motion.v[1] * np.cos(self.grid.centre))[:, None]
        w = np.zeros(self.grid.shape) if start is None else start
        return self.newton(balance, w, Storage(rate, np.zeros_like(rate)), mode=mode)


def _pattern(m: int, k: int):
    from scipy.sparse import csc_matrix
    cells = np.arange(m * k).reshape(m, k)
    rows = np.concatenate([cells.ravel()] * 3 + [cells[:, 1:].ravel(), cells[:, :-1].ravel()])
    columns = np.concatenate([cells.ravel(), np.roll(cells, 1, axis=0).ravel(), np.roll(cells, -1, axis=0).ravel(),
        cells[:, :-1].ravel(), cells[:, 1:].ravel()])
    matrix = csc_matrix((np.arange(1, len(rows) + 1), (rows, columns)), shape=(m * k, m * k))
    return matrix.data - 1, matrix.indices, matrix.indptr
