"""Run-ups and resting positions of chapter 6 with the penalty and the two-phase model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frbcli.bearing_tests.kinematic import KinematicResult, rotation
from frbcli.case.load import load_case
from frbcli.results.store import Run
from validation.measures import SETTLED_s, WINDOW_s, first_event, kept_runup, rise

LOOSE = "accuracy.target=3e-3"  # half the cost of the default
RAMP_Hz = 30.0  # gained in a second: 0 to 300 Hz in 10 s
WEIGHT = "29.92 N"  # of half the rotor
SECONDS = (1.0, 2.0, 3.0, 4.0)


@dataclass(frozen=True)
class RunUp:
    """What chapter 6 says of a run-up.

    Times in s, NaN for what did not happen: onset_s, when a whirl exceeds 5 % of the clearance; passage_s, when the
    eccentricity passes 0.6; critical_s, when the synchronous amplitude is largest. eccentricities: after SECONDS;
    amplitude: largest over the clearance before the onset, of unbalance and of all else.
    """

    onset_s: float
    passage_s: float
    critical_s: float
    eccentricities: tuple[float, ...]
    amplitude: float


def run_up(folder: Path, name: str, until_s: float, *settings: str) -> RunUp:
    """Run up a shipped case, but only for its first `until_s` seconds; a run that `folder` holds is taken."""
    first = (f"speed.to={RAMP_Hz * until_s:g} Hz", f"speed.duration={until_s:g} s")
    case = load_case(name, (LOOSE, *settings, *first))
    run = kept_runup(folder, case)
    onset = first_event(run, "onset", "t_s")
    after = tuple(float(np.interp(t, run["time_s"], run["eccentricity"])) for t in SECONDS)
    critical = first_event(run, "critical-speed", "t_s")
    return RunUp(onset, rise(run).passage_s, critical, after, _amplitude(run, onset))


def _amplitude(run: Run, onset_s: float) -> float:
    """Largest amplitude of the journal's motion over the clearance, once settled, until shortly before the onset."""
    until = run.t_end_s if math.isnan(onset_s) else onset_s - 5.0 * WINDOW_s
    chosen = (run["time_s"] > SETTLED_s) & (run["time_s"] < until)
    motion = (run["journal_x_m"] + 1j * run["journal_y_m"])[chosen] / run.references["clearance_m"]
    width = round(WINDOW_s / (run["time_s"][1] - run["time_s"][0]))
    windows = motion[: len(motion) // width * width].reshape(-1, width)
    return float(windows.std(axis=1).max()) if len(windows) else math.nan


def at_rest(name: str, speed_Hz: float, *settings: str) -> KinematicResult:
    """A bearing of a shipped case that carries its share of the weight at a speed."""
    motion = f'motion={{ load = "{WEIGHT}", speed = "{speed_Hz:g} Hz" }}'
    return rotation(load_case(name, (*settings, motion))).results[0]


def held(name: str, eccentricity: float, speed_Hz: float, *settings: str) -> KinematicResult:
    """A bearing of a shipped case with its journal held at an eccentricity."""
    motion = f'motion={{ eccentricity = {eccentricity:g}, speed = "{speed_Hz:g} Hz" }}'
    return rotation(load_case(name, (*settings, motion))).results[0]


def largest_pressure_bar(result: KinematicResult) -> float:
    """Largest absolute film pressure in bar, NaN where no film was found."""
    return math.nan if result.loads is None else result.loads.p_max / 1e5


def eccentricity(result: KinematicResult) -> float:
    """Relative eccentricity."""
    return math.hypot(*result.displacement)
