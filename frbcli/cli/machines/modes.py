"""Natural frequencies and damped mode shapes of a rotor in the output of `frb stability`."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from frbcli.cli.machines.stability_table import show_largest_error
from frbcli.cli.outputs import picture_of
from frbcli.cli.progress import computing
from frbcli.columns import document, documents, table_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from frbcli.case.schema import Case
    from frbcli.cli.common import Terminal
    from frbcli.cli.outputs import Outputs
    from frbcli.linear.damped_modes import DampedMode
    from frbcli.linear.modes import Mode, Modes

LONGEST_TABLE = 13  # rows of the text
LISTED = 3  # slowest modes of each direction


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
    from frbcli.units import display

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
