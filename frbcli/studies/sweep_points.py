"""The points of a sweep: from values for each key, from a list, or from distributions of keys that scatter, to settings
of one case each.

The samples of distributions are a scrambled Sobol sequence (Owen 1998, as in scipy.stats.qmc), which fills the space of
the keys more evenly than random ones. Correlated keys are joined by a Gaussian copula: normal variables with the
correlations given are turned into shares, and these into values of each distribution.
"""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import Fault, InputError, input_error
from frbcli.results.write import Unreadable, text_of

Settings = dict[str, str]  # key of the case -> value as text, as `--set` takes it

SOURCE = "sweep"
MOST_POINTS, MOST_KEYS = 100_000, 1000
LARGEST_LIST = 64 * 1024**2  # bytes of the file of a list
OPENING, CLOSING, QUOTES = "([{", ")]}", "\"'"
LINK = ";"  # between keys of one setting that change together
MOST_IN_RANGE = 10_000
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({NUMBER})\s*(.*?)\s*\.\.\s*({NUMBER})\s*(.*?)\s*/\s*(\d{{1,9}})")
Correlations = Mapping[tuple[str, str], float]

FORMS = {"normal": "mean, deviation", "uniform": "low, high", "truncated": "mean, deviation, low, high"}
EXAMPLE = '"bearing.clearance=normal(35 um, 1 um)"'
MOST_SAMPLES = 2**16
DIGITS = 10
_CALL = re.compile(r"(\w+)\s*\((.*)\)")
_VALUE = re.compile(rf"({NUMBER})\s*(.*?)")


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


@dataclass(frozen=True)
class Distribution:
    """How a key scatters, in `unit`. form: one of FORMS; mean, deviation: of the normal distribution, that is cut off
    at low and high if it is truncated; low, high: of a uniform one."""

    key: str
    form: str
    unit: str
    mean: float = 0.0
    deviation: float = 0.0
    low: float = -np.inf
    high: float = np.inf

    def at(self, shares: Array) -> Array:
        """(n,) values below which shares (n,), between 0 and 1, of all values lie."""
        from scipy.special import ndtr, ndtri

        if self.form == "uniform":
            return np.asarray(self.low + shares * (self.high - self.low))
        below, upto = (ndtr((limit - self.mean) / self.deviation) for limit in (self.low, self.high))
        values = self.mean + self.deviation * ndtri(below + shares * (upto - below))
        return np.asarray(np.clip(values, self.low, self.high))


def read_distribution(key: str, text: str) -> Distribution | None:
    """The distribution in a text such as "normal(35 um, 1 um)", "normal(35 um, 3 %)", "uniform(30 um, 40 um)" or
    "truncated(35 um, 1 um, 33 um, 37 um)"; None if it is no distribution. Raises InputError for a faulty one."""
    call = _CALL.fullmatch(text.strip())
    if call is None:
        return None
    form, inside = call.groups()
    if form not in FORMS:
        return None
    read = [_VALUE.fullmatch(value) for value in split_values(inside)]
    wanted = FORMS[form].split(", ")
    if len(read) != len(wanted) or None in read:
        raise refused(key, text, "is not of its form.", f"Write {form}({FORMS[form]}), e.g. {EXAMPLE}.")
    given = dict(zip(wanted, ((float(one[1]), one[2].strip()) for one in read if one), strict=True))
    if given.get("deviation", (0.0, ""))[1] == "%":
        mean, unit = given["mean"]
        given["deviation"] = (0.01 * given["deviation"][0] * abs(mean), unit)
    units = {unit for _, unit in given.values()}
    if len(units) > 1:
        raise refused(key, text, "has several units.", "Write all of its numbers in one unit; a deviation may be in %.")
    distribution = Distribution(key, form, units.pop(), **{name: number for name, (number, _) in given.items()})
    if not distribution.low < distribution.high:
        raise refused(key, text, "has a lower limit that is not below the upper one.", "Exchange or correct them.")
    if form != "uniform" and not distribution.deviation > 0.0:
        raise refused(key, text, "has a deviation that is not above 0.", f"Write e.g. {EXAMPLE}.")
    return distribution


def samples(
    distributions: Sequence[Distribution], count: int = 64, correlations: Correlations | None = None, seed: int = 0
) -> tuple[Settings, ...]:
    """`count` points, a power of 2, of keys that scatter.

    correlations: between -1 and 1, by pairs of keys, of the normal variables beneath; 0 where none is given. seed: of
    the scrambling. Raises InputError for a count that is no power of 2, a seed below 0, keys that do not scatter, and
    correlations that contradict each other.
    """
    from scipy.special import ndtr, ndtri
    from scipy.stats.qmc import Sobol

    keys = [one.key for one in distributions]
    if count < 2 or count > MOST_SAMPLES or count & (count - 1):
        near = min(MOST_SAMPLES, 1 << max(1, count - 1).bit_length())
        raise refused("--samples", str(count), "is not a power of 2, as a Sobol sequence needs.", f"Write {near}.")
    if seed < 0:
        raise refused("--seed", str(seed), "is below 0.", "Write a whole number from 0 on.")
    factor = _factor(keys, correlations or {})
    shares = Sobol(len(keys), scramble=True, seed=seed).random(count)
    inner = np.clip(shares, 2.0**-33, 1.0 - 2.0**-33)  # 0 would lie at minus infinity
    joined = ndtr(ndtri(inner) @ factor.T) if correlations else inner
    columns = [one.at(joined[:, place]) for place, one in enumerate(distributions)]
    return checked(
        {one.key: f"{value:.{DIGITS}g} {one.unit}".rstrip() for one, value in zip(distributions, row, strict=True)}
        for row in zip(*columns, strict=True)
    )


def read_correlation(text: str) -> tuple[tuple[str, str], float]:
    """The pair of keys and the number in "KEY,KEY=0.5". Raises InputError if it is none."""
    keys, _, number = text.partition("=")
    pair = tuple(key.strip() for key in keys.split(","))
    try:
        value = float(number)
    except ValueError:
        value = np.nan
    if len(pair) != 2 or not all(pair) or not -1.0 < value < 1.0:
        remedy = "Write KEY,KEY=NUMBER with a number between -1 and 1, e.g. a.clearance,b.clearance=0.8."
        raise refused("--correlation", text, "is no correlation of two keys.", remedy)
    return (pair[0], pair[1]), value


def _factor(keys: Sequence[str], correlations: Correlations) -> Array:
    """Lower triangle L with L L^T = the correlations."""
    matrix = np.eye(len(keys))
    for (one, other), value in correlations.items():
        strange = [key for key in (one, other) if key not in keys]
        if strange or one == other:
            named = strange[0] if strange else one
            remedy = f"Name two of: {', '.join(keys)}."
            problem = f"names {named}, which does not scatter too."
            raise refused("--correlation", f"{one},{other}", problem, remedy)
        matrix[keys.index(one), keys.index(other)] = matrix[keys.index(other), keys.index(one)] = value
    try:
        return np.asarray(np.linalg.cholesky(matrix))
    except np.linalg.LinAlgError:
        remedy = "Make them smaller, or give all other pairs too."
        raise refused("--correlation", "", "contradict each other: no variables have all of them.", remedy) from None
