"""`frb bearing`: the sheet of a bearing over rotor speed or eccentricity."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.pictures.picture_options import picture_options
from frbcli.cli.pictures.pictures import draw
from frbcli.cli.quantities import LOAD_OPTION, SPEED_OPTION
from frbcli.cli.runs.compiling import compilation_shown
from frbcli.cli.runs.live import counting, live_lines

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.linear.bearing_sheet import BearingSheet

WIDTH = 80
EXPLANATION = (
    "{}. Errors of stiffness and damping are over their largest entry. The rise is with {:.4g} kg/m^3 and "
    "{:.4g} J/(kg K). All per bearing."
)
SETTLED = "Coefficients of mass-conserving films are of oil that has settled; they do not determine stability."


@click.command()
@case_argument
@click.option("--over", type=click.Choice(["speed", "eccentricity"]), default="speed", show_default=True,
              help="At what the films are computed; over eccentricity the load follows.")  # fmt: skip
@click.option("--speed", "speeds", multiple=True, type=SPEED_OPTION, metavar="SPEED",
              help='Rotor speed, e.g. "25 Hz". Repeatable over speed. [20 over the range; the highest]')  # fmt: skip
@click.option("--load", type=LOAD_OPTION, metavar="LOAD", help='Along -y on a single film, e.g. "30 N". [of the rotor]')
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [CASE-bearing.png, here]")
@click.option("--no-picture", is_flag=True, help="No picture.")
@click.option("--csv", metavar="FILE", type=OUTPUT, help="Write all numbers as a table, too.")
@click.option("--ross", metavar="FILE", type=OUTPUT,
              help="Write stiffness and damping over speed as ROSS reads them: a file per film.")  # fmt: skip
@picture_options
@output_options
def command(
    case: Case,
    over: str,
    speeds: tuple[float, ...],
    load: float | None,
    output: Path | None,
    no_picture: bool,
    csv: Path | None,
    ross: Path | None,
    terminal: Terminal,
) -> int | None:
    """Resting position, coefficients, power loss, oil flow and pressure of every film of CASE."""
    from frbcli.errors import NotConverged
    from frbcli.linear.bearing_sheet import bearing_sheet, sommerfeld_chart
    from frbcli.linear.film_state import heat_capacity
    from frbcli.results.files.kinds import ROSS, TABLES

    _check_options(over, speeds, load, output, no_picture, ross)
    picture = None if no_picture else output or here(case.name, "-bearing.png")
    elements = _ross_files(case, ross)
    check_outputs((csv, TABLES["csv"]), *((file, ROSS) for file in elements.values()), picture=picture)
    with live_lines(terminal) as show, compilation_shown(terminal, case, show):
        if over == "speed":
            found = bearing_sheet(case, speeds or None, load, counting(terminal, show))
        else:
            found = sommerfeld_chart(case, speed_Hz=speeds[0] if speeds else None, observe=counting(terminal, show))
    _tell(terminal, found)
    if csv is not None:
        from frbcli.results.files.tables import write_table

        write_table(found.to_pandas(), csv)
        terminal.result(f"table: {csv}")
    _write_ross(terminal, found, elements)
    if picture is not None:
        from frbcli.plot.machine.bearing import bearing_figure

        picture = draw(terminal, lambda: bearing_figure(found), picture)
    terminal.emit(
        {
            "command": "bearing",
            "case": case.name,
            "over": over,
            "oil_density_kg_m3": case.oil.density,
            "oil_heat_capacity_J_kg_K": heat_capacity(case),
            "points": found.table().documents(),
            "picture": picture,
            "csv": csv,
            "ross": list(elements.values()) or None,
        }
    )
    return None if any(not point.problem for point in found.points) else NotConverged.exit_code


def _check_options(
    over: str, speeds: tuple[float, ...], load: float | None, output: Path | None, no_picture: bool, ross: Path | None
) -> None:
    if no_picture and output is not None:
        raise click.UsageError("-o names the picture that --no-picture leaves out.")
    if over == "eccentricity" and (load is not None or len(speeds) > 1):
        raise click.UsageError("Over eccentricity there is one --speed and no --load: the films tell it.")
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
    from frbcli.columns import heads, legend, table_of
    from frbcli.film.cavitation.table import law_named
    from frbcli.linear.columns import FILMS, MATRICES, SHEET, WARM
    from frbcli.linear.film_state import heat_capacity

    for film, law in zip(found.films, found.laws, strict=True):
        name = " ".join(filter(None, (found.case.title or found.case.name, film)))
        warm = {} if found.case.heat is None else {WARM: "film when everything is warm"}
        matrices = zip(MATRICES, ("stiffness in N/um", "damping in N s/mm"), strict=True)
        states = table_of(SHEET, found.of(film))
        for table, title in ({FILMS: f"{name}, {law_named(law).label}"} | warm | dict(matrices)).items():
            terminal.table(title, heads(SHEET, table), states.cells(table))
    told = EXPLANATION.format(legend(SHEET, FILMS), found.case.oil.density, heat_capacity(found.case))
    terminal.result(fill(told, WIDTH, break_long_words=False))
    if any(law_named(law).keeps_oil for law in found.laws):
        terminal.result(fill(SETTLED, WIDTH))
    problems = [point for point in found.points if point.problem]
    if problems:
        terminal.result(f"No state at {len(problems)} of {len(found.points)} points. The first: {problems[0].problem}")
