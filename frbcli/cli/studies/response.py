"""`frb response`: linear unbalance response over the rotor speed; and what standards permit, in the terminal and in
JSON: vibration, margins of critical speeds, unbalance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from frbcli.arrays import Array
from frbcli.cli.common import Terminal, case_argument, output_options
from frbcli.cli.options import INPUT, OPERATING_OPTION, Command, GradeOption, here, speeds_option
from frbcli.cli.progress import OutputOptions, computing, outputs_options, picture_of
from frbcli.cli.studies.static_tables import (
    machine_document,
    reduction_document,
    show_coefficient_error,
    show_heat,
    show_reduction,
)
from frbcli.errors import Fault, InputError
from frbcli.units import SpeedUnit

if TYPE_CHECKING:
    from frbcli.analysis.order_tracking import OrderTrack
    from frbcli.case.schema import Case
    from frbcli.linear.balance_quality import BalanceQuality
    from frbcli.linear.damped_modes import VibrationLimits
    from frbcli.linear.response import Response
    from frbcli.plot.style import Picture
    from frbcli.results.store import Run
    from frbcli.rotor.reduction import Reduction

MOST_SPEEDS, MOST_POINTS = 20, 4  # of the table; JSON, CSV and the picture have all
EXPLANATION = (
    "um: larger semi-axis of the orbit; deg: phase of the forward motion to the {angle}; growth: growth rate of the "
    "least damped mode, 1/s, unstable above 0; eps: largest eccentricity of a journal on its orbit."
)
MARKS = {"linear": "", "doubtful": " ?", "beyond-gap": " !"}  # behind eps


@click.command(cls=Command)
@case_argument
@speeds_option("120 over the range of CASE")
@click.option("--run", "run_file", type=INPUT, metavar="RUN.h5",
              help="Draw the synchronous motion of a run of CASE over the response.")  # fmt: skip
@click.option("--map", "as_map", is_flag=True,
              help="Draw the undamped critical speed map, over the stiffness of the bearings.")  # fmt: skip
@click.option("--excitation", default="unbalance", metavar="LOAD",
              show_default="the unbalance and all loads of order 1",
              help='The one load that excites the rotor, e.g. "force 2" or "bow".')  # fmt: skip
@click.option("--after-loss", is_flag=True, help="With the unbalance after the losses of CASE.")
@click.option("--operating", type=OPERATING_OPTION, metavar="RANGE",
              help='Speeds of operation, whose vibration is judged, e.g. "8000..12000 rpm".')  # fmt: skip
@click.option("--grade", type=GradeOption(), metavar="GRADE",
              help="Balance quality grade of ISO 21940-11 to compare the unbalance with, e.g. G6.3.")  # fmt: skip
@outputs_options("CASE-response.png, here")
@output_options
def command(
    case: Case,
    speeds: tuple[float, ...],
    run_file: Path | None,
    as_map: bool,
    excitation: str,
    after_loss: bool,
    operating: tuple[float, float] | None,
    grade: float | None,
    outputs: OutputOptions,
    terminal: Terminal,
) -> None:
    """Synchronous motion and bearing forces of CASE under its unbalance, with the films' stiffness and damping.

    Loads of order 1 and a bow join the unbalance; --excitation takes any of them alone.
    """
    from frbcli.columns import documents, spread_table
    from frbcli.linear.balance_quality import balance_quality
    from frbcli.linear.columns import PEAKS, RESPONSE_COEFFICIENTS, RESPONSE_FILMS, RESPONSE_FORCES
    from frbcli.linear.damped_modes import vibration_limits
    from frbcli.linear.modes import own_reduction
    from frbcli.linear.response import response
    from frbcli.results.store import read_run
    from frbcli.scene.changes import loss_times

    if excitation != "unbalance" and run_file is not None:
        raise click.UsageError("--excitation and --run exclude each other: --run is for the synchronous motion.")
    if as_map and not outputs.picture:
        raise click.UsageError("--map names the picture that --no-picture leaves out.")
    places = outputs.check(here(case.name, "-critical-map.png" if as_map else "-response.png"))
    run = None if run_file is None else read_run(run_file)
    with computing(terminal, case, kernels="rest") as shown:
        motion = response(case, speeds or None, shown.counting(), excitation, operating, after_loss)
    tracks = () if run is None else _tracks(run, motion.points, str(run_file))
    reduced = own_reduction(case, motion.resting)
    _show(terminal, motion, reduced, bool(speeds))
    machine = machine_document(terminal, case, speeds[-1]) if speeds else {}
    limits = None if operating is None else vibration_limits(motion, operating)
    quality = None if grade is None else balance_quality(motion.case, grade, operating[1] if operating else None)
    if limits is not None:
        show_limits(terminal, limits)
    if quality is not None:
        show_grade(terminal, quality)
    films = ((point, film) for point in motion.resting for film in point.films)
    terminal.emit(
        {
            "command": "response",
            "case": case.name,
            "excitation": excitation,
            **({"after_loss": after_loss} if after_loss or loss_times(case) else {}),
            "points": motion.table().documents(),
            "forces": spread_table(RESPONSE_FORCES, motion).documents(),
            "films": spread_table(RESPONSE_FILMS, motion).documents(),
            "coefficients": documents(RESPONSE_COEFFICIENTS, films),
            "reduction": reduction_document(reduced),
            **machine,
            "critical_speeds_Hz": motion.critical_speeds_Hz,
            "critical_speeds": documents(PEAKS, motion.critical_speeds),
            **({} if limits is None else {"limits": limits_document(limits)}),
            **({} if quality is None else {"grade": grade_document(quality)}),
            "error": {"critical_speeds_Hz": [peak.speed_uncertainty_Hz for peak in motion.critical_speeds]},
            **places.write(terminal, motion, picture=lambda: _figure(motion, tracks, as_map)),
        }
    )


def _figure(motion: Response, tracks: tuple[OrderTrack, ...], as_map: bool) -> Picture:
    """The critical speed map, or the response with the synchronous motion of a run."""
    from frbcli.linear.modes import critical_map
    from frbcli.plot.machine.response import response_figure

    if as_map:
        return picture_of(critical_map(motion.case, None, motion.resting))
    return response_figure(motion, tracks)


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


def _show(terminal: Terminal, motion: Response, reduced: Reduction | None, every_speed: bool) -> None:
    import numpy as np

    from frbcli.columns import table_of
    from frbcli.linear.columns import PEAKS, RESPONSE

    shown = motion.points[:MOST_POINTS]
    every = 1 if every_speed else math.ceil(len(motion.speeds_Hz) / MOST_SPEEDS)
    count, validity = len(motion.points), motion.validity
    cells = motion.table().with_speeds_in(terminal.speeds).cells(RESPONSE)
    in_films, rows = bool(motion.films), []
    for i in range(every - 1, len(motion.speeds_Hz), every):
        speed, _, _, growth, eccentricity = cells[i * count]
        motions = (f"{amplitude} {phase}" for _, amplitude, phase, *_ in cells[i * count : i * count + len(shown)])
        rows.append((speed, *motions, growth, *([f"{eccentricity}{MARKS[validity[i]]}"] if in_films else [])))
    named = [name.replace("_", " ") for name in shown]
    columns = (terminal.speeds.name, *(f"{name} um, deg" for name in named), "growth", *(["eps"] if in_films else []))
    terminal.table(motion.case.heading, columns, rows)
    if len(motion.points) > len(shown):
        rest = ", ".join(name.replace("_", " ") for name in motion.points[len(shown) :])
        terminal.result(f"{rest}: in the picture, --csv and --json.")
    explanation = EXPLANATION if in_films else EXPLANATION.partition("; eps")[0] + "."
    terminal.sentence(explanation.format(angle=motion.angle))
    show_reduction(terminal, reduced)
    for sentence in _excitation(motion):
        terminal.sentence(sentence)
    for sentence in _doubts(motion, terminal.speeds):
        terminal.sentence(sentence)
    unit = terminal.speeds
    peaks = [unit.cell(peak.speed_Hz, peak.speed_uncertainty_Hz, 3) for peak in motion.critical_speeds]
    terminal.result(f"Peaks at {', '.join(peaks)} {unit.name}." if peaks else "No peak in the range.")
    if peaks:
        terminal.show("Critical speeds", table_of(PEAKS, motion.critical_speeds), RESPONSE)
    if any(peak.amplitude is None for peak in motion.critical_speeds):
        terminal.sentence("Without an amplitude: the mode is not damped, and nothing bounds the peak.")
    show_coefficient_error(terminal, motion.resting)
    for point in motion.resting[-1:]:
        if point.warm is not None:
            show_heat(terminal, motion.case, point.warm, f"heat at {unit.words(point.speed_Hz)}")
    largest = motion.amplitude.max(axis=0)
    known = (largest > 0.0) & np.isfinite(motion.amplitude_error).all(axis=0)
    if known.any():
        share = float((motion.amplitude_error.max(axis=0)[known] / largest[known]).max())
        told_share = float(f"{100.0 * share:.1g}")
        terminal.sentence(f"Expected error of the amplitudes: up to {told_share:g} % of the largest of each point.")


def _excitation(motion: Response) -> list[str]:
    """Sentences on the loads of the case, which do not excite together, and on its losses."""
    from frbcli.rotor.loads import BOW
    from frbcli.scene.changes import has_lost, loss_note
    from frbcli.scene.machine.rotor import harmonics_of

    loads = {load.name: load for load in harmonics_of(motion.case)}
    if motion.excitation in loads:
        return [f"Excited by {motion.excitation} alone, {loads[motion.excitation].turning}."]
    if motion.excitation == BOW:
        return ["Excited by the bow alone."]
    others = ", ".join(name for name, load in loads.items() if not load.synchronous)
    notes = [f"Not excited by {others}, of another frequency: --excitation shows the motion by it."] if others else []
    if before := loss_note(motion.case):
        notes.append(f"{before}; --after-loss takes that after it.")
    return [*notes, *(["With the unbalance after the loss."] if has_lost(motion.case) else [])]


def _doubts(motion: Response, unit: SpeedUnit) -> list[str]:
    """Sentences on motions that linear coefficients do not describe."""
    from frbcli.linear.response import BEYOND_GAP, DOUBTFUL, DOUBTFUL_MOTION

    sentences = []
    speeds, validity = motion.speeds_Hz, motion.validity
    doubtful, beyond = ([s for s, v in zip(speeds, validity, strict=True) if v == kind]
                        for kind in (DOUBTFUL_MOTION, BEYOND_GAP))  # fmt: skip
    if doubtful:
        sentences.append(
            f"?: doubtful at {_among(doubtful, speeds, unit)}. A journal moves over more than {DOUBTFUL:g} of the gap "
            "that its static equilibrium leaves: its amplitude may be wrong by more than 15 %."
        )
    if beyond:
        sentences.append(
            f"!: not possible at {_among(beyond, speeds, unit)}. The orbit of a journal leaves its gap, up to an "
            f"eccentricity of {motion.eccentricity_max.max():.3g}; a run-up with this unbalance computes the motion."
        )
    return sentences


def _among(some: list[float], speeds: Array, unit: SpeedUnit) -> str:
    """Some of the speeds of a response as a reader takes them."""
    if len(some) == 1:
        return unit.words(some[0])
    return f"{len(some)} of {len(speeds)} speeds, {unit.span(min(some), max(some))}"


def show_limits(terminal: Terminal, limits: VibrationLimits) -> None:
    """Tables of the points of the shaft with their limits, and of the critical speeds with their margins."""
    from frbcli.columns import table_of
    from frbcli.linear.damped_modes import (
        API,
        API_FORMULA,
        API_POINTS,
        ISO,
        ISO_FORMULA,
        ISO_POINTS,
        MARGIN_FORMULA,
        MARGINS,
        beyond_iso,
    )

    unit = terminal.speeds
    asked = unit.span(*limits.operating_Hz)
    if limits.covered_Hz is None:
        terminal.sentence(f"No vibration limits: the response has no speed from {asked}.")
    else:
        over = "of speeds of operation" if limits.covered else f"of speeds from {unit.span(*limits.covered_Hz)} alone"
        terminal.show(f"{API}: vibration {over}", table_of(API_POINTS, limits.api))
        terminal.show(f"{ISO}: vibration {over}", table_of(ISO_POINTS, limits.iso))
        terminal.sentence(
            f"Limits at n rpm, peak to peak: {API} {API_FORMULA}; zones of {ISO} {ISO_FORMULA}. Each point at the "
            "speed where it is largest over its limit; um p-p: twice the larger semi-axis, of the shaft against the "
            "ground."
        )
        if beyond_iso(limits.operating_Hz):
            terminal.sentence(f"{ISO} is for machines of 1000 to 30000 rpm.")
    if limits.covered_Hz is not None and not limits.covered:
        terminal.sentence(f"The response does not have all speeds from {asked}: change speed.from and speed.to.")
    if limits.whirling_Hz:
        many, span = len(limits.whirling_Hz), unit.span(min(limits.whirling_Hz), max(limits.whirling_Hz))
        terminal.sentence(
            f"Not acceptable by this alone: a whirl grows at {many} speeds of operation, {span}, and adds to the "
            "vibration by the unbalance. A run-up or `frb limit-cycles` computes it."
        )
    if limits.margins:
        terminal.show(f"{API}: separation margins", table_of(MARGINS, limits.margins))
        terminal.sentence(
            f"required: {MARGIN_FORMULA}. The factor AF is the speed over the width of the peak at 0.707 of its height."
        )


def show_grade(terminal: Terminal, grade: BalanceQuality) -> None:
    """A table of the planes, and what the grade means."""
    terminal.show(f"ISO 21940-11: G{grade.grade_mm_s:g} at {terminal.speeds.words(grade.speed_Hz)}", grade.table())
    permitted, verdict = 1e6 * grade.permissible, "is within" if grade.within else "exceeds"
    terminal.sentence(
        f"U_per = 1000 G m / omega = {permitted:.4g} g mm for {grade.mass:.4g} kg. The unbalance {verdict} "
        f"G{grade.grade_mm_s:g}: it is of grade G{grade.reached_mm_s:.3g}."
    )
    if grade.centre_of_mass is not None and len(grade.planes) and grade.planes[-1].kind != "bearing":
        terminal.sentence("Not divided between planes: the rotor does not lie in two bearings.")


def limits_document(limits: VibrationLimits) -> dict[str, object]:
    """As JSON."""
    from frbcli.columns import documents
    from frbcli.linear.damped_modes import API_FORMULA, API_POINTS, ISO_FORMULA, ISO_POINTS, MARGIN_FORMULA, MARGINS

    return {
        "operating_Hz": limits.operating_Hz,
        "covered_Hz": limits.covered_Hz,
        "api_617": {"formula": API_FORMULA, "points": documents(API_POINTS, limits.api)},
        "iso_20816_3": {"formula": ISO_FORMULA, "points": documents(ISO_POINTS, limits.iso)},
        "whirling_Hz": limits.whirling_Hz,
        "margin_formula": MARGIN_FORMULA,
        "margins": documents(MARGINS, limits.margins),
    }


def grade_document(quality: BalanceQuality) -> dict[str, object]:
    """As JSON."""
    return {
        "grade_mm_s": quality.grade_mm_s,
        "speed_Hz": quality.speed_Hz,
        "mass_kg": quality.mass,
        "centre_of_mass_m": quality.centre_of_mass,
        "permissible_kg_m": quality.permissible,
        "reached_mm_s": quality.reached_mm_s,
        "within": quality.within,
        "planes": quality.table().documents(),
    }
