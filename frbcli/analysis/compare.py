"""The same run-up with several models of the films: what each says, how far it is from the first, what it costs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from frbcli.case.load import load_case_text
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.results.store import Run
from frbcli.scene.kinematic import TESTS as KINEMATIC_TESTS
from frbcli.scene.plan import CAVITATIONS, THEORIES, make_plan
from frbcli.solve.run import Progress, runup

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd

TESTS = ("runup",)
INTERRUPTED = "interrupted"
UNTIL = ("onset", "contact")  # from there on two runs differ in phase, whatever their films


@dataclass(frozen=True)
class Variant:
    """One model of the films."""

    theory: str
    cavitation: str

    @property
    def name(self) -> str:
        """For tables and file names."""
        return f"{self.cavitation} {self.theory}"


@dataclass(frozen=True)
class Deviation:
    """Of the eccentricities from those of the first variant: the largest and the root mean square until until_s, in s,
    where either begins to whirl, touches its shell, or ends. NaN if that is at the very beginning."""

    largest: float
    rms: float
    until_s: float


@dataclass(frozen=True)
class VariantResult:
    """What one model says. The run's file is gone unless it was to be kept; the run itself is not."""

    variant: Variant
    run: Run
    deviation: Deviation

    def first(self, kind: str) -> dict[str, Any] | None:
        """The first event of a kind, None if there is none."""
        return next((event for event in self.run.events if event["kind"] == kind), None)


@dataclass(frozen=True)
class Comparison:
    """Results in the order of the variants; the first is what the others are compared with."""

    case: Case
    test: str
    results: tuple[VariantResult, ...]

    def to_pandas(self) -> pd.DataFrame:
        """One row per variant: models, status, first events, deviation, cost, error."""
        import pandas as pd

        return pd.DataFrame([_row(result) for result in self.results])


Observer = Callable[[Variant, Progress], None]


def compare(
    case: Case,
    cavitations: Sequence[str] = (),
    theories: Sequence[str] = (),
    test: str = "runup",
    keep: str | Path | None = None,
    observe: Observer | None = None,
) -> Comparison:
    """Run a case with every combination of the given cavitation models and theories; () stands for that of the case.

    With neither given, all models of this version are compared, that of the case first. keep: a directory for the run
    files, made if need be; observe: called some times a second. Ctrl-C ends the comparison with an "interrupted" run.
    Raises InputError for models or tests that there are not, fewer than two models, or files that cannot be written.
    """
    _check_test(test)
    variants = make_variants(case, cavitations, theories)
    cases = [_with_models(case, variant) for variant in variants]
    runs: list[Run] = []
    with _directory(keep) as folder:
        for variant, its_case in zip(variants, cases, strict=True):
            path = folder / f"{variant.name.replace(' ', '-')}.h5"
            tell = None if observe is None else _telling(observe, variant)
            runs.append(runup(its_case, path, observe=tell))
            if runs[-1].status == INTERRUPTED:
                break
    results = [
        VariantResult(variant, run, deviation(run, runs[0])) for variant, run in zip(variants, runs, strict=False)
    ]
    return Comparison(case, test, tuple(results))


def make_variants(case: Case, cavitations: Sequence[str] = (), theories: Sequence[str] = ()) -> tuple[Variant, ...]:
    """The combinations to compare, see compare. Raises InputError with every wrong name, and for one model alone."""
    faults = [*_unknown("--cavitation", cavitations, CAVITATIONS), *_unknown("--theory", theories, THEORIES)]
    if faults:
        raise InputError(case.name or "case", tuple(faults))
    plan = make_plan(case)
    own = Variant(plan.theory, plan.cavitation)
    if not cavitations and not theories:
        found = [own, *(Variant(theory, cavitation) for cavitation in CAVITATIONS for theory in THEORIES)]
    else:
        found = [
            Variant(theory, cavitation)
            for cavitation in cavitations or (own.cavitation,)
            for theory in theories or (own.theory,)
        ]
    variants = tuple(dict.fromkeys(found))
    if len(variants) < 2:
        problem = f"names one model only, {variants[0].name}: there is nothing to compare it with."
        remedy = f"There are --cavitation {','.join(CAVITATIONS)} and --theory {','.join(THEORIES)}."
        raise InputError(case.name or "case", (Fault("comparison", "", None, problem, remedy),))
    return variants


def deviation(run: Run, reference: Run) -> Deviation:
    """How far the eccentricities of a run are from those of a reference with the same speeds and output times."""
    ends = [event["t_s"] for one in (run, reference) for event in one.events if event["kind"] in UNTIL]
    until = min([*ends, run.t_end_s, reference.t_end_s])
    count = min(int(np.searchsorted(run["time_s"], until, side="right")), len(run), len(reference))
    names = [name for name in run.signals if name.startswith("eccentricity")]
    apart = np.array([run[name][:count] - reference[name][:count] for name in names])
    if count < 2:
        return Deviation(np.nan, np.nan, until)
    return Deviation(float(np.abs(apart).max()), _rms(apart), until)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _check_test(test: str) -> None:
    if test in TESTS:
        return
    kinematic = test in KINEMATIC_TESTS
    problem = f"is a function of its own: frbcli.{test}(case, cavitations)." if kinematic else "is no test."
    raise InputError("comparison", (Fault("--test", test, None, problem, f"There is: {', '.join(TESTS)}."),))


def _unknown(option: str, names: Sequence[str], known: Sequence[str]) -> list[Fault]:
    problem, remedy = "is no model of this version.", f"There are: {', '.join(known)}."
    return [Fault(option, name, None, problem, remedy) for name in dict.fromkeys(names) if name not in known]


def _with_models(case: Case, variant: Variant) -> Case:
    settings = (f"film.theory={variant.theory}", f"film.cavitation={variant.cavitation}")
    return load_case_text(case.source_text, settings, name=case.name)


@contextmanager
def _directory(keep: str | Path | None) -> Iterator[Path]:
    """The directory for the run files; a temporary one if they are not to be kept."""
    if keep is None:
        with TemporaryDirectory(prefix="frb-compare-") as folder:
            yield Path(folder)
        return
    try:
        Path(keep).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        problem = f"cannot be made: {error.strerror}."
        raise InputError("comparison", (Fault("--keep", str(keep), None, problem, "Choose another place."),)) from error
    yield Path(keep)


def _telling(observe: Observer, variant: Variant) -> Callable[[Progress], None]:
    return lambda progress: observe(variant, progress)


def _row(result: VariantResult) -> dict[str, Any]:
    critical, onset = result.first("critical-speed"), result.first("onset")
    return {
        "cavitation": result.variant.cavitation,
        "theory": result.variant.theory,
        "status": result.run.status,
        "t_end_s": result.run.t_end_s,
        "critical_speed_Hz": np.nan if critical is None else critical["speed_Hz"],
        "onset_speed_Hz": np.nan if onset is None else onset["speed_Hz"],
        "onset_frequency_ratio": np.nan if onset is None else onset["frequency_ratio"],
        "deviation_largest": result.deviation.largest,
        "deviation_rms": result.deviation.rms,
        "deviation_until_s": result.deviation.until_s,
        "cpu_s": result.run.cost["cpu_s"],
        "film_force_relative": result.run.error["film_force_relative"],
    }
