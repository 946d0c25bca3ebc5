"""How the run-up with the two-phase model depends on the number of its cells."""

from __future__ import annotations

from pathlib import Path

from validation.chapter6 import SECONDS, run_up
from validation.chapter6_rows import CIRCUMFERENTIAL

UNTIL_s = 6.0
MESHES = {"40 x 5": (), "64 x 6": ("accuracy.mesh=[6,64]",), "96 x 10": ("accuracy.mesh=[10,96]",)}
SUPPLIES = (1, 2)
HEAD = """Case `jeffcott-two-phase`, x_1 = 0.99, on cells at rest with the oil carried upwind. Amplitude: the largest
before the onset, over the clearance. Resting positions and onsets are accurate on few cells. At 1 bar the
journal in the starved film also vibrates with 82 to 90 Hz between about 2.6 and 3.8 s, which ends before the
whirl begins. That it ends, and that its amplitude grows with the number of cells, is an effect of the upwind
diffusion, which damps it ([theory](theory.md), "A grid that turns"). On the 32 x 6 cells of the present plan,
which turn, the vibration is the event `self-excited` at 3.68 s (110 Hz), with 88 Hz, and the whirl begins at
4.59 s. At 2 bar the whirl has begun, or is about to, at 4 s."""


def table(folder: Path) -> list[str]:
    """The table of onsets and eccentricities by mesh and supply pressure."""
    lines = [
        "## Cells of a run-up with the two-phase model",
        "",
        HEAD,
        "",
        f"| supply, bar | cells | onset, s | {' | '.join(f'eccentricity at {t:g} s' for t in SECONDS)} | amplitude |",
        "|" + " --- |" * (4 + len(SECONDS)),
    ]
    for bar in SUPPLIES:
        for cells, mesh in MESHES.items():
            run = run_up(folder, CIRCUMFERENTIAL, UNTIL_s, *mesh, f"bearing.supply.pressure={bar} bar")
            values = " | ".join(f"{value:.3f}" for value in run.eccentricities)
            lines.append(f"| {bar} | {cells} | {run.onset_s:.2f} | {values} | {run.amplitude:.3f} |")
    return lines
