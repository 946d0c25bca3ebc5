"""Columns of numbers out of a CSV file that a case names, with a line of their names above."""

from __future__ import annotations

import csv
import math
from pathlib import Path

from frbcli.case.quantities import LARGEST

LARGEST_FILE = 4_194_304  # bytes
SI = "Correct it; values are in SI units."

Columns = dict[str, list[float]]


class Refused(Exception):
    """Problem and remedy of a file that cannot be read."""


def text_of(path: Path, meant: str, write: str) -> str:
    """The text of a file; meant: what it should be; write: the remedy for what is no text. Raises Refused."""
    try:
        if not path.is_file():
            raise Refused("names no file.", "Give its path from the folder of the case.")
        if path.stat().st_size > LARGEST_FILE:
            raise Refused(f"is larger than {LARGEST_FILE // 1_048_576} MiB.", f"Name {meant}.")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise Refused(f"cannot be read: {error.strerror or error}.", "Check path and permissions.") from None
    except ValueError:
        raise Refused("is no UTF-8 text.", write) from None


def number_table(text: str, names_told: str) -> Columns:
    """The columns of a text by their names; names_told: the remedy for wrong names. Raises Refused."""
    rows = [row for row in csv.reader(text.splitlines()) if any(cell.strip() for cell in row)]
    if not rows:
        raise Refused("is empty.", names_told)
    names = [cell.strip() for cell in rows[0]]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise Refused(f'has the column "{twice}" twice.', names_told)
    columns: Columns = {name: [] for name in names}
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise Refused(f"has {len(row)} values in row {number} of numbers, not {len(names)}.", "Complete the row.")
        for name, cell in zip(names, row, strict=True):
            columns[name].append(finite(cell, name, number))
    return columns


def finite(given: object, name: str, row: int) -> float:
    """A finite number that a case would take. Raises Refused."""
    try:
        if isinstance(given, bool) or not isinstance(given, str | int | float):
            raise ValueError
        value = float(given)
    except (ValueError, OverflowError):
        raise Refused(f'has no number as {row}. value of "{name}".', SI) from None
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise Refused(f'has a {row}. value of "{name}" that is no finite number within {LARGEST:g}.', SI)
    return value
