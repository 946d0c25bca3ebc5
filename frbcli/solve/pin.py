"""Pins that keep rings from turning, in a stage of the time loop. Compiled.

A ring that has turned by more than the play to one side pushes against its pin, a spring and a damper, which do not
pull at it. Machines without pins have an array without rows. Its torque over the angle alone is in elements/pin.py.
"""

from __future__ import annotations

from frbcli.arrays import Array
from frbcli.compiled import compiled

# Of a ring: play in rad, N m/rad, N m s/rad, and m from the axis; a ring without a pin has no stiffness
PLAY, STIFFNESS, DAMPING, RADIUS, PIN = range(5)


@compiled()
def pinned(pin: Array, q: float, v: float, g: float, inertia: float, pulled: float) -> float:
    """Angular acceleration a of a ring with v' = v + g a and angle q + g v' in a stage, inertia a = pulled + its pin.

    The torque never rises with the speed of the ring, so that there is one solution, in the play, against the pin, or
    at the edge: a ring that meets its damper there has any torque between none and that of the damper.
    """
    free = pulled / inertia
    angle = q + g * (v + g * free)
    if pin[STIFFNESS] == 0.0 or abs(angle) <= pin[PLAY]:
        return free
    side = 1.0 if angle > 0.0 else -1.0
    edge, k, c = side * pin[PLAY], pin[STIFFNESS], pin[DAMPING]
    pressed = (pulled - k * (q + g * v - edge) - c * v) / (inertia + g * (c + g * k))
    if side * (inertia * pressed - pulled) >= 0.0:  # it would pull
        return free
    if side * (q + g * (v + g * pressed) - edge) < 0.0:
        return float(((edge - q) / g - v) / g)
    return float(pressed)
