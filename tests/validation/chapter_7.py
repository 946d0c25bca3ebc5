"""The run-ups of chapter 7 on floating rings: what docs/floating-rings.md lists, one row each.

    PYTHONPATH=.:tests python -m validation.chapter_7 FOLDER [NAME ...]

runs the studies named, or all, and prints their rows; a run that FOLDER holds is taken. NAME@1e-3 is the study with
that target in place of the one of its case.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.analysis.events import find_events
from frbcli.analysis.signals import joined, points
from frbcli.analysis.subsynchronous import whirl_names
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.results.store import Run, read_run
from frbcli.runs.run import rundown, runup
from frbcli.scene.films import film_places

HALF = ("film.cavitation=half-sommerfeld",)
TWO_PHASE = ("film.cavitation=two-phase", "film.two-phase.steepness=0.9")
DIMENSIONLESS = "film.penalty.pressure=dimensionless"
PENALTY = ("film.cavitation=penalty", DIMENSIONLESS)
SIDES = ("inner", "outer")


def supply(pressure: str, *bearings: str) -> tuple[str, ...]:
    """Both films of the bearings fed with a pressure."""
    films = (f"{bearing}.{side}" for bearing in bearings or ("bearing",) for side in SIDES)
    return tuple(f"{film}.supply.pressure={pressure}" for film in films)


def gap(clearance: str) -> tuple[str, ...]:
    """An outer film of a clearance."""
    return (f"bearing.outer.clearance={clearance}",)


BOTH = ("bearing.0", "bearing.1")
SLOWLY = ("speed.to=700 Hz", "speed.duration=10 s", "speed.hold=0.5 s", "output.step=1e-4")
PLAIN = ('bearing.inner.supply={kind="none"}', "bearing.outer.supply.pressure=1 bar")
COUPLED = ("bearing.channels=coupled",)
GROOVE_AT_END = ('bearing.outer.supply={kind="circumferential-groove", axial_position=1, pressure="2 bar"}',)
STUDIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "hs": ("floating-ring", HALF),
    "pen": ("floating-ring", PENALTY),
    "tp90": ("floating-ring", TWO_PHASE),
    "tp": ("floating-ring", (*TWO_PHASE, "film.two-phase.steepness=0.95")),
    "table": ("floating-ring-table-7-1", HALF),
    "tpinner": ("floating-ring", (*TWO_PHASE, "bearing.outer.cavitation=penalty", DIMENSIONLESS)),
    "tpouter": ("floating-ring", (*TWO_PHASE, "bearing.inner.cavitation=penalty", DIMENSIONLESS)),
    "down": ("floating-ring", (*PENALTY, *gap("90 um"), *SLOWLY)),
    "down-hs": ("floating-ring", (*HALF, *gap("90 um"), *SLOWLY)),
    "pen45": ("floating-ring", (*PENALTY, *gap("45 um"))),
    "pen40": ("floating-ring", (*PENALTY, *gap("40 um"))),
    "tp45": ("floating-ring", (*TWO_PHASE, *gap("45 um"))),
    "tp40": ("floating-ring", (*TWO_PHASE, *gap("40 um"))),
    "pen15": ("floating-ring", (*PENALTY, *supply("1.5 bar"))),
    "pen1": ("floating-ring", (*PENALTY, *supply("1 bar"))),
    "tp15": ("floating-ring", (*TWO_PHASE, *supply("1.5 bar"))),
    "tp1": ("floating-ring", (*TWO_PHASE, *supply("1 bar"))),
    "tp15couette": ("floating-ring", (*TWO_PHASE, *supply("1.5 bar"), "film.torque=couette")),
    "tp15one": ("floating-ring", (*TWO_PHASE, *supply("1.5 bar"), "film.cavitation_factor=none")),
    "pen1plain": ("floating-ring", (*PENALTY, *PLAIN)),
    "tp90level": ("floating-ring", (*TWO_PHASE, "bearing.centrifugal_pressure=false")),
    "tc": ("turbocharger-heavy", HALF),
    "tc-pen": ("turbocharger-heavy", PENALTY),
    "tp90coupled": ("floating-ring", (*TWO_PHASE, *COUPLED)),
    "tp90end": ("floating-ring", (*TWO_PHASE, *GROOVE_AT_END)),
    "tp90endcoupled": ("floating-ring", (*TWO_PHASE, *GROOVE_AT_END, *COUPLED)),
    "tc-tp": ("turbocharger-heavy", TWO_PHASE),
    "tc-pen12": ("turbocharger-heavy", (*PENALTY, *supply("1.2 bar", *BOTH))),
    "tc-tp12": ("turbocharger-heavy", (*TWO_PHASE, *supply("1.2 bar", *BOTH))),
}


@dataclass(frozen=True)
class Row:
    """A whirl: name, film; time in s, speed and frequency in Hz of its onset, and of lock-in and offset, if any."""

    name: str
    film: str
    onset: tuple[float, float, float]
    lock_in: tuple[float, float, float] | None
    offset: tuple[float, float, float] | None

    def __str__(self) -> str:
        moments = (("on", self.onset), ("lock-in", self.lock_in), ("off", self.offset))
        told = ("{} {:.2f} s, {:.0f} Hz, f {:.0f} Hz".format(word, *at) for word, at in moments if at is not None)
        return f"{self.name} {self.film}: {'; '.join(told)}"


def case_of(name: str) -> Case:
    """The case of a study."""
    study, _, target = name.partition("@")
    shipped, settings = STUDIES[study]
    return load_case(shipped, (*settings, *((f"accuracy.target={target}",) if target else ())))


def run_of(folder: Path, name: str) -> Run:
    """The run of a study, from `folder` or into it."""
    path, case = folder / f"{name}.h5", case_of(name)
    run = read_run(path) if path.exists() else (rundown if name.startswith("down") else runup)(case, path)
    lengths = {joined("clearance_m", place.name): place.geometry.clearance for place in film_places(case)}
    return replace(run, references=run.references | lengths)


def rows(run: Run) -> Iterator[Row]:
    """Its whirls, each with what became of it."""
    events = [asdict(event) for event in find_events(run)]
    told = list(zip(events, whirl_names(events), strict=True))
    for event, name in told:
        if name and event["kind"] == "onset":
            own = [e for e, other in told if other == name and e["film"] == event["film"] and e["t_s"] >= event["t_s"]]
            yield Row(name, event["film"], _moment(event), _first(own, "lock-in"), _first(own, "offset"))


def ratios(run: Run) -> Iterator[str]:
    """omega_F / omega_R of each ring: the largest, and over time."""
    times = np.arange(0.5, run.t_end_s + 1e-9, 0.5)
    for name in points(run.signals, "ring"):
        speed = np.maximum(run["speed_Hz"], 1.0)
        ratio = run[joined("ring_speed", name, "Hz")] / speed
        largest = float(ratio[run["time_s"] > 0.3].max())
        course = ", ".join(f"{np.interp(t, run['time_s'], ratio):.3f}" for t in times)
        yield f"{name} ring ratio: largest {largest:.3f}; every 0.5 s {course}".strip()


def _first(events: Sequence[Mapping[str, Any]], kind: str) -> tuple[float, float, float] | None:
    return next((_moment(event) for event in events if event["kind"] == kind), None)


def _moment(event: Mapping[str, Any]) -> tuple[float, float, float]:
    return event["t_s"], event["speed_Hz"], event["frequency_Hz"]


def main(folder: Path, names: Sequence[str]) -> None:
    """Print the rows of the studies."""
    for name in names or STUDIES:
        run = run_of(folder, name)
        sys.stdout.write(f"{name}: {run.status} at {run.t_end_s:.2f} s, {run.cost['cpu_s']:.0f} s CPU\n")
        for line in (*map(str, rows(run)), *ratios(run)):
            sys.stdout.write(f"  {line}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
