"""Round-off as an input of the tests: what goes into factorisations and eigenvalue routines, off by 1e-15 of its size.

Processors have different kernels of linear algebra, and so different last digits. A result that follows them shows when
the matrices are perturbed. The same matrix is perturbed in the same way within one test: on every processor two equal
computations are equal to the bit.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import zlib
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg

SIZE = 1e-15  # of each entry, at most
COUNT = 1 << 14  # random numbers, which large matrices repeat from a place of their own

# The matrices among the arguments of each routine, by their names in lower case.
ONE = ("a", "x", "ab", "c")
NUMPY = "solve inv pinv lstsq eig eigvals eigh eigvalsh svd svdvals qr cholesky det slogdet matrix_rank cond"
SCIPY = "inv pinv svd qr cholesky cho_factor lu lu_factor schur solve lstsq solve_banded solve_circulant solve_toeplitz"
SPARSE = "splu spilu factorized spsolve eigs eigsh svds"
PERTURBED: tuple[tuple[ModuleType, str, tuple[str, ...]], ...] = (
    (np.linalg, NUMPY, ONE),
    (scipy.linalg, SCIPY, ONE),
    (scipy.linalg, "eig eigvals eigh eigvalsh qz", ("a", "b")),
    (scipy.sparse.linalg, SPARSE, ("a", "m")),
)


class RoundOff:
    """Perturbs while it is on. Installed once, before frbcli is imported: its modules keep the routines by name."""

    def __init__(self) -> None:
        self._factors: np.ndarray | None = None
        self.count = 0  # of perturbed matrices

    def install(self) -> None:
        """Put every routine behind a function that perturbs its matrices."""
        for module, routines, matrices in PERTURBED:
            for name in filter(functools.partial(hasattr, module), routines.split()):
                setattr(module, name, self._behind(getattr(module, name), matrices))

    @contextlib.contextmanager
    def on(self, name: str, seed: int) -> Iterator[RoundOff]:
        """Perturb by a seed and the name of a test."""
        own = np.random.default_rng([seed, zlib.crc32(name.encode())])
        before, self._factors = self._factors, 1.0 + SIZE * own.uniform(-1.0, 1.0, COUNT)
        try:
            yield self
        finally:
            self._factors = before

    def _behind(self, routine: Callable[..., Any], matrices: tuple[str, ...]) -> Callable[..., Any]:
        names = [each.lower() for each in inspect.signature(routine).parameters]

        @functools.wraps(routine)
        def perturbing(*arguments: Any, **options: Any) -> Any:
            if self._factors is None:
                return routine(*arguments, **options)
            given = [
                self._perturbed(each) if name in matrices else each
                for name, each in zip(names, arguments, strict=False)
            ]
            named = {key: self._perturbed(each) if key.lower() in matrices else each for key, each in options.items()}
            return routine(*given, **named)

        return perturbing

    def _perturbed(self, matrix: Any) -> Any:
        if scipy.sparse.issparse(matrix):
            other = matrix.copy()
            other.data = self._entries(matrix.data)
            if matrix.shape[0] == matrix.shape[1] and abs(matrix - matrix.T).nnz == 0:
                other = (0.5 * (other + other.T)).asformat(matrix.format)
            return other
        if not isinstance(matrix, np.ndarray | list | tuple):
            return matrix  # an operator
        plain = np.asarray(matrix)
        if plain.dtype.kind not in "fc" or not plain.size:
            return matrix
        other = self._entries(plain)
        if plain.ndim == 2 and plain.shape[0] == plain.shape[1]:
            for mirrored in (np.transpose, lambda each: each.conj().T):
                if np.array_equal(plain, mirrored(plain)):
                    return 0.5 * (other + mirrored(other))
        return other

    def _entries(self, entries: np.ndarray) -> np.ndarray:
        """The entries times the factors from a place that follows them; imaginary parts have others."""
        assert self._factors is not None
        self.count += 1
        begin = zlib.crc32(np.ascontiguousarray(entries).tobytes()) % COUNT
        factors = np.resize(np.roll(self._factors, -begin), (2, *entries.shape))
        if entries.dtype.kind == "c":
            return entries.real * factors[0] + 1j * (entries.imag * factors[1])
        return (entries * factors[0]).astype(entries.dtype)


round_off = RoundOff()
