"""Shaft and disks out of a rotor file of the Python package ROSS, as its `Rotor.save` writes it, TOML or JSON.

Such a file is a table of elements, named by class and tag: a shaft element carries its node `n`, length, outer and
inner diameters at both ends and its material, a disk its node, mass and inertias, all in SI. Bearings and seals of the
file are left out: frb has its own. A ROSS shaft element may be a cone; it becomes a few cylinders.
"""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, get_args

from frbcli.case.quantities import Density, Inertia, InnerDiameter, Length, Mass, Modulus
from frbcli.case.reading.tables import Breach, table
from frbcli.case.reading.toml import TomlFault, parse
from frbcli.case.rotor import OF_SECTIONS
from frbcli.units import ValueFault

LARGEST_FILE = 4_194_304  # bytes
CYLINDERS = 4  # that stand for a cone
SHAFT, DISK = ("ShaftElement", "ShaftElement6DoF"), ("DiskElement", "DiskElement6DoF")
HEAVY = ("PointMass", "GearElement", "GearElementTVMS", "CouplingElement")  # have mass, but are no disks on the shaft
UNMODELLED = ("axial_force", "torque")

# What a case file demands of the same quantities.
QUANTITIES = {"L": Length, "odl": Length, "odr": Length, "idl": InnerDiameter, "idr": InnerDiameter, "rho": Density,
              "E": Modulus, "G_s": Modulus, "m": Mass, "Ip": Inertia, "Id": Inertia}  # fmt: skip
MOST_POISSON = 0.5 + 1e-6  # of an incompressible material

KEY = ("rotor", "file")
UNITS = {"length": "m", "diameter": "m", "inner_diameter": "m", "density": "kg/m^3", "youngs_modulus": "Pa",
         "position": "m", "mass": "kg", "polar_inertia": "kg*m^2", "diametral_inertia": "kg*m^2"}  # fmt: skip
REMEDY = "Correct it in ROSS; values are in SI units."
WRITE = "Write it with Rotor.save of ROSS."


class _Unread(Exception):
    """Problem and remedy of a file that cannot be read."""


def with_rotor_file(data: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Breach]]:
    """The tables of a case with shaft and disks of its rotor.file in place of that key, and its faults.

    folder: that a relative path counts from. A [[disk]] of the case with the name of one of the file's completes it,
    e.g. by an unbalance; others come in addition. With faults the tables are returned unchanged.
    """
    rotor = table(data, "rotor")
    name = rotor.get("file")
    if rotor.get("kind") not in OF_SECTIONS or not isinstance(name, str) or not name:
        return data, []
    if "shaft" in data:
        return data, [Breach(KEY, "is given beside [[shaft]].", "Keep one of the two.")]
    try:
        shaft, disks = _rotor(_read(folder / name))
    except _Unread as fault:
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


def _read(path: Path) -> dict[str, Any]:
    try:
        if not path.is_file():
            raise _Unread("names no file.", "Give its path from the folder of the case.")
        if path.stat().st_size > LARGEST_FILE:
            raise _Unread(f"is larger than {LARGEST_FILE // 1_048_576} MiB.", "Name a rotor file of ROSS.")
        text = path.read_text(encoding="utf-8-sig")
        data = json.loads(text) if path.suffix.lower() == ".json" else parse(text)
    except OSError as error:
        raise _Unread(f"cannot be read: {error.strerror or error}.", "Check path and permissions.") from None
    except TomlFault as error:
        where = "" if error.fault.line is None else f" in line {error.fault.line}"
        raise _Unread(f"is neither TOML nor JSON{where}: it {error.fault.problem}", WRITE) from None
    except (ValueError, RecursionError):
        raise _Unread("is neither TOML nor JSON.", "Write it with Rotor.save of ROSS, to .toml or .json.") from None
    if not isinstance(data, dict):
        raise _Unread("holds no elements.", WRITE)
    return data


