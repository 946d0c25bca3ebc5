"""Warming up: the kernels that cases need are compiled on all cores, once, and kept on disk."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter

import joblib

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import shipped_names
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, table_of
from frbcli.compilation import counted
from frbcli.errors import NotConverged
from frbcli.html import Tabular
from frbcli.runs.record.interrupt import deaf
from frbcli.studies.kernels.short_analyses import ShortAnalysis, short_analyses

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
