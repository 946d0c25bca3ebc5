"""Statistics of a sweep over samples of machines: percentiles, sensitivities, the share that whirls."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import input_error
from frbcli.linear.stability_point import STABLE, UNSTABLE
from frbcli.results.records import WHOLE
from frbcli.studies.sweep.points import NUMBER
from frbcli.studies.sweep.sweep import Sweep
from frbcli.studies.sweep.workers import NO_WHIRL, ONSET, THRESHOLD, SweepPoint

PERCENTS = (5.0, 25.0, 50.0, 75.0, 95.0)
SURE = 1.959964  # standard deviations of an interval of 95 %
FEWEST = 8  # machines with a whirl, for sensitivities
_LEADING = re.compile(rf"\s*({NUMBER})")


@dataclass(frozen=True)
class Sensitivity:
    """rank: Spearman's correlation of a key with the speed; per_deviation_Hz: change of the speed in Hz with one
    standard deviation of the key, by least squares, the other keys unchanged."""

    key: str
    rank: float
    per_deviation_Hz: float


@dataclass(frozen=True)
class Scatter:
    """Statistics of the machines of a sweep whose result is known.

    count: these machines, left_out: the others; speeds_Hz: (count,) ascending rotor speed at which each begins to
    whirl, 0 for one that whirls from the lowest speed on, infinite for one that does not up to the highest;
    percentiles: percent and speed in Hz; sensitivities: of the keys, empty where fewer than FEWEST machines whirl;
    explained: share of the variance that the linear sensitivities explain; below_Hz, share: a speed, and the
    share of machines that begin to whirl below it; interval: 95 % interval of this share (Wilson 1927), as for
    random samples.
    """

    count: int
    left_out: int
    speeds_Hz: Array
    percentiles: tuple[tuple[float, float], ...]
    sensitivities: tuple[Sensitivity, ...]
    explained: float
    below_Hz: float
    share: float
    interval: tuple[float, float]


def scatter(swept: Sweep, below_Hz: float | None = None) -> Scatter:
    """The scatter of the speeds at which the points of a sweep begin to whirl; below_Hz: default the case's highest
    speed. Raises InputError if no point has a known result."""
    speeds = np.array([whirl_speed(point) for point in swept.points])
    known = ~np.isnan(speeds)
    if not known.any():
        remedy = "The table gives the reason for each machine."
        raise input_error("sweep", "--set", "", "no machine has a result.", remedy)
    ordered = np.sort(speeds[known])
    limit = max(abs(swept.case.speed.start), abs(swept.case.speed.end)) if below_Hz is None else below_Hz
    share = float(np.mean(ordered < limit))
    places = np.minimum(np.ceil(0.01 * np.array(PERCENTS) * len(ordered)).astype(int), len(ordered)) - 1
    percentiles = tuple(zip(PERCENTS, ordered[places].tolist(), strict=True))
    sensitivities, explained = _sensitivities(swept, speeds)
    return Scatter(
        count=len(ordered),
        left_out=int(np.count_nonzero(~known)),
        speeds_Hz=ordered,
        percentiles=percentiles,
        sensitivities=sensitivities,
        explained=explained,
        below_Hz=limit,
        share=share,
        interval=_wilson(share, len(ordered)),
    )


def whirl_speed(point: SweepPoint) -> float:
    """The speed in Hz at which a machine begins to whirl, 0 from the lowest speed on, infinite for none up to the
    highest, NaN where that is not known."""
    event = point.first(THRESHOLD) or point.first(ONSET)
    if event is not None:
        return float(event["speed_Hz"])
    if point.status not in WHOLE:
        return math.nan
    if point.message.startswith((STABLE, NO_WHIRL)):
        return math.inf
    return 0.0 if point.message.startswith(UNSTABLE) else math.nan


def _sensitivities(swept: Sweep, speeds: Array) -> tuple[tuple[Sensitivity, ...], float]:
    from scipy.stats import spearmanr

    whirls = np.isfinite(speeds) & (speeds > 0.0)
    columns = {key: _numbers(swept.points, key)[whirls] for key in swept.keys}
    varied = {key: column for key, column in columns.items() if len(column) and np.std(column) > 0.0}
    speed = speeds[whirls]
    if len(speed) < max(FEWEST, len(varied) + 2) or not varied or not np.std(speed) > 0.0:
        return (), math.nan
    standard = np.stack([(column - column.mean()) / column.std() for column in varied.values()], axis=1)
    slopes = np.linalg.lstsq(standard, speed - speed.mean(), rcond=None)[0]
    left = speed - speed.mean() - standard @ slopes
    explained = 1.0 - float(np.sum(left**2) / np.sum((speed - speed.mean()) ** 2))
    ranks = [float(spearmanr(column, speed).statistic) for column in varied.values()]
    rows = zip(varied, ranks, slopes.tolist(), strict=True)
    return tuple(Sensitivity(*row) for row in rows), explained


def _numbers(points: Sequence[SweepPoint], key: str) -> Array:
    read = (_LEADING.match(point.settings.get(key, "")) for point in points)
    return np.array([math.nan if one is None else float(one[1]) for one in read])


def _wilson(share: float, count: int) -> tuple[float, float]:
    """Interval of a share of `count` samples."""
    square = SURE**2 / count
    middle = (share + 0.5 * square) / (1.0 + square)
    half = SURE / (1.0 + square) * math.sqrt(share * (1.0 - share) / count + 0.25 * square / count)
    return max(0.0, middle - half), min(1.0, middle + half)