def _rotor(data: Mapping[str, Any]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The tables [[shaft]] and [[disk]] of a file's elements."""
    elements = [(name, name.split("_")[0], element) for name, element in data.items() if isinstance(element, dict)]
    for name, kind, _ in elements:
        if kind in HEAVY:
            raise _Unread(f'has the element "{name}", which frb does not model.', "Replace it by a disk in ROSS.")
    shaft = sorted((_Element(name, element) for name, kind, element in elements if kind in SHAFT), key=_node)
    if not shaft:
        raise _Unread("has no shaft elements.", WRITE)
    for place, element in enumerate(shaft):
        if _node(element) != place:
            problem = f'has "{element.name}" where the element from node {place} belongs; layers are not modelled.'
            raise _Unread(problem, "Number nodes from 0, with one shaft element after each.")
    positions = list(itertools.accumulate((element.number("L") for element in shaft), initial=0.0))
    cylinders = [cylinder for element in shaft for cylinder in _cylinders(element)]
    disks = [_disk(_Element(name, element), positions) for name, kind, element in elements if kind in DISK]
    shaft_tables = [_joined(alike) for alike in _runs(cylinders)]
    return [_with_units(section) for section in shaft_tables], [_with_units(disk) for disk in disks]


def _with_units(found: dict[str, Any]) -> dict[str, Any]:
    """A table with units, so that SI values of the file do not look like numbers without a unit."""
    return {key: f"{value!r} {UNITS[key]}" if key in UNITS else value for key, value in found.items()}


class _Element:
    """An element of the file and its values."""

    def __init__(self, name: str, values: Mapping[str, Any]) -> None:
        self.name, self.values = name, values

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number, and of what a case file has a quantity for, one that it would take."""
        found = self.values.get(key, default)
        if isinstance(found, bool) or not isinstance(found, int | float):
            raise _Unread(f'lacks a number "{key}" in "{self.name}".', WRITE)
        try:
            value = float(found)
        except OverflowError:  # a whole number of hundreds of digits
            value = math.inf
        if not math.isfinite(value):
            raise _Unread(f'has a "{key}" in "{self.name}" that is no finite number.', REMEDY)
        if key in QUANTITIES:
            try:
                get_args(QUANTITIES[key])[1].read(value)
            except ValueFault as fault:
                raise _Unread(f'has a "{key}" in "{self.name}" that {fault.problem}', REMEDY) from None
        return value


def _node(element: _Element) -> float:
    return element.number("n")


def _cylinders(element: _Element) -> Iterator[dict[str, Any]]:
    """Tables of [[shaft]] for a shaft element."""
    for key in UNMODELLED:
        if element.number(key, 0.0) != 0.0:
            raise _Unread(f'has a {key} in "{element.name}", which frb does not model.', "Set it to 0 in ROSS.")
    outer, inner = element.number("odl"), element.number("idl")
    growth = element.number("odr", outer) - outer, element.number("idr", inner) - inner
    if inner >= outer or inner + growth[1] >= outer + growth[0]:
        raise _Unread(f'has no thickness in "{element.name}": the inner diameter is not below the outer one.', REMEDY)
    material = _Element(f"{element.name}.material", table(element.values, "material"))
    modulus = material.number("E")
    poisson = modulus / (2 * material.number("G_s")) - 1
    if not 0.0 <= poisson <= MOST_POISSON:
        raise _Unread(f'has E and G_s in "{material.name}" that make a Poisson ratio of {poisson:.3g}.', REMEDY)
    parts = CYLINDERS if any(growth) else 1
    for part in range(parts):
        middle = (part + 0.5) / parts
        yield {
            "length": element.number("L") / parts,
            "diameter": outer + middle * growth[0],
            "inner_diameter": inner + middle * growth[1],
            "density": material.number("rho"),
            "youngs_modulus": modulus,
            "poisson_ratio": poisson,
        }


def _runs(cylinders: list[dict[str, Any]]) -> Iterator[list[dict[str, Any]]]:
    """Neighbours that differ in their lengths only."""
    for _, run in itertools.groupby(cylinders, lambda cylinder: {**cylinder, "length": 0.0}):
        yield list(run)


def _joined(alike: list[dict[str, Any]]) -> dict[str, Any]:
    return {**alike[0], "length": sum(cylinder["length"] for cylinder in alike)}


def _disk(element: _Element, positions: list[float]) -> dict[str, Any]:
    node = element.number("n")
    if node not in range(len(positions)):
        raise _Unread(f'has "{element.name}" beyond the shaft.', WRITE)
    tag = element.values.get("tag") or element.name
    polar, diametral = element.number("Ip"), element.number("Id")
    if polar > 2 * diametral * (1 + 1e-9):
        raise _Unread(f'has an Ip in "{element.name}" of more than twice Id, which is not possible.', REMEDY)
    return {
        "name": re.sub(r"[^A-Za-z0-9_-]", "-", str(tag))[:40],
        "position": positions[int(node)],
        "mass": element.number("m"),
        "polar_inertia": polar,
        "diametral_inertia": diametral,
    }
