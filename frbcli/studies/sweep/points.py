"""The points of a sweep: from values for each key, or from a list, to settings of one case each."""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from frbcli.errors import Fault, InputError, input_error
from frbcli.results.files.named import Unreadable, text_of

Settings = dict[str, str]  # key of the case -> value as text, as `--set` takes it

SOURCE = "sweep"
MOST_POINTS, MOST_KEYS = 100_000, 1000
LARGEST_LIST = 64 * 1024**2  # bytes of the file of a list
OPENING, CLOSING, QUOTES = "([{", ")]}", "\"'"
LINK = ";"  # between keys of one setting that change together
MOST_IN_RANGE = 10_000
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({NUMBER})\s*(.*?)\s*\.\.\s*({NUMBER})\s*(.*?)\s*/\s*(\d{{1,9}})")


def read_values(text: str) -> tuple[str, ...]:
    """The values of a key, as `split_values`, with ranges written out: "10..20 um / 6" is six values from 10 um to 20
    um. Raises InputError for a range of one value."""
    return tuple(value for written in split_values(text) for value in _written_out(written))


def _written_out(value: str) -> tuple[str, ...]:
    match = _RANGE.fullmatch(value)
    if match is None:
        return (value,)
    low, low_unit, high, high_unit, count = match.groups()
    if low_unit and low_unit != high_unit:
        raise refused("--set", "", f"{value}: has two units.", f"Write {low}..{high} {low_unit} / 6.")
    if not 2 <= int(count) <= MOST_IN_RANGE or math.isinf(float(low)) or math.isinf(float(high)):
        problem = f"{value}: is not a range of 2 to {MOST_IN_RANGE} values."
        raise refused("--set", "", problem, f"Write e.g. {low}..{high} {high_unit} / 6.")
    return tuple(f"{number:.10g} {high_unit}".rstrip() for number in np.linspace(float(low), float(high), int(count)))


def linked(axes: Mapping[str, Sequence[str]]) -> tuple[Settings, ...]:
    """The points of keys that change together: the first values of all, the second ones, and so on. Raises InputError
    if they have different numbers of values."""
    counts = {key: len(values) for key, values in axes.items()}
    if len(set(counts.values())) > 1:
        counted = ", ".join(f"{key} has {count}" for key, count in counts.items())
        problem = f"are linked, and have different numbers of values: {counted}."
        raise refused(", ".join(axes), "", problem, "Give each as many values.")
    return tuple(dict(zip(axes, values, strict=True)) for values in zip(*axes.values(), strict=True))


def split_values(text: str, mark: str = ",") -> tuple[str, ...]:
    """The values between the commas, or other marks, of `text`; those in quotes and brackets do not separate."""
    values, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in QUOTES:
            quote = letter
        depth += 0 if quote else (letter in OPENING) - (letter in CLOSING)
        if letter == mark and not quote and depth == 0:
            values.append("")
        else:
            values[-1] += letter
    return tuple(value.strip() for value in values)


def grid(axes: Mapping[str, Sequence[object]]) -> tuple[Settings, ...]:
    """Every combination of the values of all keys; the last key changes fastest. Raises InputError if there is none."""
    empty = [key for key, values in axes.items() if not values]
    if empty:
        faults = (Fault(key, "", None, "has no value.", f"Write e.g. {key}=1,2.") for key in empty)
        raise InputError(SOURCE, tuple(faults))
    return checked(
        dict(zip(axes, values, strict=True)) for values in itertools.product(*(_texts(axis) for axis in axes.values()))
    )


def product(points: Iterable[Mapping[str, str]], others: Iterable[Mapping[str, str]]) -> tuple[Settings, ...]:
    """Each of `points` with each of `others`. Raises InputError for a key that both set."""
    points, others = list(points), list(others)
    twice = {key for point in points for key in point} & {key for other in others for key in other}
    if twice:
        remedy = "Set it in the list or by --set."
        raise InputError(SOURCE, tuple(Fault(key, "", None, "is set twice.", remedy) for key in sorted(twice)))
    return checked({**point, **other} for point in points for other in others)


def checked(points: Iterable[Mapping[str, object]]) -> tuple[Settings, ...]:
    """`points` with values as text. Raises InputError if there are none, or too many."""
    settings = tuple(
        dict(zip(point, _texts(point.values()), strict=True)) for point in itertools.islice(points, MOST_POINTS + 1)
    )
    if not settings or not any(settings):
        raise refused("--set", "", "leaves nothing to change.", "Write e.g. --set key=v1,v2.")
    if len(settings) > MOST_POINTS:
        raise refused("--set", "", f"makes more than {MOST_POINTS} points.", "Take fewer values.")
    return settings


def read_list(path: str | Path) -> tuple[Settings, ...]:
    """The points of a CSV file: the keys in its first line, a point in each other; an empty cell sets nothing.

    Raises InputError for a file that cannot be read or has a line that does not fit its first one.
    """
    try:
        text = text_of(Path(path), LARGEST_LIST)
        rows = [(line, row) for line, row in enumerate(csv.reader(text.splitlines(), strict=True), 1) if any(row)]
    except Unreadable as error:
        raise _list_error(path, None, str(error)) from None
    except csv.Error as error:
        raise _list_error(path, None, f"cannot be read: {error}.") from None
    if len(rows) < 2:
        raise _list_error(path, None, "holds no points.")
    head_line, head = rows[0][0], [key.strip() for key in rows[0][1]]
    if len(head) > MOST_KEYS:
        raise _list_error(path, head_line, f"has {len(head)} columns, more than {MOST_KEYS}.")
    if not all(head) or len(set(head)) < len(head):
        raise _list_error(path, head_line, "does not name every column once.")
    for line, row in rows[1:]:
        if len(row) != len(head):
            raise _list_error(path, line, f"has {len(row)} values for {len(head)} keys.")
    return checked(
        {key: value.strip() for key, value in zip(head, row, strict=True) if value.strip()} for _, row in rows[1:]
    )


def _texts(values: Iterable[object]) -> list[str]:
    """Values as a setting takes them: TOML writes booleans in small letters."""
    return [str(value).lower() if isinstance(value, bool) else str(value) for value in values]


def refused(key: str, value: str, problem: str, remedy: str, line: int | None = None) -> InputError:
    """The error of a setting of a sweep."""
    return input_error(SOURCE, key, value, problem, remedy, line)


def _list_error(path: str | Path, line: int | None, problem: str) -> InputError:
    return refused("--list", str(path), problem, "First line: keys; each further line: a value for each.", line)
