"""What `--onset-spread` shows: the rotor speeds between which a whirl begins in runs that differ a little."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from frbcli.cli.progress import display, progress_line

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal
    from frbcli.results.store import Run
    from frbcli.runs.march import Progress
    from frbcli.studies.onset_spread import OnsetRun, OnsetSpread


def spread_shown(case: Case, run: Run, terminal: Terminal) -> dict[str, Any]:
    """The ensemble as text, and as part of the JSON document."""
    from frbcli.studies.onset_spread import onset_spread

    try:
        with display(terminal) as shown:

            def watch(number: int, count: int, progress: Progress) -> None:
                shown.redraw(f"run {number} of {count}\n{progress_line(progress)}")

            found = onset_spread(case, run, watch)
    except KeyboardInterrupt:
        terminal.remark("Interrupted before all runs of the onset had ended.")
        return {"status": "interrupted"}
    if found is None:
        terminal.result("No whirl begins in this run: its onset has no spread.")
        return {"status": "no-onset"}
    _show(found, terminal)
    low, high = found.interval_Hz
    return {
        "status": "finished",
        "onset_Hz": found.onset_Hz,
        "threshold_Hz": found.threshold_Hz,
        "lowest_Hz": low,
        "highest_Hz": high if math.isfinite(high) else None,
        "cpu_s": found.cpu_s,
        "runs": [
            {"changed": each.changed, "onset_Hz": _number(each.onset_Hz), "to_Hz": each.to_Hz, "problem": each.problem}
            for each in found.runs
        ],
    }


def _show(found: OnsetSpread, terminal: Terminal) -> None:
    low, high = found.interval_Hz
    rows = [("this run", f"{found.onset_Hz:.1f}"), *((each.changed, _onset(each)) for each in found.runs)]
    if found.threshold_Hz is not None:
        rows.append(("linear threshold of stability", f"{found.threshold_Hz:.1f}"))
    terminal.table("onset of the first whirl", ("run", "speed in Hz"), rows)
    most = f"{high:.1f} Hz" if math.isfinite(high) else "the end of a run without one"
    told = f"The onset lies between {low:.1f} Hz and {most} ({found.cpu_s:.3g} s of CPU time). {found.note}".strip()
    terminal.sentence(told)


def _onset(run: OnsetRun) -> str:
    if run.problem:
        return f"not run: {run.problem}"
    return f"none until {run.to_Hz:.1f}" if math.isnan(run.onset_Hz) else f"{run.onset_Hz:.1f}"


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value
