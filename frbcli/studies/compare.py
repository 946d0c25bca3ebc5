"""One run-up with several models of the films: events, deviation from the first, and cost of each."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import joblib
import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import ZERO_CELSIUS, Column, Shown, Table, Tabular, table_of, uncertain_speed
from frbcli.errors import Fault, InputError, did_you_mean, input_error
from frbcli.film.cavitation.table import law_named, laws, names
from frbcli.results.columns import uncertain_pair
from frbcli.results.store import Run, check_output
from frbcli.runs.header import POWER
from frbcli.runs.march import Progress
from frbcli.runs.run import PROFILES, earlier_run, is_interrupted, standing_run
from frbcli.scene.coupling import COUPLINGS, chosen_coupling
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import COMPARISON
from frbcli.scene.planning.kinematic_plan import TESTS as KINEMATIC_TESTS
from frbcli.scene.planning.plan import THEORIES, cost_of_run, make_plan
from frbcli.studies.against import COMMANDS, Ended, Report, RunTask, in_turn, side_by_side

MODELS, COUPLING_TABLE = "models", "couplings"  # tables of the terminal
MS_PER_HOUR = 3.6e6  # of a run that takes its own time
NO_HEAT = "none"
THERMALS = (NO_HEAT, "lumped")
FINISHED, INTERRUPTED = "finished", "interrupted"
WORTH_A_PROCESS_s = 20.0  # expected CPU time of the runs but the longest: a process takes about 2 s to begin
LAST = 0.02  # share of a run
UNTIL = ("onset", "contact")  # afterwards two runs differ in phase, whatever their films


def _event(kind: str, key: str) -> Callable[[Any], float]:
    def value(result: Any) -> float:
        event = result.first(kind)
        return math.nan if event is None or event.get(key) is None else event[key]

    return value


def _uncertain(kind: str) -> Callable[[Any], tuple[float, float | None] | None]:
    """The speed of an event with its uncertainty, where the run has one."""
    return lambda result: None if result.first(kind) is None else uncertain_pair(result.first(kind))


def _of(account: str, key: str) -> Callable[[Any], Any]:
    """From the cost or the error of a run; NaN where the run does not state it."""
    return lambda result: getattr(result.run, account).get(key, math.nan)


def _rough(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e+")


# Of a VariantResult
VARIANT = (
    Column("name", "", "", attrgetter("variant.name"), shown=(Shown("films", table=MODELS),), key="", flat=False),
    Column("cavitation", "", "cavitation model", attrgetter("variant.cavitation")),
    Column("theory", "", "theory of the films", attrgetter("variant.theory")),
    Column("coupling", "", "coupling of rotor and films", attrgetter("variant.coupled"),
           shown=(Shown("coupling", lambda name: name.replace("-semi", "-\nsemi"), table=COUPLING_TABLE),)),
    Column("status", "", "how the run ended", attrgetter("run.status")),
    Column("t_end", "s", "when it ended", attrgetter("run.t_end_s"), key=""),
    Column("events", "", "events of the run", attrgetter("run.events"), flat=False),
    Column("critical_speed", "Hz", "rotor speed at resonance", _event("critical-speed", "speed_Hz"), key=""),
    Column("critical_speed", "", "rotor speed at resonance", _uncertain("critical-speed"), key="", flat=False,
           shown=(uncertain_speed("crit.", table=MODELS, unit="Hz"),)),
    Column("onset_speed", "Hz", "rotor speed at the onset of whirl", _event("onset", "speed_Hz"), key=""),
    Column("onset_speed", "", "rotor speed at the onset of whirl", _uncertain("onset"), key="", flat=False,
           shown=tuple(uncertain_speed("onset", table=table, unit="Hz") for table in (MODELS, COUPLING_TABLE))),
    Column("onset_speed_uncertainty", "Hz", "its uncertainty",
           _event("onset", "speed_uncertainty_Hz"), key=""),
    Column("onset_frequency_ratio", "", "whirl ratio there", _event("onset", "frequency_ratio"), key="",
           shown=(Shown("ratio", ".3f", table=MODELS),)),
    Column("deviation_largest", "", "largest deviation from the first row before a whirl",
           attrgetter("deviation.largest"), key="deviation.eccentricity_largest",
           shown=(Shown("max", ".3f", table=MODELS), Shown("max", ".1e", table=COUPLING_TABLE))),
    Column("deviation_rms", "", "its root mean square", attrgetter("deviation.rms"),
           key="deviation.eccentricity_rms", shown=(Shown("rms", ".3f", table=MODELS),)),
    Column("deviation_until", "s", "end of both", attrgetter("deviation.until_s"), key="deviation.until_s"),
    Column("cost", "", "cost of the run", attrgetter("run.cost"), flat=False),
    Column("error", "", "stated errors", attrgetter("run.error"), flat=False),
    Column("film_force_relative", "", "stated error", _of("error", "film_force_relative"), key=""),
    Column("eccentricity_error", "", "stated error of the eccentricity before a whirl", _of("error", "eccentricity"),
           key="", shown=(Shown("err.", _rough, table=MODELS),), more="over the clearance"),
    Column("ms_per_step", "", "CPU time of a (micro) step in ms", key="",
           shown=(Shown("ms/step", ".2g", table=COUPLING_TABLE),)),
    Column("micro_steps_per_macro_step", "", "micro steps per macro step", _of("cost", "micro_steps_per_macro_step"),
           key="", shown=(Shown("micro", ".2f", table=COUPLING_TABLE),)),
    Column("simulated_ms_per_hour", "", "simulated time in ms per hour; on the terminal CPU time per simulated time",
           _of("cost", "simulated_ms_per_hour"), key="",
           shown=(Shown("s per s", lambda ms: f"{MS_PER_HOUR / ms:.2g}" if ms else "-", table=COUPLING_TABLE),)),
    Column("cpu", "s", "CPU time", _of("cost", "cpu_s"), key="",
           shown=(Shown("CPU", ".2f", table=MODELS), Shown("CPU", ".3g", table=COUPLING_TABLE))),
)  # fmt: skip


def _joined(form: str) -> Callable[[Any], str]:
    return lambda values: ", ".join(form.format(value) for value in values) or "-"


# Of a VariantResult with heat, at the end of its run
HEAT = (
    Column("name", "", "", attrgetter("variant.name"), shown=(Shown("films"),), key="", flat=False),
    Column("thermal", "", "model of heat", attrgetter("variant.thermal")),
    Column("ring_speed_ratios", "", "speeds of the rings over the rotor speed", attrgetter("ring_ratios"),
           shown=(Shown("ring over rotor", lambda ratios: _joined("{:.4f}")(ratios.values())),), flat=False),
    Column("loss", "W", "power that all films take", shown=(Shown("loss, W", ".4g"),)),
    Column("temperatures", "", "", lambda result: [value - ZERO_CELSIUS for value in result.temperatures_K],
           shown=(Shown("films, degC", _joined("{:.1f}")),), key="", flat=False),
)  # fmt: skip


@dataclass(frozen=True)
class Variant:
    """One model of the films, how they are coupled to the rotor, and a model of heat, "" for the case's own."""

    theory: str
    cavitation: str
    coupling: str = "auto"
    thermal: str = ""

    @property
    def name(self) -> str:
        """For tables and file names."""
        films = f"{self.cavitation} {self.theory}" if self.theory in THEORIES else self.theory
        heat = {"": "", "none": " without heat"}.get(self.thermal, " with heat")
        return films + ("" if self.coupling == "auto" else f" {self.coupling}") + heat

    @property
    def coupled(self) -> str:
        """The coupling, also for "auto"."""
        return chosen_coupling(self.coupling, self.cavitation)


