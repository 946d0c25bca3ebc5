"""The times of measured samples, and signals at even steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from frbcli.arrays import Array
from frbcli.results.measured.columns import Columns, wrong_file

UNEVEN = 1e-3  # of the step, by which times may be off it; beyond this the signals are interpolated to even steps
# A step may differ from the median one by this share of it. What is further apart has lost samples between: what moves
# there is not known, and what was sampled slower than elsewhere would show with wrong frequencies.
JITTER = 0.5


def times(columns: Columns, name: str, time: Array) -> Array:
    """The times (n,) in s of a column. Raises InputError if they do not rise, or have gaps."""
    steps = np.diff(time)
    if not np.all(steps > 0.0):
        place = int(np.argmin(steps > 0.0)) + 1
        problem = f'has times in "{name}" that do not rise at {columns.row(place)}.'
        raise wrong_file(columns.path, problem, "Sort the rows by time, or give --rate in place of --time.")
    usual = float(np.median(steps))
    off = np.abs(steps - usual)
    place = int(np.argmax(off))
    if off[place] > JITTER * usual:
        found = f"has a step of {steps[place]:.4g} s"
        problem = f'{found} in "{name}" before {columns.row(place + 1)}, and else of {usual:.4g} s.'
        raise wrong_file(
            columns.path, problem, "Cut the file there; if no sample is missing, give --rate in place of --time."
        )
    return time


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
