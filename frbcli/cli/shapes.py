"""Damped mode shapes in the output of `frb stability`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from frbcli.cli.coefficient_error import tell_coefficient_error
from frbcli.cli.pictures import draw

if TYPE_CHECKING:
    from pathlib import Path

    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal

COLUMNS = ("Hz", "whirl", "growth, 1/s", "damping", "log. decrement")


def emit_shapes(terminal: Terminal, case: Case, speed_Hz: float, picture: Path | None) -> None:
    """Table, picture and JSON of the modes of a rotor in its films at a speed in Hz."""
    from frbcli.linear.damped_modes import damped_modes

    found = damped_modes(case, speed_Hz)
    rows = [
        (
            f"{mode.frequency_Hz:.5g}", mode.direction, f"{mode.eigenvalue.real:.4g}", f"{mode.damping_ratio:.3g}",
            f"{mode.logarithmic_decrement:.3g}",
        )
        for mode in found.modes
    ]  # fmt: skip
    terminal.table(f"Damped modes at {speed_Hz:.5g} Hz", COLUMNS, rows)
    if not rows:
        terminal.result("No mode oscillates.")
    tell_coefficient_error(terminal, [(found.coefficient_error, speed_Hz)])
    if picture is not None and found.modes:
        from frbcli.plot.shapes import shapes_figure

        picture = draw(terminal, lambda: shapes_figure(found), picture, "mode shapes")
    terminal.emit(
        {
            "command": "stability",
            "case": case.name,
            "points": [],
            "threshold": None,
            "speed_Hz": speed_Hz,
            "error": {"coefficients_relative": found.coefficient_error},
            "modes": [
                {
                    "frequency_Hz": mode.frequency_Hz,
                    "direction": mode.direction,
                    "growth_1_s": mode.eigenvalue.real,
                    "damping_ratio": mode.damping_ratio,
                    "logarithmic_decrement": mode.logarithmic_decrement,
                    "motion": [
                        {"point": name, "x": [x.real, x.imag], "y": [y.real, y.imag]}
                        for name, (x, y) in zip(found.points, mode.motion, strict=True)
                    ],
                }
                for mode in found.modes
            ],
            "picture": picture,
        }
    )
