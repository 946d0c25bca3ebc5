"""Flow factors of rough surfaces: their published values and limits, their kernels, and films that flow with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from differences import differences
from scipy.integrate import quad

from frbcli.film.cavitation.conditions import Elrod, Sommerfeld
from frbcli.film.cavitation.law import Law
from frbcli.film.cells.film import Motion, VolumeFilm, fitted_grid
from frbcli.film.cells.linearised import settled_force
from frbcli.film.cells.loads import FilmLoads, loads
from frbcli.film.cells.solver import FilmSolver
from frbcli.film.gap import Section
from frbcli.film.roughness.contact import flowing_cube, rough_flow, sheared_gap, stress_factor
from frbcli.film.roughness.flow_factors import CUT, LAST_STRESS, pressure_flow, shear_flow, shear_stress

SIGMA = 0.03  # over the clearance
GAPS = (0.5, 0.9, 1.0, 2.0, 2.99, 3.01, 4.9, 5.1, 8.9, 9.1, 30.0)
OMEGA = 200.0
BATH = Section(0.0125, 0.02, 0.02, 35e-6, 0.012, 1e5, 1e5, 1, "oil-bath", "oil-bath")


def film_of(section: Section, law: Law, d: tuple[float, float]) -> VolumeFilm:
    return VolumeFilm(section, fitted_grid(section, d, 64, 8), law, 500.0)


def solved(section: Section, law: Law, motion: Motion) -> FilmLoads:
    film = film_of(section, law, motion.d)
    return loads(film, motion, FilmSolver(film).steady(motion))


def rough(share: float = 0.0, sigma: float = SIGMA) -> Section:
    return replace(BATH, flow_roughness=sigma * BATH.clearance, shear=share)


def test_factors_have_the_published_values() -> None:
    """Patir and Cheng 1978, 1979; isotropic surfaces."""
    np.testing.assert_array_equal(np.round(pressure_flow(np.array([1.0, 3.0])), 3), [0.486, 0.832])
    np.testing.assert_allclose(shear_flow(np.array([6.0, 9.0])), 1.126 * np.exp([-1.5, -2.25]), rtol=3e-4)
    stress = shear_stress(np.array([LAST_STRESS - 1e-9])) - shear_stress(np.array([LAST_STRESS]))
    assert stress == pytest.approx(11.1 * 7.0**2.31 * np.exp(-2.38 * 7.0 + 0.11 * 49.0), rel=1e-6)


def test_factors_tend_to_the_second_order_of_shallow_roughness() -> None:
    """In sigma / h the flow between shallow roughness of no direction falls by 3/2 of its square, the stress rises by
    5/2 of it, half from the flow to and fro, and a rough surface carries 3/2 of it more: means of the exact solutions
    for ridges along and across."""
    x = np.array([5.0])
    assert x**2 * (1.0 - pressure_flow(x)) == pytest.approx(1.5, rel=0.1)
    assert x * shear_flow(x) == pytest.approx(1.5, rel=0.1)
    assert x**2 * (shear_stress(x) - 1.0) == pytest.approx(2.5, rel=0.1)


@pytest.mark.parametrize("x", [0.5, 1.0, 2.5, 3.5, 8.9, 9.1, 40.0])
def test_stress_is_that_of_the_local_gaps_and_of_what_they_press(x: float) -> None:
    z = x / 3.0
    local, _ = quad(lambda s: (1.0 - s**2) ** 3 / (z + s), max(-1.0, CUT - z), 1.0, epsrel=1e-12, limit=200)
    pressed = 11.1 * x**2.31 * np.exp(-2.38 * x + 0.11 * x**2) if x < LAST_STRESS else 0.0
    assert shear_stress(np.array(x)) == pytest.approx(35.0 / 32.0 * z * local + pressed, rel=1e-9)


@pytest.mark.parametrize("x", GAPS)
def test_kernels_are_the_equations_and_their_derivatives(x: float) -> None:
    h = SIGMA * x
    (factor, by_h), (cube, cube_by_h) = rough_flow(h, SIGMA), flowing_cube(h, SIGMA)
    carried, carried_by_h = sheared_gap(h, SIGMA, 3.0)
    assert factor == pytest.approx(pressure_flow(np.array(x)), rel=1e-13)
    assert cube == pytest.approx(factor * h**3, rel=1e-13)
    assert carried == pytest.approx(3.0 * SIGMA * shear_flow(np.array(x)), rel=1e-12)
    assert stress_factor(h, SIGMA) == pytest.approx(shear_stress(np.array(x)), rel=1e-10)
    complex_h = h + 1e-30j
    exact = (complex_h**3 * (1.0 - 0.90 * np.exp(-0.56 * complex_h / SIGMA))).imag / 1e-30
    assert cube_by_h == pytest.approx(exact, rel=1e-12)
    found = differences(lambda y: (rough_flow(y[0], SIGMA)[0], sheared_gap(y[0], SIGMA, 3.0)[0]), [h], 1e-7 * SIGMA)
    assert (by_h, carried_by_h) == pytest.approx(found[:, 0], rel=1e-6, abs=1e-7)
    assert flowing_cube(h, 0.0) == pytest.approx((h**3, 3.0 * h**2), rel=1e-14)
    assert stress_factor(h, 0.0) == 1.0


def test_an_even_gap_has_the_same_factors_everywhere() -> None:
    """The force of a squeezed film rises with 1 / phi_x, and Petroff's torque with phi_f + Phi_fs."""
    x = np.array(1.0 / SIGMA) / 8.0
    section = rough(sigma=8.0 * SIGMA)
    squeeze = Motion((0.0, 0.0), (30.0, -10.0), OMEGA)
    found, smooth = (solved(each, Sommerfeld(), squeeze) for each in (section, BATH))
    np.testing.assert_allclose(found.force, np.array(smooth.force) / pressure_flow(x), rtol=1e-10)
    assert found.torque.couette == pytest.approx(smooth.torque.couette * float(shear_stress(x)), rel=1e-10)


