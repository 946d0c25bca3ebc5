"""The compiled elimination against scipy's pivoting one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from frbcli.film.cells.plain.elimination import eliminate, plan_elimination


def ring(around: int, along: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of a five-point stencil that closes around."""
    cells = np.arange(around * along).reshape(around, along)
    pairs = [(cells, cells), (cells, np.roll(cells, 1, axis=0)), (cells, np.roll(cells, -1, axis=0))]
    pairs += [(cells[:, 1:], cells[:, :-1]), (cells[:, :-1], cells[:, 1:])]
    return np.concatenate([a.ravel() for a, _ in pairs]), np.concatenate([b.ravel() for _, b in pairs])


def entries(rows: np.ndarray, columns: np.ndarray, seed: int) -> np.ndarray:
    """Of a film: what leaves a cell enters others, and some is stored; entries over six decades."""
    random = np.random.default_rng(seed)
    values = -(10.0 ** random.uniform(-3.0, 3.0, len(rows)))
    same = rows == columns
    values[same] = 0.0
    values[same] = -np.bincount(columns, values)[columns[same]] * (1.0 + 10.0 ** random.uniform(-4.0, 0.0, same.sum()))
    return values


@pytest.mark.parametrize("shape", [(3, 1), (4, 2), (12, 5), (40, 20)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_elimination_agrees_with_scipy(shape: tuple[int, int], seed: int) -> None:
    size = shape[0] * shape[1]
    rows, columns = ring(*shape)
    values = entries(rows, columns, seed)
    right = np.random.default_rng(seed).normal(size=size)
    found = eliminate(plan_elimination(rows, columns, size), values, right)
    expected = spsolve(csc_matrix((values, (rows, columns)), shape=(size, size)), right)
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10 * np.abs(expected).max())


def test_one_plan_serves_any_entries() -> None:
    rows, columns = ring(8, 4)
    plan = plan_elimination(rows, columns, 32)
    for seed in (1, 2):
        values = entries(rows, columns, seed)
        found = eliminate(plan, values, np.ones(32))
        matrix = csc_matrix((values, (rows, columns)), shape=(32, 32))
        assert matrix @ found == pytest.approx(np.ones(32), abs=1e-9)


def test_singular_matrix_gives_no_finite_solution() -> None:
    rows, columns = ring(4, 2)
    found = eliminate(plan_elimination(rows, columns, 8), np.zeros(len(rows)), np.ones(8))
    assert not np.isfinite(found).all()
