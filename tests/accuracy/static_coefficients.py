"""Measures whether stated errors of stiffness and damping at rest hold, beside finer meshes.

`cd tests && python -m accuracy.static_coefficients [SEEDS]`: the 30 states, or films by chance from so many seeds on;
some minutes. The truth is on FINER cells, and FINE ones tell its own error; tables have FINEST times their elements.
"""

import math
import random
import statistics
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium import static_films
from frbcli.equilibrium.static_machine import StaticMachines
from frbcli.errors import FrbError
from frbcli.film.rectangles.film import FilmForce

LAWS = ("half-sommerfeld", "reynolds", "penalty", "peeken", "elrod", "two-phase")
SOMMERFELD = (0.02, 0.1, 0.5, 1.5, 5.0)
FINE, FINER, FINEST = (288, 30), (400, 42), 5
FINE_WITH_OIL, FINER_WITH_OIL = (216, 24), (288, 30)  # of laws that keep oil, whose films take longer
SPEED_Hz, DIAMETER, CLEARANCE, VISCOSITY = 100.0, 0.025, 35e-6, 0.012


@dataclass(frozen=True)
class State:
    """A film and its load in N."""

    words: str
    case: Case
    load: float


def unit(width: float) -> float:
    """Load in N at a Sommerfeld number of 1."""
    return width * DIAMETER * VISCOSITY * 2.0 * math.pi * SPEED_Hz / (2.0 * CLEARANCE / DIAMETER) ** 2


def states() -> Iterator[State]:
    """The 30 states."""
    for law in LAWS:
        case = load_case("jeffcott", [f"film.cavitation={law}", "bearing.supply.pressure=2 bar"])
        for number in SOMMERFELD:
            yield State(f"{law}, So {number:g}", case, number * unit(0.02))


def by_chance(seed: int) -> State:
    """A film by chance."""
    draw = random.Random(seed)
    law = draw.choice(("half-sommerfeld", "reynolds", "reynolds", "penalty", "penalty"))
    pressure = draw.choice((1.0, draw.uniform(1.0, 4.0)))
    kind = draw.choice(("circumferential-groove", "circumferential-groove", "axial-grooves", "bores"))
    more = ""
    if kind == "axial-grooves":
        count, place, opening = draw.choice((1, 2)), draw.choice((0, 90)), draw.choice((10, 15, 25))
        more = f', count = {count}, position = "{place} deg", opening_angle = "{opening} deg"'
    elif kind == "bores":
        more = f', count = {draw.choice((2, 4, 6))}, diameter = "2.5 mm", position = "{draw.randrange(360)} deg"'
    number, slender = 10.0 ** draw.uniform(math.log10(0.02), math.log10(5.0)), draw.uniform(0.4, 1.0)
    settings = [
        f"film.cavitation={law}", "film.theory=finite", f"bearing.width={1e3 * DIAMETER * slender:.2f} mm",
        f'bearing.supply={{ kind = "{kind}"{more}, pressure = "{pressure:.2f} bar" }}',
    ]  # fmt: skip
    words = f"seed {seed}, {law}, {kind}, So {number:.3g}"
    return State(words, load_case("jeffcott", settings), number * unit(DIAMETER * slender))


def off(own: FilmForce, true: FilmForce) -> float:
    """How far stiffness or damping is off over the largest true entry, whichever is more."""
    pairs = ((own.by_displacement, true.by_displacement), (own.by_velocity, true.by_velocity))
    return max(float(np.abs(mine - theirs).max() / np.abs(theirs).max()) for mine, theirs in pairs)


def at_rest(state: State, cells: tuple[int, int]) -> FilmForce:
    """The film on other cells."""
    with patch.object(static_films, "CELLS", cells):
        machines = StaticMachines(state.case, load=state.load)
        return machines.at(2.0 * math.pi * SPEED_Hz, with_error=False).at_rest.forces[0]


def told(state: State) -> tuple[float, float]:
    """Stated over true error, and the error of the truth over the true one; a line about them."""
    machines = StaticMachines(state.case, load=state.load)
    found = machines.at(2.0 * math.pi * SPEED_Hz)
    own, stated = found.at_rest.forces[0], found.films[0].error
    if machines.static.on_cells:
        keeps = machines.system.remembers
        fine = at_rest(state, FINE_WITH_OIL if keeps else FINE)
        finer = at_rest(state, FINER_WITH_OIL if keeps else FINER)
        true, doubt = off(own, finer), off(fine, finer)
    else:
        with patch.object(static_films, "FINER", FINEST):
            finest = StaticMachines(state.case, load=state.load).at(2.0 * math.pi * SPEED_Hz).others[0][0].forces[0]
        true, doubt = off(own, finest), off(found.others[0][0].forces[0], finest)
    holds = "holds" if true <= stated else "MISSES"
    errors = f"true {true:.1e}, fine {doubt:.1e}, stated {stated:.1e}, {holds}"
    sys.stdout.write(f"{state.words}: eps {found.films[0].eccentricity:.3f}, {errors}\n")
    sys.stdout.flush()
    return stated / true, true


def main(seeds: list[int]) -> None:
    """See the module."""
    chosen = (by_chance(seed) for seed in range(*seeds)) if seeds else states()
    ratios = []
    for state in chosen:
        try:
            ratios.append(told(state))
        except FrbError as error:
            sys.stdout.write(f"{state.words}: {error}\n")
    of_true, errors = zip(*ratios, strict=True)
    within = sum(ratio >= 1.0 for ratio in of_true)
    sys.stdout.write(
        f"{within} of {len(ratios)} hold, stated over true {statistics.median(of_true):.1f} in the median, "
        f"{min(of_true):.2f} at least; true {statistics.median(errors):.1e} in the median, {max(errors):.1e} at most\n"
    )


if __name__ == "__main__":
    main([int(each) for each in sys.argv[1:]])
