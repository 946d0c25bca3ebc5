"""The elements of a case: their forces, springs and faults, and their lines of the plan."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.elements.support import shell_of
from frbcli.elements.support import told as support_told
from frbcli.elements.table import kind_of
from frbcli.errors import Fault
from frbcli.rotor.assembly import GROUND
from frbcli.rotor.linear import Array, LinearRotor
from frbcli.scene.keys import all_keys, element_keys
from frbcli.scene.shafts.table import shaft_of


def element_forces(case: Case, rotor: LinearRotor, omega: float, q: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """(e, 2) complex amplitudes in N of the forces of the elements on the shaft, of one each. rotor: of the case; q:
    (n,) complex amplitudes of its motion with omega rad/s."""
    shaft, nodes, forces = shaft_of(case), dict(rotor.points), np.zeros((len(case.elements), 2), dtype=np.complex128)
    for force, element in zip(forces, case.elements, strict=True):
        stiffness, damping, mass = kind_of(element).linear(element).at(omega)
        shell = shell_of(element.name, element.support)
        motion = nodes[shaft.journal(element.name)] @ q - (0.0 if shell == GROUND else nodes[shell] @ q)
        force[:] = -(stiffness + 1j * omega * damping - omega**2 * mass) @ motion
    return forces


def changes_with_speed(case: Case) -> bool:
    """Whether coefficients of an element depend on the speed of the rotor."""
    return any(not kind_of(element).linear(element).constant for element in case.elements)


def element_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of elements and supports: choice, value, reason."""
    for element in case.elements:
        value, reason = kind_of(element).told(element)
        yield "bearings", f"{element.name}: {value}".removeprefix(": "), reason
    for bearing in case.given_bearings:
        if bearing.support is not None:
            yield "support", *support_told(bearing.name, bearing.support)


def thrust_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of thrust bearings: choice, value, reason."""
    for bearing in case.thrust_bearings:
        reason = "left out of the motion, which is lateral: neither their load nor the tilt of the collar; `frb thrust`"
        yield "thrust bearing", f"{bearing.name}: left out".removeprefix(": "), reason


def element_faults(case: Case) -> list[Fault]:
    """Every reason why the elements of a case cannot be modelled."""
    keyed = zip(element_keys(case), case.elements, strict=True)
    return [fault for key, element in keyed for fault in kind_of(element).faults(key, element)]


def element_springs(case: Case, omega: float) -> Array:
    """(e,) N/m of each element at omega rad/s: the mean of the direct stiffness of both directions, as far as it holds
    the shaft; cross-coupling, damping and mass are left out."""
    stiffness = (kind_of(element).linear(element).at(omega)[0] for element in case.elements)
    return np.array([max(0.5 * float(np.trace(each)), 0.0) for each in stiffness])


def without_bearing(case: Case) -> list[Fault]:
    """The fault of a case of thrust bearings alone, which has no lateral motion."""
    if case.given_bearings:
        return []
    problem = "is missing: the case is of thrust bearings alone."
    return [Fault("bearing", "", None, problem, "Call `frb thrust`, or add [rotor], [speed] and [bearing].")]


def without_film(case: Case, what: str) -> list[Fault]:
    """The fault of a case in which no bearing has a film, where `what` is of films alone."""
    if case.bearings or not case.given_bearings:
        return []
    problem = f"has no film, and {what}."
    key = element_keys(case)[0]
    return [Fault(f"{key}.kind", case.elements[0].kind, None, problem, "Add a bearing with a film.")]


def support_faults(case: Case, what: str, remedy: str) -> list[Fault]:
    """The faults of bearings on supports, where `what` is of bearings on the ground."""
    return [
        Fault(f"{key}.support", "", None, f"is a shell that moves, and {what}.", remedy)
        for key, bearing in zip(all_keys(case), case.given_bearings, strict=True)
        if bearing.support is not None
    ]


def speed_dependent(case: Case, what: str) -> list[Fault]:
    """The faults of elements whose coefficients depend on the speed, where `what` needs constant ones."""
    problem = f"depends on the speed, and {what}."
    remedy = "Give constant stiffness, damping and mass, those at the speed of interest."
    return [
        Fault(f"{key}.over_speed", element.name, None, problem, remedy)
        for key, element in zip(element_keys(case), case.elements, strict=True)
        if not kind_of(element).linear(element).constant
    ]
