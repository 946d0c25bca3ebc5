"""Rest in films that keep their oil: what is known of how their oil follows, and how many films are solved for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

import frbcli
from frbcli.equilibrium import resting, static_films
from frbcli.equilibrium.newton import ForceBalance
from frbcli.equilibrium.resting import held_in_plane
from frbcli.film.rectangles.film import FilmForce
from frbcli.scene.machine.system import System

OMEGA = 2.0 * math.pi * 150.0
PLACE = np.array([2.7e-5, -3.5e-6])


@pytest.fixture(scope="module")
def system() -> System:
    """A floating ring in two-phase films between circumferential grooves, the outer one with missing oil."""
    groove = '{kind="circumferential-groove", pressure="2 bar"}'
    supplies = [f"bearing.{film}.supply={groove}" for film in ("inner", "outer")]
    case = frbcli.load_case("floating-ring", [*supplies, "film.cavitation=two-phase"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(static_films, "CELLS", (48, 6))
        patch.setattr(static_films, "COARSER", ((24, 4),))
        return static_films.static_films(case).system


def test_a_film_foresees_its_oil(system: System) -> None:
    """Of one place and speed the film of others is foreseen to first order: its oil, force and oil fractions."""
    total, moved, faster = 200.0, np.array([3e-9, -2e-9]), 0.02
    here = system.films.force(1, PLACE, np.zeros(2), total)
    there = system.films.force(1, PLACE + moved, np.zeros(2), total + faster)
    assert here.slopes is not None
    assert here.field is not None
    assert here.fraction is not None
    assert here.fraction.min() < 0.9
    foreseen = here.foreseen(PLACE + moved, total + faster)
    for name in ("field", "fraction"):
        before, found, expected = (np.asarray(getattr(film, name)) for film in (here, foreseen, there))
        assert np.abs(found - expected).sum() < 2e-3 * np.abs(expected - before).sum()
    change = here.by_displacement @ moved + here.slopes.force * faster
    np.testing.assert_allclose(change, there.force - here.force, rtol=2e-3)


def balance_of(system: System) -> Callable[..., ForceBalance[tuple[FilmForce, ...]]]:
    return partial(resting._balance, system, held_in_plane(system, OMEGA), OMEGA, ())


def test_slopes_know_the_oil_that_goes_missing(system: System) -> None:
    """Journals that move change the oil of their films, with it the speed of the ring, and so the forces of both. By
    central differences, films and ring speed settled at each place."""
    at = balance_of(system)
    place = np.array([[2.0e-6, -3.0e-7], [2.6e-5, -2.8e-6]])

    def settled(moved: NDArray[np.float64]) -> ForceBalance[tuple[FilmForce, ...]]:
        found = at(moved, None)
        for _ in range(3):
            found = at(moved, found)
        return found

    here = settled(place)
    for column in range(4):
        step = np.zeros(4)
        step[column] = 2e-10
        ahead, behind = (settled(place + side * step.reshape(2, 2)).residual for side in (1.0, -1.0))
        expected = ((ahead - behind) / 4e-10).reshape(2, 2)
        for found, known in zip(here.slope[:, column].reshape(2, 2), expected, strict=True):
            np.testing.assert_allclose(found, known, atol=2e-3 * np.abs(known).max())
