"""Files of the Python package ROSS, as its `Rotor.save` writes them, TOML or JSON; their shaft, disks and housing for a
case.

Such a file is a table of elements, named by class and tag: a shaft element carries its node `n`, length, outer and
inner diameters at both ends and its material, a disk its node, mass and inertias, all in SI. Bearings and seals of the
file are left out: frb has its own. A cone becomes a stack of cylinders, each thinner than the next by a share STEP. Its
alpha and beta are damping over mass and over stiffness that does not turn. Anything else that an element specifies is
refused by its name, unless it has no effect.

The housing that a rotor of ROSS has: point masses that its bearings stand on, on bearings to the ground. A bearing with
`n_link` acts between a node of the shaft and the node of a `PointMass`, and other bearings between these masses or from
them to the ground. The masses by themselves move by M u'' + C u' + K u = F, and that has the modes K u_k = omega_k^2 M
u_k with u_k . M u_k = 1, each by itself if u_j . C u_k = 0 of any two.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.case.elements import AXES
from frbcli.case.model import DampingRate, DampingTime, Density, Inertia, InnerDiameter, Length, Mass, Modulus
from frbcli.case.reading.files import Refused, ross_tables, text_of
from frbcli.case.reading.tables import Breach, at, table, tables
from frbcli.case.rotor import OF_SECTIONS
from frbcli.units import ValueFault, is_number

SHAFT = ("ShaftElement", "ShaftElement6DoF")
# What a case file demands of the same quantities.
QUANTITIES = {"L": Length, "odl": Length, "odr": Length, "idl": InnerDiameter, "idr": InnerDiameter, "rho": Density,
              "E": Modulus, "G_s": Modulus, "m": Mass, "Ip": Inertia, "Id": Inertia,
              "alpha": DampingRate, "beta": DampingTime}  # fmt: skip
REMEDY = "Correct it in ROSS; values are in SI units."
WRITE = "Write it with Rotor.save of ROSS, to .toml or .json."


@dataclass(frozen=True)
class RossElement:
    """An element of a file, its class, and its values."""

    name: str
    kind: str
    values: Mapping[str, Any]

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number, and of what a case file has a quantity for, one that it would take. Raises Refused."""
        number = self.values.get(key, default)
        if not is_number(number):
            raise Refused(f'lacks a number "{key}" in "{self.name}".', WRITE)
        try:
            value = float(number)
        except OverflowError:  # a whole number of hundreds of digits
            value = math.inf
        if not math.isfinite(value):
            raise Refused(f'has a "{key}" in "{self.name}" that is no finite number.', REMEDY)
        if key in QUANTITIES:
            try:
                get_args(QUANTITIES[key])[1].read(value)
            except ValueFault as fault:
                raise Refused(f'has a "{key}" in "{self.name}" that {fault.problem}', REMEDY) from None
        return value

    @property
    def node(self) -> float:
        """Number of its node."""
        return self.number("n")


def ross_elements(path: Path) -> tuple[RossElement, ...]:
    """The elements of a file. Raises Refused."""
    text = text_of(path, "a rotor file of ROSS", WRITE)
    named = ross_tables(text, path.suffix.lower() == ".json", "is neither TOML nor JSON", WRITE)
    return tuple(RossElement(name, name.split("_")[0], values) for name, values in named.items())


def shaft_of_file(elements: Sequence[RossElement]) -> tuple[list[RossElement], list[float]]:
    """The elements of the shaft in their order, and the positions of its nodes in m. Raises Refused."""
    shaft = sorted((element for element in elements if element.kind in SHAFT), key=lambda element: element.node)
    if not shaft:
        raise Refused("has no shaft elements.", WRITE)
    for place, element in enumerate(shaft):
        if element.node != place:
            problem = f'has "{element.name}" where the element from node {place} belongs; layers are not modelled.'
            raise Refused(problem, "Number nodes from 0, with one shaft element after each.")
    return shaft, list(itertools.accumulate((element.number("L") for element in shaft), initial=0.0))


