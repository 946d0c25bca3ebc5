"""What samples and steps resolve, and the length that errors refer to.

What the steps of a run resolve of loads and inputs that change with time, and what its samples show of them.

Steps end at the rows of a table, so that each row is followed; between rows a table is a line. The samples of a run
file show frequencies below half of their rate.

The length that displacements of a machine without films are compared with, instead of a clearance. """

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.course.time_tables import inputs_of
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.rotor.assembly import held_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.loads import Harmonic, Tabulated, speed_profile
from frbcli.scene.costs.course import expected_course
from frbcli.scene.gate.rule import run_omega
from frbcli.scene.machine.elements import element_parts
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.planned import Decision, Plan
from frbcli.scene.shafts.table import shaft_of

CONTENT = 0.01  # of the largest amplitude in a table: below it a frequency does not count
ROUND_OFF = 1e-9
EVEN = 0.01  # share by which the intervals of an even table differ
CHOICE = "resolution"


def resolution_decisions(case: Case, plan: Plan) -> Iterator[Decision]:
    """How well the steps that are expected at the top speed resolve each load and each input over time."""
    loads = [load for _, load in element_parts(case).loads]
    given = [load for load in loads if isinstance(load, Tabulated)]
    tables = [(load.name, load.times, load.factors(load.times, load.times)) for load in given]
    tables += [(each.key, np.array(each.values.time), np.array([each.values.x]).T) for each in inputs_of(case)]
    harmonics = [load for load in loads if isinstance(load, Harmonic)]
    if not (tables or harmonics):
        return
    omega = run_omega(case)
    step = 1.0 / float(expected_course(case, plan, speed_profile([0.0, 1.0], [omega, omega])).steps[-1])
    shown = 0.5 / case.output.step
    for load in harmonics:
        frequency = abs(load.order * omega + load.frequency) / (2.0 * math.pi)
        if frequency > 0.0:
            reason = f"{1.0 / (frequency * step):.0f} steps in a period{_unseen(frequency, shown)}"
            yield Decision(CHOICE, f"{load.name}: {frequency:.4g} Hz", reason)
    for name, times, values in tables:
        yield Decision(CHOICE, *_of_table(name, times, values, step, shown))


def _of_table(name: str, times: Array, values: Array, step: float, shown: float) -> tuple[str, str]:
    """Value and reason of the decision about a table."""
    shortest = float(np.diff(times).min())
    size = f"{name}: {len(times)} rows, at least {shortest:.4g} s apart"
    if shortest >= step:
        reason = f"{shortest / step:.0f} steps of {step:.2g} s between them at the top speed"
    else:
        reason = f"closer than the steps of {step:.2g} s at the top speed, which end at each row: more steps"
    highest = highest_frequency(times, values)
    if highest > 0.0:
        reason += f"; content up to {highest:.3g} Hz{_unseen(highest, shown)}"
    return size, reason


def _unseen(frequency: float, shown: float) -> str:
    """A remark on a frequency that the samples of a run do not show."""
    if frequency <= shown:
        return ""
    return f", above the {shown:.3g} Hz that samples of output.step show"


def highest_frequency(times: Array | Sequence[float], values: Array) -> float:
    """Highest frequency in Hz in a table (k, columns) of even times (k,) in s with CONTENT of its largest amplitude, a
    line between its ends left out; 0 for uneven times."""
    steps = np.diff(times)
    if len(steps) < 8 or np.abs(steps - steps.mean()).max() > EVEN * steps.mean():
        return 0.0
    k = len(values)
    line = values[0] + np.linspace(0.0, 1.0, k)[:, None] * (values[-1] - values[0])
    spectrum = np.abs(np.fft.rfft((values - line) * np.hanning(k)[:, None], axis=0)).max(axis=1)
    counts = np.flatnonzero(spectrum > max(CONTENT * spectrum.max(), ROUND_OFF * k * np.abs(values).max()))
    return float(counts[-1] / (k * steps.mean())) if len(counts) else 0.0


SMALLEST = 1e-9  # m: of a rotor that neither its weight nor an unbalance moves
LARGEST = 1.0  # m: bearings that let the rotor sag further do not hold it
SAGS, TURNS, LEAST = "the largest static deflection", "the unbalance over the mass", "the least that is taken"
LOADED = "the largest static deflection under a load that changes"


def reference_length(case: Case) -> tuple[float, str]:
    """Length in m, and which one it is: the largest static deflection of a point of a run at the first and the last
    speed, under the static load or another load at its largest, or the unbalance over the mass if that is larger, at
    least SMALLEST."""
    rotor = make_rotor(case)
    speeds = [2.0 * math.pi * speed for speed in (case.speed.start, case.speed.end)]
    sag = max(_sag(rotor, omega) for omega in speeds)
    pushed = (replace(rotor, static_load=column) for load in rotor.loads for column in load.largest)
    loaded = max((_sag(each, omega) for each in pushed for omega in speeds), default=0.0)
    return max((sag, SAGS), (loaded, LOADED), (shaft_of(case).eccentricity, TURNS), (SMALLEST, LEAST))


def _sag(rotor: LinearRotor, omega: float) -> float:
    """m; 0 where the bearings do not hold the rotor."""
    try:
        shape = held_rotor(rotor, omega).shape
    except NotConverged:
        return 0.0
    deflection = max((float(np.hypot(*(place @ shape))) for _, place in rotor.points), default=0.0)
    return deflection if deflection < LARGEST else 0.0
