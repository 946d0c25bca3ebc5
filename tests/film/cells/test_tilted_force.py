"""Force and moments of films whose journal tilts, with their derivatives: differences, closed forms, cuts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from differences import differences

from frbcli.errors import NotConverged
from frbcli.film.cavitation.conditions import HalfSommerfeld, Reynolds, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cavitation.two_phase import TwoPhase
from frbcli.film.cells.linearised import steady_force
from frbcli.film.cells.tilted_film import TiltedFilm, tilted_film, tilted_force
from frbcli.film.gap import Section

R, B, C, ETA, TOTAL = 0.01, 0.012, 40e-6, 0.01, 900.0
PLAIN = Section(R, B, B, C, ETA, 1e5, 1e5, 1, "oil-bath", "oil-bath")
GROOVED = Section(R, 0.5 * B, B, C, ETA, 1e5, 1e5, 2, "oil-bath", "groove", 1e5)
FREE = Section(R, B, B, C, ETA, 1e5, 0.8e5, 1, "free-to-air", "oil-bath")
SIZE = np.array([C, C, C / B, C / B])
PLACE, RATE = SIZE * [0.3, -0.4, 0.4, 0.5], SIZE * [5.0, -25.0, 9.0, -15.0]
LAWS = {"sommerfeld": Sommerfeld(), "half-sommerfeld": HalfSommerfeld(), "reynolds": Reynolds()}


def film_of(section: Section, law: Law, cells: tuple[int, int] = (32, 12)) -> TiltedFilm:
    return tilted_film(section, law, cells, 500.0)


@pytest.mark.parametrize("section", [PLAIN, GROOVED, FREE], ids=["plain", "grooved", "free"])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_derivatives_are_those_of_differences(section: Section, law: Law) -> None:
    film = film_of(section, law)
    found = tilted_force(film, PLACE, RATE, TOTAL)
    scale = np.outer(SIZE, SIZE)
    step = 4e-6 * SIZE
    by_place = differences(lambda d: tilted_force(film, d, RATE, TOTAL, found.field).force, PLACE, step)
    by_rate = differences(lambda v: tilted_force(film, PLACE, v, TOTAL, found.field).force, RATE, TOTAL * step)
    for exact, difference in ((found.by_displacement, by_place), (found.by_velocity, by_rate)):
        assert np.abs(scale * (exact - difference)).max() < 1e-7 * np.abs(scale * difference).max()


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_without_tilt_it_is_the_film_without_tilt(law: Law) -> None:
    """Force and derivatives of the compiled film on the same cells, and no moment."""
    film = film_of(PLAIN, law)
    place, rate = PLACE * [1, 1, 0, 0], RATE * [1, 1, 0, 0]
    found, flat = (
        tilted_force(film, place, rate, TOTAL),
        steady_force(film.lands[0].film, place[:2], rate[:2], TOTAL),
    )
    size = float(np.hypot(*flat.force))
    assert found.force[:2] == pytest.approx(flat.force, abs=1e-9 * size)
    assert np.hypot(*found.force[2:]) < 1e-9 * B * size
    for own, other in ((found.by_displacement, flat.by_displacement), (found.by_velocity, flat.by_velocity)):
        largest = np.abs(other).max()
        assert own[:2, :2] == pytest.approx(other, abs=1e-9 * largest)
        assert np.abs(own[:2, 2:]).max() < 1e-9 * B * largest
        assert np.abs(own[2:, :2]).max() < 1e-9 * B * largest


def test_oil_is_foreseen_at_other_places_and_speeds() -> None:
    """To first order, of both lands beside a groove."""
    section = replace(GROOVED, far_pressure=2e5)
    film, moved, still = film_of(section, TwoPhase(0.9)), 1e-4 * SIZE * [1.0, -0.5, 0.6, 0.8], np.zeros(4)
    here, there = tilted_force(film, PLACE, still, TOTAL), tilted_force(film, PLACE + moved, still, 1.0001 * TOTAL)
    assert here.slopes is not None
    assert here.field is not None
    assert there.field is not None
    foreseen = here.foreseen(PLACE + moved, 1.0001 * TOTAL).field
    assert foreseen is not None
    for number in range(2):
        change = np.abs(there.field[number] - here.field[number]).sum()
        assert np.abs(foreseen[number] - there.field[number]).sum() < 1e-2 * change
    change = here.by_displacement @ moved + here.slopes.force * 1e-4 * TOTAL
    assert change == pytest.approx(there.force - here.force, rel=1e-2)
    assert tilted_force(film_of(section, Reynolds()), PLACE, still, TOTAL).slopes is None


def test_damping_of_a_short_centred_film() -> None:
    """pi eta R L^3 / C^3 in translation, L^2 / 60 of that in tilt, and half of the speed times it across."""
    length = 0.05 * R
    short = Section(R, length, length, C, ETA, 1e5, 1e5, 1, "oil-bath", "oil-bath")
    found = tilted_force(film_of(short, Sommerfeld(), (48, 40)), np.zeros(4), np.zeros(4), TOTAL)
    damping = math.pi * ETA * R * length**3 / C**3
    in_tilt = damping * length**2 / 60.0
    across = 0.5 * TOTAL * np.array([[0.0, 1.0], [-1.0, 0.0]])  # the oil turns with half of the speed
    for block, size in ((slice(0, 2), damping), (slice(2, 4), in_tilt)):
        rate, place = (each[block, block] / size for each in (found.by_velocity, found.by_displacement))
        assert rate == pytest.approx(-np.eye(2), abs=4e-3)
        assert place == pytest.approx(-across, abs=5e-3 * TOTAL)


def test_cuts_that_do_not_tilt_do_the_same_work_in_second_order() -> None:
    """A bearing of n equal lands apart from each other: each follows the tilt of the shaft, or has the gap of its
    middle all along. The power of a rigid shaft that moves and tilts differs by a share that falls with the square of
    the number of cuts."""
    apart = []
    for cuts in (4, 8, 16):
        width = B / cuts
        land = Section(R, width, width, C, ETA, 1e5, 1e5, 1, "oil-bath", "oil-bath")
        film = film_of(land, HalfSommerfeld(), (32, 8))
        power = np.zeros(2)
        for z in width * (np.arange(cuts) + 0.5) - 0.5 * B:
            across = np.array([[1.0, 0.0, 0.0, z], [0.0, 1.0, -z, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
            place, rate = across @ PLACE, across @ RATE
            flat = np.array([1.0, 1.0, 0.0, 0.0])
            power += [
                tilted_force(film, place, rate, TOTAL).force @ rate,
                tilted_force(film, flat * place, flat * rate, TOTAL).force @ (flat * rate),
            ]
        apart.append(abs(power[1] / power[0] - 1.0))
    orders = np.log2(np.array(apart[:-1]) / apart[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.2)


def test_a_journal_that_touches_has_no_film() -> None:
    with pytest.raises(NotConverged, match="touches its shell at an end"):
        tilted_force(film_of(PLAIN, Sommerfeld()), SIZE * [0.6, 0.0, 0.0, 0.9], np.zeros(4), TOTAL)
