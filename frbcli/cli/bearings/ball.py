"""`frb bearing` of a case whose bearings have balls and no film: its text, and its JSON document."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal
from frbcli.cli.files import forced, here
from frbcli.cli.outputs import OutputOptions
from frbcli.cli.progress import display
from frbcli.errors import NotConverged

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from frbcli.case.schema import Case
    from frbcli.linear.sheets.ball import BallSheet


def ball_sheet(
    case: Case, speeds: Sequence[float], loads: Sequence[float], ross: Path | None, outputs: OutputOptions,
    terminal: Terminal,
) -> int | None:  # fmt: skip
    """Compute, show and write the sheet; the exit code."""
    from frbcli.linear.sheets.ball import ball_bearing_sheet
    from frbcli.results.export import ross_files
    from frbcli.results.files.write import ROSS

    if ross is not None and len(loads) > 1:
        raise click.UsageError("--ross is a table over speed, at one load.")
    names = [bearing.name for bearing in case.elements if bearing.kind == "ball"]
    elements = ross_files(ross, names) if ross is not None else {}
    places = outputs.check(here(case.name, "-bearing.png"), *((file, ROSS) for file in elements.values()))
    with display(terminal) as shown:
        sheet = ball_bearing_sheet(case, speeds or None, loads, shown.counting())
    _show(terminal, sheet)
    _write_ross(terminal, sheet, elements)
    terminal.emit(
        {
            "command": "bearing",
            "case": case.name,
            "points": sheet.table().documents(),
            **places.write(terminal, sheet),
            "ross": list(elements.values()) or None,
        }
    )
    return None if any(not point.problem for point in sheet.points) else NotConverged.exit_code


def _show(terminal: Terminal, sheet: BallSheet) -> None:
    from frbcli.columns import legend, table_of
    from frbcli.linear.columns import BALL_SHEET, BALLS, FREQUENCIES, STIFFNESSES

    for bearing in sheet.bearings:
        name, states = " ".join(filter(None, (sheet.case.heading, bearing))), sheet.of(bearing)
        titles = {BALLS: f"{name}, balls", STIFFNESSES: "rings, um and N/um", FREQUENCIES: "frequencies, Hz"}
        for table, title in titles.items():
            terminal.show(title, table_of(BALL_SHEET, states), table)
    terminal.sentence(f"{legend(BALL_SHEET, BALLS)}. All per bearing, with one ball in the line of the load.")
    problems = [point for point in sheet.points if point.problem]
    if problems:
        terminal.result(f"No state at {len(problems)} of {len(sheet.points)} points. The first: {problems[0].problem}")


def _write_ross(terminal: Terminal, sheet: BallSheet, elements: dict[str, Path]) -> None:
    from frbcli.results.export import write_ross

    table = sheet.to_pandas().rename(columns={"bearing": "film"})
    for name, path in elements.items():
        write_ross(table[table["film"] == name], path, forced())
        terminal.result(f"ROSS: {path}")
