"""The perturbed round-off of the tests in this folder and others, see tests/round_off.py."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse.linalg
from round_off import SIZE, round_off

from frbcli.cycles.method import continuation
from frbcli.film import pads

SYMMETRIC = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.1], [0.0, 0.1, 7.0]])


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch) -> list[np.ndarray]:
    """The matrices that the routines would take."""
    matrices: list[np.ndarray] = []
    original = type(round_off)._perturbed

    def recording(own: object, matrix: object) -> object:
        matrices.append(original(own, matrix))
        return matrices[-1]

    monkeypatch.setattr(type(round_off), "_perturbed", recording)
    return matrices


def test_it_is_on_in_this_folder_and_reaches_names_that_modules_keep(request: pytest.FixtureRequest) -> None:
    if not request.config.getoption("--round-off"):
        pytest.skip("switched off")
    before = round_off.count
    np.linalg.eigvals(SYMMETRIC)
    continuation.lu_factor(SYMMETRIC)
    pads.splu(scipy.sparse.csc_matrix(SYMMETRIC))
    scipy.linalg.eigh(SYMMETRIC, np.diag([1.0, 2.0, 3.0]))
    assert round_off.count == before + 5


def test_entries_are_off_by_a_share_of_their_own_size(seen: list[np.ndarray]) -> None:
    """Zeros stay, symmetric matrices stay symmetric, and the same matrix is the same in one test."""
    full = np.random.default_rng(0).normal(size=(40, 40)) * np.logspace(-9.0, 9.0, 40)
    with round_off.on("a test", 1):
        for matrix in (full, full, full + 1j * full.T, SYMMETRIC):
            np.linalg.eigvals(matrix)
        scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(SYMMETRIC))
    with round_off.on("a test", 2):
        np.linalg.eigvals(full)
    first, second, complex_one, symmetric, sparse, other_seed = seen
    off = np.abs(first / full - 1.0)
    assert 0.5 * SIZE < off.max() < 1.3 * SIZE
    assert np.count_nonzero(off) > 0.8 * off.size
    np.testing.assert_array_equal(first, second)
    assert (first != other_seed).any()
    assert 0.0 < np.abs(complex_one / (full + 1j * full.T) - 1.0).max() < 1.5 * SIZE
    for kept in (symmetric, sparse.toarray()):
        assert (kept != SYMMETRIC).any()
        np.testing.assert_array_equal(kept, kept.T)
        np.testing.assert_array_equal(kept == 0.0, SYMMETRIC == 0.0)
    assert sparse.nnz == np.count_nonzero(SYMMETRIC)
