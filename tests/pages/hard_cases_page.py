"""docs/hard-cases.md: `cd tests && python -m pages.hard_cases_page` computes all hard cases and writes it."""

import sys
from pathlib import Path
from textwrap import fill

from paths import DOCS
from studies.hard_runs.cases import HardResult, HardResults, run_hard_cases

from frbcli.columns import short_number

PAGE = DOCS / "hard-cases.md"
SURE = 0.3  # reference uncertainty over error, below which the error is well known
INTRODUCTION = """\
# Hard cases

Shipped cases at the limits of models and numerics. `cd tests && python -m pages.hard_cases_page` runs the list
`cases/hard/hard-cases.toml` and writes this page.

```sh
frb cases --hard                      # lists them
frb cases --hard reversed             # prints one as a case file; -o FILE copies it
```

Each case reached its expected status and events within its time limit, with finite signals, forces and pressures, less
than 0.1 % of its oil unaccounted for, and an error below the stated one. All finish unless the last column names
another end.

- **error**: largest deviation of the eccentricities from a reference until a whirl or the end; of a kinematic test,
  relative deviation of the force. The reference has a finer mesh and a smaller tolerance
  (`cases/hard/references.json`, by `cd tests && python -m pages.hard_references`).
- **uncertainty**: of the reference, by a second one with two thirds of its mesh and twice its tolerance. *: the error
  is known to within a factor only.
- **stated error**: reported by the run or test.

Cases that whirl from the start or end early, squeeze and whirl have no reference. Rings that begin at 200 Hz without
turning have, and state, errors of four to six times the target of `floating-ring`, 4.5e-3.
"""


def show(result: HardResult, done: int, whole: int) -> None:
    sys.stderr.write(f"{done}/{whole} {result.hard.name}: {result.status} {'; '.join(result.problems)}\n")


def doubtful(found: HardResults) -> str:
    """Cases whose stated error does not bound error and reference uncertainty together."""
    known = [r for r in found.results if r.error is not None and r.certain is not None and r.reported is not None]
    open_ones = [r.hard.name for r in known if r.error + r.certain > r.reported]
    said = f"The stated error is larger than the sum of error and uncertainty for all cases except {_list(open_ones)}."
    return fill(said, 120, break_long_words=False, break_on_hyphens=False) + "\n"


def _list(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "no case"


def write_page(found: HardResults, page: Path, introduction: str) -> None:
    """The results as a page of the documentation."""
    rows = "".join(f"| {' | '.join(cells)} |\n" for cells in map(_cells, found.results))
    head = "| case | difficulty | error, uncertainty, stated error |\n"
    head += "|---" * 3 + "|\n"
    page.write_text(f"{introduction}\n{head}{rows}", encoding="utf-8")


def _cells(result: HardResult) -> tuple[str, ...]:
    hard = result.hard
    ended = f"ended as {result.status}" if result.status != hard.end else ""
    end = f"{hard.end}: {hard.why.rstrip('.')}" if hard.why else hard.end if hard.end != "finished" else ""
    error, certain, reported = map(short_number, (result.error, result.certain, result.reported))
    vague = result.error is not None and result.certain is not None and result.certain > SURE * result.error
    numbers = f"{error}, {certain}{'*' * vague}, {reported}" if {error, certain, reported} != {"-"} else ""
    notes = "; ".join(filter(None, (numbers, end, ended, *result.problems))).replace("|", "\\|")
    return f"`{hard.name}`", hard.hard, notes


if __name__ == "__main__":
    results = run_hard_cases(observe=show)
    write_page(results, PAGE, f"{INTRODUCTION}\n{doubtful(results)}")
