"""What every film must do, whatever the motion: symmetries, scaling, dissipation, derivatives."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from films import EQUAL_PRESSURES, KINDS, film_of, force, polar
from hypothesis import given, settings
from hypothesis import strategies as st

from frbcli.film.rectangles.film import evaluate

ROUND_OFF = 1e-7  # of the force: directions are found by atan2 and cut by acos
STEP = 1e-6  # relative, of a difference quotient
DERIVATIVE_ERROR = 1e-3  # of the force over the step that changes it by its own size

angles = st.floats(-math.pi, math.pi)
places = st.builds(polar, st.floats(0.01, 0.95), angles)
velocities = st.builds(polar, st.floats(0.0, 500.0), angles)
speeds = st.floats(-2000.0, 2000.0)
every_kind = pytest.mark.parametrize("kind", KINDS)
examples = settings(max_examples=60, deadline=None)  # the first call of a kernel compiles it


def near(found: np.ndarray, expected: np.ndarray, scale: float) -> bool:
    return bool(np.linalg.norm(found - expected) <= ROUND_OFF * scale)


def size(kind: str, d: np.ndarray, v: np.ndarray, omega: float) -> float:
    """A force in N that round-off is measured by: that of the pressures before they cancel."""
    bearing, eccentricity = KINDS[kind][0], float(np.linalg.norm(d))
    centrifugal_pressure = bearing.force_scale * (float(np.linalg.norm(v)) + abs(omega)) / (1 - eccentricity) ** 2.5
    supply = 2.0 * bearing.radius * bearing.bearing_width * bearing.far_pressure
    return max(float(np.linalg.norm(force(kind, d, v, omega))), 1e-3 * centrifugal_pressure, supply)


@every_kind
@given(d=places, v=velocities, omega=speeds, angle=angles)
@examples
def test_force_turns_with_the_frame(
    kind: str, d: np.ndarray, v: np.ndarray, omega: float, angle: float
) -> None:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    assert near(force(kind, turn @ d, turn @ v, omega), turn @ force(kind, d, v, omega), size(kind, d, v, omega))


@every_kind
@given(d=places, v=velocities, omega=speeds)
@examples
def test_mirror_turns_the_rotation_round(kind: str, d: np.ndarray, v: np.ndarray, omega: float) -> None:
    mirror = np.array([-1.0, 1.0])
    found = force(kind, mirror * d, mirror * v, -omega)
    assert near(found, mirror * force(kind, d, v, omega), size(kind, d, v, omega))


@every_kind
@given(d=places, v=velocities, omega=speeds, factor=st.sampled_from([0.5, 3.0]), thicker=st.booleans())
@examples
def test_force_scales_with_viscosity_or_speed_and_pressure(
    kind: str, d: np.ndarray, v: np.ndarray, omega: float, factor: float, thicker: bool
) -> None:
    """Viscosity, or all speeds, and the gauge pressure of the supply times a factor: the force times the factor."""
    bearing, theory, cavitation = KINDS[kind]
    supply = factor * bearing.far_pressure
    other = replace(bearing, far_pressure=supply, viscosity=bearing.viscosity * (factor if thicker else 1.0))
    faster = 1.0 if thicker else factor
    found = evaluate(
        film_of(other, theory, cavitation), other.clearance, d * other.clearance, faster * v * other.clearance,
        faster * omega,
    ).force  # fmt: skip
    assert near(found, factor * force(kind, d, v, omega), factor * size(kind, d, v, omega))


@pytest.mark.parametrize("kind", EQUAL_PRESSURES)
@given(d=places, v=velocities)
@examples
def test_film_without_rotation_dissipates(kind: str, d: np.ndarray, v: np.ndarray) -> None:
    assert float(force(kind, d, v, 0.0) @ v) <= 0.0


@pytest.mark.parametrize("kind", EQUAL_PRESSURES)
@given(d=places, omega=speeds)
@examples
def test_whirl_with_half_the_speed_meets_no_resistance(kind: str, d: np.ndarray, omega: float) -> None:
    """A journal that circles with omega/2 carries nothing: the film turns with it."""
    circling = 0.5 * omega * np.array([-d[1], d[0]])
    assert near(force(kind, d, circling, omega), np.zeros(2), size(kind, d, circling, omega))


# The extended short bearing has the derivatives of its integral, not of its sum over 96 points: see test_film_limits.
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "short, 2 bar"])
@given(d=places, v=velocities, omega=speeds)
@examples
def test_derivatives_are_those_of_the_force(kind: str, d: np.ndarray, v: np.ndarray, omega: float) -> None:
    """Against differences of the force. Where the film ruptures the derivatives have kinks, which differences smear."""
    bearing = KINDS[kind][0]
    if np.linalg.norm(v) + abs(omega) < 1.0:
        return  # at rest the direction of the motion, and with it the ruptured side, is arbitrary
    c = bearing.clearance
    found = evaluate(film_of(*KINDS[kind]), c, d * c, v * c, omega)
    gap, pace = STEP * (1 - float(np.linalg.norm(d))), STEP * (float(np.linalg.norm(v)) + abs(omega))
    for analytic, step, move in (
        (found.by_displacement * c, gap, lambda s: (d + s, v)),
        (found.by_velocity * c, pace, lambda s: (d, v + s)),
    ):
        steps = step * np.eye(2)
        columns = [(force(kind, *move(s), omega) - force(kind, *move(-s), omega)) / (2 * step) for s in steps]
        scale = size(kind, d, v, omega) * STEP / step
        np.testing.assert_allclose(analytic, np.stack(columns, axis=1), rtol=0.0, atol=DERIVATIVE_ERROR * scale)


@every_kind
def test_derivatives_at_the_centre(kind: str) -> None:
    """Concentric, the film is isotropic and turns with omega/2: F = -D (d' - omega/2 J d)."""
    bearing = KINDS[kind][0]
    found = evaluate(film_of(*KINDS[kind]), bearing.clearance, np.zeros(2), np.zeros(2), 100.0)
    damping = -found.by_velocity
    assert damping[0, 0] > 0.0
    np.testing.assert_allclose(damping, damping[0, 0] * np.eye(2), atol=1e-4 * damping[0, 0])
    expected = 50.0 * damping[0, 0] * np.array([[0.0, -1.0], [1.0, 0.0]])
    np.testing.assert_allclose(found.by_displacement, expected, atol=1e-4 * 50.0 * damping[0, 0])
    np.testing.assert_allclose(found.force, 0.0, atol=1e-6)
