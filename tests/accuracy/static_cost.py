"""Measures what the errors of static results cost: CPU time with them over that without, in one process.

`cd tests && python -m accuracy.static_cost [WORD ...]`: the rows of the table whose command or case has the words; some
minutes in all.
"""

import contextlib
import math
import statistics
import sys
from collections.abc import Callable, Iterator
from time import process_time
from typing import Any
from unittest.mock import patch

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.linear import stability, stability_point
from frbcli.linear.damped_modes import damped_modes
from frbcli.linear.response import response
from frbcli.linear.sheets import film_state
from frbcli.linear.sheets.bearing import bearing_sheet
from frbcli.linear.stability_point import point_at_rest

SPEEDS = (0.1, 0.3, 0.5, 0.7, 0.9)  # over the highest one of the case
LONG = 1.0  # s of CPU time that runs without errors take in all, at least
CASES: dict[str, tuple[str, tuple[str, ...]]] = {
    "jeffcott": ("jeffcott", ()),
    "jeffcott, Reynolds": ("jeffcott", ("film.cavitation=reynolds",)),
    "axial-groove": ("axial-groove", ()),
    "rigid-two-phase, 2 bar": ("rigid-two-phase", ("bearing.supply.pressure=2 bar",)),
    "floating-ring": ("floating-ring", ()),
    "turbocharger-car": ("turbocharger-car", ()),
}
COMMANDS: dict[str, Callable[[Case, list[float]], Any]] = {
    "bearing": bearing_sheet,
    "stability": stability.stability_points,
    "threshold": lambda case, _: stability.stability(case),
    "response": response,
    "modes": lambda case, speeds: damped_modes(case, speeds[2]),
}


@contextlib.contextmanager
def without_errors() -> Iterator[None]:
    """Static results without their errors, and nothing computed for these alone."""
    whole = StaticMachines.at

    def at(
        self: StaticMachines, omega: float, near: MachineAtRest | None = None, *_: bool, **__: bool
    ) -> MachineAtRest:
        return whole(self, omega, near, with_error=False)

    def at_threshold(
        machines: StaticMachines, speed: float, near: MachineAtRest | None = None
    ) -> stability_point.Threshold:
        found = point_at_rest(whole(machines, 2.0 * math.pi * speed, near, with_error=False), speed)
        return stability_point.Threshold(speed, found.critical.imag / (2.0 * math.pi))

    unknown = film_state.Fields(*(math.nan,) * 4)
    with contextlib.ExitStack() as patches:
        for place, name, instead in (
            (StaticMachines, "at", at),
            (stability_point, "threshold_at", at_threshold),
            (stability, "with_errors", lambda point, _: point),
            (film_state, "force_error", lambda *_: math.nan),
            (film_state, "_field_errors", lambda *_: unknown),
        ):
            patches.enter_context(patch.object(place, name, instead))
        yield


def costs(compute: Callable[[], Any]) -> tuple[float, float]:
    """CPU time in s without errors and with them, medians of runs that take turns, after one of each."""
    own: list[float] = []
    whole: list[float] = []
    while len(own) < 2 or sum(own[1:]) < LONG:
        begun = process_time()
        with without_errors():
            compute()
        half = process_time()
        compute()
        own.append(half - begun)
        whole.append(process_time() - half)
    return statistics.median(own[1:]), statistics.median(whole[1:])


def row(command: str, name: str) -> str:
    """The row of the table of a command and a case."""
    source, settings = CASES[name]
    case = load_case(source, list(settings))
    speeds = [share * max(abs(case.speed.start), abs(case.speed.end)) for share in SPEEDS]
    own, whole = costs(lambda: COMMANDS[command](case, speeds))
    return f"| {command} | {name} | {own:.2g} s | {max(whole - own, 0.0):.2g} s | {max(whole / own - 1.0, 0.0):.2f} |"


def main(words: list[str]) -> None:
    """See the module."""
    sys.stdout.write("| command | case | without errors | errors | share |\n| --- | --- | --- | --- | --- |\n")
    for name in CASES:
        for command in COMMANDS:
            if all(word in f"{command} {name}" for word in words):
                sys.stdout.write(row(command, name) + "\n")
                sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
