"""`frb stability`: static equilibria, linear coefficients, eigenvalues over speed, threshold speed."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from frbcli.cli.bearings.heat import heat_document, show_heat
from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.files import here
from frbcli.cli.machines.modes import emit_modes, emit_shapes, modes_document, show_modes
from frbcli.cli.machines.stability_table import (
    reduction_document,
    show_coefficient_error,
    show_collar,
    show_points,
    show_reduction,
)
from frbcli.cli.options import REST_OPTION, SPEED_OPTION, STIFFNESS_OPTION, speeds_option
from frbcli.cli.outputs import OutputOptions, outputs_options
from frbcli.cli.progress import computing
from frbcli.units import PER_MINUTE, SpeedUnit

if TYPE_CHECKING:
    from frbcli.case.schema import Case
    from frbcli.cycles.explain import ThresholdKind
    from frbcli.linear.stability import Stability
    from frbcli.linear.stability_point import StabilityPoint
    from frbcli.linear.threshold import Threshold
    from frbcli.rotor.reduction import Reduction


@click.command()
@case_argument
@speeds_option("60 over the range of CASE", REST_OPTION)
@click.option("--threshold", "with_threshold", is_flag=True,
              help="Seek the threshold over the range of CASE, in addition to the speeds of --speed.")  # fmt: skip
@click.option("--modes", "--stiffness", "stiffness", type=STIFFNESS_OPTION, metavar="STIFFNESS",
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
    from frbcli.cycles.explain import threshold_kind
    from frbcli.errors import NotConverged
    from frbcli.linear.modes import natural_modes, own_reduction
    from frbcli.linear.stability import stability

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
        kind = None if analysis.threshold is None else threshold_kind(case, analysis.threshold.speed_Hz)
    reduced = own_reduction(case, analysis.points)
    _show(terminal, analysis, kind, reduced, bool(speeds))
    written = places.write(terminal, analysis, "Campbell diagram")
    natural = [natural_modes(case, springs, [at]) for springs, at in _springs(analysis)]
    for modes in natural:
        show_modes(terminal, modes)
    if natural and _beside_bearings(analysis):
        terminal.result("On supports, the modes belong to the whole machine: frb stability --shapes SPEED.")
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
        show_heat(terminal, warmest.warm, f"heat at {terminal.speeds.words(warmest.speed_Hz)}")
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
    from frbcli.scene.machine.elements import beside_bearings

    return bool(beside_bearings(analysis.case))


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
    from frbcli.columns import document, documents, keys
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
