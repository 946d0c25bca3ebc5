"""Files of the Python package ROSS, TOML or JSON, as its `Rotor.save` writes them: tables of elements, named by class
and tag, all in SI."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from frbcli.case.files.number_table import Refused, text_of
from frbcli.case.quantities import DampingRate, DampingTime, Density, Inertia, InnerDiameter, Length, Mass, Modulus
from frbcli.case.reading.toml import TomlFault, parse
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
