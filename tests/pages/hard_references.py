"""The references of the hard cases: `cd tests && python -m pages.hard_references [NAME ...]` computes them anew, some
minutes for all, and writes cases/hard/references.json.
"""

import json
import sys
import time
from dataclasses import asdict, replace

import numpy as np
from numpy.typing import NDArray
from paths import ROOT
from studies.hard_runs.cases import REFERENCES, RUNS, Outcome, Reference, apart, outcome

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import HardCase, hard_cases
from frbcli.case.schema import Case
from frbcli.scene.planning.plan import make_plan
from frbcli.studies.accuracy import planned_rung

FILE = ROOT / "cases" / "hard" / REFERENCES
MOMENTS = 48  # times at which a run is compared with its reference
DIGITS = 7  # of the numbers that a reference keeps
ORDER = 1.0  # of the error on cells, the lowest that was seen: Peeken's films; others have 1.5 and more
LESS, LOOSER = 2 / 3, 2.0  # second reference: factors of the mesh in each direction and of the tolerance


def main(names: list[str]) -> None:
    """Compute the references of these hard cases, all of them for none; drop those of cases that are gone."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    wanted = {hard.name: hard for hard in hard_cases() if hard.fine}
    for name, hard in wanted.items():
        if names and name not in names:
            continue
        reference = make_reference(hard)
        kept[name] = asdict(reference)
        sys.stderr.write(f"{name}: {reference.status}, {reference.cpu_s:g} s\n")
        rows = (f"{json.dumps(key)}: {json.dumps(kept[key])}" for key in wanted if key in kept)
        FILE.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


def make_reference(hard: HardCase) -> Reference:
    """The reference of a hard case, computed with its fine settings, and its uncertainty.

    Raises ValueError if the run on the coarser mesh ends otherwise.
    """
    begun = time.process_time()
    fine = hard.case(fine=True)
    found = outcome(hard.command, fine)
    count = max(1, int(np.searchsorted(found.times_s, found.until_s, side="right")))
    kept = np.unique(np.linspace(0, count - 1, MOMENTS).astype(int))
    values = {name: _rounded(row[kept] if len(found.times_s) else row) for name, row in found.values.items()}
    times = _rounded(found.times_s[kept]) if len(found.times_s) else []
    made = Reference(found.status, values, times, found.until_s, round(time.process_time() - begun, 1))
    settings, reach = _less(hard, fine)
    other = outcome(hard.command, load_case(hard.base, (*hard.settings, *hard.fine, *settings)))
    return replace(made, change=float(f"{reach * _change(hard, made, other):.2g}"))


def _change(hard: HardCase, made: Reference, other: Outcome) -> float:
    if other.status != made.status:
        raise ValueError(f"{hard.name}: {other.status} on the coarser mesh, {made.status} on the fine one")
    return apart(other, made)[0]


def _less(hard: HardCase, fine: Case) -> tuple[tuple[str, ...], float]:
    """Settings for a coarser mesh and a larger tolerance, and the factor of the change that gives the reference
    uncertainty: on cells e(h) = change / ((1 / LESS)^ORDER - 1); on elements the change itself."""
    on_cells = 1.0 / ((1.0 / LESS) ** ORDER - 1.0)
    if hard.command not in RUNS:
        return (_mesh(fine.accuracy.mesh),), on_cells
    plan = make_plan(fine)
    settings = _mesh(planned_rung(plan).mesh), f"accuracy.tolerance={LOOSER * plan.tolerance!r}"
    return settings, 1.0 if plan.cells is None else on_cells


def _mesh(mesh: tuple[int, int] | None) -> str:
    if mesh is None:
        raise ValueError("a reference needs a mesh")
    return f"accuracy.mesh=[{round(LESS * mesh[0])}, {4 * round(0.25 * LESS * mesh[1])}]"


def _rounded(values: NDArray[np.float64]) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]


if __name__ == "__main__":
    main(sys.argv[1:])
