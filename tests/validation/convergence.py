"""How the run-up with the two-phase model depends on the number of its cells."""

from __future__ import annotations

from pathlib import Path

from frbcli.scene.planning.plan import make_plan
from validation.chapter6 import SECONDS, first_seconds, run_up
from validation.chapter6_rows import CIRCUMFERENTIAL

UNTIL_s = 6.0
MESHES: tuple[tuple[str, ...], ...] = ((), ("accuracy.mesh=[6,64]",), ("accuracy.mesh=[10,96]",))
SUPPLIES = (1, 2)
HEAD = """Case `jeffcott-two-phase`, x_1 = 0.99, on cells that turn with half the rotor speed; the first row of each
supply has the cells of the plan, around x along. Amplitude: the largest before the onset, over the clearance.
Resting positions are accurate on few cells. At 1 bar the journal in the starved film also vibrates with 84 to
90 Hz from about 2.2 s on, the event `self-excited`; below 0.8 of the rotor speed, from 3.8 s on, such a
vibration is an `onset`, too, and onsets here are those below 0.65 of it, of the whirl of about half the rotor
speed. The whirl at 1 bar begins at the same time on all cells, that at 2 bar is certain to 0.2 s: a target of
1e-3 gives 3.39 s. On cells at rest with the oil carried upwind, which damps it, the vibration was smaller
(0.1 to 0.25) and ended before the whirl began, and the whirl was later, at 4.7 and 3.9 s."""


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
        for mesh in MESHES:
            chosen = CIRCUMFERENTIAL, UNTIL_s, *mesh, f"bearing.supply.pressure={bar} bar"
            cells = " x ".join(map(str, make_plan(first_seconds(*chosen)).cells or ()))
            run = run_up(folder, *chosen)
            values = " | ".join(f"{value:.3f}" for value in run.eccentricities)
            lines.append(f"| {bar} | {cells} | {run.onset_s:.2f} | {values} | {run.amplitude:.3f} |")
    return lines
