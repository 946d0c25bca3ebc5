"""What standards permit, in the terminal and in JSON: vibration, margins of critical speeds, unbalance."""

from __future__ import annotations

from typing import TYPE_CHECKING

from frbcli.cli.common import Terminal

if TYPE_CHECKING:
    from frbcli.linear.balance_quality import BalanceQuality
    from frbcli.linear.vibration import VibrationLimits


def show_limits(terminal: Terminal, limits: VibrationLimits) -> None:
    """Tables of the points of the shaft with their limits, and of the critical speeds with their margins."""
    from frbcli.columns import table_of
    from frbcli.linear.vibration import (
        API,
        API_FORMULA,
        API_POINTS,
        ISO,
        ISO_FORMULA,
        ISO_POINTS,
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
            "required: 0 for a factor AF below 2.5, else 17 (1 - 1 / (AF - 1.5)) % below the range of operation, 10 % "
            "more above it."
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
    from frbcli.linear.vibration import API_FORMULA, API_POINTS, ISO_FORMULA, ISO_POINTS, MARGINS

    return {
        "operating_Hz": limits.operating_Hz,
        "covered_Hz": limits.covered_Hz,
        "api_617": {"formula": API_FORMULA, "points": documents(API_POINTS, limits.api)},
        "iso_20816_3": {"formula": ISO_FORMULA, "points": documents(ISO_POINTS, limits.iso)},
        "whirling_Hz": limits.whirling_Hz,
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