STEP, MOST_CYLINDERS = 0.025, 80  # of a cone: relative change of the diameter from one cylinder to the next
DISK = ("DiskElement", "DiskElement6DoF")
HEAVY = ("GearElement", "GearElementTVMS", "CouplingElement")  # have mass, but are no disks on the shaft
POINT_MASS = "PointMass"  # that bearings stand on
SUPPORTED = ("L", "idl", "odl", "idr", "odr", "material", "n", "alpha", "beta")
DAMPINGS = {"mass_damping": "alpha", "stiffness_damping": "beta"}  # C = alpha M + beta K of an element
LABELS = ("tag", "color", "scale_factor", "kwargs")
ALWAYS = {"shear_effects": True, "rotary_inertia": True, "gyroscopic": True, "shear_method_calc": "cowper"}
OF_DISK = ("n", "m", "Id", "Ip")
OF_MATERIAL = ("name", "rho", "E", "G_s", "Poisson", "color", "specific_heat", "thermal_conductivity")
MOST_POISSON = 0.5 + 1e-6  # of an incompressible material

ALWAYS_WORDS = {
    "shear_effects": "the shear of a shaft", "rotary_inertia": "its rotary inertia",
    "gyroscopic": "its gyroscopic moments", "shear_method_calc": "shear with Cowper's coefficient",
}  # fmt: skip

KEY = ("rotor", "file")
UNITS = {"length": "m", "diameter": "m", "inner_diameter": "m", "density": "kg/m^3", "youngs_modulus": "Pa",
         "position": "m", "mass": "kg", "polar_inertia": "kg*m^2", "diametral_inertia": "kg*m^2",
         "mass_damping": "1/s", "stiffness_damping": "s"}  # fmt: skip


