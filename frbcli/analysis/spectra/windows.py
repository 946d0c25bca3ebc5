"""Hann windows, and lengths that are transformed fast."""

from __future__ import annotations

import numpy as np

from frbcli.arrays import Array

FACTORS = (2, 3, 5)


def hann(length: int) -> Array:
    """(n,) values of a Hann window that repeats after its length."""
    return np.asarray(0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length))


def fast_length(least: int) -> int:
    """The least length of at least so much whose prime factors are 2, 3 and 5."""
    length = least
    while True:
        rest = length
        for factor in FACTORS:
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length += 1
