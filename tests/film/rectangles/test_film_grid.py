"""The modes of a film along its axis, from which its pressure is made."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine, asm

from frbcli.film.grid import axial_modes, axial_vertices


@BilinearForm
def slopes(u, v, _):  # type: ignore[no-untyped-def]
    return u.grad[0] * v.grad[0]


@BilinearForm
def values(u, v, _):  # type: ignore[no-untyped-def]
    return u * v


@pytest.mark.parametrize("elements", [1, 4, 9])
def test_modes_are_those_of_the_forms_that_a_library_assembles(elements: int) -> None:
    vertices = axial_vertices(elements)
    modes = axial_modes(vertices)
    basis = Basis(MeshLine(vertices), ElementLineP2(), intorder=4)
    order = np.argsort(basis.doflocs[0])
    stiffness, mass = (asm(form, basis).toarray()[np.ix_(order, order)] for form in (slopes, values))
    np.testing.assert_allclose(modes.nodes, basis.doflocs[0][order], rtol=0, atol=1e-15)
    np.testing.assert_allclose(modes.mass, mass, rtol=0, atol=1e-15)
    np.testing.assert_allclose(modes.shapes @ mass @ modes.shapes.T, np.eye(len(modes.shapes)), rtol=0, atol=1e-12)
    by_form = modes.shapes @ stiffness @ modes.shapes.T
    np.testing.assert_allclose(by_form, np.diag(modes.eigenvalues), rtol=0, atol=1e-9 * modes.eigenvalues.max())
