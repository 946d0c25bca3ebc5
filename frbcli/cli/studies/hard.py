"""The hard cases on the terminal: their list, and their results."""

from __future__ import annotations

from collections.abc import Sequence

from frbcli.case.reading.hard import hard_cases
from frbcli.cli.common import Terminal
from frbcli.cli.progress import display
from frbcli.columns import table_of
from frbcli.errors import INTERRUPTED
from frbcli.studies.hard.cases import HARD_CASE, LIST, HardResult, run_hard_cases

NOT_AS_LISTED = 1  # a hard case that ends otherwise than the list says is a bug
EXPLANATION = (
    "error: largest deviation of the eccentricities from a fine reference until a whirl begins or the run ends; "
    "relative deviation of a force; stated: error that the run or test states. `frb cases --hard NAME` prints a case."
)


def list_hard(terminal: Terminal) -> None:
    """The table of all hard cases."""
    found = table_of(HARD_CASE, hard_cases())
    terminal.show("hard cases", found, LIST)
    terminal.remark("`frb cases --hard NAME` prints one as a case file.\n`frb cases --run-hard` runs them all.")
    terminal.emit({"command": "cases", "hard": found.documents()})


def hard_text(name: str) -> str:
    """The case file of a hard case: its shipped case with the settings put in. Raises InputError for an unknown name;
    a case that has to be refused is given as its base and its settings."""
    (hard,) = hard_cases([name])
    settings = "".join(f"#   --set '{text}'\n" for text in hard.settings)
    head = f"# {hard.hard}\n# The shipped case {hard.base} for `frb {hard.command}`, with\n{settings}"
    return head + (hard.case().source_text if hard.end != "input-error" else "# which has to be refused.\n")


def run_hard(names: Sequence[str], terminal: Terminal) -> int:
    """Run hard cases, all of them for no name, and report; returns the exit code."""
    with display(terminal) as shown:
        found = run_hard_cases(names, lambda *told: shown.line(_progress(*told)))
    terminal.show("hard cases", found.table())
    terminal.sentence(EXPLANATION)
    for result in found.results:
        if result.message:
            terminal.sentence(f"{result.hard.name}: {cause_of(result)}")
    wrong = [result for result in found.results if not result.ok]
    for result in wrong:
        terminal.sentence(f"NOT AS LISTED: {result.hard.name}: {'; '.join(result.problems)}")
    cpu_s = sum(result.cpu_s for result in found.results)
    done = len(found.results)
    terminal.result(f"{done - len(wrong)} of {done} end as listed; {cpu_s:.0f} s of CPU time.")
    if not found.complete:
        terminal.result("Interrupted: the other cases were not run.")
    whole = {} if found.complete else {"status": "interrupted"}
    terminal.emit({"command": "cases", **whole, "hard": found.table().documents(), "ok": found.ok})
    if not found.complete:
        return INTERRUPTED
    return 0 if found.ok else NOT_AS_LISTED


def _progress(result: HardResult, done: int, whole: int) -> str:
    return f"{done}/{whole}  {result.hard.name}: {result.status}{'' if result.ok else ', NOT AS LISTED'}"


def cause_of(result: HardResult) -> str:
    """Why a case ended early: its message, and the cause from the list."""
    return "; ".join(text.rstrip(".") for text in (result.message, result.hard.why) if text)
