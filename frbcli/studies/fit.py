"""Numbers of a case from a measured run: least squares over the ridges and the onset of whirl.

The numbers vary by their logarithms, which makes them of one size and keeps them positive. Every group of residuals
(synchronous amplitude, frequency and amplitude of the whirl, onset) is divided by its scatter: at first by a share of
the ridge, so that a start from afar finds the way, then by the scatter of the measured ridge about its own smooth
course, judged by its second differences. The standard errors follow from the covariance (J^T J)^-1 of these residuals;
where the residuals scatter more than the measurement does, from their own scatter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from frbcli.analysis.resonance import Ridges, ridge_speeds, ridges
from frbcli.analysis.signals import bearing_clearance
from frbcli.analysis.spectrum import window_length
from frbcli.arrays import Array, Truths
from frbcli.case.reading.listing import machine_fault
from frbcli.case.reading.listing import values as listed
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, table_of
from frbcli.errors import Fault, FrbError, InputError, did_you_mean, input_error
from frbcli.results.records import SPEED, TIME
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.gate.gate import require

SPAN = 3.0  # factor by which a number may move either way, if no bounds are given
STEP = 0.01  # relative change of a number for its derivatives: above what steps and onsets scatter by
FIRST_SHARE = 0.05  # of the largest of a ridge: its scatter for the first way
LEAST_SHARE = 1e-3  # of the same: no ridge is known better
EDGE = 2  # speeds at both ends of the ridges
NEAR_ONSET = 1.5  # distances of the speeds: so near to the onset a ridge grows too fast to be compared
SECOND = 6.0  # variance of a second difference of independent numbers over theirs
SETTLED = 1e-3  # relative change of the numbers that ends a fit
LARGE = 1e3  # residuals of a case that cannot be run

Scatter = float | Array
Observer = Callable[[int, Mapping[str, float]], None]


@dataclass(frozen=True)
class Fitted:
    """One number. key: of the case; unit: SI; start, value, error: at first, found, its standard error; low, high: its
    bounds."""

    key: str
    unit: str
    start: float
    value: float
    error: float
    low: float
    high: float

    @property
    def at_bound(self) -> bool:
        """Whether it ended at one of its bounds, so that its error means nothing."""
        return min(self.value / self.low, self.high / self.value) < 1.0 + 10.0 * SETTLED


@dataclass(frozen=True, repr=False)
class Fit(Tabular):
    """case: with the numbers found; numbers: them; correlation: (k, k) of their errors; before, after: ridges of the
    run with the numbers at first and in the end, measured: of the measurement; runs: how many were made; chi:
    root mean square of the residuals over their scatter."""

    case: Case
    numbers: tuple[Fitted, ...]
    correlation: Array
    before: Ridges
    after: Ridges
    measured: Ridges
    runs: int
    chi: float

    def table(self) -> Table:
        """One row per number."""
        return table_of(FITTED, self.numbers)


def fit(
    case: Case, measurement: Run, keys: Sequence[str], bounds: Mapping[str, tuple[float, float]] | None = None,
    signal: str = "journal", observe: Observer | None = None,
) -> Fit:  # fmt: skip
    """Find numbers of a case with which its run-up agrees best with a measurement.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    measurement : Run
        A measured run, see `measured_run`.
    keys : sequence of str
        Numbers of the machine that are sought, such as "bearing.clearance".
    bounds : mapping, optional
        Lower and upper bound by key, in SI; by default a factor of 3 both ways.
    signal : str
        Point of the run: "journal", or the name of a bearing.
    observe : callable, optional
        Called with the number of each run and the numbers that it is made with.

    Returns
    -------
    Fit
        The numbers with standard errors and correlations, the case with them, ridges before and after.

    Raises
    ------
    InputError
        For a key that is no positive number of the machine, bounds that do not hold it, or a case that cannot be run;
        after the first runs for a number that the ridges do not depend on.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> given = frbcli.Measurement("x", clearance=35e-6, y="y", time="t", speed="n", unit_m=1e-6)
    >>> measured = frbcli.measured_run("measured.csv", given)  # doctest: +SKIP
    >>> found = frbcli.fit(case, measured, ["bearing.clearance"])  # doctest: +SKIP
    """
    from scipy.optimize import least_squares  # scipy.optimize takes longer to import than a plan to make

    require(case)
    numbers = _numbers(case, keys, bounds or {})
    with TemporaryDirectory(prefix="frb-fit-") as folder:
        trial = _Trial(case, measurement, numbers, signal, Path(folder) / "run.h5", observe)
        start = np.zeros(len(numbers))  # logarithms of the numbers over those at first
        limits = np.log([[n.low / n.start for n in numbers], [n.high / n.start for n in numbers]])
        before = trial.ridges(start)
        at = start
        for scatter in (_shares(trial.measured, measurement), _scatter(trial.measured, measurement)):
            at = least_squares(
                trial.residuals, at, trial.slopes, limits, x_scale=0.1, xtol=0.1 * SETTLED, ftol=1e-6,
                args=(scatter, limits),
            ).x  # fmt: skip
        after = trial.ridges(at)
        left = trial.residuals(at, scatter, limits)
        slopes = trial.slopes(at, scatter, limits)
    freedom = max(1, len(left) - len(keys))
    chi = math.sqrt(float(left @ left) / freedom)
    covariance = np.linalg.pinv(slopes.T @ slopes) * max(1.0, chi) ** 2
    errors = np.sqrt(np.diag(covariance))
    fitted = tuple(
        replace(n, value=n.start * math.exp(x), error=n.start * math.exp(x) * float(error))
        for n, x, error in zip(numbers, at, errors, strict=True)
    )
    correlation = covariance / np.outer(errors, errors)
    return Fit(trial.case_at(at), fitted, correlation, before, after, trial.measured, trial.count, chi)


class _Trial:
    """Runs of the case with other numbers, and how far their ridges are from the measured ones."""

    def __init__(
        self, case: Case, measurement: Run, numbers: Sequence[Fitted], signal: str, path: Path,
        observe: Observer | None,
    ) -> None:  # fmt: skip
        self._case, self._numbers, self._signal, self._path, self._observe = case, numbers, signal, path, observe
        speeds = ridge_speeds(measurement)
        low, high = sorted((abs(case.speed.start), abs(case.speed.end)))
        self._speeds = speeds[(speeds >= low) & (speeds <= high)]
        common = len(np.unique(self._speeds))  # one at a constant speed
        if common < 2 * len(numbers):
            problem = f"has {common} speeds in common with the case, which are too few."
            remedy = "Run the case up as it was measured."
            raise input_error(case.name, "--measured", "", problem, remedy)
        length = measurement.references["clearance_m"]
        self.measured = ridges(measurement, self._speeds, length)
        self.count = 0
        self._known: dict[tuple[float, ...], Ridges] = {}

    def case_at(self, x: Array) -> Case:
        """The case with the numbers at exp(x) times their first values."""
        settings = [f"{key}={value!r}" for key, value in self._values(x).items()]
        return self._case.with_settings(*settings)

    def _values(self, x: Array) -> dict[str, float]:
        return {n.key: n.start * math.exp(change) for n, change in zip(self._numbers, x.tolist(), strict=True)}

    def ridges(self, x: Array) -> Ridges:
        """The ridges of the run with these numbers. Raises FrbError if the run fails."""
        key = tuple(x.tolist())
        if key not in self._known:
            case = self.case_at(x)
            self.count += 1
            if self._observe is not None:
                self._observe(self.count, self._values(x))
            run = runup(case, self._path, force=True)
            if run.status == "interrupted":
                raise KeyboardInterrupt
            length = bearing_clearance(run, self._signal.partition("_")[2]) or next(iter(run.references.values()))
            self._known[key] = ridges(run, self._speeds, length, self._signal)
        return self._known[key]

    def residuals(self, x: Array, scatter: Sequence[Scatter], _: Array) -> Array:
        """Computed less measured ridges over their scatter; the limits matter to the slopes only."""
        try:
            computed = self.ridges(x)
        except FrbError:
            if not self._known:
                raise
            return np.full(sum(len(group) for group in _differences(self.measured, self.measured)), LARGE)
        groups = _differences(computed, self.measured)
        return np.concatenate([group / size for group, size in zip(groups, scatter, strict=True)])

    def slopes(self, x: Array, scatter: Sequence[Scatter], limits: Array) -> Array:
        """(r, k) derivatives of the residuals by x, central where the bounds leave room."""
        columns = []
        for number in range(len(x)):
            ahead, behind = x.copy(), x.copy()
            ahead[number] = min(x[number] + STEP, limits[1, number])
            behind[number] = max(x[number] - STEP, limits[0, number])
            change = self.residuals(ahead, scatter, limits) - self.residuals(behind, scatter, limits)
            if not change.any() and np.abs(self.residuals(x, scatter, limits)).max() < LARGE:
                problem = "changes nothing that is compared with the measurement: it cannot be found from it."
                key = self._numbers[number].key
                raise input_error(self._case.name, "--vary", key, problem, "Leave it out.")
            columns.append(change / (ahead[number] - behind[number]))
        return np.stack(columns, axis=1)


def _compared(measured: Ridges) -> tuple[Truths, Truths]:
    """(n,) at which speeds synchronous amplitudes and whirls are compared: below and above the measured onset, not
    close to it."""
    known = np.isfinite(measured.synchronous).all(axis=1)
    still, whirls = ~measured.whirls & known, measured.whirls & np.isfinite(measured.whirl_Hz)
    if not np.isfinite(measured.onset_Hz):
        return still, whirls
    apart = NEAR_ONSET * float(np.median(np.diff(measured.speed_Hz)))
    after = measured.speed_Hz - measured.onset_Hz
    return still & (after < -apart), whirls & (after > apart)


def _differences(computed: Ridges, measured: Ridges) -> list[Array]:
    """Computed less measured, by groups: synchronous amplitudes in m, frequencies in Hz and amplitudes in m of the
    whirl, the onset in Hz. A ridge that the computed run does not have there counts as nothing, except at the EDGE
    outermost speeds, which its windows may not reach: what is not known there is no difference."""
    still, whirls = _compared(measured)
    pairs = [
        (_reached(computed.synchronous, measured.synchronous)[still].ravel(), measured.synchronous[still].ravel()),
        (_reached(computed.whirl_Hz, measured.whirl_Hz)[whirls], measured.whirl_Hz[whirls]),
        (_reached(computed.whirl, measured.whirl)[whirls], measured.whirl[whirls]),
        (_onset(computed), _onset(measured)) if np.isfinite(measured.onset_Hz) else (np.zeros(0), np.zeros(0)),
    ]
    return [np.nan_to_num(mine) - other for mine, other in pairs]


def _reached(computed: Array, measured: Array) -> Array:
    """A computed ridge (n, ...) over the speeds; the measured one at the outermost ones that its windows miss."""
    filled, places = computed.copy(), np.arange(len(computed))
    known = np.flatnonzero(np.isfinite(computed.reshape(len(computed), -1)).all(axis=1))
    if len(known) and known[0] <= EDGE and known[-1] >= len(computed) - 1 - EDGE:
        outside = (places < known[0]) | (places > known[-1])
        filled[outside] = measured[outside]
    return filled


def _onset(computed: Ridges) -> Array:
    """(1,) Hz; of a run that does not whirl, its last speed."""
    return np.array([computed.onset_Hz if np.isfinite(computed.onset_Hz) else computed.speed_Hz[-1]])


def _reach(run: Run) -> float:
    """Change of the rotor speed within half a window, Hz: an onset is not known better."""
    time, speed = run[TIME], np.abs(run[SPEED])
    ramp = float(np.ptp(speed) / np.ptp(time))
    return max(0.5 * window_length(run.signal(TIME), run.signal(SPEED)) * ramp, LEAST_SHARE * float(speed.max()))


def _groups(measured: Ridges) -> list[Array]:
    """The measured ridges of the groups of _differences without the onset, in the order of the speeds along axis 0."""
    still, whirls = _compared(measured)
    return [measured.synchronous[still], measured.whirl_Hz[whirls], measured.whirl[whirls]]


def _shares(measured: Ridges, run: Run) -> list[Scatter]:
    """A share of the largest of each ridge."""
    return [*(FIRST_SHARE * _largest(group) for group in _groups(measured)), _reach(run)]


def _scatter(measured: Ridges, run: Run) -> list[Scatter]:
    """The scatter of each measured ridge about its smooth course. When a whirl begins is not known better than _reach,
    so that its amplitude, where it still grows, is not either."""
    scatter, reach = list[Scatter](), _reach(run)
    for group in _groups(measured):
        second = np.diff(group, 2, axis=0)
        rough = float(np.sqrt(np.mean(second**2) / SECOND)) if second.size else FIRST_SHARE * _largest(group)
        scatter.append(max(rough, LEAST_SHARE * _largest(group)))
    grown = _groups(measured)[-1]
    earlier = np.interp(measured.speed_Hz[_compared(measured)[1]] - reach, measured.speed_Hz, measured.whirl)
    scatter[-1] = np.hypot(scatter[-1], grown - earlier)
    return [*scatter, reach]


def _largest(group: Array) -> float:
    return float(np.nanmax(np.abs(group), initial=1e-12))


def _numbers(case: Case, keys: Sequence[str], bounds: Mapping[str, tuple[float, float]]) -> list[Fitted]:
    """The numbers at first; raises InputError as `fit` does."""
    if not keys:
        raise input_error(case.name, "--vary", "", "names no number.", "Write e.g. oil.viscosity.")
    faults = [
        *(Fault("--vary", key, None, "is named more than once.", "Name it once.")
          for key in dict.fromkeys(keys) if keys.count(key) > 1),
        *(Fault("--bounds", key, None, "is not varied.", f"Add it to --vary {','.join(keys)}, or leave its bounds out.")
          for key in bounds if key not in keys),
    ]  # fmt: skip
    if faults:
        raise InputError(case.name, tuple(faults))
    return [_number(case, key, bounds.get(key)) for key in keys]


def _number(case: Case, key: str, bounds: tuple[float, float] | None) -> Fitted:
    known = {value.key: value for value in listed(case)}
    both = [known[place] for place in (f"{key}.0", f"{key}.1") if place in known]
    if len(both) == 2 and both[0].value == both[1].value:  # one number of x and y
        known[key] = both[0]
    if key in known and (fault := machine_fault(key, "--vary")):
        raise InputError(case.name, (fault,))
    if key not in known:
        alike = [name for name in known if name.rpartition(".")[2] == key.rpartition(".")[2]]
        remedy = did_you_mean(key, alike or known, "`frb check CASE --all` lists the keys.", 0.0 if alike else 0.7)
        raise input_error(case.name, "--vary", key, "is no number of the case.", remedy)
    value = known[key].value
    if not isinstance(value, float) or not value > 0.0:
        raise input_error(case.name, "--vary", key, "is not a number above zero.", "Vary other keys.")
    low, high = bounds or (value / SPAN, value * SPAN)
    if not low < high:
        problem = "has a lower bound that is not below the upper one."
        raise input_error(case.name, "--bounds", key, problem, f"Write --bounds {key}=LOW,HIGH.")
    if not 0.0 < low <= value <= high:
        problem = f"starts at {value:.6g} {known[key].unit}, which is not between its bounds."
        remedy = "Widen them, or change the case by --set."
        raise input_error(case.name, "--bounds", key, problem, remedy)
    return Fitted(key, known[key].unit, value, value, math.nan, low, high)


def _in_units(number: Any, value: float) -> str:
    from frbcli.units import display  # of the library of units, which is slow to import

    return display(float(f"{value:.5g}"), number.unit) if number.unit else f"{value:.5g}"


def _error(number: Any) -> str:
    return "at a bound" if number.at_bound else f"{100.0 * number.error / number.value:.2g} %"


def _bounds(number: Any) -> str:
    return f"{_in_units(number, number.low)} to {_in_units(number, number.high)}"


# Of a Fitted; the terminal shows each number in a unit of its own
FITTED = (
    Column("key", "", "key of the case", shown=(Shown("key"),)),
    Column("unit", "", "unit of the numbers, SI"),
    Column("start", "", "value of the case"),
    Column("value", "", "value that was found"),
    Column("error", "", "standard error"),
    Column("low", "", "lower bound"),
    Column("high", "", "upper bound"),
    Column("at_bound", "", "the value is at a bound and its error meaningless", flat=False),
    *(Column(head, "", "", value, shown=(Shown(head),), key="", flat=False) for head, value in (
        ("at first", lambda number: _in_units(number, number.start)),
        ("found", lambda number: _in_units(number, number.value)),
        ("error", _error),
        ("between", _bounds),
    )),
)  # fmt: skip
