"""Ends that lie in a bath up to a level: between free to air and an oil bath, and mirror images."""

import math

import numpy as np
import pytest

from frbcli import load_case
from frbcli.case.schema import Case
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.mesh.bores import bathed
from frbcli.film.cells.solver import FilmSolver
from frbcli.scene.films import film_places, turns_with_oil, volume_film

MOTION = Motion((0.3, -0.5), (0.0, 0.0), 300.0)
SUPPLY = 'bearing.supply={ kind = "axial-grooves", opening_angle = "20 deg", pressure = "1.5 bar" }'
RADIUS = 12.5e-3  # m


def case_of(ends: str, law: str = "peeken", *settings: str) -> Case:
    return load_case("rigid", [f"film.cavitation={law}", SUPPLY, f"bearing.ends={ends}", *settings])


def film_of(case: Case) -> VolumeFilm:
    return volume_film(case, film_places(case)[0], (48, 8))


def found(ends: str, law: str = "peeken", motion: Motion = MOTION) -> FilmLoads:
    film = film_of(case_of(ends, law))
    return loads(film, motion, FilmSolver(film).steady(motion))


def at_level(share: float) -> str:
    return f'{{ bath_level = "{1e3 * share * RADIUS!r} mm" }}'


@pytest.mark.parametrize("law", ["peeken", "two-phase"])
def test_a_full_bath_is_an_oil_bath_and_an_empty_one_is_air(law: str) -> None:
    """Bit for bit."""
    assert found(at_level(1.0), law) == found('"oil-bath"', law)
    assert found(at_level(-1.0), law) == found('"free-to-air"', law)
    assert found('"oil-bath"', law).force != found('"free-to-air"', law).force


def test_the_ends_of_cells_lie_in_the_bath_below_its_level() -> None:
    """On its chord the angle to the bottom is acos(-level); a cell on the level lies in it in part."""
    film = film_of(case_of(at_level(0.3)))
    share, size = bathed(film.section, film.grid.phi), np.diff(film.grid.phi)
    assert share @ size == pytest.approx(2.0 * math.acos(-0.3), rel=1e-12)
    below = np.cos(film.grid.centre) < 0.3
    assert np.all(np.abs(share - below) <= 0.5 + 1e-12)
    assert np.count_nonzero((share > 0.0) & (share < 1.0)) == 2


def test_more_of_the_film_fills_from_a_higher_bath() -> None:
    """Oil that is drawn in grows with the level, between no bath and a whole one."""
    levels = ['"free-to-air"', *(at_level(share) for share in (-0.9, -0.5, 0.0, 0.5, 0.9)), '"oil-bath"']
    came = [each.oil.in_m3_s for each in map(found, levels)]
    assert came == sorted(came)
    assert came[0] < came[3] < came[-1]
    assert all(abs(found(level).oil.defect_relative) < 1e-12 for level in levels[:3])


def test_a_mirrored_motion_has_the_mirrored_force() -> None:
    """About the vertical through the middle: the level is even, the groove lies at the top."""
    mirrored = Motion((-MOTION.d[0], MOTION.d[1]), (0.0, 0.0), -MOTION.omega)
    (x, y), (x_m, y_m) = (found(at_level(-0.4), "peeken", motion).force for motion in (MOTION, mirrored))
    assert (x_m, y_m) == pytest.approx((-x, y), rel=1e-9)


def test_cells_of_a_plain_gap_stay_where_the_bath_is() -> None:
    plain = 'bearing.supply={kind="circumferential-groove", pressure="2 bar"}'
    for ends, turns in ((at_level(0.0), False), ('"oil-bath"', True)):
        case = case_of(ends, "peeken", plain)
        assert turns_with_oil(case, film_places(case)[0]) is turns
