"""Keys of a case that scatter: their distributions, and samples of them.

The samples are a scrambled Sobol sequence (Owen 1998, as in scipy.stats.qmc), which fills the space of the keys
more evenly than random ones. Correlated keys are joined by a Gaussian copula: normal variables with the correlations
given are turned into shares, and these into values of each distribution.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.studies.sweep.points import NUMBER, Settings, checked, refused, split_values

Correlations = Mapping[tuple[str, str], float]

FORMS = {"normal": "mean, deviation", "uniform": "low, high", "truncated": "mean, deviation, low, high"}
EXAMPLE = '"bearing.clearance=normal(35 um, 1 um)"'
MOST_SAMPLES = 2**16
DIGITS = 10
_CALL = re.compile(r"(\w+)\s*\((.*)\)")
_VALUE = re.compile(rf"({NUMBER})\s*(.*?)")


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
