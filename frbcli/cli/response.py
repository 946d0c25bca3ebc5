"""`frb response`: linear unbalance response over the rotor speed."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.cli.coefficient_error import errors_of, tell_coefficient_error
from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.compiling import compilation_shown
from frbcli.cli.live import counting, live_lines
from frbcli.cli.picture_options import picture_options
from frbcli.cli.pictures import check_place, draw
from frbcli.cli.quantities import SPEED_OPTION
from frbcli.cli.runs import OUTPUT, RUN, here
from frbcli.errors import Fault, InputError

if TYPE_CHECKING:
    from frbcli.analysis.order_tracking import OrderTrack
    from frbcli.case.schema import Case
    from frbcli.linear.response import Response
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run

MOST_SPEEDS, MOST_POINTS = 20, 4  # of the table; JSON, CSV and the picture have all
EXPLANATION = (
    "um: larger semi-axis of the orbit; deg: phase of the forward motion to the\n"
    "angle of the rotor; growth: of the least damped whirl in 1/s, which hides the\n"
    "rest where it is above 0."
)


@click.command()
@case_argument
@click.option("--speed", "speeds", multiple=True, type=SPEED_OPTION, metavar="SPEED",
              help='Exactly this rotor speed, e.g. "25 Hz". Repeatable. [120 over the range of the case]')  # fmt: skip
@click.option("--run", "run_file", type=RUN, metavar="RUN.h5",
              help="Draw the synchronous motion of a run of the case over the response.")  # fmt: skip
@click.option("-o", "--output", metavar="PICTURE", type=OUTPUT, help="PNG, PDF or SVG. [CASE-response.png, here]")
@click.option("--map", "as_map", is_flag=True,
              help="Draw the undamped critical speed map, over the stiffness of the bearings.")  # fmt: skip
@click.option("--no-picture", is_flag=True, help="No picture.")
@click.option("--csv", metavar="FILE", type=OUTPUT, help="Write all amplitudes and phases as a table, too.")
@picture_options
@output_options
def command(
    case: Case,
    speeds: tuple[float, ...],
    run_file: Path | None,
    output: Path | None,
    as_map: bool,
    no_picture: bool,
    csv: Path | None,
    terminal: Terminal,
) -> None:
    """Synchronous motion and bearing forces of CASE under its unbalance, with the films' stiffness and damping."""
    from frbcli.linear.response import response
    from frbcli.results.place import require_place
    from frbcli.results.store import read_run

    if no_picture and output is not None:
        raise click.UsageError("-o names the picture that --no-picture leaves out.")
    picture = None if no_picture else output or here(case.name, "-critical-map.png" if as_map else "-response.png")
    check_place(picture)
    require_place(csv)
    run = None if run_file is None else read_run(run_file)
    with live_lines(terminal) as show, compilation_shown(terminal, case, show):
        found = response(case, speeds or None, counting(terminal, show))
    tracks = () if run is None else _tracks(run, found.points, str(run_file))
    _tell(terminal, found, bool(speeds))
    if csv is not None:
        found.to_pandas().to_csv(csv, index=False)
        terminal.result(f"table: {csv}")
    if picture is not None:
        picture = draw(terminal, lambda: _figure(found, tracks, as_map), picture)
    terminal.emit(
        {
            "command": "response",
            "case": case.name,
            "points": _points(found),
            "forces": _forces(found),
            "coefficients": _coefficients(found),
            "critical_speeds_Hz": found.critical_speeds_Hz,
            "picture": picture,
            "csv": csv,
        }
    )


def _figure(found: Response, tracks: tuple[OrderTrack, ...], as_map: bool) -> Picture:
    """The critical speed map, or the response with the synchronous motion of a run."""
    from frbcli.linear.critical_map import critical_map
    from frbcli.plot.critical_map import critical_map_figure
    from frbcli.plot.response import response_figure

    if as_map:
        return critical_map_figure(critical_map(found.case, None, found.resting))
    return response_figure(found, tracks)


def _tracks(run: Run, known: tuple[str, ...], name: str) -> tuple[OrderTrack, ...]:
    """The synchronous motion of the journals and disks of a run that are points of the response.

    Raises InputError if none is, which is then a run of another machine."""
    from frbcli.analysis.order_tracking import order_track
    from frbcli.analysis.signals import joined, points

    recorded = [joined(kind, node) for kind in ("journal", "disk") for node in points(run.signals, kind)]
    named = [node for node in recorded if node in known]
    if not named:
        problem = f"has the points {', '.join(recorded)}, of which the case has none."
        fault = Fault("--run", name, None, problem, f"Give a run with {', '.join(known)}.")
        raise InputError("response", (fault,))
    return tuple(order_track(run, 1.0, name) for name in named)


def _tell(terminal: Terminal, found: Response, every_speed: bool) -> None:
    shown = found.points[:MOST_POINTS]
    every = 1 if every_speed else math.ceil(len(found.speeds_Hz) / MOST_SPEEDS)
    amplitude, phase = 1e6 * found.amplitude, found.phase_deg
    rows = [
        (
            f"{found.speeds_Hz[i]:.4g}",
            *(f"{amplitude[i, j]:.3g} {phase[i, j]:.0f}°" for j in range(len(shown))),
            f"{found.growth[i]:.3g}",
        )
        for i in range(every - 1, len(found.speeds_Hz), every)
    ]
    named = [name.replace("_", " ") for name in shown]
    terminal.table(found.case.title or found.case.name, ("Hz", *(f"{name} um, deg" for name in named), "growth"), rows)
    if len(found.points) > len(shown):
        rest = ", ".join(name.replace("_", " ") for name in found.points[len(shown) :])
        terminal.result(f"{rest}: in the picture, --csv and --json.")
    terminal.result(EXPLANATION)
    peaks = ", ".join(f"{speed:.1f}" for speed in found.critical_speeds_Hz)
    terminal.result(f"Peaks at {peaks} Hz." if peaks else "No peak in the range.")
    tell_coefficient_error(terminal, errors_of(found.resting))


def _points(found: Response) -> list[dict[str, object]]:
    amplitude, phase, forward, backward = found.amplitude, found.phase_deg, abs(found.forward), abs(found.backward)
    return [
        {
            "speed_Hz": speed,
            "node": name,
            "amplitude_m": amplitude[i, j],
            "phase_deg": phase[i, j],
            "forward_m": forward[i, j],
            "backward_m": backward[i, j],
            "growth_1_s": found.growth[i],
        }
        for i, speed in enumerate(found.speeds_Hz)
        for j, name in enumerate(found.points)
    ]


def _forces(found: Response) -> list[dict[str, object]]:
    return [
        {"speed_Hz": speed, "film": film, "force_x_N": abs(x), "force_y_N": abs(y)}
        for i, speed in enumerate(found.speeds_Hz)
        for film, (x, y) in zip(found.films, found.forces[i], strict=True)
    ]


def _coefficients(found: Response) -> list[dict[str, object]]:
    return [
        {
            "speed_Hz": point.speed_Hz,
            "film": film.name,
            "stiffness_N_m": film.stiffness,
            "damping_N_s_m": film.damping,
            "error": {"coefficients_relative": film.error},
        }
        for point in found.resting
        for film in point.films
    ]
