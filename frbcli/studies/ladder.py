"""A ladder of speed against error: ways to compute a run, cost and error of each, Pareto's front."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import attrgetter, itemgetter
from typing import Any

from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, named, short_number, table_of

RESOLVED = 0.01  # Hz; resolution of the terminal's table


@dataclass(frozen=True)
class Rung:
    """One way to compute the run. mesh: elements or cells (along, around), None for the short-bearing theory."""

    theory: str
    cavitation: str
    mesh: tuple[int, int] | None
    tolerance: float
    coupling: str

    @property
    def name(self) -> str:
        """For tables and progress."""
        mesh = "" if self.mesh is None else f" {self.mesh[0]} x {self.mesh[1]}"
        return f"{self.theory}{mesh}, {self.tolerance:.0e}, {self.coupling}".replace("e-0", "e-")


@dataclass(frozen=True)
class RungError:
    """Error against the reference. eccentricity_largest, eccentricity_rms: deviation from the start until until_s,
    where a whirl begins to grow in either run, or it touches its shell or ends; onset_Hz: difference of the rotor
    speeds at which the whirl begins; threshold_Hz: difference of the stability thresholds, NaN if either has none;
    force_relative: of the film forces at states of the run, against a finer mesh."""

    eccentricity_largest: float
    eccentricity_rms: float
    until_s: float
    onset_Hz: float
    force_relative: float
    threshold_Hz: float = math.nan


@dataclass(frozen=True)
class RungResult:
    """A run on a rung. cpu_s: to tabulate its films and to march; status: how it ended; planned: the choice
    of the plan; signals: largest error of each signal, see Difference; stated: stated error of the run;
    work_s: CPU time from the number of its film solves and the times of scene/forms/, which does not depend on the
    load of the machine."""

    rung: Rung
    status: str
    cpu_s: float
    error: RungError
    planned: bool = False
    signals: Mapping[str, float] = field(default_factory=dict)
    stated: Mapping[str, float | None] = field(default_factory=dict)
    work_s: float = math.nan


@dataclass(frozen=True, repr=False)
class AccuracyLadder(Tabular):
    """until_s: how long the runs are; reference: its error is how far a run on the rung `coarser` is from it; ladder:
    in the order of their cost; complete: not interrupted; failed: rungs whose run did not begin, and why."""

    case: Case
    until_s: float
    reference: RungResult
    coarser: Rung
    ladder: tuple[RungResult, ...]
    complete: bool = True
    failed: tuple[tuple[Rung, str], ...] = ()

    @property
    def front(self) -> tuple[RungResult, ...]:
        """Pareto's front: the rungs for which no cheaper rung has a smaller error."""
        best, cheapest = math.inf, []
        for result in sorted(self.ladder, key=lambda item: item.cpu_s):
            if result.error.eccentricity_largest < best:
                best = result.error.eccentricity_largest
                cheapest.append(result)
        return tuple(cheapest)

    def above_front(self, quiet: bool = False) -> float:
        """Cost of the planned rung over the cost of the cheapest rung that is as close; 1 on the front.
        quiet: by the counted work instead of the measured CPU time. Infinite if that run did not begin, and among runs
        that end at once, which cost nothing; NaN if its error is not known."""
        planned = next((item for item in self.ladder if item.planned), None)
        if planned is None:
            return math.inf
        error = planned.error.eccentricity_largest
        costs = {item.rung: item.work_s if quiet else item.cpu_s for item in self.ladder}
        as_close = [item.rung for item in self.ladder if item.error.eccentricity_largest <= error]
        own, cheapest = costs[planned.rung], min((costs[rung] for rung in as_close), default=math.nan)
        if own == cheapest:
            return 1.0
        return math.inf if cheapest == 0.0 else own / cheapest

    def table(self) -> Table:
        """One row per rung."""
        return table_of(LADDER_COLUMNS, ((item, item in self.front) for item in self.ladder))


def _film(item: Any) -> str:
    rung = item.rung
    return rung.theory if rung.mesh is None else f"{rung.mesh[0]}x{rung.mesh[1]}"


def _tolerance(value: float) -> str:
    return short_number(value).replace(".0e", "e")


def _difference(value: float) -> str:
    return f"{value:+.2f}" if abs(value) >= RESOLVED else short_number(value)


# Of a Rung
RUNG = (
    Column("theory", "", "theory of the films"),
    Column("cavitation", "", "cavitation model"),
    Column("mesh", "", "elements or cells along and around; none of the short bearing"),
    Column("tolerance", "", "local error of a step", shown=(Shown("tol.", _tolerance),)),
    Column("coupling", "", "coupling of rotor and films"),
)

# Of a RungResult
RESULT = (
    Column("film", "", "short bearing, or elements of a finite one", _film, shown=(Shown("film"),), key="", flat=False),
    *named(RUNG, "", attrgetter("rung")),
    Column("status", "", "how the run ended"),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU", ".3g"),)),
    Column("eccentricity_largest", "", "largest error of the eccentricity", attrgetter("error.eccentricity_largest"),
           shown=(Shown("max", short_number),), key="error.eccentricity_largest"),
    Column("eccentricity_rms", "", "its root mean square", attrgetter("error.eccentricity_rms"),
           shown=(Shown("rms", short_number),), key="error.eccentricity_rms"),
    Column("until", "s", "end of both errors, at the growth of a whirl", attrgetter("error.until_s"), key=""),
    Column("window", "s", "their begin and end", lambda item: [0.0, item.error.until_s],
           key="error.window_s", flat=False),
    Column("onset_speed", "Hz", "error of the rotor speed at the onset of whirl", attrgetter("error.onset_Hz"),
           shown=(Shown("onset", _difference),), key="error.onset_speed_Hz"),
    Column("threshold", "Hz", "error of the linear threshold", attrgetter("error.threshold_Hz"),
           shown=(Shown("thr.", _difference),), key="error.threshold_Hz"),
    Column("film_force_relative", "", "relative error of the film forces", attrgetter("error.force_relative"),
           shown=(Shown("force", short_number),), key="error.film_force_relative"),
    Column("stated", "", "stated error of the eccentricity", lambda item: item.stated.get("eccentricity"),
           key=""),
    Column("work", "s", "CPU time by the number of film solves", attrgetter("work_s"),
           key=""),
)  # fmt: skip

# Of a RungResult and whether it is on Pareto's front
LADDER_COLUMNS = (
    Column("mark", "", "", lambda item: ("*" if item[0].planned else "") + ("+" if item[1] else ""),
           shown=(Shown(""),), key="", flat=False),
    *named(RESULT, "", itemgetter(0)),
    Column("planned", "", "chosen by the plan", lambda item: item[0].planned),
    Column("on_front", "", "no cheaper one has a smaller error", itemgetter(1), key="pareto"),
)  # fmt: skip
