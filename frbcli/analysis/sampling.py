"""Times of measured samples: which rise, which are even but rounded, and signals at even steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from frbcli.arrays import Array
from frbcli.results.measured.columns import Columns, wrong_file

UNEVEN = 1e-3  # of the step, by which times may be off it; beyond this the signals are interpolated to even steps
# A step may differ from the median one by this share of it. What is further apart has lost samples between: what moves
# there is not known, and what was sampled slower than elsewhere would show with wrong frequencies.
JITTER = 0.5
MOST_DECIMALS = 9
EXACT = 1e-3  # of a last decimal place, by which a rounded number may be off it
ROUNDED = 0.55  # of a last decimal place: rounding moves a time by half of it, and the fitted line a little
COARSEST = 2.5  # times a step, which the last decimal place may be
RARE = 3.0  # times the usual interval of a slow channel: a longer one is a gap


def require_rising(columns: Columns, name: str, time: Array) -> Array:
    """The times (n,) in s of a column; those that are even but rounded to few decimals are made even. Raises InputError
    if they do not rise, or have gaps."""
    even = _even_but_rounded(time)
    if even is not None:
        return even
    steps = np.diff(time)
    if not np.all(steps > 0.0):
        place = int(np.argmin(steps > 0.0)) + 1
        problem = f'has times in "{name}" that do not rise at {columns.row(place)}.'
        raise wrong_file(columns.path, problem, "Sort the rows by time, or give --rate instead of --time.")
    usual = float(np.median(steps))
    off = np.abs(steps - usual)
    place = int(np.argmax(off))
    if off[place] > JITTER * usual:
        irregular = f"has a step of {steps[place]:.4g} s"
        problem = f'{irregular} in "{name}" before {columns.row(place + 1)}, and else of {usual:.4g} s.'
        raise wrong_file(
            columns.path, problem, "Cut the file there; if no sample is missing, give --rate instead of --time."
        )
    return time


def _even_but_rounded(time: Array) -> Array | None:
    """Even times (n,) from which the given ones (n,) differ by no more than the rounding of their last decimal place;
    None if they are exact, or uneven, or rounded to more than a step."""
    count = len(time)
    if count < 3 or not time[-1] > time[0]:
        return None
    number = np.arange(count)
    step, begin = np.polynomial.polynomial.polyfit(number, time - time[0], 1)[::-1]
    even = time[0] + begin + step * number
    off = float(np.max(np.abs(time - even)))
    if off <= UNEVEN * step:
        return None
    for decimals in range(MOST_DECIMALS + 1):
        unit = 10.0**-decimals
        scaled = time / unit
        if np.max(np.abs(scaled - np.round(scaled))) <= max(EXACT, 4.0 * np.spacing(np.max(np.abs(scaled)))):
            return even if off <= ROUNDED * unit and unit <= COARSEST * step else None
    return None


def sampled_at(time: Array, columns: Columns, name: str, own: Array, values: Array) -> Array:
    """A slow channel (m,), NaN where it has no value, at the times (n,) in s, by straight lines between its values.

    own: the times (m,) in s of its values, NaN at gaps. Raises InputError if both have unequal lengths, if the channel
    has gaps among its values, or if it does not reach over the times.
    """
    if len(own) != len(values):
        problem = f'has {len(values)} values in "{name}" and {len(own)} times.'
        raise wrong_file(columns.path, problem, "Give --speed-time COLUMN, the times of the rotor speed.")
    known = np.flatnonzero(np.isfinite(values) & np.isfinite(own))
    if own is time and len(known) == len(time):
        return values
    if len(known) < 2:
        raise wrong_file(columns.path, f'has fewer than two numbers in "{name}".', "Choose another column.")
    moments, values_there = own[known], values[known]
    steps = np.diff(moments)
    if not np.all(steps > 0.0):
        place = int(known[int(np.argmin(steps > 0.0)) + 1])
        raise wrong_file(columns.path, f'has times of "{name}" that do not rise at {columns.row(place)}.', "Sort them.")
    longest = RARE * float(np.median(steps))
    missing = np.flatnonzero(steps > longest)
    if len(missing):
        place = int(known[missing[0]]) + 1
        problem = f'has no number in {columns.row(place)} of the column "{name}".'
        raise wrong_file(columns.path, problem, "Leave such rows out.")
    if moments[0] - time[0] > longest or time[-1] - moments[-1] > longest:
        problem = f'has numbers in "{name}" from {moments[0]:.4g} s to {moments[-1]:.4g} s alone.'
        remedy = f"Cut the file to these times; it lasts from {time[0]:.4g} to {time[-1]:.4g} s."
        raise wrong_file(columns.path, problem, remedy)
    return np.asarray(np.interp(time, moments, values_there))


def even_steps(time: Array, signals: Mapping[str, Array]) -> dict[str, Array]:
    """Times (m,) at even steps and signals (m,) at them. Where the times (n,) are uneven, the steps are as short as the
    shortest one, so that nothing is sampled coarser than before, and signals are interpolated by cubic splines."""
    step = (time[-1] - time[0]) / (len(time) - 1)
    even = time[0] + step * np.arange(len(time))
    if np.max(np.abs(even - time)) < UNEVEN * step:
        return {"time_s": even, **signals}
    from scipy.interpolate import CubicSpline

    count = int(np.ceil((time[-1] - time[0]) / float(np.min(np.diff(time))))) + 1
    even = np.linspace(time[0], time[-1], count)
    return {"time_s": even, **{name: CubicSpline(time, values)(even) for name, values in signals.items()}}
