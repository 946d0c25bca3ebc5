"""What standards permit, in the terminal and in JSON: vibration, margins of critical speeds, unbalance."""

from __future__ import annotations

from typing import TYPE_CHECKING

from frbcli.cli.common import Terminal

if TYPE_CHECKING:
    from frbcli.linear.standards.balance_quality import BalanceQuality
    from frbcli.linear.standards.vibration import VibrationLimits


def tell_limits(terminal: Terminal, found: VibrationLimits) -> None:
    """Tables of the points of the shaft beside their limits, and of the critical speeds beside their margins."""
    from frbcli.columns import table_of
    from frbcli.linear.standards.vibration import (
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
    asked = unit.span(*found.operating_Hz)
    if found.covered_Hz is None:
        terminal.sentence(f"No vibration limits: the response has no speed from {asked}.")
    else:
        over = "of speeds of operation" if found.covered else f"of speeds from {unit.span(*found.covered_Hz)} alone"
        terminal.show(f"{API}: vibration {over}", table_of(API_POINTS, found.api))
        terminal.show(f"{ISO}: vibration {over}", table_of(ISO_POINTS, found.iso))
        terminal.sentence(
            f"Limits at n rpm, peak to peak: {API} {API_FORMULA}; zones of {ISO} {ISO_FORMULA}. Each point at the "
            "speed where it is largest over its limit; um p-p: twice the larger semi-axis, of the shaft against the "
            "ground."
        )
        if beyond_iso(found.operating_Hz):
            terminal.sentence(f"{ISO} is for machines of 1000 to 30000 rpm.")
    if found.covered_Hz is not None and not found.covered:
        terminal.sentence(f"The response does not have all speeds from {asked}: change speed.from and speed.to.")
    if found.whirling_Hz:
        many, span = len(found.whirling_Hz), unit.span(min(found.whirling_Hz), max(found.whirling_Hz))
        terminal.sentence(
            f"Not acceptable by this alone: a whirl grows at {many} speeds of operation, {span}, and adds to the "
            "vibration by the unbalance. A run-up or `frb limit-cycles` computes it."
        )
    if found.margins:
        terminal.show(f"{API}: separation margins", table_of(MARGINS, found.margins))
        terminal.sentence(
            "required: 0 for a factor AF below 2.5, else 17 (1 - 1 / (AF - 1.5)) % below the range of operation, 10 % "
            "more above it."
        )


def tell_grade(terminal: Terminal, found: BalanceQuality) -> None:
    """A table of the planes, and what the grade means."""
    terminal.show(f"ISO 21940-11: G{found.grade_mm_s:g} at {terminal.speeds.words(found.speed_Hz)}", found.table())
    permitted, verdict = 1e6 * found.permissible, "is within" if found.within else "exceeds"
    terminal.sentence(
        f"U_per = 1000 G m / omega = {permitted:.4g} g mm for {found.mass:.4g} kg. The unbalance {verdict} "
        f"G{found.grade_mm_s:g}: it is of grade G{found.reached_mm_s:.3g}."
    )
    if found.centre_of_mass is not None and len(found.planes) and found.planes[-1].kind != "bearing":
        terminal.sentence("Not divided between planes: the rotor does not lie in two bearings.")


def limits_document(found: VibrationLimits) -> dict[str, object]:
    """As JSON."""
    from frbcli.columns import documents
    from frbcli.linear.standards.vibration import API_FORMULA, API_POINTS, ISO_FORMULA, ISO_POINTS, MARGINS

    return {
        "operating_Hz": found.operating_Hz,
        "covered_Hz": found.covered_Hz,
        "api_617": {"formula": API_FORMULA, "points": documents(API_POINTS, found.api)},
        "iso_20816_3": {"formula": ISO_FORMULA, "points": documents(ISO_POINTS, found.iso)},
        "whirling_Hz": found.whirling_Hz,
        "margins": documents(MARGINS, found.margins),
    }


def grade_document(found: BalanceQuality) -> dict[str, object]:
    """As JSON."""
    return {
        "grade_mm_s": found.grade_mm_s,
        "speed_Hz": found.speed_Hz,
        "mass_kg": found.mass,
        "centre_of_mass_m": found.centre_of_mass,
        "permissible_kg_m": found.permissible,
        "reached_mm_s": found.reached_mm_s,
        "within": found.within,
        "planes": found.table().documents(),
    }
