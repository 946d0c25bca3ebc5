"""`frb stability`: static equilibria, linear coefficients, eigenvalues over speed, threshold speed; natural frequencies
and damped mode shapes of a rotor."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import REST_OPTION, SPEED_OPTION, STIFFNESS_OPTION, Command, here, speeds_option
from frbcli.cli.progress import OutputOptions, computing, outputs_options, picture_of
from frbcli.cli.studies.static_tables import (
    heat_document,
    machine_document,
    reduction_document,
    show_coefficient_error,
    show_collar,
    show_heat,
    show_largest_error,
    show_points,
    show_reduction,
)
from frbcli.columns import document, documents, keys, table_of
from frbcli.units import PER_MINUTE, SpeedUnit, display

if TYPE_CHECKING:
    from collections.abc import Sequence

    from frbcli.case.schema import Case
    from frbcli.cli.progress import Outputs
    from frbcli.cycles.limit_cycles import ThresholdKind
    from frbcli.linear.damped_modes import DampedMode
    from frbcli.linear.modes import Mode, Modes
    from frbcli.linear.stability import Stability
    from frbcli.linear.stability_point import StabilityPoint, Threshold
    from frbcli.rotor.reduction import Reduction

LONGEST_TABLE = 13  # rows of the text
LISTED = 3  # slowest modes of each direction


@click.command(cls=Command)
@case_argument
@speeds_option("60 over the range of CASE", REST_OPTION)
@click.option("--threshold", "with_threshold", is_flag=True,
              help="Seek the threshold over the range of CASE, in addition to the speeds of --speed.")  # fmt: skip
@click.option("--modes", "stiffness", type=STIFFNESS_OPTION, metavar="STIFFNESS",
              help='Only undamped natural frequencies of the rotor, from 0 Hz on: "free", on "bearings" of given '
                   'coefficients, or on a stiffness of e.g. "5e6 N/m".')  # fmt: skip
@click.option("--shapes", type=SPEED_OPTION, metavar="SPEED",
              help='Only the damped modes at this rotor speed, with their shapes, e.g. "200 Hz".')  # fmt: skip
@outputs_options("CASE-campbell.png, here")
@output_options
def command(
    case: Case,
    speeds: tuple[float, ...],
    with_threshold: bool,
    stiffness: Any,
    shapes: float | None,
    outputs: OutputOptions,
    terminal: Terminal,
) -> int | None:
    """Static equilibria, coefficients of the films and eigenvalues of CASE over speed, and the threshold of stability.

    For a turbocharger also the natural frequencies of its rotor, free and on springs as stiff as its films.
    """
    from frbcli.errors import NotConverged
    from frbcli.linear.modes import natural_modes, own_reduction
    from frbcli.linear.stability import stability
    from frbcli.scene.gate.gate import faults
    from frbcli.scene.gate.rule import CYCLES

    if shapes is not None and (stiffness is not None or speeds):
        raise click.UsageError("--shapes stands alone: it is of one speed, on the films of the case.")
    drawn = "shapes" if shapes is not None else "campbell" if stiffness is None else "modes"
    places = outputs.check(here(case.name, f"-{drawn}.png"))
    if shapes is not None:
        emit_shapes(terminal, case, shapes, places)
        return None
    if stiffness is not None:
        emit_modes(terminal, case, stiffness, speeds, places)
        return None
    with computing(terminal, case, kernels="rest") as shown:
        analysis = stability(case, speeds or None, shown.counting(), with_threshold)
        kind = None
        if analysis.threshold is not None and not faults(case, CYCLES):
            from frbcli.cycles.limit_cycles import threshold_kind  # takes long to load

            kind = threshold_kind(case, analysis.threshold.speed_Hz)
    reduced = own_reduction(case, analysis.points)
    _show(terminal, analysis, kind, reduced, bool(speeds))
    machine = machine_document(terminal, case, speeds[-1]) if speeds else {}
    written = places.write(terminal, analysis, "Campbell diagram")
    natural = [natural_modes(case, springs, [at]) for springs, at in _springs(analysis)]
    for modes in natural:
        show_modes(terminal, modes)
    if natural and _beside_bearings(analysis):
        terminal.sentence("On supports or balls, the modes are of the whole machine: frb stability --shapes SPEED.")
    elif len(natural) == 1 and analysis.points[-1].rests:
        at = terminal.speeds.words(analysis.points[-1].speed_Hz)
        terminal.result(f"No natural frequencies on films at {at}: one has no direct stiffness.")
    terminal.emit(
        {
            "command": "stability",
            "case": case.name,
            "points": [_point(point) for point in analysis.points],
            "threshold": analysis.threshold
            and asdict(analysis.threshold) | {"whirl_ratio": analysis.threshold.whirl_ratio},
            "threshold_kind": None if kind is None else {"criticality": kind.criticality, "fold_Hz": kind.fold_Hz},
            "note": analysis.note,
            "reduction": reduction_document(reduced),
            **machine,
            **written,
        }
        | ({"natural_frequencies": [modes_document(modes) for modes in natural]} if natural else {})
    )
    return None if any(point.rests for point in analysis.points) else NotConverged.exit_code


def _show(
    terminal: Terminal, analysis: Stability, kind: ThresholdKind | None, reduced: Reduction | None, every_speed: bool
) -> None:
    from frbcli.scene.changes import step_times
    from frbcli.scene.supply import unfed_films

    show_points(terminal, analysis, every_speed)
    show_coefficient_error(terminal, analysis.points)
    terminal.sentence(_sentence(analysis, terminal.speeds))
    show_reduction(terminal, reduced)
    show_collar(terminal, analysis)
    warmest = analysis.points[-1]
    if warmest.warm is not None:
        show_heat(terminal, analysis.case, warmest.warm, f"heat at {terminal.speeds.words(warmest.speed_Hz)}")
    if kind is not None:
        terminal.sentence(_character(kind, terminal.speeds))
    for film in unfed_films(analysis.case):
        terminal.sentence(film.remark)
    if step_times(analysis.case):
        terminal.sentence(
            "Note: the clearances are the initial ones; bearing.clearance_steps changes them during a run."
        )


def _springs(analysis: Stability) -> list[tuple[tuple[float, ...] | None, float]]:
    """Stiffness of the bearings and speed in Hz at which the modes of a turbocharger's rotor are of interest."""
    from frbcli.linear.modes import film_springs

    if analysis.case.rotor.symmetric:
        return []
    wanted: list[tuple[tuple[float, ...] | None, float]] = [(None, 0.0)]
    if _beside_bearings(analysis):
        return wanted
    for point in analysis.points[-1:]:
        springs = film_springs(analysis.case, point.films) if point.films else ()
        if springs or (point.rests and not analysis.case.bearings):
            wanted.append((springs, point.speed_Hz))
    return wanted