def with_rotor_file(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with shaft and disks of its rotor.file instead of that key, and its faults.

    folder: that a relative path counts from. A [[disk]] of the case with the name of one of the file's completes it,
    e.g. by an unbalance; others come in addition. With faults the tables are returned unchanged.
    """
    rotor = table(data, "rotor")
    name = rotor.get("file")
    if rotor.get("kind") not in OF_SECTIONS or not isinstance(name, str) or not name:
        return data, []
    if "shaft" in data:
        return data, [Breach(KEY, "is given with [[shaft]].", "Keep one of the two.")]
    try:
        shaft, disks = _rotor(ross_elements(folder / name), _says_what_carries(data))
    except Refused as fault:
        return data, [Breach(KEY, *fault.args)]
    own = data.get("disk", [])
    if isinstance(own, list):
        known = {disk["name"]: disk for disk in disks}
        named = [at(disk, ("name",)) for disk in own]
        completed = [
            {**known[called], **disk} if isinstance(called, str) and called in known else disk
            for disk, called in zip(own, named, strict=True)
        ]
        own = completed + [disk for disk in disks if disk["name"] not in named]
    kept = {key: value for key, value in rotor.items() if key != "file"}
    return {**data, "rotor": kept, "shaft": shaft, "disk": own}, []


def _says_what_carries(data: Mapping[str, Any]) -> bool:
    """Whether a case has a housing, or a bearing of it a support or a damper."""
    return "housing" in data or any({"support", "damper"} & held.keys() for _, held in tables(data, "bearing"))


def _rotor(elements: Sequence[RossElement], carried: bool) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The tables [[shaft]] and [[disk]] of a file's elements; carried: whether the case says what bearings stand on."""
    for element in elements:
        if element.kind in HEAVY:
            raise Refused(
                f'has the element "{element.name}", which frb does not model.', "Replace it by a disk in ROSS."
            )
    shaft, positions = shaft_of_file(elements)
    for element in elements:
        if element.kind == POINT_MASS and element.node <= len(shaft):
            raise Refused(f'has "{element.name}" on the shaft, which has disks.', "Replace it by a disk in ROSS.")
        if element.kind == POINT_MASS and not carried:
            problem = f'has "{element.name}", which bearings stand on, and the case has no housing and no supports.'
            raise Refused(problem, "Give housing.file = this file, too, or [bearing.support].")
    cylinders = [cylinder for element in shaft for cylinder in _cylinders(element)]
    disks = [_disk(element, positions) for element in elements if element.kind in DISK]
    shaft_tables = [_joined(alike) for alike in _runs(cylinders)]
    return [_with_units(section) for section in shaft_tables], [_with_units(disk) for disk in disks]


def _with_units(entries: dict[str, Any]) -> dict[str, Any]:
    """A table with units, so that SI values of the file do not look like numbers without a unit."""
    return {key: f"{value!r} {UNITS[key]}" if key in UNITS else value for key, value in entries.items()}


def _cylinders(element: RossElement) -> Iterator[dict[str, Any]]:
    """Tables of [[shaft]] for a shaft element."""
    _refuse_others(element, SUPPORTED)
    outer, inner = element.number("odl"), element.number("idl")
    growth = element.number("odr", outer) - outer, element.number("idr", inner) - inner
    if inner >= outer or inner + growth[1] >= outer + growth[0]:
        raise Refused(f'has no thickness in "{element.name}": the inner diameter is not below the outer one.', REMEDY)
    material = RossElement(f"{element.name}.material", "", table(element.values, "material"))
    modulus = material.number("E")
    _refuse_others(material, OF_MATERIAL)
    poisson = modulus / (2 * material.number("G_s")) - 1
    if not 0.0 <= poisson <= MOST_POISSON:
        raise Refused(f'has E and G_s in "{material.name}" that make a Poisson ratio of {poisson:.3g}.', REMEDY)
    dampings = {key: element.number(name) for key, name in DAMPINGS.items() if element.values.get(name)}
    parts = _cylinders_of(outer, *growth)
    for part in range(parts):
        middle = (part + 0.5) / parts
        yield {
            "length": element.number("L") / parts,
            "diameter": outer + middle * growth[0],
            "inner_diameter": inner + middle * growth[1],
            "density": material.number("rho"),
            "youngs_modulus": modulus,
            "poisson_ratio": poisson,
            **dampings,
        }


def _refuse_others(element: RossElement, supported: Sequence[str]) -> None:
    """Raises Refused for a value that is not supported, unless it equals what frb models or is empty."""
    for key, value in element.values.items():
        if key in supported or key in LABELS:
            continue
        if key in ALWAYS:
            if value != ALWAYS[key]:
                shown = f'{key} = {str(value).lower()} in "{element.name}"'
                problem = f"has {shown}; frb always models {ALWAYS_WORDS[key]}."
                raise Refused(problem, f"Set it to {str(ALWAYS[key]).lower()} in ROSS.")
        elif value not in (None, 0, "", [], {}):
            shown = f'{key} = {value} in "{element.name}"'
            raise Refused(f"has {shown}, which frb does not model.", "Set it to 0 in ROSS.")


def _cylinders_of(outer: float, growth: float, inner_growth: float) -> int:
    """How many cylinders replace a cone; outer: diameter at its left end, growth: of the outer and inner ones."""
    least = min(outer, outer + growth)
    change = max(abs(growth), abs(inner_growth)) / least
    return min(max(1, math.ceil(change / STEP)), MOST_CYLINDERS)


def _runs(cylinders: list[dict[str, Any]]) -> Iterator[list[dict[str, Any]]]:
    """Neighbours that differ in their lengths only."""
    for _, run in itertools.groupby(cylinders, lambda cylinder: {**cylinder, "length": 0.0}):
        yield list(run)


def _joined(alike: list[dict[str, Any]]) -> dict[str, Any]:
    return {**alike[0], "length": sum(cylinder["length"] for cylinder in alike)}


def _disk(element: RossElement, positions: list[float]) -> dict[str, Any]:
    node = element.node
    if node not in range(len(positions)):
        raise Refused(f'has "{element.name}" beyond the shaft.', WRITE)
    _refuse_others(element, OF_DISK)
    tag = element.values.get("tag") or element.name
    polar, diametral = element.number("Ip"), element.number("Id")
    if polar > 2 * diametral * (1 + 1e-9):
        raise Refused(f'has an Ip in "{element.name}" of more than twice Id, which is not possible.', REMEDY)
    return {
        "name": re.sub(r"[^A-Za-z0-9_-]", "-", str(tag))[:40],
        "position": positions[int(node)],
        "mass": element.number("m"),
        "polar_inertia": polar,
        "diametral_inertia": diametral,
    }


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
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

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
    from scipy.linalg import eigh

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
