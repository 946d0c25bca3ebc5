"""docs/hard-cases.md: `cd tests && python -m pages.hard_cases_page` computes all hard cases and writes it."""

from __future__ import annotations

import sys
from pathlib import Path
from textwrap import fill

from paths import DOCS
from studies.hard_runs.cases import HardResult, HardResults, cause_of, run_hard_cases

from frbcli.columns import short_number

PAGE = DOCS / "hard-cases.md"
SURE = 0.3  # reference uncertainty over error, below which the error is well known
INTRODUCTION = """\
# Hard cases

Shipped cases with settings at the limits of the models and of the numerics, and how each ended. The page is written by
`cd tests && python -m pages.hard_cases_page`; the list is `cases/hard/hard-cases.toml`.

```sh
frb cases --hard                      # lists them
frb cases --hard reversed             # prints one as a case file; -o FILE copies it
```

`cd tests && python -m pages.hard_cases_page` runs them all, each with a time limit. A case ended as listed if

- it has the expected status and events, within its time limit;
- all signals, forces and pressures are finite, and less than 0.1 % of its oil is unaccounted for;
- its error is not larger than the error that it states, where it has a reference.

Columns:

- **error**: largest deviation of the eccentricities from the reference until a whirl begins or the run ends; of a
  kinematic test, relative deviation of the force. The reference is the same case with a finer mesh and a smaller
  tolerance (`fine` in the list; kept in `cases/hard/references.json`, written by
  `cd tests && python -m pages.hard_references`).
- **reference uncertainty**: estimated error of the reference, from a second reference with two thirds of its mesh in
  each direction and twice its tolerance. For finite-volume films and kinematic tests it is twice the difference of
  the two, which assumes an order of 1 in the mesh, the lowest that was seen; for other films it is the difference.
- **stated error**: error that the run or the test reports, of the eccentricity or the force.

Cells are those of the plan where a case does not set its mesh. Targets hold for run-ups from rest: rings that begin at
200 Hz without turning (`light-ring`, `light-spin`, `little-supply-rings`, `clearance-step-rings`) have errors of
four to six times the target of `floating-ring`, 4.5e-3, and so much is stated.

There is no reference for cases that whirl from the start or end early, for `pressed-into-the-shell`, and for squeeze
and whirl.
"""


def show(result: HardResult, done: int, whole: int) -> None:
    sys.stderr.write(f"{done}/{whole} {result.hard.name}: {result.status} {'; '.join(result.problems)}\n")


def doubtful(found: HardResults) -> str:
    """Cases whose reference uncertainty is close to the error, and cases whose stated error does not bound both."""
    known = [r for r in found.results if r.error is not None and r.certain is not None and r.reported is not None]
    vague = [r.hard.name for r in known if r.certain > SURE * r.error]
    open_ones = [r.hard.name for r in known if r.error + r.certain > r.reported]
    said = [
        f"The reference uncertainty is larger than {SURE:g} times the error for {_list(vague)}: their errors are known "
        "to within a factor only.",
        "The stated error is larger than the sum of error and reference uncertainty for all cases except "
        f"{_list(open_ones)}.",
    ]
    return "\n\n".join(fill(text, 120, break_long_words=False, break_on_hyphens=False) for text in said) + "\n"


def _list(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "no case"


def write_page(found: HardResults, page: Path, introduction: str) -> None:
    """The results as a page of the documentation."""
    rows = "".join(f"| {' | '.join(cells)} |\n" for cells in map(_cells, found.results))
    head = "| case | difficulty | expected | ended | error | reference uncertainty | stated error | CPU s | cause |\n"
    head += "| --- " * 9 + "|\n"
    page.write_text(f"{introduction}\n{head}{rows}", encoding="utf-8")


def _cells(result: HardResult) -> tuple[str, ...]:
    hard = result.hard
    notes = "; ".join(filter(None, (cause_of(result), *result.problems))).replace("|", "\\|")
    errors = map(short_number, (result.error, result.certain, result.reported))
    return f"`{hard.name}`", hard.hard, hard.end, result.status, *errors, f"{result.cpu_s:.1f}", notes


if __name__ == "__main__":
    results = run_hard_cases(observe=show)
    write_page(results, PAGE, f"{INTRODUCTION}\n{doubtful(results)}")
