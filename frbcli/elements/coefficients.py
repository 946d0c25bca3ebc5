"""Given coefficients: the force on the shaft is -K d - C d' - M d'' with the displacement d (2,) of the shaft.

K, C and M may depend on the speed of the rotor; for the motion at each moment they are those of its speed then.
"""

from __future__ import annotations

import math

import numpy as np

from frbcli.case.elements import AXES, EMPTY_MATRIX, CoefficientsBearing
from frbcli.elements.kind import ElementKind
from frbcli.errors import Fault
from frbcli.rotor.body import COORDINATES
from frbcli.rotor.over_speed import Array, LinearPart


def linear(element: CoefficientsBearing) -> LinearPart:
    """The coefficients in SI: constant, or over the speed."""
    table = element.over_speed
    if table is None:
        given = (element.stiffness, element.damping, element.mass)
        stiffness, damping, mass = (np.array([EMPTY_MATRIX if each is None else each]) for each in given)
        return LinearPart(np.zeros(1), stiffness, damping, mass)

    def matrices(letter: str) -> Array:
        columns = [getattr(table, f"{letter}{axes}") or (0.0,) * len(table.speed) for axes in AXES]
        return np.array(columns).T.reshape(-1, 2, 2)

    return LinearPart(2.0 * math.pi * np.array(table.speed), *(matrices(letter) for letter in "kcm"))


def faults(key: str, element: CoefficientsBearing) -> list[Fault]:
    """None beyond the rules of its keys, for a file that has been read."""
    if not element.file:
        return []
    problem = "has not been read: the folder of the case is not known."
    return [Fault(f"{key}.file", element.file, None, problem, "Load the case with load_case or case_from_dict.")]


def told(element: CoefficientsBearing) -> tuple[str, str]:
    """Its line of the plan."""
    table = element.over_speed
    if table is None:
        named = [name for name in ("stiffness", "damping", "mass") if getattr(element, name) is not None]
        return "given coefficients", f"constant {', '.join(named)}; linear, part of the rotor's matrices"
    source = f" from {table.source}" if table.source else ""
    low, high = table.speed[0], table.speed[-1]
    many = f"{len(table.speed)} speeds, {low:.4g} to {high:.4g} Hz" if len(table.speed) > 1 else "one speed: constant"
    return f"given coefficients, over speed{source}", f"{many}; linear between them, constant beyond"


KIND = ElementKind(CoefficientsBearing, COORDINATES, linear, faults, told, "spring")
