"""Random films on cells: whether the plan holds its target, and what a run states of its error.

`python unseen_films.py FOLDER SEED...` draws a film for each seed, runs it with the plans for two targets and on fine
cells, and writes a line of JSON for each: expected, true and stated error of the eccentricities.
"""

import json
import math
import random
import sys
from dataclasses import dataclass
from pathlib import Path

from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.errors import FrbError
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.planning.plan import expected_error, make_plan
from frbcli.studies.accuracy import difference

TARGETS = (1e-2, 3e-3)
FINE, FINE_BESIDE_GROOVES = "[10, 192]", "[6, 384]"  # beside axial grooves the cells along hardly matter
GRAVITY = 9.81
LAWS = ("half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase")  # the last three keep their oil


@dataclass(frozen=True)
class Found:
    """A film with a target. cells: of the plan; expected, true, stated: errors of the eccentricities; announced: what
    `frb check` says of the target; fine: how the run on fine cells ended."""

    seed: int
    law: str
    supply: str
    target: float
    cells: tuple[int, int]
    expected: float
    true: float
    stated: float
    eccentricity: float
    announced: str
    status: str
    fine: str
    cpu_s: float


def drawn(seed: int) -> str:
    """The case file of a film: a rigid rotor whose Sommerfeld number at the top speed is 0.1 to 5."""
    chance = random.Random(seed)
    law, supply = LAWS[seed % len(LAWS)], SUPPLIES[seed // len(LAWS) % len(SUPPLIES)]
    diameter = chance.uniform(10.0, 50.0)  # mm
    width, clearance = diameter * chance.uniform(0.35, 1.1), diameter * chance.uniform(0.8, 1.8)  # mm, um
    viscosity, speed = 10.0 ** chance.uniform(0.6, 1.7), 10.0 ** chance.uniform(1.2, 2.2)  # mPa s, Hz
    number = 10.0 ** chance.uniform(-1.0, 0.7)
    gap = 2e-3 * clearance / diameter
    load = number * 1e-6 * width * diameter * 1e-3 * viscosity * 2.0 * math.pi * speed / gap**2
    dry = supply == "none" and law in LAWS[3:]  # between free ends it would run dry, and is refused
    ends = "free-to-air" if chance.random() < 0.5 and not dry else "oil-bath"
    cavitation = chance.choice((1.0, 1.0, 0.7, 0.3))
    opening = _opening(supply, chance, diameter, width)
    return f"""
[rotor]
kind = "rigid"
mass = "{2.0 * load / GRAVITY:.6g} kg"
[bearing]
kind = "single-film"
width = "{width:.4g} mm"
diameter = "{diameter:.4g} mm"
clearance = "{clearance:.4g} um"
ends = "{ends}"
{opening}
[oil]
viscosity = "{viscosity:.4g} mPa*s"
density = "850 kg/m^3"
ambient_pressure = "1 bar"
cavitation_pressure = "{cavitation} bar"
[film]
cavitation = "{law}"
solution = "cells"
[speed]
from = "0 Hz"
to = "{speed:.4g} Hz"
duration = "{8.0 / speed:.4g} s"
[output]
step = "{0.02 / speed:.4g} s"
"""


SUPPLIES = ("axial-grooves", "bores", "pocket", "axial-slots", "circumferential-groove", "none")


def _opening(supply: str, chance: random.Random, diameter: float, width: float) -> str:
    if supply == "none":
        return ""
    pressure = f'pressure = "{chance.uniform(1.0, 4.0):.3g} bar"'
    place = f'position = "{chance.uniform(0.0, 360.0):.0f} deg", opening_angle = "{chance.uniform(10.0, 40.0):.0f} deg"'
    share, count = chance.uniform(0.3, 0.8), chance.choice((1, 1, 2, 3))
    parts = {
        "circumferential-groove": "",
        "axial-grooves": f"count = {count}, {place}, ",
        "axial-slots": f'count = {count}, {place}, length = "{share * width:.3g} mm", ',
        "pocket": f'{place}, width = "{share * width:.3g} mm", ',
        "bores": f'count = {chance.choice((1, 2, 3, 6))}, diameter = "{chance.uniform(0.08, 0.16) * diameter:.3g} mm", '
        f'position = "{chance.uniform(0.0, 360.0):.0f} deg", ',
    }[supply]
    return f'supply = {{ kind = "{supply}", {parts}{pressure} }}'


def tried(seed: int, folder: Path) -> list[Found]:
    """The film of a seed with each target."""
    text = drawn(seed)
    mesh = FINE_BESIDE_GROOVES if '"axial-grooves"' in text else FINE
    fine = _run(load_case_text(text, (f"accuracy.mesh={mesh}", "accuracy.tolerance=2e-5")), folder / "fine.h5")
    if len(fine) < 2:
        return []
    return [_compared(seed, text, target, fine, folder) for target in TARGETS]


def _compared(seed: int, text: str, target: float, fine: Run, folder: Path) -> Found:
    case = load_case_text(text, (f"accuracy.target={target}",))
    plan = make_plan(case)
    run = _run(case, folder / "run.h5")
    announced = next((decision.value for decision in plan.decisions if decision.choice == "target"), "")
    stated = run.error.get("eccentricity")
    assert plan.cells is not None
    return Found(
        seed, case.film.cavitation, case.bearings[0].supply.kind, target, plan.cells, expected_error(plan).eccentricity,
        difference(run, fine).largest, math.nan if stated is None else float(stated), float(fine["eccentricity"].max()),
        announced, run.status, fine.status, float(run.cost["cpu_s"]),
    )  # fmt: skip


def _run(case: Case, path: Path) -> Run:
    return runup(case, path, force=True)


def main() -> None:
    """Write a line for each seed and target."""
    folder = Path(sys.argv[1])
    for seed in map(int, sys.argv[2:]):
        try:
            lines = [vars(found) for found in tried(seed, folder)]
        except FrbError as error:
            lines = [{"seed": seed, "refused": str(error)}]
        for line in lines:
            sys.stdout.write(json.dumps(line) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
