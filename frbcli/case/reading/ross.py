"""Files of the Python package ROSS, as its `Rotor.save` writes them, TOML or JSON; their shaft and disks for a case.

Such a file is a table of elements, named by class and tag: a shaft element carries its node `n`, length, outer and
inner diameters at both ends and its material, a disk its node, mass and inertias, all in SI. Bearings and seals of the
file are left out: frb has its own. A cone becomes a stack of cylinders, each thinner than the next by a share STEP. Its
alpha and beta are damping over mass and over stiffness that does not turn. Anything else that an element specifies is
refused by its name, unless it has no effect.
"""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from frbcli.case.model import DampingRate, DampingTime, Density, Inertia, InnerDiameter, Length, Mass, Modulus
from frbcli.case.reading.coefficient_files import Refused, text_of
from frbcli.case.reading.settings import TomlFault, parse
from frbcli.case.reading.tables import Breach, table, tables
from frbcli.case.rotor import OF_SECTIONS
from frbcli.units import ValueFault

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
        if isinstance(number, bool) or not isinstance(number, int | float):
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
    try:
        data = json.loads(text) if path.suffix.lower() == ".json" else parse(text)
    except TomlFault as error:
        where = "" if error.fault.line is None else f" in line {error.fault.line}"
        raise Refused(f"is neither TOML nor JSON{where}: it {error.fault.problem}", WRITE) from None
    except (ValueError, RecursionError):
        raise Refused("is neither TOML nor JSON.", WRITE) from None
    if not isinstance(data, dict):
        raise Refused("holds no elements.", WRITE)
    return tuple(
        RossElement(name, name.split("_")[0], values) for name, values in data.items() if isinstance(values, dict)
    )


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
        named = [disk.get("name") if isinstance(disk, dict) else None for disk in own]
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
