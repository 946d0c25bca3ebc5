"""Closed forms of a rigid rotor whose bearings stand on a body of their own: each direction by itself, in series."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from frbcli.case.schema import Case
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.stability import stability

# The shaft and the wheels of turbocharger-heavy on two cross-coupled bearings.
HEAVY = {
    "rotor": {"kind": "turbocharger", "modes": 200},
    "shaft": [
        {"length": f"{length} mm", "diameter": f"{diameter} mm"}
        for length, diameter in ((25, 20), (33, 20), (22, 25), (105, 28), (39, 25))
    ],
    "disk": [
        {"name": "nut", "position": "0 mm", "mass": "0.1 kg"},
        {"name": "compressor", "position": "25 mm", "mass": "1 kg", "polar_inertia": "1.4e-3 kg*m^2",
         "diametral_inertia": "1.0e-3 kg*m^2", "unbalance": "1 g*mm"},
        {"name": "turbine", "position": "224 mm", "mass": "4 kg", "polar_inertia": "4.5e-3 kg*m^2",
         "diametral_inertia": "4.0e-3 kg*m^2", "unbalance": "2 g*mm"},
    ],
    "bearing": [
        {"kind": "coefficients", "name": "front", "position": "80 mm",
         "stiffness": [["1.2e7 N/m", "2e6 N/m"], ["-3e6 N/m", "1.5e7 N/m"]],
         "damping": [["3e3 N*s/m", "2e2 N*s/m"], ["2e2 N*s/m", "4e3 N*s/m"]]},
        {"kind": "coefficients", "name": "rear", "position": "185 mm",
         "stiffness": [["2e7 N/m", "1e6 N/m"], ["-1e6 N/m", "1.8e7 N/m"]], "damping": "5e3 N*s/m"},
    ],
    "speed": {"from": "100 Hz", "to": "1200 Hz", "duration": "0.5 s"},
}  # fmt: skip


def in_series(one: Any, other: Any) -> Any:
    """The stiffness of two elements in series."""
    return one * other / (one + other)


def assert_eigenvalues(case: Case, mass: float, bearing: Sequence[float], bodies: Sequence[Sequence[float]]) -> None:
    """Eigenvalues and damped modes are the roots of (m s^2 + b) (M s^2 + b + c) - b^2 in x and in y.

    mass: m of the rotor, kg; bearing: b = C s + K of all bearings; bodies: M s^2 + c = M s^2 + C s + K of all bodies
    under them, in x and in y; all coefficients with the highest power of s first.
    """
    expected: list[complex] = []
    for own in bodies:
        both = np.polymul(np.polyadd([mass, 0, 0], bearing), np.polyadd(own, bearing))
        expected += np.roots(np.polysub(both, np.polymul(bearing, bearing))).tolist()
    found = stability(case, [80.0]).points[0].eigenvalues
    assert len(found) == len(expected) == 8
    for value in expected:
        assert np.abs(found - value).min() < 1e-9 * abs(value)
    frequencies = sorted(mode.frequency_Hz for mode in damped_modes(case, 80.0).modes)
    oscillating = sorted(abs(value.imag) / (2 * math.pi) for value in expected if value.imag > 0)
    np.testing.assert_allclose(frequencies, oscillating, rtol=1e-9)
