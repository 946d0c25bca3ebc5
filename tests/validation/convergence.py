"""How the run-up with the two-phase model depends on the number of its cells."""

from __future__ import annotations

from pathlib import Path

from validation.chapter6 import SECONDS, run_up
from validation.chapter6_rows import CIRCUMFERENTIAL

UNTIL_s = 6.0
MESHES = {"40 x 5": (), "64 x 6": ("accuracy.mesh=[6,64]",), "96 x 10": ("accuracy.mesh=[10,96]",)}
SUPPLIES = (1, 2)
HEAD = """Case `jeffcott-two-phase`, x_1 = 0.99; the first row of each pressure has the cells of a target of 3e-3.
Amplitude: the largest before the onset, over the clearance. Resting positions and onsets are accurate on
few cells. At 1 bar the journal in the starved film also vibrates with 82 to 90 Hz between about 2.6 and 3.8
s, which ends before the whirl begins; this amplitude grows with the number of cells and has not converged:
on few cells unbalance excites the vibration, which decays slowly; on many cells it persists. It is the
event `self-excited` of such a run. At 2 bar the whirl has begun, or is about to, at 4 s."""


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