@dataclass(frozen=True)
class Deviation:
    """Deviation of the eccentricities from the first variant, the largest and the rms until until_s, in s, where either
    begins to whirl, touches its shell, or ends. NaN if that is at the very beginning."""

    largest: float
    rms: float
    until_s: float


@dataclass(frozen=True)
class VariantResult:
    """The run of one model. The run's file is deleted unless it was to be kept; the run itself stays in memory."""

    variant: Variant
    run: Run
    deviation: Deviation

    @property
    def ms_per_step(self) -> float:
        """CPU time of a step, of one of the films' own if they have them."""
        cost = self.run.cost
        return 1e3 * float(cost["cpu_s"]) / max(float(cost.get("micro_steps", cost["steps"])), 1.0)

    @property
    def ring_ratios(self) -> dict[str, float]:
        """Speed of each ring over the rotor speed in the last LAST of the run, by the names of their signals."""
        rotor = float(np.mean(_last(self.run, "speed_Hz")))
        rings = [name for name in self.run.signals if name.startswith("ring_speed")]
        return {name: float(np.mean(_last(self.run, name))) / rotor for name in rings} if rotor else {}

    @property
    def loss(self) -> float:
        """Mean power in W that all films took in the last LAST of the run, of one bearing each; NaN where the run
        does not record it."""
        powers = [name for name in self.run.signals if name.startswith("power")]
        return float(sum(np.mean(_last(self.run, name)) for name in powers)) if powers else np.nan

    @property
    def temperatures_K(self) -> list[float]:
        """Temperatures of the films at the end."""
        flows = [name for name in self.run.signals if name.startswith("flow")]
        names = [name.replace("flow", "temperature").removesuffix("_m3_s") + "_K" for name in flows]
        return [float(self.run[name][-1]) for name in names]

    def first(self, kind: str) -> dict[str, Any] | None:
        """The first event of a kind, None if there is none."""
        return next((event for event in self.run.events if event["kind"] == kind), None)