def _beside_bearings(analysis: Stability) -> bool:
    from frbcli.scene.machine.rotor import beside_bearings

    balls = any(bearing.kind == "ball" for bearing in analysis.case.elements)
    return balls or bool(beside_bearings(analysis.case))


def _sentence(analysis: Stability, unit: SpeedUnit) -> str:
    threshold = analysis.threshold
    if threshold is None:
        return analysis.note
    return (
        f"Threshold of stability: above {unit.words(threshold.speed_Hz, 1)} the rotor whirls, initially with "
        f"{threshold.frequency_Hz:.1f} Hz, {threshold.whirl_ratio:.3f} times its speed"
        f"{_uncertain(threshold, unit)}.{analysis.note}"
    )


def _uncertain(threshold: Threshold, unit: SpeedUnit) -> str:
    """The expected errors of a threshold, where they are known."""
    if math.isnan(threshold.speed_uncertainty_Hz):
        return ""
    speed, frequency = threshold.speed_uncertainty_Hz, threshold.frequency_uncertainty_Hz
    of_speed = f"{PER_MINUTE * speed:.1g} rpm" if unit.rpm else f"{speed:.1g}"
    return f" (expected errors {of_speed} and {frequency:.1g} Hz)"


def _character(kind: ThresholdKind, unit: SpeedUnit) -> str:
    """Whether a threshold is soft or hard."""
    if kind.criticality == "supercritical":
        return "The threshold is soft (supercritical): the whirl grows with the speed from nothing."
    if kind.fold_Hz is None:
        return "The threshold is hard (subcritical): the whirl jumps to a large one."
    return (
        "The threshold is hard (subcritical): the whirl jumps to a large one, which a "
        f"disturbance leads to from {unit.words(kind.fold_Hz, 1)} on."
    )


def _point(point: StabilityPoint) -> dict[str, Any]:
    """One point in JSON; a rotor with several films lists them, the first of them at the top as well."""
    from frbcli.linear.columns import AXIAL, FILM, MODES, POINT, film_columns

    row, films = document(POINT, point), documents(film_columns(point.films), point.films)
    errors = row.pop("error") | (films[0]["error"] if films else {})
    row |= (films[0] if films else dict.fromkeys(keys(FILM))) | {"error": errors}
    if len(films) > 1:
        named = zip(point.films, films, strict=True)
        row["films"] = [{"film": film.name} | values for film, values in named]
    if point.ring_speeds_Hz:
        row["ring_speeds_Hz"] = list(point.ring_speeds_Hz)
    if point.warm is not None:
        row["thermal"] = heat_document(point.warm)
    if point.axial is not None:
        row["axial"] = document(AXIAL, point.axial)
    if point.problem:
        row["problem"] = point.problem
    row["modes"] = documents(MODES, point.modes_with_errors)
    return row | {"eigenvalues": [[value.real, value.imag] for value in point.eigenvalues.tolist()]}


