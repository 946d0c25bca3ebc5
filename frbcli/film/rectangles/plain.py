"""The Reynolds equation (3.9) of a rectangular film, plainly: scikit-fem assembly and a sparse direct solve.

This is the naive way. It is slow and easy to read; `modal.py` solves the same equations and a test holds the two
together to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array


@dataclass(frozen=True)
class PlainFilm:
    """Pressure at the nodes of the mesh. phi, z: (n,) coordinates of the n nodes; pressure: (n,) scaled, gauge."""

    phi: Array
    z: Array
    pressure: Array


def solve_plain(
    phi_vertices: Array,
    z_vertices: Array,
    radius_to_width: float,
    displacement: tuple[float, float],
    squeeze: tuple[float, float],
    edge_pressure: tuple[float, float] = (0.0, 0.0),
) -> PlainFilm:
    """Sommerfeld's pressure of one film section on quadratic quadrilaterals, periodic in phi.

    phi_vertices: (m,) element boundaries of one turn, in [0, 2 pi); z_vertices: (k,) from 0 to 1;
    displacement: d = D/C; squeeze: w = d' - (omega/2) J d in 1/s; edge_pressure: scaled gauge pressure at z = 0 and 1.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import spsolve
    from skfem import Basis, BilinearForm, ElementQuad2, LinearForm, MeshQuad, asm

    turn = np.append(phi_vertices, phi_vertices[0] + 2 * np.pi)
    basis = Basis(MeshQuad.init_tensor(turn, z_vertices), ElementQuad2(), intorder=5)
    d, w, aspect = displacement, squeeze, radius_to_width**2

    @BilinearForm
    def diffusion(p, q, s):  # type: ignore[no-untyped-def]
        gap = 1 + d[0] * np.sin(s.x[0]) - d[1] * np.cos(s.x[0])  # (4.4)
        return gap**3 * (p.grad[0] * q.grad[0] + aspect * p.grad[1] * q.grad[1])

    @LinearForm
    def motion(q, s):  # type: ignore[no-untyped-def]
        return -(w[0] * np.sin(s.x[0]) - w[1] * np.cos(s.x[0])) * q  # (4.5)

    phi, z = basis.doflocs
    # The seam: every node at the end of the turn is the node at its beginning.
    seam = np.isclose(phi, turn[-1])
    master = np.arange(len(phi))
    start = np.flatnonzero(np.isclose(phi, turn[0]))
    master[seam] = start[np.argmin(np.abs(z[seam][:, None] - z[start][None, :]), axis=1)]
    kept, column = np.unique(master, return_inverse=True)
    join = csr_matrix((np.ones(len(phi)), (np.arange(len(phi)), column)))
    matrix = (join.T @ asm(diffusion, basis) @ join).tocsr()
    load = join.T @ asm(motion, basis)

    pressure = np.where(np.isclose(z[kept], 1.0), edge_pressure[1], edge_pressure[0])
    inner = np.flatnonzero((z[kept] > 1e-12) & (z[kept] < 1 - 1e-12))
    fixed = pressure.copy()
    fixed[inner] = 0.0
    pressure[inner] = spsolve(matrix[inner][:, inner].tocsc(), (load - matrix @ fixed)[inner])
    return PlainFilm(phi[kept], z[kept], pressure)
