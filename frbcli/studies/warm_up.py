"""Warming up: the kernels that cases need are compiled on all cores, once, and kept on disk; by analyses of a case as
short as can be, which compile the kernels that the whole ones need."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory

import joblib

from frbcli.bearing_tests import kinematic
from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import shipped_names
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, table_of
from frbcli.compiled import counted
from frbcli.errors import NotConverged
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.stability import stability_points
from frbcli.runs.inputs import films_change, machine_inputs
from frbcli.runs.interruption import deaf
from frbcli.runs.run import runup
from frbcli.scene.gate.gate import faults
from frbcli.scene.gate.rule import BEARING, KINEMATIC, ROTATION, RUN, STABILITY
from frbcli.scene.machine.rotor import element_parts
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.film_choice import Decision, form_of
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import make_plan

MOMENT_s = 1e-3  # of a run
PERIODS = 1e-3  # of a squeeze or a whirl
# Decisions of a plan that choose the kernels
COMPILED_FOR = ("bearings", "channels", "theory", "cavitation", "coupling", "film", "integrator")
CELLS, OTHERS = "cells", "others"  # kernels of finite-volume films; all others, which are compiled apart from them


@dataclass(frozen=True)
class ShortAnalysis:
    """An analysis of a case, as short as can be. kind: what determines its kernels; family: CELLS or OTHERS."""

    case: Case
    analysis: str
    kind: tuple[object, ...]
    family: str

    def compute(self) -> None:
        """Run the analysis. Raises FrbError as the analysis does."""
        ANALYSES[self.analysis](self.case)


def short_analyses(case: Case) -> Iterator[ShortAnalysis]:
    """Short forms of all analyses that a case can be asked for, of runs, stability, sheets and kinematic tests. Raises
    InputError if the machine cannot be modelled."""
    if not case.given_bearings or (case.given_rotor is None and case.motion is None):
        return  # thrust and ball bearings alone need no kernels
    if case.motion is None or (case.given_rotor is not None and case.given_speed is not None):
        make_plan(case)  # raises the faults of a machine
    applicable = [analysis for analysis in ANALYSES if _applies(case, analysis)]
    for analysis in applicable:
        machine = analysis not in KINEMATIC
        plan = make_plan(case) if machine else kinematic_plan(case, test=analysis)
        kind = analysis, *(machine_kernels(case, plan.decisions) if machine else _film_kernels(case, plan.decisions))
        on_cells = analysis in (BEARING, *KINEMATIC) or form_of(case).by_cells
        yield ShortAnalysis(case, analysis, kind, CELLS if on_cells else OTHERS)


def machine_kernels(case: Case, decisions: Sequence[Decision]) -> tuple[object, ...]:
    """What determines the kernels of a machine in an analysis, with the decisions of its plan: two machines that agree
    in it have the same."""
    inputs = machine_inputs(case)
    return (
        *_film_kernels(case, decisions),
        bool(element_parts(case).loads) or shaft_of(case).bow > 0.0,
        inputs is not None,
        films_change(case),
        case.contact.rough,
        case.start.position,
        case.drive is not None,
    )


def _film_kernels(case: Case, decisions: Sequence[Decision]) -> tuple[object, ...]:
    """What determines the kernels of the films of a machine and of their heat."""
    chosen = tuple(made.value for made in decisions if made.choice in COMPILED_FOR)
    heat = None if case.heat is None else case.heat.side_flow
    return *chosen, form_of(case), heat, case.output.signals


def moment_of_run(case: Case) -> Case:
    """A case whose run takes a moment, at its last speed; with a drive from its first one on."""
    duration = max(MOMENT_s, 2 * case.output.step)
    if case.drive is not None:
        return case.with_settings(f"drive.duration={duration!r}", f"drive.down_duration={duration!r}")
    end = case.speed.end
    return case.with_settings({"speed": {"from": end, "to": end, "duration": duration}})


def _applies(case: Case, analysis: str) -> bool:
    if analysis in KINEMATIC:
        wanted = case.motion is not None and (case.motion.frequency is None) == (analysis == ROTATION)
        return wanted and not faults(case, analysis)
    return case.given_rotor is not None and case.given_speed is not None and not faults(case, analysis)


def _run(case: Case) -> None:
    with TemporaryDirectory(prefix="frb-warm-up-") as folder:
        runup(moment_of_run(case), Path(folder) / "moment.h5")




def _kinematic(test: Callable[..., object]) -> Callable[[Case], object]:
    return lambda case: test(case.with_settings(f"motion.periods={PERIODS!r}"))


ANALYSES: dict[str, Callable[[Case], object]] = {
    RUN: _run,
    STABILITY: lambda case: stability_points(case, [case.speed.top]),
    BEARING: lambda case: bearing_sheet(case, [case.speed.top]),
    "rotation": kinematic.rotation,
    "squeeze": _kinematic(kinematic.squeeze),
    "whirl": _kinematic(kinematic.whirl),
}


COMPILED = (
    Column("case", "", "name of the case", shown=(Shown("case"),)),
    Column("analysis", "", "what was computed of it", shown=(Shown("analysis"),)),
    Column("functions", "", "compiled, with those that they call", shown=(Shown("compiled", "d"),)),
    Column("cpu", "s", "CPU time of the compilation", attrgetter("cpu_s"), shown=(Shown("CPU, s", ".1f"),)),
)

Observer = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Compiled:
    """What an analysis of a case compiled: number of functions, CPU time in s."""

    case: str
    analysis: str
    functions: int
    cpu_s: float


@dataclass(frozen=True, repr=False)
class WarmUp(Tabular):
    """What was compiled, and in which time. cases: names; all: what was tried; wall_s: s."""

    cases: tuple[str, ...]
    all: tuple[Compiled, ...]
    wall_s: float

    @property
    def compiled(self) -> tuple[Compiled, ...]:
        """The analyses for which something was missing."""
        return tuple(each for each in self.all if each.functions)

    @property
    def functions(self) -> int:
        """Number of compiled functions; 0 if all were on the disk."""
        return sum(each.functions for each in self.all)

    @property
    def cpu_s(self) -> float:
        """CPU time of all compilations in s."""
        return sum(each.cpu_s for each in self.all)

    def table(self) -> Table:
        """One row per analysis for which something was compiled."""
        return table_of(COMPILED, self.compiled)


def warm_up(cases: Iterable[Case] = (), jobs: int = -1, observe: Observer | None = None) -> WarmUp:
    """Compile what run-ups, stability, bearing sheets and kinematic tests of cases need, once, on all cores.

    Parameters
    ----------
    cases : iterable of Case
        The machines, see `load_case`; by default all shipped ones.
    jobs : int
        Processes; -1 for one on each core.
    observe : callable, optional
        Called with the name of each case and analysis that is done, its number and their number.

    Returns
    -------
    WarmUp
        What was compiled, with CPU times in s; nothing where all kernels are on the disk.

    Raises
    ------
    InputError
        If a case cannot be modelled.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.warm_up([frbcli.load_case("jeffcott", ["film.theory=short"])])  # doctest: +SKIP
    """
    began = time.monotonic()
    wanted = list(cases) or [load_case(name) for name in shipped_names()]
    different = {short.kind: short for case in reversed(wanted) for short in short_analyses(case)}
    work = sorted(different.values(), key=attrgetter("family"))
    families = [list(members) for _, members in groupby(work, attrgetter("family"))]
    kernels: list[Compiled] = []
    with closing(_compiled(families, jobs)) as done:
        for compiled in done:
            kernels += compiled
            if observe is not None:
                observe(", ".join(f"{each.case}: {each.analysis}" for each in compiled[-1:]), len(kernels), len(work))
    return WarmUp(tuple(case.name for case in wanted), tuple(kernels), time.monotonic() - began)


def _compiled(families: Sequence[Sequence[ShortAnalysis]], jobs: int) -> Generator[list[Compiled], None, None]:
    """What each analysis compiled, as soon as it is known: by processes, one family each, since processes do not share
    kernels; or one by one in this process, which alone has the force laws that were added."""
    laws = any(spring.law for members in families for short in members for spring in short.case.springs)
    if jobs == 1 or len(families) == 1 or laws:
        for members in families:
            for short in members:
                yield [_compile(short)]
        return
    with joblib.parallel_config("loky", inner_max_num_threads=1):
        parallel = joblib.Parallel(n_jobs=jobs, batch_size=1, return_as="generator_unordered")
        with deaf():  # the processes start in it, and ignore what a terminal sends to all
            done = parallel(joblib.delayed(_compile_all)(members) for members in families)
        yield from done


def _compile_all(members: Sequence[ShortAnalysis]) -> list[Compiled]:
    return [_compile(short) for short in members]


def _compile(short: ShortAnalysis) -> Compiled:
    """An analysis that finds no solution has compiled what it needs, too."""
    with counted() as compilations, suppress(NotConverged):
        short.compute()
    return Compiled(short.case.name, short.analysis, compilations.functions, compilations.cpu_s)
