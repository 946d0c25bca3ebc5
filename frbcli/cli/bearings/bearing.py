"""`frb bearing`: the sheet of a bearing over rotor speed or eccentricity."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import OUTPUT, here
from frbcli.cli.options import LOAD_OPTION, speeds_option
from frbcli.cli.outputs import OutputOptions, outputs_options
from frbcli.cli.progress import computing

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.linear.bearing_sheet import BearingSheet
    from frbcli.plot.style import Picture

EXPLANATION = (
    "{}. Errors of stiffness and damping are over their largest entry. The rise is with {:.4g} kg/m^3 and "
    "{:.4g} J/(kg K). All per bearing."
)
SETTLED = "Coefficients of mass-conserving films are of oil that has settled; they do not determine stability."


@click.command()
@case_argument
@click.option("--over", type=click.Choice(["speed", "eccentricity"]), default="speed", show_default=True,
              help="Number that is varied; over the eccentricity the load follows.")  # fmt: skip
@speeds_option("20 over the range; over the eccentricity one, the highest")
@click.option("--load", type=LOAD_OPTION, metavar="LOAD", help='Load along -y on a single film, e.g. "30 N". '
              "[that of the rotor]")  # fmt: skip
@click.option("--ross", metavar="FILE", type=OUTPUT,
              help="Write stiffness and damping over speed as ROSS reads them, a file per film.")  # fmt: skip
@outputs_options("CASE-bearing.png, here")
@output_options
def command(
    case: Case,
    over: str,
    speeds: tuple[float, ...],
    load: float | None,
    ross: Path | None,
    outputs: OutputOptions,
    terminal: Terminal,
) -> int | None:
    """Resting position, coefficients, power loss, oil flow and pressure of every film of CASE."""
    from frbcli.errors import NotConverged
    from frbcli.linear.bearing_sheet import bearing_sheet, sommerfeld_chart
    from frbcli.linear.film_state import heat_capacity
    from frbcli.results.files.kinds import ROSS

    _check_options(over, speeds, load, ross)
    elements = _ross_files(case, ross)
    places = outputs.check(here(case.name, "-bearing.png"), *((file, ROSS) for file in elements.values()))
    with computing(terminal, case) as shown:
        if over == "speed":
            found = bearing_sheet(case, speeds or None, load, shown.counting())
        else:
            found = sommerfeld_chart(case, speed_Hz=speeds[0] if speeds else None, observe=shown.counting())
    _tell(terminal, found)
    _write_ross(terminal, found, elements)
    terminal.emit(
        {
            "command": "bearing",
            "case": case.name,
            "over": over,
            "oil_density_kg_m3": case.oil.density,
            "oil_heat_capacity_J_kg_K": heat_capacity(case),
            "points": found.table().documents(),
            **places.write(terminal, found.to_pandas, lambda: _figure(found)),
            "ross": list(elements.values()) or None,
        }
    )
    return None if any(not point.problem for point in found.points) else NotConverged.exit_code


def _figure(found: BearingSheet) -> Picture:
    from frbcli.plot.machine.bearing import bearing_figure

    return bearing_figure(found)


def _check_options(over: str, speeds: tuple[float, ...], load: float | None, ross: Path | None) -> None:
    if over == "eccentricity" and (load is not None or len(speeds) > 1):
        raise click.UsageError("Over eccentricity there is one --speed and no --load: the load follows from the films.")
    if over == "eccentricity" and ross is not None:
        raise click.UsageError("--ross is a table over speed.")


def _ross_files(case: Case, ross: Path | None) -> dict[str, Path]:
    """The file for ROSS of each film, if they are asked for."""
    if ross is None:
        return {}
    from frbcli.results.ross import ross_files
    from frbcli.scene.films import film_places

    return ross_files(ross, [place.name for place in film_places(case)])


def _write_ross(terminal: Terminal, found: BearingSheet, elements: dict[str, Path]) -> None:
    from frbcli.results.ross import write_ross

    table = found.to_pandas()
    for film, path in elements.items():
        write_ross(table[table["film"] == film], path)
        terminal.result(f"ROSS: {path}")


def _tell(terminal: Terminal, found: BearingSheet) -> None:
    from frbcli.columns import legend, table_of
    from frbcli.film.cavitation.table import law_named
    from frbcli.linear.columns import FILMS, MATRICES, SHEET, WARM
    from frbcli.linear.film_state import heat_capacity

    for film, law in zip(found.films, found.laws, strict=True):
        name = " ".join(filter(None, (found.case.heading, film)))
        warm = {} if found.case.heat is None else {WARM: "film when everything is warm"}
        matrices = zip(MATRICES, ("stiffness in N/um", "damping in N s/mm"), strict=True)
        states = table_of(SHEET, found.of(film))
        for table, title in ({FILMS: f"{name}, {law_named(law).label}"} | warm | dict(matrices)).items():
            terminal.show(title, states, table)
    terminal.sentence(EXPLANATION.format(legend(SHEET, FILMS), found.case.oil.density, heat_capacity(found.case)))
    if any(law_named(law).keeps_oil for law in found.laws):
        terminal.sentence(SETTLED)
    problems = [point for point in found.points if point.problem]
    if problems:
        terminal.result(f"No state at {len(problems)} of {len(found.points)} points. The first: {problems[0].problem}")
