"""Run-ups and resting positions of chapter 6 with the penalty and the two-phase model."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frbcli.analysis.resonance import ridge_speeds, ridges
from frbcli.bearing_tests.kinematic import KinematicResult, rotation
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.results.store import Run
from validation.measures import SETTLED_s, WINDOW_s, first_event, kept_runup, rise

LOOSE = "accuracy.target=3e-3"  # half the cost of the default
WHIRLS = 0.65  # of the rotor speed, at most: a starved film also vibrates with a frequency of its own, near 90 Hz
RAMP_Hz = 30.0  # gained in a second: 0 to 300 Hz in 10 s
WEIGHT = "29.92 N"  # of half the rotor
SECONDS = (1.0, 2.0, 3.0, 4.0)
SLOW_Hz = 5.0  # gained in a second: an onset that is near the threshold


@dataclass(frozen=True)
class RunUp:
    """What chapter 6 says of a run-up.

    Times in s, NaN for what did not happen: onset_s, when a whirl of about half the rotor speed exceeds 5 % of the
    clearance; passage_s, when the
    eccentricity passes 0.6; critical_s, when the synchronous amplitude is largest. eccentricities: after SECONDS;
    amplitude: largest over the clearance before the onset, of unbalance and of all else.
    """

    onset_s: float
    passage_s: float
    critical_s: float
    eccentricities: tuple[float, ...]
    amplitude: float


def first_seconds(name: str, until_s: float, *settings: str) -> Case:
    """A shipped case, but only its first `until_s` seconds."""
    first = (f"speed.to={RAMP_Hz * until_s:g} Hz", f"speed.duration={until_s:g} s")
    return load_case(name, (LOOSE, *settings, *first))


def run_up(folder: Path, name: str, until_s: float, *settings: str) -> RunUp:
    """Run up the first seconds of a shipped case; a run that `folder` holds is taken."""
    run = kept_runup(folder, first_seconds(name, until_s, *settings))
    onset = whirl_onset(run, "t_s")
    after = tuple(float(np.interp(t, run["time_s"], run["eccentricity"])) for t in SECONDS)
    critical = first_event(run, "critical-speed", "t_s")
    return RunUp(onset, rise(run).passage_s, critical, after, _amplitude(run, onset))


def whirl_onset(run: Run, key: str) -> float:
    """`key`, t_s or speed_Hz, of the first onset of a whirl of about half the rotor speed, NaN if there is none. A
    vibration of another frequency that began before may turn into it without an end, which is no event."""
    onsets = [event for event in run.events if event["kind"] == "onset"]
    whirls = (event for event in onsets if event["frequency_ratio"] < WHIRLS)
    begun = next((float(event[key]) for event in whirls), math.nan)
    if not onsets or not math.isnan(begun):
        return begun
    lines = ridges(run, ridge_speeds(run), run.references["clearance_m"])
    other = np.flatnonzero(~(lines.whirls & (lines.whirl_Hz < WHIRLS * lines.speed_Hz)))
    later = lines.speed_Hz[other[-1] + 1 if len(other) else 0 :]
    if not len(later):
        return math.nan
    return float(later[0]) if key == "speed_Hz" else float(np.interp(later[0], run["speed_Hz"], run["time_s"]))


def slow_onset(folder: Path, name: str, begin_Hz: float, end_Hz: float, *settings: str) -> float:
    """Rotor speed in Hz at the onset in a slow ramp from the resting position at begin_Hz."""
    duration = (end_Hz - begin_Hz) / SLOW_Hz
    ramp = (f"speed.from={begin_Hz:g} Hz", f"speed.to={end_Hz:g} Hz", f"speed.duration={duration:g} s")
    case = load_case(name, (LOOSE, *settings, *ramp, 'start.position="resting"'))
    return whirl_onset(kept_runup(folder, case), "speed_Hz")


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
