"""Stated errors of static results beside true ones: on half the cells, against the cells of all static results."""

from typing import Any

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.equilibrium import static_films, static_machine
from frbcli.equilibrium.resting import SEARCH
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.response import response
from frbcli.linear.sheets.bearing import bearing_sheet, sommerfeld_chart
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.stability import stability, stability_points
from frbcli.linear.stability_point import threshold_at

SPEEDS = [40.0, 90.0]
CASE = load_case("rigid-axial-groove", ["rotor.unbalance=3 g*mm"])


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Static results on half of their cells, with errors from a quarter and a third of them."""
    monkeypatch.setattr(static_films, "CELLS", (72, 10))
    monkeypatch.setattr(static_films, "COARSER", ((36, 5), (48, 7)))


@pytest.fixture(scope="module")
def exact() -> dict[str, Any]:
    return {
        "points": stability_points(CASE, SPEEDS)[1],
        "response": response(CASE, SPEEDS),
        "sheet": bearing_sheet(CASE, SPEEDS),
        "chart": sommerfeld_chart(CASE, [0.6], 90.0),
        "modes": damped_modes(CASE, 90.0),
    }


@pytest.mark.usefixtures("coarse")
def test_places_and_eigenvalues(exact: dict[str, Any]) -> None:
    for own, fine in zip(stability_points(CASE, SPEEDS)[1], exact["points"], strict=True):
        off = np.hypot(*(own.films[0].displacement - fine.films[0].displacement))
        assert off <= own.films[0].place_error < 0.05
        for value, error in own.modes_with_errors:
            apart = fine.eigenvalues[np.argmin(np.abs(fine.eigenvalues - value))] - value
            assert abs(apart) <= error < 0.1 * abs(value)


@pytest.mark.usefixtures("coarse")
def test_amplitudes(exact: dict[str, Any]) -> None:
    own, fine = response(CASE, SPEEDS), exact["response"]
    assert np.all(np.abs(own.amplitude - fine.amplitude) <= own.amplitude_error)
    assert np.all(own.amplitude_error < 0.1 * own.amplitude)


def holds(own: FilmState, fine: FilmState) -> None:
    """Smallest film thickness, largest pressure, power and flow of a sheet are off by no more than is stated."""
    for name, error, most in (
        ("film_thickness_min", own.film_thickness_error, 0.02),
        ("p_max", own.p_max_error, 0.02),
        ("power", own.power_error, 1e-2),
        ("side_flow", own.side_flow_error, 0.02),
    ):
        exact = getattr(fine, name)
        assert abs(getattr(own, name) - exact) <= error < most * exact


@pytest.mark.usefixtures("coarse")
def test_sheets(exact: dict[str, Any]) -> None:
    for own, fine in zip(bearing_sheet(CASE, SPEEDS).points, exact["sheet"].points, strict=True):
        assert np.hypot(*(own.displacement - fine.displacement)) <= own.place_error < 0.05
        holds(own, fine)
    own, fine = sommerfeld_chart(CASE, [0.6], 90.0).points[0], exact["chart"].points[0]
    assert np.hypot(*(own.displacement - fine.displacement)) <= own.place_error < 0.05
    holds(own, fine)


@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize(
    ("case", "settings"), [("jeffcott", "film.theory=finite"), ("rigid", "film.cavitation=reynolds")]
)
def test_pressures_losses_and_flows_of_other_films(monkeypatch: pytest.MonkeyPatch, case: str, settings: str) -> None:
    """A film on tables, whose fields are on cells all the same, and one on cells."""
    own = bearing_sheet(load_case(case, [settings]), SPEEDS).points
    monkeypatch.undo()
    for coarse, fine in zip(own, bearing_sheet(load_case(case, [settings]), SPEEDS).points, strict=True):
        holds(coarse, fine)


@pytest.mark.usefixtures("coarse")
def test_damped_modes(exact: dict[str, Any]) -> None:
    for own, fine in zip(damped_modes(CASE, 90.0).modes, exact["modes"].modes, strict=True):
        assert abs(own.eigenvalue - fine.eigenvalue) <= own.error


def test_a_peak_is_as_uncertain_as_the_films() -> None:
    """Tables of the half-Sommerfeld film are good to 3e-5 and less; the error of a peak is as small, and known."""
    found = response(load_case("jeffcott", ["film.theory=finite"]))
    assert found.critical_speeds
    for peak in found.critical_speeds:
        assert 3e-5 * peak.speed_Hz <= peak.speed_uncertainty_Hz < 1e-2 * peak.speed_Hz


def test_a_hopf_point_of_other_films_is_as_uncertain_as_it_is_off() -> None:
    """On the same films its error is that of the threshold. A threshold 1 % higher on other films is 1 % more off."""
    case = load_case("jeffcott", ["film.theory=short"])
    threshold = stability(case, [150.0, 200.0], threshold=True).threshold
    assert threshold is not None
    speed, frequency, machines = threshold.speed_Hz, threshold.frequency_Hz, StaticMachines(case)
    same, higher = (threshold_at(machines, factor * speed, frequency) for factor in (1.0, 1.01))
    assert same.speed_uncertainty_Hz == pytest.approx(threshold.speed_uncertainty_Hz, rel=1e-5)
    assert same.frequency_uncertainty_Hz == pytest.approx(threshold.frequency_uncertainty_Hz, rel=1e-5)
    more = higher.speed_uncertainty_Hz - same.speed_uncertainty_Hz
    assert more == pytest.approx(0.01 * speed, rel=0.1)


@pytest.mark.parametrize("name", ["NEARLY"])
def test_errors_do_not_depend_on_where_the_search_on_other_meshes_ends(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """They are those of journals at rest there to round-off, and so short a search is enough for them: the law of a
    penalty film follows the place of its journal, which slopes lack."""
    settings = {"NEARLY": [], "NEARLY_ON_CELLS": ["film.cavitation=penalty", "bearing.supply.pressure=2 bar"]}[name]
    case, speeds = load_case("axial-groove" if not settings else "jeffcott", settings), [3.0, 10.0, 30.0]
    near = stability_points(case, speeds)[1]
    monkeypatch.setattr(static_machine, name, SEARCH)
    monkeypatch.setattr(static_machine, "NEARLY_CARRIED", 0.0)
    for own, settled in zip(near, stability_points(case, speeds)[1], strict=True):
        mine, exact = own.films[0], settled.films[0]
        assert (mine.error, mine.place_error) == pytest.approx((exact.error, exact.place_error), rel=0.01)
        assert own.errors == pytest.approx(settled.errors, rel=0.01)


def test_without_films_no_error_is_stated() -> None:
    """The coefficients are given, and nothing is known of their errors."""
    found = response(load_case("seal"), [30.0])
    assert np.isnan(found.amplitude_error).all()
    assert np.isnan(stability(load_case("seal"), [30.0]).points[0].critical_error)
