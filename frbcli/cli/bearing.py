"""`frb bearing`: the sheet of a bearing over rotor speed or eccentricity."""

from __future__ import annotations

import math
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.compiling import compilation_shown
from frbcli.cli.files import OUTPUT, check_outputs, here
from frbcli.cli.live import counting, live_lines
from frbcli.cli.picture_options import picture_options
from frbcli.cli.pictures import draw
from frbcli.cli.quantities import LOAD_OPTION, SPEED_OPTION

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.linear.bearing_sheet import BearingSheet
    from frbcli.linear.film_state import Array as Matrix
    from frbcli.linear.film_state import FilmState

COLUMNS = 80
NUMBERS = ("Hz", "eps", "att.", "So", "h", "p", "loss", "flow", "rise", "err.")
HEAT = ("Hz", "eps", "temperature, degC", "viscosity, mPa s", "clearance, um")
ZERO_CELSIUS = 273.15
COEFFICIENTS = ("Hz", "eps", "xx", "xy", "yx", "yy", "err.")
EXPLANATION = (
    "att.: attitude angle; So: Sommerfeld number (3.14); h: smallest film thickness, um; p: largest pressure, "
    "bar, absolute; loss: power, W; flow: oil that leaves at the ends, mm^3/s; rise: of its temperature if it took all "
    "of the power, with {density:.4g} kg/m^3 and {capacity:.4g} J/(kg K), K; err.: relative error of the force, and of "
    "stiffness and damping over their largest entry, from other meshes. All per bearing."
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
    from frbcli.results.kinds import ROSS, TABLES

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
        from frbcli.results.tables import write_table

        write_table(found.to_pandas(), csv)
        terminal.result(f"table: {csv}")
    _write_ross(terminal, found, elements)
    if picture is not None:
        from frbcli.plot.bearing import bearing_figure

        picture = draw(terminal, lambda: bearing_figure(found), picture)
    terminal.emit(
        {
            "command": "bearing",
            "case": case.name,
            "over": over,
            "oil_density_kg_m3": case.oil.density,
            "oil_heat_capacity_J_kg_K": heat_capacity(case),
            "points": [_point(point) for point in found.points],
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
    from frbcli.film.cavitation.table import law_named
    from frbcli.linear.film_state import heat_capacity

    for film, law in zip(found.films, found.laws, strict=True):
        states = found.of(film)
        name = " ".join(filter(None, (found.case.title or found.case.name, film)))
        terminal.table(f"{name}, {law_named(law).label}", NUMBERS, map(_numbers, states))
        if found.case.heat is not None:
            terminal.table("film when everything is warm", HEAT, map(_heat, states))
        terminal.table("stiffness in N/um", COEFFICIENTS, (_entries(state, state.stiffness, 1e-6) for state in states))
        terminal.table("damping in N s/mm", COEFFICIENTS, (_entries(state, state.damping, 1e-3) for state in states))
    told = EXPLANATION.format(density=found.case.oil.density, capacity=heat_capacity(found.case))
    terminal.result(fill(told, COLUMNS, break_long_words=False))
    if any(law_named(law).keeps_oil for law in found.laws):
        terminal.result(fill(SETTLED, COLUMNS))
    problems = [point for point in found.points if point.problem]
    if problems:
        terminal.result(f"No state at {len(problems)} of {len(found.points)} points. The first: {problems[0].problem}")


def _numbers(state: FilmState) -> tuple[str, ...]:
    return (
        f"{state.speed_Hz:.3g}",
        f"{state.eccentricity:.3f}",
        _told(state.attitude_deg, ".1f"),
        _told(state.sommerfeld_number, ".3g"),
        f"{1e6 * state.film_thickness_min:.3g}",
        f"{1e-5 * state.p_max:.3g}",
        f"{state.power:.4g}",
        f"{1e9 * state.side_flow:.4g}",
        _told(state.temperature_rise, ".3g"),
        _error(state.force_error),
    )


def _heat(state: FilmState) -> tuple[str, ...]:
    return (
        f"{state.speed_Hz:.3g}",
        f"{state.eccentricity:.3f}",
        f"{state.temperature - ZERO_CELSIUS:.2f}",
        f"{1e3 * state.viscosity:.4g}",
        f"{1e6 * state.clearance:.4g}",
    )


def _error(value: float) -> str:
    return _told(value, ".0e").replace("e-0", "e-")


def _told(value: float, form: str) -> str:
    return "-" if math.isnan(value) else format(value, form)


def _entries(state: FilmState, matrix: Matrix | None, scale: float) -> tuple[str, ...]:
    values = () if matrix is None else (f"{scale * value:.4g}" for value in matrix.ravel())
    return (f"{state.speed_Hz:.4g}", f"{state.eccentricity:.3f}", *values, _error(state.error))


def _point(state: FilmState) -> dict[str, object]:
    return {
        "film": state.film,
        "status": "not-converged" if state.problem else "resting",
        "problem": state.problem,
        "speed_Hz": state.speed_Hz,
        "journal_speed_Hz": state.journal_speed_Hz,
        "shell_speed_Hz": state.shell_speed_Hz,
        "load_N": state.load,
        "displacement": state.displacement,
        "eccentricity": state.eccentricity,
        "attitude_deg": state.attitude_deg,
        "sommerfeld_number": state.sommerfeld_number,
        "film_thickness_min_m": state.film_thickness_min,
        "stiffness_N_m": state.stiffness,
        "damping_N_s_m": state.damping,
        "torque_N_m": state.torque,
        "power_W": state.power,
        "side_flow_m3_s": state.side_flow,
        "p_max_Pa": state.p_max,
        "temperature_rise_K": state.temperature_rise,
        "viscosity_Pa_s": state.viscosity,
        "clearance_m": state.clearance,
        "temperature_K": state.temperature,
        "error": {"force_relative": state.force_error, "coefficients_relative": state.error},
    }
