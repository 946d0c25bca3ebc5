"""Machines at rest whose shells are not in line and whose journals keep their direction: sheets, stability, what is
refused."""

import math

import pytest

from frbcli import bearing_sheet, load_case, rotation, sommerfeld_chart
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.stability import stability_points

SPEED, CLEARANCE, WIDTH, MRAD = 50.0, 35e-6, 0.02, 0.5
SHELL = 'bearing.misalignment=["{} mrad", "{} mrad"]'
FINITE = "film.theory=finite"


def at_rest(*settings: str) -> FilmState:
    (point,) = bearing_sheet(load_case("jeffcott", [FINITE, *settings]), [SPEED]).points
    assert not point.problem
    return point


def test_a_shell_that_is_hardly_inclined_carries_like_one_in_line() -> None:
    """The films of both differ by their meshes alone, within what the sheet states."""
    inclined, flat = at_rest(SHELL.format(1e-9, 0.0)), at_rest()
    assert inclined.load == pytest.approx(flat.load, rel=1e-6)
    assert math.dist(inclined.displacement, flat.displacement) < inclined.place_error + flat.place_error
    assert inclined.stiffness is not None
    assert flat.stiffness is not None
    assert inclined.stiffness == pytest.approx(flat.stiffness, abs=inclined.error * abs(flat.stiffness).max())
    assert inclined.power == pytest.approx(flat.power, rel=2e-3)
    assert inclined.side_flow == pytest.approx(flat.side_flow, rel=1e-2)
    assert inclined.film_thickness_min == pytest.approx(flat.film_thickness_min, abs=inclined.film_thickness_error)


def test_a_shell_inclined_the_other_way_is_its_mirror_image() -> None:
    """The film between z and -z is the same one, so that the two middle planes see the same forces."""
    one, other = at_rest(SHELL.format(0.0, MRAD)), at_rest(SHELL.format(0.0, -MRAD))
    assert other.displacement == pytest.approx(one.displacement, rel=1e-8)
    assert other.stiffness == pytest.approx(one.stiffness, rel=1e-6)
    assert (other.power, other.p_max) == pytest.approx((one.power, one.p_max), rel=1e-8)


def test_the_sheet_says_what_a_rotation_at_the_same_place_says() -> None:
    """Rotations are solved on other cells by another room. Journal and shell overlap nowhere: the least gap is the
    clearance less the displacement at the end that is nearer."""
    rest = at_rest(SHELL.format(0.0, MRAD))
    e, angle = math.hypot(*rest.displacement), math.atan2(rest.displacement[1], rest.displacement[0])
    motion = f'motion={{eccentricity={e}, angle="{angle} rad", speed="{SPEED} Hz"}}'
    loads = rotation(load_case("jeffcott", [FINITE, SHELL.format(0.0, MRAD), motion])).results[0].loads
    assert loads is not None
    assert loads.force == pytest.approx(-rest.load, abs=1e-2 * math.hypot(*rest.load))
    assert loads.torque.journal == pytest.approx(rest.torque, rel=2e-3)
    assert loads.p_max - 1e5 == pytest.approx(rest.p_max - 1e5, rel=2e-2)
    x, y = rest.displacement
    growth = 0.5 * WIDTH * MRAD * 1e-3 / CLEARANCE
    least = CLEARANCE * (1.0 - max(math.hypot(x + side * growth, y) for side in (-1.0, 1.0)))
    assert rest.film_thickness_min == pytest.approx(least, rel=1e-4)
    flat = at_rest()
    assert rest.film_thickness_min < 0.9 * flat.film_thickness_min
    assert rest.stiffness[0, 0] > flat.stiffness[0, 0]  # type: ignore[index]


def test_stability_has_the_films_of_the_sheet() -> None:
    case = load_case("jeffcott", [FINITE, SHELL.format(MRAD, 0.0)])
    (film,) = stability_points(case, [SPEED])[1][0].films
    (rest,) = bearing_sheet(case, [SPEED]).points
    assert film.displacement == pytest.approx(rest.displacement, rel=1e-9)
    assert film.stiffness == pytest.approx(rest.stiffness, rel=1e-7)
    assert film.damping == pytest.approx(rest.damping, rel=1e-7)


def test_a_bearing_alone_has_a_chart_until_an_end_touches() -> None:
    case = load_case("bearing", [SHELL.format(1, 0), "film.cavitation=half-sommerfeld"])
    low, high = sommerfeld_chart(case, [0.3, 0.95], 20.0).points
    assert not low.problem
    assert abs(low.load[0]) < 1e-6 * abs(low.load[1])
    assert "touches its shell at an end" in high.problem
