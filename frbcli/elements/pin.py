"""Pins of semi-floating rings and cartridges: they act on the turning of a ring alone.

M = -(K (phi - phi_0) + C phi') beyond the play phi_0 to one side, K = k r^2 and C = c r^2 of a pin at the radius r, as
long as it pushes the ring back, and 0 within the play; solve/inputs.py solves it in a stage of the time loop. At rest
the drag of its films holds a ring against its pin. """

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.bearing import Pin
from frbcli.case.schema import Case
from frbcli.elements.element import Line, MachineElement, Site
from frbcli.units import display

PLAY, STIFFNESS, DAMPING = range(3)  # columns of pin_rows


@dataclass(frozen=True)
class PinElement(MachineElement):
    """The pin of a ring or cartridge. bearing: its name."""

    bearing: str
    given: Pin

    @classmethod
    def of(cls, case: Case) -> Iterator[Self]:
        for key, bearing in zip(case.given_keys, case.given_bearings, strict=True):
            if bearing.pin is not None:
                yield cls(f"{key}.pin", bearing.name, bearing.pin)

    def plan_line(self, site: Site) -> Line:
        pin = self.given
        value = f"{self.bearing}: play {display(pin.play, 'm')}".removeprefix(": ")
        free = f"{math.degrees(pin.play / pin.radius):.3g} deg to either side"
        damped = f" and {display(pin.damping, 'N*s/m')}" if pin.damping else ", undamped"
        return "pin", value, f"the ring turns by {free}, then touches {display(pin.stiffness, 'N/m')}{damped}"


def pin_rows(pins: Sequence[Pin | None]) -> Array:
    """(rings, 4) PLAY, STIFFNESS, DAMPING and RADIUS of solve/inputs.py of the pins of all rings; without rows if there
    is none."""
    if not any(pins):
        return np.zeros((0, 4))
    return np.array([(0.0,) * 4 if pin is None else _row(pin) for pin in pins])


def held_by_pins(pins: Array, count: int) -> NDArray[np.bool_]:
    """(count,) which rings have a pin, by the rows of pin_rows."""
    return pins[:, STIFFNESS] > 0.0 if len(pins) else np.zeros(count, dtype=bool)


def pin_angle(row: Array, torque: float) -> float:
    """Angle in rad at which the pin of a row of pin_rows holds a ring against a torque in N m; 0 without any."""
    return float(np.sign(torque) * (row[PLAY] + abs(torque) / row[STIFFNESS])) if torque else 0.0


def _row(pin: Pin) -> tuple[float, float, float, float]:
    return pin.play / pin.radius, pin.stiffness * pin.radius**2, pin.damping * pin.radius**2, pin.radius


def pin_torque(row: Array, angle: Array, speed: Array) -> Array:
    """Torque in N m on a ring of its pin, a row of pin_rows, at angles in rad and speeds in rad/s."""
    play, stiffness, damping, _ = row
    beyond = angle - np.clip(angle, -play, play)
    pushes = np.sign(beyond) * np.maximum(np.sign(beyond) * (stiffness * beyond + damping * speed), 0.0)
    return np.asarray(-pushes)
