"""Ball bearings: an independent program, closed forms of Stribeck and Harris, and the plain form of the equations."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from ball_bearings import NITRIDE, STEEL, A, B, solve_plain
from paths import DATA

from frbcli.elements.ball import BallBearing, Balls, at_displacement
from frbcli.elements.ball_force import ball_bearing_force, ball_friction
from frbcli.linear.sheets.ball import rating_life, under_load

BEARINGS = {"A": A, "B": B}
# independent program: Hertz contacts by elliptic integrals, centrifugal force of the balls, no friction, no gyroscopic
# moment; one ball in the line of the load
ROWS = list(csv.DictReader((DATA / "ball-bearing.csv").read_text(encoding="utf-8").splitlines()))
DIGITS = 1e-6  # of the table
RADIAL = BallBearing(60, 10e-3, 50e-3, 0.0, 0.52, 0.53, STEEL, STEEL)  # no clearance, held in the middle


@pytest.mark.parametrize("row", ROWS, ids=lambda row: " ".join(list(row.values())[:4]))
def test_rest_and_stiffness_are_those_of_an_independent_program(row: dict[str, str]) -> None:
    values = {name: float(text) for name, text in row.items() if name != "bearing"}
    bearing = replace(BEARINGS[row["bearing"]], preload=values["preload_N"])
    found = under_load(bearing, np.array([0.0, -values["load_N"]]), 2.0 * math.pi * values["speed_Hz"])
    x, y, z = found.displacement
    assert x == pytest.approx(0.0, abs=1e-12)
    assert (y, z) == pytest.approx((values["y_m"], values["z_m"]), rel=DIGITS)
    expected = [values[f"k_{axes}_N_m"] for axes in ("xx", "yy", "zz")]
    assert (*np.diag(found.stiffness), found.axial_stiffness) == pytest.approx(expected, rel=DIGITS)
    assert found.force == pytest.approx([0.0, values["load_N"], -values["preload_N"]], abs=1e-6)


def random_points() -> list[tuple[BallBearing, np.ndarray, float, float]]:
    """Loaded and unloaded balls, at rest and at any speed, under a constant force and held."""
    random = np.random.default_rng(4)
    points = []
    for number in range(24):
        preload = None if number % 4 == 3 else 10.0 ** random.uniform(0.5, 2.3)
        bearing = replace((A, B)[number % 2], preload=preload, offset=5e-6, turning=number % 3 > 0)
        place = random.normal(size=2) * 10.0 ** random.uniform(-7.0, -4.6)
        points.append((bearing, place, (0.0, 1.0, 500.0, 2000.0, 6000.0, 15e3)[number % 6], random.uniform(0.0, 7.0)))
    return points


def kernel(bearing: BallBearing, place: np.ndarray, omega: float, cage: float) -> np.ndarray:
    return np.array(ball_bearing_force(bearing.numbers, *place.tolist(), omega, cage, bearing.memory))


@pytest.mark.parametrize("point", random_points())
def test_kernel_is_the_plain_form(point: tuple[BallBearing, np.ndarray, float, float]) -> None:
    bearing, place, omega, cage = point
    found, plain = kernel(bearing, place, omega, cage), solve_plain(bearing.numbers, place, omega, cage)
    assert found[:2] == pytest.approx(plain.force, rel=1e-9, abs=1e-9 * np.abs(plain.force).max())
    assert found[2:] == pytest.approx(plain.stiffness.ravel(), abs=1e-6 * np.abs(plain.stiffness).max())


@pytest.mark.parametrize("point", random_points()[::2])
def test_stiffness_is_the_derivative(point: tuple[BallBearing, np.ndarray, float, float]) -> None:
    bearing, place, omega, cage = point
    step = 1e-10
    stiffness = kernel(bearing, place, omega, cage)[2:].reshape(2, 2)
    for axis in range(2):
        off = step * np.eye(2)[axis]
        forces = [kernel(bearing, place + way * off, omega, cage)[:2] for way in (1.0, -1.0)]
        difference = (forces[1] - forces[0]) / (2.0 * step)
        assert stiffness[:, axis] == pytest.approx(difference, abs=1e-5 * max(np.abs(stiffness).max(), 1e4))


def test_what_the_last_call_left_does_not_change_the_answer() -> None:
    """Jumps as a run never has them: from any state to any other, also beyond the grooves."""
    random, kept = np.random.default_rng(1), A.memory
    for _ in range(300):
        place = random.normal(size=2) * 10.0 ** random.uniform(-8.0, -3.9)
        omega, cage = 10.0 ** random.uniform(-1.0, 4.4), random.uniform(0.0, 7.0)
        found = np.array(ball_bearing_force(A.numbers, *place.tolist(), omega, cage, kept))
        assert found == pytest.approx(kernel(A, place, omega, cage), rel=1e-5, abs=1e-6 * np.abs(found).max())


def test_radial_load_is_carried_as_stribeck_says() -> None:
    """W = Z K delta_max^1.5 J with J = 0.2288, and a largest load of 4.37 W / Z (Harris, chapter 7)."""
    load = 1000.0
    found = under_load(RADIAL, np.array([0.0, -load]), 0.0)
    inner, outer = (each.stiffness for each in RADIAL.contacts)
    both = (inner ** (-2.0 / 3.0) + outer ** (-2.0 / 3.0)) ** -1.5
    assert load == pytest.approx(RADIAL.balls * both * (-found.displacement[1]) ** 1.5 * 0.2288, rel=2e-4)
    assert found.balls.inner_load.max() == pytest.approx(4.37 * load / RADIAL.balls, rel=2e-4)


@pytest.mark.parametrize("bearing", [A, B])
def test_axial_load_is_carried_in_closed_form(bearing: BallBearing) -> None:
    """Fa = Z K (A (cos alpha_0 / cos alpha - 1))^1.5 sin alpha, without centrifugal force (Harris, chapter 7)."""
    found = at_displacement(bearing, np.zeros(2), 0.0)
    angle = found.balls.inner_angle[0]
    inner, outer = (each.stiffness for each in bearing.contacts)
    both = (inner ** (-2.0 / 3.0) + outer ** (-2.0 / 3.0)) ** -1.5
    approach = bearing.grooves * (math.cos(bearing.contact_angle) / math.cos(angle) - 1.0)
    assert bearing.preload == pytest.approx(bearing.balls * both * approach**1.5 * math.sin(angle), rel=1e-9)
    assert found.balls.outer_angle == pytest.approx(np.full(bearing.balls, angle), rel=1e-9)


def test_balls_without_contact_rest_on_the_outer_ring() -> None:
    omega = 2.0 * math.pi * 800.0
    found = under_load(replace(B, preload=3.0), np.array([0.0, -150.0]), omega)
    alone = found.balls.inner_load == 0.0
    assert 0 < np.count_nonzero(alone) < B.balls
    assert found.balls.outer_load[alone] == pytest.approx(B.centrifugal * omega**2, rel=1e-6)
    assert found.balls.outer_angle[alone] == pytest.approx(0.0, abs=1e-12)


def test_forces_on_each_ball_are_in_balance() -> None:
    omega = 2.0 * math.pi * 2500.0
    balls = at_displacement(A, np.array([1e-6, -2e-6]), omega, 0.4).balls
    axial = balls.inner_load * np.sin(balls.inner_angle) - balls.outer_load * np.sin(balls.outer_angle)
    radial = balls.inner_load * np.cos(balls.inner_angle) - balls.outer_load * np.cos(balls.outer_angle)
    assert axial == pytest.approx(0.0, abs=1e-6)
    assert radial == pytest.approx(-A.centrifugal * omega**2, rel=1e-6)


@pytest.mark.parametrize("omega", [0.0, 1e-3])
def test_balls_that_the_inner_ring_has_left_bear_no_load_of_it(omega: float) -> None:
    """A bearing from outside, 14 balls of 5.556 mm at 25 deg, preload 50 N and load 100 N: an independent program has
    five balls under load and 39.60971 N on the largest."""
    bearing = BallBearing(14, 5.556e-3, 37e-3, math.radians(25.0), 0.52, 0.52, NITRIDE, STEEL, preload=50.0)
    found = under_load(bearing, np.array([0.0, -100.0]), omega)
    assert found.displacement[1:] == pytest.approx([-4.38712e-6, -3.28395e-6], rel=1e-4)
    assert found.balls.inner_load.max() == pytest.approx(39.60971, rel=1e-4)
    assert np.count_nonzero(found.balls.inner_load > 1e-6) == 5
    assert np.count_nonzero(found.balls.outer_load > 1e-6) == 5
    friction = replace(bearing, f_1=0.001).numbers
    memory = bearing.memory
    ball_bearing_force(friction, *found.displacement[:2].tolist(), omega, 0.0, memory)
    torque = ball_friction(friction, omega, memory)[0]
    assert torque == pytest.approx(-0.001 * 37e-3 * found.balls.inner_load.sum(), rel=1e-9)


def test_rings_within_their_clearance_carry_nothing() -> None:
    """cos(alpha_0) = 1 - G / (2 A): along a radius the ring meets a ball after half of the clearance."""
    clearance = 12e-6
    free = math.acos(1.0 - 0.5 * clearance / RADIAL.grooves)
    middle = -RADIAL.grooves * math.sin(free)
    bearing = replace(RADIAL, balls=8, contact_angle=free, offset=middle)
    below, beyond = (at_displacement(bearing, np.array([0.0, -y]), 0.0) for y in (5.99e-6, 6.02e-6))
    assert not below.force.any()
    assert beyond.force[1] > 0.0
    assert under_load(bearing, np.array([0.0, -1e-3]), 0.0).displacement[1] == pytest.approx(-6e-6, rel=0.02)


def test_two_rows_carry_twice_as_much() -> None:
    one, two = (at_displacement(replace(A, rows=rows), np.array([1e-6, -1e-6]), 3000.0) for rows in (1, 2))
    assert two.force == pytest.approx(2.0 * one.force, rel=1e-12)
    assert two.stiffness == pytest.approx(2.0 * one.stiffness, rel=1e-12)


def test_mean_over_the_cage_is_the_same_in_all_directions() -> None:
    """The mean of the force over angles of the cage, for rings that are held: they have one axial displacement."""
    held, omega, size = replace(A, preload=None, offset=8e-6), 6000.0, 2e-6
    angles = np.linspace(0.0, 2.0 * math.pi / A.balls, 12, endpoint=False)
    mean = replace(held, turning=False)
    for phi in (0.0, 0.3, 2.0):
        place = size * np.array([math.cos(phi), math.sin(phi)])
        forces = [kernel(held, place, omega, angle) for angle in angles]
        assert kernel(mean, place, omega, 0.0) == pytest.approx(np.mean(forces, axis=0), rel=1e-4, abs=1.0)


def test_frequencies_are_those_of_rolling_without_slip() -> None:
    """Speeds at the contacts: the ball's centre moves with half of the inner ring's surface (Harris, chapter 10)."""
    d, pitch, angle = A.ball_diameter, A.pitch_diameter, A.contact_angle
    surface = 0.5 * (pitch - d * math.cos(angle))  # of the inner ring at 1 rad/s
    assert A.cage_ratio == pytest.approx(0.5 * surface / (0.5 * pitch), rel=1e-12)
    assert A.pass_outer + A.pass_inner == pytest.approx(A.balls, rel=1e-12)
    outer_surface = 0.5 * (pitch + d * math.cos(angle)) * A.cage_ratio  # in the frame of the cage
    assert A.ball_spin == pytest.approx(outer_surface / (0.5 * d), rel=1e-12)


@pytest.mark.parametrize("grooves", [(0.52, 0.52), (0.52, 0.53), (0.515, 0.53)])
def test_life_under_a_radial_load_is_that_of_iso_281(grooves: tuple[float, float]) -> None:
    """L10 = (C / P)^3 in millions of revolutions with P the radial load of a bearing without clearance."""
    bearing, load, rating = replace(RADIAL, inner=grooves[0], outer=grooves[1]), 800.0, 10e3
    found = under_load(bearing, np.array([0.0, -load]), 0.0)
    assert rating_life(bearing, found.balls, rating) == pytest.approx(1e6 * (rating / load) ** 3, rel=2e-3)
    assert rating_life(bearing, at_displacement(bearing, np.zeros(2), 0.0).balls, rating) == math.inf


@pytest.mark.parametrize("angle", [0.0, 15.0, 40.0])
@pytest.mark.parametrize("rows", [1, 2])
@pytest.mark.parametrize("deep", [False, True])
def test_life_of_half_the_balls_under_load_is_that_of_iso_281(angle: float, rows: int, deep: bool) -> None:
    """Loads Q cos(psi)^1.5 on half of the circle at an angle alpha carry the radial load i Z Q J cos(alpha) with J =
    0.2288, for which P is the load. What a deep groove bears at no angle does not depend on its clearance."""
    alpha, rating = math.radians(angle), 10e3
    bearing = replace(RADIAL, contact_angle=alpha, rows=rows, deep_groove=deep)
    around = 2.0 * math.pi * np.arange(RADIAL.balls) / RADIAL.balls
    loads = 50.0 * np.maximum(np.cos(around), 0.0) ** 1.5
    at = np.full(RADIAL.balls, alpha)
    carried = rows * RADIAL.balls * 50.0 * 0.2288 * (1.0 if deep else math.cos(alpha))
    found = rating_life(bearing, Balls(around, at, at, loads, loads), rating)
    assert found == pytest.approx(1e6 * (rating / carried) ** 3, rel=2e-3)
