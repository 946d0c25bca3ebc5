"""The tables of a case file as the user wrote them, and the breaches that the rules find in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from frbcli.case.reading.lines import Path
from frbcli.units import ValueFault, quantity

RINGED = ("floating-ring", "cartridge")  # kinds of bearings with an inner and an outer film


@dataclass(frozen=True)
class Breach:
    """A rule that is broken: the key to change, the problem, and the remedy."""

    path: Path
    problem: str
    remedy: str


def tables(data: Mapping[str, Any], key: str) -> list[tuple[Path, dict[str, Any]]]:
    """The tables of [key] or [[key]] with their paths."""
    entry = data.get(key)
    if isinstance(entry, dict):
        return [((key,), entry)]
    many = enumerate(entry) if isinstance(entry, list) else ()
    return [((key, index), item) for index, item in many if isinstance(item, dict)]


def table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The table [key], empty if there is none."""
    entry = data.get(key)
    return entry if isinstance(entry, dict) else {}


def at(data: Any, path: Path) -> Any:
    """What stands at a path of nested tables and lists, None where nothing does."""
    for element in path:
        if isinstance(element, int):
            data = data[element] if isinstance(data, list) and element < len(data) else None
        else:
            data = data.get(element) if isinstance(data, dict) else None
    return data


def replaced(data: Any, path: Path, value: Any) -> Any:
    """`data` with another value at a path that it has."""
    if not path:
        return value
    changed: Any = list(data) if isinstance(data, list) else dict(data)
    changed[path[0]] = replaced(data[path[0]], path[1:], value)
    return changed


Located = tuple[Path, dict[str, Any]]  # a table with its path


def ring_films(bearing: Mapping[str, Any]) -> list[tuple[Located, Located]]:
    """The tables of the inner and outer film of a ring, with their paths in the table of its bearing; two pairs where a
    cartridge has other films at each end; none of a bearing without a ring."""
    if bearing.get("kind") not in RINGED:
        return []
    inner, outer = (tables(bearing, side) or [((side,), {})] for side in ("inner", "outer"))
    count = max(len(inner), len(outer))
    return [(inner[min(end, len(inner) - 1)], outer[min(end, len(outer) - 1)]) for end in range(count)]


def number(values: Mapping[str, Any], key: str, unit: str, default: float | None = None) -> float | None:
    """The SI value of a key; `default` where it is absent, None where it cannot be read."""
    if key not in values:
        return default
    try:
        return quantity(values[key], unit)
    except ValueFault:
        return None
