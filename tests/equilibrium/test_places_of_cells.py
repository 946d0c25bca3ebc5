"""What the mean over a few places of the cells leaves of eigenvalues, on a film whose stiffness jumps between them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from frbcli.equilibrium.dynamic_films import SPREAD, DynamicFilm, Oscillator, modes, place_errors
from frbcli.film.cells.linearised import weighted, without_memory

MASS, STIFFNESS, JUMP, OMEGA = 2.0, 2e6, 2e3, 1000.0
PLACES, OFFSETS = 8, 50


def oscillator() -> Oscillator:
    """A mass on one film that pushes it as its journal moves, along one line."""
    one = np.ones((1, 1))
    return Oscillator(MASS * one, 0.0 * one, 0.0 * one, one[None], one[None])


def film(offset: float, jumps: tuple[float, ...]) -> DynamicFilm:
    """A film whose damping jumps by JUMP / OMEGA at each of the places in `jumps` and rises evenly between them, in
    shares of a cell; its cells lie at `offset` and evenly behind it."""
    shares = [sum((offset + number / PLACES - jump) % 1.0 for jump in jumps) for number in range(PLACES)]
    parts = tuple(
        without_memory(np.array([[STIFFNESS / PLACES]]), np.array([[JUMP / OMEGA * share / PLACES]]))
        for share in shares
    )
    mean = weighted([(part, 1.0) for part in parts])
    whole = tuple(weighted([(part, float(PLACES))]) for part in parts)
    return DynamicFilm(mean, mean, mean, weighted([(mean, 0.0)]), None, (whole,))


def growth_and_error(offset: float, jumps: tuple[float, ...]) -> tuple[float, float]:
    machine, films = oscillator(), [film(offset, jumps)]
    (value, _), *_ = modes(machine, films, [films[0].own], OMEGA)
    return value.real, float(place_errors(machine, films, np.array([value]))[0])


@pytest.mark.parametrize("jumps", [(0.3,), (0.05, 0.62)])
def test_the_error_by_the_places_is_the_scatter_over_where_the_cells_lie(jumps: tuple[float, ...]) -> None:
    """The growth is -D / (2 m), D in the mean a half of each jump. Two fronts are 0.57 cells or 4.56 places apart, so
    that what they leave adds up neither always nor never."""
    found = np.array([growth_and_error(offset / OFFSETS / PLACES, jumps) for offset in range(OFFSETS)])
    off = found[:, 0] + 0.5 * len(jumps) * JUMP / OMEGA / (2.0 * MASS)
    rms, told = math.sqrt(np.mean(off**2)), found[:, 1] / SPREAD
    if len(jumps) == 1:
        np.testing.assert_allclose(told, rms, rtol=2e-3)
    assert np.abs(off).max() < 2.0 * told.min()
    assert 0.5 * rms < told.min() <= told.max() < 2.0 * rms
