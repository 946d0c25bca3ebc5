"""The housing that a rotor of ROSS has: point masses that its bearings stand on, on bearings to the ground.

In ROSS a bearing with `n_link` acts between a node of the shaft and the node of a `PointMass`, and other bearings
between these masses or from them to the ground. The masses by themselves move by M u'' + C u' + K u = F, and that has
the modes K u_k = omega_k^2 M u_k with u_k . M u_k = 1, each by itself if u_j . C u_k = 0 of any two. """

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from frbcli.arrays import Array
from frbcli.case.elements import AXES
from frbcli.case.reading.coefficient_files import Refused
from frbcli.case.reading.ross import POINT_MASS, REMEDY, RossElement, ross_elements, shaft_of_file

COUPLED = 1e-6  # of the largest damping of the modes of a housing: that between two of them
LOOSE = 1e-12  # of the largest square of a frequency
SAME_PLACE = 1e-6  # of the length of the shaft
GIVE_SUPPORTS = "Give bearings [bearing.support], which takes any mass, stiffness and damping."



@dataclass(frozen=True)
class _Masses:
    """Point masses. nodes: their numbers; mass: (2 k,) kg, x and y of each; damping, stiffness: (2 k, 2 k)."""

    nodes: tuple[int, ...]
    mass: Array
    damping: Array
    stiffness: Array

    def rows(self, node: int) -> slice:
        """x and y of a node."""
        at = 2 * self.nodes.index(node)
        return slice(at, at + 2)


def ross_housing(path: Path, bearings: Sequence[tuple[str, float]]) -> dict[str, Any]:
    """The keys `modes` and `masses` of a housing out of a rotor file.

    bearings: names and positions in m of the bearings of the case, each at a node at which the rotor of the file has
    one, too. Raises Refused. """
    elements = ross_elements(path)
    _, positions = shaft_of_file(elements)
    springs = [element for element in elements if "kxx" in element.values]
    masses = _masses(elements, springs, len(positions))
    under = {name: _under(name, position, positions, springs, masses) for name, position in bearings}
    named = {f"{POINT_MASS}-{node}": node for node in masses.nodes if node not in under.values()}
    places = {name: node for name, node in under.items() if node is not None}
    if not places:
        raise Refused(f"has no {POINT_MASS} under a bearing of the case.", "Remove housing.file.")
    alike = bool(np.all(masses.mass[::2] == masses.mass[1::2]))  # a mass in kg is one of both directions
    carrying = [masses.rows(node) for node in places.values()]
    places |= named if alike else {}
    modes = []
    for square, ratio, displacement in _modes(masses, carrying):
        at = {name: [0.0, 0.0] for name, _ in bearings}
        at |= {name: displacement[masses.rows(node)].tolist() for name, node in places.items()}
        frequency = f"{math.sqrt(square) / (2.0 * math.pi)!r} Hz"
        modes.append({"frequency": frequency, "damping": ratio, "at": at})
    first = {node: name for name, node in reversed(places.items())}  # a mass under two bearings counts once
    weights = {name: f"{float(masses.mass[masses.rows(node)][0])!r} kg" for node, name in first.items()}
    return {"modes": modes} | ({"masses": weights} if alike else {})


def _masses(elements: Sequence[RossElement], springs: Sequence[RossElement], nodes: int) -> _Masses:
    """The point masses of a file with what holds them; nodes: of the shaft."""
    by_node: dict[int, Array] = {}
    for element in elements:
        if element.kind == POINT_MASS:
            mass = element.values.get("m")
            both = np.array([element.number(key, mass) for key in ("mx", "my")])
            if np.any(both <= 0.0):
                raise Refused(f'has no mass in x or y in "{element.name}".', REMEDY)
            by_node[int(element.node)] = by_node.get(int(element.node), np.zeros(2)) + both
    if not by_node:
        problem = f"has no {POINT_MASS}: its bearings stand on the ground."
        raise Refused(problem, "Remove housing.file, or give the bearings in ROSS an n_link with a PointMass.")
    size = 2 * len(by_node)
    masses = _Masses(tuple(by_node), np.concatenate(list(by_node.values())), *np.zeros((2, size, size)))
    for element in springs:
        ends = _ends(element)
        if not any(end < nodes for end in ends):
            seen = np.zeros((2, size))
            for sign, end in zip((1.0, -1.0), ends, strict=False):
                if end not in by_node:
                    raise Refused(f'has "{element.name}" at node {end}, which has no {POINT_MASS}.', "Add it in ROSS.")
                seen[:, masses.rows(end)] += sign * np.eye(2)
            masses.stiffness[:] += seen.T @ _matrix(element, "k") @ seen
            masses.damping[:] += seen.T @ _matrix(element, "c") @ seen
    return masses


