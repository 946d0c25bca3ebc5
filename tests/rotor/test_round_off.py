"""Perturbed round-off, and the order of modes and shapes, which does not follow it."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse.linalg
from round_off import SIZE, round_off

from frbcli.cycles.method import continuation
from frbcli.film import pads
from frbcli.linear.stability_point import StabilityPoint, eigenvalues
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import fastest_first, first_largest, largest_first, ranks

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


def shaken(values: np.ndarray, seed: int) -> np.ndarray:
    """With round-off."""
    return np.asarray(values * (1.0 + 1e-14 * np.random.default_rng(seed).standard_normal(len(values))))


@pytest.mark.parametrize("seed", range(5))
def test_equal_numbers_have_one_rank_and_the_next_rule_decides(seed: int) -> None:
    assert ranks(shaken(np.array([3.0, 1.0, 3.0, 2.0, 1.0]), seed)).tolist() == [2, 0, 2, 1, 0]
    alike = shaken(np.array([-2.0, -2.0, -2.0]), seed) + 1j * np.array([30.0, 10.0, 20.0])
    assert fastest_first(alike).tolist() == [1, 2, 0]
    round_the_circle = np.exp(1j * np.array([0.3, -0.3, 0.1, -0.1])) * shaken(np.ones(4), seed)
    assert largest_first(round_the_circle).tolist() == [2, 3, 0, 1]
    assert first_largest(shaken(np.array([1.0, 2.0, -2.0, 2.0]), seed)) == 1


@pytest.mark.parametrize("seed", range(5))
def test_undamped_modes_are_told_by_their_frequency(seed: int) -> None:
    """All grow by nothing, to round-off."""
    noise = 1e-11 * np.random.default_rng(seed).standard_normal(3)
    pairs = noise + 1j * np.array([900.0, 100.0, 400.0])
    modes = StabilityPoint(50.0, (), np.concatenate([pairs, pairs.conj()])).modes
    assert modes.imag.tolist() == [100.0, 400.0, 900.0]


def test_pairs_of_one_frequency_come_by_their_growth_and_stay_together() -> None:
    """A mass on equal springs with dashpots chosen so that x and y have one damped frequency, and different growth."""
    k, c = np.array([101.0, 109.0]), np.array([2.0, 6.0])  # k - c^2 / 4 = 100
    none = np.zeros((2, 2))
    rotor = LinearRotor(
        np.eye(2), none, none, none, np.zeros(2), np.zeros(2), np.zeros(2), np.eye(2)[None], np.ones(1), ()
    )
    found = eigenvalues(rotor, 100.0, np.diag(k)[None], np.diag(c)[None])
    np.testing.assert_allclose(found, [-3 + 10j, -3 - 10j, -1 + 10j, -1 - 10j], rtol=1e-10)


SHAPES = """
import json, frbcli
case = frbcli.load_case("jeffcott", ["film.theory=short"])
found = frbcli.damped_modes(case, 120.0)
print(json.dumps([[m.direction, *(v for z in m.motion.ravel() for v in (z.real, z.imag))] for m in found.modes]))
"""


def test_shapes_do_not_depend_on_the_kernels_of_the_linear_algebra() -> None:
    """The eigenvectors of LAPACK have any phase; those that are told do not."""
    told = []
    for kernels in ("Nehalem", "Haswell"):
        bare = os.environ | {"OPENBLAS_CORETYPE": kernels}
        done = subprocess.run([sys.executable, "-c", SHAPES], env=bare, capture_output=True, text=True, timeout=300)
        told.append(json.loads(done.stdout.splitlines()[-1]))
    assert [mode[0] for mode in told[0]] == [mode[0] for mode in told[1]]
    for one, other in zip(*told, strict=True):
        assert one[1:] == pytest.approx(other[1:], abs=1e-7)
