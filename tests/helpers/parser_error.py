"""How exactly pandas reads a number with all its digits: since version 3 to the last bit, before to some 1e-13."""

from __future__ import annotations

import io
from functools import cache

import numpy as np
import pandas as pd


@cache
def parser_error() -> float:
    """The largest relative error of 10 000 numbers of all sizes, as measured here."""
    random = np.random.default_rng(0)
    values = random.normal(size=10_000) * 10.0 ** random.integers(-12, 4, 10_000)
    text = "\n".join(["a", *map(repr, values.tolist())])
    return float(np.abs(pd.read_csv(io.StringIO(text))["a"].to_numpy() / values - 1.0).max())