def _ends(element: RossElement) -> tuple[int, ...]:
    """The nodes of a bearing: one, if it leads to the ground."""
    linked = element.values.get("n_link")
    return (int(element.node),) if linked is None else (int(element.node), int(element.number("n_link")))


def _constant(element: RossElement, key: str) -> float:
    """A coefficient of what holds a mass, 0 if the file has none."""
    given = element.values.get(key, 0.0)
    values = given if isinstance(given, list) else [given]
    numbers = {RossElement(element.name, element.kind, {key: value}).number(key) for value in values}
    if len(numbers) != 1:
        problem = f'has a {key} over the frequency in "{element.name}", which holds a {POINT_MASS}.'
        raise Refused(problem, "Give one value.")
    return numbers.pop()


def _matrix(element: RossElement, letter: str) -> Array:
    """(2, 2) coefficients of what holds a mass: constant and symmetric, as of springs and dampers."""
    if any(_constant(element, f"m{axes}") for axes in AXES):
        raise Refused(f'has a mass in "{element.name}", which holds a {POINT_MASS}.', "Add it to that in ROSS.")
    matrix = np.array([_constant(element, f"{letter}{axes}") for axes in AXES]).reshape(2, 2)
    if matrix[0, 1] != matrix[1, 0]:
        problem = f'has {letter}xy and {letter}yx in "{element.name}" that differ: no spring or damper holds a mass so.'
        raise Refused(problem, REMEDY)
    return matrix


def _under(
    name: str, position: float, positions: Sequence[float], springs: Sequence[RossElement], masses: _Masses
) -> int | None:
    """The node of the mass under a bearing of the case, None of one on the ground."""
    near = SAME_PLACE * positions[-1]
    carriers = set[int | None]()
    for element in springs:
        ends = _ends(element)
        here = [end for end in ends if end < len(positions) and abs(positions[end] - position) <= near]
        if here:
            carriers |= {end for end in ends if end not in here} or {None}
    if not carriers:
        places = sorted({positions[end] for element in springs for end in _ends(element) if end < len(positions)})
        listed = ", ".join(f"{1e3 * place:.6g} mm" for place in places) or "none"
        problem = f'has no bearing at {1e3 * position:.6g} mm, where the case has "{name}"; its bearings: {listed}.'
        raise Refused(problem, "Let both have the same positions.")
    linked = carriers - {None}
    if len(linked) > 1 or not linked <= set(masses.nodes):
        problem = f"has bearings at {1e3 * position:.6g} mm that do not stand on one {POINT_MASS}."
        raise Refused(problem, "Link them to one.")
    return next(iter(linked), None)


def _modes(masses: _Masses, carrying: Sequence[slice]) -> list[tuple[float, float, Array]]:
    """(omega^2, damping ratio, (2 k,) displacements of unit modal mass) of each mode that moves what carries a bearing,
    from the slowest on. Directions and masses that nothing couples are solved by themselves, so that equal ones do not
    mix."""
    root = np.sqrt(masses.mass)
    stiffness, damping = (each / np.outer(root, root) for each in (masses.stiffness, masses.damping))
    count, group = connected_components(csr_array((stiffness != 0.0) | (damping != 0.0)), directed=False)
    moved = {int(each) for rows in carrying for each in group[rows]}
    modes = [
        (square, ratio, displacement / root)
        for number in range(count)
        if number in moved
        for square, ratio, displacement in _coupled(stiffness, damping, np.flatnonzero(group == number))
    ]
    return sorted(modes, key=lambda mode: mode[0])


def _coupled(stiffness: Array, damping: Array, own: NDArray[np.intp]) -> Iterator[tuple[float, float, Array]]:
    """The modes of degrees of freedom that are coupled, both matrices over the roots of the masses."""
    squares, vectors = eigh(stiffness[np.ix_(own, own)])
    if squares[0] <= LOOSE * squares[-1]:
        raise Refused(
            f"has a {POINT_MASS} that no spring holds.", "Add a BearingElement from its node to the ground in ROSS."
        )
    modal = vectors.T @ damping[np.ix_(own, own)] @ vectors
    if np.abs(modal - np.diag(np.diag(modal))).max() > COUPLED * np.abs(modal).max():
        problem = "has dampers that couple the modes of its point masses."
        raise Refused(problem, f"Let their damping be in proportion to their stiffness. {GIVE_SUPPORTS}")
    for square, vector, rate in zip(squares.tolist(), vectors.T, np.diag(modal).tolist(), strict=True):
        ratio = rate / (2.0 * math.sqrt(square))
        if not 0.0 <= ratio <= 1.0:
            problem = f"has a damping of {ratio:.4g} of the critical one in a mode of its point masses."
            raise Refused(problem, f"Give from 0 to 1. {GIVE_SUPPORTS}")
        displacement = np.zeros(len(stiffness))
        displacement[own] = vector * np.sign(vector[np.argmax(np.abs(vector))])
        yield square, ratio, displacement
