"""Damped mode shapes in the output of `frb stability`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from frbcli.cli.bearings.coefficient_error import tell_coefficient_error
from frbcli.cli.pictures.pictures import draw

if TYPE_CHECKING:
    from pathlib import Path

    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal
    from frbcli.linear.damped_modes import DampedMode


def emit_shapes(terminal: Terminal, case: Case, speed_Hz: float, picture: Path | None) -> None:
    """Table, picture and JSON of the modes of a rotor in its films at a speed in Hz."""
    from frbcli.columns import heads
    from frbcli.linear.columns import DAMPED_MODES
    from frbcli.linear.damped_modes import damped_modes

    found = damped_modes(case, speed_Hz)
    rows = found.table().cells()
    terminal.table(f"Damped modes at {speed_Hz:.5g} Hz", heads(DAMPED_MODES), rows)
    if not rows:
        terminal.result("No mode oscillates.")
    tell_coefficient_error(terminal, [(found.coefficient_error, speed_Hz)])
    if picture is not None and found.modes:
        from frbcli.plot.machine.shapes import shapes_figure

        picture = draw(terminal, lambda: shapes_figure(found), picture, "mode shapes")
    modes, motions = found.table().documents(), [_motion(found.points, mode) for mode in found.modes]
    terminal.emit(
        {
            "command": "stability",
            "case": case.name,
            "points": [],
            "threshold": None,
            "speed_Hz": speed_Hz,
            "error": {"coefficients_relative": found.coefficient_error},
            "modes": [document | {"motion": motion} for document, motion in zip(modes, motions, strict=True)],
            "picture": picture,
        }
    )


def _motion(points: tuple[str, ...], mode: DampedMode) -> list[dict[str, object]]:
    named = zip(points, mode.motion, strict=True)
    return [{"point": name, "x": [x.real, x.imag], "y": [y.real, y.imag]} for name, (x, y) in named]