@dataclass(frozen=True, repr=False)
class Comparison(Tabular):
    """Results in the order of the variants; the first is what the others are compared with.

    status: "finished", or why not all variants have a result: "interrupted", "not-converged", "input-error"; message
    says more then.
    """

    case: Case
    test: str
    results: tuple[VariantResult, ...]
    status: str = FINISHED
    message: str = ""

    def table(self) -> Table:
        """One row per variant: models, coupling, status, first events, deviation, cost, error."""
        return table_of(VARIANT, self.results)


Observer = Callable[[Variant, int, int, Progress], None]


def compare(
    case: Case,
    cavitations: Sequence[str] = (),
    theories: Sequence[str] = (),
    test: str = "runup",
    keep: str | Path | None = None,
    observe: Observer | None = None,
    couplings: Sequence[str] = (),
    thermals: Sequence[str] = (),
) -> Comparison:
    """Run a case with every combination of cavitation models, theories, couplings and models of heat.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    cavitations, theories, couplings, thermals : sequence of str
        Names of models; an empty one means the model of the case. With none given, the model of the case is compared
        with all that have no state and cost little.
    test : {"runup", "rundown"}
        The scene.
    keep : str or Path, optional
        Directory for the run files, made if need be; interrupted runs there go on.
    observe : callable, optional
        Called some times a second with the variant, its number from 1, how many there are, and its progress.

    Returns
    -------
    Comparison
        The runs, their events, deviations and cost. Ctrl-C, or a variant that does not begin, ends the comparison with
        the runs so far. Long runs go side by side, one on each core; each has its own cost.

    Raises
    ------
    InputError
        For models or tests that there are not, fewer than two models, models that the case does not allow, or files
        that cannot be written; nothing is run then. A first variant that does not begin raises its error.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.compare(case, ["half-sommerfeld", "sommerfeld"])  # doctest: +SKIP
    """
    require(case, COMPARISON)
    _check_test(test)
    variants = make_variants(case, cavitations, theories, couplings, thermals)
    cases = [_planned(case, variant) for variant in variants]
    with _directory(keep) as folder:
        paths = [folder / f"{variant.name.replace(' ', '-')}.h5" for variant in variants]
        begun = [_is_begun(test, its_case, path) for its_case, path in zip(cases, paths, strict=True)]
        tasks = [
            RunTask(number, test, its_case, path, resume)
            for number, (its_case, path, resume) in enumerate(zip(cases, paths, begun, strict=True), start=1)
        ]

        def report(number: int, progress: Progress) -> None:
            if observe is not None:
                observe(variants[number - 1], number, len(variants), progress)

        ended = dict(_ended(tasks, report))
    runs = {number: run for number, run in sorted(ended.items()) if isinstance(run, Run)}
    failures = [end for _, end in sorted(ended.items()) if not isinstance(end, Run)]
    if 1 not in runs:
        raise failures[0]
    failures += [KeyboardInterrupt() for run in runs.values() if run.status == INTERRUPTED]
    status, message = (getattr(failures[0], "status", INTERRUPTED), str(failures[0])) if failures else (FINISHED, "")
    results = [VariantResult(variants[number - 1], run, deviation(run, runs[1])) for number, run in runs.items()]
    return Comparison(case, test, tuple(results), status, message)


def _ended(tasks: Sequence[RunTask], report: Report) -> Iterator[tuple[int, Ended]]:
    """How each run has ended. Those that take long run side by side, the longest first, if other processes know their
    models: laws that Python has added are known to this one alone."""
    planned = ((task, make_plan(task.case), PROFILES[task.command](task.case)) for task in tasks)
    costs = {task.number: cost_of_run(task.case, plan, profile).total_s for task, plan, profile in planned}
    shipped = all(law_named(law).__module__.startswith("frbcli.") for task in tasks for law in task.case.cavitations)
    own = not shipped or any(spring.law for task in tasks for spring in task.case.springs)
    if own or joblib.cpu_count() == 1 or sum(costs.values()) - max(costs.values()) < WORTH_A_PROCESS_s:
        return in_turn(tasks, report)
    return side_by_side(sorted(tasks, key=lambda task: -costs[task.number]), report)


def _planned(case: Case, variant: Variant) -> Case:
    """The case of a variant. Raises InputError if it cannot be modelled."""
    its_case = _with_models(case, variant)
    make_plan(its_case)
    _check_own_models(case, variant, its_case)
    return its_case


def _is_begun(test: str, case: Case, path: Path) -> bool:
    """Whether the run of a variant was interrupted before and goes on. Raises InputError if its file cannot be written,
    or holds a run of another case."""
    check_output(path)
    if is_interrupted(path):
        return earlier_run(test, case, path) is not None
    standing_run(test, case, path)
    return False


