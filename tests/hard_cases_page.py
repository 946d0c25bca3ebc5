"""docs/hard-cases.md: `cd tests && python -m hard_cases_page` computes all hard cases and writes it."""

from __future__ import annotations

import sys
from pathlib import Path
from textwrap import fill

from frbcli.cli.hard import write_page
from frbcli.studies.hard.cases import HardResult, HardResults, run_hard_cases

PAGE = Path(__file__).parents[1] / "docs" / "hard-cases.md"
SURE = 0.3  # of an error that a reference may be off by itself, for the error to be well known
INTRODUCTION = """\
# Hard cases

Shipped cases with settings that bring a program to its limits, and how each ended. Written by
`cd tests && python -m hard_cases_page`; the list is `cases/hard/hard-cases.toml`.

```sh
frb cases --hard                      # lists them
frb cases --hard reversed             # prints one as a case file; -o FILE copies it
frb cases --run-hard                  # runs them all, each within its time, and says how each ended
frb cases --run-hard reversed no-speed --json
```

The command ends with 0 if every case ended as the list says, else with 1. A case is as listed if it

- ended with the status that it has to end with, within its time, and with the events that it has to have;
- has no signal, force or pressure that is not a finite number, and less than 0.1 % of its oil unaccounted for;
- is off by no more than the program itself states, where it has a reference.

**error**: largest deviation of the eccentricities from those of the same case with a finer mesh and a tighter tolerance
(`fine` in the list, kept in `cases/hard/references.json`, made anew by `cd tests && python -m hard_references`), until
a whirl begins or the run ends; of a kinematic test, that of the force, relative. **certain to**: how far that reference
may itself be off, told by a second one with two thirds of its mesh each way and twice its tolerance; with cells and in
kinematic tests 3.3 times the distance of the two, as if errors fell with the power 0.66 of the mesh. **stated**: the
error that the run or the test itself reports, of the eccentricity or the force. No reference have the cases that whirl
from the start or end early, `pressed-into-the-shell`, and journals that are moved over time (squeeze and whirl).
"""


def tell(result: HardResult, done: int, whole: int) -> None:
    sys.stderr.write(f"{done}/{whole} {result.hard.name}: {result.status} {'; '.join(result.problems)}\n")


def doubtful(found: HardResults) -> str:
    """Which references are not certain to much less than the errors that they tell, and where that matters."""
    known = [r for r in found.results if r.error is not None and r.certain is not None and r.reported is not None]
    vague = [r.hard.name for r in known if r.certain > SURE * r.error]
    open_ones = [r.hard.name for r in known if r.error + r.certain > r.reported]
    said = [
        f"Not certain to less than {SURE:g} of the errors that they tell are the references of {_list(vague)}: there "
        "the error is known within a factor only.",
        f"The stated error bounds error and uncertainty of the reference together, but in {_list(open_ones)}.",
    ]
    return "\n\n".join(fill(text, 120, break_long_words=False, break_on_hyphens=False) for text in said) + "\n"


def _list(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "no case"


if __name__ == "__main__":
    results = run_hard_cases(observe=tell)
    write_page(results, PAGE, f"{INTRODUCTION}\n{doubtful(results)}")