@pytest.mark.parametrize("share", [-1.0, 0.4, 1.0])
def test_a_rough_journal_carries_more_oil_and_a_rough_shell_less(share: float) -> None:
    """Near the centre the film is driven by how much more is carried where the gap is wider."""
    sigma, d = 8.0 * SIGMA, 1e-6
    motion = Motion((0.0, -d), (0.0, 0.0), OMEGA)
    found, smooth = (np.array(solved(each, Sommerfeld(), motion).force) for each in (rough(share, sigma), BATH))
    x = 1.0 / sigma
    by_gap = float(shear_flow(np.array(x))) * (0.98 / x - 0.92 + 0.10 * x)
    np.testing.assert_allclose(
        found, smooth * (1.0 + share * by_gap) / float(pressure_flow(np.array(x))), atol=1e-5 * abs(smooth).max()
    )


def test_forces_have_their_derivatives() -> None:
    section, motion = rough(0.5, 0.1), Motion((0.3, -0.6), (4.0, 2.0), OMEGA)
    film = film_of(section, Sommerfeld(), motion.d)
    solver = FilmSolver(film)
    found = settled_force(solver, motion, solver.steady(motion))

    def force(d: np.ndarray) -> tuple[float, float]:
        moved = replace(motion, d=tuple(d))
        return loads(film, moved, FilmSolver(film).steady(moved)).force

    slopes = differences(force, motion.d, 1e-6) / section.clearance
    np.testing.assert_allclose(found.by_displacement, slopes, atol=1e-7 * abs(found.by_displacement).max())


def test_oil_is_conserved() -> None:
    found = solved(rough(0.5, 0.1), Elrod(2e4), Motion((0.3, -0.6), (0.0, 0.0), OMEGA))
    assert abs(found.oil.defect_relative) < 1e-11
