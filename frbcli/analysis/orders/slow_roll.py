"""The slow-roll vector: what a probe sees once in a revolution as the rotor turns slowly, without dynamic forces.

It is the runout of the surface under the probe with the bow of the shaft, and belongs to the angle of the rotor at all
speeds: subtracted, it leaves the motion of the rotor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array

BAND = 0.1  # of the slow speed, by which the speed may be off it
LEAST_REVOLUTIONS = 3.0  # about that speed


@dataclass(frozen=True)
class SlowRoll:
    """vector: complex amplitude A of Re(A exp(i angle)), in the unit of the signal; revolutions: that it was taken
    over."""

    vector: complex
    revolutions: float

    def at(self, angle: Array) -> Array:
        """(n,) the slow roll at angles (n,) of the rotor in rad."""
        return np.asarray((self.vector * np.exp(1j * angle)).real)


def slow_roll(signal: Array, angle: Array, speed: Array, slow: float) -> SlowRoll:
    """The slow-roll vector of a signal (n,) at angles (n,) in rad and speeds (n,) in Hz of the rotor, where these are
    within BAND of the speed `slow` in Hz, by least squares together with a straight line.

    Raises ValueError if the rotor turns less than LEAST_REVOLUTIONS there."""
    near = np.abs(np.abs(speed) - slow) <= BAND * slow
    turned = np.abs(np.diff(angle))[near[1:] & near[:-1]].sum() / (2.0 * np.pi)
    if turned < LEAST_REVOLUTIONS:
        least, most = float(np.abs(speed).min()), float(np.abs(speed).max())
        raise ValueError(
            f"turns {turned:.2g} times within {BAND:.0%} of {slow:g} Hz, and {LEAST_REVOLUTIONS:g} times are needed: "
            f"its speed is {least:.4g} to {most:.4g} Hz."
        )
    there = angle[near]
    line = (there - there.mean()) / np.ptp(there)
    columns = np.column_stack([np.cos(there), -np.sin(there), np.ones_like(there), line])
    real, imaginary = np.linalg.lstsq(columns, signal[near], rcond=None)[0][:2]
    return SlowRoll(complex(real, imaginary), float(turned))