def make_variants(
    case: Case,
    cavitations: Sequence[str] = (),
    theories: Sequence[str] = (),
    couplings: Sequence[str] = (),
    thermals: Sequence[str] = (),
) -> tuple[Variant, ...]:
    """The combinations to compare, see compare. Raises InputError with every wrong name, and for one model alone."""
    faults = [*_unknown("--cavitation", cavitations, names()), *_unknown("--theory", theories, THEORIES)]
    faults += [*_unknown("--coupling", couplings, COUPLINGS), *_unknown("--thermal", thermals, THERMALS)]
    if faults:
        raise case.refused(*faults)
    plan = make_plan(case)
    own = Variant(plan.theory, plan.cavitation, case.film.coupling)
    if not (cavitations or theories or couplings or thermals):
        closed = names(law for law in laws() if law.closed)
        others = (Variant(theory, cavitation, own.coupling) for cavitation in closed for theory in THEORIES)
        combinations = [own, *(variant for variant in others if _fits(case, variant))]
    else:
        combinations = [
            Variant(theory, cavitation, coupling, thermal)
            for cavitation in cavitations or (own.cavitation,)
            for theory in theories or (own.theory,)
            for coupling in couplings or (own.coupling,)
            for thermal in thermals or ("",)
        ]
    variants = tuple(dict.fromkeys(combinations))
    if len(variants) < 2:
        problem = f"names one model only, {variants[0].name}: there is nothing to compare it with."
        remedy = f"There are --cavitation {','.join(names())} and --theory {','.join(THEORIES)}, "
        remedy += f"--coupling {','.join(COUPLINGS)}, --thermal {','.join(THERMALS)}."
        raise input_error(case.name or "case", "comparison", "", problem, remedy)
    return variants


def deviation(run: Run, reference: Run) -> Deviation:
    """How far the eccentricities of a run are from a reference with the same speeds and output times."""
    ends = [event["t_s"] for one in (run, reference) for event in one.events if event["kind"] in UNTIL]
    until = min([*ends, run.t_end_s, reference.t_end_s])
    count = min(int(np.searchsorted(run["time_s"], until, side="right")), len(run), len(reference))
    names = [name for name in run.signals if name.startswith("eccentricity")]
    apart = np.array([run[name][:count] - reference[name][:count] for name in names])
    if count < 2:
        return Deviation(np.nan, np.nan, until)
    return Deviation(float(np.abs(apart).max()), float(np.sqrt(np.mean(apart**2))), until)


def _last(run: Run, name: str) -> Array:
    return run[name][-max(1, round(LAST * len(run))) :]


def _check_test(test: str) -> None:
    if test in COMMANDS:
        return
    kinematic = test in KINEMATIC_TESTS
    problem = f"is a function of its own: frbcli.{test}(case, cavitations)." if kinematic else "is not a test."
    raise input_error("comparison", "--test", test, problem, f"There is: {', '.join(COMMANDS)}.")


def _unknown(option: str, names: Sequence[str], known: Sequence[str]) -> list[Fault]:
    problem = "is not a model of this version."
    unknown = (name for name in dict.fromkeys(names) if name not in known)
    return [Fault(option, name, None, problem, did_you_mean(name, known)) for name in unknown]


def _with_models(case: Case, variant: Variant) -> Case:
    signals = dict.fromkeys((*case.output.signals, POWER))
    settings = (
        f"film.theory={variant.theory}",
        f"film.cavitation={variant.cavitation}",
        f"film.coupling={variant.coupling}",
        *([f"thermal.model={variant.thermal}"] if variant.thermal else []),
        # the loss of a run without heat is recorded by choice alone
        *([f"output.signals=[{', '.join(map(json.dumps, signals))}]"] if variant.thermal == NO_HEAT else []),
    )
    return case.with_settings(*settings)


def _fits(case: Case, variant: Variant) -> bool:
    """Whether a run-up of the case can be made with the model: no short bearing with openings, for instance."""
    try:
        _planned(case, variant)
    except InputError:
        return False
    return True


def _check_own_models(case: Case, variant: Variant, its_case: Case) -> None:
    """Raise InputError for a variant whose model some film does not take, having one of its own."""
    if variant.cavitation != case.film.cavitation and set(its_case.cavitations) != {variant.cavitation}:
        problem = "does not apply to all films: some have a model of their own."
        remedy = "Remove `cavitation` from the films of the bearing, or compare couplings only."
        raise input_error(case.name or "case", "--cavitation", variant.cavitation, problem, remedy)


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
        raise input_error("comparison", "--keep", str(keep), problem, "Choose another place.") from error
    yield Path(keep)
