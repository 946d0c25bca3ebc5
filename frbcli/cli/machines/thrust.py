"""`frb thrust`: the sheet of a thrust bearing over gap, load and speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import here
from frbcli.cli.options import LENGTH_OPTION, LOAD_OPTION, Command, speeds_option
from frbcli.cli.progress import OutputOptions, display, outputs_options

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.linear.sheets.thrust import ThrustSheet


@click.command(cls=Command)
@case_argument
@click.option("--gap", "gaps", multiple=True, type=LENGTH_OPTION, metavar="GAP",
              show_default="10 over the range, without --load",
              help='Gap over the lands, e.g. "12 um". Repeatable.')  # fmt: skip
@click.option("--load", "loads", multiple=True, type=LOAD_OPTION, metavar="LOAD",
              help='Load, e.g. "40 N". Repeatable.')  # fmt: skip
@speeds_option("the highest of CASE")
@outputs_options("CASE-thrust.png, here")
@output_options
def command(
    case: Case,
    gaps: tuple[float, ...],
    loads: tuple[float, ...],
    speeds: tuple[float, ...],
    outputs: OutputOptions,
    terminal: Terminal,
) -> None:
    """Load, loss, oil flow, pressure, stiffness and damping of every thrust bearing of CASE."""
    from frbcli.linear.sheets.thrust import thrust_sheet

    places = outputs.check(here(case.name, "-thrust.png"))
    with display(terminal) as shown:
        sheet = thrust_sheet(case, gaps or None, speeds or None, loads, shown.counting())
    _show(terminal, sheet)
    terminal.emit(
        {
            "command": "thrust",
            "case": case.name,
            "points": sheet.table().documents(),
            **places.write(terminal, sheet),
        }
    )


def _show(terminal: Terminal, sheet: ThrustSheet) -> None:
    from frbcli.columns import legend, table_of
    from frbcli.linear.columns import FILMS, THRUST, TILT_DAMPING, TILT_STIFFNESS

    titles = {FILMS: "thrust bearing", TILT_STIFFNESS: "stiffness in tilt, N m", TILT_DAMPING: "damping in tilt, N m s"}
    for bearing in sheet.bearings:
        states = table_of(THRUST, sheet.of(bearing))
        terminal.result(" ".join(filter(None, (sheet.case.heading, bearing))))
        for table, title in titles.items():
            terminal.show(title, states, table)
    terminal.sentence(f"{legend(THRUST, FILMS)}. Errors are the change from a mesh of half as many elements per side.")
