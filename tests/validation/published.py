"""Run-ups in the published two-phase form: `cd tests && python -m validation.published [FOLDER [COUNT]]`.

validation.validate does not repeat them: this writes what they gave to data/published-runs.csv, and validate reads it.
Runs are kept in FOLDER, where it is given, and taken from it the next time; COUNT: only the first so many of RUNS.
"""

import csv
import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from paths import DATA, rows_of

from frbcli.analysis.events import find_events
from frbcli.case.reading.load import load_case
from frbcli.results.store import Run
from validation.chapter6 import LOOSE, RAMP_Hz
from validation.measured import listed
from validation.measures import kept_runup

FILE = "published-runs.csv"
SETTINGS = (
    "film.cavitation=two-phase", "film.two-phase.form=published", "accuracy.target=1e-2", "accuracy.mesh=[10, 40]"
)  # fmt: skip
COLUMNS = ("what", "case", "settings", "until_s", "status", "onset_s", "eps_1s", "eps_4s", "created_percent", "cpu_s")
BESIDE = ("conservative_1s", "penalty_1s")
CONSERVATIVE, PENALTY = "film.cavitation=two-phase", "film.cavitation=penalty"
SHORT_OF_s = 1e-3  # a run may end so much before the time that is looked at
CIRCUMFERENTIAL, AXIAL, RIGID = "jeffcott-two-phase", "axial-groove-two-phase", "rigid-two-phase"


HEAD = """## Run-ups in the published form

On 40 x 10 cells of a section with a target of 1e-2 (`python -m validation.published`). Eccentricities after 1 s on
cells, on 20 x 10 quadratic elements as in the source, in the conservative form and the penalty model; then after 4 s,
the onset, and the oil created over what left the film. Around: circumferential groove.

| run | until, s | at 1 s: cells, elements, conservative, penalty | at 4 s | onset, s | created, % |
| --- | --- | --- | --- | --- | --- |"""


@dataclass(frozen=True)
class Wanted:
    """A run-up of a shipped case for its first `until_s` seconds. what: in words, as the page has it."""

    what: str
    case: str
    until_s: float
    settings: tuple[str, ...] = ()


SOFT, BATH, TWO_BAR = "film.two-phase.steepness=0.9", "bearing.ends=oil-bath", "bearing.supply.pressure=2 bar"
RUNS = (
    Wanted("circumferential groove, 1 bar, x_1 = 0.9", CIRCUMFERENTIAL, 1.0, (SOFT,)),
    Wanted("circumferential groove, 1 bar, x_1 = 0.99", CIRCUMFERENTIAL, 1.0),
    Wanted("circumferential groove, 1 bar, x_1 = 0.99, oil bath", CIRCUMFERENTIAL, 1.0, (BATH,)),
    Wanted("circumferential groove, 2 bar, x_1 = 0.9", CIRCUMFERENTIAL, 1.0, (SOFT, TWO_BAR)),
    Wanted("axial groove, 1 bar, x_1 = 0.99", AXIAL, 1.0),
    Wanted("axial groove, 2 bar, x_1 = 0.99", AXIAL, 1.0, (TWO_BAR,)),
    Wanted("rigid rotor, circumferential groove, 1 bar, x_1 = 0.99", RIGID, 1.0),
    Wanted("circumferential groove, 1 bar, x_1 = 0.9", CIRCUMFERENTIAL, 7.0, (SOFT,)),
    Wanted("circumferential groove, 1 bar, x_1 = 0.99", CIRCUMFERENTIAL, 7.0),
    Wanted("circumferential groove, 2 bar, x_1 = 0.99", CIRCUMFERENTIAL, 7.0, (TWO_BAR,)),
)


def _after(run: Run, t: float) -> float:
    """Eccentricity after t s, NaN if the run has not come so far."""
    reached = run["time_s"][-1] > t - SHORT_OF_s
    return float(np.interp(t, run["time_s"], run["eccentricity"])) if reached else math.nan


def beside(folder: Path, wanted: Wanted) -> dict[str, str]:
    """Eccentricities after 1 s with the conservative form and the penalty model."""
    first = (LOOSE, *wanted.settings, f"speed.to={RAMP_Hz:g} Hz", "speed.duration=1 s")
    runs = [kept_runup(folder, load_case(wanted.case, (model, *first))) for model in (CONSERVATIVE, PENALTY)]
    return dict(zip(BESIDE, (f"{_after(run, 1.0):.3f}" for run in runs), strict=True))


def measured(folder: Path, wanted: Wanted) -> dict[str, str]:
    """A row of FILE. A run that was interrupted goes on."""
    first = (f"speed.to={RAMP_Hz * wanted.until_s:g} Hz", f"speed.duration={wanted.until_s:g} s")
    return row(wanted, kept_runup(folder, load_case(wanted.case, (*SETTINGS, *wanted.settings, *first))))


def row(wanted: Wanted, run: Run) -> dict[str, str]:
    """What a run gives, as far as it has come."""
    onset = next((event.t_s for event in find_events(run) if event.kind == "onset"), math.nan)
    after = [_after(run, t) for t in (1.0, 4.0)]
    created = 100.0 * run.cost["oil_created_m3"] / run.cost["oil_out_m3"]
    figures = (run.status, listed([onset], ".2f"), *(listed([value], ".3f") for value in after),
               f"{round(created)}", f"{run.cost['cpu_s']:.1f}")  # fmt: skip
    told = (wanted.what, wanted.case, "; ".join(wanted.settings), f"{run.t_end_s:.2f}", *figures)
    return dict(zip(COLUMNS, told, strict=True))


def table() -> list[str]:
    """The section on them."""
    lines, elements = [HEAD], {row["what"]: row["eps_1s"] for row in rows_of("published-runs-on-elements.csv")}
    for found in rows_of(FILE):
        found = {name: "-" if value == "none" else value for name, value in found.items()}
        first = (found["eps_1s"], elements.get(found["what"], "-"), found["conservative_1s"], found["penalty_1s"])
        what = found["what"].replace("circumferential groove", "around").replace("axial groove", "axial")
        shown = (what, f"{float(found['until_s']):g}", ", ".join(first), found["eps_4s"], found["onset_s"],
                 found["created_percent"])  # fmt: skip
        lines.append(f"| {' | '.join(shown)} |")
    return lines


def main(folder: Path, count: int) -> None:
    """Run, and write the file anew after each run."""
    rows = []
    for wanted in RUNS[:count]:
        rows.append({**measured(folder, wanted), **beside(folder, wanted)})
        with (DATA / FILE).open("w", encoding="utf-8", newline="") as file:
            file.write(f"# python -m validation.published; all with {' '.join(SETTINGS)}\n")
            table = csv.DictWriter(file, COLUMNS + BESIDE, lineterminator="\n")
            table.writeheader()
            table.writerows(rows)


if __name__ == "__main__":
    most = int(sys.argv[2]) if len(sys.argv) > 2 else len(RUNS)
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]), most)
    else:
        with tempfile.TemporaryDirectory() as name:
            main(Path(name), most)
