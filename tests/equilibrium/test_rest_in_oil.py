"""Rest in films that keep their oil: what is known of how their oil follows, and how many films are solved for it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

import frbcli
from frbcli.equilibrium import static_films
from frbcli.equilibrium.resting import ForceBalance, RestEquations
from frbcli.film.rectangles.film import FilmForce
from frbcli.rotor.assembly import sprung
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


def test_slopes_know_the_oil_that_goes_missing(system: System) -> None:
    """Journals that move, and a ring that turns otherwise, change the oil of the films, and so forces and torques. By
    central differences, the films settled at each place."""
    equations = RestEquations(system, OMEGA)
    held, place = equations.held, np.array([2.0e-6, -3.0e-7, 2.6e-5, -2.8e-6])
    unknowns = equations.with_rings(held.shape + held.following @ place)

    def settled(moved: NDArray[np.float64]) -> ForceBalance[tuple[FilmForce, ...]]:
        found = equations.balance(moved, ())
        for _ in range(3):
            found = equations.balance(moved, found.films)
        return found

    here, n, (_, stiffness) = settled(unknowns), system.rotor.size, sprung(system.rotor)
    stiffness[-1] = 0.0
    for column in (*np.flatnonzero(system.rotor.journals.any(axis=(0, 1))), n - 1):  # no film sees the disk
        step = 2e-10 * np.eye(n)[column]
        ahead, behind = (settled(unknowns + side * step).residual for side in (1.0, -1.0))
        known, found = (each + stiffness[:, column] for each in ((ahead - behind) / 4e-10, here.slope[:, column]))
        for rows in (np.arange(n - 1), [n - 1]):  # forces, and the torque on the ring
            np.testing.assert_allclose(found[rows], known[rows], atol=2e-3 * np.abs(known[rows]).max())
