"""The barotropic law of Bayada and Chupin: its formulas, its limits, and films that it is solved in."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import frbcli
from frbcli.case.reading.load import load_case
from frbcli.film.cavitation.barotropic import Barotropic
from frbcli.film.cavitation.law import FilmOil, Scales

DENSITY, C_L, C_V, CAVITY, SCALE = 850.0, 1400.0, 350.0, 0.8e5, 250.0
GIVEN = SimpleNamespace(liquid_sound_speed=C_L, vapour_sound_speed=C_V)
LAW = Barotropic.scaled(GIVEN, FilmOil(SCALE, 1e5, CAVITY, DENSITY))
SCALES = Scales(reference=700.0, cavitation=(CAVITY - 1e5) / SCALE, ambient=1e5 / SCALE)
VAPOUR_DENSITY = LAW.emptied * DENSITY
W = np.concatenate([np.linspace(-1.6, 0.5, 2001), -np.logspace(-13, -1, 100)])


def state() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(rho, p absolute in Pa, dp/drho) of cells."""
    cells = LAW.cells(W, SCALES)
    return (
        DENSITY * cells.fraction,
        1e5 + SCALE * cells.pressure,
        SCALE * cells.pressure_slope / (DENSITY * cells.fraction_slope),
    )


def test_pressures_are_the_integral_of_wood_from_the_vapour_on() -> None:
    """From rho_v c_v^2 at rho_v; the law itself counts from p_cav at rho_l."""
    density, pressure, _ = state()
    light, heavy = VAPOUR_DENSITY * C_V**2, DENSITY * C_L**2
    factor = light * heavy * (VAPOUR_DENSITY - DENSITY) / (VAPOUR_DENSITY * light - DENSITY * heavy)
    void = (DENSITY - density) / (DENSITY - VAPOUR_DENSITY)
    mixed = (density > VAPOUR_DENSITY) & (density < DENSITY)
    rho, alpha = density[mixed], void[mixed]
    expected = light + factor * np.log(heavy * rho / (VAPOUR_DENSITY * (light * (1.0 - alpha) + heavy * alpha)))
    assert np.count_nonzero(mixed) > 1000
    assert pressure[mixed] == pytest.approx(expected, rel=1e-7)  # void fractions of 1e-13 are differences of densities
    liquid = density > DENSITY
    assert pressure[liquid] == pytest.approx(CAVITY + C_L**2 * (density[liquid] - DENSITY), rel=1e-9)
    vapour = density < VAPOUR_DENSITY
    assert np.count_nonzero(vapour) > 10
    assert pressure[vapour] == pytest.approx(C_V**2 * density[vapour], rel=1e-6, abs=1e-2)


def test_speed_of_sound_is_woods() -> None:
    density, _, square = state()
    mixed = (density > VAPOUR_DENSITY) & (density < DENSITY)
    rho = density[mixed]
    void = (DENSITY - rho) / (DENSITY - VAPOUR_DENSITY)
    wood = void / (VAPOUR_DENSITY * C_V**2) + (1.0 - void) / (DENSITY * C_L**2)
    assert square[mixed] == pytest.approx(1.0 / (rho * wood), rel=1e-6)
    assert square[density > DENSITY] == pytest.approx(C_L**2, rel=1e-9)
    assert square[density < VAPOUR_DENSITY] == pytest.approx(C_V**2, rel=1e-9)


def test_curve_is_that_of_the_films() -> None:
    over_cavity = Barotropic.scaled(GIVEN, FilmOil(CAVITY, 1e5, CAVITY, DENSITY))
    density, pressure, _ = state()
    assert over_cavity.curve(pressure / CAVITY) == pytest.approx(density / DENSITY, abs=1e-9)


def test_it_is_elrods_where_the_cavity_has_hardly_any_pressure() -> None:
    """At a p_cav of 0.01 bar the mixture has no room to fall below it."""
    settings = ("motion={ eccentricity = 0.85, speed = '60 Hz' }", "oil.cavitation_pressure=0.01 bar")
    case = load_case("bearing-axial-groove", (*settings, "accuracy.mesh=[8, 64]"))
    own, elrod = (result.loads for result in frbcli.rotation(case, ("barotropic", "elrod")).results)
    assert own is not None
    assert elrod is not None
    assert elrod.oil_fraction < 0.97  # it does cavitate
    assert own.force == pytest.approx(elrod.force, abs=5e-3 * float(np.hypot(*elrod.force)))
    assert own.oil_fraction == pytest.approx(elrod.oil_fraction, abs=5e-3)


def test_run_up_keeps_its_oil(tmp_path: Path) -> None:
    settings = ("speed.duration=2 ms", "speed.from=40 Hz", "speed.to=41 Hz", "accuracy.mesh=[3, 24]")
    case = load_case("axial-groove-two-phase", ("film.cavitation=barotropic", "accuracy.tolerance=1e-5", *settings))
    run = frbcli.runup(case, tmp_path / "run.h5")
    assert run.status == "finished"
    assert 0.5 < run["oil_fraction"][-1] < 1.0 + 1e-3
    assert abs(run.error["oil_balance_relative"]) < 1e-6  # what Newton leaves of a curved law is carried on
