"""The output of `--onset-spread`: rotor speeds between which a whirl begins in runs that differ a little."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from frbcli.cli.progress import display, progress_line

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal
    from frbcli.results.store import Run
    from frbcli.runs.march import Progress
    from frbcli.studies.onset_spread import OnsetSpread


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
        "highest_Hz": high,
        "cpu_s": found.cpu_s,
        "runs": found.table().documents(),
    }


def _show(found: OnsetSpread, terminal: Terminal) -> None:
    low, high = found.interval_Hz
    table = found.table()
    rows = [("this run", f"{found.onset_Hz:.1f}"), *table.cells()]
    if found.threshold_Hz is not None:
        rows.append(("linear threshold of stability", f"{found.threshold_Hz:.1f}"))
    terminal.table("onset of the first whirl", table.heads(), rows)
    most = f"{high:.1f} Hz" if math.isfinite(high) else "the end of a run without one"
    told = f"The onset lies between {low:.1f} Hz and {most} ({found.cpu_s:.3g} s of CPU time). {found.note}".strip()
    terminal.sentence(told)
