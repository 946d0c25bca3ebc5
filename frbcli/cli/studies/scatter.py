"""The output of `frb sweep` for machines whose numbers scatter."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from frbcli.cli.common import Terminal
from frbcli.cli.outputs import draw

if TYPE_CHECKING:
    from frbcli.studies.sweep.sweep import Sweep


def of_machines(
    found: Sweep, below_Hz: float | None, target: Path | None, terminal: Terminal
) -> tuple[dict[str, Any], Path | None]:
    """Tables and picture of the scatter, and its part of the JSON document."""
    from frbcli.studies.sweep.scatter import scatter

    seen = scatter(found, below_Hz)
    rows = [(f"{percent:g} %", _hertz(speed)) for percent, speed in seen.percentiles]
    terminal.table(f"{seen.count} machines", ("share", "whirl at or below"), rows)
    if seen.sensitivities:
        terminal.table("sensitivities", ("key", "per standard deviation", "rank correlation"), [
            (one.key, f"{one.per_deviation_Hz:+.3g} Hz", f"{one.rank:+.2f}") for one in seen.sensitivities
        ])
        terminal.result(f"A linear model explains {100.0 * seen.explained:.0f} % of the variance of the speed.")
    low, high = (100.0 * limit for limit in seen.interval)
    told = f"{100.0 * seen.share:.1f} % of the machines whirl below {seen.below_Hz:.4g} Hz"
    terminal.result(f"{told} (95 % interval {low:.1f} to {high:.1f} %).")
    if seen.left_out:
        terminal.result(f"{seen.left_out} machines without a known result are left out.")
    drawn = None
    if target is not None:
        from frbcli.plot.studies.scatter import scatter_figure

        drawn = draw(terminal, lambda: scatter_figure(found.case.heading, seen), target)
    document = {
        "count": seen.count,
        "left_out": seen.left_out,
        "percentiles": [{"percent": percent, "speed_Hz": speed} for percent, speed in seen.percentiles],
        "sensitivities": [asdict(one) for one in seen.sensitivities],
        "explained": seen.explained,
        "below_Hz": seen.below_Hz,
        "share": seen.share,
        "interval": seen.interval,
    }
    return document, drawn


def _hertz(speed: float) -> str:
    if math.isinf(speed):
        return "none up to the highest speed"
    return "the lowest speed" if speed == 0.0 else f"{speed:.1f} Hz"
