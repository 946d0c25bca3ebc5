"""A measurement beside a run in the output of `frb compare`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from frbcli.cli.common import Terminal
from frbcli.cli.files import beside
from frbcli.cli.outputs import OutputOptions
from frbcli.cli.progress import display
from frbcli.cli.studies.measured import run_of
from frbcli.columns import documents, table_of

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.studies.against import AgainstMeasured

KINDS = ("critical-speed", "self-excited", "onset", "offset", "lock-in")


def beside_measured(
    terminal: Terminal, run_file: Path, file: Path, measurement: Measurement | None, signal: str,
    outputs: OutputOptions,
) -> None:  # fmt: skip
    """Tables, picture and JSON of a run and a measurement."""
    from frbcli.results.store import read_run
    from frbcli.studies.against import DEVIATIONS, against_measured

    places = outputs.check(beside(run_file, "-measured.png"))
    with display(terminal):
        found = against_measured(read_run(run_file), run_of(file, measurement), signal)
    _tell(terminal, found)
    terminal.emit(
        {
            "command": "compare",
            "run": run_file,
            "measured": file,
            "events": {"computed": found.computed_events, "measured": found.measured_events},
            "deviations": documents(DEVIATIONS, found.deviations()),
            **places.write(terminal, found),
        }
    )


def _tell(terminal: Terminal, found: AgainstMeasured) -> None:
    from frbcli.studies.against import DEVIATIONS

    rows = []
    for kind in KINDS:
        speeds = [
            next((event["speed_Hz"] for event in events if event["kind"] == kind), None)
            for events in (found.computed_events, found.measured_events)
        ]
        if any(speed is not None for speed in speeds):
            rows.append((kind, *("-" if speed is None else f"{speed:.1f} Hz" for speed in speeds)))
    where = found.point.replace("_", " ")
    terminal.table(f"first events of the {where}, rotor speed", ("event", "computed", "measured"), rows)
    terminal.show("ridges", table_of(DEVIATIONS, found.deviations()))
