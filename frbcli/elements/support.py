"""The support of a bearing: its shell is a body on springs and dampers, M u'' + C u' + K u = weight + what acts on it.

Film or coefficients act between the shaft, or the ring, and that body. Equal bearings of a symmetric rotor move alike:
one body stands for both, with twice their mass, stiffness and damping.
"""

from __future__ import annotations

import numpy as np

from frbcli.case.surroundings.support import Support
from frbcli.rotor.assembly import GROUND, Link
from frbcli.rotor.body import Body, point_mass
from frbcli.rotor.over_speed import LinearPart
from frbcli.units import display

NODE = "support"  # and behind it the name of its bearing


def shell_of(bearing: str, support: Support | None) -> str:
    """The node of the shell of the bearing with a name: that of its support, or the ground."""
    return GROUND if support is None else f"{NODE}_{bearing}".rstrip("_")


def body(bearing: str, support: Support, count: float, gravity: float) -> Body:
    """The bodies of `count` equal supports as one; gravity in m/s^2."""
    return point_mass(shell_of(bearing, support), count * support.mass, gravity)


def mount(bearing: str, support: Support, count: float) -> tuple[Link, LinearPart]:
    """Springs and dampers of `count` equal supports to the ground."""
    stiffness, damping = (np.diag(each)[None] for each in (support.stiffness, support.damping))
    link = Link(shell_of(bearing, support), count=count)
    return link, LinearPart(np.zeros(1), stiffness, damping, np.zeros((1, 2, 2)))


def told(bearing: str, support: Support) -> tuple[str, str]:
    """Its line of the plan."""
    springs = _directions(support.stiffness, "N/m")
    damping = f", {_directions(support.damping, 'N*s/m')}" if any(support.damping) else ", undamped"
    value = f"{bearing}: {display(support.mass, 'kg')} on springs".removeprefix(": ")
    why = "the shell is a body with its weight; what acts in the bearing acts between shaft and shell"
    return value, f"{springs}{damping}; {why}"


def _directions(both: tuple[float, float], unit: str) -> str:
    x, y = (display(each, unit) for each in both)
    return x if x == y else f"{x} in x and {y} in y"
