"""The mesh of quadratic elements of the published two-phase form: its openings, its shape functions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from frbcli.film.cells.mesh.openings import hole_area
from frbcli.film.gap import AxialGroove, Hole, LobedShell, Section
from frbcli.film.published.mesh.quadratic import quadratic_mesh

Array = np.ndarray
RADIUS, WIDTH = 12.5e-3, 20e-3
PLAIN = Section(RADIUS, WIDTH, WIDTH, 40e-6, 10e-3, 1e5, 1e5, 1, "oil-bath", "oil-bath")


def bore(position: float, axial: float = 10e-3, radius: float = 1.25e-3, pressure: float = 1e5) -> Hole:
    return Hole(position, axial, radius / RADIUS, radius, pressure, True)


SIX = tuple(bore(0.1 + n * math.pi / 3) for n in range(6))
SECTIONS = {
    "plain": PLAIN,
    "six bores": replace(PLAIN, holes=SIX),
    "half of six bores": replace(PLAIN, width=WIDTH / 2, copies=2, far="symmetry", holes=SIX),
    "bore across the seam": replace(PLAIN, holes=(bore(0.0, 6e-3, 3e-3, 2e5), bore(0.7, 13e-3, 3e-3, 2e5))),
    "pocket": replace(PLAIN, holes=(Hole(1.0, 9e-3, 0.4, 6e-3, 1e5, False),)),
    "axial groove": replace(PLAIN, grooves=(AxialGroove(0.0, 0.26, 1e5),)),
    "groove and bore": replace(PLAIN, grooves=(AxialGroove(2.0, 0.2, 1e5),), holes=(bore(-1.0, 5e-3),)),
    "circumferential groove": replace(PLAIN, width=WIDTH / 2, copies=2, far="groove", far_pressure=1e5),
    "lobes": replace(PLAIN, lobes=LobedShell(3, 0.4, 0.2)),
}


@pytest.mark.parametrize("mesh", [(20, 10), (41, 17)], ids=str)
@pytest.mark.parametrize("name", SECTIONS)
def test_grooves_and_holes_have_their_area(name: str, mesh: tuple[int, int]) -> None:
    section = SECTIONS[name]
    made = quadratic_mesh(section, *mesh)
    openings = sum(hole_area(section, hole) for hole in section.holes) / (RADIUS * section.width)
    openings += sum(groove.opening for groove in section.grooves)
    assert made.area.sum() == pytest.approx(2 * math.pi, rel=1e-12)
    assert made.area.min() > 0.0
    assert made.area[made.covered].sum() == pytest.approx(openings, rel=1e-12, abs=1e-14)


def test_crowded_bores_do_not_fold_elements() -> None:
    """A bore beside the faces of three others, which leave it slivers; areas would add up to more than the turn."""
    holes = (
        Hole(-3.478, 6.32e-3, 0.111, 2.42e-3, 1e5, True),
        Hole(-2.962, 10e-3, 0.0685, 4.91e-4, 1e5, False),
        Hole(-1.398, 10e-3, 0.0852, 6.16e-4, 1e5, True),
        Hole(-1.998, 8.67e-3, 0.371, 2.91e-3, 1e5, True),
    )
    section = replace(SECTIONS["half of six bores"], holes=holes)
    mesh = quadratic_mesh(section, 15, 10)
    openings = sum(hole_area(section, hole) for hole in holes) / (RADIUS * section.width)
    assert mesh.area.sum() == pytest.approx(2 * math.pi, rel=1e-12)
    assert mesh.area[mesh.covered].sum() == pytest.approx(openings, rel=1e-12)


def test_round_holes_are_round() -> None:
    """The nodes on the edge of a bore lie on a circle, to the 3 % by which four parabolas miss it."""
    section = replace(PLAIN, holes=(bore(1.0),))
    mesh = quadratic_mesh(section, 20, 10)
    inside = np.zeros(mesh.phi.size, dtype=bool)
    inside[mesh.nodes[mesh.covered]] = True
    radius = np.hypot((mesh.phi - 1.0) * RADIUS, (mesh.z - 0.5) * WIDTH).ravel()[inside]
    assert len(radius) == 9
    assert np.sort(radius)[1:] == pytest.approx(1.25e-3, rel=0.03)


def test_the_number_of_elements_is_what_is_asked_for_unless_holes_need_more() -> None:
    few = quadratic_mesh(SECTIONS["six bores"], 20, 10)
    many = quadratic_mesh(SECTIONS["six bores"], 5, 2)
    assert (few.around, few.along) == (20, 10)
    assert (many.around, many.along) == (12, 3)


def test_shape_functions_differentiate_a_field() -> None:
    """On straight elements quadratic functions are exact; on those that a bore bends, linear ones."""
    for section, degree in ((PLAIN, 2), (SECTIONS["six bores"], 1)):
        mesh = quadratic_mesh(section, 20, 10)
        slopes = np.einsum("egnd,en->egd", mesh.slopes, (mesh.z.ravel() ** degree)[mesh.nodes])
        assert slopes[..., 1] == pytest.approx(degree * mesh.height ** (degree - 1), abs=1e-11)
        assert slopes[..., 0] == pytest.approx(0.0, abs=1e-11)
