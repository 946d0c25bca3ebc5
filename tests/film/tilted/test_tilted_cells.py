"""The cells of runs under a journal that tilts: closed forms on few of them, and their error beside equal ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from frbcli.film.cavitation.conditions import HalfSommerfeld, Sommerfeld
from frbcli.film.cells.tilted_film import settled_force, tilted_film, tilted_force
from frbcli.film.gap import Section

R, C, ETA, TOTAL = 0.01, 40e-6, 0.01, 900.0


def plain(width: float) -> Section:
    return Section(R, width, width, C, ETA, 1e5, 1e5, 1, "oil-bath", "oil-bath")


@pytest.mark.parametrize("along", [3, 4, 5, 8, 10])
def test_a_short_film_has_its_closed_forms_on_few_cells(along: int) -> None:
    """pi eta R L^3 / C^3 in translation and L^2 / 60 of it in tilt, but for the sine around, which the cells hold by
    values in their middles; what flows around falls with (L / R)^2."""
    length, around = 0.005 * R, 48
    film = tilted_film(plain(length), Sommerfeld(), (around, along), 500.0)
    by_rate = -tilted_force(film, np.zeros(4), np.zeros(4), TOTAL).by_velocity
    damping = math.pi * ETA * R * length**3 / C**3 * math.sin(math.pi / around) / (math.pi / around)
    assert np.diag(by_rate)[:2] == pytest.approx(damping, rel=1e-5)
    assert np.diag(by_rate)[2:] == pytest.approx(damping * length**2 / 60.0, rel=1e-5)


def test_ten_cells_are_as_exact_as_six_of_a_half_without_tilt() -> None:
    """The error of forces, and of moments over half the width, of eight journals that move and tilt, over the force:
    its median is about that of a journal without tilt on six cells of each half that comes as near
    to its shell (0.9e-3 in the mean, 1.3e-3 at the most), and so is that of eight beside five (1.0e-3, 1.4e-3)."""
    random, width = np.random.default_rng(5), R
    section = plain(width)
    films = {along: tilted_film(section, HalfSommerfeld(), (64, along), 500.0) for along in (8, 10, 32)}
    off: dict[int, list[float]] = {8: [], 10: []}
    for _ in range(8):
        eccentricity, angle, way = random.uniform(0.2, 0.75), *random.uniform(0.0, 2.0 * math.pi, 2)
        tilt = 2.0 * C / width * random.uniform(0.0, 0.5 * (0.93 - eccentricity))
        place = np.array([C * eccentricity * math.cos(angle), C * eccentricity * math.sin(angle),
                          -tilt * math.sin(way), tilt * math.cos(way)])  # fmt: skip
        rate = TOTAL * np.array([C, C, 2.0 * C / width, 2.0 * C / width]) * random.uniform(-0.4, 0.4, 4)
        loads = {along: settled_force(film, place, rate, TOTAL) for along, film in films.items()}
        size = float(np.hypot(*loads[32][:2])) * np.array([1.0, 1.0, 0.5 * width, 0.5 * width])
        for along, found in off.items():
            found.append(float(np.linalg.norm((loads[along] - loads[32]) / size)))
    assert np.median(off[10]) < 0.9e-3
    assert np.median(off[8]) < 1.4e-3