def emit_modes(terminal: Terminal, case: Case, stiffness: Any, speeds: Sequence[float], places: Outputs) -> None:
    """Table, picture and JSON of the rotor, free at rest, then at speeds in Hz: "free", on its "bearings" or on springs
    of a stiffness in N/m."""
    from frbcli.linear.modes import natural_modes

    on = None if stiffness == "free" else stiffness
    tables = [natural_modes(case, None, [0.0]), natural_modes(case, on, speeds or None)]
    show_free(terminal, tables[0])
    show_held(terminal, tables[1])
    drawn = natural_modes(case, on) if len(speeds) == 1 else tables[1]
    written = places.write(terminal, tables[1], "Natural modes", partial(picture_of, drawn))
    terminal.emit(
        {
            "command": "stability",
            "case": case.name,
            "points": [],
            "threshold": None,
            "natural_frequencies": [modes_document(modes) for modes in tables],
            **written,
        }
    )


def show_modes(terminal: Terminal, modes: Modes) -> None:
    """The modes as text: of a free rotor its bending ones at rest, else a table."""
    (show_held if modes.stiffness_N_m else show_free)(terminal, modes)


def show_free(terminal: Terminal, modes: Modes) -> None:
    """The bending modes of the free rotor at rest, and what is not listed of it."""
    bending = ", ".join(f"{frequency:.4g}" for frequency in modes.free_Hz[:LISTED])
    bending_modes = f"bending modes of {bending} Hz at rest" if bending else "it does not bend"
    terminal.result(f"Free rotor of {modes.mass_kg:.4g} kg: {bending_modes}.")
    rings = sum(1 for given in modes.case.bearings if len(given.films) > 1)
    apart = f", and its {rings} rings are apart" if rings > 1 else ", and its ring is apart" if rings else ""
    terminal.sentence(f"Not listed: {modes.points[0].still} rigid-body motions of 0 Hz{apart}.")


def show_held(terminal: Terminal, modes: Modes) -> None:
    """A table of the modes over the speed."""
    springs = ", ".join(display(spring, "N/m") for spring in dict.fromkeys(modes.stiffness_N_m))
    every = -(-len(modes.points) // LONGEST_TABLE)
    rows = [
        (terminal.speeds.number(point.speed_Hz),
         *_cells(point.directed("forward")), *_cells(point.directed("backward")))
        for point in modes.points[::every]
    ]  # fmt: skip
    columns = (terminal.speeds.name, *("forward",) * LISTED, *("backward",) * LISTED)
    on = f"on {springs}" if springs else "of the free rotor"
    title = f"Natural frequencies {on}: conical, cylindrical, bending"
    terminal.table(title, columns, rows)
    if modes.error is not None:
        missing = 100 * modes.error.frequency
        kept = f"{modes.kept} modes of each plane"
        terminal.result(f"The reduction to {kept} changes these frequencies by {missing:.2g} %.")


def _cells(modes: Sequence[Mode]) -> list[str]:
    from frbcli.linear.columns import NATURAL_MODES

    cells = [" ".join(row) for row in table_of(NATURAL_MODES, modes[:LISTED]).cells()]
    return cells + [""] * (LISTED - len(cells))


def modes_document(modes: Modes) -> dict[str, object]:
    """The modes in JSON."""
    from frbcli.linear.columns import NATURAL_MODES, REDUCTION

    return {
        "stiffness_N_m": modes.stiffness_N_m,
        "mass_kg": modes.mass_kg,
        "free_bending_Hz": modes.free_Hz,
        "points": [
            {"speed_Hz": point.speed_Hz, "modes": documents(NATURAL_MODES, point.modes)} for point in modes.points
        ],
        "reduction": document(REDUCTION, modes),
    }


def emit_shapes(terminal: Terminal, case: Case, speed_Hz: float, places: Outputs) -> None:
    """Table, picture and JSON of the modes of a rotor in its films at a speed in Hz."""
    from frbcli.linear.damped_modes import damped_modes

    with computing(terminal, case, kernels="rest"):
        shapes = damped_modes(case, speed_Hz)
    terminal.show(f"Damped modes at {terminal.speeds.words(speed_Hz)}", shapes.table())
    if not shapes.modes:
        terminal.result("No mode oscillates.")
        places = replace(places, picture=None)
    show_largest_error(terminal, [(shapes.coefficient_error, speed_Hz)])
    modes, motions = shapes.table().documents(), [_motion(shapes.points, mode) for mode in shapes.modes]
    terminal.emit(
        {
            "command": "stability",
            "case": case.name,
            "points": [],
            "threshold": None,
            "speed_Hz": speed_Hz,
            "error": {"coefficients_relative": shapes.coefficient_error},
            "modes": [mode | {"motion": motion} for mode, motion in zip(modes, motions, strict=True)],
            **places.write(terminal, shapes, "mode shapes"),
        }
    )


def _motion(points: tuple[str, ...], mode: DampedMode) -> list[dict[str, object]]:
    named = zip(points, mode.motion, strict=True)
    return [{"point": name, "x": [x.real, x.imag], "y": [y.real, y.imag]} for name, (x, y) in named]
